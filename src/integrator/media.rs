//! Paths through media: surfaces that are hidden in a medium, and the light that a medium absorbs.
//!
//! A path knows the media that it is in: [`PathMedia`], or `None` in scenes without media, where every question ends at once. Where it arrives at a surface at which the medium does not change, it
//! goes on behind the surface; this is no vertex. Shadow rays do the same, so that light samples and Bsdf samples find the same
//! lamps.

use super::tracer::Tracer;
use super::vertex::Vertex;
use crate::math::Ray;
use crate::scene::{Hit, PathMedia, Scene};
use crate::spectrum::Spectrum;

/// Traces a path's ray: the nearest surface that is not hidden in the media that the path is in.
#[inline(always)]
pub(super) fn arrive<T: Tracer>(
    scene: &Scene,
    tracer: &mut T,
    ray: &Ray,
    media: &mut Option<PathMedia>,
) -> Option<Hit> {
    let hit = tracer.intersect(ray);
    match media {
        Some(media) => seen(scene, tracer, ray, hit, media),
        None => hit,
    }
}

/// The nearest surface that is not hidden, from the nearest one of all. `media` become those in which the ray arrives.
#[cold]
#[inline(never)]
pub(super) fn seen<T: Tracer>(
    scene: &Scene,
    tracer: &mut T,
    ray: &Ray,
    hit: Option<Hit>,
    media: &mut PathMedia,
) -> Option<Hit> {
    let mut next = hit;
    while let Some(hit) = next {
        let Some(behind) = scene.behind_hidden(ray, &hit, media) else { break };
        *media = behind;
        // The segment begins just behind the hit and has the same origin, so that no distance is rounded anew.
        next = tracer.intersect(&Ray { tnear: hit.t.next_up().max(f32::MIN_POSITIVE), ..*ray });
    }
    next
}

/// The share of light that is left at the end of a path's ray, which arrived in `media` or left the scene.
#[inline]
pub(super) fn left_after<C: Spectrum>(
    scene: &Scene,
    ray: &Ray,
    hit: Option<&Hit>,
    media: Option<PathMedia>,
    wavelengths: &C::Wavelengths,
) -> C {
    let Some(media) = media.filter(|media| !media.is_empty()) else { return C::ONE };
    let length = hit.map_or(f32::INFINITY, |hit| hit.t * ray.direction.length());
    scene.transmittance(media, length, wavelengths)
}

/// The light that arrives along a shadow ray in `media`, where the ray brings `light` if nothing is in its way. `is_clear` says
/// whether no surface is in its way at all.
#[cold]
#[inline(never)]
pub(super) fn light_through<T: Tracer, C: Spectrum>(
    scene: &Scene,
    tracer: &mut T,
    shadow: &Ray,
    media: PathMedia,
    is_clear: bool,
    light: C,
    wavelengths: &C::Wavelengths,
) -> Option<C> {
    if media.is_empty() {
        return is_clear.then_some(light);
    }
    if !is_clear {
        let mut on_the_way = media;
        let first = tracer.intersect(shadow);
        if seen(scene, tracer, shadow, first, &mut on_the_way).is_some() {
            return None;
        }
    }
    let length = shadow.tfar * shadow.direction.length();
    Some(light * scene.transmittance::<C>(media, length, wavelengths))
}

