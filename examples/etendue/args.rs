//! The command line's grammar.

#[path = "matte_args.rs"]
mod matte_args;

use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::Duration;

use clap::builder::PossibleValue;
use clap::{Args, Parser, Subcommand, ValueEnum};
use etendue::bake::{MAX_GUTTER, MAX_SIDE};
use etendue::desc::{
    CropDesc, FilterDesc, IntegratorDesc, LoadOptions, MAX_PHOTONS, MAX_RADIOSITY_ITERATIONS, MAX_SHADOW_RAYS,
    PhotonDesc, PlaneGridDesc, RADII, RadiosityDesc, RadiositySolver, RenderDesc, RouletteDesc, SamplerDesc,
};
use etendue::film::ErrorMeasure;
use etendue::math::DVec3;
use etendue::output::ToneMap;
use etendue::render::{MAX_THREADS, MOST_SAMPLES, Share};
use etendue::spectrum::{Primaries, Sensor, VISIBLE};

pub use matte_args::MatteArgs;

/// Physically based rendering of scene files.
///
/// Of an option that is given twice the last counts, except --output, which adds up.
///
/// Exit codes: 0 done; 1 failed while running; 2 the command, the scene or an image cannot be used, nothing was done;
/// 130 stopped by Ctrl-C after writing what there was.
#[derive(Debug, Parser)]
#[command(name = "etendue", version, args_override_self = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to image files.
    Render(Box<RenderArgs>),
    /// Write any scene as a scene file of the native format, with its meshes and images beside it.
    Convert(ConvertArgs),
    /// Put the parts of a picture together that were rendered by several processes.
    Merge(MergeArgs),
    /// Say what a scene holds, what was built for it and why.
    Info(InfoArgs),
    /// Write the photons of a map, or draw them.
    Photons(PhotonsArgs),
    /// Bake light maps: the irradiance of all surfaces, in texels and at vertices.
    Bake(BakeArgs),
    /// Calculate illuminance [lx] and luminance [cd/m²] at points, with the figures of lighting design.
    Lux(LuxArgs),
    /// Measure how far image A is from the reference B.
    Compare(CompareArgs),
    /// Measure time and error of scenes against references, and write a report.
    Bench(BenchArgs),
}

