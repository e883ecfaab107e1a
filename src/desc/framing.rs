//! A camera and a light for scenes whose files have none.

use super::environment::EnvironmentDesc;
use super::{CameraDesc, FilmDesc, FovAxis, SceneDesc, ShapeDesc};
use crate::math::{Bounds, DVec3};
use crate::spectrum::Rgb;

/// Angle of view across the height of the image, degrees: that of a lens a little longer than a normal one, so that near parts are
/// not distorted.
const FIELD_OF_VIEW: f64 = 40.0;
/// Direction from the middle of the scene to the eye: a three-quarter view, 35 degrees to the right of the front and 25 degrees
/// above it, where the front is towards +z and up is +y.
const AZIMUTH: f64 = 35.0;
const ELEVATION: f64 = 25.0;
/// Room around the scene.
const MARGIN: f64 = 1.05;

/// Makes a camera that sees the ball around all surfaces in a three-quarter view with +y up. In an image that is higher than wide,
/// the ball's sides are outside.
pub(super) fn frame(scene: &mut SceneDesc) {
    let (centre, radius) = ball(scene);
    let (azimuth, elevation) = (AZIMUTH.to_radians(), ELEVATION.to_radians());
    let towards = DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
    let distance = MARGIN * radius / (0.5 * FIELD_OF_VIEW.to_radians()).sin();
    scene.camera = CameraDesc::Perspective {
        eye: centre + distance * towards,
        look_at: centre,
        up: DVec3::Y,
        fov_deg: FIELD_OF_VIEW,
        fov_axis: FovAxis::Vertical,
        film: FilmDesc::default(),
    };
}

/// Gives a scene without lights an even sky of radiance 1. Surfaces that emit no more than the sky glow, as a lit display does, and
/// are not there to light what is around them: many files have some, with 1 as the most that glTF's `emissiveFactor` can say.
pub(super) fn light(scene: &mut SceneDesc) {
    let is_lamp = |emission: Option<Rgb>| emission.is_some_and(|radiance| radiance.max_element() > 1.0);
    let used = scene.used_materials();
    let materials = scene.materials.iter().zip(used);
    let is_lit = !scene.lights.is_empty()
        || !scene.distant_lights.is_empty()
        || scene.environment.is_some()
        || materials.into_iter().any(|(material, used)| used && is_lamp(material.emission))
        || scene.surfaces.iter().any(|surface| !surface.hidden && is_lamp(surface.emission));
    if !is_lit {
        scene.environment = Some(EnvironmentDesc { path: "environment".to_owned(), ..EnvironmentDesc::even(Rgb::ONE) });
    }
}

/// The ball around all surfaces: the middle of their box, and the distance to the farthest point.
fn ball(scene: &SceneDesc) -> (DVec3, f64) {
    let corners = |Bounds { min, max }: Bounds| {
        let axis = move |i: usize, bit: usize| if i >> bit & 1 == 1 { max[bit] } else { min[bit] };
        (0..8).map(move |i| DVec3::new(axis(i, 0), axis(i, 1), axis(i, 2)))
    };
    // Of meshes each vertex is looked at, of other shapes the corners of their boxes.
    let each = |take: &mut dyn FnMut(DVec3)| {
        for surface in scene.surfaces.iter().filter(|surface| !surface.hidden) {
            let to_world = surface.to_world();
            let mesh = match surface.shape {
                ShapeDesc::Mesh { mesh, .. } => scene.meshes.get(mesh),
                _ => None,
            };
            match mesh {
                Some(mesh) => {
                    (0..mesh.vertex_count()).for_each(|vertex| take(to_world.transform_point3(mesh.position(vertex))));
                }
                None => {
                    let bounds = surface.shape.extent(|_| Bounds::EMPTY);
                    corners(bounds).for_each(|corner| take(to_world.transform_point3(corner)));
                }
            }
        }
    };
    let mut bounds = Bounds::EMPTY;
    each(&mut |point| {
        if point.is_finite() {
            bounds = bounds.include(point);
        }
    });
    let centre = 0.5 * bounds.min + 0.5 * bounds.max;
    if !centre.is_finite() {
        return (DVec3::ZERO, 1.0);
    }
    let mut radius = 0.0_f64;
    each(&mut |point| {
        if point.is_finite() {
            radius = radius.max(point.distance(centre));
        }
    });
    // A scene of one point is seen from somewhere, too.
    (centre, if radius > 0.0 { radius } else { 1.0 })
}
