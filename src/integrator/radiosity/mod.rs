//! Radiosity: the light of a diffuse scene, solved once for all surfaces and for every view.
//!
//! Surfaces are divided into elements, and form factors say what fraction of the light that leaves one element reaches
//! another. The result is a system of linear equations. The system is hierarchical: distant parts of a wall exchange
//! light as wholes, so that its cost grows about in proportion to the number of elements. Images of the solution cost
//! one ray for each sample.
//!
//! # Method
//!
//! - Elements are sides of triangles, subdivided where irradiance changes ([`form_factor`], `elements`, `links`).
//!   Inscribed triangles stand for spheres, disks and quadrics, with the areas of these shapes.
//! - Above the elements is a hierarchy of clusters, which exchange light as points do, by functions of direction.
//!   Scenes of many triangles are therefore no worse than others.
//! - Rays measure what fraction of a pair's light is blocked.
//! - The solution is irradiance at vertices, and it is continuous over flat surfaces and smooth ones. Emission is never
//!   interpolated.
//! - With `radiosityFinalGather`, surfaces that the camera sees take direct light from light samples and indirect light
//!   from a ray into the solution: shadows and contacts are as sharp as a path tracer's.
//!
//! # When it is a poor choice
//!
//! Where surfaces are not diffuse: mirrors and glass are black in the solution, and rough diffuse surfaces are
//! Lambertian with the same mean albedo. Where shadows are smaller than elements, unless the final gather draws them.
//!
//! ```json
//! {"integrator": "radiosity", "radiosityError": 1, "radiosityIterations": null, "radiosityTolerance": 0.0001,
//!  "radiositySolver": "gather", "radiosityAmbient": false, "radiosityFinalGather": false, "radiosityMemory": 1024}
//! ```
//!
//! Sources: Goral et al. 1984, "Modeling the Interaction of Light Between Diffuse Surfaces"; Cohen et al. 1988, "A
//! Progressive Refinement Approach to Fast Radiosity Image Generation"; Hanrahan, Salzman, Aupperle 1991, "A Rapid
//! Hierarchical Radiosity Algorithm"; Smits, Arvo, Greenberg 1994, "A Clustering Algorithm for Radiosity in Complex
//! Environments".

mod albedo;
mod course;
mod elements;
pub mod form_factor;
mod gather;
mod light;
mod links;
mod node_irradiance;
mod oracle;
mod picture;
mod refine;
mod rows;
mod sampled;
mod shoot;
mod solve;
mod tessellate;
mod textured;
mod vertices;
mod visibility;

pub(crate) use course::{Extent, Steps};
pub(crate) use picture::RadiosityPicture;

use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::{Duration, Instant};

use crate::control::{Parallel, Part};
use crate::desc::{IntegratorDesc, PhotonSharing, RadiosityDesc, RadiositySolver, check_radiosity};
use crate::emitter::Receiver;
use crate::error::Result;
use crate::integrator::check_support;
use crate::integrator::photon::{Aim, Emission};
use crate::math::{DVec3, Ray, Vec3};
use crate::sampling::Rng;
use crate::scene::{FaceNumbers, Hit, Scene};
use crate::spectrum::Rgb;
use course::{Course, Step};
use elements::{Elements, NONE};
use oracle::RefinementOracle;
use refine::{LinkHierarchy, SharedHierarchy};
use rows::Rows;
use solve::{Convergence, Iterations, MAX_ITERATIONS};

/// Size, convergence and cost of a solution.
#[derive(Clone, Copy, Debug, Default)]
pub struct RadiositySummary {
    /// Number of elements that are not subdivided any further; both sides of surfaces count.
    pub elements: usize,
    /// Number of links between elements or clusters.
    pub links: usize,
    /// Iterations of the last solution: bounces gathered, or patches and point lights that shot.
    pub iterations: u32,
    /// Change by the last iteration over the total, both as sums of area times radiosity.
    pub residual: f64,
    /// Bound on the change by further iterations, in the same measure. It does not include the error of the links.
    pub error_bound: f64,
    /// Standard error of what light from infinity and points that shine unevenly bring to an element at first hand, over that light;
    /// both as root mean square by area. 0 for a scene without such lights.
    pub sampling_error: f64,
    /// Light emitted and light absorbed by surfaces (W), for each channel. Of light from infinity, what meets elements counts as
    /// emitted.
    pub emitted: Rgb,
    /// See `emitted`.
    pub absorbed: Rgb,
    /// Memory of elements and links during the solution, bytes.
    pub memory: usize,
    /// Time that the solution took.
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
    steps: Steps,
}

