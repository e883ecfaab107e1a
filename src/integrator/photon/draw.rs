//! Draws the photons of a map as a camera sees them, as in the report's figure of its photon map.

use super::Photon;
use crate::camera::Camera;
use crate::desc::CameraDesc;
use crate::film::Image;
use crate::math::{HitPoint, Ray, Vec3};
use crate::room::{filled, with_room};
use crate::scene::Scene;
use crate::{Error, Result};

/// Grey of a surface that is seen edge-on, and the grey that is added where the surface faces the eye: dark, so that white
/// dots show, and not black, so that black dots do.
const EDGE: f32 = 0.05;
const FACING: f32 = 0.1;

/// Distance in pixels by which a photon is lifted off its surface before its visibility is tested.
const LIFT: f32 = 0.01;

/// How photons are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawSettings {
    /// Whether dots have the colour of the photons' power, scaled so that the largest channel is 1; otherwise they are
    /// white.
    pub coloured: bool,
}

/// A photon's colour by its power: linear, scaled so that the largest channel is 1; black for a shadow photon.
pub fn colour(photon: &Photon) -> [f32; 3] {
    let most = photon.power.into_iter().fold(0.0, f32::max);
    photon.power.map(|power| if most > 0.0 { power / most } else { 0.0 })
}

/// Draws photons of `scene` as seen by a camera (world frame). Each photon is a dot of one pixel, white or coloured (black
/// for shadow photons), over the scene in dark grey. The photon nearest to the eye is shown where several fall into one
/// pixel. Photons that a surface occludes, glass included, and photons on the far side of a surface are not shown. With a lens, all is drawn as sharp as through its
/// middle: dots of one pixel would be lost in the blur.
///
/// The image is meant for viewing: its values are linear in [0, 1].
///
/// # Errors
/// [`crate::ErrorKind::InvalidScene`] for a camera that makes no image, or a resolution that is not one
/// (`render.resolution`).
pub fn draw(
    scene: &Scene,
    camera: &CameraDesc,
    resolution: [u32; 2],
    photons: &[Photon],
    settings: DrawSettings,
) -> Result<Image> {
    let [width, height] = resolution;
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > crate::desc::MAX_PIXELS {
        let message = format!("{width} x {height} pixels, expected 1 to {} in all", crate::desc::MAX_PIXELS);
        return Err(Error::invalid("render.resolution", message));
    }
    let camera = Camera::new(camera, resolution, scene.centre())?;
    let mut rgb = with_room(3 * pixels as usize)?;
    let mut nearest = filled(f32::INFINITY, pixels as usize)?;
    shade(scene, &camera, resolution, &mut rgb);
    for photon in photons {
        let Some((pixel, distance)) = seen(scene, &camera, resolution, photon) else { continue };
        if distance < nearest[pixel] {
            nearest[pixel] = distance;
            let lit = if settings.coloured { colour(photon) } else { [1.0; 3] };
            rgb[3 * pixel..][..3].copy_from_slice(&if photon.is_shadow() { [0.0; 3] } else { lit });
        }
    }
    Ok(Image { width, height, rgb, ..Image::default() })
}

/// Adds the pixels of the scene in grey by how much a surface faces the eye; black where there is no surface.
fn shade(scene: &Scene, camera: &Camera, [width, height]: [u32; 2], rgb: &mut Vec<f32>) {
    for y in 0..height {
        for x in 0..width {
            let ray = camera.ray(x as f32 + 0.5, y as f32 + 0.5);
            let grey = scene.intersect(&ray).map_or(0.0, |hit| {
                let cos = scene.interaction(&ray, &hit).ns.dot(ray.direction).abs();
                EDGE + FACING * cos.min(1.0)
            });
            rgb.extend([grey; 3]);
        }
    }
}

/// The pixel in which the eye sees a photon, and its distance.
fn seen(scene: &Scene, camera: &Camera, [width, height]: [u32; 2], photon: &Photon) -> Option<(usize, f32)> {
    let p = photon.position();
    let [x, y] = camera.film_position(p)?;
    let [column, row] = [x.floor(), y.floor()];
    if !((0.0..width as f32).contains(&column) && (0.0..height as f32).contains(&row)) {
        return None;
    }
    let eye = camera.ray(x, y).origin;
    let distance = p.distance(eye);
    let normal = photon.normal.get();
    if normal.dot(eye - p) <= 0.0 {
        return None;
    }
    // The width of a pixel at the photon.
    let pixel = camera.pixel_width(x, y).at(camera.eye_distance(p));
    let from = p + normal * (LIFT * pixel).max(HitPoint::rounding_error(p, normal));
    let to_eye: Vec3 = eye - from;
    let ray = Ray::segment(from, to_eye, 1.0);
    scene.unoccluded(&ray).then(|| (row as usize * width as usize + column as usize, distance))
}
