//! Meshes with hierarchies of their own, under transforms that stretch, shear, mirror and move them far.

use etendue::desc::{MeshDesc, ShapeDesc};
use std::sync::Arc;

use etendue::math::{DAffine3, DMat3, DQuat, DVec3, EulerRot};
use etendue::sampling::Rng;

use super::spawn::{GREY, LIST, Tally, build, offset, random_direction, shoot};
use crate::common::scenes::{camera, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "S22c", title: "rays spawned on instances", run: instances },
        Entry { id: "S22e", title: "uses that the kernel cannot invert", run: copies },
    ]
}

/// What single precision cannot invert is copied, said, and found.
fn copies(case: &mut Case) {
    let mesh: Arc<MeshDesc> = ball_mesh(60, 100).into();
    let turn = DMat3::from_quat(DQuat::from_euler(EulerRot::XYZ, 0.5, 1.1, 2.2));
    let stretched = turn * DMat3::from_diagonal(DVec3::new(1.0, 1e3, 1e-3)) * turn.transpose();
    for (what, matrix) in [("a stretch between turns", stretched), ("a scale of 10^-13", DMat3::IDENTITY * 1e-13)] {
        let ball = ShapeDesc::Mesh { mesh: 0, smooth: false };
        let eye = matrix * DVec3::splat(2.0);
        let mut desc = scene(camera(eye, DVec3::ZERO, 60.0), vec![(ball, GREY, None), (ball, GREY, None)]);
        desc.meshes.push(Arc::clone(&mesh));
        for surface in &mut desc.surfaces {
            surface.transform = DAffine3::from_mat3(matrix);
        }
        let scene = build(&desc, LIST);
        let instances = scene.info().instances;
        case.holds(format!("{what}: instances"), "0", instances.to_string(), instances == 0);
        let says =
            |warning: &&String| warning.contains("2 uses of meshes are copied") && warning.contains("surfaces[0]");
        let is_said = scene.warnings().iter().find(says).is_some();
        case.holds(
            format!("{what}: a warning with count and path"),
            "said",
            if is_said { "said" } else { "—" },
            is_said,
        );
    }
}

/// A convex mesh (a tessellated ball, outward winding) of enough triangles to be instanced when used twice.
pub fn ball_mesh(rings: u32, sectors: u32) -> MeshDesc {
    let mut mesh = MeshDesc { name: "ball".into(), path: "meshes[0]".into(), ..MeshDesc::default() };
    for ring in 0..=rings {
        for sector in 0..sectors {
            let theta = f64::from(ring) / f64::from(rings) * std::f64::consts::PI;
            let phi = f64::from(sector) / f64::from(sectors) * std::f64::consts::TAU;
            mesh.positions.push(DVec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()));
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let next = (sector + 1) % sectors;
            let [a, b] = [ring * sectors + sector, ring * sectors + next];
            let [c, d] = [a + sectors, b + sectors];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh
}

fn instances(case: &mut Case) {
    let mut rng = Rng::new(3, 0);
    let mesh: Arc<MeshDesc> = ball_mesh(60, 100).into();
    let turn = DMat3::from_quat(DQuat::from_euler(EulerRot::XYZ, 0.5, 1.1, 2.2));
    let other = DMat3::from_quat(DQuat::from_euler(EulerRot::XYZ, 1.5, 0.7, -1.2));
    let scale = |x, y, z| DMat3::from_diagonal(DVec3::new(x, y, z));
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(3.0, 1.0, 0.0), DVec3::new(-2.0, 10.0, 1.0));
    let (mut hits, mut inwards, mut nearer) = (0, 0, Tally::with_bound_times(0.1));
    let [mut largest, mut largest_thin] = [0.0_f64; 2];
    for (what, matrix, distances, is_thin) in [
        ("turned", turn, &[3.0, 1e3, 1e6][..], false),
        ("10^-5", scale(1e-5, 1e-5, 1e-5) * turn, &[3.0, 1e3, 1e6], false),
        ("10^5", scale(1e5, 1e5, 1e5) * turn, &[3.0, 1e3, 1e6], false),
        ("mirrored", turn * scale(-1.0, 1.0, 1.0), &[3.0, 1e3, 1e6], false),
        ("stretched 1, 10, 0.1, turned", turn * scale(1.0, 10.0, 0.1), &[3.0], false),
        ("turned, stretched 1, -10, 0.1", scale(1.0, -10.0, 0.1) * turn, &[3.0], false),
        ("sheared and mirrored", turn * scale(1.0, -2.0, 1.0) * shear, &[3.0], false),
        ("turned, stretched 1, 10, 0.1, turned", other * scale(1.0, 10.0, 0.1) * turn, &[3.0], false),
        ("turned, stretched 1, 30, 1/30, turned", other * scale(1.0, 30.0, 1.0 / 30.0) * turn, &[3.0], false),
        ("stretched 1, 10^3, 10^-3, turned", turn * scale(1.0, 1e3, 1e-3), &[3.0], true),
        ("turned, stretched 1, 10^3, 10^-3", scale(1.0, 1e3, 1e-3) * turn, &[3.0], true),
    ] {
        let size = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.length()).into_iter().sum::<f64>();
        let (mut rays, mut inside) = (Tally::default(), Tally::default());
        for &distance in distances {
            let ball = ShapeDesc::Mesh { mesh: 0, smooth: false };
            let eye = distance * size * DVec3::new(0.3, 0.5, 0.8);
            let mut desc = scene(camera(eye, DVec3::ZERO, 60.0), vec![(ball, GREY, None), (ball, GREY, None)]);
            desc.meshes.push(Arc::clone(&mesh));
            desc.surfaces[0].transform = DAffine3::from_mat3(matrix);
            // The second use is small and stands in the eye, so that the scene's frame does.
            desc.surfaces[1].transform = DAffine3::from_mat3_translation(scale(size, size, size) * 1e-3, eye);
            let scene = build(&desc, LIST);
            for _ in 0..case.count(500, 10_000) {
                let direction = random_direction(&mut rng);
                let [from, aim] = [4.0, 0.5].map(|reach| scene.to_scene(matrix * (reach * direction)));
                let Some(point) = shoot(&scene, from, aim, 0) else { continue };
                hits += 1;
                inwards += u64::from(point.ng.dot(aim - from) >= 0.0);
                let largest = if is_thin { &mut largest_thin } else { &mut largest };
                *largest = largest.max(offset(&point, point.ng) / (distance * size));
                // A convex body is left for good.
                rays.leave(&scene, &point, point.ng, 10.0 * size as f32, 10, &mut rng);
                nearer.leave(&scene, &point, point.ng, 10.0 * size as f32, 2, &mut rng);
                inside.enter(&scene, &point, 4, &mut rng);
            }
        }
        case.never(format!("{what}: met again"), rays.bad, rays.rays);
        if is_thin {
            case.known(THIN);
        }
        case.rarely(format!("{what}: light leaks in"), inside.bad, inside.rays, 1e-3);
    }
    case.never("normals inwards", inwards, hits);
    case.at_most("offset / distance", largest, 1e-5);
    case.at_most("offset / distance, stretched by 10^6", largest_thin, 1e-4);
    let Tally { rays, bad, .. } = nearer;
    case.holds("a tenth of the bound", "some met again", format!("{bad} of {rays}"), bad > 0);
}

/// Why rays that enter some bodies come out on the other side.
const THIN: &str = "the body is a few roundings of its coordinates thick, being a million times longer than that";
