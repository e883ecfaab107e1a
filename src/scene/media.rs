//! Media inside surfaces: which one fills a point, and what an interface between two of them refracts.
//!
//! A material that transmits into a body may give the body a medium: an index of refraction, an absorption coefficient and a
//! priority. Where bodies overlap, the medium of the highest priority fills the overlap; among equal priorities, it is the
//! medium that was entered last. A surface at which the medium does not change is hidden: rays pass it as if it were not
//! there. Only scenes in which a medium absorbs or has a priority have any of this ([`Scene::has_media`]).
//!
//! Source: Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images".

use std::sync::{Arc, OnceLock};

use super::geometry::Geometry;
use super::hit::{Hit, IN_LIST};
use super::interaction::{NO_EMITTER, Owner, Triangles};
use super::material::turned_with_tangents;
use super::textured::has_varying_bsdf;
use super::{Scene, SurfaceDetail};
use crate::bsdf::{Black, Bsdf, ByWavelength, Dielectric, Index, Model as _};
use crate::camera::Camera;
use crate::desc::{Body, BsdfDesc, Dispersion, MaterialDesc, MediumDesc, SceneDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{Bounds, DVec3, Ray, Vec3};
use crate::sampling::hash;
use crate::shape::Analytic;
use crate::spectrum::{Rgb, SpectralCurve, Spectrum};

/// The number of a medium of the scene, from 1 on; 0 stands for none.
type Number = u8;

/// Greatest number of different media in a scene.
const MOST_MEDIA: usize = Number::MAX as usize;

/// Directions of the probes that find the media around a point. None is parallel to a plane that scenes are likely to have.
const PROBES: [Vec3; 3] = [
    Vec3::new(0.267_1, 0.853_7, 0.447_1),
    Vec3::new(-0.612_9, 0.401_3, -0.680_7),
    Vec3::new(0.761_3, 0.290_3, -0.579_9),
];

/// Most surfaces that a probe meets.
const MOST_CROSSINGS: u32 = 256;

/// Most reflections of a probe in a scene whose media have open boundaries.
const MOST_REFLECTIONS: u32 = 16;

/// The media that a point lies in, in the order in which a path entered them: the last one in the lowest byte, 0 in unused
/// bytes. A medium more than [`MOST_NESTED`] makes the path forget the first one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PathMedia(u128);

/// Most media that a path knows to be in at once.
const MOST_NESTED: usize = 16;

impl PathMedia {
    /// No medium.
    pub const NONE: Self = Self(0);

    /// Whether the point lies in no medium. Its next surface is then not hidden.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    fn entered(self, medium: Number) -> Self {
        Self(self.0 << 8 | u128::from(medium))
    }

    /// The media from the last entered one on.
    fn numbers(self) -> impl Iterator<Item = Number> {
        self.0.to_le_bytes().into_iter().take_while(|number| *number != 0)
    }

    /// Without the last entered medium of this number.
    fn left(self, medium: Number) -> Self {
        let Some(place) = self.numbers().position(|number| number == medium) else { return self };
        let below = (1_u128 << (8 * place)) - 1;
        Self(self.0 & below | (self.0 >> 8) & !below)
    }

    /// With a medium that was entered before all others.
    fn with_outermost(self, medium: Number) -> Self {
        let place = self.numbers().count().min(MOST_NESTED - 1);
        Self(self.0 & !(0xff << (8 * place)) | u128::from(medium) << (8 * place))
    }
}

/// A medium.
#[derive(Clone, Debug, PartialEq)]
struct Medium {
    /// Indices of refraction: of the medium, and of what is around it where it lies in no other medium.
    ior: f32,
    exterior_ior: f32,
    /// Absorption coefficient [1 / length].
    absorption: Rgb,
    priority: u32,
    /// How the index of the medium depends on the wavelength.
    dispersion: Option<Dispersion>,
    /// How the absorption coefficient does, where it has a spectrum of its own.
    by_wavelength: Option<SpectralCurve>,
}

