//! Information about a scene: its contents, the structures that were built for it, and the reasons for them.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use super::prepared_textures::PreparedTextures;
use super::record::{BuildFacts, GeometryRecord};
use crate::bsdf::{Bsdf, Lobes, Model as _};
use crate::desc::{
    BlockFacts, IntegratorDesc, LightDistribution, RouletteDesc, SceneDesc, SurfaceDesc, TextureSource, WebDesc,
};
use crate::emitter::{Emitter, EmitterSet};
use crate::math::Bounds;
use crate::photometry::{LampTilt, Web};
use crate::spectrum::Rgb;

/// Range of a scene's extent in which products of three lengths, and with them the kernel's tests, neither overflow nor
/// underflow.
const SAFE_SIZES: std::ops::RangeInclusive<f64> = 1e-8..=1e9;

/// The figures of a built scene. Its `Display` is the text that `etendue info` prints.
#[derive(Clone, Debug, Default)]
pub struct SceneInfo {
    /// The first photometric webs.
    pub webs: Vec<WebInfo>,
    /// Number of surfaces described.
    pub surfaces: usize,
    /// Number of materials described.
    pub materials: usize,
    /// Kinds of these materials, as files call them, and the number of each, in the order in which the description has them.
    pub kinds: Vec<(&'static str, usize)>,
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
    /// Number of emitters at infinity.
    pub infinite_emitters: usize,
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
    /// Number of textures that materials of surfaces use.
    pub textures: usize,
    /// Bytes of the images of these textures and of their smaller levels. The images are those of the description.
    pub texture_bytes: usize,
    /// Time that the whole build took.
    pub build_time: Duration,
    /// The decisions that the build made, one per line.
    pub decisions: Vec<String>,
    /// Features that this scene does not need and that therefore cost it nothing.
    pub switched_off: Vec<&'static str>,
    /// How radiosity treats surfaces that are not Lambertian, with one line for each kind.
    pub not_diffuse: Vec<String>,
    /// Surfaces for which radiosity computes no irradiance, on one side or on both, if there are any: they reflect nothing
    /// diffusely there and do not emit.
    pub not_in_radiosity: Option<String>,
}

impl SceneInfo {
    pub(super) fn new(
        desc: &SceneDesc,
        bsdfs: &[Bsdf],
        record: &GeometryRecord,
        emitters: &EmitterSet,
        textures: &PreparedTextures,
        has_kernel: bool,
    ) -> Self {
        let facts = &record.facts;
        let mut decisions = facts.decisions.clone();
        if facts.listed_shapes > 0 {
            decisions.push(format!("{} analytic shapes are tested in a list before Embree", facts.listed_shapes));
        }
        if facts.moving > 0 {
            decisions.push(format!("{} surfaces move or deform while the shutter is open", facts.moving));
        }
        let hosted = facts.host_instances;
        let elsewhere = hosted + facts.whole_placements;
        if record.is_dynamic {
            decisions.push(format!(
                "geometry is edited: {} uses of larger meshes are instances, which edits elsewhere leave alone",
                facts.instances - elsewhere
            ));
        } else if facts.instances > elsewhere {
            let shared = facts.instances - elsewhere;
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
        let glossy = bsdfs.iter().filter(|bsdf| bsdf.lit_lobes().intersects(Lobes::GLOSSY));
        let widths: Vec<f32> = glossy.map(Bsdf::narrowest).collect();
        if !widths.is_empty() {
            let of = |pick: fn(f32, f32) -> f32| widths.iter().copied().reduce(pick).unwrap_or_default();
            decisions.push(format!(
                "{} materials have glossy lobes; the narrowest lobe of each has a width alpha of {} to {}",
                widths.len(),
                of(f32::min),
                of(f32::max)
            ));
        }
        let anisotropic = bsdfs.iter().filter(|bsdf| bsdf.is_anisotropic()).count();
        if anisotropic > 0 {
            decisions.push(format!("tangents are found at hits of {anisotropic} anisotropic materials"));
        }
        let media = desc.bodies().iter().flatten().filter(|body| body.uses_medium()).count();
        if media > 0 {
            decisions
                .push(format!("paths follow the media that they are in: {media} materials absorb or have a priority"));
        }
        let images = TextureFacts::new(desc, textures);
        decisions.extend(images.lines);
        decisions.extend(emitters.environment_map().map(|map| {
            let [columns, rows] = map.grid_size();
            let size = format!("{columns} x {rows} points, {:.1} MB", map.bytes() as f64 / 1e6);
            format!("light from infinity varies by direction, and is sampled by its luminance at {size}")
        }));
        if desc.backplate.is_some() {
            decisions.push("rays of the camera that meet nothing show the backplate, which lights nothing".to_owned());
        }
        let used = desc.used_materials();
        let on_surfaces = || desc.materials.iter().zip(&used).filter(|(_, used)| **used).map(|(material, _)| material);
        let see_through = on_surfaces().filter(|material| !material.is_opaque()).count();
        if see_through > 0 {
            decisions.push(format!("rays pass surfaces by their opacity: {see_through} materials are not opaque"));
        }
        let lamps = on_surfaces().filter(|material| material.emission.is_some()).count();
        if lamps > 0 {
            decisions
                .push(format!("surfaces of {lamps} materials are emitters, unless they have an emission of their own"));
        }
        let is_two_sided = |it: &&SurfaceDesc| it.emits_both && it.emission.is_some() && !it.hidden;
        let lamps = desc.surfaces.of_blocks(|facts| facts.emits).map(|(_, surface)| surface);
        let two_sided = lamps.filter(is_two_sided).count();
        if two_sided > 0 {
            decisions.push(format!(
                "{two_sided} surfaces emit on both sides, by an emitter on each side of a triangle, disk or tube"
            ));
        }
        let shaped = lit_by_web(desc).count();
        if shaped > 0 {
            decisions.push(format!(
                "{shaped} surfaces shine by a photometric web, whose intensities over area and cosine are their radiance"
            ));
        }
        decisions.extend(spectra(desc, emitters));
        let off = [
            (see_through == 0, "opacity"),
            (textures.len() == 0, "textures"),
            (media == 0, "media"),
            (widths.is_empty(), "glossy lobes"),
            (anisotropic == 0, "tangents"),
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
            kinds: kinds(desc),
            triangles: facts.triangles,
            instances: facts.instances,
            shared_triangles: facts.shared_triangles,
            listed_shapes: facts.listed_shapes,
            embree_shapes: facts.embree_shapes,
            emitters: emitters.emitters().len(),
            point_lights: emitters.point_lights(),
            infinite_emitters: emitters.infinite(),
            webs: webs(desc),
            smooth_meshes: facts.smooth_meshes,
            bounds: facts.bounds,
            geometry_bytes: facts.geometry_bytes,
            embree_bytes: facts.embree_bytes,
            textures: textures.len(),
            texture_bytes: images.bytes,
            build_time: Duration::ZERO,
            decisions,
            not_diffuse: not_diffuse(desc, bsdfs),
            not_in_radiosity: not_in_radiosity(desc, bsdfs),
            switched_off: off.into_iter().filter_map(|(is_off, name)| is_off.then_some(name)).collect(),
        }
    }
}

/// What there is to say about textures.
struct TextureFacts {
    bytes: usize,
    lines: Vec<String>,
}

impl TextureFacts {
    fn new(desc: &SceneDesc, prepared: &PreparedTextures) -> Self {
        if prepared.len() == 0 {
            return Self { bytes: 0, lines: Vec::new() };
        }
        let mut bytes = prepared.bytes();
        let mut images = std::collections::HashMap::new();
        for (texture, space) in prepared.each() {
            if let TextureSource::Image(it) = &texture.source {
                images
                    .entry(Arc::as_ptr(&it.image))
                    .or_insert_with(|| (Arc::clone(&it.image), Vec::new()))
                    .1
                    .push(space);
            }
        }
        let mut spaces = [0; 3];
        for (image, of_image) in images.values() {
            bytes += image.texels().bytes();
            for space in of_image {
                spaces[*space as usize] += 1;
            }
        }
        let white = prepared.each().filter(|(texture, _)| texture.source == TextureSource::White).count();
        let patterns = prepared.len() - spaces.iter().sum::<usize>() - white;
        let colored = desc.textures.iter().any(|texture| texture.vertex_colors);
        let colors = if colored { ", colours of vertices" } else { "" };
        let mut lines = vec![format!(
            "textures: {} images of {:.1} MB with their levels ({} as sRGB, {} as linear light, {} as numbers), {patterns} patterns{colors}",
            images.len(),
            bytes as f64 / 1e6,
            spaces[0],
            spaces[1],
            spaces[2]
        )];
        let asked = textured(desc);
        if asked > 0 {
            lines.push(format!("{asked} materials are asked at every hit for what their textures say"));
        }
        Self { bytes, lines }
    }
}

/// Number of materials with textures.
fn textured(desc: &SceneDesc) -> usize {
    desc.materials.iter().filter(|material| !material.textures.is_empty()).count()
}

/// Counts materials by their kinds.
fn kinds(desc: &SceneDesc) -> Vec<(&'static str, usize)> {
    let mut kinds: Vec<(&'static str, usize)> = Vec::new();
    for kind in desc.materials.iter().map(|material| material.bsdf.kind()) {
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((kind, 1)),
        }
    }
    kinds
}

/// Collects warnings about parts of the description that were left out or deserve attention.
pub(super) fn warnings(
    desc: &SceneDesc,
    bsdfs: &[Bsdf],
    facts: &BuildFacts,
    emitters: &EmitterSet,
    dark_lights: usize,
) -> Vec<String> {
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
    if let Some((off, first)) = facts.coarse.first() {
        let count = facts.coarse.len();
        warnings.push(format!(
            "{count} surfaces turn so far while the shutter is open that what is shown is off by more than a thousandth of their size; \
             the first is {first}, by {off:.2e} of its size"
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
    let is_sky = |emitter: &Emitter| matches!(emitter, Emitter::Environment(_) | Emitter::EnvironmentMap(_));
    if desc.environment.is_some() && !emitters.emitters().iter().any(is_sky) {
        warnings.push("dropped an environment without radiance".to_owned());
    }
    if desc.render.integrator == IntegratorDesc::Radiosity {
        warnings.extend(not_diffuse(desc, bsdfs));
    }
    let black = match desc.backplate {
        Some(_) => "all of the image but its backplate will be black",
        None => "the image will be black",
    };
    if desc.surfaces.is_empty() && !emitters.has_infinite() {
        if desc.backplate.is_none() {
            warnings.push(format!("the scene has no surface: {black}"));
        }
    } else if emitters.is_dark() {
        warnings.push(format!("nothing in the scene emits light: {black}"));
    }
    warnings
}

/// What is known by the wavelength.
fn spectra(desc: &SceneDesc, emitters: &EmitterSet) -> Option<String> {
    let lamps = emitters.with_own_spectrum();
    let materials = desc.materials.iter().filter(|it| !it.spectra.is_empty()).count();
    let use_of =
        if desc.render.spectral { "which paths carry" } else { "of which paths in three channels see the colours" };
    (lamps + materials > 0)
        .then(|| format!("{lamps} emitters and {materials} materials have spectra of their own, {use_of}"))
}

/// The surfaces that shine by a photometric web.
fn lit_by_web(desc: &SceneDesc) -> impl Iterator<Item = &SurfaceDesc> {
    let lamps = desc.surfaces.of_blocks(|facts| facts.shines_unevenly).map(|(_, surface)| surface);
    lamps.filter(|it| it.web.is_some() && it.emission.is_some() && !it.hidden)
}

/// The first photometric webs of a description, each once.
fn webs(desc: &SceneDesc) -> Vec<WebInfo> {
    let mut webs: Vec<(&Arc<Web>, WebInfo)> = Vec::new();
    let of_lights = desc.lights.iter().filter_map(|light| match &light.distribution {
        LightDistribution::Web(WebDesc { web, .. }) => Some((web, &light.path)),
        _ => None,
    });
    let of_surfaces = lit_by_web(desc).filter_map(|surface| Some((&surface.web.as_ref()?.web, &surface.path)));
    for (web, path) in of_lights.chain(of_surfaces) {
        if let Some((_, info)) = webs.iter_mut().find(|(known, _)| Arc::ptr_eq(known, web)) {
            info.lights += 1;
        } else if webs.len() < NAMED {
            let tilts = web.tilt().map(LampTilt::range);
            let (path, flux, stated) = (path.clone(), web.flux(), web.stated_flux());
            let info = WebInfo { path, lights: 1, flux, stated, tilts };
            webs.push((web, info));
        }
    }
    webs.into_iter().map(|(_, info)| info).collect()
}

/// The greatest number of surfaces that one warning names, and of webs that are told of.
const NAMED: usize = 5;

/// Returns the number of surfaces of a description that have such a material, with `unlit` those alone that have no emission of their own,
/// and the names of the first ones; `None` where there are none.
fn named(desc: &SceneDesc, unlit: bool, is_such: impl Fn(Option<usize>) -> bool) -> Option<(usize, String)> {
    let of_block = |facts: &BlockFacts| -> usize {
        let such = facts.materials.iter().filter(|it| is_such(it.material));
        such.map(|it| if unlit { it.unlit } else { it.surfaces }).sum()
    };
    let count = desc.surfaces.blocks().map(|block| of_block(block.facts())).sum();
    let shown = desc.surfaces.of_blocks(|facts| of_block(facts) > 0).map(|(_, surface)| surface);
    let shown = shown.filter(|it| !it.hidden && is_such(it.material) && !(unlit && it.emission.is_some()));
    let named = shown.take(NAMED).map(|surface| {
        let material = desc.material_of(surface).map_or("", |material| &material.name);
        if material.is_empty() { surface.path.clone() } else { format!("{} ({material})", surface.path) }
    });
    let mut named: Vec<String> = named.collect();
    if count > NAMED {
        named.push(format!("and {} more", count - NAMED));
    }
    (count > 0).then(|| (count, named.join(", ")))
}

/// How radiosity treats a surface that is not Lambertian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TakenAs {
    Black,
    WithoutSpecular,
    MeanAlbedo,
}

impl TakenAs {
    fn of(bsdf: &Bsdf) -> Option<Self> {
        match (bsdf.lobes().have_diffuse(), bsdf.lobes().have_specular()) {
            (false, true) => Some(Self::Black),
            (true, true) => Some(Self::WithoutSpecular),
            (true, false) if sides(bsdf).iter().any(is_rough) => Some(Self::MeanAlbedo),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Black => "black, being mirrors or glass",
            Self::WithoutSpecular => "diffuse alone, without their mirrors or glass",
            Self::MeanAlbedo => "Lambert's of the same mean albedo, being rough",
        }
    }
}

/// The models of the outer and of the inner side of a surface.
fn sides(bsdf: &Bsdf) -> [Bsdf; 2] {
    [true, false].map(|front| bsdf.on_side(front))
}

/// Whether the diffuse lobes on one side are not Lambert's.
fn is_rough(side: &Bsdf) -> bool {
    side.lit_lobes().have_diffuse() && side.constant_f().is_none()
}

/// Whether a surface, or one side of it, reflects nothing diffusely.
fn is_not_diffuse(bsdf: &Bsdf) -> bool {
    !bsdf.lobes().have_diffuse() || bsdf.diffuse_albedo() == Rgb::ZERO
}

/// Lists how radiosity treats surfaces that are not Lambertian.
fn not_diffuse(desc: &SceneDesc, bsdfs: &[Bsdf]) -> Vec<String> {
    let of_material: Vec<Option<TakenAs>> = bsdfs.iter().map(TakenAs::of).collect();
    let line = |taken: TakenAs| {
        let (count, names) =
            named(desc, false, |material| material.and_then(|it| *of_material.get(it)?) == Some(taken))?;
        Some(format!("radiosity takes {count} surfaces as {}: {names}", taken.name()))
    };
    [TakenAs::Black, TakenAs::WithoutSpecular, TakenAs::MeanAlbedo].into_iter().filter_map(line).collect()
}

/// Names the surfaces for which radiosity has no elements.
fn not_in_radiosity(desc: &SceneDesc, bsdfs: &[Bsdf]) -> Option<String> {
    let of_material: Vec<[bool; 2]> = bsdfs.iter().map(|bsdf| sides(bsdf).each_ref().map(is_not_diffuse)).collect();
    let of = |material: Option<usize>| material.map_or(Some(&[true; 2]), |it| of_material.get(it));
    let line = |absent: [bool; 2], what: &str| {
        let (count, names) = named(desc, true, |material| of(material) == Some(&absent))?;
        Some(format!("{what} {count} surfaces, which reflect nothing diffusely: {names}"))
    };
    let lines = [
        line([true; 2], "radiosity finds no irradiance for"),
        line([true, false], "radiosity finds no irradiance on the outer sides of"),
        line([false, true], "radiosity finds no irradiance on the inner sides of"),
    ];
    lines.into_iter().flatten().reduce(|all, line| format!("{all}; {line}"))
}

/// What is known of a photometric web.
#[derive(Clone, Debug, PartialEq)]
pub struct WebInfo {
    /// The first light or surface that has it.
    pub path: String,
    /// How many lights and surfaces have it.
    pub lights: usize,
    /// Luminous flux \[lm\]: the integral of its intensities.
    pub flux: f64,
    /// Luminous flux that its file states, of the lamps or of the luminaire \[lm\].
    pub stated: Option<f64>,
    /// The least and the largest tilt in degrees for which the file has a factor, where it has some.
    pub tilts: Option<[f64; 2]>,
}

impl fmt::Display for WebInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "web             {} ({} lights): {:.1} lm", self.path, self.lights, self.flux)?;
        if let Some(stated) = self.stated {
            write!(f, " of the {stated:.1} lm in its file")?;
        }
        if let Some([low, high]) = self.tilts {
            write!(f, ", factors of tilts from {low} to {high} degrees")?;
        }
        Ok(())
    }
}

impl fmt::Display for SceneInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mebibytes = |bytes: usize| bytes as f64 / (1024.0 * 1024.0);
        writeln!(f, "surfaces        {} of {} materials", self.surfaces, self.materials)?;
        if !self.kinds.is_empty() {
            let kinds: Vec<String> = self.kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
            writeln!(f, "materials       {}", kinds.join(", "))?;
        }
        writeln!(f, "triangles       {}", self.triangles)?;
        if self.instances > 0 {
            writeln!(f, "instances       {} of {} shared triangles", self.instances, self.shared_triangles)?;
        }
        writeln!(f, "analytic shapes {}", self.listed_shapes + self.embree_shapes)?;
        write!(f, "emitters        {} ({} points", self.emitters, self.point_lights)?;
        if self.infinite_emitters > 0 {
            write!(f, ", {} at infinity", self.infinite_emitters)?;
        }
        writeln!(f, ")")?;
        for web in &self.webs {
            writeln!(f, "{web}")?;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::LobeMixture;
    use crate::desc::{BsdfDesc, MicrofacetsDesc, ShapeDesc, SurfaceLook};
    use crate::emitter::{Emitter, EnvironmentEmitter, InfiniteBall};
    use crate::math::{DVec3, Vec3};
    use crate::scene::{BuildOptions, Scene};

    #[test]
    fn light_from_infinity_is_no_darkness() {
        let ball = || ShapeDesc::sphere(DVec3::ZERO, 1.0).unwrap();
        let mut with_ball = SceneDesc::default();
        let white = with_ball.add_material("white", BsdfDesc::Lambert { albedo: Rgb::ONE }, None).unwrap();
        let look = SurfaceLook { material: Some(white), ..SurfaceLook::default() };
        with_ball.add_surface(ball().0, ball().1, look).unwrap();
        let environment =
            |radiance| Emitter::Environment(EnvironmentEmitter::new(radiance, InfiniteBall::new(Vec3::ZERO, 2.0)));
        let point = Emitter::Point { position: Vec3::ZERO, intensity: Rgb::ONE };
        for (desc, black) in [(&SceneDesc::default(), "no surface"), (&with_ball, "nothing in the scene emits")] {
            let scene = Scene::build(desc, &BuildOptions::default()).unwrap();
            let of = |emitters: Vec<Emitter>| {
                let emitters = EmitterSet::new(emitters);
                let info = SceneInfo::new(desc, &[], &scene.record, &emitters, &PreparedTextures::default(), false);
                (info, warnings(desc, &[], &scene.record.facts, &emitters, 0))
            };
            let (info, warnings) = of(vec![point.clone(), environment(Rgb::ONE)]);
            assert_eq!((info.emitters, info.point_lights, info.infinite_emitters), (2, 1, 1));
            assert!(warnings.is_empty(), "{warnings:?}");
            assert!(info.to_string().contains("\nemitters        2 (1 points, 1 at infinity)\n"), "{info}");
            assert!(!info.switched_off.contains(&"emitter sampling"));
            for emitters in [vec![], vec![environment(Rgb::ZERO)]] {
                let (info, warnings) = of(emitters);
                assert_eq!(info.infinite_emitters, 0);
                assert!(matches!(&warnings[..], [one] if one.contains(black)), "{warnings:?}");
                assert!(!info.to_string().contains("infinity"), "{info}");
            }
        }
    }

    #[test]
    fn materials_are_told_by_kind_and_width() {
        let mut desc = SceneDesc::default();
        let facets = |roughness, anisotropy| MicrofacetsDesc { anisotropy, ..MicrofacetsDesc::rough(roughness) };
        let glass = |microfacets| BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets };
        let white = BsdfDesc::Lambert { albedo: Rgb::ONE };
        // Only materials that surfaces have count, so each gets one.
        let add = |desc: &mut SceneDesc, bsdf| {
            let material = Some(desc.add_material("", bsdf, None).unwrap());
            let (ball, local) = ShapeDesc::sphere(DVec3::ZERO, 1.0).unwrap();
            desc.add_surface(ball, local, SurfaceLook { material, ..SurfaceLook::default() }).unwrap();
        };
        for bsdf in [white, glass(facets(0.5, 0.0)), white, glass(facets(0.1, 0.0)), glass(facets(0.0, 0.0))] {
            add(&mut desc, bsdf);
        }
        let info = Scene::build(&desc, &BuildOptions::default()).unwrap().info().to_string();
        assert!(info.contains("\nmaterials       2 diffuse, 3 refractive\n"), "{info}");
        assert!(
            info.contains("2 materials have glossy lobes; the narrowest lobe of each has a width alpha of 0.01"),
            "{info}"
        );
        assert!(info.contains("switched off    opacity, textures, media, tangents, "), "{info}");
        add(&mut desc, glass(facets(0.5, 0.5)));
        let info = Scene::build(&desc, &BuildOptions::default()).unwrap().info().to_string();
        assert!(info.contains("tangents are found at hits of 1 anisotropic materials"), "{info}");
    }

