//! The light map: texels of an atlas with their values.

use super::{Atlas, Baked};
use crate::spectrum::Rgb;

/// Irradiance in the texels of an [`Atlas`], with padded seams.
///
/// `[side][side]`, row by row: row 0 is at v = 0, as graphics interfaces expect textures. Texels that no triangle
/// covers have the values of the nearest covered texel of their chart, up to the distance [`Atlas::padding`], and are
/// zero elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightMap {
    /// Texels along a side.
    pub side: u32,
    /// Irradiance [W m^-2].
    pub irradiance: Vec<[f32; 3]>,
    /// Standard error of the irradiance [W m^-2] where it is known; NaN where there are too few samples.
    pub standard_error: Vec<[f32; 3]>,
    /// Fraction of a texel that triangles cover; 0 for padded texels and for texels outside of charts.
    pub coverage: Vec<f32>,
}

impl LightMap {
    /// Irradiance [W m^-2] at a position in [0, 1]^2, interpolated between the centres of texels as graphics hardware
    /// does it, with the outermost texels repeated at the edge.
    pub fn at(&self, [u, v]: [f32; 2]) -> Rgb {
        let side = self.side as f32;
        let most = self.side.saturating_sub(1);
        let split = |x: f32| {
            let x = (x * side - 0.5).clamp(0.0, most as f32);
            let low = (x as u32).min(most);
            (low, (low + 1).min(most), x - low as f32)
        };
        let ((left, right, s), (below, above, t)) = (split(u), split(v));
        let texel = |x: u32, y: u32| Rgb::from(self.irradiance[(y * self.side + x) as usize]);
        let row = |y: u32| texel(left, y) * (1.0 - s) + texel(right, y) * s;
        row(below) * (1.0 - t) + row(above) * t
    }
}

impl Atlas {
    /// The light map of baked [`Atlas::sites`]; sites without a value are black.
    pub fn light_map(&self, baked: &Baked) -> LightMap {
        let side = self.side();
        let count = side as usize * side as usize;
        let mut map = LightMap {
            side,
            irradiance: vec![[0.0; 3]; count],
            standard_error: vec![[0.0; 3]; count],
            coverage: vec![0.0; count],
        };
        for (site, (&texel, &coverage)) in self.texels().iter().zip(self.coverage()).enumerate() {
            let texel = texel as usize;
            map.coverage[texel] = coverage;
            map.irradiance[texel] = baked.irradiance.get(site).copied().unwrap_or_default();
            map.standard_error[texel] = baked.standard_error.get(site).copied().unwrap_or_default();
        }
        self.pad(&mut map);
        map
    }

    /// Copies the values of the nearest covered texel of a chart to its uncovered texels.
    fn pad(&self, map: &mut LightMap) {
        let (side, reach) = (self.side() as usize, self.padding() as usize);
        for chart in self.charts() {
            let [left, top] = chart.origin.map(|x| x as usize);
            let [right, bottom] = [left + chart.size[0] as usize, top + chart.size[1] as usize];
            for y in top..bottom {
                for x in left..right {
                    let texel = y * side + x;
                    if map.coverage[texel] > 0.0 {
                        continue;
                    }
                    let mut nearest: Option<(usize, usize)> = None;
                    for row in y.saturating_sub(reach).max(top)..(y + reach + 1).min(bottom) {
                        for column in x.saturating_sub(reach).max(left)..(x + reach + 1).min(right) {
                            let other = row * side + column;
                            let distance = row.abs_diff(y).pow(2) + column.abs_diff(x).pow(2);
                            if map.coverage[other] > 0.0 && nearest.is_none_or(|(least, _)| distance < least) {
                                nearest = Some((distance, other));
                            }
                        }
                    }
                    if let Some((_, other)) = nearest {
                        map.irradiance[texel] = map.irradiance[other];
                        map.standard_error[texel] = map.standard_error[other];
                    }
                }
            }
        }
    }
}
