//! Checks of cameras.

use super::json::join;
use super::validate::{number, positive, vector, within};
use super::{CameraDesc, FocusDesc, FovAxis, LensDesc, MAX_BLADES, PIXEL_ASPECTS, Panorama, SHIFTS};
use crate::math::DVec3;
use crate::{Error, Result};

/// Sine of the smallest angle at which two directions count as different.
const PARALLEL: f64 = 1e-7;

/// Least and greatest squeeze of an aperture.
const SQUEEZES: [f64; 2] = [0.01, 100.0];

/// Why a spherical camera has no shape of pixels.
pub(super) const EVERY_RESOLUTION: &str = "a spherical camera spreads all directions over any resolution";

/// Checks that a camera's position, view direction and up vector give a frame, that a pinhole can span its angle, that
/// parallel rays span a width, that the film is within reach, and that a lens has a size and is in focus in front of the camera.
pub(super) fn camera(path: &str, camera: CameraDesc) -> Result<CameraDesc> {
    let [origin, look_at, up] = camera.view();
    let at = |key: &str| join(path, key);
    vector(&at("origin"), origin)?;
    vector(&at("lookAt"), look_at)?;
    vector(&at("up"), up)?;
    if let CameraDesc::Panoramic { panorama, .. } = &camera {
        if !panorama.is_possible() {
            let message =
                format!("{} degrees are out of range, expected an angle above 0 and up to 360", panorama.fov_deg);
            return Err(Error::invalid(at("fieldOfView"), message));
        }
    } else if let Some(fov_deg) = camera.fov_deg()
        && !(fov_deg > 0.0 && fov_deg < 180.0)
    {
        let message = format!("{fov_deg} degrees are out of range, expected an angle between 0 and 180");
        return Err(Error::invalid(at("fieldOfView"), message));
    }
    if let CameraDesc::Orthographic { size, axis, .. } = camera {
        positive(&at(size_key(axis)), size)?;
    }
    if let Some(film) = camera.film() {
        let [least, most] = SHIFTS;
        for (i, shift) in film.shift.into_iter().enumerate() {
            within(&format!("{}[{i}]", at("shift")), shift, least, most)?;
        }
    }
    let [least, most] = PIXEL_ASPECTS;
    within(&at("pixelAspect"), camera.pixel_aspect(), least, most)?;
    if let CameraDesc::Panoramic { panorama, .. } = &camera
        && panorama.kind == Panorama::Spherical
        && panorama.pixel_aspect != 1.0
    {
        let message = format!("{} is out of range, {EVERY_RESOLUTION}, expected 1", panorama.pixel_aspect);
        return Err(Error::invalid(at("pixelAspect"), message));
    }
    let view = look_at - origin;
    let Some(w) = (view / view.abs().max_element()).try_normalize() else {
        return Err(Error::invalid(at("lookAt"), format!("{look_at} is the camera's origin, expected another point")));
    };
    let Some(up) = (up / up.abs().max_element()).try_normalize() else {
        return Err(Error::invalid(at("up"), "the vector is zero, expected the direction that is up in the image"));
    };
    if w.cross(up).length() < PARALLEL {
        let message = format!("the vector is parallel to the view direction {w}, expected another direction");
        return Err(Error::invalid(at("up"), message));
    }
    if let CameraDesc::ThinLens { eye, lens, .. } = &camera {
        check_lens(path, lens, |point| (point - *eye).dot(w))?;
    }
    Ok(camera)
}

/// The key of what parallel rays span across a side of the image.
pub(super) fn size_key(axis: FovAxis) -> &'static str {
    match axis {
        FovAxis::Horizontal => "width",
        FovAxis::Vertical => "height",
    }
}

/// Checks a lens; `depth` is the distance of a point along the view direction.
fn check_lens(path: &str, lens: &LensDesc, depth: impl Fn(DVec3) -> f64) -> Result<()> {
    let at = |key: &str| join(path, key);
    number(&at("lensRadius"), lens.radius)?;
    if lens.radius < 0.0 {
        let message = format!("{} is negative, expected a radius > 0, or 0 for a pinhole", lens.radius);
        return Err(Error::invalid(at("lensRadius"), message));
    }
    match lens.focus {
        FocusDesc::LookAt => {}
        FocusDesc::Distance(distance) => {
            positive(&at("focusDistance"), distance)?;
        }
        FocusDesc::Point(point) => {
            vector(&at("focusAt"), point)?;
            let depth = depth(point);
            if depth.is_nan() || depth < f64::from(f32::MIN_POSITIVE) {
                let message = format!(
                    "{point} is {depth} from the camera along the view direction, expected a point in front of it"
                );
                return Err(Error::invalid(at("focusAt"), message));
            }
        }
    }
    if !matches!(lens.blades, 0 | 3..=MAX_BLADES) {
        let message = format!(
            "an aperture has no {} blades, expected 0 for a round one, or a whole number from 3 to {MAX_BLADES}",
            lens.blades
        );
        return Err(Error::invalid(at("blades"), message));
    }
    number(&at("bladeRotation"), lens.blade_rotation_deg)?;
    let [least, most] = SQUEEZES;
    within(&at("squeeze"), lens.squeeze, least, most)?;
    Ok(())
}
