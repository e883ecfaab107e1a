//! Conversion of cameras between the plain structure of the host and the description.

use super::boundary::read_sized;
use super::read::enumeration;
use super::status::{Failure, Result};
use super::types::*;
use crate::desc::{CameraDesc, FilmDesc, FocusDesc, FovAxis, LensDesc, Panorama, PanoramaDesc};
use crate::math::DVec3;

/// # Safety
/// The contract of [`read_sized`].
pub(super) unsafe fn camera(pointer: *const etd_camera) -> Result<CameraDesc> {
    // SAFETY: the caller keeps this function's contract.
    let it = unsafe { read_sized(pointer, "camera") }?;
    let [eye, look_at, up] = [it.origin, it.look_at, it.up].map(DVec3::from_array);
    let fov_deg = it.fov_deg;
    let fov_axis = match enumeration("camera.fov_axis", it.fov_axis)? {
        ETD_FOV_HORIZONTAL => FovAxis::Horizontal,
        ETD_FOV_VERTICAL => FovAxis::Vertical,
    };
    let lens = lens(&it)?;
    let projection = enumeration("camera.projection", it.projection)?;
    let (name, has_lens, has_size) = match projection {
        ETD_CAMERA_PERSPECTIVE => ("a perspective camera", true, false),
        ETD_CAMERA_VIEW_PLANE => ("a view-plane camera", false, false),
        ETD_CAMERA_ORTHOGRAPHIC => ("an orthographic camera", false, true),
        ETD_CAMERA_SPHERICAL => ("a spherical camera", false, false),
        ETD_CAMERA_CYLINDRICAL => ("a cylindrical camera", false, false),
        ETD_CAMERA_FISHEYE => ("a fisheye camera", false, false),
    };
    if !has_lens && let Some((field, _)) = lens {
        return Err(Failure::argument(format!("camera.{field}: {name} has no lens, expected 0")));
    }
    if !has_size && it.size != 0.0 {
        return Err(Failure::argument(format!("camera.size: {name} spans an angle, expected 0")));
    }
    let pixel_aspect = if it.pixel_aspect == 0.0 { 1.0 } else { it.pixel_aspect };
    let film = FilmDesc { shift: it.shift, pixel_aspect };
    if it.shift != [0.0; 2] && !matches!(projection, ETD_CAMERA_PERSPECTIVE | ETD_CAMERA_ORTHOGRAPHIC) {
        return Err(Failure::argument(format!("camera.shift: {name} has no film to shift, expected 0")));
    }
    if it.pixel_aspect != 0.0 && matches!(projection, ETD_CAMERA_VIEW_PLANE | ETD_CAMERA_SPHERICAL) {
        return Err(Failure::argument(format!("camera.pixel_aspect: {name} fills any resolution, expected 0")));
    }
    match projection {
        ETD_CAMERA_PERSPECTIVE => Ok(match lens {
            Some((_, lens)) => CameraDesc::ThinLens { eye, look_at, up, fov_deg, fov_axis, lens, film },
            None => CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis, film },
        }),
        ETD_CAMERA_VIEW_PLANE if fov_axis == FovAxis::Vertical => {
            Err(Failure::argument("camera.fov_axis: a view-plane camera's field of view is horizontal"))
        }
        ETD_CAMERA_VIEW_PLANE => Ok(CameraDesc::ViewPlane { centre: eye, look_at, up, fov_deg }),
        ETD_CAMERA_ORTHOGRAPHIC => {
            Ok(CameraDesc::Orthographic { eye, look_at, up, size: it.size, axis: fov_axis, film })
        }
        ETD_CAMERA_SPHERICAL => {
            let panorama = PanoramaDesc::new(Panorama::Spherical);
            Ok(CameraDesc::Panoramic { eye, look_at, up, panorama })
        }
        ETD_CAMERA_CYLINDRICAL if fov_axis == FovAxis::Vertical => {
            Err(Failure::argument("camera.fov_axis: a cylindrical camera's field of view is horizontal"))
        }
        ETD_CAMERA_CYLINDRICAL | ETD_CAMERA_FISHEYE => {
            let kind = if projection == ETD_CAMERA_FISHEYE { Panorama::Fisheye } else { Panorama::Cylindrical };
            Ok(CameraDesc::Panoramic {
                eye,
                look_at,
                up,
                panorama: PanoramaDesc { kind, fov_deg, fov_axis, pixel_aspect },
            })
        }
    }
}

