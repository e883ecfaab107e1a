//! A render that goes on from a checkpoint, or is put together from parts, comes to the film of one that was never interrupted, to the
//! last bit. A file that was changed is refused.

mod common;

use std::ops::ControlFlow;
use std::time::Duration;

use common::scenes::{box_inside, brief, camera, point_light, scene};
use etendue::desc::{
    BsdfDesc, FilterDesc, IntegratorDesc, RadiosityDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc,
};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::render::{Checkpoint, CheckpointPlan, Render, RenderSettings, Share};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Error, ErrorKind};

/// A room with a lamp and a ball of glass, or of what all methods can do.
fn room(ball: BsdfDesc) -> SceneDesc {
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::NEG_Z, 90.0),
        vec![
            (
                ShapeDesc::Mesh { mesh: 0, smooth: false },
                BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) },
                Some(Rgb::splat(0.1)),
            ),
            (ShapeDesc::Sphere { centre: DVec3::new(0.25, -0.125, -0.5), radius: 0.3 }, ball, None),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc.lights.push(point_light(DVec3::new(0.0, 0.875, -0.5), 0.5));
    desc
}

const GLASS: BsdfDesc = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
const PAINT: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::new(0.2, 0.4, 0.8) };

fn built(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).unwrap()
}

fn settings(integrator: IntegratorDesc) -> RenderSettings {
    let radiosity = RadiosityDesc { error: 4.0, ..RadiosityDesc::default() };
    // Tiles that are cut at both sides.
    let desc = RenderDesc { resolution: [21, 19], radiosity, ..brief(integrator) };
    RenderSettings { desc, auxiliary: true, ..RenderSettings::default() }
}

/// All values of an image, so that NaN equals itself.
fn bits(image: &Image) -> Vec<u32> {
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}

fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let mut bytes = Vec::new();
    checkpoint.write_to(&mut bytes).unwrap();
    bytes
}

