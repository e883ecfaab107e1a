//! Radiosity: the light of a diffuse scene, solved for all of it at once and for every view.
//!
//! Surfaces are cut into elements, whose form factors say how much of one's light reaches another. That is a system of linear
//! equations, and hierarchical: parts of a wall that are far from each other exchange light as wholes, so that its cost grows
//! about as the number of elements. Pictures of the solution cost one ray a sample.
//!
//! # What it does and how
//!
//! - Elements are sides of triangles, divided where light changes ([`form_factor`], `elements`, `links`). Inscribed triangles
//!   stand for spheres, disks and quadrics, with the areas of these.
//! - Clusters above them exchange light as points do, by functions of direction, so that scenes of many triangles are no worse
//!   than others.
//! - Rays say what share of a pair's light is blocked.
//! - The solution is irradiance at vertices, and continuous over flat surfaces and smooth ones. Emission is never interpolated.
//! - With `radiosityFinalGather`, what the camera sees takes direct light from light samples and indirect light from a ray into
//!   the solution: shadows and contacts are as sharp as a path tracer's.
//!
//! # When it is a poor choice
//!
//! Where surfaces are not diffuse: mirrors and glass are black to it, rough diffuse surfaces are Lambert's of the same mean albedo.
//! Where shadows are fine against elements, unless the final gather draws them.
//!
//! ```json
//! {"integrator": "radiosity", "radiosityError": 1, "radiosityIterations": null, "radiosityTolerance": 0.0001,
//!  "radiositySolver": "gather", "radiosityAmbient": false, "radiosityFinalGather": false, "radiosityMemory": 1024}
//! ```
//!
//! Sources: Goral et al. 1984, "Modeling the Interaction of Light Between Diffuse Surfaces"; Cohen et al. 1988, "A Progressive
//! Refinement Approach to Fast Radiosity Image Generation"; Hanrahan, Salzman, Aupperle 1991, "A Rapid Hierarchical Radiosity
//! Algorithm"; Smits, Arvo, Greenberg 1994, "A Clustering Algorithm for Radiosity in Complex Environments".

mod elements;
pub mod form_factor;
mod judge;
mod light;
mod links;
mod picture;
mod refine;
mod shoot;
mod solve;
mod tessellate;
mod vertices;
mod visibility;

pub(crate) use picture::RadiosityPicture;

use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};

use crate::control::{Parallel, Part};
use crate::desc::{PhotonSharing, RadiosityDesc, RadiositySolver, check_radiosity};
use crate::emitter::Receiver;
use crate::error::Result;
use crate::integrator::photon::{Aim, Emission};
use crate::math::{DVec3, Ray, Vec3};
use crate::sampling::Rng;
use crate::scene::{FaceNumbers, Hit, Scene};
use crate::spectrum::Rgb;
use elements::{Elements, NONE};
use judge::Judge;
use refine::{Network, Shared};
use solve::Course;

/// What a solution came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct RadiositySummary {
    /// Elements that are not divided any further, both sides of surfaces counted.
    pub elements: usize,
    /// Links between elements or clusters.
    pub links: usize,
    /// Iterations of the last solution: bounces gathered, or bodies that shot.
    pub iterations: u32,
    /// What the last iteration changed, over what there is, both as sums of area times radiosity.
    pub residual: f64,
    /// Bound on what more iterations would change, in the same measure. It knows nothing of what the links are wrong by.
    pub error_bound: f64,
    /// Light emitted and light absorbed by surfaces (W), per channel.
    pub emitted: Rgb,
    /// See `emitted`.
    pub absorbed: Rgb,
    /// Memory of elements and links while it was solved, bytes.
    pub memory: usize,
    /// Time it took.
    pub elapsed: Duration,
}

/// A solution: irradiance on every diffuse surface.
#[derive(Debug)]
pub struct Radiosity {
    elements: Elements,
    numbers: FaceNumbers,
    scene: Scene,
    /// Irradiance at the vertices of elements.
    irradiance: Vec<Rgb>,
    summary: RadiositySummary,
    notes: Vec<String>,
}

