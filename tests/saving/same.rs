//! Comparison of descriptions, down to the bits of their numbers.

use std::fmt::Debug;
use std::sync::Arc;

use etendue::desc::{
    BsdfDesc, DistantLightDesc, MaterialDesc, MeshDesc, PointLightDesc, SceneDesc, ShapeDesc, SpectrumDesc,
    SurfaceDesc, TextureDesc, TextureMapping, TextureSource,
};
use etendue::texture::ColorSpace;

/// Writes a description into an empty folder and reads it. The file gives no warning.
pub fn saved(scene: &SceneDesc) -> SceneDesc {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    scene.save(&path).unwrap();
    let again = etendue::desc::load(&path, None).unwrap_or_else(|error| {
        panic!("{error}\n{}", std::fs::read_to_string(&path).unwrap());
    });
    assert_eq!(again.warnings, [""; 0]);
    again
}

/// Asserts that two descriptions say the same with the same bits. Paths and names of files may differ, as may names that elements
/// have not been given, and how the placement of a surface is divided.
pub fn assert_same(before: &SceneDesc, after: &SceneDesc, what: &str) {
    assert_eq!(text(&before.camera), text(&after.camera), "{what}");
    assert_eq!(text(&before.render), text(&after.render), "{what}");
    let light = |it: &PointLightDesc| text(&(it.position, it.intensity, &it.distribution, spectrum(&it.spectrum)));
    each(&before.lights, &after.lights, light, what);
    let distant =
        |it: &DistantLightDesc| text(&(it.towards, it.irradiance, it.angle_deg, it.visible, spectrum(&it.spectrum)));
    each(&before.distant_lights, &after.distant_lights, distant, what);
    let sky = |scene: &SceneDesc| {
        let it = scene.environment.as_ref();
        text(&it.map(|it| (it.radiance, it.sky.clone(), it.visible, spectrum(&it.spectrum))))
    };
    assert_eq!(sky(before), sky(after), "{what}");
    assert_eq!(text(&before.backplate), text(&after.backplate), "{what}");
    each(&before.textures, &after.textures, |it| texture(it), what);
    for (before, after) in before.textures.iter().zip(&after.textures) {
        if let (TextureSource::Image(before), TextureSource::Image(after)) = (&before.source, &after.source)
            && before.color_space.is_some()
        {
            assert_eq!(before.color_space, after.color_space, "{what}");
        }
    }
    let images = |scene: &SceneDesc| shared(&scene.textures);
    assert_eq!(images(before), images(after), "{what}: images are shared");
    each(&before.materials, &after.materials, material, what);
    for (before, after) in before.materials.iter().zip(&after.materials) {
        assert!(before.name.is_empty() || before.name == after.name, "{what}: {}", before.name);
    }
    assert_eq!(motions(before), motions(after), "{what}: motion");
    let meshes: Vec<_> = before.meshes.iter().filter(|mesh| mesh.triangle_count() > 0).collect();
    assert_eq!(meshes.len(), after.meshes.len(), "{what}");
    for (before, after) in meshes.iter().zip(&after.meshes) {
        assert!(mesh(before) == mesh(after), "{what}: the mesh {} differs", before.name);
        assert!(after.host.is_none());
    }
    let shown: Vec<_> = before.surfaces.iter().filter(|surface| !surface.hidden).collect();
    assert_eq!(shown.len(), after.surfaces.len(), "{what}");
    for (one, other) in shown.iter().zip(&after.surfaces) {
        assert_eq!(surface(one, before), surface(other, after), "{what}: {}", one.path);
    }
}

/// All motion, by the numbers that elements have in a file: without those that were removed.
fn motions(scene: &SceneDesc) -> String {
    let motion = &scene.motion;
    let number = |removed: &dyn Fn(usize) -> bool, number: usize| (0..number).filter(|i| !removed(*i)).count();
    let surfaces: Vec<_> =
        motion.surfaces.iter().map(|(i, it)| (number(&|i| scene.surfaces[i].hidden, *i), it)).collect();
    let meshes: Vec<_> =
        motion.meshes.iter().map(|(i, it)| (number(&|i| scene.meshes[i].triangle_count() == 0, *i), it)).collect();
    text(&(&motion.shutter, &motion.camera, surfaces, &motion.lights, meshes))
}

/// A spectrum with all of its samples.
fn spectrum(spectrum: &Option<SpectrumDesc>) -> String {
    match spectrum {
        Some(SpectrumDesc::Samples(samples)) => text(samples),
        other => text(other),
    }
}

/// The text of a value, which tells all bits of its numbers but those of NaN.
fn text(value: &impl Debug) -> String {
    format!("{value:?}")
}

fn each<T>(before: &[T], after: &[T], text: impl Fn(&T) -> String, what: &str) {
    assert_eq!(before.len(), after.len(), "{what}");
    for (before, after) in before.iter().zip(after) {
        assert_eq!(text(before), text(after), "{what}");
    }
}

