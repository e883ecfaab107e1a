//! Photons in files and in pictures: what is written can be read back by the formats' own rules, and a dot is where the
//! camera would see its photon.

use std::fs;
use std::path::Path;

use etendue::camera::Camera;
use etendue::desc::{self, CameraDesc, FilmDesc};
use etendue::film::Image;
use etendue::integrator::photon::{self, DrawSettings, MapKind, NARROW, Photon, PhotonJob};
use etendue::math::{DVec3, Vec3};
use etendue::output::{self, PhotonFormat};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Alone, ErrorKind};

/// Photons of every kind: in the middle, at the edge of the directions' packing, tiny, far, without power.
fn samples() -> Vec<Photon> {
    let direction = Vec3::new(0.6, -0.48, 0.64);
    vec![
        Photon::new(Vec3::new(1.25, -2.5, 3.75), Vec3::Y, direction, Rgb::new(0.5, 0.25, 0.125)),
        Photon::new(Vec3::new(1e-7, 0.0, -123_456.79), -Vec3::Z, Vec3::X, Rgb::new(1e-12, 3e7, 2e-30)),
        Photon::new(Vec3::new(0.1, 0.2, 0.3), Vec3::X, -direction, Rgb::ZERO),
    ]
}

/// A reader of PLY by its description (Turk 1994): properties of one element of scalars, little-endian.
fn read_ply(path: &Path) -> (Vec<(String, String)>, Vec<Vec<f64>>) {
    let bytes = fs::read(path).unwrap();
    let end = b"end_header\n";
    let at = bytes.windows(end.len()).position(|window| window == end).expect("an end of the header") + end.len();
    let header = std::str::from_utf8(&bytes[..at]).unwrap();
    assert!(header.is_ascii());
    let mut lines = header.lines();
    assert_eq!((lines.next(), lines.next()), (Some("ply"), Some("format binary_little_endian 1.0")));
    let (mut count, mut properties) = (None, Vec::new());
    for line in lines.filter(|line| !line.starts_with("comment ")) {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["element", "vertex", n] if count.is_none() => count = Some(n.parse::<usize>().unwrap()),
            ["property", kind, name] => properties.push((kind.to_owned(), name.to_owned())),
            ["end_header"] => {}
            _ => panic!("{line}"),
        }
    }
    let mut rest = &bytes[at..];
    let mut take = |size: usize| {
        let (value, behind) = rest.split_at(size);
        rest = behind;
        value.to_vec()
    };
    let mut rows = Vec::new();
    for _ in 0..count.expect("a count") {
        let value = |(kind, _): &(String, String)| match kind.as_str() {
            "uchar" => f64::from(take(1)[0]),
            "float" => f32::from_le_bytes(take(4).try_into().unwrap()).into(),
            "double" => f64::from_le_bytes(take(8).try_into().unwrap()),
            _ => panic!("{kind}"),
        };
        rows.push(properties.iter().map(value).collect());
    }
    assert!(rest.is_empty(), "{} bytes too many", rest.len());
    (properties, rows)
}

fn read_csv(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.ends_with('\n'));
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    (header, lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect())
}

#[test]
fn photons_are_read_back_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, ply) = (folder.path().join("a.csv"), folder.path().join("a.PLY"));
    for centre in [DVec3::ZERO, DVec3::new(1e9, -0.125, 1e-3), DVec3::splat(1_099_511_627_776.0)] {
        let photons = samples();
        output::write_photons(&photons, centre, &csv).unwrap();
        output::write_photons(&photons, centre, &ply).unwrap();
        let (header, rows) = read_csv(&csv);
        assert_eq!(header, "x,y,z,nx,ny,nz,wx,wy,wz,r,g,b,shadow");
        let (properties, vertices) = read_ply(&ply);
        let types: Vec<_> = properties.iter().map(|(kind, name)| format!("{kind} {name}")).collect();
        assert_eq!(
            types.join(", "),
            "double x, double y, double z, float nx, float ny, float nz, uchar red, uchar green, uchar blue, \
             float power_r, float power_g, float power_b, uchar shadow"
        );
        assert_eq!((rows.len(), vertices.len()), (photons.len(), photons.len()));
        for ((photon, row), vertex) in photons.iter().zip(&rows).zip(&vertices) {
            let near = |found: &[f64], wanted: Vec3, tolerance: f64| {
                (0..3).all(|axis| (found[axis] - f64::from(wanted[axis])).abs() <= tolerance)
            };
            for axis in 0..3 {
                let local = f64::from(photon.p[axis]);
                let world = local + centre[axis];
                assert_eq!(vertex[axis], world, "PLY keeps every bit");
                // Nine digits of the scene's own frame, or what double precision has left of them.
                let tolerance = 1e-8 * local.abs() + f64::EPSILON * world.abs();
                assert!((row[axis] - world).abs() <= tolerance, "{} for {world}", row[axis]);
            }
            assert!(near(&row[3..], photon.normal.get(), 1e-6) && near(&row[6..], photon.wi.get(), 1e-6), "{row:?}");
            assert!(near(&vertex[3..], photon.normal.get(), 0.0), "{vertex:?}");
            let power = photon.power.map(f64::from);
            assert_eq!(row[9..12].iter().map(|value| *value as f32).collect::<Vec<_>>(), photon.power);
            assert_eq!(vertex[9..12], power);
            let shadow = f64::from(u8::from(photon.is_shadow()));
            assert_eq!((row[12], vertex[12]), (shadow, shadow));
        }
        // Colour at full brightness through the sRGB curve: 1, 1/2 and 1/4 are 255, 188 and 137.
        assert_eq!(vertices[0][6..9], [255.0, 188.0, 137.0]);
        assert_eq!(vertices[2][6..9], [0.0; 3]);
    }
    output::write_photons(&[], DVec3::ZERO, &csv).unwrap();
    output::write_photons(&[], DVec3::ZERO, &ply).unwrap();
    assert!(read_csv(&csv).1.is_empty() && read_ply(&ply).1.is_empty());
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (name, kind, words) in [
        ("a.obj", ErrorKind::Unsupported, "use .csv or .ply"),
        ("photons", ErrorKind::Unsupported, "use .csv or .ply"),
        ("no/a.csv", ErrorKind::Io, "cannot write the photons"),
    ] {
        let path = folder.path().join(name);
        let written = output::write_photons(&samples(), DVec3::ZERO, &path).unwrap_err();
        let checked = output::check_photon_target(&path).unwrap_err();
        for error in [written, checked] {
            assert_eq!(error.kind(), kind, "{error}");
            assert!(error.to_string().contains(words) && error.to_string().contains(name), "{error}");
        }
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    assert_eq!(PhotonFormat::from_path(Path::new("a.Csv")), Some(PhotonFormat::Csv));
    assert_eq!(PhotonFormat::from_path(Path::new("a.csv.png")), None);
}

