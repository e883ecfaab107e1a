//! Bindings of a scene: which surface and material own each primitive, and which primitives emit. All of this can
//! change while the geometry stays the same.

mod kept;

pub(super) use kept::{Kept, KeptOwners, rebind_materials};

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::analytic::AnalyticList;
use super::cost;
use super::emission_webs::{EmissionWeb, emission_webs};
use super::geometry::Geometry;
use super::interaction;
use super::interaction::{NO_EMITTER, Owner, Owners, Triangles};
use super::moving_shape::MovingShape;
use super::record::GeometryRecord;
use super::sky::environment_map;
use super::textured_emission::{EmissionTexture, MOST_PIECES, emission_textures};
use crate::control::WorkProgress;
use crate::desc::{
    EnvironmentDesc, LightDistribution, LightSpectrum, PointLightDesc, PortalDesc, SceneDesc, SkyDesc, SpectrumDesc,
};
use crate::emitter::{
    DirectedPoint, DiskEmitter, DistantEmitter, Distribution, Emitter, EmitterSet, EnvironmentEmitter, EnvironmentMap,
    EnvironmentMapEmitter, InfiniteBall, InnerTubeEmitter, MovingEmitter, MovingPoint, PLANCKIAN, Portals,
    SphereEmitter, Spot, TriangleEmitter, TubeEmitter, TurnedWeb,
};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{Bounds, DVec3, Vec3};
use crate::photometry::LUMENS_PER_WATT;
use crate::room::{collected, grow, shared, with_room};
use crate::shape::{Analytic, Sphere, Triangle};
use crate::spectrum::Rgb;

/// Room between the surfaces and the ball from which the light of an environment comes, relative to the ball's radius.
const BALL_MARGIN: f64 = 1e-3;

/// The tables of owners, in the order of the geometries, and the emitters that the owners refer to.
#[derive(Clone)]
pub(super) struct SurfaceBindings {
    pub owners: Arc<[Owners]>,
    pub list_owners: Arc<[Owner]>,
    pub emitters: Arc<EmitterSet>,
}

/// Geometry that has no owners and emitters yet.
#[derive(Clone, Copy)]
pub(super) struct UnboundGeometry<'a> {
    pub geometries: &'a [Geometry],
    pub record: &'a GeometryRecord,
    pub list: &'a AnalyticList,
    pub list_surfaces: &'a [u32],
    pub centre: DVec3,
    /// Box around all surfaces, world frame.
    pub bounds: Bounds,
}

/// Returns the largest number of units of work that the emitters of a description's loose triangles and shapes can
/// take. The emitters of meshes are counted separately.
pub(super) fn triangles_cost(count: usize) -> f64 {
    cost::EMITTER * count as f64
}

/// Builds the tables of owners and the emitters of a scene from its description. Textures of lamps are prepared by at most
/// `threads` threads.
pub(super) fn bindings(
    desc: &SceneDesc,
    unbound: UnboundGeometry,
    threads: usize,
    kept: Kept<'_>,
    progress: &WorkProgress,
) -> Result<SurfaceBindings> {
    let textures = emission_textures(desc, unbound.centre, threads)?;
    let webs = emission_webs(desc)?;
    let mut dresser = BindingBuilder {
        desc,
        progress,
        record: unbound.record,
        textures,
        webs,
        pieces_left: MOST_PIECES,
        emitters: Vec::new(),
        backs: Vec::new(),
        spectra: EmissionSpectra::default(),
    };
    dresser.point_lights(unbound.centre)?;
    let mut lamps = None;
    let mut geometry = |geometry| match kept.owners.and_then(|kept| Some((kept.of(geometry)?, kept.reclad))) {
        Some((owners, reclad)) => {
            let lamps = lamps.get_or_insert_with(|| dresser.lamps());
            dresser.edited(geometry, owners, lamps, reclad)
        }
        None => dresser.geometry(geometry),
    };
    let owners = unbound.geometries.iter().map(&mut geometry).collect::<Result<_>>()?;
    let list_owners = dresser.analytic(unbound.list.shapes(), &[], unbound.list_surfaces)?;
    dresser.light_from_infinity(&unbound, kept.environment, threads)?;
    let pairs = dresser.append_backs()?;
    let spectra = dresser.spectra.lights()?;
    let emitters = EmitterSet::cancellable(dresser.emitters, &progress.cancel)?.with_backs(&pairs);
    let emitters = emitters.with_spectra(&dresser.spectra.pairs, spectra);
    Ok(SurfaceBindings { owners, list_owners: list_owners.into(), emitters: Arc::new(emitters) })
}

