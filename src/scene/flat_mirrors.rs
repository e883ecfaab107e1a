//! Flat mirrors: the planes in which lamps are seen a second time.

use super::geometry::Geometry;
use super::hit::Hit;
use super::{Facet, Material, Scene};
use crate::bsdf::{Lobes, Model, TransportMode};
use crate::emitter::Receiver;
use crate::math::{DVec3, HitPoint, Ray, Vec3};
use crate::spectrum::Spectrum;

/// Most planes that lamps are looked for in, and most mirrors in each. The largest come first.
const MOST_PLANES: usize = 4;
const MOST_PANES: usize = 64;

/// A mesh of more triangles is taken for a curved one, and is not looked at.
const MOST_TRIANGLES: usize = 64;

/// No more mirrors than this are looked at, and no more planes gathered, before the largest are chosen.
const MOST_LOOKED_AT: usize = 4096;
const MOST_GATHERED: usize = 64;

/// Triangles are in one plane where their normals differ by no more than this, and all of their corners are in it.
const SAME_NORMAL: f64 = 1e-6;

/// A triangle is too narrow, or too small for its distance from the origin, where the kernel's error is a larger share of its longest side.
const LARGEST_ERROR: f64 = 1e-4;

/// The flat mirrors of a scene, by planes: triangles at rest with a material that reflects perfectly, has no other lobe, and is the same
/// everywhere. Balls, meshes with interpolated normals, and what moves are not among them.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlatMirrors {
    planes: Box<[Plane]>,
    /// The geometry and the primitive of each mirror, in rising order, and its plane.
    known: Box<[([u32; 2], usize)]>,
}

/// The mirrors in one plane.
#[derive(Clone, Debug)]
struct Plane {
    /// Unit normal of the plane, and its distance from the origin along it.
    normal: DVec3,
    offset: f64,
    panes: Vec<Pane>,
}

/// A triangle that is a mirror.
#[derive(Clone, Debug)]
struct Pane {
    material: u32,
    /// Its geometry and its primitive, as hits have them.
    key: [u32; 2],
    /// Unit normals in the plane against the sides, pointing inwards, and their distances from the origin.
    sides: [(DVec3, f64); 3],
    /// Whether the plane's normal points to the triangle's outer side.
    faces_out: bool,
    area: f64,
    /// Bound on the distance of the triangle from the plane, as a kernel knows it: [`HitPoint::error`].
    error: f32,
}

/// A triangle that may become one.
struct Candidate {
    material: u32,
    key: [u32; 2],
    corners: [DVec3; 3],
    /// Unit normal by the order of the corners, and on the outer side.
    normal: DVec3,
    outer: Vec3,
    area: f64,
    /// Greatest error bound of [`HitPoint`] at the corners.
    error: f32,
}

/// A place of a mirror in which a point is seen.
pub(crate) struct Reflection {
    /// The place.
    point: HitPoint,
    /// Unit normal of the mirror on the side from which the point is seen.
    normal: Vec3,
    material: u32,
    faces_out: bool,
}

impl Plane {
    /// The distance of a point from the plane, on the side of its normal.
    #[inline]
    fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }

    fn area(&self) -> f64 {
        self.panes.iter().map(|pane| pane.area).sum()
    }

    /// Adds a triangle; whether it lies in the plane.
    fn take(&mut self, candidate: &Candidate) -> bool {
        let Candidate { material, key, corners, normal, outer, area, error } = *candidate;
        let size = corners.iter().fold(0.0, |size: f64, corner| size.max(corner.abs().max_element()));
        let height = corners.iter().fold(0.0, |most: f64, corner| most.max(self.height(*corner).abs()));
        if 1.0 - normal.dot(self.normal).abs() > SAME_NORMAL || height > 4.0 * f64::from(f32::EPSILON) * size {
            return false;
        }
        if self.panes.len() < MOST_PANES {
            let [a, b, c] = corners;
            let side = |from: DVec3, to: DVec3| {
                let inwards = normal.cross(to - from).normalize();
                (inwards, inwards.dot(from))
            };
            let sides = [side(a, b), side(b, c), side(c, a)];
            let faces_out = self.normal.dot(outer.as_dvec3()) > 0.0;
            self.panes.push(Pane { material, key, sides, faces_out, area, error: error + height as f32 });
        }
        true
    }
}

