//! Renders by several processes: the same bits as by one, whoever is slow, is lost or renders something else. Processes are threads here,
//! and links are channels.

mod common;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use common::scenes::{box_inside, brief, camera, point_light, scene};
use etendue::desc::{self, BsdfDesc, FilterDesc, IntegratorDesc, RadiosityDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::film::{ErrorMeasure, Image};
use etendue::math::DVec3;
use etendue::render::{Checkpoint, Crew, Ended, Event, Link, Render, RenderSettings, Summary, help};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Cancel, ErrorKind};

/// A room with a lamp and a ball.
fn room(ball: BsdfDesc) -> SceneDesc {
    let walls = BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) };
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::NEG_Z, 90.0),
        vec![
            (ShapeDesc::Mesh { mesh: 0, smooth: false }, walls, Some(Rgb::splat(0.1))),
            (ShapeDesc::Sphere { centre: DVec3::new(0.25, -0.125, -0.5), radius: 0.3 }, ball, None),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc.lights.push(point_light(DVec3::new(0.0, 0.875, -0.5), 0.5));
    desc
}

const GLASS: BsdfDesc = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
const PAINT: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::new(0.2, 0.4, 0.8) };

fn built(ball: BsdfDesc) -> Scene {
    Scene::build(&room(ball), &BuildOptions::default()).unwrap()
}

/// 5 x 4 tiles, of which some are cut.
fn settings(integrator: IntegratorDesc) -> RenderSettings {
    let radiosity = RadiosityDesc { element_size: Some(0.5), ..RadiosityDesc::default() };
    let desc = RenderDesc { resolution: [68, 51], radiosity, ..brief(integrator) };
    RenderSettings { desc, auxiliary: true, threads: 1, ..RenderSettings::default() }
}

fn bits(image: &Image) -> Vec<u32> {
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}

/// How a helper is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Health {
    Well,
    /// It dies in place of sending its message with this number, from 0 on.
    Dies(usize),
    /// It brings no tiles unless it is told to stop.
    Slow,
    /// It hears nothing before it is told to stop for so many times, the last of which it hears first.
    Sleepy(u32),
}

/// One end of channels.
struct Channels {
    to: Vec<Sender<(usize, Event)>>,
    from: Receiver<(usize, Event)>,
    /// The number by which the others know this end.
    own: usize,
    health: Health,
    sent: usize,
    /// Messages of a slow helper that are not delivered yet, and those that a sleepy one has not heard.
    held: Vec<Vec<u8>>,
    unheard: VecDeque<(usize, Event)>,
    stops: u32,
    is_dead: bool,
    /// Whether a slow helper was told to stop.
    is_told: bool,
}

impl Channels {
    fn new(to: Vec<Sender<(usize, Event)>>, from: Receiver<(usize, Event)>, own: usize, health: Health) -> Self {
        Self {
            to,
            from,
            own,
            health,
            sent: 0,
            held: Vec::new(),
            unheard: VecDeque::new(),
            stops: 0,
            is_dead: false,
            is_told: false,
        }
    }
}

impl Link for Channels {
    fn peers(&self) -> usize {
        self.to.len()
    }

    fn send(&mut self, peer: usize, message: Vec<u8>) {
        if self.is_dead {
            return;
        }
        if self.health == Health::Dies(self.sent) {
            self.is_dead = true;
            let _ = self.to[peer].send((self.own, Event::Lost("its machine is on fire".to_owned())));
            return;
        }
        self.sent += 1;
        if self.health == Health::Slow && !self.is_told && message.windows(4).any(|bytes| bytes == b"Done") {
            self.held.push(message);
            return;
        }
        let _ = self.to[peer].send((self.own, Event::Message(message)));
    }

    fn receive(&mut self) -> Option<(usize, Event)> {
        if self.is_dead {
            return Some((0, Event::Lost("this machine is on fire".to_owned())));
        }
        let health = self.health;
        let is_asleep = |stops| matches!(health, Health::Sleepy(until) if stops < until);
        if !is_asleep(self.stops)
            && let Some(received) = self.unheard.pop_front()
        {
            return Some(received);
        }
        let received = self.from.try_recv().ok()?;
        let is =
            |name: &[u8]| matches!(&received.1, Event::Message(bytes) if bytes.windows(4).any(|bytes| bytes == name));
        self.is_told = (self.is_told || is(b"Stop")) && !is(b"Pass");
        if self.is_told {
            for message in self.held.drain(..) {
                let _ = self.to[0].send((self.own, Event::Message(message)));
            }
        }
        self.stops += u32::from(is(b"Stop"));
        if is_asleep(self.stops) {
            self.unheard.push_back(received);
            return None;
        }
        Some(received)
    }
}