/// The emitter of a point light that is at `position` in the scene frame.
fn point_emitter(light: &PointLightDesc, position: Vec3) -> Emitter {
    let unit = |v: DVec3| (v / v.abs().max_element()).try_normalize();
    let (intensity, distribution) = match &light.distribution {
        LightDistribution::Even => return Emitter::Point { position, intensity: light.intensity },
        LightDistribution::Spot(spot) => {
            let [inner, outer] = [spot.inner_deg, spot.outer_deg].map(f64::to_radians);
            let axis = unit(spot.direction).unwrap_or(DVec3::NEG_Y);
            (light.intensity, Distribution::Spot(Spot::new(axis, inner, outer)))
        }
        LightDistribution::Web(it) => {
            let intensity = light.intensity;
            let axis = unit(it.direction).unwrap_or(DVec3::NEG_Y);
            let web = TurnedWeb::new(Arc::clone(&it.web), axis, unit(it.c0).unwrap_or(axis));
            let factor = it.tilt_factor() / LUMENS_PER_WATT;
            (Rgb::from_f64(intensity.to_f64() * factor), Distribution::Web(web))
        }
    };
    Emitter::Directed(Box::new(DirectedPoint { position, intensity, distribution }))
}

/// Which emitters have spectra of their own.
#[derive(Default)]
struct EmissionSpectra {
    /// The number of an emitter and that of its spectrum.
    pairs: Vec<[u32; 2]>,
    known: HashMap<(u8, u64), u32>,
    spectra: Vec<SpectrumDesc>,
}

impl EmissionSpectra {
    fn add(&mut self, emitter: u32, spectrum: &SpectrumDesc) {
        let number = *self.known.entry(spectrum.identity()).or_insert_with(|| {
            self.spectra.push(spectrum.clone());
            self.spectra.len() as u32 - 1
        });
        self.pairs.push([emitter, number]);
    }

    fn lights(&self) -> Result<Vec<LightSpectrum>> {
        self.spectra.iter().map(|spectrum| spectrum.light("spectrum")).collect()
    }
}

struct BindingBuilder<'a, 'p> {
    desc: &'a SceneDesc,
    progress: &'a WorkProgress<'p>,
    record: &'a GeometryRecord,
    /// Of materials; empty where no texture varies an emission.
    textures: Vec<Option<EmissionTexture>>,
    /// Of surfaces by their numbers; empty where none shines by a photometric web.
    webs: BTreeMap<u32, EmissionWeb>,
    /// Room for parts of textured triangles and spheres.
    pieces_left: usize,
    emitters: Vec<Emitter>,
    /// Emitters on the other side of surfaces that emit on both, each with the number of that on the normal's side. They come after all
    /// others in the end, because those of a mesh have consecutive numbers.
    backs: Vec<(u32, Emitter)>,
    spectra: EmissionSpectra,
}

/// The texture that varies the emission of a surface's material, where there is one.
fn texture_of<'a>(
    textures: &'a [Option<EmissionTexture>],
    desc: &SceneDesc,
    surface: u32,
) -> Option<&'a EmissionTexture> {
    textures.get(desc.surfaces[surface as usize].material?)?.as_ref()
}

impl BindingBuilder<'_, '_> {
    /// Adds the emitters of other sides to the list; returns the pairs of numbers of both sides.
    fn append_backs(&mut self) -> Result<Vec<[u32; 2]>> {
        let first = self.emitters.len() as u32;
        grow(&mut self.emitters, self.backs.len())?;
        let pairs = self.backs.iter().zip(first..).map(|((front, _), back)| [*front, back]);
        let pairs = collected(pairs, self.backs.len())?;
        self.emitters.extend(std::mem::take(&mut self.backs).into_iter().map(|(_, emitter)| emitter));
        Ok(pairs)
    }

    /// Makes room for the emitters of so many triangles, on both sides where there are lamps of two sides.
    fn make_room(&mut self, count: usize, emits_both: bool) -> Result<()> {
        grow(&mut self.emitters, count)?;
        grow(&mut self.backs, if emits_both { count } else { 0 })
    }

    /// Adds an emitter whose light has this spectrum.
    fn push_with(&mut self, spectrum: Option<&SpectrumDesc>, emitter: Emitter) {
        if let Some(spectrum) = spectrum {
            self.spectra.add(self.emitters.len() as u32, spectrum);
        }
        self.emitters.push(emitter);
    }

