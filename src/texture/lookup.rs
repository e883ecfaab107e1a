//! Where a texture coordinate lies in an image, and the filters by name.

/// What lies beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image in a mirror, and so on.
    Mirror,
    /// The texels of its edge.
    Clamp,
    /// Nothing: black without opacity.
    Black,
}

impl Wrap {
    /// The column (or row) of `n` that lies at `i`; `None` where nothing does.
    #[inline]
    pub(super) fn place(self, i: i64, n: u32) -> Option<u32> {
        let count = i64::from(n);
        let within = match self {
            // Most are in range; a division takes long.
            Self::Repeat if (0..count).contains(&i) => i,
            Self::Repeat => i.rem_euclid(count),
            Self::Mirror => {
                let i = i.rem_euclid(2 * count);
                i.min(2 * count - 1 - i)
            }
            Self::Clamp => i.clamp(0, count - 1),
            Self::Black => {
                if i < 0 || i >= count {
                    return None;
                }
                i
            }
        };
        Some(within as u32)
    }
}

/// How the value of a pixel comes from texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TextureFilter {
    /// The nearest texel.
    Nearest,
    /// Linear between the four nearest texels; unbiased, since a pixel's samples average over the pixel.
    #[default]
    Bilinear,
    /// From two levels of smaller and smaller images, by the larger axis of the footprint (Williams 1983); blurs what is seen at an angle.
    Mip,
    /// A Gaussian over the elliptical footprint, in the level where the shorter axis is a texel or more (Greene and Heckbert 1986).
    Ewa,
    /// One texel of the full image, drawn from that Gaussian (Pharr, Wronski, Salvi, Fajardo 2024): nearly the mean of `Ewa` with one read,
    /// and noise.
    Stochastic,
}

impl TextureFilter {
    /// Whether the filter reads levels of smaller and smaller images.
    pub(crate) fn has_levels(self) -> bool {
        matches!(self, Self::Mip | Self::Ewa)
    }

    /// Whether the filter depends on the footprint of a pixel.
    pub fn asks_footprint(self) -> bool {
        matches!(self, Self::Mip | Self::Ewa | Self::Stochastic)
    }
}
