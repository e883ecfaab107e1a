//! Layouts: every triangle has a place of its own.

use std::collections::HashMap;

use etendue::bake::{AtlasOptions, Layout};
use etendue::math::DAffine3;
use etendue::spectrum::Rgb;
use proptest::prelude::*;

use super::*;

/// Everything that must hold of any atlas of any scene.
fn check(scene: &Scene, atlas: &Atlas) {
    let side = f64::from(atlas.side());
    // Places of charts are inside and apart.
    let mut owner = vec![u32::MAX; (atlas.side() * atlas.side()) as usize];
    for (number, chart) in atlas.charts().iter().enumerate() {
        for y in chart.origin[1]..chart.origin[1] + chart.size[1] {
            for x in chart.origin[0]..chart.origin[0] + chart.size[0] {
                assert!(x < atlas.side() && y < atlas.side(), "chart {number} reaches out of the map");
                let texel = &mut owner[(y * atlas.side() + x) as usize];
                assert_eq!(*texel, u32::MAX, "charts {number} and {texel} share a texel");
                *texel = number as u32;
            }
        }
    }
    // Every triangle has one chart, and lies in its place.
    assert_eq!(atlas.triangles().len(), atlas.chart_numbers().len());
    let meshes = scene.surface_meshes(&Cancel::new()).unwrap();
    assert_eq!(atlas.triangles().len(), meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>());
    for (triangle, &chart) in atlas.triangles().iter().zip(atlas.chart_numbers()) {
        let place = atlas.charts()[chart as usize];
        for corner in triangle {
            let vertex = atlas.vertices()[*corner as usize];
            assert!((vertex.normal.length() - 1.0).abs() < 1e-5, "{vertex:?}");
            for axis in 0..2 {
                let at = f64::from(vertex.uv[axis]) * side;
                let (low, high) = (f64::from(place.origin[axis]), f64::from(place.origin[axis] + place.size[axis]));
                assert!((0.0..=1.0).contains(&vertex.uv[axis]), "{vertex:?}");
                assert!(at > low - 1e-3 && at < high + 1e-3, "{vertex:?} is not in {place:?}");
            }
        }
    }
    // From texel to point and back.
    let sites = atlas.sites();
    assert_eq!((sites.len(), sites.facets().len()), (atlas.texels().len(), atlas.triangles().len()));
    let mut covered = 0.0;
    for site in 0..sites.len() {
        let texel = atlas.texels()[site];
        let [x, y] = [texel % atlas.side(), texel / atlas.side()].map(f64::from);
        covered += f64::from(atlas.coverage()[site]);
        for piece in sites.pieces(site) {
            assert_eq!(owner[texel as usize], atlas.chart_numbers()[piece.facet as usize], "a foreign texel");
            for u in [[0.0, 0.0], [0.999, 0.5], [0.3, 0.9]] {
                let [b1, b2] = piece.point(u);
                let [u, v] = atlas.uv(piece.facet as usize, [b1, b2]).map(|u| f64::from(u) * side);
                assert!(u > x - 2e-3 && u < x + 1.002, "{u} is not in column {x}");
                assert!(v > y - 2e-3 && v < y + 1.002, "{v} is not in row {y}");
                let point = scene.facet_point(&sites.facets()[piece.facet as usize], b1, b2);
                let corners = atlas.triangles()[piece.facet as usize].map(|i| atlas.vertices()[i as usize].position);
                let [b1, b2] = [b1, b2].map(f64::from);
                let expected = corners[0] + b1 * (corners[1] - corners[0]) + b2 * (corners[2] - corners[0]);
                let off = (point.point.p.as_dvec3() + scene.centre()).distance(expected);
                let size = corners[0].distance(corners[1]).max(corners[0].distance(corners[2]));
                assert!(off < 1e-3 * (size + expected.length()), "{off} beside the triangle");
            }
        }
    }
    // No two triangles of a chart are at one place: what they cover adds up to their areas.
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| atlas.vertices()[i as usize].uv.map(|u| f64::from(u) * side));
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
    };
    let areas: f64 = atlas.triangles().iter().map(area).sum();
    assert!((covered - areas).abs() < 1e-3 * areas + 1e-2, "{covered} texels are covered by {areas}");
}

