//! Triangles inscribed in analytic shapes: the first elements of these shapes.

use std::collections::{BTreeSet, HashMap};

use crate::math::DVec3;
use crate::shape::{Analytic, ClipFaces, Quadric};

/// Triangles whose corners lie on the shape and that together represent all of it. Their winding has no meaning.
pub(super) fn tessellate(shape: &Analytic) -> Vec<[DVec3; 3]> {
    match shape {
        Analytic::Sphere(sphere) => {
            let place = |p: DVec3| sphere.centre + sphere.radius * p;
            ball().into_iter().map(|t| t.map(place)).collect()
        }
        Analytic::Disk(disk) => disk.fan(DISK_SECTORS),
        Analytic::Quadric(quadric) => tidy(quadric, quadric.triangles(QUADRIC_CELLS)),
    }
}

/// Triangles around the centre of a disk.
const DISK_SECTORS: u32 = 32;

/// Cells along each axis in which a quadric is searched for.
const QUADRIC_CELLS: u32 = 4;

/// Sides of triangles that are shorter than this are collapsed, in cells.
const SHORT: f64 = 0.7;

/// The cosine between a triangle's normal and that of the shape is at least this after a side was collapsed.
const LEAST_COSINE: f64 = 0.7;

/// Most rounds of collapsing and flipping sides.
const MOST_ROUNDS: usize = 16;

/// Triangles of a quadric without the slivers that lie where its grid is nearly met: short sides are collapsed, the shortest first.
///
/// The children of a sliver would lie over each other on the shape. All corners stay on the shape and on the edges of its clip box.
fn tidy(quadric: &Quadric, triangles: Vec<[DVec3; 3]>) -> Vec<[DVec3; 3]> {
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let mut points = Vec::new();
    let mut triangles: Vec<[usize; 3]> = triangles
        .iter()
        .map(|triangle| {
            triangle.map(|p| {
                *numbers.entry((p + DVec3::ZERO).to_array().map(f64::to_bits)).or_insert_with(|| {
                    points.push(p);
                    points.len() - 1
                })
            })
        })
        .filter(|&[a, b, c]| a != b && b != c && c != a)
        .collect();
    let faces: Vec<ClipFaces> = points.iter().map(|p| quadric.faces_at(*p)).collect();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for (number, triangle) in triangles.iter().enumerate() {
        triangle.iter().for_each(|&corner| around[corner].push(number));
    }
    let cells: Vec<DVec3> = points.iter().map(|p| quadric.in_cells(*p, QUADRIC_CELLS)).collect();
    let length = |a: usize, b: usize| cells[a].distance(cells[b]);
    let normal = |[a, b, c]: [usize; 3]| (points[b] - points[a]).cross(points[c] - points[a]);
    // Cosine between the normal of a triangle and that of the shape, whatever way its corners run.
    let cosine = |triangle: [usize; 3]| {
        let middle = triangle.iter().map(|&corner| points[corner]).sum::<DVec3>() / 3.0;
        normal(triangle).normalize_or_zero().dot(quadric.settle(middle, ClipFaces::default()).1)
    };
    let mut rounds = 0;
    loop {
        let mut short: Vec<(f64, usize, usize)> = Vec::new();
        for &[a, b, c] in triangles.iter().filter(|triangle| triangle[0] != triangle[1]) {
            let sides = [[a, b], [b, c], [c, a]].map(|[a, b]| (length(a, b), a.min(b), a.max(b)));
            short.extend(sides.into_iter().filter(|side| side.0 < SHORT));
        }
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        short.dedup();
        let mut has_changed = false;
        for (_, a, b) in short {
            for (gone, kept) in [(b, a), (a, b)] {
                let between: Vec<usize> =
                    around[gone].iter().copied().filter(|&number| triangles[number].contains(&kept)).collect();
                // On an edge of the clip box, points move along this edge only.
                let is_along = faces[gone].and(faces[kept]) == faces[gone];
                let is_edge = |gone: usize, other: usize| {
                    around[gone].iter().filter(|&&number| triangles[number].contains(&other)).count() == 1
                };
                let neighbours = |of: usize| {
                    let all: BTreeSet<usize> = around[of].iter().flat_map(|&number| triangles[number]).collect();
                    all
                };
                let is_at_edge = neighbours(gone).into_iter().any(|other| other != gone && is_edge(gone, other));
                if between.is_empty() || !is_along || (is_at_edge && between.len() != 1) {
                    continue;
                }
                // Two points that have other neighbours in common would fold the surface.
                if neighbours(gone).intersection(&neighbours(kept)).count() != between.len() + 2 {
                    continue;
                }
                let moved = |number: usize| with_corner(triangles[number], gone, kept);
                let is_good = around[gone].iter().filter(|number| !between.contains(number)).all(|&number| {
                    let (before, after) = (cosine(triangles[number]), cosine(moved(number)));
                    let is_sliver = before.abs() < LEAST_COSINE;
                    after.abs() >= LEAST_COSINE && (is_sliver || before * after > 0.0)
                });
                if !is_good {
                    continue;
                }
                for number in std::mem::take(&mut around[gone]) {
                    if between.contains(&number) {
                        let corners = std::mem::take(&mut triangles[number]);
                        corners.iter().filter(|&&corner| corner != gone).for_each(|&corner| {
                            around[corner].retain(|&other| other != number);
                        });
                    } else {
                        triangles[number] = with_corner(triangles[number], gone, kept);
                        around[kept].push(number);
                    }
                }
                has_changed = true;
                break;
            }
        }
        has_changed |= flip(&mut triangles, &mut around, &cells, &cosine);
        rounds += 1;
        if !has_changed || rounds == MOST_ROUNDS {
            break;
        }
    }
    triangles.into_iter().filter(|&[a, b, _]| a != b).map(|triangle| triangle.map(|corner| points[corner])).collect()
}

