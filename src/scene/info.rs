//! Information about a scene: its contents, the structures that were built for it, and the reasons for them.

use std::fmt;
use std::time::Duration;

use super::record::{BuildFacts, GeometryRecord};
use crate::bsdf::{Bsdf, Model as _};
use crate::desc::{BsdfDesc, IntegratorDesc, RouletteDesc, SceneDesc, SurfaceDesc};
use crate::emitter::EmitterSet;
use crate::math::Bounds;

/// Range of a scene's extent in which products of three lengths, and with them the kernel's tests, neither overflow nor
/// underflow.
const SAFE_SIZES: std::ops::RangeInclusive<f64> = 1e-8..=1e9;

/// The figures of a built scene. Its `Display` is the text that `etendue info` prints.
#[derive(Clone, Debug, Default)]
pub struct SceneInfo {
    /// Number of surfaces described.
    pub surfaces: usize,
    /// Number of materials described.
    pub materials: usize,
    /// Number of triangles that Embree holds in the scene frame.
    pub triangles: usize,
    /// Number of instances: uses of meshes that have hierarchies of their own.
    pub instances: usize,
    /// Number of triangles of the instanced meshes, each counted once.
    pub shared_triangles: usize,
    /// Number of spheres, disks and quadrics that are tested in a list before Embree.
    pub listed_shapes: usize,
    /// Number of spheres, disks and quadrics that Embree holds as user geometry.
    pub embree_shapes: usize,
    /// Number of emitters that can be sampled.
    pub emitters: usize,
    /// Number of emitters that are point lights.
    pub point_lights: usize,
    /// Number of meshes that are shaded smoothly.
    pub smooth_meshes: usize,
    /// Box around all surfaces, in the world frame.
    pub bounds: Bounds,
    /// Bytes of vertices, indices and normals, without those that a host keeps, and of the cache of triangles for
    /// shading.
    pub geometry_bytes: usize,
    /// Bytes that Embree holds for this scene's hierarchies, including those that it shares with the scene it was
    /// rebuilt from.
    pub embree_bytes: usize,
    /// Time that the whole build took.
    pub build_time: Duration,
    /// The decisions that the build made, one per line.
    pub decisions: Vec<String>,
    /// Features that this scene does not need and that therefore cost it nothing.
    pub switched_off: Vec<&'static str>,
    /// How radiosity treats surfaces that are not Lambertian, with one line for each kind.
    pub not_diffuse: Vec<String>,
    /// Surfaces for which radiosity computes no irradiance, if there are any: they reflect nothing diffusely and do not
    /// emit.
    pub not_in_radiosity: Option<String>,
}

impl SceneInfo {
    pub(super) fn new(desc: &SceneDesc, record: &GeometryRecord, emitters: &EmitterSet, has_kernel: bool) -> Self {
        let facts = &record.facts;
        let mut decisions = facts.decisions.clone();
        if facts.listed_shapes > 0 {
            decisions.push(format!("{} analytic shapes are tested in a list before Embree", facts.listed_shapes));
        }
        let hosted = facts.host_instances;
        if record.is_dynamic {
            decisions.push(format!(
                "geometry is edited: {} uses of larger meshes are instances, which edits elsewhere leave alone",
                facts.instances - hosted
            ));
        } else if facts.instances > hosted {
            let shared = facts.instances - hosted;
            decisions.push(format!("{shared} uses of large shared meshes are instances of one copy each"));
        }
        if hosted > 0 {
            decisions.push(format!("{hosted} uses of meshes in the host's memory are instances, read in place"));
        }
        let stated = desc.materials.iter().filter(|material| material.survival.is_some()).count();
        if stated > 0 {
            decisions.push(match desc.render.roulette {
                RouletteDesc::Own => {
                    format!("the survival probabilities of {stated} materials are not used: Russian roulette is the library's own")
                }
                RouletteDesc::File => format!("Russian roulette uses the survival probabilities of {stated} materials"),
            });
        }
        let off = [
            (facts.listed_shapes == 0, "analytic shape list"),
            (facts.embree_shapes == 0, "user geometry"),
            (facts.instances == 0, "instances"),
            (facts.smooth_meshes == 0, "smooth normals"),
            (!has_kernel, "Embree"),
            (emitters.is_dark(), "emitter sampling"),
        ];
        Self {
            surfaces: desc.surfaces.len(),
            materials: desc.materials.len(),
            triangles: facts.triangles,
            instances: facts.instances,
            shared_triangles: facts.shared_triangles,
            listed_shapes: facts.listed_shapes,
            embree_shapes: facts.embree_shapes,
            emitters: emitters.emitters().len(),
            point_lights: emitters.point_lights(),
            smooth_meshes: facts.smooth_meshes,
            bounds: facts.bounds,
            geometry_bytes: facts.geometry_bytes,
            embree_bytes: facts.embree_bytes,
            build_time: Duration::ZERO,
            decisions,
            not_diffuse: not_diffuse(desc),
            not_in_radiosity: not_in_radiosity(desc),
            switched_off: off.into_iter().filter_map(|(is_off, name)| is_off.then_some(name)).collect(),
        }
    }
}