    /// Adds an emitter of a surface, and that of the other side where there is one; returns the number of the first.
    fn push(&mut self, surface: u32, front: Emitter, back: Option<Emitter>) -> u32 {
        let number = self.emitters.len() as u32;
        let desc = &self.desc.surfaces[surface as usize];
        if texture_of(&self.textures, self.desc, surface).is_some_and(EmissionTexture::is_planckian) {
            self.spectra.pairs.push([number, PLANCKIAN]);
            self.emitters.push(front);
        } else {
            self.push_with(desc.spectrum.as_ref(), front);
        }
        self.backs.extend(back.map(|back| (number, back)));
        number
    }

    fn emits_both(&self, surface: u32) -> bool {
        self.desc.surfaces[surface as usize].emits_both
    }

    fn owner(&self, surface: u32, emitter: u32) -> Owner {
        let material = self.desc.material_number(&self.desc.surfaces[surface as usize]) as u32;
        Owner { surface, material, emitter }
    }

    /// The emitted radiance of a surface, or `None` where the surface emits no light.
    fn emission(&self, surface: u32) -> Option<Rgb> {
        self.desc.surfaces[surface as usize].emission.filter(|emission| *emission != Rgb::ZERO)
    }

    fn point_lights(&mut self, centre: DVec3) -> Result<()> {
        for (number, light) in self.desc.lights.iter().enumerate() {
            let position = (light.position - centre).as_vec3a();
            if !position.is_finite() {
                return Err(Error::invalid(format!("{}.origin", light.path), "is too far from the scene"));
            }
            let is_dark = match &light.distribution {
                LightDistribution::Web(it) => it.web.flux() * it.tilt_factor() <= 0.0,
                _ => false,
            };
            if light.intensity != Rgb::ZERO && !is_dark {
                let emitter = point_emitter(light, position);
                let emitter = match self.desc.motion.lights.get(&number) {
                    Some(motion) => Emitter::Moving(Box::new(MovingEmitter::Point(MovingPoint {
                        position: light.position,
                        intensity: match &emitter {
                            Emitter::Directed(directed) => directed.intensity,
                            _ => light.intensity,
                        },
                        distribution: match emitter {
                            Emitter::Directed(directed) => Some(directed.distribution),
                            _ => None,
                        },
                        path: motion.path(),
                        interval: self.desc.motion.shutter.interval(),
                        centre,
                    }))),
                    None => emitter,
                };
                self.push_with(light.spectrum.as_ref(), emitter);
            }
        }
        Ok(())
    }

    /// Adds the light from infinity, around a ball that holds all surfaces.
    fn light_from_infinity(
        &mut self,
        unbound: &UnboundGeometry<'_>,
        kept: Option<Arc<EnvironmentMap>>,
        threads: usize,
    ) -> Result<()> {
        // Coordinates of the scene frame are rounded, and so may lie outside of the box that was measured before.
        let (middle, radius) = if unbound.bounds.is_empty() {
            (DVec3::ZERO, 1.0)
        } else {
            let bounds = unbound.bounds;
            (bounds.centre() - unbound.centre, 0.5 * (bounds.max - bounds.min).length() * (1.0 + BALL_MARGIN))
        };
        let ball = InfiniteBall::new(middle.as_vec3a(), (radius as f32).max(f32::MIN_POSITIVE));
        let sun = self.desc.environment.as_ref().and_then(EnvironmentDesc::sun);
        let distant = self.desc.distant_lights.iter().chain(&sun);
        for light in distant.filter(|light| light.irradiance != Rgb::ZERO) {
            let towards = light.towards.normalize().as_vec3a().normalize();
            let mut emitter = DistantEmitter::new(light.irradiance, towards, light.angle_deg.to_radians(), ball);
            emitter.visible = light.visible;
            self.push_with(light.spectrum.as_ref(), Emitter::Distant(emitter));
        }
        self.environment(ball, unbound.centre, kept, threads)
    }

    fn environment(
        &mut self,
        ball: InfiniteBall,
        centre: DVec3,
        kept: Option<Arc<EnvironmentMap>>,
        threads: usize,
    ) -> Result<()> {
        let Some(environment) = &self.desc.environment else { return Ok(()) };
        if environment.radiance == Rgb::ZERO {
            return Ok(());
        }
        if environment.sky == SkyDesc::Even && environment.portals.is_empty() {
            let mut emitter = EnvironmentEmitter::new(environment.radiance, ball);
            emitter.visible = environment.visible;
            self.push_with(environment.spectrum.as_ref(), Emitter::Environment(emitter));
            return Ok(());
        }
        let map = match kept {
            Some(kept) => Some(kept),
            None => environment_map(self.desc, environment, threads, &self.progress.cancel)?.map(Arc::new),
        };
        // A black image gives nothing.
        let emitter = map.map(|map| {
            let mut emitter = EnvironmentMapEmitter::new(map, ball);
            emitter.visible = environment.visible;
            let portals = environment.portals.iter().flat_map(PortalDesc::triangles);
            let triangle = |corners: [DVec3; 3]| Triangle::new(corners.map(|p| (p - centre).as_vec3a()));
            emitter.portals = Portals::new(portals.filter_map(triangle)).map(Arc::new);
            Emitter::EnvironmentMap(emitter)
        });
        if let Some(emitter) = emitter {
            self.push_with(environment.spectrum.as_ref(), emitter);
        }
        Ok(())
    }

