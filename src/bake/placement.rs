//! The position and scale of charts in the square.

use super::chart::Chart;
use super::options::{AtlasOptions, DEFAULT_SIDE, MAX_SIDE};
use super::overlap::PlanarTriangle;
use super::{pack, raster};
use crate::control::WorkProgress;
use crate::error::{Error, Result};

/// The rectangle of texels that belongs to a chart, including its gutter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartRect {
    /// Column and row of the first texel.
    pub origin: [u32; 2],
    /// Numbers of columns and rows.
    pub size: [u32; 2],
}

/// The position and scale of charts in the square.
pub(super) struct ChartPlacement {
    pub side: u32,
    /// Texels for a unit of length.
    pub density: f64,
    gutter: u32,
    pub rects: Vec<ChartRect>,
}

/// Lengths that are whole numbers of texels except for this rounding count as whole.
const ROUNDING_TEXELS: f64 = 1e-6;

impl ChartPlacement {
    /// Finds the resolution and the density where they are not given.
    pub(super) fn find(charts: &[Chart], options: &AtlasOptions, progress: &WorkProgress) -> Result<Self> {
        // A single mesh with its own layout: the map has that layout.
        if let [chart] = charts
            && chart.uses_mesh_uvs
        {
            let needed = options.texels_per_unit.map(|density| (density * chart.unit - ROUNDING_TEXELS).ceil());
            let side = match (options.resolution, needed) {
                (Some(side), Some(needed)) if needed > f64::from(side) => return Err(too_dense(options, side)),
                (Some(side), _) => side,
                (None, Some(needed)) if needed > f64::from(MAX_SIDE) => return Err(too_large(options, needed)),
                (None, Some(needed)) => (needed as u32).max(1),
                (None, None) => DEFAULT_SIDE,
            };
            let place = ChartRect { origin: [0, 0], size: [side, side] };
            return Ok(Self { side, density: f64::from(side) / chart.unit, gutter: 0, rects: vec![place] });
        }
        let gutter = options.gutter;
        let at = |side: u32, density: f64| {
            let Some(sizes) = sizes(charts, density, gutter, side) else { return Ok(None) };
            let places = pack::pack(&sizes, side, progress)?;
            Ok::<_, Error>(places.map(|places| {
                let place = |(origin, size)| ChartRect { origin, size };
                let places = places.into_iter().zip(sizes).map(place).collect();
                Self { side, density, gutter, rects: places }
            }))
        };
        match (options.resolution, options.texels_per_unit) {
            (Some(side), Some(density)) => match at(side, density)? {
                Some(placement) => Ok(placement),
                None => Err(too_dense(options, side)),
            },
            (None, Some(density)) => {
                let area: f64 = charts.iter().map(|chart| padded_area(chart, density, gutter)).sum();
                let mut side = area.sqrt().ceil().max(1.0);
                loop {
                    if side > f64::from(MAX_SIDE) {
                        return Err(too_large(options, side));
                    }
                    // Multiples of four suit block compression.
                    let whole = (side as u32).next_multiple_of(4).min(MAX_SIDE);
                    if let Some(placement) = at(whole, density)? {
                        return Ok(placement);
                    }
                    side = (1.04 * f64::from(whole)).max(f64::from(whole) + 1.0);
                }
            }
            (resolution, None) => Self::densest(charts, resolution.unwrap_or(DEFAULT_SIDE), gutter, at),
        }
    }

    /// The largest density that fits, to 1 %.
    fn densest(
        charts: &[Chart],
        side: u32,
        gutter: u32,
        at: impl Fn(u32, f64) -> Result<Option<Self>>,
    ) -> Result<Self> {
        let area: f64 = charts.iter().map(|chart| chart.size[0] * chart.size[1] * chart.unit * chart.unit).sum();
        let lengths = charts.iter().map(|chart| chart.size[0].max(chart.size[1]) * chart.unit);
        let mut high = f64::from(side) / area.sqrt().max(lengths.fold(0.0, f64::max));
        let mut low = high;
        let mut best = None;
        for _ in 0..64 {
            low *= 0.8;
            best = at(side, low)?;
            if best.is_some() {
                break;
            }
            high = low;
        }
        let Some(mut best) = best else {
            let message = format!(
                "{} charts with {gutter} texels around each do not fit into {side} x {side} texels",
                charts.len()
            );
            return Err(Error::invalid("resolution", message));
        };
        while high > 1.01 * low {
            let middle = (low * high).sqrt();
            match at(side, middle)? {
                Some(better) => (low, best) = (middle, better),
                None => high = middle,
            }
        }
        Ok(best)
    }

    /// Texels for a unit of a chart's plane.
    pub(super) fn scale(&self, chart: &Chart) -> f64 {
        self.density * chart.unit
    }

    /// Origin of a chart's plane, in texels.
    pub(super) fn corner(&self, number: usize) -> [f64; 2] {
        self.rects[number].origin.map(|x| f64::from(x + self.gutter))
    }

    /// The triangle that is rasterized for a chart's triangle.
    pub(super) fn rasterizable(&self, number: usize, chart: &Chart, at: usize) -> PlanarTriangle {
        let ChartRect { origin, size } = self.rects[number];
        let end = [0, 1].map(|axis| f64::from(origin[axis] + size[axis] - self.gutter));
        raster::rasterizable(self.in_texels(number, chart, at), end)
    }

    /// A chart's triangle in texels.
    pub(super) fn in_texels(&self, number: usize, chart: &Chart, at: usize) -> PlanarTriangle {
        let (scale, [x, y]) = (self.scale(chart), self.corner(number));
        // Rounding must not move a corner beyond the chart's own texels.
        let most = self.rects[number].size.map(|size| f64::from(size - 2 * self.gutter));
        chart.flat[at].map(|[u, v]| [x + (u * scale).min(most[0]), y + (v * scale).min(most[1])])
    }
}

/// Numbers of texels that charts take with their gutters; `None` where one is larger than `side`.
fn sizes(charts: &[Chart], density: f64, gutter: u32, side: u32) -> Option<Vec<[u32; 2]>> {
    charts
        .iter()
        .map(|chart| {
            let length = |length: f64| {
                let texels = (length * chart.unit * density - ROUNDING_TEXELS).ceil().max(1.0) + f64::from(2 * gutter);
                (texels <= f64::from(side)).then_some(texels as u32)
            };
            Some([length(chart.size[0])?, length(chart.size[1])?])
        })
        .collect()
}

fn padded_area(chart: &Chart, density: f64, gutter: u32) -> f64 {
    let length = |length: f64| (length * chart.unit * density).ceil().max(1.0) + f64::from(2 * gutter);
    length(chart.size[0]) * length(chart.size[1])
}

fn too_dense(options: &AtlasOptions, side: u32) -> Error {
    let density = options.texels_per_unit.unwrap_or_default();
    let message = format!(
        "{density} texels per unit do not fit into {side} x {side} texels: raise the resolution, or leave one of the two to be \
         found"
    );
    Error::invalid("resolution", message)
}

fn too_large(options: &AtlasOptions, side: f64) -> Error {
    let density = options.texels_per_unit.unwrap_or_default();
    let message = format!(
        "{density} texels per unit need a light map of about {side:.0} x {side:.0} texels; at most {MAX_SIDE} x {MAX_SIDE} \
         are made"
    );
    Error::invalid("texelsPerUnit", message)
}
