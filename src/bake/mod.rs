//! Light maps: irradiance of all surfaces of a scene, for programs that draw them themselves.
//!
//! An [`Atlas`] gives every point of every surface a distinct place in a square of texels; [`Vertices`] use the vertices
//! instead. A [`Bake`] computes the irradiance [W m^-2] of each texel or vertex by path tracing, with the errors, budgets
//! and threads of any other render, so that scenes with mirrors and glass can be baked as well. [`by_radiosity`] takes
//! the irradiance from a radiosity solution instead. The radiance of a Lambertian surface of albedo a is a / pi times
//! the irradiance, plus the emitted radiance.
//!
//! Baking is a poor choice for a scene that is viewed only once, because an image costs less. It is also a poor choice
//! for surfaces that are not diffuse, since their radiance does not follow from irradiance.
//!
//! ```
//! use std::ops::ControlFlow;
//! use std::sync::Arc;
//! use etendue::Cancel;
//! use etendue::bake::{Atlas, AtlasOptions, Bake};
//! use etendue::render::RenderSettings;
//! use etendue::scene::{BuildOptions, Scene};
//!
//! let desc = etendue::desc::load("scenes/cornell.json".as_ref(), None)?;
//! let scene = Scene::build(&desc, &BuildOptions::default())?;
//! let options = AtlasOptions { resolution: Some(64), ..AtlasOptions::default() };
//! let atlas = Arc::new(Atlas::new(&scene, &options, &Cancel::new())?);
//! let mut settings = RenderSettings::default();
//! settings.desc.samples = 16;
//! let mut bake = Bake::new(&scene, atlas.sites(), settings, true)?;
//! bake.run(&mut |_| ControlFlow::Continue(()))?;
//! let map = atlas.light_map(&bake.irradiance());
//! let floor = map.at(atlas.vertices()[0].uv);
//! assert!(floor.min_element() > 0.0);
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! Sources: Lévy, Petitjean, Ray, Maillot 2002, "Least Squares Conformal Maps for Automatic Texture Atlas Generation"
//! (the frame of it: charts, then packing; charts are planar projections here); Jylänki 2010, "A Thousand Ways to Pack
//! the Bin".

mod atlas;
mod chart;
mod map;
mod mesh_uvs;
mod options;
mod overlap;
mod pack;
mod placement;
mod radiosity;
mod raster;
mod vertices;

pub use atlas::{Atlas, AtlasSurface, AtlasVertex};
pub use map::LightMap;
pub use options::{AtlasOptions, DEFAULT_SIDE, Layout, MAX_GUTTER, MAX_SIDE};
pub use placement::ChartRect;
pub use radiosity::by_radiosity;
pub use vertices::{LitVertex, VertexOptions, Vertices};

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::Cancel;
use crate::error::Result;
use crate::film::LayerKind;
use crate::integrator::Sites;
use crate::render::{Progress, Render, RenderSettings, Summary};
use crate::scene::{Facet, Scene};
use crate::spectrum::Rgb;

/// Irradiance of sites by path tracing.
pub struct Bake {
    render: Render,
    count: usize,
}

/// Irradiance of each site and its standard error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Baked {
    /// Irradiance [W m^-2].
    pub irradiance: Vec<[f32; 3]>,
    /// Standard error of the irradiance [W m^-2]; NaN where there are fewer than four samples.
    pub standard_error: Vec<[f32; 3]>,
}

impl Bake {
    /// Prepares to find the irradiance of each of these sites, on the outer side of the surface (`front`) or the inner
    /// one.
    ///
    /// Resolution, integrator, filter and auxiliary layers of the settings are not used. `max_depth` counts the site
    /// itself as the first hit: 1 is direct light alone. Results depend on scene, sites, `desc.samples`, seed and
    /// sampler alone, not on threads.
    ///
    /// # Errors
    /// As for [`Render::irradiance`].
    pub fn new(scene: &Scene, sites: &Arc<Sites>, settings: RenderSettings, front: bool) -> Result<Self> {
        let render = Render::irradiance(scene, settings, Arc::clone(sites), front)?;
        Ok(Self { render, count: sites.len() })
    }

    /// Renders until samples or time are used up, or the callback stops it; see [`Render::run`]. "Pixels" are sites
    /// here.
    ///
    /// # Errors
    /// As for [`Render::run`].
    pub fn run(&mut self, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Summary> {
        self.render.run(progress)
    }

    /// What stops the next [`Bake::run`].
    pub fn set_cancel(&mut self, cancel: Cancel) {
        self.render.set_cancel(cancel);
    }

    /// The present results, in the order of the sites; zero where there is no sample yet.
    pub fn irradiance(&self) -> Baked {
        let film = self.render.film();
        let [width, height] = film.options().resolution.map(|n| n as usize);
        let mut irradiance = vec![0.0; 4 * width * height];
        let mut error = vec![0.0; 3 * width * height];
        // Slices of the film's own size are never refused.
        let _ = film.rgba_into(&mut irradiance, false);
        let _ = film.layer_into(LayerKind::StandardError, &mut error);
        Baked {
            irradiance: irradiance.chunks_exact(4).take(self.count).map(|v| [v[0], v[1], v[2]]).collect(),
            standard_error: error.as_chunks::<3>().0.iter().take(self.count).copied().collect(),
        }
    }
}

/// Reflectance of a facet's outer and of its inner side, where they are diffuse, and the radiosity that it emits on each [W m^-2], at the
/// point with these weights of the second and third corner.
fn reflection(scene: &Scene, facet: &Facet, [b1, b2]: [f32; 2]) -> [[Rgb; 2]; 2] {
    let at = scene.facet_point(facet, b1, b2);
    let hit = facet.hit(b1, b2);
    let reflectances = scene.material(at.material).diffuse_albedos(|_| scene.detail(&hit, &at));
    let emitted = [at.ng, -at.ng].map(|wo| {
        at.emitter.map_or(Rgb::ZERO, |emitter| scene.emitters().emitted_radiosity(emitter, at.ng, wo, at.point.p))
    });
    [reflectances, emitted]
}
