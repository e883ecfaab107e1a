//! Radiosity: the same rooms and factors as light transport, by the solver.

mod skies;

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::scenes::{box_inside, camera, point_light, scene};
use crate::record::{Case, Entry, Within};
use crate::transport::{MESH, ball_mesh, grey, mesh, parallelogram, pick, turned};
use etendue::Alone;
use etendue::desc::{BsdfDesc, MeshDesc, RadiosityDesc, SceneDesc};
use etendue::integrator::radiosity::Radiosity;
use etendue::integrator::radiosity::form_factor::polygon_to_polygon;
use etendue::math::{DVec3, Ray, Vec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    let mut cases = vec![
        Entry { id: "Q55", title: "emitting rooms", run: furnaces },
        Entry { id: "Q56", title: "integrating sphere", run: sphere },
        Entry { id: "Q57", title: "form factors in closed form", run: factors },
        Entry { id: "Q58", title: "two plates", run: plates },
        Entry { id: "Q60", title: "Cornell box", run: cornell },
        Entry { id: "Q46", title: "dark side of emitters", run: sides },
    ];
    cases.extend(skies::cases());
    cases
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

fn solve(scene: &Scene, desc: &RadiosityDesc) -> Radiosity {
    Radiosity::solve(scene, desc, &mut Alone::default()).expect("it fits, and nobody cancels")
}

/// A room of one mesh.
fn room(mesh: MeshDesc, albedo: f32, emission: Option<f32>) -> SceneDesc {
    let view = camera(DVec3::ZERO, DVec3::X, 60.0);
    let mut desc = scene(view, vec![(MESH, grey(albedo), emission.map(Rgb::splat))]);
    desc.meshes.push(Arc::new(mesh));
    desc
}

fn furnaces(case: &mut Case) {
    let corners = [[-1.0, -1.0, -1.0], [2.0, 1.0, -1.0], [1.0, -1.5, 1.0], [-1.0, 1.0, 1.5]].map(DVec3::from_array);
    let tetrahedron = mesh(corners.to_vec(), vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]);
    let rooms = [
        ("box", box_inside(DVec3::new(-1.0, -2.0, -1.0), DVec3::new(1.0, 1.0, 1.5))),
        ("tetrahedron", turned(tetrahedron, 0.25 * corners.iter().sum::<DVec3>(), true)),
        ("sphere of triangles", turned(ball_mesh(1.5, 12, 24), DVec3::ZERO, true)),
    ];
    for (name, mesh) in rooms {
        // The brighter one is the harder, and has the same links.
        for &albedo in pick(case, &[0.9_f32][..], &[0.5, 0.9]) {
            let solution = solve(&build(&room(mesh.clone(), albedo, Some(1.0))), &RadiosityDesc::default());
            let expected = 1.0 / (1.0 - f64::from(albedo));
            let radiance = solution.mesh(None, true).radiosity.into_iter().map(|b| f64::from(b.r()) / PI);
            let farthest = radiance
                .fold(expected, |worst, b| if (b - expected).abs() > (worst - expected).abs() { b } else { worst });
            case.exact(format!("{name}, albedo {albedo}, worst vertex"), farthest, expected, Within::Relative(1e-3));
            let summary = solution.summary();
            let balance = f64::from(summary.absorbed.r() / summary.emitted.r());
            case.exact(format!("{name}, albedo {albedo}, absorbed"), balance, 1.0, Within::Absolute(1e-3));
        }
    }
}

fn sphere(case: &mut Case) {
    let (radius, albedo, intensity, light) = (2.0, 0.7, 5.0, DVec3::new(0.8, 0.0, 0.0));
    let mut desc = room(turned(ball_mesh(radius, 36, 72), DVec3::ZERO, true), albedo as f32, None);
    desc.lights.push(point_light(light, intensity as f32));
    let scene = build(&desc);
    let solution = solve(&scene, &RadiosityDesc { error: 1.0, element_size: Some(10.0), ..RadiosityDesc::default() });
    // By the solution and in closed form, in directions spread evenly. Links of clusters differ from place to place, so that single
    // places say little. The area of the triangles is 0.25 % below that of the ball, and so their light is brighter.
    const COUNT: u32 = 400;
    let (mut sums, mut squares, mut worst) = ([0.0; 2], 0.0, 0.0_f64);
    for k in 0..COUNT {
        let (z, phi) = (1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(COUNT), 2.399_963 * f64::from(k));
        let r = (1.0 - z * z).sqrt();
        let direction = DVec3::new(r * phi.cos(), r * phi.sin(), z);
        let ray = Ray::new(scene.to_scene(DVec3::ZERO), direction.as_vec3a());
        let hit = scene.intersect(&ray).expect("it looks at a surface");
        let at = scene.interaction(&ray, &hit);
        let radiance = albedo / PI * f64::from(solution.irradiance(&hit, at.point.p, true).r());
        let to_light = light - radius * direction;
        let direct = intensity * to_light.dot(-direction) / to_light.length().powi(3);
        let expected = albedo / PI * (direct + albedo * intensity / (radius * radius * (1.0 - albedo)));
        let error = radiance / expected - 1.0;
        sums = [sums[0] + radiance, sums[1] + expected];
        squares += error * error;
        worst = worst.max(error.abs());
    }
    let [found, expected] = sums.map(|sum| sum / f64::from(COUNT));
    case.exact("5040 triangles, mean radiance", found, expected, Within::Relative(0.004));
    case.at_most("5040 triangles, root mean square of relative errors", (squares / f64::from(COUNT)).sqrt(), 0.01);
    case.at_most("5040 triangles, largest relative error", worst, 0.04);
}