/// The elements of a surface, as triangles.
#[derive(Clone, Debug, Default)]
pub struct RadiosityMesh {
    /// Positions, world frame.
    pub positions: Vec<DVec3>,
    /// Radiosity at each [W m^-2]: what is emitted and what is reflected.
    pub radiosity: Vec<Rgb>,
    /// Irradiance at each [W m^-2].
    pub irradiance: Vec<Rgb>,
    /// Three indices each, counter-clockwise seen from the side that they are of.
    pub triangles: Vec<[u32; 3]>,
}

/// By what the allowed error of a link is larger at first: brightness is not known yet.
const COARSENESS: [f64; 4] = [64.0, 16.0, 4.0, 1.0];

/// Once it is, links are looked at again so often.
const REPEATS: usize = 2;

/// How often leaves are divided whose corners do not tell what light is within, and by how much that is, in what a link may be
/// wrong by.
const DIVISIONS: usize = 2;
const BETWEEN: f64 = 3.0;

/// How often leaves are balanced: by what they send, which it changes; they look for themselves the last time.
const BALANCES: u32 = 6;

/// No more than this is changed by a balance that needs no other after it but the one in which leaves look.
const SETTLED: f64 = 1e-3;

/// Iterations between two balances, at most: before all are balanced, some may gather more than there is, and without bound.
const SWEEPS_BETWEEN: usize = 8;

/// Of a number of bounces so many are balanced each by itself; later ones are alike enough.
const BALANCED_BOUNCES: u32 = 8;

/// Iterations between refinements.
const SWEEPS: usize = 3;

/// What share of the work is done after each step of linking, by how many pairs are judged in them in usual scenes.
const LINKED: [f64; COARSENESS.len() + REPEATS] = [0.05, 0.15, 0.3, 0.45, 0.5, 0.52];

/// After each division of leaves.
const DIVIDED: [f64; DIVISIONS] = [0.63, 0.75];

/// When they are balanced, and when the system of equations is solved.
const BALANCED: f64 = 0.9;
const SOLVED: f64 = 0.95;