impl FlatMirrors {
    fn new(scene: &Scene) -> Self {
        let mut candidates = candidates(scene);
        candidates.sort_by(|a, b| b.area.total_cmp(&a.area));
        let mut planes: Vec<Plane> = Vec::new();
        for candidate in &candidates {
            if planes.iter_mut().any(|plane| plane.take(candidate)) || planes.len() == MOST_GATHERED {
                continue;
            }
            let Candidate { normal, corners, .. } = *candidate;
            let mut plane = Plane { normal, offset: normal.dot(corners[0]), panes: Vec::new() };
            if plane.take(candidate) {
                planes.push(plane);
            }
        }
        planes.sort_by(|a, b| b.area().total_cmp(&a.area()));
        planes.truncate(MOST_PLANES);
        let keys = |(number, plane): (usize, &Plane)| {
            plane.panes.iter().map(move |pane| (pane.key, number)).collect::<Vec<_>>()
        };
        let mut known: Vec<_> = planes.iter().enumerate().flat_map(keys).collect();
        known.sort_unstable();
        Self { planes: planes.into(), known: known.into() }
    }

    /// The number of planes.
    #[inline]
    pub fn count(&self) -> usize {
        self.planes.len()
    }

    /// The number of the plane of the mirror that was hit; `None` where it is none of those that are looked at.
    #[inline]
    pub fn plane_of(&self, hit: &Hit) -> Option<usize> {
        let key = [hit.geometry, hit.primitive];
        let place = self.known.binary_search_by_key(&key, |(key, _)| *key).ok()?;
        Some(self.known[place].1)
    }

    /// The receiver's image in a plane.
    #[inline]
    pub fn image(&self, plane: usize, receiver: Receiver) -> Receiver {
        let Plane { normal, offset, .. } = &self.planes[plane];
        let p = receiver.p.as_dvec3();
        let p = (p - 2.0 * (normal.dot(p) - offset) * normal).as_vec3a();
        match receiver.normal() {
            Some(n) => Receiver::facing(p, self.turn(plane, n)),
            None => p.into(),
        }
    }

    /// The image of a direction in a plane.
    #[inline]
    pub fn turn(&self, plane: usize, w: Vec3) -> Vec3 {
        let normal = self.planes[plane].normal.as_vec3a();
        w - 2.0 * normal.dot(w) * normal
    }

    /// The place of a mirror in this plane in which `p` sees `target`; `None` where there is no mirror.
    #[inline]
    pub fn between(&self, plane: usize, p: Vec3, target: Vec3) -> Option<Reflection> {
        let plane = &self.planes[plane];
        let (from, to) = (p.as_dvec3(), target.as_dvec3());
        let [above, beyond] = [from, to].map(|p| plane.height(p));
        if above * beyond <= 0.0 {
            return None;
        }
        // From the image of `p` to the target.
        let image = from - 2.0 * above * plane.normal;
        let place = image.lerp(to, above / (above + beyond));
        let holds = |pane: &&Pane| pane.sides.iter().all(|(inwards, offset)| inwards.dot(place) >= *offset);
        let pane = plane.panes.iter().find(holds)?;
        let normal = plane.normal.as_vec3a() * if above < 0.0 { -1.0 } else { 1.0 };
        let at = place.as_vec3a();
        let point = HitPoint::new(at, pane.error).seen_from((place - from).length() as f32);
        let faces_out = pane.faces_out == (above > 0.0);
        Some(Reflection { point, normal, material: pane.material, faces_out })
    }
}