fn quad(corner: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [corner, corner + u, corner + u + v, corner + v]
}

fn factors(case: &mut Case) {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let floor = |width: f64| quad(DVec3::ZERO, width * x, y);
    let ceiling = |width: f64, height: f64| quad(height * z, y, width * x);
    let wall = |height: f64| quad(DVec3::ZERO, y, height * z);
    let groove = quad(-5000.0 * y, 1e4 * y, 0.5 * x + 0.75_f64.sqrt() * z);
    for (what, from, to, expected) in [
        ("parallel squares at 1", floor(1.0), ceiling(1.0, 1.0), 0.199_824_895_698_387_4),
        ("parallel squares at 0.1", floor(1.0), ceiling(1.0, 0.1), 0.826_994_522_397),
        ("parallel squares at 10", floor(1.0), ceiling(1.0, 10.0), 0.003_162_056_838_76),
        ("parallel rectangles 2 x 1 at 0.5", floor(2.0), ceiling(2.0, 0.5), 0.508_988_669_041),
        ("squares with a common edge", floor(1.0), wall(1.0), 0.200_043_776_075_403_2),
        ("common edge, width 1, height 2", floor(1.0), wall(2.0), 0.232_852_602_795),
        ("common edge, width 2, height 1", floor(2.0), wall(1.0), 0.116_426_301_398),
        ("a piece of a long groove of 60 degrees", floor(1.0), groove, 0.5),
    ] {
        let area = |p: &[DVec3; 4]| (p[1] - p[0]).cross(p[3] - p[0]).length();
        let (there, back) = (polygon_to_polygon(&from, &to, 1e-7), polygon_to_polygon(&to, &from, 1e-9));
        case.exact(what, there, expected, Within::Absolute(1e-5));
        case.exact(format!("{what}, reciprocity"), area(&to) * back / area(&from), there, Within::Absolute(1e-5));
    }
}

fn plates(case: &mut Case) {
    let half = pick(case, 150.0, 500.0);
    let floor = parallelogram(DVec3::new(-half, 0.0, -half), DVec3::Z * 2.0 * half, DVec3::X * 2.0 * half);
    let ceiling = parallelogram(DVec3::new(-half, 1.0, -half), DVec3::X * 2.0 * half, DVec3::Z * 2.0 * half);
    let surfaces = vec![(floor, grey(0.5), Some(Rgb::splat((1.0 / PI) as f32))), (ceiling, grey(0.8), None)];
    let desc = scene(camera(DVec3::Y * 0.5, DVec3::ZERO, 60.0), surfaces);
    let solution = solve(&build(&desc), &RadiosityDesc { tolerance: 1e-5, ..RadiosityDesc::default() });
    let at = |surface| {
        solution.irradiance_on(surface, 0, [0.3, 0.4], DVec3::ZERO, true).map_or(f64::NAN, |e| f64::from(e.r()))
    };
    case.exact("radiosity of the one that emits", 1.0 + 0.5 * at(0), 5.0 / 3.0, Within::Absolute(3e-3));
    case.exact("radiosity of the other", 0.8 * at(1), 4.0 / 3.0, Within::Absolute(3e-3));
    plates_with_a_point(case);
}

