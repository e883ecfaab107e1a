//! Slopes of a surface from images of normals or heights, with their squares: the mean of both over a footprint says where the surface
//! faces in the mean and how much it varies, which is roughness that is too fine to be seen (Olano and Baker 2010, "LEAN Mapping").

use super::lookup::Wrap;
use super::texels::{ColorSpace, TexelImage};
use super::{Texel, pyramid::wrapped};

/// What an image says of the slopes of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SlopesOf {
    /// Unit normals: red, green and blue are x, y and z from -1 to 1.
    Normals,
    /// Heights, in this channel.
    Heights(usize),
}

/// Normals are taken to lean by no more than this slope, 87 degrees.
const STEEPEST: f32 = 20.0;

impl SlopesOf {
    /// The slopes at a texel, by columns to the right and rows upwards, and their squares. Those of normals are the x and y of a normal
    /// whose z is 1; those of heights are their growth over the whole width and height of the image.
    pub fn at(self, image: &TexelImage, space: ColorSpace, wrap: [Wrap; 2], x: u32, y: u32) -> Texel {
        let [a, b] = match self {
            Self::Normals => {
                let [nx, ny, nz] = [0, 1, 2].map(|i: usize| 2.0 * image.texel(x, y, space)[i] - 1.0);
                let z = nz.max(nx.hypot(ny) / STEEPEST);
                if z > 0.0 { [nx / z, ny / z] } else { [0.0; 2] }
            }
            Self::Heights(channel) => {
                let size = [image.width(), image.height()];
                let height = |dx: i64, dy: i64| {
                    let place = wrapped(wrap, size, [i64::from(x) + dx, i64::from(y) + dy]);
                    place.map_or(0.0, |[x, y]| image.texel(x, y, space)[channel])
                };
                let [width, rows] = size.map(|n| n as f32);
                // Rows grow down.
                [0.5 * width * (height(1, 0) - height(-1, 0)), 0.5 * rows * (height(0, -1) - height(0, 1))]
            }
        };
        [a, b, a * a, b * b]
    }
}

impl SlopesOf {
    /// The slopes at a texel that may lie beyond the edges, from those of the texel that is shown there: heights beyond the edges that
    /// repeat those of the edge do not grow, and heights in a mirror grow the other way. Maps of normals are shown as they are, like
    /// images.
    pub fn beyond_edges(self, wrap: [Wrap; 2], size: [u32; 2], at: [i64; 2], texel: Texel) -> Texel {
        let mut texel = texel;
        for i in 0..2 {
            let tile = at[i].div_euclid(i64::from(size[i]));
            match wrap[i] {
                Wrap::Clamp if self != Self::Normals && tile != 0 => (texel[i], texel[i + 2]) = (0.0, 0.0),
                Wrap::Mirror if self != Self::Normals && tile % 2 != 0 => texel[i] = -texel[i],
                _ => {}
            }
        }
        texel
    }
}