fn texture(texture: &TextureDesc) -> String {
    let TextureDesc { name, source, mapping, vertex_colors, .. } = texture;
    match source {
        TextureSource::White => text(&(name, vertex_colors)),
        TextureSource::Procedural(it) => text(&(name, it, mapping, vertex_colors)),
        TextureSource::Image(it) => {
            // Whether colours and other numbers are sRGB: linear light and raw numbers are the same. The rotation may differ in its
            // last bit.
            let is_srgb = |space| space == ColorSpace::Srgb;
            let of_colors = is_srgb(it.color_space.unwrap_or(it.suggested_space));
            let space = (of_colors, it.color_space.is_some_and(is_srgb));
            let mapping = match *mapping {
                TextureMapping::Uv { set, scale, rotation, offset } => text(&(set, scale, rotation as f32, offset)),
                TextureMapping::Projected { projection, scale, rotation, offset } => {
                    text(&(projection, scale, rotation as f32, offset))
                }
                TextureMapping::Space { scale, offset } => text(&(scale, offset)),
            };
            text(&(name, &it.image, space, it.wrap, it.filter, mapping, vertex_colors))
        }
    }
}

/// For each texture, the first one of the same image.
fn shared(textures: &[Arc<TextureDesc>]) -> Vec<Option<usize>> {
    let image = |texture: &TextureDesc| match &texture.source {
        TextureSource::Image(it) => Some(Arc::as_ptr(&it.image)),
        TextureSource::Procedural(_) | TextureSource::White => None,
    };
    textures.iter().map(|texture| textures.iter().position(|other| image(other) == image(texture))).collect()
}

fn material(material: &MaterialDesc) -> String {
    let MaterialDesc { bsdf, survival, medium, dispersion, opacity, emission, .. } = material;
    let spectra: Vec<_> = material.spectra.iter().map(|(key, it)| (key, spectrum(&Some(it.clone())))).collect();
    let mut bsdf = *bsdf;
    match &mut bsdf {
        // Glass without any roughness is smooth glass, which has no facets.
        BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets }
            if microfacets.roughness == 0.0 && material.textures.iter().all(|it| it.key.is_of_surface()) =>
        {
            bsdf = BsdfDesc::Dielectric { ior: *ior, exterior_ior: *exterior_ior };
        }
        // A coat never makes up for multiple scattering.
        BsdfDesc::CoatedDiffuse { microfacets, .. } => microfacets.multiple_scattering = false,
        _ => {}
    }
    let mut textures = material.textures.clone();
    textures.sort_by_key(|binding| binding.key.name());
    text(&(bsdf, survival, medium.unwrap_or_default(), dispersion, opacity, emission, spectra, textures))
}

/// All numbers of a mesh as bits.
fn mesh(mesh: &MeshDesc) -> impl PartialEq + use<> {
    let vertices = || 0..mesh.vertex_count();
    (
        vertices().map(|i| mesh.position(i).to_array().map(f64::to_bits)).collect::<Vec<_>>(),
        vertices().map(|i| mesh.normal(i).map(|normal| normal.map(f32::to_bits))).collect::<Vec<_>>(),
        vertices().map(|i| mesh.uv(i).map(|uv| uv.map(f32::to_bits))).collect::<Vec<_>>(),
        (0..mesh.triangle_count()).map(|i| mesh.triangle(i)).collect::<Vec<_>>(),
        mesh.colors.iter().map(|color| color.map(f32::to_bits)).collect::<Vec<_>>(),
        mesh.tangents.iter().map(|tangent| tangent.map(f32::to_bits)).collect::<Vec<_>>(),
        mesh.further_uvs.iter().map(|uvs| uvs.iter().map(|uv| uv.map(f32::to_bits)).collect()).collect::<Vec<Vec<_>>>(),
    )
}

fn surface(surface: &SurfaceDesc, scene: &SceneDesc) -> String {
    let SurfaceDesc { name, shape, material, emission, emits_both, transform, .. } = surface;
    // Meshes that were removed have no number in a file.
    let shape = match *shape {
        ShapeDesc::Mesh { mesh, smooth } => {
            let before = scene.meshes[..mesh].iter().filter(|mesh| mesh.triangle_count() > 0).count();
            ShapeDesc::Mesh { mesh: before, smooth }
        }
        shape => shape,
    };
    // A zero without a sign, since sums of products with zeros may lose it.
    let placed = surface.to_world().to_cols_array().map(|x| x + 0.0);
    // The direction of a web as it is in the world, since the frame of a shape may have gone into the transform.
    let web = surface.web.as_ref().filter(|_| emission.is_some()).map(|it| {
        let c0 = (transform.matrix3 * it.c0).normalize().to_array().map(|x| (x * 1e12).round() + 0.0);
        (it.web.text(), it.tilt_deg, c0)
    });
    let spectrum = spectrum(&surface.spectrum.clone().filter(|_| emission.is_some()));
    text(&(name, shape, material, emission, emits_both, placed, web, spectrum))
}