#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scene file: JSON, glTF 2.0 (.gltf, .glb), or a mesh that is a scene by itself (.obj, .ply, .stl).
    pub scene: PathBuf,
    /// Parameter file of a scene of the 2017 report.
    pub params: Option<PathBuf>,
    /// Image files to write, by extension: .exr, .pfm or .png. Put them after the scene, or repeat the option.
    #[arg(short, long, value_name = "FILE", required_unless_present = "checkpoint", num_args = 1..)]
    pub output: Vec<PathBuf>,

    /// Threads; 0 takes all there are.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse_threads)]
    pub threads: usize,
    /// Name or number of the camera of a glTF file, in place of the first one of its scene.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Seconds after the beginning of the animation of a glTF file at which the scene is seen.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// Name or number of the animation of a glTF file, in place of the first one.
    #[arg(long, value_name = "NAME", requires = "at")]
    pub animation: Option<String>,
    /// The time in seconds at which a scene in which something moves is seen, without blur, in place of its shutter.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = parse_seconds)]
    pub time_at: Option<f64>,
    /// Frames of a scene in which something moves, such as 1-48. The shutter's times are from the time of the frame on, which is its
    /// number over the frame rate. Each # in the names of files is a digit of the number.
    #[arg(long, value_name = "FIRST-LAST", value_parser = parse_frames, conflicts_with_all = ["time_at", "at"])]
    pub frames: Option<Frames>,
    /// Frames per second.
    #[arg(long, value_name = "N", default_value_t = 24.0, requires = "frames", value_parser = parse_frame_rate)]
    pub frame_rate: f64,
    /// Samples per pixel, in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Stop after so many seconds. With --spp, at whichever comes first; without, the scene's samples do not count.
    #[arg(long, value_name = "SECONDS", value_parser = parse_time)]
    pub time: Option<Duration>,
    /// Stop when the estimated relMSE of the image is no larger than this, such as 0.001.
    #[arg(long, value_name = "RELMSE", value_parser = parse_error)]
    pub target_error: Option<f64>,
    /// Stop when the estimated error of what a screen shows is no larger than this, in levels of 255, such as 2.
    #[arg(long, value_name = "LEVELS", value_parser = parse_error, conflicts_with = "target_error")]
    pub target_display: Option<f64>,
    /// More samples for pixels with more error; alone it means on. On by itself where an error is aimed at without --reuse.
    #[arg(long, value_name = "on|off", value_enum, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "on", hide_possible_values = true)]
    pub adaptive: Option<Switch>,
    /// Seed of all randomness, in place of the scene's.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Width and height in pixels, such as 640x480, in place of the scene's.
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub resolution: Option<[u32; 2]>,
    /// Renders only this rectangle of the picture: first column, first row, width and height, such as 100,50,64x48.
    #[arg(long, value_name = "X,Y,WxH", value_parser = parse_crop)]
    pub crop: Option<CropDesc>,
    /// Light transport, in place of the scene's.
    #[arg(long, value_enum)]
    pub integrator: Option<Integrator>,
    /// Pixels in groups of 16 share the second hits of their paths; alone it means on. Only with the integrator path. In place of the
    /// choice of the scene; by default, a pilot of long renders says.
    #[arg(long, value_name = "on|off", value_enum, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "on", hide_possible_values = true)]
    pub reuse: Option<Switch>,
    /// Light paths, from lamps by way of mirrors and glass to what the camera sees, find caustics beside the paths from the camera; alone it
    /// means on. Only with the integrator path. In place of the choice of the scene; by default, a pilot of long renders says.
    #[arg(long, value_name = "on|off", value_enum, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "on", hide_possible_values = true)]
    pub light_paths: Option<Switch>,
    /// Whether the integrator auto may choose the irradiance cache, whose bias error estimates do not know, where a pilot of a long render
    /// says that its whole error is the least for the time. In place of the scene's.
    #[arg(long, value_enum)]
    pub bias: Option<Bias>,
    /// Paths carry wavelengths instead of three channels; alone it means on. In place of the scene's choice.
    #[arg(long, value_name = "on|off", value_enum, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "on", hide_possible_values = true)]
    pub spectral: Option<Switch>,
    /// Layers of an EXR for light by how often it was scattered on its way from its emitter: emission (not at all), direct (once) and
    /// indirect. With the integrators path, direct and auto, which is then path.
    #[arg(long)]
    pub light_layers: bool,
    /// Layers of an EXR for the mean spectral radiance over so many bands of equal width, 3 to 512. With --spectral.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=512))]
    pub spectral_layers: Option<u32>,
    /// First and last wavelength of those bands in nm, within 360 and 830.
    #[arg(long, value_name = "FIRST-LAST", default_value = "380-780", requires = "spectral_layers")]
    #[arg(value_parser = parse_range)]
    pub spectral_range: WavelengthRange,
    #[command(flatten)]
    pub mattes: MatteArgs,
    /// The light under which white surfaces are grey in the picture: A, D50, D55, D65, D75, E, FL1 to FL12, a temperature in kelvin (black bodies
    /// below 4000, daylight above), or its chromaticity X,Y.
    #[arg(long, value_name = "LIGHT", value_parser = parse_white)]
    pub white_balance: Option<White>,
    /// Pixel filter: box, tent, gaussian[:SIGMA], blackman-harris or mitchell[:B,C].
    #[arg(long, value_name = "FILTER", value_parser = parse_filter)]
    pub filter: Option<FilterDesc>,
    /// Where the samples of a pixel come from.
    #[arg(long, value_enum)]
    pub sampler: Option<Sampler>,
    /// Light samples per hit, in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SHADOW_RAYS)))]
    pub shadow_rays: Option<u32>,
    /// Light samples at the hits that the camera sees itself or by way of mirrors and smooth glass alone. Only with the integrator path. In
    /// place of the scene's; by default, a pilot of long renders says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SHADOW_RAYS)))]
    pub first_shadow_rays: Option<u32>,
    /// Which survival probability Russian roulette ends paths by, in place of the scene's.
    #[arg(long, value_enum)]
    pub roulette: Option<Roulette>,
    /// Light paths of a photon map (of each pass, where maps are made anew), in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_PHOTONS)))]
    pub photons: Option<u32>,
    /// Radius of density estimates in scene units, in place of the scene's.
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = parse_radius)]
    pub photon_radius: Option<f64>,
    /// Light paths of a caustic map, in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_PHOTONS)))]
    pub caustic_photons: Option<u32>,
    /// Radius of caustics in scene units, in place of the scene's.
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = parse_radius)]
    pub caustic_radius: Option<f64>,
    /// Radiosity: iterations, or none to go on until little is left. Gathered ones are bounces of light.
    #[arg(long, value_name = "N|none", value_parser = parse_iterations)]
    pub iterations: Option<Iterations>,
    /// Radiosity: longest side below which elements are not divided, in scene units, in place of the scene's.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = parse_element_size)]
    pub element_size: Option<f64>,
    /// Radiosity: what one link between elements may be wrong by, in thousandths of all irradiance.
    #[arg(long, value_name = "E", value_parser = parse_link_error)]
    pub radiosity_error: Option<f64>,
    /// Radiosity: how the system is solved.
    #[arg(long, value_enum)]
    pub radiosity_solver: Option<Solver>,
    /// Radiosity: light that was not yet distributed is shown as its mean; alone it means on.
    #[arg(long, value_name = "on|off", value_enum, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "on", hide_possible_values = true)]
    pub ambient: Option<Switch>,
    /// Radiosity: direct light from light samples, indirect light from a ray into the solution; alone it means on.
    #[arg(long, value_name = "on|off", value_enum, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "on", hide_possible_values = true)]
    pub final_gather: Option<Switch>,
    /// Greatest number of surface hits on a path, or none for no cut.
    #[arg(long, value_name = "N|none", value_parser = parse_depth)]
    pub max_depth: Option<Depth>,

    #[command(flatten)]
    pub state: CheckpointArgs,

    /// A file for what the render came to: one JSON object.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Rewrite the images after each pass.
    #[arg(long)]
    pub progressive: bool,
    /// How radiance becomes brightness in a PNG.
    #[arg(long, value_enum, default_value_t = Tone::Clamp)]
    pub tone_map: Tone,
    /// Primaries of the colours of an EXR or PFM; a PNG is always sRGB.
    #[arg(long, value_enum, default_value_t = Space::Rec709)]
    pub primaries: Space,
    /// Brightness of a PNG in stops: 1 doubles it.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0)]
    #[arg(allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: f32,
    /// No progress and no summary; warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

