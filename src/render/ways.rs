//! Ways to take the samples of a render that a pilot chooses among, where the settings leave it open: whether pixels share hits, whether
//! light paths find caustics, how many light samples the hits have that the camera sees, and whether the irradiance cache takes the place of
//! paths.

use serde::{Deserialize, Serialize};

use super::Render;
use super::maps::Maps;
use super::method::Method;
use super::pilot::{MOST_TIMES, Size};
use super::settings::RenderSettings;
use crate::desc::{IntegratorDesc, MAX_SHADOW_RAYS, Preparation};
use crate::error::Result;
use crate::integrator::Path;
use crate::integrator::light_tracing::LightPaths;
use crate::integrator::photon::Choice;
use crate::integrator::radiosity::Steps;
use crate::integrator::reuse::PathReuse;
use crate::integrator::{
    check_bias, check_first_shadow_rays, check_light_paths, check_reuse, check_support, no_choice,
    no_first_shadow_rays, no_light_paths, no_reuse,
};
use crate::scene::Scene;

/// Makes the random numbers of light paths others than those of the pixels.
pub(super) const LIGHT_SEED: u64 = 0x6c69_6768_7400_0000;

/// Whether something is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decision {
    No,
    Yes,
    ByPilot,
}

/// What the settings say about the ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Whether pixels share hits.
    pub reuse: Decision,
    /// Whether light paths are traced to the camera.
    pub light_paths: Decision,
    /// Number of light samples at the hits that the camera sees; `None` where a pilot is to say.
    pub first_shadow_rays: Option<u32>,
    /// Whether a pilot may choose the irradiance cache, and why not.
    pub cache: std::result::Result<(), &'static str>,
    /// The size of a pilot, where the render is long enough for one.
    pub size: Option<Size>,
}

/// What pixels of a render have in common, as checkpoints keep it and helpers hear it: `None` as long as a pilot is to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Ways {
    /// Whether they share hits.
    pub reuse: Option<bool>,
    /// Number of light paths for each sample of all of them.
    pub light_paths: Option<u32>,
    /// Number of light samples at the hits that the camera sees.
    pub first_shadow_rays: Option<u32>,
    /// Whether the irradiance cache takes the place of paths, where `auto` may choose it.
    pub cache: Option<bool>,
    /// Where the radiosity solution ended, where there is one.
    pub solution: Option<Steps>,
}

/// Why each path is by itself where light is kept apart.
const APART: &str = "light is kept apart by how often it was scattered, which each path counts for itself";