impl Reflection {
    /// Where a segment that arrives at the place ends: moved off the mirror by what the kernel may be off there.
    #[inline]
    pub fn offset(&self) -> Vec3 {
        self.point.offset(self.normal)
    }

    /// The segment from the place to `target` at a time ([`crate::math::Ray::time`]).
    #[inline]
    pub fn leave_to(&self, target: Vec3, time: f32) -> Ray {
        HitPoint { time, ..self.point }.leave_to(self.normal, target)
    }

    /// The fraction of the light that is reflected along the unit direction `w`, or against it.
    #[inline]
    pub fn reflectance<C: Spectrum>(&self, scene: &Scene, w: Vec3, wavelengths: &C::Wavelengths) -> C {
        let mut slot = None;
        let Some(bsdf) = scene.material(self.material).everywhere::<C>(wavelengths, &mut slot) else { return C::ZERO };
        let cosine = w.dot(self.normal).abs().min(1.0);
        let z = if self.faces_out { cosine } else { -cosine };
        let wo = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, z);
        let [reflected, ..] = bsdf.specular_lobes(wo, TransportMode::Radiance);
        reflected.map_or(C::ZERO, |lobe| lobe.weight)
    }
}

/// The unit normal of a triangle and its area; `None` where it has none.
fn normal_and_area([a, b, c]: [DVec3; 3]) -> Option<(DVec3, f64)> {
    let cross = (b - a).cross(c - a);
    let length = cross.length();
    (length > 0.0 && length.is_finite()).then(|| (cross / length, 0.5 * length))
}

/// The triangles that may be mirrors in which lamps are looked for.
fn candidates(scene: &Scene) -> Vec<Candidate> {
    let such: Vec<bool> = scene.materials.iter().map(is_mirror).collect();
    let mut found = Vec::new();
    if !such.contains(&true) {
        return found;
    }
    for (number, (geometry, owners)) in scene.geometries.iter().zip(&*scene.bindings.owners).enumerate() {
        let (triangles, place) = match geometry {
            Geometry::Loose { triangles, .. } => (triangles, None),
            Geometry::Flat { triangles, moved: None, .. } => (triangles, None),
            Geometry::Instance { triangles, instance_path, .. } if !instance_path.moves() => {
                (triangles, Some(instance_path.start().to_scene))
            }
            _ => continue,
        };
        let count = triangles.mesh.indices().len();
        let is_loose = matches!(geometry, Geometry::Loose { .. });
        if triangles.normals.is_some() || triangles.mesh.is_deforming() || !is_loose && count > MOST_TRIANGLES {
            continue;
        }
        for primitive in 0..count as u32 {
            let material = owners.of(primitive).material;
            if !such[material as usize] {
                continue;
            }
            let corners = triangles.corners(primitive, 0.0);
            let corners = place.map_or(corners, |place| corners.map(|corner| place.transform_point3(corner)));
            let Some((normal, area)) = normal_and_area(corners) else { continue };
            let facet = Facet::triangle(number as u32, primitive);
            let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[b1, b2]| scene.facet_point(&facet, b1, b2));
            let error = points.iter().map(|at| at.point.error).fold(0.0, f32::max);
            let [a, b, c] = corners;
            let longest = (b - a).length().max((c - a).length()).max((c - b).length());
            if f64::from(error) <= LARGEST_ERROR * longest {
                let key = [number as u32, primitive];
                found.push(Candidate { material, key, corners, normal, outer: points[0].ng, area, error });
            }
            if found.len() == MOST_LOOKED_AT {
                return found;
            }
        }
    }
    found
}

/// Whether a surface of this material reflects perfectly and does nothing else.
fn is_mirror(material: &Material) -> bool {
    !material.is_varying() && material.is_opaque() && material.lobes() == Lobes::SPECULAR_REFLECTION
}