/// A floor at y = 0 with a lamp above it and, between the two, a small tile that casts a shadow; seen from the side.
fn stage(shift: f64) -> Scene {
    let quad = |half: f64, y: f64, up: bool, more: &str| {
        let corner = |x: f64, z: f64| format!("[{:?}, {y:?}, {:?}]", shift + x * half, z * half);
        let corners = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
        let order = if up { [0, 1, 2, 3] } else { [3, 2, 1, 0] };
        let vertices: Vec<_> = (0..4).map(|i| format!("\"vertex-{}\": {}", i + 1, corners[order[i]])).collect();
        format!("{{\"geometry\": \"quad\", {}, {more}}}", vertices.join(", "))
    };
    let white = "\"material\": \"white\"";
    let surfaces =
        [quad(4.0, 0.0, true, white), quad(1.0, 1.0, true, white), quad(0.5, 6.0, false, "\"emission\": [4, 2, 1]")]
            .join(", ");
    let text = format!(
        "{{\"etendue\": 1, \"camera\": {{\"origin\": [{:?}, 5, 9], \"lookAt\": [{shift:?}, 0.5, 0], \"fieldOfView\": 60}},
          \"materials\": [{{\"name\": \"white\", \"type\": \"diffuse\", \"color\": [0.5, 0.5, 0.5]}}],
          \"surfaces\": [{surfaces}]}}",
        shift + 3.0
    );
    let scene = desc::parse(&text, Path::new("."), None).unwrap_or_else(|error| panic!("{error}\n{text}"));
    Scene::build(&scene, &BuildOptions::default()).unwrap()
}

const SIZE: [u32; 2] = [96, 64];

fn pixel_of(scene: &Scene, world: DVec3) -> (u32, u32) {
    let camera = Camera::new(scene.camera(), SIZE, scene.centre()).unwrap();
    let [x, y] = camera.film_position(scene.to_scene(world)).unwrap();
    (x as u32, y as u32)
}

fn draw(scene: &Scene, photons: &[Photon], coloured: bool) -> Image {
    photon::draw(scene, scene.camera(), SIZE, photons, DrawSettings { coloured }).unwrap()
}