/// Any triangles between points of a box, degenerate ones among them.
fn soup() -> impl Strategy<Value = MeshDesc> {
    let point = [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64];
    (prop::collection::vec(point, 3..24), prop::collection::vec([0..1000_u32, 0..1000, 0..1000], 1..40)).prop_map(
        |(points, triangles)| {
            let count = points.len() as u32;
            mesh(
                points.into_iter().map(DVec3::from).collect(),
                triangles.into_iter().map(|t| t.map(|i| i % count)).collect(),
            )
        },
    )
}

fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> MeshDesc {
    MeshDesc { name: "mesh".into(), path: "meshes[0]".into(), positions, triangles, ..MeshDesc::default() }
}

/// A strip that turns around an axis while it goes on, more than once: flat charts of it would lie over each other.
fn screw(turns: f64, steps: u32, pitch: f64) -> MeshDesc {
    let angle = |i: u32| turns * std::f64::consts::TAU * f64::from(i) / f64::from(steps);
    let at = |i: u32, r: f64| DVec3::new(r * angle(i).cos(), pitch * angle(i), r * angle(i).sin());
    let positions = (0..=steps).flat_map(|i| [at(i, 0.3), at(i, 1.0)]).collect();
    let triangles = (0..steps).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]]).collect();
    mesh(positions, triangles)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_triangles_have_places_of_their_own(
        mesh in soup(),
        side in 96..200_u32,
        gutter in 0..3_u32,
        turn in 0.0..6.0_f64,
        angle in 20.0..80.0_f64,
    ) {
        let mut desc = one_mesh(mesh, None);
        desc.surfaces[0].transform = DAffine3::from_rotation_x(turn);
        let scene = build(&desc);
        prop_assume!(scene.info().triangles > 0);
        let options = AtlasOptions { resolution: Some(side), gutter, max_angle_deg: angle, ..AtlasOptions::default() };
        let atlas = Atlas::new(&scene, &options, &Cancel::new()).unwrap();
        check(&scene, &atlas);
    }
}

#[test]
fn what_would_lie_over_itself_is_cut() {
    let scene = build(&one_mesh(screw(2.7, 90, 0.1), None));
    let atlas = atlas(&scene, 128);
    check(&scene, &atlas);
    // One chart a turn, about: it is nearly flat.
    assert!((3..12).contains(&atlas.charts().len()), "{} charts", atlas.charts().len());
}

#[test]
fn a_box_has_six_charts_and_a_quad_one() {
    let scene = build(&one_mesh(scenes::box_inside(DVec3::splat(-1.0), DVec3::new(1.0, 2.0, 3.0)), None));
    let options = AtlasOptions { texels_per_unit: Some(8.0), ..AtlasOptions::default() };
    let atlas = Atlas::new(&scene, &options, &Cancel::new()).unwrap();
    check(&scene, &atlas);
    assert_eq!((atlas.charts().len(), atlas.vertices().len()), (6, 24));
    // Sides of whole numbers of texels need no more than these.
    let mut sizes: Vec<[u32; 2]> = atlas.charts().iter().map(|chart| chart.size.map(|n| n - 4)).collect();
    sizes.sort();
    assert_eq!(sizes, [[24, 16], [24, 16], [32, 16], [32, 16], [32, 24], [32, 24]]);
    assert!(atlas.coverage().iter().all(|&coverage| coverage > 0.999));
    assert!(atlas.side().is_multiple_of(4) && atlas.side() <= 80, "{}", atlas.side());
    assert_eq!(atlas.texels_per_unit(), 8.0);

    let scene = build(&scenes::scene(
        scenes::camera(DVec3::Y, DVec3::ZERO, 60.0),
        vec![(square(0.0, true), BsdfDesc::Black, None)],
    ));
    let atlas = super::atlas(&scene, 36);
    assert_eq!((atlas.charts().len(), atlas.vertices().len(), atlas.triangles().len()), (1, 4, 2));
    assert_eq!(atlas.primitives(), [0, 1]);
    let density = atlas.texels_per_unit();
    assert!(density > 15.8 && density <= 16.0 + 1e-6, "{density} for 32 texels on 2 units");
}

