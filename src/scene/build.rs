//! Builds a scene from a description, and rebuilds a scene after its description was edited.

use std::sync::Arc;
use std::time::Instant;

use super::assemble::{Assembly, assemble};
use super::backplate::Backplate;
use super::bindings::{Kept, KeptOwners, SurfaceBindings, bindings, rebind_materials};
use super::emissive::with_emission_of_materials;
use super::material::MaterialNeeds;
use super::media::Media;
use super::movement::{Movement, posed};
use super::options::BuildOptions;
use super::prepared_textures::PreparedTextures;
use super::record::AppearanceKey;
use super::tangents::SurfaceTangents;
use super::textured::Textured;
use super::{Material, Scene, SceneInfo, VaryingMaterial as _, frame, lower, roulette};
use crate::bsdf::{Black, Bsdf, ByWavelength};
use crate::camera::Camera;
use crate::control::{Cancel, WorkProgress};
use crate::desc::{CameraDesc, MaterialDesc, SceneDesc, ShapeDesc};
use crate::embree::{Device, DeviceOptions};
use crate::error::{Error, Result};

impl Scene {
    /// Builds the scene of a description.
    ///
    /// A scene that was built has no unresolved name, no vertex that is not finite, no index out of range, no
    /// degenerate triangle, no emitter without area, no shape without bounds, and no triangle too large for the ray
    /// kernel.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] or `Unsupported` with the JSON path for what cannot be rendered; `Device` or
    /// `OutOfMemory` from Embree; `Cancelled`.
    pub fn build(desc: &SceneDesc, options: &BuildOptions) -> Result<Self> {
        build(desc, options).map_err(|error| error.in_file(desc.file.as_deref(), 0))
    }

    /// Builds the scene of an edited description and reuses every part of this scene that did not change. This scene
    /// stays as it is and may be in use meanwhile.
    ///
    /// Changes are found by comparing the two descriptions, apart from the blocks of surfaces that both share
    /// ([`Surfaces`](crate::desc::Surfaces)): the description is best a clone of the one before that was edited. Two
    /// meshes are the same if they are the same `Arc`; two surfaces are the same if their shapes, their placements and
    /// whether they are hidden agree.
    ///
    /// - Edits of the camera, of materials, of lights, of which surface has which material, of the colour of an
    ///   emission, and of whether a surface other than a mesh emits, leave the geometry as it is. The camera may move
    ///   as far as the scene frame allows ([`Scene::centre`]); a move beyond that transfers the geometry to another
    ///   frame.
    /// - Any other edit is an edit of geometry. From the first such edit on, and from the beginning where
    ///   [`BuildOptions::dynamic`] was set, larger meshes that do not emit have hierarchies of their own, which are
    ///   reused. So have single triangles and quads, and single analytic shapes, if there are more than 1024 of the kind;
    ///   they are reused while none of the kind is edited and the origin of the scene frame stays. All other geometry is
    ///   built anew. The first edit of a scene that was not built with [`BuildOptions::dynamic`] therefore costs as much
    ///   as a build.
    ///
    /// # Errors
    /// The errors are those of [`Scene::build`].
    pub fn rebuild(&self, desc: &SceneDesc, options: &BuildOptions) -> Result<Self> {
        rebuild(self, desc, options).map_err(|error| error.in_file(desc.file.as_deref(), 0))
    }
}

fn build(desc: &SceneDesc, options: &BuildOptions) -> Result<Scene> {
    let run = Run { cancel: &options.cancel, start: Instant::now() };
    options.cancel.check()?;
    check_materials(desc)?;
    desc.check_textures()?;
    let base = desc.camera;
    let desc = &*posed(desc)?;
    let desc = &*with_emission_of_materials(desc)?;
    let device = match &options.device {
        Some(device) => device.clone(),
        None => {
            let threads = match options.threads {
                0 => std::thread::available_parallelism().map_or(1, usize::from),
                threads => threads,
            };
            Device::new(&DeviceOptions { threads, ..DeviceOptions::default() })?
        }
    };
    let progress = WorkProgress::by_steps(&options.cancel, options.progress.clone());
    let assembly = assemble(desc, options, options.dynamic, &device, None, &progress)?;
    let bindings = bindings(desc, assembly.unbound(), device.threads(), Kept::default(), &progress)?;
    progress.finish();
    complete(desc, base, device, assembly, bindings, AppearanceKey::new(desc), None, run)
}

