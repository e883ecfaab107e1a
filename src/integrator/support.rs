//! Which scenes an integrator supports, by the lobes and the opacity of their surfaces, by their emitters and their motion.

use crate::bsdf::Lobes;
use crate::desc::{CameraDesc, FilterDesc, IntegratorDesc, LobeSupport, LobeUse, Preparation, RenderDesc, SamplerDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::sampling::Filter;
use crate::scene::Scene;

/// Refuses a scene that moves, that has light from infinity or points that shine unevenly, in which media absorb, or that has a surface with lobes or an opacity, which the
/// integrator does not support according to the table of integrators.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names the integrator and, for lobes, the surface.
pub fn check_support(scene: &Scene, integrator: IntegratorDesc) -> Result<()> {
    // What is prepared knows no camera, and pictures of it are taken ray by ray.
    if !integrator.info().shows_motion() && scene.has_moving_world() {
        check_still(scene, integrator.name())?;
    }
    let refuse = |surface: &str, what: &str| {
        let name = integrator.name();
        let message = format!("{surface}{name} takes no {what}; expected an integrator that does, such as path");
        Err(Error::new(ErrorKind::Unsupported, message))
    };
    if scene.emitters().has_infinite() && !integrator.info().takes_infinite_emitters {
        return refuse("", "light from infinity");
    }
    if scene.emitters().has_directed() && !integrator.info().takes_directed_points {
        return refuse("", "point lights that shine unevenly");
    }
    // Links to clusters of elements that face each other lose much of the light of a tube's inner side.
    if scene.emitters().has_inner_tubes() && integrator.info().preparation == Preparation::RadiositySolution {
        return refuse("", "cylinders that emit on both sides");
    }
    // Elements emit evenly into their hemisphere.
    if scene.emitters().has_web_areas() && integrator.info().preparation == Preparation::RadiositySolution {
        return refuse("", "surfaces that shine by a photometric web");
    }
    if scene.has_absorption() && !integrator.info().takes_absorption {
        return refuse("", "media that absorb light");
    }
    let Some(support) = integrator.info().lobes else { return Ok(()) };
    // The density of what is stored on a surface is that of the light times the opacity.
    if support.diffuse == LobeUse::StoredAndGathered && !scene.is_opaque() {
        return refuse("", "surfaces that are not opaque");
    }
    let Some((lobes, kind)) = refused(scene.lobes(), support) else { return Ok(()) };
    let surface = scene.surface_with(lobes).map_or_else(String::new, |surface| format!("surfaces[{surface}]: "));
    refuse(&surface, &format!("{kind} surfaces"))
}

/// Refuses wavelengths for an integrator whose paths carry colours alone.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names the integrator.
pub fn check_wavelengths(integrator: IntegratorDesc, desc: &RenderDesc) -> Result<()> {
    if integrator.info().renders_wavelengths(desc.photons.progressive) {
        return Ok(());
    }
    no_wavelengths(integrator.name())
}

/// Says that a method has no wavelengths.
///
/// # Errors
/// [`ErrorKind::Unsupported`], always.
pub fn no_wavelengths(method: &str) -> Result<()> {
    let message = format!(
        "render.spectral is true, and {method} carries three channels through the whole image; expected false, or an integrator \
         whose paths carry wavelengths, such as path"
    );
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// Refuses to keep light apart by how often it was scattered, for an integrator that does not count it.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names the integrator.
pub fn check_light_parts(integrator: IntegratorDesc) -> Result<()> {
    if matches!(integrator, IntegratorDesc::Path | IntegratorDesc::Direct) {
        return Ok(());
    }
    let message = format!(
        "layers of emitted, direct and indirect light: {} does not count how often light was scattered; expected the integrator path \
         or direct, or none of these layers",
        integrator.name()
    );
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// Refuses to share hits among pixels for an integrator, settings or a scene with which that cannot be done: for each pixel of a
/// group, the hits of the others count as its own, with the density that its own paths would have given them.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names what the hits are not shared with.
pub fn check_reuse(scene: &Scene, integrator: IntegratorDesc, desc: &RenderDesc) -> Result<()> {
    if integrator != IntegratorDesc::Path {
        let why = format!("{} shares no hits among pixels", integrator.name());
        return no_reuse(&why, "false, or the integrator path");
    }
    match what_paths_have_apart(scene, desc) {
        Some((why, expected)) => no_reuse(why, expected),
        None => Ok(()),
    }
}

/// Farthest reach of a filter beside light paths, pixels.
const WIDEST_FILTER: f32 = 4.0;

/// Refuses light paths to the camera for an integrator, settings or a scene with which they do not find what paths from the camera find.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names what light paths are not traced with.
pub fn check_light_paths(scene: &Scene, integrator: IntegratorDesc, desc: &RenderDesc) -> Result<()> {
    if integrator != IntegratorDesc::Path {
        let why = format!("{} traces none to the camera", integrator.name());
        return no_light_paths(&why, "false, or the integrator path");
    }
    if let Some((why, expected)) = what_paths_have_apart(scene, desc) {
        return no_light_paths(why, expected);
    }
    if !matches!(scene.camera(), CameraDesc::Perspective { .. }) {
        let why = "the camera does not see in perspective through a pinhole";
        return no_light_paths(why, "false, or the camera perspective");
    }
    if scene.asks_footprints() {
        let why = "textures are filtered by what a path's own rays see";
        return no_light_paths(why, "false, or textures with other filters");
    }
    if desc.max_depth.is_some() {
        return no_light_paths("render.maxDepth cuts paths", "false, or no maxDepth");
    }
    if matches!(desc.filter, FilterDesc::Mitchell { .. }) {
        let why = "the filter mitchell divides by the weights of a pixel's own samples";
        return no_light_paths(why, "false, or a filter that is nowhere negative");
    }
    // What one light path brings would otherwise be a part of thousands of pixels.
    if Filter::new(&desc.filter).radius() > WIDEST_FILTER {
        let why = format!("the filter reaches farther than {WIDEST_FILTER} pixels");
        return no_light_paths(&why, "false, or a filter that does not");
    }
    if desc.sampler == SamplerDesc::Gaussian {
        let why = "the sampler gaussian is a pixel filter by itself";
        return no_light_paths(why, "false, or another sampler");
    }
    Ok(())
}

/// Says why no light paths are traced, and what would be expected.
///
/// # Errors
/// [`ErrorKind::Unsupported`], always.
pub fn no_light_paths(why: &str, expected: &str) -> Result<()> {
    let message = format!("render.integrator.lightPaths is true, and {why}; expected {expected}");
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// Refuses a number of light samples at the first hits for an integrator that takes as many at all hits.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names the integrator.
pub fn check_first_shadow_rays(integrator: IntegratorDesc) -> Result<()> {
    if integrator == IntegratorDesc::Path { Ok(()) } else { no_first_shadow_rays(integrator.name()) }
}

/// Says that a method has no number of light samples of its own for the first hits.
///
/// # Errors
/// [`ErrorKind::Unsupported`], always.
pub fn no_first_shadow_rays(method: &str) -> Result<()> {
    let message = format!(
        "render.integrator.firstShadowRays is given, and {method} has no number of its own for what the camera sees; expected \
         shadowRays alone, or a picture by the integrator path"
    );
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// Refuses to allow a bias to an integrator that chooses no other.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names the integrator.
pub fn check_bias(integrator: IntegratorDesc) -> Result<()> {
    if integrator == IntegratorDesc::Auto {
        return Ok(());
    }
    no_choice(&format!("{} chooses no other integrator", integrator.name()))
}

/// Says why a bias has nothing to be allowed for.
///
/// # Errors
/// [`ErrorKind::Unsupported`], always.
pub fn no_choice(why: &str) -> Result<()> {
    let message =
        format!("render.integrator.bias is allowed, and {why}; expected refused, or a picture by the integrator auto");
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// What each path of a render has by itself, so that what it finds is not what another one would have found, and what would be expected
/// instead.
fn what_paths_have_apart(scene: &Scene, desc: &RenderDesc) -> Option<(&'static str, &'static str)> {
    if desc.spectral {
        return Some((
            "render.spectral gives each path wavelengths of its own",
            "false, or a render in three channels",
        ));
    }
    if scene.has_motion() {
        return Some(("something moves while the shutter is open", "false, or a scene at rest"));
    }
    // Whether a ray passes such a surface is a random choice of the ray, which the ways of several pixels to one hit do not share.
    if !scene.is_opaque() {
        return Some(("surfaces of the scene are not opaque", "false, or a scene whose surfaces are"));
    }
    if scene.has_media() {
        let why =
            "media of the scene absorb light or have priorities, which each path follows from its own camera ray on";
        return Some((why, "false, or a scene without such media"));
    }
    None
}

/// Says why hits are not shared among pixels, and what would be expected.
///
/// # Errors
/// [`ErrorKind::Unsupported`], always.
pub fn no_reuse(why: &str, expected: &str) -> Result<()> {
    let message = format!("render.integrator.reuse is true, and {why}; expected {expected}");
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// Refuses a scene that moves, for a method that sees the scene at one moment only.
///
/// # Errors
/// [`ErrorKind::Unsupported`], whose message names the method.
pub fn check_still(scene: &Scene, method: &str) -> Result<()> {
    if !scene.has_motion() {
        return Ok(());
    }
    let message =
        format!("{method} shows no motion; expected an integrator that does, such as path, or a scene at rest");
    Err(Error::new(ErrorKind::Unsupported, message))
}

/// The lobes among these that the integrator refuses, and their name in messages.
fn refused(lobes: Lobes, support: LobeSupport) -> Option<(Lobes, &'static str)> {
    // Maps, caches and elements hold the light of one side.
    let through = if support.diffuse == LobeUse::StoredAndGathered { LobeUse::Refused } else { support.diffuse };
    let kinds = [
        (Lobes::DIFFUSE_REFLECTION, support.diffuse, "diffuse"),
        (Lobes::DIFFUSE_TRANSMISSION, through, "diffusely transmitting"),
        (Lobes::GLOSSY, support.glossy, "glossy"),
        (Lobes::SPECULAR, support.specular, "specular"),
    ];
    let refused = |(kind, use_of, _): &(Lobes, LobeUse, &str)| *use_of == LobeUse::Refused && lobes.intersects(*kind);
    kinds.into_iter().find(refused).map(|(kind, _, name)| (kind, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_table_refuses_is_refused_by_name() {
        for integrator in IntegratorDesc::ALL {
            let Some(support) = integrator.info().lobes else { continue };
            assert_ne!(support.diffuse, LobeUse::Refused, "{}", integrator.name());
            let through = refused(Lobes::DIFFUSE_TRANSMISSION, support).is_some();
            assert_eq!(through, support.diffuse == LobeUse::StoredAndGathered, "{}", integrator.name());
            assert_eq!(refused(Lobes::DIFFUSE_REFLECTION, support), None);
            let kinds = [
                (support.glossy, [Lobes::GLOSSY_REFLECTION, Lobes::GLOSSY_TRANSMISSION], "glossy"),
                (support.specular, [Lobes::SPECULAR_REFLECTION, Lobes::SPECULAR_TRANSMISSION], "specular"),
            ];
            for (use_of, lobes, name) in kinds {
                for lobe in lobes {
                    let found = refused(lobe, support).map(|(_, name)| name);
                    assert_eq!(found, (use_of == LobeUse::Refused).then_some(name), "{}", integrator.name());
                }
            }
            assert_eq!(refused(Lobes::empty(), support), None);
        }
        let radiosity = IntegratorDesc::Radiosity.info().lobes.unwrap();
        let mixed = Lobes::DIFFUSE_REFLECTION | Lobes::GLOSSY_REFLECTION;
        assert_eq!(refused(mixed, radiosity), Some((Lobes::GLOSSY, "glossy")));
    }
}