/// Lookups at seams show their own chart alone.
#[test]
fn seams_are_padded() {
    let scene = build(&one_mesh(screw(2.7, 90, 0.1), None));
    for gutter in [1, 2, 5] {
        let options = AtlasOptions { resolution: Some(160), gutter, ..AtlasOptions::default() };
        let atlas = Atlas::new(&scene, &options, &Cancel::new()).unwrap();
        // Each chart in a colour of its own.
        let own = |site: usize| {
            let chart = atlas.chart_numbers()[atlas.sites().pieces(site)[0].facet as usize];
            [1.0 + chart as f32; 3]
        };
        let irradiance: Vec<_> = (0..atlas.sites().len()).map(own).collect();
        let map = atlas.light_map(&Baked { standard_error: vec![[0.0; 3]; irradiance.len()], irradiance });
        for (triangle, &chart) in atlas.chart_numbers().iter().enumerate() {
            for i in 0..=8_u8 {
                for j in 0..=8 - i {
                    let [b1, b2] = [i, j].map(|k| f32::from(k) / 8.0);
                    let found = map.at(atlas.uv(triangle, [b1, b2]));
                    assert!(
                        (found.r() - 1.0 - chart as f32).abs() < 1e-4,
                        "{found} at {b1}, {b2} of {triangle} in {chart}"
                    );
                }
            }
        }
    }
}

/// A cube of separate faces whose own coordinates are a grid of 3 x 2 cells.
fn unwrapped_box() -> MeshDesc {
    let mut mesh = scenes::box_inside(DVec3::splat(-1.0), DVec3::splat(1.0));
    let positions = std::mem::take(&mut mesh.positions);
    for (face, two) in mesh.triangles.chunks_mut(2).enumerate() {
        let (first, mut known) = (mesh.positions.len() as u32, HashMap::new());
        let (column, row) = ((face % 3) as f64, (face / 3) as f64);
        let corners = two[0].map(|i| positions[i as usize]);
        let across =
            (0..3).find(|&axis| corners.iter().all(|p| p[axis] == corners[0][axis])).expect("a face of a cube");
        for corner in two.iter_mut().flatten() {
            let next = known.len() as u32;
            let number = *known.entry(*corner).or_insert(next);
            if number == next {
                let p = positions[*corner as usize];
                mesh.positions.push(p);
                let [u, v] = [1, 2].map(|i| 0.5 + 0.45 * p[(across + i) % 3]);
                mesh.uvs.push([(column + u) / 3.0, (row + v) / 2.0].map(|x| x as f32));
            }
            *corner = first + number;
        }
    }
    mesh
}

fn with_layout(desc: &SceneDesc, layout: Layout) -> etendue::Result<Atlas> {
    let options = AtlasOptions { resolution: Some(96), layout, ..AtlasOptions::default() };
    Atlas::new(&build(desc), &options, &Cancel::new())
}

#[test]
fn a_mesh_keeps_its_own_layout() {
    let desc = one_mesh(unwrapped_box(), None);
    let atlas = with_layout(&desc, Layout::Auto).unwrap();
    check(&build(&desc), &atlas);
    assert!(atlas.warnings().is_empty(), "{:?}", atlas.warnings());
    assert_eq!((atlas.charts().len(), atlas.vertices().len()), (1, 24));
    assert_eq!(atlas.surfaces()[0].scale_offset, Some([1.0, 1.0, 0.0, 0.0]));
    for vertex in atlas.vertices() {
        let own = desc.meshes[0].uvs[vertex.source as usize];
        assert!((vertex.uv[0] - own[0]).abs() < 1e-6 && (vertex.uv[1] - own[1]).abs() < 1e-6, "{vertex:?} {own:?}");
    }
    assert_eq!(with_layout(&desc, Layout::Own).unwrap().vertices(), atlas.vertices());
    assert_eq!(with_layout(&desc, Layout::Charts).unwrap().charts().len(), 6);

    // Beside others it is a part of the square, scaled.
    let mut two = desc.clone();
    scenes::add(&mut two, 1, square(-3.0, true), BsdfDesc::Black, None);
    let atlas = with_layout(&two, Layout::Own).unwrap();
    check(&build(&two), &atlas);
    let [a, b, x, y] = atlas.surfaces()[0].scale_offset.unwrap();
    assert_eq!(atlas.surfaces()[1].scale_offset, None);
    for vertex in &atlas.vertices()[..24] {
        let own = two.meshes[0].uvs[vertex.source as usize];
        let expected = [own[0] * a + x, own[1] * b + y];
        assert!((vertex.uv[0] - expected[0]).abs() < 1e-6 && (vertex.uv[1] - expected[1]).abs() < 1e-6);
    }
}