/// The variances of the two slopes, of which means and mean squares are given.
pub(crate) fn variances([a, b, aa, bb]: Texel) -> [f32; 2] {
    [(aa - a * a).max(0.0), (bb - b * b).max(0.0)]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{ImageTexture, Texels, TextureFilter, TexturePoint};
    use super::*;

    fn texture(
        of: SlopesOf,
        channels: u32,
        filter: TextureFilter,
        value: impl Fn(u32, u32) -> [f32; 3],
    ) -> ImageTexture {
        let values = (0..64).flat_map(|i| value(i % 8, i / 8).into_iter().take(channels as usize));
        let image = TexelImage::new(8, 8, channels, Texels::F32(values.collect())).unwrap();
        ImageTexture::of_slopes(Arc::new(image), ColorSpace::Raw, [Wrap::Repeat; 2], filter, of, 1)
    }

    fn point(uv: [f32; 2], width: f32) -> TexturePoint {
        TexturePoint { uv, axes: [[width, 0.0], [0.0, width]], ..TexturePoint::default() }
    }

    /// Normals that lean by these slopes.
    fn leaning([a, b]: [f32; 2]) -> [f32; 3] {
        let length = (a * a + b * b + 1.0).sqrt();
        [a, b, 1.0].map(|x| 0.5 * x / length + 0.5)
    }

    #[test]
    fn means_of_slopes_and_squares_are_those_of_the_texels() {
        let slope = |x: u32, y: u32| [0.1 * x as f32 - 0.2, 0.05 * ((3 * y) % 8) as f32];
        let all: Vec<[f32; 2]> = (0..64).map(|i| slope(i % 8, i / 8)).collect();
        let mean = |f: &dyn Fn(&[f32; 2]) -> f32| all.iter().map(f).sum::<f32>() / 64.0;
        let means = [mean(&|s| s[0]), mean(&|s| s[1])];
        let expected = [mean(&|s| (s[0] - means[0]).powi(2)), mean(&|s| (s[1] - means[1]).powi(2))];
        for filter in [TextureFilter::Mip, TextureFilter::Ewa] {
            let texture = texture(SlopesOf::Normals, 3, filter, |x, y| leaning(slope(x, y)));
            let far = texture.at(&point([0.3, 0.7], 40.0));
            for i in 0..2 {
                assert!((far[i] - means[i]).abs() < 1e-5, "{filter:?}: {far:?}, not {means:?}");
                let variance = variances(far)[i];
                assert!(
                    (variance - expected[i]).abs() < 1e-2 * expected[i],
                    "{filter:?}: {variance}, not {expected:?}"
                );
            }
        }
    }

    /// From near, the surface between texels is smooth.
    #[test]
    fn nothing_is_averaged_from_near() {
        for filter in [TextureFilter::Mip, TextureFilter::Ewa] {
            let texture = texture(SlopesOf::Normals, 3, filter, |x, _| leaning([0.3 * x as f32, 0.0]));
            let between = texture.at(&point([2.0 / 8.0, 0.5], 0.01));
            assert!((between[0] - 0.45).abs() < 1e-5, "{between:?}");
            assert!(variances(between).iter().all(|variance| *variance < 1e-6), "{between:?}");
        }
    }

    #[test]
    fn heights_grow_by_coordinates() {
        // 3 u + 5 v, rows from the top; the middle of the image, which repeats.
        let height = |x: u32, y: u32| [(3.0 * (x as f32 + 0.5) + 5.0 * (7.5 - y as f32)) / 8.0, 0.0, 0.0];
        let texture = texture(SlopesOf::Heights(0), 1, TextureFilter::Ewa, height);
        let [a, b, ..] = texture.texel(0, [4, 3]);
        assert!((a - 3.0).abs() < 1e-5 && (b - 5.0).abs() < 1e-5, "{a} {b}");
    }

    /// The slopes of a ramp that is repeated, mirrored and held at its edges, as differences of its heights say.
    #[test]
    fn heights_beyond_the_edges_grow_as_they_are_shown() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let values = (0..8 * 8).map(|i| ((i % 8) as f32 + 0.5) / 8.0 + 2.0 * ((i / 8) as f32 + 0.5) / 8.0);
            let image = Arc::new(TexelImage::new(8, 8, 1, Texels::F32(values.collect())).unwrap());
            let space = ColorSpace::Raw;
            let slopes = ImageTexture::of_slopes(
                Arc::clone(&image),
                space,
                [wrap; 2],
                TextureFilter::Mip,
                SlopesOf::Heights(0),
                1,
            );
            let heights = ImageTexture::new(image, space, [wrap; 2], TextureFilter::Bilinear);
            for uv in [[0.45_f32, 0.3], [-0.4, 0.3], [1.6, 0.55], [-1.3, 2.4], [0.5, -0.7]] {
                let height = |du: f32, dv: f32| heights.at(&point([uv[0] + du, uv[1] + dv], 0.0))[0];
                let step = 0.01;
                let expected = [
                    (height(step, 0.0) - height(-step, 0.0)) / (2.0 * step),
                    (height(0.0, step) - height(0.0, -step)) / (2.0 * step),
                ];
                let [a, b, ..] = slopes.at(&point(uv, 0.0));
                assert!(
                    (a - expected[0]).abs() < 1e-3 && (b - expected[1]).abs() < 1e-3,
                    "{wrap:?} {uv:?}: {a} {b}, not {expected:?}"
                );
            }
        }
    }

    #[test]
    fn wild_normals_have_slopes() {
        for normal in [[0.5, 0.5, 0.5], [1.0, 0.0, 0.5], [0.0, 0.0, 0.0], [9.0, -9.0, 0.4]] {
            let texture = texture(SlopesOf::Normals, 3, TextureFilter::Mip, |_, _| normal);
            let [a, b, aa, bb] = texture.at(&point([0.1, 0.1], 3.0));
            assert!([a, b, aa, bb].iter().all(|x| x.is_finite()) && a.hypot(b) <= 1.01 * STEEPEST, "{a} {b}");
        }
    }
}