/// The lens, with the name of a field that says something of it; `None` where no field does.
fn lens(it: &etd_camera) -> Result<Option<(&'static str, LensDesc)>> {
    let kind = enumeration("camera.focus", it.focus)?;
    let fields = [
        ("lens_radius", it.lens_radius != 0.0),
        ("focus", kind != ETD_FOCUS_LOOK_AT),
        ("blades", it.blades != 0),
        ("focus_distance", it.focus_distance != 0.0),
        ("focus_at", it.focus_at != [0.0; 3]),
        ("blade_rotation_deg", it.blade_rotation_deg != 0.0),
        ("squeeze", it.squeeze != 0.0),
    ];
    let Some((field, _)) = fields.into_iter().find(|(_, is_set)| *is_set) else { return Ok(None) };
    let focus = match kind {
        ETD_FOCUS_LOOK_AT => FocusDesc::LookAt,
        ETD_FOCUS_DISTANCE => FocusDesc::Distance(it.focus_distance),
        ETD_FOCUS_POINT => FocusDesc::Point(DVec3::from_array(it.focus_at)),
    };
    let squeeze = if it.squeeze == 0.0 { 1.0 } else { it.squeeze };
    let (radius, blades, blade_rotation_deg) = (it.lens_radius, it.blades, it.blade_rotation_deg);
    Ok(Some((field, LensDesc { radius, focus, blades, blade_rotation_deg, squeeze })))
}

/// Converts a camera to the host's structure.
pub(super) fn camera_out(camera: &CameraDesc) -> etd_camera {
    let [origin, look_at, up] = camera.view().map(|vector| vector.to_array());
    let (projection, axis, size) = match *camera {
        CameraDesc::Perspective { fov_axis, .. } | CameraDesc::ThinLens { fov_axis, .. } => {
            (ETD_CAMERA_PERSPECTIVE, fov_axis, 0.0)
        }
        CameraDesc::ViewPlane { .. } => (ETD_CAMERA_VIEW_PLANE, FovAxis::Horizontal, 0.0),
        CameraDesc::Orthographic { size, axis, .. } => (ETD_CAMERA_ORTHOGRAPHIC, axis, size),
        CameraDesc::Panoramic { panorama, .. } => match panorama.kind {
            Panorama::Spherical => (ETD_CAMERA_SPHERICAL, FovAxis::Horizontal, 0.0),
            Panorama::Cylindrical => (ETD_CAMERA_CYLINDRICAL, FovAxis::Horizontal, 0.0),
            Panorama::Fisheye => (ETD_CAMERA_FISHEYE, panorama.fov_axis, 0.0),
        },
    };
    let fov_axis = match axis {
        FovAxis::Horizontal => ETD_FOV_HORIZONTAL,
        FovAxis::Vertical => ETD_FOV_VERTICAL,
    };
    let without_lens = etd_camera {
        struct_size: size_of::<etd_camera>(),
        projection: projection.number(),
        fov_axis: fov_axis.number(),
        origin,
        look_at,
        up,
        fov_deg: camera.fov_deg().unwrap_or(0.0),
        size,
        lens_radius: 0.0,
        focus: ETD_FOCUS_LOOK_AT.number(),
        blades: 0,
        focus_distance: 0.0,
        focus_at: [0.0; 3],
        blade_rotation_deg: 0.0,
        squeeze: 0.0,
        shift: camera.film().unwrap_or_default().shift,
        pixel_aspect: if camera.pixel_aspect() == 1.0 { 0.0 } else { camera.pixel_aspect() },
    };
    let CameraDesc::ThinLens { lens, .. } = camera else { return without_lens };
    let (focus, focus_distance, focus_at) = match lens.focus {
        FocusDesc::LookAt => (ETD_FOCUS_LOOK_AT, 0.0, [0.0; 3]),
        FocusDesc::Distance(distance) => (ETD_FOCUS_DISTANCE, distance, [0.0; 3]),
        FocusDesc::Point(point) => (ETD_FOCUS_POINT, 0.0, point.to_array()),
    };
    etd_camera {
        lens_radius: lens.radius,
        focus: focus.number(),
        blades: lens.blades,
        focus_distance,
        focus_at,
        blade_rotation_deg: lens.blade_rotation_deg,
        squeeze: lens.squeeze,
        ..without_lens
    }
}