#[test]
fn coordinates_that_are_no_layout_are_refused_or_replaced() {
    type Spoil = fn(&mut MeshDesc);
    let cases: [(&str, Spoil); 6] = [
        ("has no texture coordinates", |mesh| mesh.uvs.clear()),
        ("is outside of [0, 1]", |mesh| mesh.uvs[5] = [1.25, 0.5]),
        ("is outside of [0, 1]", |mesh| mesh.uvs[5][1] = -0.001),
        ("is outside of [0, 1]", |mesh| mesh.uvs[5][1] = f32::NAN),
        ("overlap in texture coordinates", |mesh| mesh.uvs.iter_mut().for_each(|uv| uv[0] = (uv[0] * 3.0).fract())),
        ("has no area in texture coordinates", |mesh| mesh.uvs[0] = mesh.uvs[1]),
    ];
    for (what, spoil) in cases {
        let mut mesh = unwrapped_box();
        spoil(&mut mesh);
        let desc = one_mesh(mesh, None);
        let error = with_layout(&desc, Layout::Own).unwrap_err();
        assert!(error.message().contains(what), "{error}");
        assert_eq!(error.location().json_path, "surfaces[0]");
        let atlas = with_layout(&desc, Layout::Auto).unwrap();
        assert_eq!(atlas.charts().len(), 6);
        let warned = !desc.meshes[0].uvs.is_empty();
        assert_eq!(atlas.warnings().iter().any(|warning| warning.contains(what)), warned, "{:?}", atlas.warnings());
    }
}

#[test]
fn coordinates_beside_the_square_by_rounding_are_a_layout() {
    let mut mesh = unwrapped_box();
    let least = mesh.uvs.iter().flatten().copied().fold(1.0, f32::min);
    let most = mesh.uvs.iter().flatten().copied().fold(0.0, f32::max);
    mesh.uvs.iter_mut().flatten().for_each(|x| *x = (*x - least) / (most - least) * 1.000_000_7 - 4e-7);
    assert!(mesh.uvs.iter().flatten().any(|x| *x < 0.0) && mesh.uvs.iter().flatten().any(|x| *x > 1.0));
    let desc = one_mesh(mesh, None);
    let atlas = with_layout(&desc, Layout::Own).unwrap();
    check(&build(&desc), &atlas);
}

#[test]
fn a_speck_of_the_square_is_no_layout() {
    // Overlaps are judged by the size of the layout, and one without a texel to speak of is none.
    let shrunk = |mut mesh: MeshDesc, by: f32| {
        mesh.uvs.iter_mut().flatten().for_each(|x| *x *= by);
        one_mesh(mesh, None)
    };
    let mut folded = unwrapped_box();
    folded.uvs.iter_mut().for_each(|uv| uv[0] = (uv[0] * 3.0).fract());
    let error = with_layout(&shrunk(folded, 2e-3), Layout::Own).unwrap_err();
    assert!(error.message().contains("overlap"), "{error}");
    let error = with_layout(&shrunk(unwrapped_box(), 1e-4), Layout::Own).unwrap_err();
    assert!(error.message().contains("of the square"), "{error}");
    assert!(with_layout(&shrunk(unwrapped_box(), 2e-3), Layout::Own).is_ok());
}