/// Collects warnings about parts of the description that were left out or deserve attention.
pub(super) fn warnings(desc: &SceneDesc, facts: &BuildFacts, emitters: &EmitterSet, dark_lights: usize) -> Vec<String> {
    let mut warnings = Vec::new();
    if !facts.dropped.is_empty() {
        let mut dropped: Vec<_> = facts.dropped.iter().collect();
        dropped.sort_by(|a, b| a.1.cmp(&b.1));
        let total: usize = dropped.iter().map(|(count, _)| count).sum();
        let mut places: Vec<String> =
            dropped.iter().take(5).map(|(count, path)| format!("{count} in {path}")).collect();
        if dropped.len() > places.len() {
            places.push(format!("and more in {} other surfaces", dropped.len() - places.len()));
        }
        warnings.push(format!("dropped {total} triangles without area: {}", places.join(", ")));
    }
    if let Some((count, first)) = &facts.copied {
        warnings.push(format!(
            "{count} uses of meshes are copied instead of instanced, which takes memory, because the kernel inverts transforms \
             in single precision and would lose theirs: a shear, or a stretch between two turns; the first is {first}"
        ));
    }
    let size = (facts.bounds.max - facts.bounds.min).max_element();
    if !facts.bounds.is_empty() && !SAFE_SIZES.contains(&size) {
        warnings.push(format!(
            "the scene is {size:e} units across: products of lengths may leave single precision; scale it to between \
             {:e} and {:e}",
            SAFE_SIZES.start(),
            SAFE_SIZES.end()
        ));
    }
    if dark_lights > 0 {
        warnings.push(format!("dropped {dark_lights} point lights without intensity"));
    }
    if desc.render.integrator == IntegratorDesc::Radiosity {
        warnings.extend(not_diffuse(desc));
    }
    if desc.surfaces.is_empty() {
        warnings.push("the scene has no surface: the image will be black".to_owned());
    } else if emitters.is_dark() {
        warnings.push("nothing in the scene emits light: the image will be black".to_owned());
    }
    warnings
}

/// The greatest number of surfaces that one warning names.
const NAMED: usize = 5;

/// Returns the number of surfaces of a description that satisfy `is_such`, and the names of the first ones; `None`
/// where there are none.
fn named(desc: &SceneDesc, is_such: impl Fn(&SurfaceDesc, &BsdfDesc) -> bool) -> Option<(usize, String)> {
    let such = |surface: &&SurfaceDesc| {
        let material = desc.materials.get(surface.material);
        !surface.hidden && material.is_some_and(|material| is_such(surface, &material.bsdf))
    };
    let count = desc.surfaces.iter().filter(such).count();
    let named = desc.surfaces.iter().filter(such).take(NAMED).map(|surface| {
        let material = &desc.materials[surface.material].name;
        if material.is_empty() { surface.path.clone() } else { format!("{} ({material})", surface.path) }
    });
    let mut named: Vec<String> = named.collect();
    if count > NAMED {
        named.push(format!("and {} more", count - NAMED));
    }
    (count > 0).then(|| (count, named.join(", ")))
}

fn is_specular(bsdf: &BsdfDesc) -> bool {
    Bsdf::new(bsdf).lobes().have_specular()
}

/// Lists how radiosity treats surfaces that are not Lambertian.
fn not_diffuse(desc: &SceneDesc) -> Vec<String> {
    let taken = |(count, names), as_what: &str| format!("radiosity takes {count} surfaces as {as_what}: {names}");
    let is_rough = |bsdf: &BsdfDesc| {
        let bsdf = Bsdf::new(bsdf);
        bsdf.lobes().have_diffuse() && bsdf.constant_f().is_none()
    };
    let specular = named(desc, |_, bsdf| is_specular(bsdf)).map(|it| taken(it, "black, being mirrors or glass"));
    let rough =
        named(desc, |_, bsdf| is_rough(bsdf)).map(|it| taken(it, "Lambert's of the same mean albedo, being rough"));
    specular.into_iter().chain(rough).collect()
}

/// Names the surfaces for which radiosity has no elements.
fn not_in_radiosity(desc: &SceneDesc) -> Option<String> {
    let is_black = |bsdf: &BsdfDesc| Bsdf::new(bsdf).is_black();
    let (count, names) =
        named(desc, |surface, bsdf| surface.emission.is_none() && (is_specular(bsdf) || is_black(bsdf)))?;
    Some(format!("radiosity finds no irradiance for {count} surfaces, which reflect nothing diffusely: {names}"))
}

impl fmt::Display for SceneInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mebibytes = |bytes: usize| bytes as f64 / (1024.0 * 1024.0);
        writeln!(f, "surfaces        {} of {} materials", self.surfaces, self.materials)?;
        writeln!(f, "triangles       {}", self.triangles)?;
        if self.instances > 0 {
            writeln!(f, "instances       {} of {} shared triangles", self.instances, self.shared_triangles)?;
        }
        writeln!(f, "analytic shapes {}", self.listed_shapes + self.embree_shapes)?;
        writeln!(f, "emitters        {} ({} points)", self.emitters, self.point_lights)?;
        if !self.bounds.is_empty() {
            let (min, max) = (self.bounds.min, self.bounds.max);
            writeln!(f, "bounds          [{}, {}, {}] to [{}, {}, {}]", min.x, min.y, min.z, max.x, max.y, max.z)?;
        }
        writeln!(
            f,
            "memory          {:.2} MiB geometry, {:.2} MiB Embree",
            mebibytes(self.geometry_bytes),
            mebibytes(self.embree_bytes)
        )?;
        writeln!(f, "built in        {:.1} ms", 1e3 * self.build_time.as_secs_f64())?;
        for decision in &self.decisions {
            writeln!(f, "decision        {decision}")?;
        }
        write!(f, "switched off    {}", self.switched_off.join(", "))
    }
}