impl Wanted {
    /// What the settings say. `place`: what is rendered, where that is no picture.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Unsupported`] where the settings ask for what cannot be done.
    pub fn of(
        scene: &Scene,
        settings: &RenderSettings,
        integrator: IntegratorDesc,
        place: Option<&'static str>,
    ) -> Result<Self> {
        let desc = &settings.desc;
        let size = Size::of(settings);
        let decide = |asked: Option<bool>, allowed: &dyn Fn() -> Result<()>| match asked {
            Some(true) => allowed().map(|()| Decision::Yes),
            Some(false) => Ok(Decision::No),
            None if size.is_some() && allowed().is_ok() => Ok(Decision::ByPilot),
            None => Ok(Decision::No),
        };
        // Whether a picture that was asked for can be rendered must not depend on what is chosen for the scene.
        let named = |asked: Option<bool>| if asked == Some(true) { desc.integrator } else { integrator };
        let adaptive = settings.adaptive == Some(true);
        let reuse = decide(desc.reuse, &|| {
            match place {
                Some(place) => no_reuse(&format!("{place} has no neighbouring pixels"), "false")?,
                None => check_reuse(scene, named(desc.reuse), desc)?,
            }
            if adaptive {
                let why = "adaptive sampling gives neighbouring pixels different numbers of samples";
                no_reuse(why, "false, or the same number of samples in all pixels")?;
            }
            if settings.light_parts {
                no_reuse(APART, "false, or no layers of emitted, direct and indirect light")?;
            }
            Ok(())
        })?;
        let light_paths = decide(desc.light_paths, &|| {
            match place {
                Some(place) => no_light_paths(&format!("{place} has no camera"), "false")?,
                None => check_light_paths(scene, named(desc.light_paths), desc)?,
            }
            if adaptive {
                let why = "adaptive sampling gives pixels different numbers of samples, and light paths are those of all pixels";
                no_light_paths(why, "false, or the same number of samples in all pixels")?;
            }
            if settings.light_parts {
                no_light_paths(APART, "false, or no layers of emitted, direct and indirect light")?;
            }
            Ok(())
        })?;
        let own = desc.shadow_rays;
        // A pilot is made for this where it is made for one of the others.
        let has_pilot = reuse == Decision::ByPilot || light_paths == Decision::ByPilot;
        let takes_more = has_pilot && own <= MAX_SHADOW_RAYS / MOST_TIMES && !scene.emitters().is_dark();
        let first_shadow_rays = match desc.first_shadow_rays {
            Some(count) => {
                match place {
                    Some(place) => no_first_shadow_rays(place)?,
                    None => check_first_shadow_rays(desc.integrator)?,
                }
                Some(count)
            }
            None => (!takes_more).then_some(own),
        };
        if desc.allow_bias {
            match place {
                Some(place) => no_choice(&format!("{place} has no pilot"))?,
                None => check_bias(desc.integrator)?,
            }
        }
        let cache = match why_no_cache(scene, settings, integrator) {
            _ if !desc.allow_bias => Err("auto allows no bias unless it is asked to"),
            _ if !size.is_some_and(Size::is_large) => {
                Err("the picture is small or of few samples, or has other numbers of samples for each pixel")
            }
            Some(why) => Err(why),
            None => Ok(()),
        };
        Ok(Self { reuse, light_paths, first_shadow_rays, cache, size })
    }

    /// Whether one of them was asked for, so that all pixels have the same number of samples.
    pub fn is_settled_for_all_pixels(&self) -> bool {
        self.reuse != Decision::No || self.light_paths != Decision::No
    }
}

/// Why a pilot does not compare the irradiance cache with paths, where settings or scene say so; it is not asked whether they allow a bias.
pub(super) fn why_no_cache(
    scene: &Scene,
    settings: &RenderSettings,
    integrator: IntegratorDesc,
) -> Option<&'static str> {
    let is_asked = settings.desc.integrator == IntegratorDesc::Auto && integrator == IntegratorDesc::Path;
    if !is_asked {
        return Some("the integrator is another one");
    }
    if settings.light_parts {
        return Some("the cache does not keep light apart by how often it was scattered");
    }
    if settings.target_error.is_some() {
        return Some("an error ends the render, and estimates do not know the bias");
    }
    if settings.time_limit.is_some() && settings.share.is_some() {
        return Some("time ends the render of a share, and the others might choose otherwise");
    }
    if settings.desc.spectral {
        return Some("the cache holds no wavelengths");
    }
    if scene.has_moving_world() {
        return Some("the cache shows no motion");
    }
    if scene.emitters().is_dark() || !scene.lobes().have_diffuse() {
        return Some("there is no light on diffuse surfaces");
    }
    let is_refused = check_support(scene, IntegratorDesc::IrradianceCache).is_err();
    is_refused.then_some("the cache does not take the scene")
}

/// What a pilot is to choose.
#[derive(Clone, Debug)]
pub(super) struct Undecided {
    /// Path tracing with shared hits, where it is open whether hits are shared.
    pub sharing: Option<PathReuse>,
    /// Light paths, where it is open whether they are traced.
    pub light: Option<LightPaths>,
    /// Whether it is open how many light samples the hits have that the camera sees.
    pub first_shadow_rays: bool,
    /// Whether it is open whether the irradiance cache takes the place of paths.
    pub cache: bool,
    pub size: Size,
}

impl Undecided {
    /// What is open; `None` where nothing is.
    pub fn new(wanted: &Wanted, sharing: impl FnOnce() -> PathReuse, light: Option<&LightPaths>) -> Option<Self> {
        let sharing = (wanted.reuse == Decision::ByPilot).then(sharing);
        let light = light.filter(|_| wanted.light_paths == Decision::ByPilot).cloned();
        let first_shadow_rays = wanted.first_shadow_rays.is_none();
        Self { sharing, light, first_shadow_rays, cache: wanted.cache.is_ok(), size: wanted.size? }.unless_empty()
    }