#[test]
fn a_layout_of_its_own_is_as_dense_as_was_asked() {
    let desc = one_mesh(unwrapped_box(), None);
    let options = AtlasOptions {
        resolution: Some(64),
        texels_per_unit: Some(100.0),
        layout: Layout::Own,
        ..AtlasOptions::default()
    };
    let error = Atlas::new(&build(&desc), &options, &Cancel::new()).unwrap_err();
    assert_eq!(error.location().json_path, "resolution");
    assert!(error.message().contains("100 texels per unit do not fit into 64 x 64"), "{error}");
    let fits = AtlasOptions { texels_per_unit: Some(2.0), ..options };
    assert_eq!(Atlas::new(&build(&desc), &fits, &Cancel::new()).unwrap().side(), 64);
}

#[test]
fn specks_have_a_texel() {
    // A millionth of a texel, less than rounding tells apart, and nothing at all of it.
    for size in [1e-2, 1e-6, 1e-9] {
        let ground = scenes::scene(
            scenes::camera(DVec3::Y, DVec3::ZERO, 60.0),
            vec![
                (square(0.0, true), BsdfDesc::Black, None),
                (
                    ShapeDesc::Triangle([DVec3::Y, DVec3::Y + size * DVec3::Z, DVec3::Y + size * DVec3::X]),
                    BsdfDesc::Black,
                    None,
                ),
            ],
        );
        let scene = build(&ground);
        let atlas = atlas(&scene, 32);
        check(&scene, &atlas);
        let shown: Vec<usize> = (0..atlas.sites().len())
            .filter(|&site| atlas.sites().pieces(site).iter().any(|piece| piece.facet == 2))
            .collect();
        assert_eq!(shown.len(), 1, "{size}");
        let [u, v] = atlas.uv(2, [0.3, 0.3]).map(|u| (u * 32.0) as u32);
        assert_eq!(atlas.texels()[shown[0]], v * 32 + u, "{size}");
        let baked = Baked { irradiance: vec![[1.0; 3]; atlas.sites().len()], standard_error: Vec::new() };
        assert_eq!(atlas.light_map(&baked).at(atlas.uv(2, [0.3, 0.3])), Rgb::ONE, "{size}");
    }
}

#[test]
fn a_thread_of_a_surface_fits() {
    let corners = [DVec3::ZERO, DVec3::X * 1e6, DVec3::X * 1e6 + DVec3::Y * 1e-9];
    let scene = build(&one_mesh(mesh(corners.to_vec(), vec![[0, 1, 2]]), None));
    let atlas = atlas(&scene, 64);
    assert!(atlas.texels_per_unit() * 1e6 > 55.0, "{}", atlas.texels_per_unit());
}

#[test]
fn fine_detail_on_a_large_ground_is_laid_out_in_time() {
    // Grids of cells as large as the mean triangle had all of the detail in one: its square of comparisons, minutes of work.
    let n = 160_u32;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for z in 0..=n {
        for x in 0..=n {
            positions.push(DVec3::new(f64::from(x), 1.0, f64::from(z)) * DVec3::new(1e-4, 0.1, 1e-4));
            if x < n && z < n {
                let a = z * (n + 1) + x;
                triangles.extend([[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]);
            }
        }
    }
    let first = positions.len() as u32;
    positions
        .extend([(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| DVec3::new(1e3 * x, 0.0, 1e3 * z)));
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    let scene = build(&one_mesh(mesh(positions, triangles), None));
    let cancel = Cancel::new();
    let watch = cancel.clone();
    let (done, is_done) = std::sync::mpsc::channel::<()>();
    let guard = std::thread::spawn(move || {
        if is_done.recv_timeout(std::time::Duration::from_secs(300)).is_err() {
            watch.cancel();
        }
    });
    let options = AtlasOptions { resolution: Some(64), ..AtlasOptions::default() };
    let atlas = Atlas::new(&scene, &options, &cancel).expect("an atlas within five minutes");
    done.send(()).expect("somebody waits");
    guard.join().expect("no panic");
    assert_eq!(atlas.charts().len(), 2);
}
