//! `convert SCENE OUTPUT`: any scene as one of the native format.

use etendue::desc::{self, LoadOptions, SceneDesc, TextureSource};
use etendue::{ErrorKind, output};

use crate::args::ConvertArgs;
use crate::render::place;
use crate::{Failure, console};

/// Reads a scene and writes it.
pub fn convert(args: &ConvertArgs) -> Result<u8, Failure> {
    let read_and_written = |what: &str| {
        let output = args.output.display();
        Failure::usage(format!("{output}: {what} is read as a part of the scene and cannot be written"))
    };
    output::check_text_target(&args.output)?;
    if std::iter::once(&args.scene).chain(&args.params).any(|input| place(input) == place(&args.output)) {
        return Err(read_and_written("this file"));
    }
    let options = LoadOptions {
        time: args.at,
        animation: args.animation.clone(),
        camera: args.camera.clone(),
        progress: Some(console::reading_images(args.quiet)),
        ..LoadOptions::default()
    };
    let scene = desc::load_with(&args.scene, args.params.as_deref(), &options)?;
    scene.warnings.iter().for_each(console::warn);
    let folder = place(&SceneDesc::files_folder(&args.output));
    if scene.files.iter().chain([&args.scene]).any(|file| place(file).starts_with(&folder)) {
        return Err(read_and_written("a file in the folder of its meshes and images"));
    }
    scene.save(&args.output).map_err(|error| match error.kind() {
        ErrorKind::Io => Failure::running(error),
        _ => error.into(),
    })?;
    if !args.quiet {
        console::say(&summary(&scene, args));
    }
    Ok(0)
}

/// What was written.
fn summary(scene: &SceneDesc, args: &ConvertArgs) -> String {
    let meshes = scene.meshes.iter().filter(|mesh| mesh.triangle_count() > 0).count();
    let is_image = |source: &TextureSource| matches!(source, TextureSource::Image(_));
    let images = scene.textures.iter().filter(|texture| is_image(&texture.source)).count();
    let surfaces = scene.surfaces.iter().filter(|surface| !surface.hidden).count();
    let counts = format!(
        "{surfaces} surfaces, {} materials, {meshes} meshes, {images} textures of images",
        scene.materials.len()
    );
    format!("{} written: {counts}", args.output.display())
}