/// The elements of a surface, as triangles. Neighbours share vertices, but not where a texture varies the surface: there each element
/// reflects and emits by means of its own.
#[derive(Clone, Debug, Default)]
pub struct RadiosityMesh {
    /// Positions, world frame.
    pub positions: Vec<DVec3>,
    /// Radiosity at each vertex [W m^-2]: emitted and reflected.
    pub radiosity: Vec<Rgb>,
    /// Irradiance at each vertex [W m^-2].
    pub irradiance: Vec<Rgb>,
    /// Three indices for each triangle, counter-clockwise seen from the side that it belongs to.
    pub triangles: Vec<[u32; 3]>,
}

/// Factors on the allowed error of a link in the first refinements, when radiosities are not known yet.
const COARSE_FACTORS: [f64; 4] = [64.0, 16.0, 4.0, 1.0];

/// Number of further refinements at the full accuracy.
const FULL_REFINEMENTS: usize = 2;

/// Number of times that discontinuous leaves are subdivided: those whose vertices interpolate the irradiance inside
/// badly. A leaf counts as discontinuous where the difference exceeds this multiple of a link's allowed error.
const SUBDIVISIONS: usize = 2;
const DISCONTINUITY_THRESHOLD: f64 = 3.0;

/// Most balances of the leaves. A balance depends on the radiosities, which it changes. In the last balance each leaf
/// traces its own visibility rays.
const MAX_BALANCES: u32 = 6;

/// Once an iteration after a balance changes no more than this, only the last balance follows.
const SETTLED_CHANGE: f64 = 1e-3;

/// Most iterations between two balances. Before all leaves are balanced, some may gather more light than there is, and
/// the iteration may diverge.
const ITERATIONS_PER_BALANCE: usize = 8;

/// Of a fixed number of bounces, this many are balanced each by itself; later bounces are similar enough to each other.
const BALANCED_BOUNCES: u32 = 8;

/// Iterations between refinements.
const ITERATIONS_PER_REFINEMENT: usize = 3;

/// Fraction of the work that is done after each refinement, by the number of pairs that are evaluated in it in typical
/// scenes.
const PROGRESS_LINKED: [f64; COARSE_FACTORS.len() + FULL_REFINEMENTS] = [0.05, 0.15, 0.3, 0.45, 0.5, 0.52];

/// The same after each subdivision of discontinuous leaves.
const PROGRESS_SUBDIVIDED: [f64; SUBDIVISIONS] = [0.63, 0.75];

/// The same when the leaves are balanced, and when the system of equations is solved.
const PROGRESS_BALANCED: f64 = 0.9;
const PROGRESS_SOLVED: f64 = 0.95;

impl Radiosity {
    /// Solves a scene. The result is the same for any number of threads.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Unsupported`] for surfaces and emitters that the method does not take (see [`check_support`]);
    /// [`crate::ErrorKind::InvalidScene`] for settings that no file could have given; `OutOfMemory` where elements and
    /// links take more than `memory` allows; `Cancelled`.
    pub fn solve(scene: &Scene, desc: &RadiosityDesc, parallel: &mut impl Parallel) -> Result<Self> {
        Self::solve_to(scene, desc, Extent::Steps(Steps::WHOLE), parallel)
    }