/// The beginning of a file with this header, which fits its checksum.
fn with_header(header: &str) -> Vec<u8> {
    let mut file = b"\x89ETD\r\n\x1a\n\x01\0\0\0".to_vec();
    file.extend((header.len() as u32).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(crc32fast::hash(&file).to_le_bytes());
    file
}

/// The checkpoint as another process would read it.
fn moved(checkpoint: &Checkpoint) -> Checkpoint {
    Checkpoint::read_from(&bytes(checkpoint)[..]).unwrap()
}

fn finish(mut render: Render) -> Render {
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert!(!summary.stopped, "{:?}", summary.notes);
    render
}

/// Renders in pieces: each time the progress function is called `calls` times, and the rest is left to another render with another
/// number of threads.
fn in_pieces(scene: &Scene, settings: &RenderSettings, calls: usize) -> Render {
    let mut render = Render::new(scene, settings.clone()).unwrap();
    let mut pieces = 0;
    for threads in [1, 2, 3] {
        let mut left = calls;
        let summary = render
            .run(&mut |_| {
                left = left.saturating_sub(1);
                if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .unwrap();
        if !summary.stopped {
            break;
        }
        pieces += 1;
        let checkpoint = moved(&render.checkpoint().unwrap());
        render = Render::resume(scene, RenderSettings { threads, ..settings.clone() }, checkpoint).unwrap();
    }
    assert!(pieces > 0 || calls > 10, "the render ended before it could be interrupted");
    finish(render)
}

/// A radiosity solution that time has ended is made once more as it was, by whoever goes on, and by another number of threads.
#[test]
fn solutions_that_time_has_ended_go_on_as_they_are() {
    let scene = built(&room(PAINT));
    let whole = settings(IntegratorDesc::Radiosity);
    let ended = RenderSettings { time_limit: Some(Duration::ZERO), ..whole.clone() };
    let run = |render: &mut Render| render.run(&mut |_| ControlFlow::Continue(())).unwrap().notes;
    let is_early = |notes: &[String]| notes.iter().any(|note| note.contains("the time limit ended the solution early"));

    let mut begun = Render::new(&scene, ended.clone()).unwrap();
    assert!(is_early(&run(&mut begun)));
    let checkpoint = begun.checkpoint().unwrap();
    let goes_on = |threads: usize, samples: u32| {
        let mut settings = RenderSettings { threads, ..whole.clone() };
        settings.desc.samples = samples;
        let mut render = Render::resume(&scene, settings, moved(&checkpoint)).unwrap();
        assert!(is_early(&run(&mut render)));
        render
    };
    let [one, two] = [1, 2].map(|threads| goes_on(threads, 16));
    assert_eq!(bits(&one.image()), bits(&two.image()));
    let again = moved(&goes_on(1, 8).checkpoint().unwrap());
    let mut render = Render::resume(&scene, whole.clone(), again).unwrap();
    assert!(is_early(&run(&mut render)));
    assert_eq!(bits(&one.image()), bits(&render.image()));

    let mut other = Render::new(&scene, whole.clone()).unwrap();
    assert!(!is_early(&run(&mut other)));
    assert_ne!(bits(&one.image()), bits(&other.image()));
    // Another time limit does not end it elsewhere.
    let time_limit = Some(Duration::from_secs(60));
    let more = RenderSettings { time_limit, ..whole.clone() };
    let mut render = Render::resume(&scene, more, moved(&checkpoint)).unwrap();
    run(&mut render);
    assert_eq!(bits(&one.image()), bits(&render.image()));
    // What is early is near to the whole.
    let mean = |render: &Render| render.image().rgb.iter().map(|&x| f64::from(x)).sum::<f64>();
    let ratio = mean(&one) / mean(&other);
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");

    // Shares of a picture have one solution, which is the whole.
    let share = RenderSettings { share: Some(Share::new(1, 2).unwrap()), ..ended };
    assert!(!is_early(&run(&mut Render::new(&scene, share).unwrap())));
}

#[test]
fn interrupted_renders_come_to_the_same_film() {
    for integrator in IntegratorDesc::ALL {
        let can_glass = !matches!(integrator, IntegratorDesc::Radiosity);
        let scene = built(&room(if can_glass { GLASS } else { PAINT }));
        let settings = settings(integrator);
        let whole = finish(Render::new(&scene, settings.clone()).unwrap());
        // Maps that are made for each pass are interrupted before the first sample, in later passes and between them.
        let is_progressive = matches!(integrator, IntegratorDesc::Ppm | IntegratorDesc::Sppm);
        for calls in if is_progressive { [3, 40, 150].as_slice() } else { &[1, 2] } {
            let calls = *calls;
            let pieces = in_pieces(&scene, &settings, calls);
            let [whole, pieces] = [&whole, &pieces].map(Render::image);
            assert!(bits(&whole) == bits(&pieces), "{} after {calls} calls", integrator.name());
        }
    }
}

#[test]
fn what_differs_from_pixel_to_pixel_is_kept() {
    let scene = built(&room(GLASS));
    let path = settings(IntegratorDesc::Path);
    let of = |change: fn(&mut RenderSettings)| {
        let mut settings = path.clone();
        change(&mut settings);
        settings
    };
    let cases = [
        ("adaptive", of(|it| (it.adaptive, it.desc.samples) = (Some(true), 100))),
        ("a target error", of(|it| (it.target_error, it.desc.samples) = (Some(0.02), 1 << 12))),
        ("shared hits", of(|it| it.desc.reuse = Some(true))),
        ("light paths", of(|it| (it.desc.light_paths, it.desc.filter) = (Some(true), FilterDesc::Tent))),
        ("more light samples first", of(|it| it.desc.first_shadow_rays = Some(3))),
        ("wavelengths", of(|it| it.desc.spectral = true)),
        ("parts of the light", of(|it| it.light_parts = true)),
        ("a pattern", of(|it| it.desc.sampler = SamplerDesc::Jittered)),
    ];
    for (name, settings) in cases {
        let whole = finish(Render::new(&scene, settings.clone()).unwrap());
        let pieces = in_pieces(&scene, &settings, 2);
        assert!(bits(&whole.image()) == bits(&pieces.image()), "{name}");
    }
}

#[test]
fn what_the_settings_leave_open_is_that_of_the_checkpoint() {
    let scene = built(&room(GLASS));
    let mut asked = settings(IntegratorDesc::Path);
    (asked.desc.reuse, asked.desc.light_paths, asked.desc.filter) = (Some(true), Some(true), FilterDesc::Box);
    asked.desc.first_shadow_rays = Some(3);
    let whole = finish(Render::new(&scene, asked.clone()).unwrap());
    let mut begun = Render::new(&scene, asked.clone()).unwrap();
    begun.run(&mut |_| ControlFlow::Break(())).unwrap();
    (asked.desc.reuse, asked.desc.light_paths, asked.desc.first_shadow_rays) = (None, None, None);
    let open = RenderSettings { auxiliary: false, ..asked };
    let more = finish(Render::resume(&scene, open.clone(), begun.checkpoint().unwrap()).unwrap());
    assert!(bits(&whole.image()) == bits(&more.image()));
    let mut other = open.clone();
    other.desc.first_shadow_rays = Some(2);
    let error = Render::resume(&scene, other, begun.checkpoint().unwrap()).err().expect("it is another render");
    assert!(error.message().contains("with `firstShadowRays` 3, and this render has 2"), "{error}");
    let mut without = open;
    without.desc.light_paths = Some(false);
    let error = Render::resume(&scene, without, begun.checkpoint().unwrap()).err().expect("it is another render");
    assert!(error.message().contains("with light paths, and this render is without them"), "{error}");
}

#[test]
fn parts_of_the_light_go_on_without_being_asked_for_and_cannot_be_added() {
    let scene = built(&room(GLASS));
    let asked = RenderSettings { light_parts: true, ..settings(IntegratorDesc::Auto) };
    let whole = finish(Render::new(&scene, asked.clone()).unwrap());
    let part_way = |settings: &RenderSettings| {
        let mut begun = Render::new(&scene, settings.clone()).unwrap();
        begun.run(&mut |_| ControlFlow::Break(())).unwrap();
        moved(&begun.checkpoint().unwrap())
    };
    let open = RenderSettings { light_parts: false, ..asked.clone() };
    let more = finish(Render::resume(&scene, open, part_way(&asked)).unwrap());
    assert!(bits(&whole.image()) == bits(&more.image()));
    let without = settings(IntegratorDesc::Path);
    let adding = RenderSettings { light_parts: true, ..without.clone() };
    let error = Render::resume(&scene, adding, part_way(&without)).err().expect("earlier samples have no parts");
    assert!(error.message().contains("other layers"), "{error}");

    // No render shares hits and keeps parts of the light apart.
    let begun = bytes(&part_way(&asked));
    let length = u32::from_le_bytes(begun[12..16].try_into().unwrap()) as usize;
    let header = std::str::from_utf8(&begun[16..16 + length]).unwrap();
    for (from, to) in [("\"reuse\":false", "\"reuse\":true"), ("\"lightPaths\":0", "\"lightPaths\":9")] {
        let header = header.replace(from, to);
        assert!(header.contains(to), "{header}");
        let mut forged = with_header(&header);
        forged.extend(&begun[16 + length + 4..]);
        let message = Checkpoint::read_from(&forged[..]).unwrap_err().to_string();
        assert!(message.contains("its header is of no render"), "{message}");
    }
}

/// Nothing to aim at, or no lamp: a render without them all the same.
#[test]
fn light_paths_that_a_scene_cannot_have_are_none_after_a_checkpoint() {
    let scene = built(&room(PAINT));
    let mut asked = settings(IntegratorDesc::Path);
    (asked.desc.light_paths, asked.desc.filter) = (Some(true), FilterDesc::Box);
    let whole = finish(Render::new(&scene, asked.clone()).unwrap());
    let pieces = in_pieces(&scene, &asked, 2);
    assert!(bits(&whole.image()) == bits(&pieces.image()));
}

#[test]
fn more_samples_may_be_added_to_a_render_that_is_done() {
    let scene = built(&room(GLASS));
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Sppm] {
        let mut settings = settings(integrator);
        let done = finish(Render::new(&scene, settings.clone()).unwrap());
        let before = bits(&done.image());
        settings.desc.samples = 24;
        let checkpoint = done.checkpoint().unwrap();
        let more = finish(Render::resume(&scene, settings.clone(), checkpoint).unwrap());
        let whole = finish(Render::new(&scene, settings).unwrap());
        assert!(bits(&more.image()) == bits(&whole.image()), "{}", integrator.name());
        assert!(bits(&done.image()) == before, "the first render keeps its film");
    }
}

#[test]
fn parts_make_the_whole_in_any_order() {
    let scene = built(&room(GLASS));
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Sppm, IntegratorDesc::Photon] {
        let settings = settings(integrator);
        let whole = finish(Render::new(&scene, settings.clone()).unwrap());
        let part = |number: u32| {
            let share = Some(Share::new(number, 4).unwrap());
            let render = Render::new(&scene, RenderSettings { share, ..settings.clone() }).unwrap();
            moved(&finish(render).checkpoint().unwrap())
        };
        let merged = Checkpoint::merge([3, 1, 4, 2].map(part).into()).unwrap();
        assert!(bits(&merged.film().develop()) == bits(&whole.image()), "{}", integrator.name());
        assert_eq!(merged.film().rel_mse(), whole.film().rel_mse());
        // The whole may go on.
        let mut settings = settings.clone();
        settings.desc.samples = 32;
        let more = finish(Render::resume(&scene, settings.clone(), merged).unwrap());
        let other = finish(Render::new(&scene, settings).unwrap());
        assert!(bits(&more.image()) == bits(&other.image()), "{}", integrator.name());
    }
}

#[test]
fn a_part_that_was_interrupted_is_made_up_for_after_the_merge() {
    let scene = built(&room(GLASS));
    let settings = settings(IntegratorDesc::Path);
    let render = |number: u32| {
        let share = Some(Share::new(number, 2).unwrap());
        Render::new(&scene, RenderSettings { share, ..settings.clone() }).unwrap()
    };
    let mut second = render(2);
    second.run(&mut |_| ControlFlow::Break(())).unwrap();
    let parts = vec![finish(render(1)).checkpoint().unwrap(), second.checkpoint().unwrap()];
    let merged = Checkpoint::merge(parts).unwrap();
    assert!(merged.samples() < 16);
    let made_up = finish(Render::resume(&scene, settings.clone(), merged).unwrap());
    let whole = finish(Render::new(&scene, settings).unwrap());
    assert!(bits(&made_up.image()) == bits(&whole.image()));
}

#[test]
fn parts_that_make_no_whole_are_named() {
    let scene = built(&room(PAINT));
    let settings = settings(IntegratorDesc::Path);
    let part = |number: u32, count: u32, seed: u64| {
        let mut settings = RenderSettings { share: Some(Share::new(number, count).unwrap()), ..settings.clone() };
        (settings.desc.seed, settings.desc.samples) = (seed, 1);
        finish(Render::new(&scene, settings).unwrap()).checkpoint().unwrap()
    };
    let message = |parts: Vec<Checkpoint>| Checkpoint::merge(parts).unwrap_err().to_string();
    assert!(message(vec![part(1, 3, 0), part(2, 3, 0)]).ends_with("of 3 shares, these are missing: 3"));
    assert!(message(vec![part(1, 3, 0), part(1, 3, 0)]).contains("share 1 is given twice"));
    assert!(message(vec![part(1, 3, 0), part(2, 4, 0)]).contains("share 2 is one of 4; expected shares of 3"));
    assert!(message(vec![part(1, 2, 0), part(2, 2, 5)]).contains("made with `seed` 5"));
    assert!(message(vec![]).contains("of 1 shares, these are missing: 1"));
    let whole = finish(Render::new(&scene, settings).unwrap()).checkpoint().unwrap();
    assert!(message(vec![whole]).contains("all of the picture"));
}

/// The error of going on with `settings` from a checkpoint of a render with `first`.
fn refused(scene: &Scene, first: &RenderSettings, settings: RenderSettings) -> Error {
    let mut render = Render::new(scene, first.clone()).unwrap();
    render.run(&mut |_| ControlFlow::Break(())).unwrap();
    Render::resume(scene, settings, moved(&render.checkpoint().unwrap())).map(|_| ()).unwrap_err()
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let desc = room(GLASS);
    let scene = built(&desc);
    let first = RenderSettings { fingerprint: Some(desc.fingerprint().unwrap()), ..settings(IntegratorDesc::Path) };
    let of = |change: &dyn Fn(&mut RenderSettings)| {
        let mut settings = first.clone();
        change(&mut settings);
        let error = refused(&scene, &first, settings);
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        error.to_string()
    };
    let mut other = desc.clone();
    other.lights[0].position.x = 0.01;
    let moved_light = other.fingerprint().unwrap();
    for (change, expected) in [
        (
            &(|it: &mut RenderSettings| it.desc.seed = 3) as &dyn Fn(&mut RenderSettings),
            "`seed` null, and this render has 3",
        ),
        (&|it| it.desc.resolution = [40, 35], "`resolution` [21,19], and this render has [40,35]"),
        (&|it| it.desc.integrator = IntegratorDesc::Whitted, "`integrator` \"path\", and this render has \"whitted\""),
        (&|it| it.desc.max_depth = Some(7), "`maxDepth` null, and this render has 7"),
        (&|it| it.desc.reuse = Some(true), "keeping to themselves, and this render has pixels sharing hits"),
        (&|it| it.adaptive = Some(true), "adaptive sampling none, and this render has RelMse"),
        (&|it| it.share = Some(Share::new(1, 2).unwrap()), "all of the picture, and this render is of share 1/2"),
        (&|it| it.fingerprint = Some(moved_light), "of another scene"),
    ] {
        let message = of(change);
        assert!(message.contains(expected), "{message}");
    }
    // A pattern is planned for its number of samples.
    let mut grid = first.clone();
    grid.desc.sampler = SamplerDesc::Grid;
    let mut more = grid.clone();
    more.desc.samples = 100;
    let message = refused(&scene, &grid, more).to_string();
    assert!(message.contains("`samples` 16, and this render has 100"), "{message}");
}

#[test]
fn parts_of_what_looks_at_the_whole_picture_are_refused() {
    let scene = built(&room(PAINT));
    let share = Some(Share::new(1, 2).unwrap());
    let first = RenderSettings { share, ..settings(IntegratorDesc::Path) };
    for (settings, expected) in [
        (RenderSettings { adaptive: Some(true), ..first.clone() }, "adaptive sampling"),
        (RenderSettings { target_error: Some(0.01), adaptive: Some(false), ..first.clone() }, "a target error"),
    ] {
        let error = Render::new(&scene, settings).map(|_| ()).unwrap_err();
        assert!(error.kind() == ErrorKind::Unsupported && error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn the_fingerprint_is_that_of_the_contents() {
    let desc = room(GLASS);
    let own = desc.fingerprint().unwrap();
    let mut other = desc.clone();
    other.render.samples = 5;
    assert_eq!(other.fingerprint().unwrap(), own, "render settings do not count");
    let mut mesh = (*desc.meshes[0]).clone();
    mesh.positions[3].x = 1.0000001;
    other.meshes[0] = mesh.into();
    assert_ne!(other.fingerprint().unwrap(), own);
    let mut other = desc.clone();
    other.materials[1].bsdf = BsdfDesc::Dielectric { ior: 1.5000001, exterior_ior: 1.0 };
    assert_ne!(other.fingerprint().unwrap(), own);
    // Written and read.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.json");
    desc.save(&path).unwrap();
    assert_eq!(etendue::desc::load(&path, None).unwrap().fingerprint().unwrap(), own);
}

#[test]
fn any_changed_byte_is_noticed() {
    let scene = built(&room(PAINT));
    let mut settings = settings(IntegratorDesc::Sppm);
    (settings.desc.resolution, settings.desc.samples) = ([20, 3], 2);
    let render = finish(Render::new(&scene, settings).unwrap());
    let bytes = bytes(&render.checkpoint().unwrap());
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 1 << (place % 8);
        assert!(Checkpoint::read_from(&changed[..]).is_err(), "byte {place}");
    }
    for end in 0..bytes.len() {
        assert!(Checkpoint::read_from(&bytes[..end]).is_err(), "the first {end} bytes");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(Checkpoint::read_from(&longer[..]).unwrap_err().to_string().contains("something follows its end"));
    let error = Checkpoint::read_from(&b"P6\n3 3\n255\n"[..]).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("no checkpoint of a render"), "{error}");
}

/// Places in a checkpoint after which a checksum lies.
fn ends_of_blocks(bytes: &[u8], pixels: &[usize], bytes_of_a_pixel: usize) -> Vec<usize> {
    let number = |place: usize| u32::from_le_bytes(bytes[place..place + 4].try_into().unwrap());
    let mut ends = vec![16 + number(12) as usize];
    let mut after = |length: usize| ends.push(ends[ends.len() - 1] + 4 + length);
    pixels.iter().for_each(|pixels| after(4 + pixels * bytes_of_a_pixel));
    while ends[ends.len() - 1] + 20 < bytes.len() {
        let block = ends[ends.len() - 1] + 4;
        let length = 8 + 9 * number(block + 4) as usize;
        ends.push(block + length);
    }
    ends.push(bytes.len() - 4);
    ends
}

/// Whoever changes a checkpoint on purpose can make its checksums right as well. It is refused, or has some other film.
#[test]
fn what_was_forged_is_refused_or_harmless() {
    let scene = built(&room(PAINT));
    let mut settings = settings(IntegratorDesc::Sppm);
    (settings.desc.resolution, settings.desc.samples) = ([20, 3], 2);
    let original = finish(Render::new(&scene, settings.clone()).unwrap());
    let original = bytes(&original.checkpoint().unwrap());
    let ends = ends_of_blocks(&original, &[48, 12], 208 + 60 + 96);
    let mut random = 1_u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 33) as usize % below
    };
    let (mut read, mut refused) = (0, 0);
    for _ in 0..3000 {
        let mut forged = original.clone();
        // Half of the changes are in the header.
        let block = if next(2) == 0 { 0 } else { next(ends.len()) };
        let begin = if block == 0 { 0 } else { ends[block - 1] + 4 };
        for _ in 0..1 + next(3) {
            let place = begin + next(ends[block] - begin);
            forged[place] = match next(4) {
                0 => 0,
                1 => 0xff,
                2 => b"0123456789-.eE\"{}[],:"[next(21)],
                _ => next(256) as u8,
            };
        }
        let sum = crc32fast::hash(&forged[begin..ends[block]]);
        forged[ends[block]..ends[block] + 4].copy_from_slice(&sum.to_le_bytes());
        match Checkpoint::read_from(&forged[..]) {
            Err(error) => {
                assert!(error.kind() != ErrorKind::Internal, "{error}");
                refused += 1;
            }
            Ok(checkpoint) => {
                read += 1;
                checkpoint.film().develop();
                checkpoint.film().rel_mse();
                if let Ok(mut render) = Render::resume(&scene, settings.clone(), checkpoint) {
                    render.run(&mut |_| ControlFlow::Break(())).unwrap();
                }
            }
        }
    }
    assert!(read > 300 && refused > 300, "{read} read, {refused} refused");
}

/// A file may have words of any length, which are not repeated whole.
#[test]
fn messages_are_short() {
    let header = format!("{{\"{}\": 1}}", "n".repeat(100_000));
    let message = Checkpoint::read_from(&with_header(&header)[..]).unwrap_err().to_string();
    assert!(message.contains("unknown field `nnn") && message.len() < 1000, "{message}");
}

#[test]
fn checkpoints_are_written_while_the_render_goes_on() {
    let desc = room(GLASS);
    let scene = built(&desc);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.checkpoint");
    let plan = CheckpointPlan { path: path.clone(), every: Duration::ZERO };
    let mut settings = RenderSettings { checkpoint: Some(plan), threads: 2, ..settings(IntegratorDesc::Path) };
    settings.desc.samples = 64;
    let whole = finish(Render::new(&scene, RenderSettings { checkpoint: None, ..settings.clone() }).unwrap());
    // Whatever is found in the file at any time, a render goes on from it to the same film.
    let mut found = Vec::new();
    let mut render = Render::new(&scene, settings.clone()).unwrap();
    render
        .run(&mut |_| {
            found.extend(std::fs::read(&path).ok());
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(found.len() > 3, "{}", found.len());
    for bytes in &found {
        let checkpoint = Checkpoint::read_from(&bytes[..]).unwrap();
        let more = RenderSettings { checkpoint: None, ..settings.clone() };
        let resumed = finish(Render::resume(&scene, more, checkpoint).unwrap());
        assert!(bits(&resumed.image()) == bits(&whole.image()));
    }
    assert_eq!(Checkpoint::read(&path).unwrap().samples(), 64, "the last one is written at the end");
    // One that cannot be written ends no render.
    let plan = CheckpointPlan { path: folder.path().join("no such folder/file"), every: Duration::ZERO };
    let mut render = Render::new(&scene, RenderSettings { checkpoint: Some(plan), ..settings }).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert!(!summary.stopped && summary.samples == 64);
    assert!(summary.checkpoint_failure.is_some_and(|why| why.contains("no such folder")));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no other file is left");
}