/// The options of `render` about checkpoints.
#[derive(Debug, Args)]
pub struct CheckpointArgs {
    /// A file for the state of the render, written every so often and at the end, also where a signal stops the render.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["frames", "spectral_layers"])]
    pub checkpoint: Option<PathBuf>,
    /// Seconds from one checkpoint to the next.
    #[arg(long, value_name = "SECONDS", default_value = "60", requires = "checkpoint", value_parser = parse_time)]
    pub checkpoint_every: Duration,
    /// Go on from a checkpoint of the same scene and settings. Of these, only the number of samples, time, errors and threads may differ.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["frames", "spectral_layers"])]
    pub resume: Option<PathBuf>,
    /// Render part K of N of the picture, such as 3/16, into a checkpoint; `merge` makes the picture of all parts.
    #[arg(long, value_name = "K/N", value_parser = parse_share, requires = "checkpoint", conflicts_with_all = ["frames", "spectral_layers"])]
    pub share: Option<Share>,
}

#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Checkpoints of all parts of a picture, in any order; or one of a whole picture, which is written as images.
    #[arg(value_name = "CHECKPOINT", required = true, num_args = 1..)]
    pub parts: Vec<PathBuf>,
    /// Image files to write, by extension: .exr, .pfm or .png. Put them after the checkpoints, or repeat the option.
    #[arg(short, long, value_name = "FILE", required_unless_present = "checkpoint", num_args = 1..)]
    pub output: Vec<PathBuf>,
    /// A file for the checkpoint of the whole picture.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// How radiance becomes brightness in a PNG.
    #[arg(long, value_enum, default_value_t = Tone::Clamp)]
    pub tone_map: Tone,
    /// Primaries of the colours of an EXR or PFM; a PNG is always sRGB.
    #[arg(long, value_enum, default_value_t = Space::Rec709)]
    pub primaries: Space,
    /// Brightness of a PNG in stops: 1 doubles it.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0)]
    #[arg(allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: f32,
    /// No summary; warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// Scene file: JSON, glTF 2.0 (.gltf, .glb), or a mesh that is a scene by itself (.obj, .ply, .stl).
    pub scene: PathBuf,
    /// Scene file to write (.json). Meshes and images go into a folder beside it: room.files for room.json.
    pub output: PathBuf,
    /// Parameter file of a scene of the 2017 report.
    #[arg(long, value_name = "FILE")]
    pub params: Option<PathBuf>,
    /// Name or number of the camera of a glTF file, in place of the first one of its scene.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Seconds after the beginning of the animation of a glTF file at which the scene is seen.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// Name or number of the animation of a glTF file, in place of the first one.
    #[arg(long, value_name = "NAME", requires = "at")]
    pub animation: Option<String>,
    /// No summary; warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Scene file: JSON, or a mesh that is a scene by itself (.obj, .ply, .stl).
    pub scene: PathBuf,
    /// Parameter file of a scene of the 2017 report.
    pub params: Option<PathBuf>,
    /// Threads to build with; 0 takes all there are.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse_threads)]
    pub threads: usize,
}

#[derive(Debug, Args)]
pub struct PhotonsArgs {
    /// Scene file: JSON, or a mesh that is a scene by itself (.obj, .ply, .stl).
    pub scene: PathBuf,
    /// Parameter file of a scene of the 2017 report.
    pub params: Option<PathBuf>,
    /// Files to write, by extension: tables (.csv), point clouds (.ply), pictures (.png, .exr, .pfm). Put them after the
    /// scene, or repeat the option.
    #[arg(short, long, value_name = "FILE", required = true, num_args = 1..)]
    pub output: Vec<PathBuf>,

    /// Which photons.
    #[arg(long, value_enum, default_value_t = Map::Direct)]
    pub map: Map,
    /// Light paths, in place of the scene's; 100000 where that has none.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_PHOTONS)))]
    pub photons: Option<u32>,
    /// Threads; 0 takes all there are.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse_threads)]
    pub threads: usize,
    /// Seed of all randomness, in place of the scene's.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Greatest number of surface hits on a path, or none for no cut.
    #[arg(long, value_name = "N|none", value_parser = parse_depth)]
    pub max_depth: Option<Depth>,

