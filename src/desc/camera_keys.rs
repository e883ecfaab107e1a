//! The keys of a scene's camera: reads and writes them.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::json::{self, Whole, join};
use super::numbers::unless;
use super::validate::{positive, whole};
use super::{
    CameraDesc, FilmDesc, FocusDesc, FovAxis, LensDesc, MAX_BLADES, Panorama, PanoramaDesc, SceneDesc, SceneMotion,
    camera_check, motion_keys, save,
};
use crate::math::DVec3;
use crate::{Error, Result};

/// Which kind of camera; perspective unless it says otherwise.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum CameraType {
    /// A pinhole at `origin`, or a thin lens around it.
    #[default]
    Perspective,
    /// Parallel rays from the plane through `origin`.
    Orthographic,
    /// All directions: longitude across the width, latitude across the height.
    Spherical,
    /// The mantle of an upright cylinder: `fieldOfView` across the width, and as high as square pixels make it.
    Cylindrical,
    /// A circle of `fieldOfView` by the equisolid projection, black beyond.
    Fisheye,
    /// The report's camera: `origin` is the centre of the view plane, the eye is behind it.
    ViewPlane,
}

/// The side of the image that `fieldOfView` spans.
#[derive(Clone, Copy, Default, Deserialize, Serialize, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Axis {
    /// The width.
    #[default]
    Horizontal,
    /// The height.
    Vertical,
}

/// Where the scene is seen from.
#[derive(Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Camera {
    /// `perspective` (default), `orthographic`, `spherical`, `cylindrical`, `fisheye` or `view-plane`.
    #[serde(default, deserialize_with = "json::name")]
    r#type: Option<CameraType>,
    /// The eye; with `view-plane` the centre of the view plane. Default [0, 0, 0].
    origin: Option<[f64; 3]>,
    /// A point in the middle of the image. Default [0, 0, -1].
    look_at: Option<[f64; 3]>,
    /// Upwards in the image. Default [0, 1, 0].
    up: Option<[f64; 3]>,
    /// Full angle of view across `fieldOfViewAxis`, degrees, between 0 and 180; not with `orthographic` and `spherical`. Default 90.
    /// With `cylindrical` and `fisheye` above 0 and up to 360, default 360 and 180.
    field_of_view: Option<f64>,
    /// `horizontal` (default) or `vertical`; only with `perspective`, and with `fisheye`, of which it is the side that the circle spans:
    /// there the default is `vertical`.
    #[serde(default, deserialize_with = "json::name")]
    field_of_view_axis: Option<Axis>,
    /// With `orthographic`: what the image spans across its width, scene units. It has this key or `height`.
    width: Option<f64>,
    /// With `orthographic`: what the image spans across its height, scene units.
    height: Option<f64>,
    /// With `perspective` and `orthographic`: how far the film is moved against the view axis, to the right in widths of the image and
    /// upwards in heights of the image, each -100 to 100. Default [0, 0].
    shift: Option<[f64; 2]>,
    /// Width of a pixel over its height, 0.01 to 100; not with `spherical` and `view-plane`. Default 1.
    pixel_aspect: Option<f64>,
    /// With `perspective`: radius of the lens, scene units, 0 or more. Without it and `fStop`, the camera is a pinhole.
    lens_radius: Option<f64>,
    /// In place of `lensRadius`: `focalLength` over the diameter of the lens, above 0.
    f_stop: Option<f64>,
    /// With `fStop`: the length that it divides, scene units, above 0.
    focal_length: Option<f64>,
    /// With a lens: distance of the plane in focus along the view direction, above 0. Default: the plane through `lookAt`.
    focus_distance: Option<f64>,
    /// With a lens, in place of `focusDistance`: a point of the plane in focus.
    focus_at: Option<[f64; 3]>,
    /// With a lens: sides of the aperture, a regular polygon in the circle of the lens, 3 to 32; 0 is the whole disk. Default 0.
    blades: Option<Whole>,
    /// With a lens: degrees by which the polygon is turned counter-clockwise in the image. Default 0: a vertex at the right.
    blade_rotation: Option<f64>,
    /// With a lens: what the aperture's width is divided by, 0.01 to 100. Default 1.
    squeeze: Option<f64>,
    /// When the shutter is open. Default: everything is seen at the time 0.
    shutter: Option<motion_keys::Shutter>,
    /// Keyframes, by which the camera is moved from where the other keys have it; they keep lengths. Default: it rests.
    motion: Option<Vec<motion_keys::Key>>,
}