impl Medium {
    /// The index of the medium by the wavelength.
    fn index(&self) -> Index {
        Index { ior: self.ior, dispersion: self.dispersion }
    }
}

/// All media of a scene that has any.
#[derive(Clone, Debug)]
pub(super) struct Media {
    media: Vec<Medium>,
    /// The medium of each material. Materials with equal media share one.
    of_material: Vec<Number>,
    /// How each material is an interface between the media on its sides.
    interfaces: Vec<Interface>,
    /// The descriptions that interfaces are made from.
    materials: Arc<[MaterialDesc]>,
    /// Whether the boundaries of all media are known to be closed.
    is_closed: bool,
    /// Box around the boundaries of all media, scene frame.
    bounds: Bounds,
    /// The position of the scene's own camera and the media there.
    camera: Option<(Vec3, PathMedia)>,
}

/// What the Bsdf of a boundary is, in dependence of the media on its sides.
#[derive(Clone, Debug)]
enum Interface {
    /// That of the two indices alone, which is made at each hit.
    Smooth,
    /// One that takes work to make: with the number of the medium around the body as index, made where a path first meets it.
    Made(Box<[OnceLock<Bsdf>]>),
    /// One that textures vary, which is made at each hit.
    Varying,
}

/// What happens to the media of a path that passes through a surface.
struct Crossing {
    before: PathMedia,
    after: PathMedia,
    /// The medium that fills the space before and behind the surface.
    filling: [Number; 2],
}

impl Media {
    /// The media of a description; `None` where no medium absorbs or has a priority.
    ///
    /// # Errors
    /// [`ErrorKind::Unsupported`] for more than 255 different media.
    pub fn new(desc: &SceneDesc) -> Result<Option<Arc<Self>>> {
        let bodies = desc.bodies();
        if !bodies.iter().flatten().any(Body::uses_medium) {
            return Ok(None);
        }
        let mut media: Vec<Medium> = Vec::new();
        let mut of_material = Vec::with_capacity(desc.materials.len());
        for (i, (material, body)) in desc.materials.iter().zip(bodies).enumerate() {
            let Some(Body { ior, exterior_ior, medium: given, dispersion, absorption: spectrum }) = body else {
                of_material.push(0);
                continue;
            };
            let fail = |message| Err(Error::new(ErrorKind::Unsupported, message).at(material.path.clone()));
            if !material.is_one_body(&desc.materials[..i]) {
                let message = "the parts of the mixture are bodies of different media, expected one in a scene whose media \
                     absorb or have priorities";
                return fail(message.to_owned());
            }
            let MediumDesc { absorption, priority } = given;
            let by_wavelength = spectrum.map(|it| it.curve(&material.path)).transpose()?;
            let medium = Medium { ior, exterior_ior, absorption, priority, dispersion, by_wavelength };
            let place = media.iter().position(|other| *other == medium).unwrap_or_else(|| {
                media.push(medium);
                media.len() - 1
            });
            if place >= MOST_MEDIA {
                return fail(format!("the scene has more than {MOST_MEDIA} different media"));
            }
            of_material.push((place + 1) as Number);
        }
        // Surfaces without a material bound no body.
        of_material.push(0);
        let interface = |(i, material): (usize, &MaterialDesc)| match material.bsdf {
            BsdfDesc::Dielectric { .. } if material.film.is_none() => Interface::Smooth,
            _ if has_varying_bsdf(desc, i) => Interface::Varying,
            _ => Interface::Made((0..=media.len()).map(|_| OnceLock::new()).collect()),
        };
        let (interfaces, bounds) = (desc.materials.iter().enumerate().map(interface).collect(), Bounds::default());
        let materials = desc.materials.clone().into();
        Ok(Some(Arc::new(Self { media, of_material, interfaces, materials, is_closed: false, bounds, camera: None })))
    }

    fn medium(&self, number: Number) -> Option<&Medium> {
        self.media.get(usize::from(number).wrapping_sub(1))
    }