    /// Draw photons in the colour of their power instead of white.
    #[arg(long)]
    pub color: bool,
    /// Width and height of a picture in pixels, in place of the scene's.
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub resolution: Option<[u32; 2]>,
    /// Where a picture is seen from, such as 0,1,5, in place of the scene's camera.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub origin: Option<DVec3>,
    /// A point in the middle of a picture.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub look_at: Option<DVec3>,
    /// Upwards in a picture.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector)]
    pub up: Option<DVec3>,
    /// Full angle of view of a picture, degrees.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = parse_angle)]
    pub field_of_view: Option<f64>,
    /// No summary; warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct BakeArgs {
    /// Scene file: JSON, or a mesh that is a scene by itself (.obj, .ply, .stl).
    pub scene: PathBuf,
    /// Parameter file of a scene of the 2017 report.
    pub params: Option<PathBuf>,
    /// What the files' names begin with: PREFIX.exr (light map), PREFIX.obj (its coordinates), PREFIX.ply (vertices) and
    /// PREFIX.json (summary). Of a folder: the scene's name in it.
    #[arg(short, long, value_name = "PREFIX")]
    pub output: PathBuf,

    /// How light is found.
    #[arg(long, value_enum, default_value_t = BakeMethod::Path)]
    pub method: BakeMethod,
    /// Only the light map, or only the vertices, instead of both.
    #[arg(long, value_enum)]
    pub only: Option<BakeTarget>,
    /// Texels along the sides of the light map; 512 where --texels-per-unit is not given either.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SIDE)))]
    pub resolution: Option<u32>,
    /// Texels for a unit of length; as many as fit where only --resolution is given.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse_length)]
    pub texels_per_unit: Option<f64>,
    /// Texels around each chart that are its own.
    #[arg(long, value_name = "N", default_value_t = 2)]
    #[arg(value_parser = clap::value_parser!(u32).range(..=i64::from(MAX_GUTTER)))]
    pub gutter: u32,
    /// Where the layout of meshes comes from.
    #[arg(long, value_enum, default_value_t = BakeLayout::Auto)]
    pub layout: BakeLayout,
    /// Greatest length of a triangle's side between vertices; the vertices as they are where none is given.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = parse_length)]
    pub spacing: Option<f64>,
    /// The inner side of surfaces instead of the outer one.
    #[arg(long)]
    pub back: bool,
    /// Most memory for the light map and its work, MiB.
    #[arg(long, value_name = "MIB", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..))]
    pub memory: u32,

    /// Threads; 0 takes all there are.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse_threads)]
    pub threads: usize,
    /// Samples per texel and vertex, in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Stop each of both after so many seconds. With --spp, at whichever comes first; without, the scene's samples do not count.
    #[arg(long, value_name = "SECONDS", value_parser = parse_time)]
    pub time: Option<Duration>,
    /// Stop when the estimated relMSE over texels (or vertices) is no larger than this, such as 0.001.
    #[arg(long, value_name = "RELMSE", value_parser = parse_error)]
    pub target_error: Option<f64>,
    /// Seed of all randomness, in place of the scene's.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Light samples per hit, in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SHADOW_RAYS)))]
    pub shadow_rays: Option<u32>,
    /// Greatest number of surface hits on a path, the texel being the first, or none for no cut. 1 is direct light alone.
    #[arg(long, value_name = "N|none", value_parser = parse_depth)]
    pub max_depth: Option<Depth>,

    /// Brightness of the vertices' display colours in stops: 1 doubles it.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0)]
    #[arg(allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: f32,
    /// No progress and no summary; warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct LuxArgs {
    /// Scene file: JSON, or a mesh that is a scene by itself (.obj, .ply, .stl).
    pub scene: PathBuf,
    /// Parameter file of a scene of the 2017 report.
    pub params: Option<PathBuf>,
    /// File of grids: planes, points and views, each with a name (docs/photometry.md).
    #[arg(long, value_name = "FILE", required_unless_present = "plane")]
    pub grid: Option<PathBuf>,
    /// A plane in place of a file, or beside it: a corner, two sides and the numbers of points along them, such as
    /// 0,0.8,0 0,0,3 4,0,0 6x8. Its normal is that of the first side times the second.
    #[arg(long, value_names = ["CORNER", "SIDE", "SIDE", "NxM"], num_args = 4, allow_hyphen_values = true)]
    pub plane: Option<Vec<String>>,
    /// The normal of --plane, in place of its own.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_vector, requires = "plane")]
    pub normal: Option<DVec3>,
    /// Files to write, by extension: tables (.csv), results as one object (.json), false-colour pictures of all planes
    /// (.png). The table for people goes to standard output in any case.
    #[arg(short, long, value_name = "FILE", num_args = 1..)]
    pub output: Vec<PathBuf>,

    /// How light is found.
    #[arg(long, value_enum, default_value_t = LuxMethod::Path)]
    pub method: LuxMethod,
    /// Stop a grid when its relative standard error is no larger than this: the root of the mean square over its points.
    /// 0.01 where nothing else limits the work.
    #[arg(long, value_name = "ERROR", value_parser = parse_error)]
    pub error: Option<f64>,
    /// Most samples per point; 1048576 unless --time is given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    pub spp: Option<u32>,
    /// Stop each grid after so many seconds.
    #[arg(long, value_name = "SECONDS", value_parser = parse_time)]
    pub time: Option<Duration>,
    /// Daylight factors: the sky alone lights the scene, and illuminance is given in per cent of that outside too.
    #[arg(long)]
    pub daylight: bool,
    /// Greatest number of surface hits on a path, the point being the first, or none for no cut. 1 is direct light alone. Not with radiosity.
    #[arg(long, value_name = "N|none", value_parser = parse_depth)]
    pub max_depth: Option<Depth>,
    /// Light samples per hit, in place of the scene's.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SHADOW_RAYS)))]
    pub shadow_rays: Option<u32>,
    /// Seed of all randomness, in place of the scene's.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads; 0 takes all there are.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse_threads)]
    pub threads: usize,