impl Camera {
    /// The first given key of a lens.
    fn lens_key(&self) -> Option<&'static str> {
        let size = [
            ("lensRadius", self.lens_radius.is_some()),
            ("fStop", self.f_stop.is_some()),
            ("focalLength", self.focal_length.is_some()),
        ];
        size.into_iter().find(|(_, given)| *given).map(|(key, _)| key).or(self.aperture_key())
    }

    /// The first given key that says nothing of a lens's size.
    fn aperture_key(&self) -> Option<&'static str> {
        let keys = [
            ("focusDistance", self.focus_distance.is_some()),
            ("focusAt", self.focus_at.is_some()),
            ("blades", self.blades.is_some()),
            ("bladeRotation", self.blade_rotation.is_some()),
            ("squeeze", self.squeeze.is_some()),
        ];
        keys.into_iter().find(|(_, given)| *given).map(|(key, _)| key)
    }

    /// The lens; `None` for a pinhole.
    fn lens(&self, path: &str) -> Result<Option<LensDesc>> {
        let at = |key: &str| join(path, key);
        let radius = match (self.lens_radius, self.f_stop, self.focal_length) {
            (Some(radius), None, None) => radius,
            (Some(_), _, _) => {
                let other = if self.f_stop.is_some() { "fStop" } else { "focalLength" };
                return Err(Error::invalid(at(other), "the size of the lens is given by `lensRadius` already"));
            }
            (None, Some(f_stop), Some(focal_length)) => {
                positive(&at("focalLength"), focal_length)? / (2.0 * positive(&at("fStop"), f_stop)?)
            }
            (None, Some(_), None) => {
                let message = "says nothing of a size by itself, expected `focalLength` with it, or `lensRadius`";
                return Err(Error::invalid(at("fStop"), message));
            }
            (None, None, Some(_)) => {
                let message = "gives the size of the lens only with `fStop`, and never the angle of view";
                return Err(Error::invalid(at("focalLength"), message));
            }
            (None, None, None) => {
                return match self.aperture_key() {
                    Some(key) => {
                        let message =
                            "a pinhole has no aperture and is in focus everywhere, expected `lensRadius` with it";
                        Err(Error::invalid(at(key), message))
                    }
                    None => Ok(None),
                };
            }
        };
        let focus = match (self.focus_distance, self.focus_at) {
            (None, None) => FocusDesc::LookAt,
            (Some(distance), None) => FocusDesc::Distance(distance),
            (None, Some(point)) => FocusDesc::Point(DVec3::from_array(point)),
            (Some(_), Some(_)) => {
                return Err(Error::invalid(at("focusAt"), "the plane in focus is given by `focusDistance` already"));
            }
        };
        let blades = self.blades.map_or(Ok(0), |blades| whole(&at("blades"), blades, 0, u64::from(MAX_BLADES)))?;
        let blade_rotation_deg = self.blade_rotation.unwrap_or(0.0);
        Ok(Some(LensDesc { radius, focus, blades, blade_rotation_deg, squeeze: self.squeeze.unwrap_or(1.0) }))
    }

    /// The flat film.
    fn film(&self) -> FilmDesc {
        let default = FilmDesc::default();
        FilmDesc {
            shift: self.shift.unwrap_or(default.shift),
            pixel_aspect: self.pixel_aspect.unwrap_or(default.pixel_aspect),
        }
    }

    /// What parallel rays span, and across which side.
    fn span(&self, path: &str) -> Result<(f64, FovAxis)> {
        match (self.width, self.height) {
            (Some(width), None) => Ok((width, FovAxis::Horizontal)),
            (None, Some(height)) => Ok((height, FovAxis::Vertical)),
            (Some(_), Some(_)) => {
                let message = "follows from `width` and the resolution, expected only one of them";
                Err(Error::invalid(join(path, "height"), message))
            }
            (None, None) => Err(Error::invalid(path, "missing key `width`, or `height`")),
        }
    }

    /// Refuses keys that mean nothing to this type of camera.
    fn refuse(&self, path: &str, kind: CameraType) -> Result<()> {
        let err = |key: &str, message: &str| Err(Error::invalid(join(path, key), message));
        let name = match kind {
            CameraType::Perspective => "a perspective camera",
            CameraType::Orthographic => "an orthographic camera",
            CameraType::Spherical => "a spherical camera",
            CameraType::Cylindrical => "a cylindrical camera",
            CameraType::Fisheye => "a fisheye camera",
            CameraType::ViewPlane => "a view-plane camera",
        };
        let is_spherical = matches!(kind, CameraType::Spherical);
        if is_spherical && self.field_of_view.is_some() {
            return err("fieldOfView", &format!("{name} sees all directions, expected no angle"));
        }
        if self.field_of_view_axis.is_some() && (is_spherical || matches!(kind, CameraType::Cylindrical)) {
            return err("fieldOfViewAxis", &format!("the angle of {name} spans the width, expected no axis"));
        }
        let is_orthographic = matches!(kind, CameraType::Orthographic);
        for (key, value) in [("width", self.width), ("height", self.height)] {
            if value.is_some() && !is_orthographic {
                return err(key, &format!("{name} spans an angle, expected `fieldOfView`"));
            }
        }
        if is_orthographic {
            for (key, given) in
                [("fieldOfView", self.field_of_view.is_some()), ("fieldOfViewAxis", self.field_of_view_axis.is_some())]
            {
                if given {
                    return err(key, &format!("the rays of {name} are parallel, expected `width` or `height`"));
                }
            }
        }
        if self.shift.is_some() && !matches!(kind, CameraType::Perspective | CameraType::Orthographic) {
            return err("shift", &format!("{name} has no film to shift, expected a perspective or orthographic one"));
        }
        if self.pixel_aspect.is_some() {
            match kind {
                CameraType::Spherical => {
                    return err("pixelAspect", &format!("{}, expected no such key", camera_check::EVERY_RESOLUTION));
                }
                CameraType::ViewPlane => {
                    return err("pixelAspect", &format!("the plane of {name} follows from the resolution alone"));
                }
                _ => {}
            }
        }
        if let Some(key) = self.lens_key()
            && !matches!(kind, CameraType::Perspective)
        {
            return err(key, &format!("{name} has no lens, expected a perspective one"));
        }
        Ok(())
    }
}

