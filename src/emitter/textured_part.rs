//! What a part of a lamp emits whose radiance a texture varies, for methods that divide surfaces.

use std::f32::consts::PI;
use std::sync::Arc;

use super::Emitter;
use crate::math::{DVec3, Vec3};
use crate::shape::centroids;
use crate::spectrum::Rgb;
use crate::texture::{Texture, TextureLight};

/// Points of a part along a side.
const STEPS: u32 = 16;

/// The radiance of a part of a lamp.
#[derive(Clone, Copy, Debug)]
pub struct PartRadiance {
    /// The mean over the area of the part [W m^-2 sr^-1].
    pub mean: DVec3,
    /// The mean difference from that mean, of the channel in which it is largest [W m^-2 sr^-1].
    pub deviation: f64,
}

impl Emitter {
    /// The texture that varies the radiance.
    pub fn texture(&self) -> Option<&Arc<Texture>> {
        match self {
            Self::Textured(emitter) => Some(emitter.texture()),
            Self::TexturedSphere(emitter) => Some(emitter.texture()),
            _ => None,
        }
    }

    /// The radiance of the part of a textured lamp that lies in a triangle with these corners, scene frame; on a sphere the part that is
    /// seen behind it from the centre. It is read at many points, at each as the mean over a square of texels, so that the parts of a lamp
    /// together emit the lamp's light. `light` is that of [`Emitter::texture`]. A lamp without a texture has the same radiance everywhere.
    pub fn part_radiance(&self, corners: &[DVec3; 3], light: &TextureLight) -> PartRadiance {
        let [a, b, c] = *corners;
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a)) as f32;
        let level = light.level_of(longest * self.texels_in_length() / STEPS as f32);
        let centre = self.sphere().map(|sphere| sphere.centre);
        let found: Vec<(DVec3, f64)> = centroids(STEPS)
            .map(|[s, t]| {
                let p = a + f64::from(s) * (b - a) + f64::from(t) * (c - a);
                // A small part of the triangle covers a solid angle in proportion to the inverse cube of its distance.
                let weight = centre.map_or(1.0, |centre| p.distance(centre).powi(-3));
                (self.radiance_near(p.as_vec3a(), light, level).to_f64(), weight)
            })
            .collect();
        let total: f64 = found.iter().map(|(_, weight)| weight).sum();
        let mean = found.iter().map(|(value, weight)| *weight * *value).sum::<DVec3>() / total;
        let differences = found.iter().map(|(value, weight)| *weight * (*value - mean).abs()).sum::<DVec3>();
        PartRadiance { mean, deviation: differences.max_element() / total }
    }

    /// The radiance near a point, as [`TextureLight::near`] gives it.
    fn radiance_near(&self, p: Vec3, light: &TextureLight, level: usize) -> Rgb {
        match self {
            Self::Textured(emitter) => emitter.radiance_near(p, light, level),
            Self::TexturedSphere(emitter) => emitter.radiance_near(p, light, level),
            _ => self.mean_radiance(),
        }
    }

    /// Texels of the texture in a unit of length, where they are smallest.
    fn texels_in_length(&self) -> f32 {
        match self {
            Self::Textured(emitter) => {
                let [e1, e2] = emitter.mean.triangle.sides();
                emitter.texels() / e1.length().max(e2.length()).max(e1.distance(e2))
            }
            Self::TexturedSphere(emitter) => {
                let [around, across] = emitter.texels();
                around.max(2.0 * across) / (2.0 * PI * emitter.mean.sphere.radius as f32)
            }
            _ => 0.0,
        }
    }
}