    /// The medium that fills a point: of those with the highest priority, the one that was entered last.
    fn filling(&self, media: PathMedia) -> Number {
        let mut filling = (0, 0);
        for number in media.numbers() {
            let priority = self.medium(number).map_or(0, |medium| medium.priority);
            if filling.0 == 0 || priority > filling.1 {
                filling = (number, priority);
            }
        }
        filling.0
    }

    /// A path in `media` passes the boundary of a medium. A path that leaves a medium it never entered was in this medium
    /// all the time.
    fn crossing(&self, media: PathMedia, medium: Number, enters: bool) -> Crossing {
        let (before, after) = if enters {
            (media, media.entered(medium))
        } else if media.numbers().any(|number| number == medium) {
            (media, media.left(medium))
        } else {
            (media.with_outermost(medium), media)
        };
        Crossing { before, after, filling: [before, after].map(|media| self.filling(media)) }
    }
}

impl Scene {
    /// Whether a medium absorbs or has a priority. Other scenes do not follow the media of paths.
    #[inline(always)]
    pub fn has_media(&self) -> bool {
        self.media.is_some()
    }

    /// Whether light is absorbed between surfaces.
    pub fn has_absorption(&self) -> bool {
        let absorbs = |media: &Arc<Media>| media.media.iter().any(|medium| medium.absorption != Rgb::ZERO);
        self.media.as_ref().is_some_and(absorbs)
    }

    fn owner_of(&self, hit: &Hit) -> Owner {
        if hit.geometry == IN_LIST {
            self.bindings.list_owners[hit.primitive as usize]
        } else {
            self.bindings.owners[hit.geometry as usize].of(hit.primitive)
        }
    }

    /// The media behind a surface that a ray in `media` met, if the surface is hidden. Otherwise `media` become those before
    /// the surface, which a surface that was met from within may correct.
    #[cold]
    #[inline(never)]
    pub(crate) fn behind_hidden(&self, ray: &Ray, hit: &Hit, media: &mut PathMedia) -> Option<PathMedia> {
        let all = self.media.as_deref()?;
        let owner = self.owner_of(hit);
        let medium = all.of_material[owner.material as usize];
        if medium == 0 {
            return None;
        }
        let enters = self.interaction(ray, hit).ng.dot(ray.direction) < 0.0;
        let Crossing { before, after, filling } = all.crossing(*media, medium, enters);
        if filling[0] == filling[1] && owner.emitter == NO_EMITTER {
            return Some(after);
        }
        *media = before;
        None
    }

    /// The media that a path in `media` is in after it passed a surface of a material from its outer side (`front`) or from its
    /// inner side.
    #[cold]
    #[inline(never)]
    pub(crate) fn media_behind(&self, media: PathMedia, material: u32, front: bool) -> PathMedia {
        match self.media.as_deref() {
            Some(all) if all.of_material[material as usize] != 0 => {
                all.crossing(media, all.of_material[material as usize], front).after
            }
            _ => media,
        }
    }

    /// Whether surfaces of a material bound a medium.
    #[inline]
    pub(crate) fn bounds_medium(&self, material: u32) -> bool {
        self.media.as_deref().is_some_and(|all| all.of_material[material as usize] != 0)
    }