/// Renders with helpers, each with so many threads and of some health. Returns the render, its summary, and what became of the helpers.
fn with_helpers(
    scene: &Scene,
    render: Render,
    helpers: &[(RenderSettings, Health)],
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> (Render, Summary, Vec<etendue::Result<()>>) {
    with_watched_helpers(scene, render, helpers, &mut |fraction, _| progress(fraction))
}

/// The same; `progress` is told too how many helpers have ended.
fn with_watched_helpers(
    scene: &Scene,
    mut render: Render,
    helpers: &[(RenderSettings, Health)],
    progress: &mut dyn FnMut(f64, usize) -> ControlFlow<()>,
) -> (Render, Summary, Vec<etendue::Result<()>>) {
    let (to_leader, from) = channel();
    let ended = &AtomicUsize::new(0);
    std::thread::scope(|threads| {
        let mut to = Vec::new();
        let mut running = Vec::new();
        for (own, (settings, health)) in helpers.iter().enumerate() {
            let (sender, receiver) = channel();
            to.push(sender);
            let end = (vec![to_leader.clone()], receiver);
            running.push(threads.spawn(move || {
                let (to, from) = end;
                let mut link = Channels::new(to, from, own, *health);
                let outcome = help(scene, settings.clone(), &mut link);
                ended.fetch_add(1, Ordering::Release);
                outcome
            }));
        }
        let mut link = Channels::new(to, from, 0, Health::Well);
        let mut crew = Crew::new(&mut link);
        let summary =
            render.run_with(&mut crew, &mut |report| progress(report.fraction, ended.load(Ordering::Acquire))).unwrap();
        drop(crew);
        let outcomes = running.into_iter().map(|helper| helper.join().unwrap()).collect();
        (render, summary, outcomes)
    })
}

fn go_on(_: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn alone(scene: &Scene, settings: &RenderSettings) -> (Vec<u32>, Summary) {
    let mut render = Render::new(scene, settings.clone()).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    (bits(&render.image()), summary)
}

/// Checks that a render has the same bits with two helpers, and that these did a part of it. Returns the integrator that took the samples.
fn check(scene: &Scene, settings: &RenderSettings) -> IntegratorDesc {
    let (expected, before) = alone(scene, settings);
    let helpers = [1, 2].map(|threads| (RenderSettings { threads, ..settings.clone() }, Health::Well));
    let render = Render::new(scene, settings.clone()).unwrap();
    let (render, summary, outcomes) = with_helpers(scene, render, &helpers, &mut go_on);
    let what = settings.desc.integrator;
    assert!(outcomes.iter().all(Result::is_ok), "{what:?}: {outcomes:?}");
    assert!(bits(&render.image()) == expected, "{what:?} has other bits");
    assert_eq!(summary.rel_mse, before.rel_mse, "{what:?}");
    assert_eq!(
        (summary.samples, summary.ended, summary.integrator, summary.reuse, summary.light_paths),
        (before.samples, before.ended, before.integrator, before.reuse, before.light_paths)
    );
    // What a radiosity solution took is all that differs.
    let is_timed = |note: &String| note.starts_with("radiosity");
    let [after, before] =
        [&summary, &before].map(|it| it.notes.iter().filter(|note| !is_timed(note)).collect::<Vec<_>>());
    assert_eq!(after, before);
    summary.integrator
}

#[test]
fn every_integrator_has_the_same_bits_with_helpers() {
    let (glass, painted) = (built(GLASS), built(PAINT));
    for integrator in IntegratorDesc::ALL {
        let is_simple = integrator == IntegratorDesc::Radiosity;
        let mut settings = settings(integrator);
        settings.desc.samples = 8;
        check(if is_simple { &painted } else { &glass }, &settings);
    }
}

#[test]
fn adaptive_renders_and_shared_hits_have_the_same_bits_with_helpers() {
    let (glass, painted) = (built(GLASS), built(PAINT));
    let path = settings(IntegratorDesc::Path);
    let adaptive =
        RenderSettings { adaptive: Some(true), desc: RenderDesc { samples: 40, ..path.desc.clone() }, ..path.clone() };
    check(&glass, &adaptive);
    let aimed = RenderSettings {
        target_error: Some(0.01),
        error_measure: ErrorMeasure::RelMse,
        desc: RenderDesc { samples: 4096, ..path.desc.clone() },
        ..path.clone()
    };
    check(&painted, &aimed);
    check(&painted, &RenderSettings { desc: RenderDesc { reuse: Some(true), ..path.desc.clone() }, ..path.clone() });
    let lit = RenderDesc { light_paths: Some(true), filter: FilterDesc::Tent, ..path.desc.clone() };
    check(&glass, &RenderSettings { desc: lit, ..path.clone() });
    let first = RenderDesc { first_shadow_rays: Some(3), reuse: Some(true), ..path.desc.clone() };
    check(&glass, &RenderSettings { desc: first, ..path.clone() });
    check(&glass, &RenderSettings { light_parts: true, ..path.clone() });
    check(&glass, &RenderSettings { desc: RenderDesc { spectral: true, ..path.desc.clone() }, ..path });
}

/// What a pilot says of the irradiance cache is told to helpers, which fill one of their own.
#[test]
fn a_cache_that_a_pilot_chose_has_the_same_bits_with_helpers() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.json");
    let scene = Scene::build(&desc::load(&file, None).unwrap(), &BuildOptions::default()).unwrap();
    let desc = RenderDesc {
        integrator: IntegratorDesc::Auto,
        allow_bias: true,
        resolution: [256, 256],
        samples: 64,
        ..RenderDesc::default()
    };
    let settings = RenderSettings { desc, threads: 1, ..RenderSettings::default() };
    assert_eq!(check(&scene, &settings), IntegratorDesc::IrradianceCache);
}

#[test]
fn what_lost_and_slow_helpers_had_is_rendered_by_others() {
    let scene = built(GLASS);
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Sppm] {
        let base = settings(integrator);
        let settings = RenderSettings { desc: RenderDesc { samples: 4, ..base.desc.clone() }, ..base };
        let (expected, before) = alone(&scene, &settings);
        // One dies before its first word, one with tiles, and one brings nothing.
        let health = [Health::Dies(0), Health::Dies(2), Health::Dies(4), Health::Slow, Health::Well];
        let helpers = health.map(|health| (settings.clone(), health));
        let render = Render::new(&scene, settings.clone()).unwrap();
        let (render, summary, outcomes) = with_helpers(&scene, render, &helpers, &mut go_on);
        assert!(bits(&render.image()) == expected, "{integrator:?}");
        assert_eq!((summary.rel_mse, summary.samples), (before.rel_mse, before.samples));
        let kinds: Vec<_> =
            outcomes.iter().map(|outcome| outcome.as_ref().map_err(etendue::Error::kind).err()).collect();
        let io = Some(ErrorKind::Io);
        assert_eq!(kinds, [io, io, io, None, None], "{outcomes:?}");
        let lost = |number: usize| {
            let note = format!("helper {number} was lost, and others did its work: its machine is on fire");
            summary.notes.contains(&note)
        };
        assert!([1, 2, 3].into_iter().all(lost) && !lost(4), "{:?}", summary.notes);
    }
}