impl<C: Spectrum> Vertex<'_, C> {
    /// The media that a path is in after it left the vertex into `direction`.
    #[inline(always)]
    pub fn media_beyond(&self, scene: &Scene, ray: &Ray) -> Option<PathMedia> {
        // The arguments are values, since a reference to the vertex would keep all of it in memory.
        match self.media {
            Some(media) => {
                let front = self.wo_scene().dot(self.surface.ng) > 0.0;
                let crosses = (ray.direction.dot(self.surface.ng) > 0.0) != front;
                Some(if crosses { scene.media_behind(media, self.surface.material, front) } else { media })
            }
            None => None,
        }
    }

    /// The light that a shadow ray of this vertex brings; `None` where a surface occludes the ray.
    #[inline(always)]
    pub fn unoccluded<T: Tracer>(&self, scene: &Scene, tracer: &mut T, shadow: &Ray, light: C) -> Option<C> {
        let is_clear = tracer.unoccluded(shadow);
        match self.media_beyond(scene, shadow) {
            Some(media) => light_through(scene, tracer, shadow, media, is_clear, light, &self.wavelengths),
            None => is_clear.then_some(light),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::desc;
    use crate::math::{DVec3, Vec3};
    use crate::scene::BuildOptions;
    use crate::spectrum::Rgb;

    /// Balls of water, glass and air in a room, which overlap: the air has the highest priority. A lamp and a diffuse ball are in the
    /// water. The camera is at height `z` on the axis z.
    pub(in crate::integrator) fn aquarium(z: f64) -> String {
        serde_json::json!({
            "etendue": 1,
            "camera": {"origin": [0, 0, z], "lookAt": [0, -0.4, -0.2], "fieldOfView": 70},
            "materials": [
                {"name": "white", "type": "diffuse", "color": [0.7, 0.7, 0.7]},
                {"name": "water", "type": "refractive", "refractionIndex": 1.33, "absorption": [0.5, 0.2, 0.1], "priority": 1},
                {"name": "glass", "type": "refractive", "refractionIndex": 1.5, "transmittance": [0.9, 0.5, 1],
                    "transmittanceDistance": 0.5},
                {"name": "air", "type": "refractive", "refractionIndex": 1, "priority": 9},
            ],
            "surfaces": [
                {"geometry": "quad", "material": "white", "vertex-1": [-3, -1.5, 3], "vertex-2": [3, -1.5, 3],
                    "vertex-3": [3, -1.5, -3], "vertex-4": [-3, -1.5, -3]},
                {"geometry": "quad", "vertex-1": [-2, 2, -2], "vertex-2": [2, 2, -2], "vertex-3": [2, 2, 2],
                    "vertex-4": [-2, 2, 2], "emission": [2, 2, 2]},
                {"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "water"},
                {"geometry": "sphere", "origin": [0.8, 0, 0], "radius": 0.6, "material": "glass"},
                {"geometry": "sphere", "origin": [-0.5, 0.1, 0], "radius": 0.3, "material": "air"},
                {"geometry": "sphere", "origin": [0, -0.5, 0.1], "radius": 0.2, "material": "white"},
                {"geometry": "sphere", "origin": [0.1, 0.6, -0.2], "radius": 0.1, "emission": [5, 4, 3]},
            ],
        })
        .to_string()
    }

    /// A square of water above a basin, and a glass ball and a lamp in it. The camera is at the height `y`.
    pub(in crate::integrator) fn pond(y: f64) -> String {
        serde_json::json!({
            "etendue": 1,
            "camera": {"origin": [0, y, 0], "lookAt": [0.3, -1, -0.4], "fieldOfView": 70},
            "materials": [
                {"name": "stone", "type": "diffuse", "color": [0.7, 0.7, 0.7]},
                {"name": "water", "type": "refractive", "refractionIndex": 1.33, "absorption": [0.5, 0.2, 0.1]},
                {"name": "glass", "type": "refractive", "refractionIndex": 1.5},
            ],
            "surfaces": [
                {"geometry": "mesh", "material": "stone",
                    "positions": [[-2, 0.3, -2], [2, 0.3, -2], [2, 0.3, 2], [-2, 0.3, 2],
                        [-2, -1, -2], [2, -1, -2], [2, -1, 2], [-2, -1, 2]],
                    "triangles": [[4, 6, 5], [4, 7, 6], [0, 4, 5], [0, 5, 1], [1, 5, 6], [1, 6, 2],
                        [2, 6, 7], [2, 7, 3], [3, 7, 4], [3, 4, 0]]},
                {"geometry": "quad", "material": "water", "vertex-1": [-2, 0, 2], "vertex-2": [2, 0, 2],
                    "vertex-3": [2, 0, -2], "vertex-4": [-2, 0, -2]},
                {"geometry": "sphere", "origin": [-1, -0.6, 0.5], "radius": 0.15, "emission": [5, 4, 3]},
                {"geometry": "sphere", "origin": [1, -0.5, -1], "radius": 0.3, "material": "glass"},
                {"geometry": "quad", "vertex-1": [-1, 3, -1], "vertex-2": [1, 3, -1], "vertex-3": [1, 3, 1],
                    "vertex-4": [-1, 3, 1], "emission": [5, 5, 5]},
            ],
        })
        .to_string()
    }

    fn build(text: &str) -> Scene {
        let desc = desc::parse(text, "".as_ref(), None).unwrap();
        Scene::build(&desc, &BuildOptions::default()).unwrap()
    }

    /// What the medium at a point leaves of light after the distance 1.
    fn left(scene: &Scene, [x, y, z]: [f64; 3]) -> Rgb {
        let ray = Ray::new(scene.to_scene(DVec3::new(x, y, z)), Vec3::Z);
        scene.transmittance(scene.media_at(&ray).unwrap(), 1.0, &())
    }

    #[test]
    fn probes_find_the_medium_that_fills_a_point() {
        let scene = build(&aquarium(2.6));
        let water = Rgb::new((-0.5_f32).exp(), (-0.2_f32).exp(), (-0.1_f32).exp());
        let glass = Rgb::new(0.81, 0.25, 1.0);
        let cases = [
            ([0.0, 0.0, 2.6], Rgb::ONE),
            ([5.0, 0.0, 0.0], Rgb::ONE),
            ([0.0, 0.0, 0.5], water),
            // In the overlap with glass and outside of it, and in the air.
            ([0.6, 0.0, 0.1], water),
            ([1.2, 0.0, 0.1], glass),
            ([-0.5, 0.1, 0.0], Rgb::ONE),
        ];
        for (p, expected) in cases {
            let found = left(&scene, p);
            assert!((found - expected).abs().max_element() < 1e-6, "{p:?}: {found:?}, expected {expected:?}");
        }
    }

    #[test]
    fn a_pond_is_open_and_has_an_inside_all_the_same() {
        let scene = build(&pond(-0.5));
        let water = Rgb::new((-0.5_f32).exp(), (-0.2_f32).exp(), (-0.1_f32).exp());
        for i in 0..40 {
            let (x, z) = (1.9 * f64::from(i * 13 % 40) / 20.0 - 1.9, 1.9 * f64::from(i) / 20.0 - 1.9);
            for (y, expected) in [(-0.999, water), (-0.1, water), (0.1, Rgb::ONE), (2.5, Rgb::ONE), (-1.2, Rgb::ONE)] {
                assert_eq!(left(&scene, [x, y, z]), expected, "{x}, {y}, {z}");
            }
        }
        assert_eq!(left(&scene, [1.0, -0.5, -1.0]), Rgb::ONE, "in the glass ball");
        assert_eq!(left(&scene, [1.0, -0.5, -0.65]), water, "beside the glass ball");
    }

    #[test]
    fn a_scene_without_absorption_and_priorities_has_no_media() {
        let text = pond(1.0).replace("[0.5,0.2,0.1]", "[0,0,0]");
        let scene = build(&text);
        assert!(!scene.has_media() && !scene.has_absorption());
        assert!(scene.info().switched_off.contains(&"media"));
        assert!(build(&pond(1.0)).info().decisions.iter().any(|line| line.contains("1 materials absorb")));
    }
}