    /// The Bsdf of a boundary between the two media at its sides, in place of the material's own Bsdf. `front` says whether the path
    /// arrives on the outer side.
    #[cold]
    #[inline(never)]
    pub(crate) fn interface<'a, C: Spectrum>(
        &self,
        media: PathMedia,
        material: u32,
        front: bool,
        wavelengths: &C::Wavelengths,
        detail: impl FnOnce(bool) -> SurfaceDetail<'a>,
    ) -> Bsdf<C> {
        let own = || self.material(material).mean().in_spectrum::<C>(wavelengths);
        let Some(all) = self.media.as_deref() else { return own() };
        let number = all.of_material[material as usize];
        let Some(medium) = all.medium(number) else { return own() };
        let Crossing { filling, .. } = all.crossing(media, number, front);
        let around = Index { ior: medium.exterior_ior, dispersion: None };
        let [here, beyond] = filling.map(|number| all.medium(number).map_or(around, Medium::index));
        let (inner, outer) = if front { (beyond, here) } else { (here, beyond) };
        let is_hidden = filling[0] == filling[1];
        match &all.interfaces[material as usize] {
            // Where the medium does not change, nothing is refracted, however rough the surface is.
            Interface::Made(around) if !is_hidden => {
                // A boundary at which the medium changes has its own medium on the inner side.
                let place = usize::from(if front { filling[0] } else { filling[1] });
                let bsdf = around[place].get_or_init(|| {
                    let (before, rest) = all.materials.split_at(material as usize);
                    rest.first().map_or(Bsdf::Black(Black), |own| {
                        let (bsdf, by) = (Bsdf::within(&own.bsdf, before, Some(outer.ior)), ByWavelength::new(own));
                        bsdf.by_wavelength(&own.bsdf, &by, Some(outer.ior), None).dispersing(inner, outer)
                    })
                });
                if bsdf.is_anisotropic() {
                    turned_with_tangents(bsdf, &detail(true)).in_spectrum::<C>(wavelengths)
                } else {
                    bsdf.in_spectrum::<C>(wavelengths)
                }
            }
            Interface::Varying if !is_hidden => self
                .material(material)
                .at_body(detail, outer.ior)
                .dispersing(inner, outer)
                .in_spectrum::<C>(wavelengths),
            Interface::Made(_) | Interface::Varying | Interface::Smooth => {
                let smooth = Bsdf::Dielectric(Dielectric::new(inner.ior, outer.ior));
                smooth.dispersing(inner, outer).in_spectrum::<C>(wavelengths)
            }
        }
    }

    /// The share of light that is left after a way of this length through `media`, by the law of Beer and Lambert.
    #[cold]
    #[inline(never)]
    pub(crate) fn transmittance<C: Spectrum>(&self, media: PathMedia, length: f32, wavelengths: &C::Wavelengths) -> C {
        let filling = self.media.as_deref().and_then(|all| all.medium(all.filling(media)));
        let Some(Medium { absorption, by_wavelength, .. }) = filling else { return C::ONE };
        if *absorption == Rgb::ZERO {
            return C::ONE;
        }
        // The product of no absorption and an infinite length is no number.
        let of = |coefficient: f32| if coefficient > 0.0 { (-coefficient * length).exp() } else { 1.0 };
        if C::HAS_WAVELENGTHS
            && let Some(curve) = by_wavelength
        {
            return C::at_wavelengths(wavelengths, |nanometres| of(curve.at(nanometres.unwrap_or(0.0))));
        }
        // The coefficient becomes a spectrum and not the share: shares of parts of a way then multiply to that of the whole.
        C::from_reflectance(*absorption, wavelengths).map(of)
    }

    /// The media at the origin of a ray; `None` in a scene that has no media.
    #[inline(always)]
    pub(crate) fn media_at(&self, ray: &Ray) -> Option<PathMedia> {
        self.has_media().then(|| self.probed_media(ray.origin, ray.time))
    }

    /// The media at a point, from the surfaces that probes meet: two of three probes have to agree.
    #[cold]
    #[inline(never)]
    fn probed_media(&self, p: Vec3, time: f32) -> PathMedia {
        let Some(all) = self.media.as_deref() else { return PathMedia::NONE };
        if let Some((camera, media)) = all.camera
            && camera == p
            && !self.has_motion()
        {
            return media;
        }
        if all.is_closed && !self.has_motion() && !all.bounds.contains(p.as_dvec3()) {
            return PathMedia::NONE;
        }
        let probe = |i: usize| self.probe(all, Ray::new(p, PROBES[i].normalize()).at_time(time));
        match (probe(0), probe(1)) {
            (Some(a), Some(b)) if a == b => a,
            (a, b) => {
                let c = probe(2);
                // Probes that met no boundary know nothing.
                let known = [a, b, c].into_iter().flatten().collect::<Vec<_>>();
                let agreed = known.iter().find(|one| known.iter().filter(|other| other == one).count() > 1);
                agreed.or(known.first()).copied().unwrap_or_default()
            }
        }
    }

    /// The media at the origin of a ray, from the boundaries that it crosses; `None` where it meets no boundary.
    ///
    /// The ray passes everything where all boundaries are closed. Otherwise it is reflected at surfaces that bound no
    /// medium, so that it stays where the light of the origin goes.
    fn probe(&self, all: &Media, mut ray: Ray) -> Option<PathMedia> {
        let mut counts = vec![0_i32; all.media.len() + 1];
        let mut least = counts.clone();
        let (mut left, mut met, mut reflections) = (Vec::new(), false, 0);
        for _ in 0..MOST_CROSSINGS {
            let Some(hit) = self.nearest(&ray) else { break };
            let medium = all.of_material[self.owner_of(&hit).material as usize];
            if medium == 0 && !all.is_closed {
                reflections += 1;
                if reflections > MOST_REFLECTIONS {
                    break;
                }
                let surface = self.interaction(&ray, &hit);
                let n = if surface.ng.dot(ray.direction) < 0.0 { surface.ng } else { -surface.ng };
                let direction = ray.direction - 2.0 * ray.direction.dot(n) * n;
                ray = Ray::new(surface.point.offset(n), direction.normalize()).at_time(ray.time);
                continue;
            }
            if medium != 0 {
                met = true;
                let number = usize::from(medium);
                let enters = self.interaction(&ray, &hit).ng.dot(ray.direction) < 0.0;
                counts[number] += if enters { 1 } else { -1 };
                // The ray leaves a medium that it did not enter: it began there.
                if counts[number] < least[number] {
                    least[number] = counts[number];
                    left.push(medium);
                }
            }
            ray.tnear = hit.t.next_up().max(f32::MIN_POSITIVE);
        }
        // The medium that was left first was entered last.
        let media = || left.iter().rev().fold(PathMedia::NONE, |media, medium| media.entered(*medium));
        (met || all.is_closed).then(media)
    }

    /// Measures the boundaries of the media, and finds the media at the camera.
    pub(super) fn with_located_media(mut self) -> Self {
        let Some(media) = self.media.take() else { return self };
        let mut media = Arc::unwrap_or_clone(media);
        (media.is_closed, media.bounds) = self.boundaries(&media);
        self.media = Some(Arc::new(media));
        if let Ok(camera) = Camera::new(&self.camera, [1; 2], self.centre) {
            let eye = camera.ray(0.5, 0.5).origin;
            let found = self.probed_media(eye, 0.0);
            if let Some(media) = self.media.as_mut().map(Arc::make_mut) {
                media.camera = Some((eye, found));
            }
        }
        self
    }

    /// Whether the boundaries of all media are known to be closed, and a box around them, scene frame.
    fn boundaries(&self, media: &Media) -> (bool, Bounds) {
        let of = |owner: Owner| media.of_material[owner.material as usize];
        let mut bounds = Bounds::default();
        // Other shapes than spheres may be clipped.
        let mut is_closed = true;
        for (shape, owner) in self.list.shapes().iter().zip(&*self.bindings.list_owners) {
            if of(*owner) != 0 {
                bounds = bounds.union(shape.bounds());
                is_closed &= matches!(shape, Analytic::Sphere(_));
            }
        }
        let mut loose = vec![0_u64; media.media.len() + 1];
        for (geometry, owners) in self.geometries.iter().zip(&*self.bindings.owners) {
            match geometry {
                Geometry::Analytic { shapes, .. } => {
                    for (primitive, shape) in shapes.start.iter().enumerate() {
                        if of(owners.of(primitive as u32)) != 0 {
                            bounds = bounds.union(shape.bounds());
                            is_closed &= matches!(shape, Analytic::Sphere(_));
                        }
                    }
                }
                Geometry::Loose { triangles, .. } => {
                    for primitive in 0..triangles.mesh.indices().len() {
                        let number = of(owners.of(primitive as u32));
                        if number != 0 {
                            let corners = corners(triangles, primitive);
                            bounds = bounds.union(Bounds::around(corners.map(to_double)));
                            let sum = &mut loose[usize::from(number)];
                            *sum = sum.wrapping_add(edges(corners));
                        }
                    }
                }
                Geometry::Flat { triangles, .. } | Geometry::Instance { triangles, .. } if of(owners.of(0)) != 0 => {
                    let vertices = triangles.mesh.vertices();
                    let own = Bounds::around((0..vertices.len()).map(|i| to_double(vertices.get(i))));
                    bounds = bounds.union(match geometry {
                        Geometry::Instance { instance_path, .. } => own.transformed(&instance_path.start().to_scene),
                        _ => own,
                    });
                    let count = triangles.mesh.indices().len();
                    let sum = (0..count).fold(0_u64, |sum, i| sum.wrapping_add(edges(corners(triangles, i))));
                    is_closed &= sum == 0;
                }
                Geometry::Flat { .. } | Geometry::Instance { .. } => {}
            }
        }
        is_closed &= loose.iter().all(|sum| *sum == 0);
        // The box is larger than what rounding could add to it.
        let margin = DVec3::splat(1e-5 * bounds.min.abs().max(bounds.max.abs()).max_element());
        let bounds =
            if bounds.is_empty() { bounds } else { Bounds { min: bounds.min - margin, max: bounds.max + margin } };
        (is_closed, bounds)
    }
}