    /// Value at the upper end of a picture's scale, in place of a round one above the greatest.
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true, value_parser = parse_length)]
    pub scale: Option<f64>,
    /// No progress and no notes; the table, warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LuxMethod {
    /// Path tracing: everything, without bias.
    Path,
    /// A radiosity solution, whose light is gathered at each point: for diffuse scenes.
    Radiosity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BakeMethod {
    /// Path tracing: everything, with noise whose size is known.
    Path,
    /// Radiosity: without noise, for diffuse scenes; elements as small as texels, unless the scene says how large.
    Radiosity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BakeTarget {
    /// The light map and its coordinates.
    Map,
    /// The vertices.
    Vertices,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum BakeLayout {
    /// A mesh's own texture coordinates where they are fit for it, else charts.
    Auto,
    /// Charts.
    Charts,
    /// A mesh's own texture coordinates; an error where they are not fit for it.
    Own,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Map {
    /// Light straight from the emitters, and shadow photons behind what it meets.
    Direct,
    /// Light that came by mirrors and glass only.
    Caustic,
    /// Light that was scattered diffusely before.
    Indirect,
    /// All light.
    Global,
}

#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The image in question: .exr, .pfm or .png.
    pub a: PathBuf,
    /// The reference, of the same size.
    pub b: PathBuf,
    /// Print one JSON object; what is not finite is null.
    #[arg(long)]
    pub json: bool,
    /// Leave out FLIP, the slow one.
    #[arg(long)]
    pub no_flip: bool,
    /// Brightness at which FLIP looks at the images, in stops.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0)]
    #[arg(allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: f32,
}

#[derive(Debug, Args)]
pub struct BenchArgs {
    /// Scene files (JSON).
    #[arg(required_unless_present_any = ["suite", "report_only"])]
    pub scenes: Vec<PathBuf>,
    /// Suite file (JSON) with groups of cases, in place of scenes.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "integrators", "samplers"])]
    pub suite: Option<PathBuf>,
    /// Folder for results.json, results.md, report.html and the pictures; made where it is missing. Beside the results with
    /// --report-only, else out/bench where none is given.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,

    /// Light transport to compare, separated by commas; the scene's where none is given.
    #[arg(long, value_name = "NAME,...", value_enum, value_delimiter = ',')]
    pub integrators: Vec<Integrator>,
    /// Samplers to compare, separated by commas; the scene's where none is given.
    #[arg(long, value_name = "NAME,...", value_enum, value_delimiter = ',')]
    pub samplers: Vec<Sampler>,
    /// Samples per pixel to try, separated by commas; 16,64,256 where there is neither --spp nor --time.
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Vec<u32>,
    /// Seconds to try, separated by commas.
    #[arg(long, value_name = "SECONDS,...", value_delimiter = ',', value_parser = parse_time)]
    pub time: Vec<Duration>,
    /// Numbers of threads to try, separated by commas; 0 takes all there are.
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = parse_threads)]
    pub threads: Vec<usize>,
    /// Width and height in pixels, such as 256x256, in place of the scene's.
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub resolution: Option<[u32; 2]>,
    /// Runs of each case, each with a seed of its own; the suite's number, or 5.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: Option<u32>,

    /// Folder of references, NAME-WxH.exr; what is missing is path traced and kept there. References in the output
    /// folder where none is given.
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
    /// Samples per pixel of references that are made; the suite's number, or four times the most that is measured and
    /// at least 1024.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..))]
    pub reference_spp: Option<u32>,

    /// Results of other renderers (JSON) that the report shows beside; may be repeated.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub include: Vec<PathBuf>,
    /// Render nothing, and make the report of these results anew.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "suite"])]
    pub report_only: Option<PathBuf>,
    /// Markdown file in which the tables between <!-- bench GROUP --> and <!-- /bench --> are written anew.
    #[arg(long, value_name = "FILE")]
    pub tables: Option<PathBuf>,
    /// No progress and no summary; warnings and errors stay.
    #[arg(short, long)]
    pub quiet: bool,
}

/// An integrator, by the name and with the description that it has in the table of integrators.
#[derive(Clone, Copy, Debug)]
pub struct Integrator(pub IntegratorDesc);