    /// [`Self::solve`], which may end early: links are then less accurate, or what follows them is left out.
    pub(crate) fn solve_to(
        scene: &Scene,
        desc: &RadiosityDesc,
        extent: Extent,
        parallel: &mut impl Parallel,
    ) -> Result<Self> {
        check_support(scene, IntegratorDesc::Radiosity)?;
        let start = Instant::now();
        let mut course = Course::new(extent);
        check_radiosity("render", desc)?;
        parallel.check()?;
        let limit = (desc.memory as usize).saturating_mul(1 << 20);
        let elements = Elements::new(scene, desc.element_size, limit)?;
        let mut notes = Vec::new();
        if elements.patches.is_empty() {
            notes.push("radiosity: no surface is diffuse or emits, the solution is empty".to_owned());
        }
        let mut hierarchy = LinkHierarchy::new(scene, elements)?;
        hierarchy.divide_lamps(|| parallel.check())?;
        let shared: SharedHierarchy = Arc::new(RwLock::new(hierarchy));
        // Without bounces, the solution is the surfaces' emission.
        let is_emission = desc.iterations == Some(0) && !desc.ambient;
        let has_transport =
            !scene.emitters().is_dark() && !is_emission && !read(&shared).oracle.elements.patches.is_empty();
        let (convergence, ambient) = if has_transport {
            link_scene(&shared, desc, &mut course, parallel)?;
            course.step(Step::Measuring, || measure_links(&shared, parallel))?;
            balance_leaves(&shared, &mut course, parallel)?;
            let is_short = course.is_short();
            solve_system(&shared, desc, is_short, &mut Part::new(parallel, PROGRESS_BALANCED..PROGRESS_SOLVED))?
        } else {
            let mut hierarchy = write(&shared);
            hierarchy.first = vec![0; hierarchy.oracle.elements.nodes.len() + 1];
            Default::default()
        };
        parallel.progress(PROGRESS_SOLVED);
        let (irradiance, leaves) = final_irradiance(&shared, desc, ambient, &mut course, parallel)?;
        let mut hierarchy = write(&shared);
        let mut summary = RadiositySummary {
            links: hierarchy.links.len(),
            memory: hierarchy.bytes(),
            iterations: convergence.iterations,
            residual: convergence.residual,
            // Where nothing changed any more, nothing is left to bound, whatever the albedos are.
            error_bound: if convergence.residual == 0.0 { 0.0 } else { convergence.bound },
            ..RadiositySummary::default()
        };
        let elements = std::mem::take(&mut hierarchy.oracle.elements);
        let from_infinity = hierarchy.sampled.as_ref().map_or(DVec3::ZERO, |sampled| {
            summary.sampling_error = sampled.relative_error;
            sampled.from_infinity
        });
        summary.add_power(scene, &elements, &leaves, from_infinity);
        summary.elapsed = start.elapsed();
        notes.push(summary.note(solve::largest_albedo(&elements) < 1.0));
        let steps = course.steps();
        if !steps.is_whole() {
            notes.push(course.note(hierarchy.oracle.threshold / hierarchy.oracle.allowed));
        }
        let numbers = scene.face_numbers();
        Ok(Self { elements, numbers, scene: scene.clone(), irradiance, summary, notes, steps })
    }

    /// Irradiance [W m^-2] at a hit of a ray in the same scene, on the outer side of the surface (`front`) or the inner
    /// one. `p` is the point, scene frame. The result is 0 on surfaces that neither reflect diffusely nor emit.
    #[inline]
    pub fn irradiance(&self, hit: &Hit, p: Vec3, front: bool) -> Rgb {
        let (face, weights) = self.numbers.of(hit);
        self.at(face, weights, p.as_dvec3(), front).unwrap_or(Rgb::ZERO)
    }

    /// The same for a point of a described surface. Of a triangle, quad or mesh, it is given by the `primitive` and the
    /// weights of its second and third vertex as in [`crate::scene::HitDescription`]; of other shapes, by the point
    /// `p`, world frame.
    ///
    /// `None` where the surface has no such primitive, or no part of it reflects diffusely or emits.
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

    /// Size, convergence and cost of the solution.
    pub fn summary(&self) -> &RadiositySummary {
        &self.summary
    }

    /// Where the solution ended.
    pub(crate) fn steps(&self) -> Steps {
        self.steps
    }