impl Radiosity {
    /// Solves a scene. The result is the same for any number of threads.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for settings that no file could have given; `OutOfMemory` where elements and links
    /// take more than `memory` allows; `Cancelled`.
    pub fn solve(scene: &Scene, desc: &RadiosityDesc, parallel: &mut impl Parallel) -> Result<Self> {
        let start = Instant::now();
        check_radiosity("render", desc)?;
        parallel.check()?;
        let limit = (desc.memory as usize).saturating_mul(1 << 20);
        let elements = Elements::new(scene, desc.element_size, limit)?;
        let mut notes = Vec::new();
        if elements.patches.is_empty() {
            notes.push("radiosity: no surface is diffuse or emits, the solution is empty".to_owned());
        }
        let is_dark = scene.emitters().is_dark();
        let shared: Shared = Arc::new(RwLock::new(Network::new(scene, elements)));
        let (mut course, mut ambient) = (Course::default(), DVec3::ZERO);
        // With no bounce at all, nothing is asked for but what surfaces emit.
        let is_emission = desc.iterations == Some(0) && !desc.ambient;
        if !is_dark && !is_emission && !read(&shared).judge.elements.patches.is_empty() {
            link(&shared, desc, parallel)?;
            let at_vertices = vertices::vertices(&shared, parallel)?;
            shared.write().unwrap_or_else(PoisonError::into_inner).judge.at_vertices = at_vertices;
            refine::look_again(&shared, parallel)?;
            solve::sweep(&shared, parallel)?;
            let divided = DIVIDED[DIVISIONS - 1];
            let mut is_settled = false;
            for count in 1..=BALANCES {
                let is_last = is_settled || count == BALANCES;
                solve::balance(&shared, is_last, parallel)?;
                parallel.progress(divided + (BALANCED - divided) * f64::from(count) / f64::from(BALANCES));
                if is_last {
                    break;
                }
                let mut change = solve::sweep(&shared, parallel)?;
                is_settled = change < SETTLED;
                // Far cheaper than another balance, which is the better the nearer light is to where it ends.
                for _ in 1..SWEEPS_BETWEEN {
                    if change < SETTLED || !change.is_finite() {
                        break;
                    }
                    change = solve::sweep(&shared, parallel)?;
                }
            }
            let mut part = Part::new(parallel, BALANCED..SOLVED);
            (course, ambient) = match desc.solver {
                // The last of a number of bounces is gathered at the vertices.
                RadiositySolver::Gather => {
                    let bounces = desc.iterations.map(|count| count.saturating_sub(1));
                    let course = solve::gather(&shared, bounces, BALANCED_BOUNCES, desc.tolerance, &mut part)?;
                    (Course { iterations: desc.iterations.unwrap_or(course.iterations), ..course }, DVec3::ZERO)
                }
                RadiositySolver::Shoot => shoot::shoot(&shared, desc.iterations, desc.tolerance, &mut part)?,
            };
        } else {
            let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
            network.first = vec![0; network.judge.elements.nodes.len() + 1];
        }
        parallel.progress(SOLVED);
        if desc.iterations.is_some_and(|count| count > 0) {
            solve::balance(&shared, true, parallel)?;
        }
        let mut found = solve::irradiances(&shared, parallel)?;
        let mut irradiance = vertices::vertices(&shared, parallel)?;
        vertices::conserve(&read(&shared).judge.elements, &mut irradiance, &found);
        if desc.iterations == Some(0) {
            found.iter_mut().for_each(|(_, e)| *e = DVec3::ZERO);
            irradiance.fill(Rgb::ZERO);
        }
        if desc.ambient {
            let ambient = Rgb::from_f64(ambient);
            irradiance.iter_mut().for_each(|e| *e += ambient);
        }
        let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
        let mut summary = RadiositySummary {
            links: network.links.len(),
            memory: network.bytes(),
            iterations: course.iterations,
            residual: course.residual,
            // Where nothing is left there is nothing to bound, whatever surfaces reflect.
            error_bound: if course.residual == 0.0 { 0.0 } else { course.bound },
            ..RadiositySummary::default()
        };
        let elements = std::mem::take(&mut network.judge.elements);
        let mut absorbed = DVec3::ZERO;
        for (leaf, irradiance) in found {
            let node = &elements.nodes[leaf as usize];
            let patch = &elements.patches[node.patch as usize];
            absorbed += node.area * (1.0 - patch.albedo) * irradiance;
            summary.elements += 1;
        }
        let emitted = scene.emitters().emitters().iter().map(crate::emitter::Emitter::power).sum::<DVec3>();
        (summary.emitted, summary.absorbed) = (Rgb::from_f64(emitted), Rgb::from_f64(absorbed));
        summary.elapsed = start.elapsed();
        let is_bounded = solve::largest_albedo(&elements) < 1.0;
        let bound = if summary.error_bound.is_finite() {
            format!("bound {:.1e}", summary.error_bound)
        } else if is_bounded {
            "no bound after so few".to_owned()
        } else {
            "no bound, a surface reflects all of a colour".to_owned()
        };
        notes.push(format!(
            "radiosity: {} elements, {} links, {} iterations, residual {:.1e}, {bound}, {:.1} MiB, {:.1} s",
            summary.elements,
            summary.links,
            summary.iterations,
            summary.residual,
            summary.memory as f64 / f64::from(1 << 20),
            summary.elapsed.as_secs_f64(),
        ));
        let numbers = scene.face_numbers();
        Ok(Self { elements, numbers, scene: scene.clone(), irradiance, summary, notes })
    }

    /// Irradiance [W m^-2] where a ray of the same scene met a surface, on the outer side (`front`) or the other one. `p`: the
    /// point, scene frame. 0 on surfaces that reflect nothing diffusely and do not emit.
    #[inline]
    pub fn irradiance(&self, hit: &Hit, p: Vec3, front: bool) -> Rgb {
        let (face, weights) = self.numbers.of(hit);
        self.at(face, weights, p.as_dvec3(), front).unwrap_or(Rgb::ZERO)
    }