    #[test]
    fn radiosity_tells_how_it_takes_mixtures() {
        let grey = |lobes: &[Lobes]| {
            let weights: Vec<_> = lobes.iter().map(|lobe| (*lobe, Rgb::splat(0.25))).collect();
            Bsdf::LobeMixture(LobeMixture::new(&weights, 20.0))
        };
        let (diffuse, mirror) = (Lobes::DIFFUSE_REFLECTION, Lobes::SPECULAR_REFLECTION);
        let cases = [
            (grey(&[diffuse]), None, false),
            (grey(&[mirror]), Some(TakenAs::Black), true),
            (grey(&[diffuse, mirror]), Some(TakenAs::WithoutSpecular), false),
            (Bsdf::new(&BsdfDesc::Black), None, true),
        ];
        for (bsdf, taken, is_absent) in cases {
            assert_eq!((TakenAs::of(&bsdf), is_not_diffuse(&bsdf)), (taken, is_absent), "{bsdf:?}");
        }
    }

    #[test]
    fn radiosity_tells_how_it_takes_sides() {
        let told = |bsdfs: [BsdfDesc; 2]| {
            let mut desc = SceneDesc::default();
            for bsdf in bsdfs {
                desc.add_material("", bsdf, None).unwrap();
            }
            let lined = desc.add_material("lined", BsdfDesc::TwoSided { front: 0, back: 1 }, None).unwrap();
            let look = SurfaceLook { material: Some(lined), ..SurfaceLook::default() };
            let (shape, local) = ShapeDesc::sphere(DVec3::ZERO, 1.0).unwrap();
            desc.add_surface(shape, local, look).unwrap();
            let info = Scene::build(&desc, &BuildOptions::default()).unwrap().info().clone();
            (info.not_diffuse.concat(), info.not_in_radiosity.unwrap_or_default())
        };
        let albedo = Rgb::splat(0.5);
        let (grey, dark) = (BsdfDesc::Lambert { albedo }, BsdfDesc::Lambert { albedo: Rgb::splat(0.1) });
        let rough = BsdfDesc::OrenNayar { albedo, roughness: 0.5 };
        assert_eq!(told([grey, dark]), Default::default());
        for faces in [[grey, rough], [rough, dark]] {
            let (taken, absent) = told(faces);
            assert!(taken.contains("1 surfaces as Lambert's of the same mean albedo, being rough"), "{taken}");
            assert!(absent.is_empty(), "{absent}");
        }
        let mirror = BsdfDesc::Mirror { reflectance: albedo };
        for (faces, side) in [([mirror, grey], "outer"), ([grey, BsdfDesc::Black], "inner")] {
            let (_, absent) = told(faces);
            assert!(absent.contains(&format!("no irradiance on the {side} sides of 1 surfaces")), "{absent}");
        }
        let (_, absent) = told([mirror, mirror]);
        assert!(absent.contains("no irradiance for 1 surfaces"), "{absent}");
    }
}