fn corners(triangles: &Triangles, primitive: usize) -> [[f32; 3]; 3] {
    triangles.mesh.indices().get(primitive).map(|corner| triangles.mesh.vertices().get(corner as usize))
}

fn to_double(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// A sum over the edges of a triangle in which an edge cancels with the same edge in the opposite direction. Over the
/// triangles of a closed surface the sum is 0; over others it is 0 by an accident of the hash only.
fn edges(corners: [[f32; 3]; 3]) -> u64 {
    let key = |p: [f32; 3]| p.into_iter().fold(0, |key, x| hash(key, u64::from((x + 0.0).to_bits())));
    let keys = corners.map(key);
    let edge = |i: usize| {
        let (from, to) = (keys[i], keys[(i + 1) % 3]);
        if from < to { hash(from, to) } else { hash(to, from).wrapping_neg() }
    };
    edge(0).wrapping_add(edge(1)).wrapping_add(edge(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(numbers: &[Number]) -> PathMedia {
        numbers.iter().fold(PathMedia::NONE, |media, number| media.entered(*number))
    }

    #[test]
    fn media_are_entered_and_left_in_any_order() {
        assert!(of(&[]).is_empty());
        assert_eq!(of(&[1, 2, 3]).left(2), of(&[1, 3]));
        assert_eq!(of(&[1, 2, 1]).left(1), of(&[1, 2]));
        assert_eq!(of(&[1]).left(1), PathMedia::NONE);
        assert_eq!(of(&[1, 2]).left(3), of(&[1, 2]));
        assert_eq!(of(&[2, 3]).with_outermost(1), of(&[1, 2, 3]));
        let numbers: Vec<Number> = (1..=MOST_NESTED as Number).collect();
        let full = of(&numbers);
        // The first medium is forgotten.
        assert_eq!(full.entered(99), of(&[&numbers[1..], &[99]].concat()));
        assert_eq!(full.with_outermost(99), of(&[&[99], &numbers[1..]].concat()));
        assert_eq!(full.left(MOST_NESTED as Number), of(&numbers[..MOST_NESTED - 1]));
        assert_eq!(full.left(1), of(&numbers[1..]));
    }

    #[test]
    fn edges_of_closed_surfaces_cancel() {
        let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -0.0, 1.0]];
        let sum = |faces: &[[usize; 3]]| {
            faces.iter().fold(0_u64, |sum, face| sum.wrapping_add(edges(face.map(|corner| p[corner]))))
        };
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert_eq!(sum(&faces), 0);
        assert_ne!(sum(&faces[..3]), 0);
        assert_ne!(sum(&[faces[0], faces[0]]), 0);
        // A face that is turned over leaves its neighbours' edges open.
        assert_ne!(sum(&[[0, 1, 2], faces[1], faces[2], faces[3]]), 0);
    }
}