    /// The same for a place of a described surface: of a triangle, quad or mesh the `primitive` and the weights of its second
    /// and third vertex as in [`crate::scene::HitDescription`]; of other shapes the point `p`, world frame.
    ///
    /// `None` where the surface has no such primitive, or nothing on it reflects diffusely or emits.
    pub fn irradiance_on(
        &self,
        surface: u32,
        primitive: u32,
        barycentric: [f32; 2],
        p: DVec3,
        front: bool,
    ) -> Option<Rgb> {
        let (face, is_swapped) = self.scene.face_of(surface, primitive)?;
        let [s, t] = barycentric;
        let weights = if is_swapped { [t, s] } else { [s, t] };
        self.at(face, weights, p - self.scene.centre(), front)
    }

    #[inline]
    fn at(&self, face: u32, weights: [f32; 2], p: DVec3, front: bool) -> Option<Rgb> {
        let (leaf, [s, t]) = self.elements.leaf_at(face, front, weights, p)?;
        let [a, b, c] = self.elements.nodes[leaf as usize].corners.map(|vertex| self.irradiance[vertex as usize]);
        let (s, t) = (s as f32, t as f32);
        Some((1.0 - s - t) * a + s * b + t * c)
    }

    /// What the solution came to.
    pub fn summary(&self) -> &RadiositySummary {
        &self.summary
    }

    /// What a user should know.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The elements of one side of a surface, or of all surfaces, as a mesh.
    pub fn mesh(&self, surface: Option<u32>, front: bool) -> RadiosityMesh {
        let elements = &self.elements;
        let mut mesh = RadiosityMesh::default();
        let mut known = std::collections::HashMap::new();
        for node in elements.nodes.iter().filter(|node| node.patch != NONE && node.is_leaf()) {
            let patch = &elements.patches[node.patch as usize];
            if patch.is_front != front || surface.is_some_and(|surface| surface != patch.surface) {
                continue;
            }
            let mut corners = node.corners.map(|vertex| {
                *known.entry(vertex).or_insert_with(|| {
                    let irradiance = self.irradiance[vertex as usize];
                    mesh.positions.push(elements.vertices[vertex as usize] + self.scene.centre());
                    mesh.irradiance.push(irradiance);
                    mesh.radiosity.push(Rgb::from_f64(patch.emitted) + Rgb::from_f64(patch.albedo) * irradiance);
                    mesh.positions.len() as u32 - 1
                })
            });
            let flat = form_factor::normal(&elements.triangle(node)).unwrap_or(node.normal);
            if flat.dot(node.normal) < 0.0 {
                corners.swap(1, 2);
            }
            mesh.triangles.push(corners);
        }
        mesh
    }
}

fn read(shared: &Shared) -> std::sync::RwLockReadGuard<'_, Network> {
    shared.read().unwrap_or_else(PoisonError::into_inner)
}

/// Links everything, coarsely at first, then as brightness becomes known.
fn link(shared: &Shared, desc: &RadiosityDesc, parallel: &mut impl Parallel) -> Result<()> {
    let allowed = 1e-3 * desc.error;
    let mut norm = first_norm(&read(shared))?;
    let mut pairs = refine::first_pairs(&read(shared));
    let last = COARSENESS.len() - 1;
    for step in 0..COARSENESS.len() + REPEATS {
        let coarseness = COARSENESS[step.min(last)];
        shared.write().unwrap_or_else(PoisonError::into_inner).judge.threshold = coarseness * allowed * norm;
        if step > 0 {
            pairs = refine::stale(shared, parallel)?;
        }
        let count = pairs.len();
        refine::refine(shared, pairs, parallel)?;
        pairs = Vec::new();
        if step > last && count == 0 {
            break;
        }
        for _ in 0..SWEEPS {
            solve::bounce(shared, parallel)?;
        }
        let found = solve::irradiances(shared, parallel)?;
        let nodes = &read(shared).judge.elements.nodes;
        let square = |(leaf, e): &(u32, DVec3)| nodes[*leaf as usize].area * e.max_element().powi(2);
        let total = found.iter().map(square).sum::<f64>().sqrt();
        if total > 0.0 {
            norm = total;
        }
        parallel.progress(LINKED[step]);
    }
    for done in DIVIDED {
        cut(shared, parallel)?;
        let pairs = refine::stale(shared, parallel)?;
        if pairs.is_empty() {
            break;
        }
        refine::refine(shared, pairs, parallel)?;
        for _ in 0..SWEEPS {
            solve::bounce(shared, parallel)?;
        }
        parallel.progress(done);
    }
    Ok(())
}