impl Scene {
    /// The flat mirrors, where the scene has any that lamps can be looked for in.
    #[inline]
    pub(crate) fn flat_mirrors(&self) -> Option<&FlatMirrors> {
        let mirrors = self
            .flat_mirrors
            .get_or_init(|| if self.has_media() { FlatMirrors::default() } else { FlatMirrors::new(self) });
        (!mirrors.planes.is_empty()).then_some(mirrors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{self, MeshDesc, ShapeDesc, SurfaceDesc};
    use crate::math::DAffine3;
    use crate::scene::BuildOptions;

    const MATERIALS: &str = r#"[
        {"name": "mirror", "type": "reflective", "color": [0.9, 0.8, 0.7]},
        {"name": "metal", "type": "conductor", "metal": "Au"},
        {"name": "rough", "type": "conductor", "metal": "Au", "roughness": 0.3},
        {"name": "thin", "type": "reflective", "color": [1, 1, 1], "opacity": 0.5},
        {"name": "glass", "type": "refractive", "refractionIndex": 1.5},
        {"name": "matte", "type": "diffuse", "color": [1, 1, 1]}]"#;

    fn text(surfaces: &str, camera: &str) -> String {
        format!(
            r#"{{"etendue": 1, "materials": {MATERIALS}, "surfaces": [{surfaces}],
            "camera": {{"origin": [0, 0, 5], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 40{camera}}}}}"#
        )
    }

    fn built(surfaces: &str, camera: &str) -> Scene {
        let desc = desc::parse(&text(surfaces, camera), "".as_ref(), None).unwrap();
        Scene::build(&desc, &BuildOptions::default()).unwrap()
    }

    fn quad(material: &str, z: f32, half: f32) -> String {
        format!(
            r#"{{"geometry": "quad", "material": "{material}", "vertex-1": [-{half}, -{half}, {z}], "vertex-2": [{half}, -{half}, {z}],
            "vertex-3": [{half}, {half}, {z}], "vertex-4": [-{half}, {half}, {z}]}}"#
        )
    }

    fn planes(surfaces: &[String]) -> usize {
        built(&surfaces.join(","), "").flat_mirrors().map_or(0, FlatMirrors::count)
    }

    #[test]
    fn only_flat_and_perfect_mirrors_are_looked_into() {
        for (material, expected) in [("mirror", 1), ("metal", 1), ("rough", 0), ("thin", 0), ("glass", 0), ("matte", 0)]
        {
            assert_eq!(planes(&[quad(material, 0.0, 1.0)]), expected, "{material}");
        }
        let ball = r#"{"geometry": "sphere", "material": "mirror", "origin": [0, 0, 0], "radius": 1}"#.to_owned();
        assert_eq!(planes(&[ball]), 0);
        // Two quads in one plane, and one in another.
        assert_eq!(planes(&[quad("mirror", 0.0, 1.0), quad("metal", 0.0, 3.0), quad("mirror", 1.0, 1.0)]), 2);
        let many: Vec<_> = (0..9).map(|i| quad("mirror", i as f32, 1.0 + i as f32)).collect();
        let scene = built(&many.join(","), "");
        let mirrors = scene.flat_mirrors().unwrap();
        assert_eq!(mirrors.count(), MOST_PLANES);
        let offsets: Vec<f64> = mirrors.planes.iter().map(|plane| plane.offset.abs() + scene.centre().z).collect();
        assert!(mirrors.planes.iter().all(|plane| plane.area() > 100.0), "the largest: {offsets:?}");
        // Those that move.
        let moving = quad("mirror", 0.0, 1.0)
            .replace(r#""material""#, r#""motion": [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}], "material""#);
        assert!(built(&moving, r#", "shutter": {"open": 0, "close": 1}"#).flat_mirrors().is_none());
    }

    #[test]
    fn meshes_are_mirrors_where_they_are_placed() {
        let positions = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]].map(DVec3::from);
        for (smooth, dynamic) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut desc = desc::parse(&text(&quad("matte", 0.0, 1.0), ""), "".as_ref(), None).unwrap();
            let mesh = MeshDesc {
                positions: positions.to_vec(),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                ..MeshDesc::default()
            };
            desc.meshes.push(mesh.into());
            let turned = DAffine3::from_translation(DVec3::new(0.0, 0.0, 2.0)) * DAffine3::from_rotation_y(0.5);
            let surface = SurfaceDesc {
                shape: ShapeDesc::Mesh { mesh: 0, smooth },
                transform: turned,
                material: Some(0),
                ..desc.surfaces[0].clone()
            };
            desc.surfaces.push(surface);
            let scene = Scene::build(&desc, &BuildOptions { dynamic, ..BuildOptions::default() }).unwrap();
            let Some(mirrors) = scene.flat_mirrors() else {
                assert!(smooth, "flat, dynamic: {dynamic}");
                continue;
            };
            assert!(!smooth && mirrors.count() == 1 && mirrors.planes[0].panes.len() == 2);
            let normal = turned.transform_vector3(DVec3::Z);
            let place = scene.to_scene(turned.transform_point3(DVec3::new(0.7, 0.2, 0.0)));
            let ray = Ray::new(place + normal.as_vec3a(), -normal.as_vec3a());
            assert_eq!(mirrors.plane_of(&scene.intersect(&ray).unwrap()), Some(0));
            let [p, target] = [-0.3, 0.9].map(|x| scene.to_scene(turned.transform_point3(DVec3::new(x, 0.1, 0.5))));
            let found = mirrors.between(0, p, target).unwrap();
            let middle = scene.to_scene(turned.transform_point3(DVec3::new(0.3, 0.1, 0.0)));
            assert!((found.point.p - middle).length() < 1e-6 && found.normal.dot(normal.as_vec3a()) > 1.0 - 1e-6);
        }
    }

    #[test]
    fn a_ray_by_way_of_a_mirror_is_reflected_there() {
        let scene = built(&[quad("metal", 0.0, 1.0), quad("mirror", 3.0, 0.1)].join(","), "");
        let mirrors = scene.flat_mirrors().unwrap();
        let (p, target) = (DVec3::new(-0.5, 0.2, 0.7), DVec3::new(0.8, -0.3, 0.4));
        let [p, target] = [p, target].map(|it| scene.to_scene(it));
        let plane = mirrors.plane_of(&scene.intersect(&Ray::new(p, -Vec3::Z)).unwrap()).unwrap();
        let place = mirrors.between(plane, p, target).unwrap();
        let (to, from) = ((place.point.p - p).normalize(), (target - place.point.p).normalize());
        assert!((mirrors.turn(plane, to) - from).length() < 1e-5 && place.normal.z > 0.99);
        let image = mirrors.image(plane, Receiver::facing(p, Vec3::new(0.6, 0.0, -0.8)));
        assert!(((target - image.p).normalize() - from).length() < 1e-5);
        assert!((image.normal().unwrap() - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
        // What the material reflects at this angle.
        let reflectance = place.reflectance::<crate::spectrum::Rgb>(&scene, to, &());
        assert!(reflectance.r() > reflectance.b() && reflectance.r() < 1.0 && reflectance.b() > 0.1, "{reflectance:?}");
        // Beyond the mirror, on the other side of it, and in its plane.
        for (p, target) in [
            ([-9.0, 0.0, 0.7], [-7.0, 0.0, 0.7]),
            ([0.0, 0.0, 0.7], [0.5, 0.0, -0.7]),
            ([0.0, 0.0, 0.0], [0.5, 0.0, 1.0]),
        ] {
            let [p, target] = [p, target].map(|it| scene.to_scene(DVec3::from(it)));
            assert!(mirrors.between(plane, p, target).is_none());
        }
    }
}