    fn geometry(&mut self, geometry: &Geometry) -> Result<Owners> {
        let progress = self.progress;
        self.check_textures(geometry)?;
        match geometry {
            Geometry::Loose { triangles, parts, .. } => {
                let mut owners = with_room(parts.len())?;
                let emitting = || parts.iter().filter(|part| self.emission(part.surface).is_some());
                let (count, emits_both) = (emitting().count(), emitting().any(|part| self.emits_both(part.surface)));
                self.make_room(count, emits_both)?;
                progress.each(parts.len(), cost::EMITTER, |i| {
                    let surface = parts[i].surface;
                    let emitter = self
                        .emission(surface)
                        .and_then(|radiance| self.emit(geometry, triangles, i, surface, radiance));
                    owners.push(self.owner(surface, emitter.unwrap_or(NO_EMITTER)));
                })?;
                Ok(Owners::Each(shared(owners)?))
            }
            &Geometry::Flat { ref triangles, surface, .. } => {
                let mut first = NO_EMITTER;
                if let Some(radiance) = self.emission(surface) {
                    first = self.emitters.len() as u32;
                    self.make_room(triangles.mesh.indices().len(), self.emits_both(surface))?;
                    progress.each(triangles.mesh.indices().len(), cost::EMITTER, |i| {
                        self.emit(geometry, triangles, i, surface, radiance);
                    })?;
                }
                Ok(Owners::One(self.owner(surface, first)))
            }
            &Geometry::Instance { surface, .. } => Ok(Owners::One(self.owner(surface, NO_EMITTER))),
            Geometry::Analytic { shapes, surfaces } => {
                let owners = self.analytic(&shapes.start, &shapes.moving, surfaces)?;
                Ok(Owners::Each(shared(owners)?))
            }
        }
    }

    /// Refuses lamps that move and whose radiance a texture varies.
    fn check_textures(&self, geometry: &Geometry) -> Result<()> {
        let refuse = |surface: u32| {
            let described = &self.desc.surfaces[surface as usize];
            if texture_of(&self.textures, self.desc, surface).is_none() || self.emission(surface).is_none() {
                return Ok(());
            }
            let message =
                "a surface whose emission a texture varies cannot move, expected one that rests or an even emission";
            Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.motion", described.path)))
        };
        match geometry {
            Geometry::Loose { triangles, parts, .. } if triangles.mesh.is_deforming() => {
                parts.iter().try_for_each(|part| refuse(part.surface))
            }
            Geometry::Flat { triangles, surface, .. } if triangles.mesh.is_deforming() => refuse(*surface),
            Geometry::Analytic { shapes, surfaces } if !shapes.moving.is_empty() => {
                surfaces.iter().try_for_each(|surface| refuse(*surface))
            }
            _ => Ok(()),
        }
    }

    /// Makes an emitter of a triangle that moves; `flipped`: of its other side.
    fn moving_triangle(triangles: &Triangles, index: usize, radiance: Rgb, flipped: bool) -> Emitter {
        let corners = triangles.mesh.indices().get(index);
        let at = |step| {
            let vertices = triangles.mesh.vertices_at_step(step);
            let [a, b, c] = corners.map(|corner| Vec3::from(vertices.get(corner as usize)));
            if flipped { [a, c, b] } else { [a, b, c] }
        };
        let steps: Box<[_]> = (0..triangles.mesh.time_steps()).map(at).collect();
        let error = interaction::moving_triangle_error(&steps);
        Emitter::Moving(Box::new(MovingEmitter::Triangle { steps, radiance, error }))
    }