/// Reads a camera, its motion and its shutter into a scene.
pub(super) fn read(raw: &RawValue, path: &str, scene: &mut SceneDesc) -> Result<()> {
    let mut keys: Camera = json::object(raw, path)?;
    scene.set_shutter(motion_keys::shutter(keys.shutter.take()))?;
    if let Some(motion) = keys.motion.take() {
        scene.set_camera_motion(Some(motion_keys::motion(motion, &join(path, "motion"))?))?;
    }
    scene.camera = camera(&keys, path)?;
    Ok(())
}

fn camera(camera: &Camera, path: &str) -> Result<CameraDesc> {
    let eye = DVec3::from_array(camera.origin.unwrap_or_default());
    let look_at = camera.look_at.map_or(DVec3::NEG_Z, DVec3::from_array);
    let up = camera.up.map_or(DVec3::Y, DVec3::from_array);
    let fov_deg = camera.field_of_view.unwrap_or(90.0);
    let fov_axis = match camera.field_of_view_axis.unwrap_or_default() {
        Axis::Horizontal => FovAxis::Horizontal,
        Axis::Vertical => FovAxis::Vertical,
    };
    let kind = camera.r#type.unwrap_or_default();
    camera.refuse(path, kind)?;
    let film = camera.film();
    match kind {
        CameraType::Perspective => {
            let described = match camera.lens(path)? {
                None => CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis, film },
                Some(lens) => CameraDesc::ThinLens { eye, look_at, up, fov_deg, fov_axis, lens, film },
            };
            camera_check::camera(path, described)
        }
        CameraType::Orthographic => {
            let (size, axis) = camera.span(path)?;
            camera_check::camera(path, CameraDesc::Orthographic { eye, look_at, up, size, axis, film })
        }
        CameraType::Spherical | CameraType::Cylindrical | CameraType::Fisheye => {
            let default = PanoramaDesc::new(match kind {
                CameraType::Cylindrical => Panorama::Cylindrical,
                CameraType::Fisheye => Panorama::Fisheye,
                _ => Panorama::Spherical,
            });
            let panorama = PanoramaDesc {
                fov_deg: camera.field_of_view.unwrap_or(default.fov_deg),
                fov_axis: if camera.field_of_view_axis.is_some() { fov_axis } else { default.fov_axis },
                pixel_aspect: film.pixel_aspect,
                ..default
            };
            camera_check::camera(path, CameraDesc::Panoramic { eye, look_at, up, panorama })
        }
        CameraType::ViewPlane => {
            let described = CameraDesc::ViewPlane { centre: eye, look_at, up, fov_deg };
            let described = camera_check::camera(path, described)?;
            if fov_axis == FovAxis::Vertical {
                let message = "a view-plane camera's field of view is horizontal";
                return Err(Error::invalid(join(path, "fieldOfViewAxis"), message));
            }
            Ok(described)
        }
    }
}