/// What is learnt from photons is learnt pass by pass, also by a helper that others were faster than in the first passes.
#[test]
fn a_helper_that_has_missed_passes_comes_to_the_same_bits() {
    let scene = built(GLASS);
    let base = settings(IntegratorDesc::Sppm);
    let settings = RenderSettings { desc: RenderDesc { samples: 64, ..base.desc.clone() }, ..base };
    let (expected, _) = alone(&scene, &settings);
    // The first photons are those of four samples, which take two passes.
    let helpers = [Health::Sleepy(4), Health::Well].map(|health| (settings.clone(), health));
    let render = Render::new(&scene, settings.clone()).unwrap();
    let (render, summary, outcomes) = with_helpers(&scene, render, &helpers, &mut go_on);
    assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
    assert!(bits(&render.image()) == expected, "{:?}", summary.notes);
}

#[test]
fn without_helpers_the_leader_does_all() {
    let scene = built(PAINT);
    let settings = settings(IntegratorDesc::Path);
    let (expected, _) = alone(&scene, &settings);
    let other = RenderSettings { desc: RenderDesc { seed: 1, ..settings.desc.clone() }, ..settings.clone() };
    let render = Render::new(&scene, settings.clone()).unwrap();
    let (render, summary, outcomes) = with_helpers(&scene, render, &[(other, Health::Well)], &mut go_on);
    assert!(bits(&render.image()) == expected);
    let error = outcomes[0].as_ref().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    assert!(error.to_string().contains("`seed` null, and this render has 1"), "{error}");
    assert!(
        summary.notes.iter().any(|note| note.contains("helper 1") && note.contains("`seed`")),
        "{:?}",
        summary.notes
    );
    let render = Render::new(&scene, settings).unwrap();
    let (render, ..) = with_helpers(&scene, render, &[], &mut go_on);
    assert!(bits(&render.image()) == expected);
}