fn rebuild(old: &Scene, desc: &SceneDesc, options: &BuildOptions) -> Result<Scene> {
    let run = Run { cancel: &options.cancel, start: Instant::now() };
    options.cancel.check()?;
    check_materials(desc)?;
    desc.check_textures()?;
    let base = desc.camera;
    let desc = &*posed(desc)?;
    let desc = &*with_emission_of_materials(desc)?;
    let progress = WorkProgress::by_steps(&options.cancel, options.progress.clone());
    let device = old.device.clone();
    let appearance = AppearanceKey::new(desc);
    let environment = match appearance.has_same_environment(&old.appearance) {
        true => old.bindings.emitters.environment_map().cloned(),
        false => None,
    };
    let reclad = appearance.reclad(&old.appearance);
    let owners = Some(KeptOwners::new(old, reclad.as_deref()));
    let kept = Kept { environment, owners };
    let same_geometry = old.record.is_geometry_of(desc);
    let same_frame = same_geometry && (old.camera == desc.camera || frame::still_serves(old, &desc.camera));

    let (assembly, bindings) = if same_frame {
        Camera::new(&desc.camera, desc.render.resolution, old.centre)?;
        check_emission(desc)?;
        let assembly = Assembly {
            embree: old.embree.clone(),
            list: Arc::clone(&old.list),
            geometries: Arc::clone(&old.geometries),
            centre: old.centre,
            record: old.record.seen_again(desc),
        };
        let bindings = if !appearance.has_same_emitters(&old.appearance) {
            bindings(desc, assembly.unbound(), device.threads(), kept, &progress)?
        } else if let Some(reclad) = &reclad {
            rebind_materials(&old.bindings, &appearance, reclad)
        } else {
            old.bindings.clone()
        };
        (assembly, bindings)
    } else {
        let is_dynamic = old.record.is_dynamic || options.dynamic || !same_geometry;
        let assembly = assemble(desc, options, is_dynamic, &device, Some(&old.record), &progress)?;
        let bindings = bindings(desc, assembly.unbound(), device.threads(), kept, &progress)?;
        (assembly, bindings)
    };
    progress.finish();
    complete(desc, base, device, assembly, bindings, appearance, Some(old), run)
}

/// Checks that the materials of surfaces exist.
fn check_materials(desc: &SceneDesc) -> Result<()> {
    let count = desc.materials.len();
    let lacks = |number: &usize| *number >= count;
    let mut suspects = desc.surfaces.of_blocks(|facts| facts.last_material.as_ref().is_some_and(lacks));
    match suspects.find_map(|(_, surface)| Some((surface, surface.material.filter(lacks)?))) {
        None => Ok(()),
        Some((surface, number)) => {
            let message = format!("material {number} of {count} does not exist");
            Err(Error::invalid(format!("{}.material", surface.path), message))
        }
    }
}

/// Checks that no shape that cannot emit has an emission, nor on both sides.
fn check_emission(desc: &SceneDesc) -> Result<()> {
    let lamps = desc.surfaces.of_blocks(|facts| facts.emits);
    for (_, surface) in lamps.filter(|(_, surface)| surface.emission.is_some() && !surface.hidden) {
        match surface.shape {
            ShapeDesc::Sphere { .. } | ShapeDesc::Quadric { .. } | ShapeDesc::Disk { .. } => {
                lower::world_shape(surface)?;
            }
            ShapeDesc::Triangle(_) | ShapeDesc::Quad(_) | ShapeDesc::Mesh { .. } => {}
        }
    }
    Ok(())
}