    /// What is still open once some of it is known; `None` where nothing is.
    fn without(mut self, known: Ways) -> Option<Self> {
        self.sharing = self.sharing.filter(|_| known.reuse.is_none());
        self.light = self.light.filter(|_| known.light_paths.is_none());
        self.first_shadow_rays &= known.first_shadow_rays.is_none();
        self.cache &= known.cache.is_none();
        self.unless_empty()
    }

    fn unless_empty(self) -> Option<Self> {
        let is_open = self.sharing.is_some() || self.light.is_some() || self.first_shadow_rays || self.cache;
        is_open.then_some(self)
    }
}

impl Render {
    /// What pixels have in common.
    pub(super) fn ways(&self) -> Ways {
        let open = self.undecided.as_ref();
        let reuse = open.is_none_or(|open| open.sharing.is_none()).then_some(matches!(self.method, Method::Reuse(_)));
        let count = self.light_paths.as_ref().map_or(0, LightPaths::count);
        let light_paths = open.is_none_or(|open| open.light.is_none()).then_some(count);
        let first_shadow_rays = open.is_none_or(|open| !open.first_shadow_rays).then_some(self.first_shadow_rays);
        let is_cached = self.integrator() == IntegratorDesc::IrradianceCache;
        let cache = open.is_none_or(|open| !open.cache).then_some(is_cached);
        Ways { reuse, light_paths, first_shadow_rays, cache, solution: self.steps() }
    }

    /// Takes what a pilot has said, if it has, so that it is not asked again.
    pub(super) fn set_ways(&mut self, ways: Ways) {
        let own = self.ways();
        if let Some(reuse) = ways.reuse
            && own.reuse != ways.reuse
        {
            let path = Path::new(self.desc.max_depth, self.desc.shadow_rays);
            self.method = if reuse { Method::Reuse(PathReuse::new(&self.scene, path)) } else { Method::Path };
        }
        if let Some(count) = ways.light_paths
            && own.light_paths != ways.light_paths
        {
            self.light_paths = match count {
                0 => None,
                _ => LightPaths::new(&self.scene, &self.camera, self.desc.resolution).map(|it| it.with_count(count)),
            };
        }
        self.first_shadow_rays = ways.first_shadow_rays.unwrap_or(self.first_shadow_rays);
        if let Some(is_taken) = ways.cache {
            // A checkpoint may have been begun where a pilot was made, and go on where none is.
            let settings = RenderSettings { target_error: None, time_limit: None, ..self.settings.clone() };
            let is_possible = || why_no_cache(&self.scene, &settings, self.integrator()).is_none();
            if is_taken && self.cache.is_none() && self.desc.allow_bias && is_possible() {
                self.cache = Maps::cache_alone(&self.scene, &self.camera, &self.desc);
            }
            let why = "the part of the render before chose so, and more samples take nothing from its bias";
            self.settle_cache(is_taken.then_some(why));
        }
        self.solution = ways.solution.or(self.solution);
        self.undecided = self.undecided.take().and_then(|open| open.without(ways));
    }

    /// Where the radiosity solution ended, or is to end where that is known.
    fn steps(&self) -> Option<Steps> {
        let has_one = self.integrator().info().preparation == Preparation::RadiositySolution;
        let known = self.radiosity.as_ref().map(|solution| solution.steps()).or(self.solution);
        known.filter(|_| has_one)
    }

    /// Takes the irradiance cache in place of paths, for this reason, or leaves it for good. Nothing changes in a render that has no such
    /// choice.
    pub(super) fn settle_cache(&mut self, why: Option<&str>) {
        let (Some(plan), Some(why)) = (self.cache.take(), why) else { return };
        self.plan = Some(Maps::Colours(plan));
        self.choice = Some(Choice { integrator: IntegratorDesc::IrradianceCache, why: why.to_owned() });
        (self.light_paths, self.first_shadow_rays) = (None, self.desc.shadow_rays);
    }
}