/// Writes a camera, whose numbers have been checked, with its motion and shutter.
pub(super) fn write(camera: &CameraDesc, motion: &SceneMotion) -> Result<Box<RawValue>> {
    let [origin, look_at, up] = camera.view().map(|vector| Some(vector.to_array()));
    let mut keys = Camera {
        origin,
        look_at,
        up,
        field_of_view: camera.fov_deg(),
        shift: camera
            .film()
            .map(|film| film.shift)
            .filter(|shift| shift.iter().any(|side| unless(*side, 0.0).is_some())),
        pixel_aspect: unless(camera.pixel_aspect(), 1.0),
        shutter: motion_keys::write_shutter(&motion.shutter),
        motion: motion.camera.as_deref().map(motion_keys::write_motion),
        ..Camera::default()
    };
    let vertical = |axis| (axis == FovAxis::Vertical).then_some(Axis::Vertical);
    keys.r#type = Some(match *camera {
        CameraDesc::Perspective { fov_axis, .. } => {
            keys.field_of_view_axis = vertical(fov_axis);
            CameraType::Perspective
        }
        CameraDesc::ThinLens { fov_axis, lens, .. } => {
            keys.field_of_view_axis = vertical(fov_axis);
            keys.lens_radius = Some(lens.radius);
            match lens.focus {
                FocusDesc::LookAt => {}
                FocusDesc::Distance(distance) => keys.focus_distance = Some(distance),
                FocusDesc::Point(point) => keys.focus_at = Some(point.to_array()),
            }
            keys.blades = (lens.blades != 0).then_some(Whole(u64::from(lens.blades)));
            keys.blade_rotation = unless(lens.blade_rotation_deg, 0.0);
            keys.squeeze = unless(lens.squeeze, 1.0);
            CameraType::Perspective
        }
        CameraDesc::Orthographic { size, axis, .. } => {
            match axis {
                FovAxis::Horizontal => keys.width = Some(size),
                FovAxis::Vertical => keys.height = Some(size),
            }
            CameraType::Orthographic
        }
        CameraDesc::Panoramic { panorama, .. } => match panorama.kind {
            Panorama::Spherical => {
                keys.field_of_view = None;
                CameraType::Spherical
            }
            Panorama::Cylindrical => CameraType::Cylindrical,
            Panorama::Fisheye => {
                keys.field_of_view_axis = (panorama.fov_axis == FovAxis::Horizontal).then_some(Axis::Horizontal);
                CameraType::Fisheye
            }
        },
        CameraDesc::ViewPlane { .. } => CameraType::ViewPlane,
    });
    save::raw(&keys)
}
