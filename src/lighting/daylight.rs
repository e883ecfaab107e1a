//! Daylight: the sky as the only light of a scene, and the illuminance outside that daylight factors refer to.

use std::ops::ControlFlow;

use super::Calculation;
use crate::desc::{
    EnvironmentDesc, GridDesc, GridPoints, SceneDesc, SceneMotion, SkyDesc, SpectrumKey, Surfaces, TextureKey,
};
use crate::error::{Error, ErrorKind, Result};
use crate::math::DVec3;
use crate::render::RenderSettings;
use crate::scene::{BuildOptions, Scene};

/// Samples for the illuminance outside, of which no ray meets a surface.
const EXTERIOR_SAMPLES: u32 = 1 << 16;

/// The same scene, lit by its sky alone: without lamps, without light of distant sources such as the sun's disk, and without
/// surfaces that emit, which reflect as before.
///
/// A daylight factor excludes direct sunlight by its definition (CIE S 017, 17-29-121).
///
/// # Errors
/// [`ErrorKind::InvalidScene`] for a scene without light from infinity.
pub fn daylight_only(desc: &SceneDesc) -> Result<SceneDesc> {
    sky(desc)?;
    let mut desc = desc.clone();
    desc.lights.clear();
    desc.motion.lights.clear();
    desc.distant_lights.clear();
    desc.environment = desc.environment.map(without_sun);
    let lamps: Vec<usize> = desc.surfaces.of_blocks(|facts| facts.emits).map(|(number, _)| number).collect();
    lamps.into_iter().for_each(|number| desc.surfaces[number].emission = None);
    for material in &mut desc.materials {
        material.emission = None;
        material.spectra.retain(|(key, _)| *key != SpectrumKey::Emission);
        material.textures.retain(|binding| !matches!(binding.key, TextureKey::Emission | TextureKey::Temperature));
    }
    Ok(desc)
}

/// The illuminance \[lx\] of a horizontal plane under the unobstructed sky of a scene, and its standard error. The sky's light is
/// all that counts: neither surfaces nor lamps, nor distant light such as the sun's disk. Upwards is where the sky has its
/// zenith or the upper edge of its image; +y for an even sky.
///
/// # Errors
/// [`ErrorKind::InvalidScene`] for a scene without light from infinity or whose sky is black above the horizon, and the errors
/// of [`Scene::build`] and [`Calculation::run`].
pub fn exterior_illuminance(desc: &SceneDesc, settings: &RenderSettings) -> Result<(f64, f64)> {
    let up = sky(desc)?;
    // What moves is gone with its motion.
    let outside = SceneDesc {
        surfaces: Surfaces::default(),
        lights: Vec::new(),
        distant_lights: Vec::new(),
        motion: SceneMotion::default(),
        environment: desc.environment.clone().map(without_sun),
        ..desc.clone()
    };
    let scene = Scene::build(&outside, &BuildOptions { threads: settings.threads, ..BuildOptions::default() })?;
    let points = GridPoints::Points { points: vec![DVec3::ZERO], normals: vec![up] };
    let grid = GridDesc { name: "exterior".to_owned(), points };
    let mut settings = settings.clone();
    (settings.desc.samples, settings.target_error, settings.time_limit) = (EXTERIOR_SAMPLES, None, None);
    let mut calculation = Calculation::new(&scene, &grid, settings)?;
    calculation.run(&mut |_| ControlFlow::Continue(()))?;
    let measured = calculation.measured();
    match (measured.values.first(), measured.standard_errors.first()) {
        (Some(&value), Some(&error)) if value > 0.0 => Ok((value, error)),
        _ => Err(Error::new(ErrorKind::InvalidScene, "the sky is black: there is no daylight to compare with")),
    }
}

/// The same light from infinity without the sun that a sky may have.
fn without_sun(environment: EnvironmentDesc) -> EnvironmentDesc {
    EnvironmentDesc { sky: environment.sky.without_sun(), ..environment }
}

/// The direction that is up under the sky of a scene.
fn sky(desc: &SceneDesc) -> Result<DVec3> {
    let Some(environment) = &desc.environment else {
        let message = "there is no environment or sky, without which there is no daylight";
        return Err(Error::new(ErrorKind::InvalidScene, message));
    };
    Ok(match &environment.sky {
        SkyDesc::Even => DVec3::Y,
        SkyDesc::Map(map) => map.up,
        SkyDesc::Formula(sky) => sky.up,
        SkyDesc::HosekWilkie(sky) => sky.up,
    })
}