#[test]
fn a_render_that_was_stopped_goes_on_with_other_helpers() {
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Sppm] {
        let scene = built(GLASS);
        let base = settings(integrator);
        let settings = RenderSettings { desc: RenderDesc { samples: 64, ..base.desc.clone() }, ..base };
        let (expected, _) = alone(&scene, &settings);
        let mut calls = 3;
        let helpers = [(settings.clone(), Health::Well), (settings.clone(), Health::Slow)];
        let render = Render::new(&scene, settings.clone()).unwrap();
        let (render, summary, _) = with_helpers(&scene, render, &helpers, &mut |_| {
            calls -= 1;
            if calls <= 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(summary.stopped && summary.notes.iter().all(|note| !note.contains("helper")), "{:?}", summary.notes);
        let mut bytes = Vec::new();
        render.checkpoint().unwrap().write_to(&mut bytes).unwrap();
        let state = Checkpoint::read_from(&bytes[..]).unwrap();
        let render = Render::resume(&scene, settings.clone(), state).unwrap();
        let (render, ..) = with_helpers(&scene, render, &helpers[..1], &mut go_on);
        assert!(bits(&render.image()) == expected, "{integrator:?}");
    }
}

/// Helpers make a radiosity solution as it is that time has ended, in the render that it ends and in one that goes on with it.
#[test]
fn helpers_have_the_solution_that_time_has_ended() {
    let scene = built(PAINT);
    let whole = settings(IntegratorDesc::Radiosity);
    let ended = RenderSettings { time_limit: Some(Duration::ZERO), ..whole.clone() };
    let helpers = [(whole.clone(), Health::Well), (whole.clone(), Health::Well)];
    let is_early = |notes: &[String]| notes.iter().any(|note| note.contains("the time limit ended the solution early"));
    let (expected, summary) = alone(&scene, &ended);
    assert!(is_early(&summary.notes), "{:?}", summary.notes);
    let render = Render::new(&scene, ended).unwrap();
    let (begun, summary, outcomes) = with_helpers(&scene, render, &helpers, &mut go_on);
    assert!(is_early(&summary.notes) && outcomes.iter().all(Result::is_ok), "{outcomes:?}");
    assert_eq!(bits(&begun.image()), expected);

    let resumed = || Render::resume(&scene, whole.clone(), begun.checkpoint().unwrap()).unwrap();
    let mut by_itself = resumed();
    by_itself.run(&mut |_| ControlFlow::Continue(())).unwrap();
    let (helped, summary, outcomes) = with_helpers(&scene, resumed(), &helpers, &mut go_on);
    assert!(is_early(&summary.notes) && outcomes.iter().all(Result::is_ok), "{outcomes:?}");
    assert_eq!(bits(&helped.image()), bits(&by_itself.image()));
}

#[test]
fn time_and_cancelling_end_a_render_with_helpers() {
    let scene = built(GLASS);
    let base = settings(IntegratorDesc::Path);
    let endless = RenderDesc { samples: 1 << 20, ..base.desc.clone() };
    let settings = RenderSettings { desc: endless, ..base };
    let timed = RenderSettings { time_limit: Some(Duration::from_millis(700)), ..settings.clone() };
    let helpers = [(settings.clone(), Health::Well), (settings.clone(), Health::Slow)];
    let render = Render::new(&scene, timed).unwrap();
    let (_, summary, outcomes) = with_helpers(&scene, render, &helpers, &mut go_on);
    assert_eq!(summary.ended, Ended::Time);
    assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
    let cancel = Cancel::new();
    let render = Render::new(&scene, RenderSettings { cancel: cancel.clone(), ..settings.clone() }).unwrap();
    // A helper that is cancelled by itself is missed, and no more.
    let own = Cancel::new();
    let cancelled = RenderSettings { cancel: own.clone(), ..settings };
    let helpers = [helpers[0].clone(), (cancelled, Health::Well)];
    let mut reports_since = 0;
    let (_, summary, outcomes) = with_watched_helpers(&scene, render, &helpers, &mut |fraction, ended| {
        own.cancel();
        // What the helper said at its end is heard before the next report.
        reports_since += usize::from(ended > 0);
        if fraction > 2e-5 && reports_since > 1 {
            cancel.cancel();
        }
        ControlFlow::Continue(())
    });
    assert_eq!(summary.ended, Ended::Cancelled);
    assert!(outcomes[0].is_ok(), "{outcomes:?}");
    assert_eq!(outcomes[1].as_ref().unwrap_err().kind(), ErrorKind::Cancelled);
    assert!(summary.notes.iter().any(|note| note.contains("helper 2 was lost")), "{:?}", summary.notes);
}