#[test]
fn dots_are_where_their_photons_are_seen() {
    for shift in [0.0, 1e7] {
        let scene = stage(shift);
        let at = |x: f64, y: f64, z: f64, normal: Vec3, power: Rgb| {
            let p = scene.to_scene(DVec3::new(shift + x, y, z));
            Photon::new(p, normal, normal, power)
        };
        let empty = draw(&scene, &[], false);
        assert!(empty.rgb.iter().all(|value| *value <= 0.2), "dim");
        let (lit, red) = (Rgb::new(1.0, 0.5, 0.25), Rgb::new(8.0, 4.0, 2.0));
        let world = |x: f64, y: f64, z: f64| DVec3::new(shift + x, y, z);
        // On the floor in front, on the tile, on the floor in its shadow.
        let seen = [
            (at(-3.0, 0.0, 3.0, Vec3::Y, lit), world(-3.0, 0.0, 3.0), [1.0; 3], [1.0, 0.5, 0.25]),
            (at(0.2, 1.0, 0.3, Vec3::Y, red), world(0.2, 1.0, 0.3), [1.0; 3], [1.0, 0.5, 0.25]),
            (at(2.5, 0.0, 1.0, Vec3::Y, Rgb::ZERO), world(2.5, 0.0, 1.0), [0.0; 3], [0.0; 3]),
        ];
        for (photon, place, white, coloured) in seen {
            let (x, y) = pixel_of(&scene, place);
            assert!(empty.pixel(x, y)[0] > 0.04, "the scene is behind it, and not black");
            for (is_coloured, wanted) in [(false, white), (true, coloured)] {
                let image = draw(&scene, &[photon], is_coloured);
                assert_eq!(image.pixel(x, y), wanted, "{place}");
                let changed = image.rgb.chunks(3).zip(empty.rgb.chunks(3)).filter(|(a, b)| a != b).count();
                assert_eq!(changed, 1, "nothing but the dot");
            }
        }
        // Under the tile, on its underside, below the floor, behind the eye, beyond the image's edge.
        for hidden in [
            at(-0.5, 0.0, -1.5, Vec3::Y, lit),
            at(0.0, 1.0, 0.0, -Vec3::Y, lit),
            at(2.5, 0.0, 1.0, -Vec3::Y, lit),
            at(3.0, 8.0, 20.0, Vec3::Y, lit),
            at(100.0, 0.0, 0.0, Vec3::Y, lit),
        ] {
            assert!(draw(&scene, &[hidden], false) == empty, "{hidden:?}");
        }
        // Two in a pixel: the nearer, whichever comes first.
        let camera = Camera::new(scene.camera(), SIZE, scene.centre()).unwrap();
        let ray = camera.ray(20.5, 40.5);
        let far = Photon::new(ray.at(scene.intersect(&ray).expect("the floor").t), Vec3::Y, Vec3::Y, lit);
        let near = Photon::new(ray.at(1.0), -ray.direction, Vec3::Y, Rgb::ZERO);
        for order in [[near, far], [far, near]] {
            assert_eq!(draw(&scene, &order, false).pixel(20, 40), [0.0; 3]);
        }
    }
}

/// A dot in each pixel, if there are photons enough: white from the lamp's place, but for the half-shadow.
#[test]
fn a_map_of_direct_light_covers_what_it_lights_and_darkens_what_it_does_not() {
    let scene = stage(0.0);
    let job =
        PhotonJob { kind: MapKind::Direct, paths: 300_000, pass: 0, most: 1 << 22, narrow_below: NARROW, time: 0.0 };
    let shot = photon::shoot(&scene, &desc::RenderDesc::default(), job, &mut Alone::default()).unwrap();
    assert!(shot.tally.shadows > 1000 && shot.tally.stored > 100_000, "{:?}", shot.tally);
    let top = CameraDesc::Perspective {
        eye: DVec3::new(0.0, 5.9, 0.0),
        look_at: DVec3::ZERO,
        up: DVec3::Z,
        fov_deg: 60.0,
        fov_axis: desc::FovAxis::Vertical,
        film: FilmDesc::default(),
    };
    let lit = photon::draw(&scene, &top, [32, 32], &shot.photons, DrawSettings::default()).unwrap();
    for (index, pixel) in lit.rgb.chunks(3).enumerate() {
        // Where the middle of the pixel's floor is, in scene units from the middle of the image.
        let place = |i: usize| (i as f64 + 0.5 - 16.0).abs() / 16.0 * 5.9 * 30.0_f64.to_radians().tan();
        let off = place(index % 32).max(place(index / 32));
        // Beside the tile's edge, at 1.2 as seen from here, part of the lamp is hidden.
        let is_clear = !(1.0..1.6).contains(&off);
        assert!(
            if is_clear { pixel == [1.0; 3] } else { pixel == [1.0; 3] || pixel == [0.0; 3] },
            "{index}: {pixel:?}"
        );
    }
    // From under the tile, all that is seen of the floor lies in shadow.
    let below = CameraDesc::Perspective {
        eye: DVec3::new(0.0, 0.9, 0.0),
        look_at: DVec3::ZERO,
        up: DVec3::Z,
        fov_deg: 40.0,
        fov_axis: desc::FovAxis::Vertical,
        film: FilmDesc::default(),
    };
    let dark = photon::draw(&scene, &below, [8, 8], &shot.photons, DrawSettings::default()).unwrap();
    assert!(dark.rgb.iter().all(|value| *value == 0.0), "under the tile, all is dark");
}

#[test]
fn pictures_that_cannot_be_are_errors() {
    let scene = stage(0.0);
    for resolution in [[0, 4], [4, 0], [1 << 20, 1 << 20]] {
        let error = photon::draw(&scene, scene.camera(), resolution, &[], DrawSettings::default()).unwrap_err();
        assert_eq!(error.location().json_path, "render.resolution");
    }
    let CameraDesc::Perspective { eye, up, fov_deg, fov_axis, .. } = *scene.camera() else { panic!("a pinhole") };
    let camera = CameraDesc::Perspective { eye, look_at: eye, up, fov_deg, fov_axis, film: FilmDesc::default() };
    let error = photon::draw(&scene, &camera, [4, 4], &[], DrawSettings::default()).unwrap_err();
    assert_eq!(error.location().json_path, "camera.lookAt");
}
