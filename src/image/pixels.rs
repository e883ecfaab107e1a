//! An image as plain floats.

/// Where an image lies in the picture of which it is a part, and what its pixels look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Column and row of the picture that are the image's first, from the top left.
    pub origin: [u32; 2],
    /// Width and height of the picture, pixels.
    pub picture: [u32; 2],
    /// Width of a pixel over its height, above 0.
    pub pixel_aspect: f32,
}

/// Scene-linear pixels and further layers. Row 0 is on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `[height][width][3]`, radiance [W m^-2 sr^-1], Rec. 709 primaries, linear.
    pub rgb: Vec<f32>,
    /// Further layers of the same size, in a fixed order.
    pub layers: Vec<Layer>,
    /// Where the image lies in a picture; `None` for a whole picture of square pixels. OpenEXR keeps it, other formats do not.
    pub placement: Option<Placement>,
}

/// One auxiliary layer of an [`Image`].
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name of the quantity, such as `albedo`, `normal`, `depth`, `samples`, `variance` or `CryptoObject00`.
    pub name: String,
    /// Values per pixel: 1, 3 or 4.
    pub channels: usize,
    /// `[height][width][channels]`.
    pub data: Vec<f32>,
}

impl Image {
    /// The pixel at column `x` of row `y`; both must be inside.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 3] {
        let i = 3 * (y as usize * self.width as usize + x as usize);
        [self.rgb[i], self.rgb[i + 1], self.rgb[i + 2]]
    }

    /// The layer of that name.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// Mean of each channel over all pixels, summed in double precision.
    pub fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0_f64; 3];
        for pixel in self.rgb.chunks_exact(3) {
            for (sum, &value) in sum.iter_mut().zip(pixel) {
                *sum += f64::from(value);
            }
        }
        sum.map(|sum| sum / (self.rgb.len() / 3).max(1) as f64)
    }
}