    /// Makes an emitter of a triangle in the scene frame and returns its number. Every triangle has an area here,
    /// because degenerate ones were dropped before.
    fn emit(
        &mut self,
        geometry: &Geometry,
        triangles: &Triangles,
        index: usize,
        surface: u32,
        radiance: Rgb,
    ) -> Option<u32> {
        let emits_both = self.emits_both(surface);
        if triangles.mesh.is_deforming() {
            let [front, back] = [false, true].map(|flipped| {
                (flipped <= emits_both).then(|| Self::moving_triangle(triangles, index, radiance, flipped))
            });
            return front.map(|front| self.push(surface, front, back));
        }
        let corners = triangles.mesh.indices().get(index);
        let vertices = triangles.mesh.vertices();
        let [a, b, c] = corners.map(|corner| Vec3::from(vertices.get(corner as usize)));
        let front = self.triangle(geometry, Triangle::new([a, b, c])?, index, surface, radiance, false);
        let back = match emits_both {
            true => Some(self.triangle(geometry, Triangle::new([a, c, b])?, index, surface, radiance, true)),
            false => None,
        };
        Some(self.push(surface, front, back))
    }

    /// Makes an emitter of a triangle that rests; `flipped`: of its other side, whose second and third corner are the third and second of
    /// the mesh.
    fn triangle(
        &mut self,
        geometry: &Geometry,
        triangle: Triangle,
        index: usize,
        surface: u32,
        radiance: Rgb,
        flipped: bool,
    ) -> Emitter {
        let error = interaction::triangle_error(&triangle);
        if let Some(web) = self.webs.get(&surface) {
            return web.triangle(triangle, error, flipped);
        }
        match texture_of(&self.textures, self.desc, surface) {
            Some(texture) => {
                let set = texture.uv_set();
                let [a, b, c] = self.record.corner_uvs_of_set(geometry, index as u32, set).unwrap_or_default();
                let uvs = if flipped { [a, c, b] } else { [a, b, c] };
                texture.emitter(triangle, error, radiance, uvs, &mut self.pieces_left)
            }
            _ => Emitter::Triangle(TriangleEmitter::new(triangle, radiance, error)),
        }
    }

    fn sphere(&mut self, sphere: Sphere, surface: u32, radiance: Rgb) -> Emitter {
        match (texture_of(&self.textures, self.desc, surface), self.record.placed(surface)) {
            (Some(texture), Some((_, to_world))) => {
                texture.sphere_emitter(sphere, &to_world, radiance, &mut self.pieces_left)
            }
            _ => Emitter::Sphere(SphereEmitter { sphere, radiance }),
        }
    }

    fn cannot_move(&self, surface: u32) -> Error {
        let message =
            "a disk or a cylinder that emits cannot move, expected one that rests, or a sphere, triangle, quad or mesh";
        let path = format!("{}.motion", self.desc.surfaces[surface as usize].path);
        Error::new(ErrorKind::Unsupported, message).at(path)
    }

    fn analytic(&mut self, shapes: &[Analytic], moving: &[MovingShape], surfaces: &[u32]) -> Result<Vec<Owner>> {
        let owner = |(number, (shape, &surface)): (usize, (&Analytic, &u32))| {
            let emitter = match self.emission(surface) {
                Some(radiance) => self.emit_shape(shape, moving.get(number), surface, radiance)?,
                None => NO_EMITTER,
            };
            Ok(self.owner(surface, emitter))
        };
        shapes.iter().zip(surfaces).enumerate().map(owner).collect()
    }

    /// Makes an emitter of a shape, with `moving` where it moves, and returns its number.
    fn emit_shape(
        &mut self,
        shape: &Analytic,
        moving: Option<&MovingShape>,
        surface: u32,
        radiance: Rgb,
    ) -> Result<u32> {
        // The light of a textured ball is worked out at thousands of its points.
        self.progress.check()?;
        let mut other = None;
        let emission = match (moving.map(MovingShape::spheres), shape) {
            (Some(Some(steps)), _) => {
                Emitter::Moving(Box::new(MovingEmitter::Sphere { steps: steps.into(), radiance }))
            }
            (Some(None), Analytic::Disk(_) | Analytic::Quadric(_)) => return Err(self.cannot_move(surface)),
            (_, Analytic::Sphere(sphere)) => self.sphere(*sphere, surface, radiance),
            (None, Analytic::Disk(disk)) => match self.webs.get(&surface) {
                Some(web) => {
                    other = Some(web.disk(disk.flipped(), true));
                    web.disk(*disk, false)
                }
                None => {
                    let disk = DiskEmitter::new(*disk, radiance);
                    other = Some(Emitter::Disk(Box::new(disk.flipped())));
                    Emitter::Disk(Box::new(disk))
                }
            },
            // Of the quadrics, only cylinders have an emission.
            (None, Analytic::Quadric(tube)) => {
                let tube = TubeEmitter::new(*tube.to_scene(), radiance);
                other = Some(Emitter::InnerTube(Box::new(InnerTubeEmitter::new(tube))));
                Emitter::Tube(Box::new(tube))
            }
        };
        Ok(self.push(surface, emission, other.filter(|_| self.emits_both(surface))))
    }
}