    /// Notes for the user.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The elements of one side of a surface, or of all surfaces, as a mesh.
    pub fn mesh(&self, surface: Option<u32>, front: bool) -> RadiosityMesh {
        let elements = &self.elements;
        let mut mesh = RadiosityMesh::default();
        let mut known = std::collections::HashMap::new();
        for (number, node) in (0..).zip(&elements.nodes).filter(|(_, node)| node.patch != NONE && node.is_leaf()) {
            let patch = &elements.patches[node.patch as usize];
            if patch.is_front != front || surface.is_some_and(|surface| surface != patch.surface) {
                continue;
            }
            let own = if elements.varies(number) { number } else { NONE };
            let mut corners = node.corners.map(|vertex| {
                *known.entry((vertex, own)).or_insert_with(|| {
                    let irradiance = self.irradiance[vertex as usize];
                    mesh.positions.push(elements.vertices[vertex as usize] + self.scene.centre());
                    mesh.irradiance.push(irradiance);
                    mesh.radiosity.push(
                        Rgb::from_f64(elements.emitted(number)) + Rgb::from_f64(elements.albedo(number)) * irradiance,
                    );
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

impl RadiositySummary {
    /// Counts the leaves, and adds up the power that emitters emit and that surfaces absorb. `from_infinity`: what of that light meets
    /// elements.
    fn add_power(&mut self, scene: &Scene, elements: &Elements, leaves: &[(u32, DVec3)], from_infinity: DVec3) {
        let mut absorbed = DVec3::ZERO;
        for &(leaf, irradiance) in leaves {
            let node = &elements.nodes[leaf as usize];
            absorbed += node.area * (1.0 - elements.albedo(leaf)) * irradiance;
            self.elements += 1;
        }
        let near = scene.emitters().emitters().iter().filter(|emitter| !emitter.is_infinite());
        let emitted = near.map(crate::emitter::Emitter::power).sum::<DVec3>() + from_infinity;
        (self.emitted, self.absorbed) = (Rgb::from_f64(emitted), Rgb::from_f64(absorbed));
    }

    /// Fraction of the emitted light that no surface absorbed. It left the scene, or the error of the links lost it; below 0 they made it.
    /// `None` without light.
    pub fn lost(&self) -> Option<f64> {
        let [emitted, absorbed] = [self.emitted, self.absorbed].map(|power| power.to_f64().element_sum());
        (emitted > 0.0).then(|| 1.0 - absorbed / emitted)
    }

    /// The note that tells the user about size and convergence. `is_bounded`: whether all albedos are below 1.
    fn note(&self, is_bounded: bool) -> String {
        let bound = if self.error_bound.is_finite() {
            format!("bound {:.1e}", self.error_bound)
        } else if is_bounded {
            "no bound after so few".to_owned()
        } else {
            "no bound, a surface reflects all of a colour".to_owned()
        };
        let sampling = match self.sampling_error {
            0.0 => String::new(),
            error => format!(", direct light sampled within {error:.1e}"),
        };
        let lost = self
            .lost()
            .map_or_else(String::new, |lost| format!(", {:.2} % of the light came to nothing", 100.0 * lost));
        format!(
            "radiosity: {} elements, {} links, {} iterations, residual {:.1e}, {bound}{sampling}{lost}, {:.1} MiB, {:.1} s",
            self.elements,
            self.links,
            self.iterations,
            self.residual,
            self.memory as f64 / f64::from(1 << 20),
            self.elapsed.as_secs_f64(),
        )
    }
}

fn read(shared: &SharedHierarchy) -> RwLockReadGuard<'_, LinkHierarchy> {
    shared.read().unwrap_or_else(PoisonError::into_inner)
}

fn write(shared: &SharedHierarchy) -> RwLockWriteGuard<'_, LinkHierarchy> {
    shared.write().unwrap_or_else(PoisonError::into_inner)
}

/// Measures sampled light, and the visible fraction of all links by the irradiance at vertices, and updates the radiosities.
fn measure_links(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    sampled::measure(shared, parallel)?;
    let at_vertices = vertices::vertices(shared, parallel)?;
    write(shared).oracle.at_vertices = at_vertices;
    refine::measure_visibility(shared, parallel)?;
    let rows = Rows::new(shared, parallel)?;
    write(shared).rows = rows.map(Box::new);
    solve::gauss_seidel_iteration(shared, parallel)?;
    Ok(())
}

/// Balances the leaves until the radiosities have settled. In the last balance, leaves trace their own visibility rays.
fn balance_leaves(shared: &SharedHierarchy, course: &mut Course, parallel: &mut impl Parallel) -> Result<()> {
    let start = PROGRESS_SUBDIVIDED[SUBDIVISIONS - 1];
    let mut is_settled = false;
    for count in 1..=MAX_BALANCES {
        let is_last = is_settled || count == MAX_BALANCES;
        let step = if is_last { Step::LastBalance } else { Step::Balance };
        if !course.step(step, || solve::balance(shared, is_last, parallel))? {
            break;
        }
        parallel.progress(start + (PROGRESS_BALANCED - start) * f64::from(count) / f64::from(MAX_BALANCES));
        if is_last {
            break;
        }
        let mut change = solve::gauss_seidel_iteration(shared, parallel)?;
        is_settled = change < SETTLED_CHANGE;
        // An iteration is far cheaper than a balance, and a balance is better the closer radiosities are to the
        // solution.
        for _ in 1..ITERATIONS_PER_BALANCE {
            if change < SETTLED_CHANGE || !change.is_finite() {
                break;
            }
            change = solve::gauss_seidel_iteration(shared, parallel)?;
        }
    }
    Ok(())
}

/// Solves the system of equations; `is_short`: leaves are not balanced to the end. Returns the ambient irradiance too, which is 0 for
/// gathering.
fn solve_system(
    shared: &SharedHierarchy,
    desc: &RadiosityDesc,
    is_short: bool,
    parallel: &mut impl Parallel,
) -> Result<(Convergence, DVec3)> {
    if is_short && desc.iterations.is_none() {
        // Where leaves are not balanced to the end, iterations may diverge.
        let most = ITERATIONS_PER_BALANCE as u32;
        let iterations = Iterations::Until { tolerance: desc.tolerance, most };
        return Ok((solve::gather(shared, iterations, parallel)?, DVec3::ZERO));
    }
    match desc.solver {
        // The last bounce of a fixed number is gathered at the vertices.
        RadiositySolver::Gather => {
            let iterations = match desc.iterations {
                Some(count) => Iterations::Fixed { count: count.saturating_sub(1), balanced: BALANCED_BOUNCES },
                None => Iterations::Until { tolerance: desc.tolerance, most: MAX_ITERATIONS },
            };
            let convergence = solve::gather(shared, iterations, parallel)?;
            let iterations = desc.iterations.unwrap_or(convergence.iterations);
            Ok((Convergence { iterations, ..convergence }, DVec3::ZERO))
        }
        RadiositySolver::Shoot => shoot::shoot(shared, desc.iterations, desc.tolerance, parallel),
    }
}

/// Irradiance at vertices, which is the solution, and irradiance of the leaves by number.
type FinalIrradiance = (Vec<Rgb>, Vec<(u32, DVec3)>);

/// The irradiance that the solved hierarchy comes to.
fn final_irradiance(
    shared: &SharedHierarchy,
    desc: &RadiosityDesc,
    ambient: DVec3,
    course: &mut Course,
    parallel: &mut impl Parallel,
) -> Result<FinalIrradiance> {
    if desc.iterations.is_some_and(|count| count > 0) {
        solve::balance(shared, true, parallel)?;
    }
    let mut leaves = node_irradiance::leaf_irradiances(shared, parallel)?;
    let mut irradiance = match course.gathers_at_vertices() {
        true => vertices::vertices(shared, parallel)?,
        false => vertices::means(&read(shared).oracle.elements, &leaves),
    };
    vertices::conserve(&read(shared).oracle.elements, &mut irradiance, &leaves);
    if desc.iterations == Some(0) {
        leaves.iter_mut().for_each(|(_, e)| *e = DVec3::ZERO);
        irradiance.fill(Rgb::ZERO);
    }
    if desc.ambient {
        let ambient = Rgb::from_f64(ambient);
        irradiance.iter_mut().for_each(|e| *e += ambient);
    }
    Ok((irradiance, leaves))
}

/// Links all elements and clusters, first with a large allowed error, then with smaller ones as radiosities become
/// known. The first links are made in any case.
fn link_scene(
    shared: &SharedHierarchy,
    desc: &RadiosityDesc,
    course: &mut Course,
    parallel: &mut impl Parallel,
) -> Result<()> {
    let allowed = 1e-3 * desc.error;
    let mut norm = estimate_norm(&read(shared))?;
    let mut pairs = refine::first_pairs(&read(shared));
    let last = COARSE_FACTORS.len() - 1;
    for step in 0..COARSE_FACTORS.len() + FULL_REFINEMENTS {
        let coarse_factor = COARSE_FACTORS[step.min(last)];
        if course.refines_no_more(read(shared).links.len(), 0) {
            return Ok(());
        }
        {
            let oracle = &mut write(shared).oracle;
            (oracle.threshold, oracle.allowed) = (coarse_factor * allowed * norm, allowed * norm);
        }
        // Before links, which are sorted by the leaves that there are.
        sampled::divide(shared, parallel)?;
        if step > 0 {
            pairs = refine::take_inaccurate(shared, parallel)?;
        }
        let count = pairs.len();
        refine::refine(shared, pairs, course, parallel)?;
        sampled::estimate(shared, parallel)?;
        pairs = Vec::new();
        if step > last && count == 0 {
            break;
        }
        for _ in 0..ITERATIONS_PER_REFINEMENT {
            solve::jacobi_iteration(shared, parallel)?;
        }
        let found = node_irradiance::leaf_irradiances(shared, parallel)?;
        let nodes = &read(shared).oracle.elements.nodes;
        let square = |(leaf, e): &(u32, DVec3)| nodes[*leaf as usize].area * e.max_element().powi(2);
        let total = found.iter().map(square).sum::<f64>().sqrt();
        if total > 0.0 {
            norm = total;
        }
        parallel.progress(PROGRESS_LINKED[step]);
    }
    for done in PROGRESS_SUBDIVIDED {
        if course.refines_no_more(read(shared).links.len(), 0) {
            return Ok(());
        }
        mark_discontinuities(shared, parallel)?;
        let pairs = refine::take_inaccurate(shared, parallel)?;
        if pairs.is_empty() {
            break;
        }
        refine::refine(shared, pairs, course, parallel)?;
        sampled::estimate(shared, parallel)?;
        for _ in 0..ITERATIONS_PER_REFINEMENT {
            solve::jacobi_iteration(shared, parallel)?;
        }
        parallel.progress(done);
    }
    Ok(())
}

/// Marks the leaves whose vertices interpolate the irradiance inside badly: those at the edges of shadows.
fn mark_discontinuities(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    let at_vertices = vertices::vertices(shared, parallel)?;
    let found = node_irradiance::leaf_irradiances(shared, parallel)?;
    let mut hierarchy = write(shared);
    let threshold = hierarchy.oracle.threshold;
    for (leaf, within) in found {
        let node = &mut hierarchy.oracle.elements.nodes[leaf as usize];
        let corners = node.corners.map(|vertex| at_vertices[vertex as usize].to_f64());
        let mean = (corners[0] + corners[1] + corners[2]) / 3.0;
        if (mean - within).abs().max_element() * node.area.sqrt() > DISCONTINUITY_THRESHOLD * threshold {
            node.is_discontinuous = true;
        }
    }
    Ok(())
}

/// Photons for the first estimate of the scene's irradiance.
const NORM_PHOTONS: u64 = 1024;

/// The root of the integral of squared direct irradiance, estimated roughly. The integral is the mean of the irradiance
/// where emitted photons land: a small bright spot counts by its fraction of the light, however small the spot is.
fn estimate_norm(hierarchy: &LinkHierarchy) -> Result<f64> {
    let RefinementOracle { scene, elements, .. } = &hierarchy.oracle;
    let (emitters, numbers) = (scene.emitters(), scene.face_numbers());
    let mut sum = 0.0;
    if let Some(emission) = Emission::new(scene, PhotonSharing::Power, Aim::Everywhere)? {
        for photon in 0..NORM_PHOTONS {
            let mut rng = Rng::new(0, photon);
            let (u, d) = (rng.next_4d(), rng.next_4d());
            let Some((ray, power)) = emission.begin(scene, u, d, 1.0 / NORM_PHOTONS as f64) else { continue };
            let Some(hit) = scene.intersect(&ray) else { continue };
            let at = scene.interaction(&ray, &hit);
            let front = at.ng.dot(ray.direction) < 0.0;
            let normal = if front { at.ng } else { -at.ng };
            let (face, weights) = numbers.of(&hit);
            // Mirrors, glass and black surfaces have no elements.
            if elements.leaf_at(face, front, weights, at.point.p.as_dvec3()).is_none() {
                continue;
            }
            if let Some(light) = emitters.sample(Receiver::facing(at.point.p, normal), rng.next_4d()) {
                let origin = at.point.offset(normal);
                let shadow = Ray::segment(origin, light.target - origin, 1.0);
                let cosine = f64::from(normal.dot(light.wi).max(0.0) / light.pdf);
                let seen = if cosine > 0.0 && scene.unoccluded(&shadow) { cosine } else { 0.0 };
                sum += seen * (power.to_f64() * light.radiance.to_f64()).max_element();
            }
        }
    }
    if sum > 0.0 && sum.is_finite() {
        return Ok(sum.sqrt());
    }
    // No photon landed on a lit surface, or one landed at a light itself: all power is spread evenly over all surfaces.
    let power: f64 = emitters.emitters().iter().map(|emitter| emitter.power().max_element()).sum();
    let area: f64 = elements.patches.iter().map(|patch| elements.nodes[patch.node as usize].area).sum();
    Ok((power / area.max(f64::MIN_POSITIVE).sqrt()).max(f64::MIN_POSITIVE))
}