/// The same with a point light half way between them: a spot of 1 of plates of 1000, whose light wanders outwards.
///
/// What is dim beside the spot is known to the three thousandths that are asked for where links may be wrong by ten times less
/// than by default. The test solves eight times as coarsely, which leaves it eight times as far off.
fn plates_with_a_point(case: &mut Case) {
    let half = 500.0;
    let floor = parallelogram(DVec3::new(-half, 0.0, -half), DVec3::Z * 2.0 * half, DVec3::X * 2.0 * half);
    let ceiling = parallelogram(DVec3::new(-half, 1.0, -half), DVec3::X * 2.0 * half, DVec3::Z * 2.0 * half);
    let error = if case.is_full() { 0.1 } else { 0.8 };
    for (albedo, expected) in [
        (0.5, &[(0.0, 4.528_129_526)][..]),
        (0.8, &[(0.0, 5.177_588_122), (1.0, 1.108_237_669), (3.0, 0.201_985_157_5)]),
    ] {
        // Of the two, this one has more light that wanders.
        if albedo < 0.8 && !case.is_full() {
            continue;
        }
        let surfaces = vec![(floor, grey(albedo), None), (ceiling, grey(albedo), None)];
        let mut desc = scene(camera(DVec3::Y * 0.5, DVec3::ZERO, 60.0), surfaces);
        desc.lights.push(point_light(DVec3::Y * 0.5, 1.0));
        let scene = build(&desc);
        let element_size = Some(pick(case, 0.04, 0.02));
        let solution = solve(&scene, &RadiosityDesc { error, element_size, ..RadiosityDesc::default() });
        for &(r, expected) in expected {
            // Not along a diagonal.
            let p = DVec3::new(r * 0.8, 0.25, r * 0.6);
            let ray = Ray::new(scene.to_scene(p), -Vec3::Y);
            let hit = scene.intersect(&ray).expect("it looks at a surface");
            let at = scene.interaction(&ray, &hit);
            let e = f64::from(solution.irradiance(&hit, at.point.p, true).r());
            case.exact(format!("point light, albedo {albedo}, at {r}"), e, expected, Within::Relative(0.03 * error));
        }
    }
}

/// Power: the open side lets some escape, so the box is closed for this by a black wall, which absorbs what meets it.
fn cornell(case: &mut Case) {
    let mut desc = etendue::desc::load("scenes/cornell.json".as_ref(), None).expect("the scene is there");
    let (albedo, z) = (1e-4, DVec3::Z);
    desc.materials.push(etendue::desc::MaterialDesc {
        name: "front".into(),
        path: "materials.front".into(),
        bsdf: BsdfDesc::Lambert { albedo: Rgb::splat(albedo) },
        ..etendue::desc::MaterialDesc::default()
    });
    let mut front = desc.surfaces[0].clone();
    front.shape = parallelogram(DVec3::new(-10.0, -10.0, -1e-3), DVec3::Y * 580.0, DVec3::X * 580.0);
    front.material = Some(desc.materials.len() - 1);
    desc.surfaces.push(front);
    desc.camera = camera(DVec3::new(278.0, 273.0, 10.0), DVec3::new(278.0, 273.0, 10.0) + z, 60.0);
    let solution = solve(&build(&desc), &RadiosityDesc { error: pick(case, 0.6, 0.3), ..RadiosityDesc::default() });
    let summary = solution.summary();
    let balance = f64::from(summary.absorbed.element_sum() / summary.emitted.element_sum());
    case.known(
        "around blocks two thousandths of the light are lost, at a radiosityError of 0.3 and of 0.1: elements of the floor that lie \
         half below one let some into it; in an empty room all but one ten-thousandth is found",
    );
    case.exact("closed by a black wall: absorbed over emitted power", balance, 1.0, Within::Absolute(1e-3));
}

fn sides(case: &mut Case) {
    let square = |y: f64, up: bool| {
        let (corner, u, v) = (DVec3::new(-1.0, y, -1.0), DVec3::Z * 2.0, DVec3::X * 2.0);
        if up { parallelogram(corner, u, v) } else { parallelogram(corner, v, u) }
    };
    let surfaces = vec![
        (square(0.0, true), BsdfDesc::Black, Some(Rgb::ONE)),
        (square(-1.0, true), grey(0.5), None),
        (square(1.0, false), grey(0.5), None),
    ];
    let desc = scene(camera(DVec3::Y * 5.0, DVec3::ZERO, 60.0), surfaces);
    let solution = solve(&build(&desc), &RadiosityDesc::default());
    let at = |surface, front| {
        solution.irradiance_on(surface, 0, [0.3, 0.3], DVec3::ZERO, front).map_or(f64::NAN, |e| f64::from(e.r()))
    };
    case.exact("behind it", at(1, true), 0.0, Within::Absolute(0.0));
    case.exact("behind it, the other side", at(1, false), 0.0, Within::Absolute(0.0));
    case.holds("before it", "> 0.5", format!("{:.3}", at(2, true)), at(2, true) > 0.5);
}