/// A triangle with another corner in place of one.
fn with_corner(triangle: [usize; 3], from: usize, to: usize) -> [usize; 3] {
    triangle.map(|corner| if corner == from { to } else { corner })
}

/// Flips the sides of a mesh across which two triangles have a circle around one that holds the other, as Delaunay's do not: narrow
/// triangles whose longest side is that of a neighbour go. `cells`: the points, in cells. Returns whether any was flipped.
fn flip(
    triangles: &mut [[usize; 3]],
    around: &mut [Vec<usize>],
    cells: &[DVec3],
    cosine: &impl Fn([usize; 3]) -> f64,
) -> bool {
    let angle = |at: usize, a: usize, b: usize| (cells[a] - cells[at]).angle_between(cells[b] - cells[at]);
    let mut has_changed = false;
    for number in 0..triangles.len() {
        for side in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| triangles[number][(side + i) % 3]);
            if a == b {
                break;
            }
            let other: Vec<usize> =
                around[a].iter().copied().filter(|&other| other != number && triangles[other].contains(&b)).collect();
            let [other] = other[..] else { continue };
            let Some(&d) = triangles[other].iter().find(|&&corner| corner != a && corner != b) else { continue };
            let is_side = around[c].iter().any(|&number| triangles[number].contains(&d));
            if c == d || is_side || angle(c, a, b) + angle(d, a, b) <= std::f64::consts::PI + 1e-6 {
                continue;
            }
            // The new triangles run as the old ones do.
            let new = [with_corner(triangles[number], b, d), with_corner(triangles[other], a, c)];
            let before = [number, other].map(|number| cosine(triangles[number]));
            let after = new.map(cosine);
            let worst = |cosines: [f64; 2]| cosines[0].abs().min(cosines[1].abs());
            let is_turned = |i: usize| before[i].abs() >= LEAST_COSINE && before[i] * after[i] < 0.0;
            if worst(after) < LEAST_COSINE.min(worst(before)) || is_turned(0) || is_turned(1) {
                continue;
            }
            (triangles[number], triangles[other]) = (new[0], new[1]);
            around[b].retain(|&at| at != number);
            around[a].retain(|&at| at != other);
            around[d].push(number);
            around[c].push(other);
            has_changed = true;
            break;
        }
    }
    has_changed
}

/// An icosahedron on the unit sphere whose sides were halved once.
fn ball() -> Vec<[DVec3; 3]> {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(1.0, g), (1.0, -g), (-1.0, g), (-1.0, -g)] {
        corners.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let is_side = |a: DVec3, b: DVec3| (a.distance_squared(b) - 4.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [a, b, c] = [corners[i], corners[j], corners[k]];
                if is_side(a, b) && is_side(b, c) && is_side(c, a) {
                    let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
                    let [a, b, c] = [a, b, c].map(DVec3::normalize);
                    triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]);
                }
            }
        }
    }
    triangles
}