/// Marks the leaves whose corners do not tell what light is within: at the edges of shadows.
fn cut(shared: &Shared, parallel: &mut impl Parallel) -> Result<()> {
    let at_vertices = vertices::vertices(shared, parallel)?;
    let found = solve::irradiances(shared, parallel)?;
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    let threshold = network.judge.threshold;
    for (leaf, within) in found {
        let node = &mut network.judge.elements.nodes[leaf as usize];
        let corners = node.corners.map(|vertex| at_vertices[vertex as usize].to_f64());
        let mean = (corners[0] + corners[1] + corners[2]) / 3.0;
        if (mean - within).abs().max_element() * node.area.sqrt() > BETWEEN * threshold {
            node.is_cut = true;
        }
    }
    Ok(())
}

/// Photons that give a first idea of how bright it is.
const PHOTONS: u64 = 1024;

/// The root of the integral of the square of direct irradiance, roughly. The integral is what photons find of irradiance where
/// they land: what they see of a spot is its share of the light, however small it is.
fn first_norm(network: &Network) -> Result<f64> {
    let Judge { scene, elements, .. } = &network.judge;
    let (emitters, numbers) = (scene.emitters(), scene.face_numbers());
    let mut sum = 0.0;
    if let Some(emission) = Emission::new(scene, PhotonSharing::Power, Aim::Everywhere)? {
        for photon in 0..PHOTONS {
            let mut rng = Rng::new(0, photon);
            let (u, d) = (rng.next_4d(), rng.next_4d());
            let Some((ray, power)) = emission.begin(scene, u, d, 1.0 / PHOTONS as f64) else { continue };
            let Some(hit) = scene.intersect(&ray) else { continue };
            let at = scene.interaction(&ray, &hit);
            let front = at.ng.dot(ray.direction) < 0.0;
            let normal = if front { at.ng } else { -at.ng };
            let (face, weights) = numbers.of(&hit);
            // Mirrors, glass and what is black have no elements.
            if elements.leaf_at(face, front, weights, at.point.p.as_dvec3()).is_none() {
                continue;
            }
            if let Some(light) = emitters.sample(Receiver::facing(at.point.p, normal), rng.next_4d()) {
                let origin = at.point.offset(normal);
                let shadow = Ray { origin, direction: light.target - origin, tnear: 0.0, tfar: 1.0 };
                let cosine = f64::from(normal.dot(light.wi).max(0.0) / light.pdf);
                let seen = if cosine > 0.0 && scene.unoccluded(&shadow) { cosine } else { 0.0 };
                sum += seen * (power.to_f64() * light.radiance.to_f64()).max_element();
            }
        }
    }
    if sum > 0.0 && sum.is_finite() {
        return Ok(sum.sqrt());
    }
    // Where no photon landed on what is lit, or one at a light itself: as if all were, evenly.
    let power: f64 = emitters.emitters().iter().map(|emitter| emitter.power().max_element()).sum();
    let area: f64 = elements.patches.iter().map(|patch| elements.nodes[patch.node as usize].area).sum();
    Ok((power / area.max(f64::MIN_POSITIVE).sqrt()).max(f64::MIN_POSITIVE))
}