impl ValueEnum for Integrator {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<Integrator>> = LazyLock::new(|| IntegratorDesc::ALL.map(Integrator).to_vec());
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let info = self.0.info();
        Some(PossibleValue::new(info.name).help(info.description.trim_end_matches('.')))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    On,
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Bias {
    /// Unbiased and consistent integrators only.
    Refused,
    /// The irradiance cache too.
    Allowed,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Sampler {
    /// Owen-scrambled Sobol' points.
    Sobol,
    /// Independent random numbers.
    Random,
    /// One random position in each of n x n cells.
    Jittered,
    /// n x n regular positions.
    Grid,
    /// Normally distributed around the pixel's centre.
    Gaussian,
}

/// A survival probability of Russian roulette, by its name in files.
#[derive(Clone, Copy, Debug)]
pub struct Roulette(pub RouletteDesc);

impl ValueEnum for Roulette {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<Roulette>> = LazyLock::new(|| RouletteDesc::ALL.map(Roulette).to_vec());
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            RouletteDesc::Own => "The library's own, by the throughput that a path still carries",
            RouletteDesc::File => "The reflectionRate of the scene's materials",
        };
        Some(PossibleValue::new(self.0.name()).help(help))
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Solver {
    /// Every element gathers from all others, again and again.
    Gather,
    /// The patch that has most light left shoots it.
    Shoot,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Tone {
    /// Divide by the largest value of the image.
    Maximum,
    /// 1 is white, and so is all above.
    Clamp,
    /// x / (1 + x).
    Reinhard,
    /// A film-like curve.
    Aces,
}

/// The primaries of colours in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// Rec. 709, white D65.
    Rec709,
    /// Rec. 2020, white D65.
    Rec2020,
    /// ACEScg, adapted to its white.
    Acescg,
    /// Tristimulus values of CIE 1931.
    Xyz,
}

impl From<Space> for Primaries {
    fn from(space: Space) -> Self {
        match space {
            Space::Rec709 => Self::Rec709,
            Space::Rec2020 => Self::Rec2020,
            Space::Acescg => Self::AcesCg,
            Space::Xyz => Self::Xyz,
        }
    }
}

impl From<Tone> for ToneMap {
    fn from(tone: Tone) -> Self {
        match tone {
            Tone::Maximum => Self::Maximum,
            Tone::Clamp => Self::Clamp,
            Tone::Reinhard => Self::Reinhard,
            Tone::Aces => Self::Aces,
        }
    }
}

/// A range of numbers of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// The first.
    pub first: u32,
    /// The last, not before the first.
    pub last: u32,
}

/// A path length; `None` cuts nothing. A type of its own because clap gives `Option` a meaning.
#[derive(Clone, Copy, Debug)]
pub struct Depth(pub Option<u32>);

/// Iterations; `None` until little is left.
#[derive(Clone, Copy, Debug)]
pub struct Iterations(pub Option<u32>);

/// Wavelengths \[nm\]: a first and a last one.
#[derive(Clone, Copy, Debug)]
pub struct WavelengthRange(pub [f64; 2]);

impl RenderArgs {
    /// A setting of an integrator. Another integrator takes the place of the scene's together with its settings, as in a file.
    fn of_integrator<T>(&self, asked: Option<T>, scene: Option<T>) -> Option<T> {
        asked.or(scene.filter(|_| self.integrator.is_none()))
    }

    /// The error to stop at, and what it is measured by.
    pub fn target(&self) -> Option<(ErrorMeasure, f64)> {
        let relative = self.target_error.map(|target| (ErrorMeasure::RelMse, target));
        relative.or(self.target_display.map(|target| (ErrorMeasure::Display, target)))
    }

    /// What is taken from a file that describes more than one picture.
    pub fn choices(&self) -> LoadOptions {
        LoadOptions {
            time: self.at,
            animation: self.animation.clone(),
            camera: self.camera.clone(),
            ..LoadOptions::default()
        }
    }

    /// The scene's settings with those of the command line in their place.
    pub fn settings(&self, scene: &RenderDesc) -> RenderDesc {
        let is_limited = self.time.is_some() || self.target().is_some();
        RenderDesc {
            resolution: self.resolution.unwrap_or(scene.resolution),
            // A rectangle of the scene's picture means nothing in one of another size.
            crop: self.crop.or(scene.crop.filter(|_| self.resolution.is_none())),
            // Time or error alone count where they are all that was asked for.
            samples: self.spp.unwrap_or(if is_limited { MOST_SAMPLES } else { scene.samples }),
            sampler: self.sampler.map_or(scene.sampler, |sampler| match sampler {
                Sampler::Sobol => SamplerDesc::Sobol,
                Sampler::Random => SamplerDesc::Random,
                Sampler::Jittered => SamplerDesc::Jittered,
                Sampler::Grid => SamplerDesc::Grid,
                Sampler::Gaussian => SamplerDesc::Gaussian,
            }),
            filter: self.filter.unwrap_or(scene.filter),
            integrator: self.integrator.map_or(scene.integrator, |Integrator(integrator)| integrator),
            reuse: self.of_integrator(self.reuse.map(|it| it == Switch::On), scene.reuse),
            light_paths: self.of_integrator(self.light_paths.map(|it| it == Switch::On), scene.light_paths),
            allow_bias: self
                .of_integrator(self.bias.map(|it| it == Bias::Allowed), Some(scene.allow_bias))
                .unwrap_or(false),
            spectral: self.spectral.map_or(scene.spectral, |spectral| spectral == Switch::On),
            white_balance: self.white_balance.map_or(scene.white_balance, |White(white)| Some(white)),
            max_depth: self.max_depth.map_or(scene.max_depth, |depth| depth.0),
            shadow_rays: self.shadow_rays.unwrap_or(scene.shadow_rays),
            first_shadow_rays: self.of_integrator(self.first_shadow_rays, scene.first_shadow_rays),
            roulette: self.roulette.map_or(scene.roulette, |roulette| roulette.0),
            photons: PhotonDesc {
                count: self.photons.or(scene.photons.count),
                radius: self.photon_radius.or(scene.photons.radius),
                caustic_count: self.caustic_photons.or(scene.photons.caustic_count),
                caustic_radius: self.caustic_radius.or(scene.photons.caustic_radius),
                ..scene.photons.clone()
            },
            cache: scene.cache.clone(),
            radiosity: RadiosityDesc {
                element_size: self.element_size.or(scene.radiosity.element_size),
                error: self.radiosity_error.unwrap_or(scene.radiosity.error),
                iterations: self.iterations.map_or(scene.radiosity.iterations, |iterations| iterations.0),
                solver: self.radiosity_solver.map_or(scene.radiosity.solver, |solver| match solver {
                    Solver::Gather => RadiositySolver::Gather,
                    Solver::Shoot => RadiositySolver::Shoot,
                }),
                ambient: self.ambient.map_or(scene.radiosity.ambient, |ambient| ambient == Switch::On),
                final_gather: self.final_gather.map_or(scene.radiosity.final_gather, |gather| gather == Switch::On),
                ..scene.radiosity.clone()
            },
            seed: self.seed.unwrap_or(scene.seed),
        }
    }
}

fn parse_threads(text: &str) -> Result<usize, String> {
    let threads = text.parse::<usize>().ok().filter(|threads| *threads <= MAX_THREADS);
    threads.ok_or_else(|| format!("expected a whole number up to {MAX_THREADS}"))
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| seconds.abs() <= f64::from(f32::MAX));
    seconds.ok_or_else(|| "expected seconds, such as 0.5".to_owned())
}

