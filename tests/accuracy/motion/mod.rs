//! Motion: what a picture shows of things that move while the shutter is open is the mean over its moments.

mod bodies;
mod edges;
mod lamps;
mod photons;
mod whole;

use etendue::desc::{self, IntegratorDesc, MotionDesc, SceneDesc, ShutterDesc};
use etendue::film::Image;
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use serde_json::{Value, json};

use crate::common::scenes::{Job, mean_and_error, render};
use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    [edges::cases(), bodies::cases(), lamps::cases(), whole::cases(), photons::cases()].into_iter().flatten().collect()
}

/// The integrators that show motion by rays.
const INTEGRATORS: [(&str, IntegratorDesc); 3] =
    [("path", IntegratorDesc::Path), ("whitted", IntegratorDesc::Whitted), ("direct", IntegratorDesc::Direct)];

fn parse(scene: &Value) -> SceneDesc {
    desc::parse(&scene.to_string(), "".as_ref(), None).expect("a scene of the test")
}

/// A scene of these parts, with a black, a white and a grey material, and a mirror.
fn scene(camera: Value, lights: Value, surfaces: Value) -> SceneDesc {
    parse(&json!({
        "etendue": 1,
        "camera": camera,
        "materials": [
            {"name": "black", "type": "black"},
            {"name": "white", "type": "diffuse", "color": [1, 1, 1]},
            {"name": "grey", "type": "diffuse", "color": [0.5, 0.5, 0.5]},
            {"name": "mirror", "type": "reflective", "color": [1, 1, 1]},
        ],
        "lights": lights,
        "surfaces": surfaces,
    }))
}

/// A camera of parallel rays against z that sees a square of this width around a point of the plane z = 0.
fn window(x: f64, y: f64, width: f64, shutter: Value) -> Value {
    json!({"type": "orthographic", "origin": [x, y, 50], "lookAt": [x, y, 0], "up": [0, 1, 0], "width": width,
        "shutter": shutter})
}

/// The same description seen at one moment.
fn still(desc: &SceneDesc, time: f64) -> SceneDesc {
    let mut still = desc.clone();
    still.set_shutter(ShutterDesc::at(time)).expect("a moment");
    still
}

/// A description whose first surface moves by this motion.
fn moved(mut desc: SceneDesc, motion: MotionDesc) -> SceneDesc {
    desc.set_surface_motion(0, Some(motion)).expect("a motion of the test");
    desc
}

fn measure(desc: &SceneDesc, job: &Job) -> (f64, f64) {
    mean_and_error(&render(desc, job).0)
}

/// An image with its auxiliary layers.
fn layers(desc: &SceneDesc, job: &Job) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let settings = RenderSettings { desc: job.desc(), threads: 2, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(&scene, settings).expect("settings of the test");
    render.run(&mut |_| std::ops::ControlFlow::Continue(())).expect("no worker panics");
    render.image()
}