/// The Bsdfs of all materials that surfaces have; others are black. Those that need integrals over rough surfaces take a few
/// milliseconds each.
fn bsdfs(desc: &SceneDesc, used: &[bool]) -> Vec<Bsdf> {
    let of = |(i, material): (usize, &MaterialDesc)| {
        if !used[i] {
            return Bsdf::Black(Black);
        }
        let bsdf = Bsdf::of_materials(&material.bsdf, &desc.materials[..i]);
        bsdf.by_wavelength(&material.bsdf, &ByWavelength::new(material), None, None)
    };
    desc.materials.iter().enumerate().map(of).collect()
}

/// When a build began, and what may cancel it.
struct Run<'a> {
    cancel: &'a Cancel,
    start: Instant,
}

#[expect(clippy::too_many_arguments, reason = "they are what both builds have made")]
fn complete(
    desc: &SceneDesc,
    base: CameraDesc,
    device: Device,
    assembly: Assembly,
    bindings: SurfaceBindings,
    appearance: AppearanceKey,
    old: Option<&Scene>,
    run: Run<'_>,
) -> Result<Scene> {
    let used = desc.used_materials();
    let mut bsdfs = bsdfs(desc, &used);
    let mut textures = PreparedTextures::default();
    let before = old.map(|old| &*old.textures);
    let mut textured = Vec::with_capacity(bsdfs.len());
    for (i, bsdf) in bsdfs.iter_mut().enumerate() {
        if used[i] {
            textures.add_emission(desc, &desc.materials[i], before, &device)?;
        }
        let varying = match used[i] {
            true => Textured::new(desc, i, assembly.centre, &device, &mut textures, before)?,
            false => None,
        };
        if let Some(varying) = &varying {
            *bsdf = varying.mean();
        }
        textured.push(varying);
    }
    textures.add_environment(desc, bindings.emitters.environment_map(), before, &device)?;
    let backplate = Backplate::new(desc, &mut textures, before, &device)?;
    let tangents = SurfaceTangents::new(desc, old.map(|old| &*old.tangents), &device, &WorkProgress::new(run.cancel))?;
    let has_kernel = assembly.embree.is_some();
    let mut info = SceneInfo::new(desc, &bsdfs, &assembly.record, &bindings.emitters, &textures, has_kernel);
    let warnings =
        super::info::warnings(desc, &bsdfs, &assembly.record.facts, &bindings.emitters, appearance.dark_lights());
    let made = bsdfs.into_iter().zip(textured).zip(desc.materials.iter().zip(used));
    let materials: Arc<[Material]> = made
        .map(|((bsdf, textured), (desc, used))| {
            let material = textured.map_or_else(|| Material::uniform(bsdf), |it| Material::varying(Arc::new(it)));
            material.with_opacity(if used { desc.opacity } else { 1.0 })
        })
        // That of surfaces without a material.
        .chain([Material::uniform(Bsdf::Black(Black))])
        .collect();
    info.build_time = run.start.elapsed();
    let scene = Scene {
        embree: assembly.embree,
        list: assembly.list,
        is_large: super::geometry::are_large(&assembly.geometries),
        geometries: assembly.geometries,
        bindings,
        needs: MaterialNeeds::of(&materials),
        media: Media::new(desc)?,
        materials,
        tangents: Arc::new(tangents),
        reads_mesh_points: desc.textures.iter().any(|it| it.vertex_colors || it.mapping.uv_set() > 0),
        textures: Arc::new(textures),
        camera: desc.camera,
        backplate: backplate.map(Arc::new),
        movement: Movement::new(desc, base),
        centre: assembly.centre,
        info: Arc::new(info),
        warnings: warnings.into(),
        device,
        record: assembly.record,
        appearance: Arc::new(appearance),
        stated_survival: roulette::stated_survival(desc),
        flat_mirrors: Arc::default(),
    };
    // A camera that cannot be is refused here and not by the first render.
    scene.moving_camera(desc.render.resolution)?;
    Ok(scene.with_roulette(desc.render.roulette).with_located_media())
}