fn parse_frame_rate(text: &str) -> Result<f64, String> {
    let rate = text.parse::<f64>().ok().filter(|rate| (1e-3..=1e6).contains(rate));
    rate.ok_or_else(|| "expected frames per second from 0.001 to 1000000, such as 25".to_owned())
}

/// The greatest number of a frame: file names have up to as many digits as it has.
const MOST_FRAMES: u32 = 999_999;

fn parse_frames(text: &str) -> Result<Frames, String> {
    let wrong = || format!("expected FIRST-LAST up to {MOST_FRAMES}, such as 1-48, or one number");
    let number = |text: &str| text.parse::<u32>().ok().filter(|number| *number <= MOST_FRAMES).ok_or_else(wrong);
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let frames = Frames { first: number(first)?, last: number(last)? };
    if frames.last < frames.first { Err(wrong()) } else { Ok(frames) }
}

fn parse_share(text: &str) -> Result<Share, String> {
    let wrong = || "expected part K of N, such as 3/16".to_owned();
    let (number, count) = text.split_once('/').ok_or_else(wrong)?;
    let [number, count] = [number, count].map(|text| text.parse().ok());
    let (number, count) = number.zip(count).ok_or_else(wrong)?;
    Share::new(number, count).map_err(|error| error.message().to_owned())
}

fn parse_radius(text: &str) -> Result<f64, String> {
    let [low, high] = RADII;
    let radius = text.parse::<f64>().ok().filter(|radius| (low..=high).contains(radius));
    radius.ok_or_else(|| format!("expected a radius from {low:e} to {high:e}, such as 0.1"))
}

fn parse_element_size(text: &str) -> Result<f64, String> {
    parse_radius(text).map_err(|message| message.replace("a radius", "a length"))
}

fn parse_length(text: &str) -> Result<f64, String> {
    let length = text.parse::<f64>().ok().filter(|length| *length > 0.0 && length.is_finite());
    length.ok_or_else(|| "expected a number above 0, such as 8 or 0.1".to_owned())
}

fn parse_error(text: &str) -> Result<f64, String> {
    let error = text.parse::<f64>().ok().filter(|error| *error > 0.0 && error.is_finite());
    error.ok_or_else(|| "expected an error above 0, such as 0.001".to_owned())
}

fn parse_time(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| *seconds > 0.0);
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "expected seconds above 0, such as 30 or 0.5".to_owned())
}

fn parse_resolution(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "expected WIDTHxHEIGHT in pixels, such as 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let length = |text: &str| text.parse::<u32>().ok().filter(|length| *length > 0).ok_or_else(wrong);
    let (width, height) = (length(width)?, length(height)?);
    if u64::from(width) * u64::from(height) > etendue::desc::MAX_PIXELS {
        return Err(format!("more than {} pixels", etendue::desc::MAX_PIXELS));
    }
    Ok([width, height])
}

fn parse_crop(text: &str) -> Result<CropDesc, String> {
    let wrong = || "expected X,Y,WIDTHxHEIGHT in pixels of the whole picture, such as 100,50,64x48".to_owned();
    let mut parts = text.splitn(3, ',');
    let mut next = || parts.next().map(str::trim).ok_or_else(wrong);
    let number = |text: &str| text.parse::<u32>().map_err(|_| wrong());
    let (left, top) = (number(next()?)?, number(next()?)?);
    let [width, height] = parse_resolution(next()?).map_err(|_| wrong())?;
    Ok(CropDesc { left, top, width, height })
}

fn parse_vector(text: &str) -> Result<DVec3, String> {
    let wrong = || "expected three numbers, such as 0,1,-2.5".to_owned();
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers: Vec<f64> = text.split(',').map(number).collect::<Option<_>>().ok_or_else(wrong)?;
    <[f64; 3]>::try_from(numbers).map(DVec3::from_array).map_err(|_| wrong())
}

impl LuxArgs {
    /// The plane of the options, if there is one.
    pub fn plane_grid(&self) -> Result<Option<PlaneGridDesc>, String> {
        let Some([origin, u, v, counts]) = self.plane.as_deref() else { return Ok(None) };
        let wrong = |text: &str, why: String| format!("--plane '{text}': {why}");
        let vector = |text: &String| parse_vector(text).map_err(|why| wrong(text, why));
        let pair = counts.split_once(['x', 'X']).and_then(|(n, m)| Some([n.parse().ok()?, m.parse().ok()?]));
        let counts =
            pair.ok_or_else(|| wrong(counts, "expected NxM, the numbers of points, such as 6x8".to_owned()))?;
        let [origin, u, v] = [vector(origin)?, vector(u)?, vector(v)?];
        Ok(Some(PlaneGridDesc { origin, u, v, counts, normal: self.normal }))
    }
}

fn parse_angle(text: &str) -> Result<f64, String> {
    let degrees = text.parse::<f64>().ok().filter(|degrees| *degrees > 0.0 && *degrees < 180.0);
    degrees.ok_or_else(|| "expected degrees between 0 and 180".to_owned())
}

fn parse_depth(text: &str) -> Result<Depth, String> {
    if text == "none" {
        return Ok(Depth(None));
    }
    let depth = text.parse::<u32>().ok().filter(|depth| *depth > 0);
    depth.map(|depth| Depth(Some(depth))).ok_or_else(|| "expected a number above 0, or none".to_owned())
}

fn parse_iterations(text: &str) -> Result<Iterations, String> {
    if text == "none" {
        return Ok(Iterations(None));
    }
    let count = text.parse::<u32>().ok().filter(|count| *count <= MAX_RADIOSITY_ITERATIONS);
    let wrong = || format!("expected a number up to {MAX_RADIOSITY_ITERATIONS}, or none");
    count.map(|count| Iterations(Some(count))).ok_or_else(wrong)
}

fn parse_link_error(text: &str) -> Result<f64, String> {
    let error = text.parse::<f64>().ok().filter(|error| *error >= 1e-6 && *error <= 1000.0);
    error.ok_or_else(|| "expected a number from 1e-6 to 1000, such as 5".to_owned())
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    let stops = text.parse::<f32>().ok().filter(|stops| (-64.0..=64.0).contains(stops));
    stops.ok_or_else(|| "expected stops within -64 and 64".to_owned())
}

/// A chromaticity.
#[derive(Clone, Copy, Debug)]
pub struct White([f64; 2]);

fn parse_white(text: &str) -> Result<White, String> {
    let pair = text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    let white = pair.or_else(|| RenderDesc::white_of(text));
    white.filter(|white| etendue::spectrum::white_balance(*white).is_some()).map(White).ok_or_else(|| {
        "expected A, D50, D55, D65, D75, E, FL1 to FL12, a temperature from 1000 to 25000 kelvin, or a chromaticity such as \
         0.3127,0.329"
            .to_owned()
    })
}

fn parse_range(text: &str) -> Result<WavelengthRange, String> {
    let numbers = text.split_once('-').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    let is_range = |range: &[f64; 2]| Sensor::Bands { range: *range }.check("").is_ok();
    let [low, high] = VISIBLE;
    let wrong = || format!("expected two wavelengths from {low} to {high} nm, the smaller one first, such as 400-700");
    numbers.filter(is_range).map(WavelengthRange).ok_or_else(wrong)
}

fn parse_filter(text: &str) -> Result<FilterDesc, String> {
    let (name, parameters) = match text.split_once(':') {
        Some((name, parameters)) => (name, Some(parameters)),
        None => (text, None),
    };
    let number = |text: &str| text.parse::<f32>().ok().filter(|number| number.is_finite());
    match (name, parameters) {
        ("box", None) => Ok(FilterDesc::Box),
        ("tent", None) => Ok(FilterDesc::Tent),
        ("blackman-harris", None) => Ok(FilterDesc::BlackmanHarris),
        ("gaussian", sigma) => sigma
            .map_or(Some(0.5), number)
            .filter(|sigma| *sigma > 0.0)
            .map(|sigma| FilterDesc::Gaussian { sigma })
            .ok_or_else(|| "expected gaussian:SIGMA with a standard deviation above 0 pixels".to_owned()),
        ("mitchell", None) => Ok(FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        ("mitchell", Some(parameters)) => parameters
            .split_once(',')
            .and_then(|(b, c)| Some(FilterDesc::Mitchell { b: number(b)?, c: number(c)? }))
            .ok_or_else(|| "expected mitchell:B,C such as mitchell:0.33,0.33".to_owned()),
        _ => Err("expected box, tent, gaussian[:SIGMA], blackman-harris or mitchell[:B,C]".to_owned()),
    }
}
