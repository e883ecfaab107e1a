//! Charts: parts of surfaces that are projected to a plane without overlaps.

use std::collections::{HashMap, VecDeque};

use super::overlap::{OverlapGrid, PlanarTriangle};
use crate::Result;
use crate::control::WorkProgress;
use crate::math::DVec3;
use crate::scene::SurfaceMesh;

/// A part of a surface, projected to a plane.
#[derive(Debug)]
pub(super) struct Chart {
    /// Index of the surface's mesh among the given meshes.
    pub mesh: usize,
    /// Indices of its triangles in that mesh.
    pub triangles: Vec<u32>,
    /// The corners of each triangle in the plane, in units of `unit`, from (0, 0) up to `size`.
    pub flat: Vec<PlanarTriangle>,
    /// Width and height in the plane.
    pub size: [f64; 2],
    /// Length in the scene of one unit of the plane.
    pub unit: f64,
    /// Whether the plane is that of the mesh's own texture coordinates.
    pub uses_mesh_uvs: bool,
}

/// An overlap that is less deep than this does not count, in units of a chart's largest triangle.
const TOLERANCE: f64 = 1e-9;

/// Corners, normal and area of a triangle.
struct Face {
    corners: [DVec3; 3],
    normal: DVec3,
    area: f64,
}

impl Face {
    fn new(mesh: &SurfaceMesh, triangle: [u32; 3]) -> Self {
        let corners = triangle.map(|corner| mesh.positions[corner as usize]);
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        Self { corners, normal: cross.normalize_or_zero(), area: 0.5 * cross.length() }
    }
}

/// Divides a mesh into charts. A chart's triangles are connected by their sides, and their normals are within an angle
/// of that of the first triangle, which is the largest one left. They are projected along that normal. A triangle that
/// would overlap another one is left for another chart.
///
/// `cos_angle`: cosine of the angle, above 0. A unit of work is a triangle.
pub(super) fn grow(
    number: usize,
    mesh: &SurfaceMesh,
    cos_angle: f64,
    progress: &WorkProgress,
    charts: &mut Vec<Chart>,
) -> Result<()> {
    let count = mesh.triangles.len();
    let faces: Vec<Face> = mesh.triangles.iter().map(|&triangle| Face::new(mesh, triangle)).collect();
    let neighbours = neighbours(mesh, progress)?;
    let mut order: Vec<u32> = (0..count as u32).collect();
    progress.sort(&mut order, &|&a, &b| faces[b as usize].area.total_cmp(&faces[a as usize].area).then(a.cmp(&b)))?;
    let mean_length = faces.iter().map(|face| face.area.sqrt()).sum::<f64>() / count.max(1) as f64;
    let mut is_taken = vec![false; count];
    for seed in order {
        if is_taken[seed as usize] {
            continue;
        }
        let axis = faces[seed as usize].normal;
        let (right, above) = axis.any_orthonormal_pair();
        let origin = faces[seed as usize].corners[0];
        let project = |face: &Face| face.corners.map(|p| [(p - origin).dot(right), (p - origin).dot(above)]);
        let tolerance = TOLERANCE * extent(&project(&faces[seed as usize]));
        // The seed is the largest triangle left. Its size limits the cells, so that fine detail is not in one cell
        // because of coarse triangles elsewhere.
        let mut cover = OverlapGrid::new(2.0 * mean_length.min(faces[seed as usize].area.sqrt()), tolerance);
        let mut chart = Chart {
            mesh: number,
            triangles: Vec::new(),
            flat: Vec::new(),
            size: [0.0; 2],
            unit: 1.0,
            uses_mesh_uvs: false,
        };
        let mut waiting = VecDeque::from([seed]);
        while let Some(next) = waiting.pop_front() {
            progress.check()?;
            let face = &faces[next as usize];
            if is_taken[next as usize] || face.normal.dot(axis) < cos_angle {
                continue;
            }
            let flat = project(face);
            // The first triangle is accepted even if its normal fails the test by rounding.
            if next != seed && cover.find_overlap(&flat).is_some() {
                continue;
            }
            progress.spend(1);
            is_taken[next as usize] = true;
            cover.add(flat, next);
            chart.triangles.push(next);
            chart.flat.push(flat);
            waiting.extend(neighbours[next as usize].iter().copied().filter(|&other| other != u32::MAX));
        }
        // A normal whose length is not exactly 1 must not keep the first triangle out of its own chart.
        if chart.triangles.is_empty() {
            is_taken[seed as usize] = true;
            chart.triangles.push(seed);
            chart.flat.push(project(&faces[seed as usize]));
        }
        align(&mut chart, progress)?;
        charts.push(chart);
    }
    Ok(())
}

fn extent(flat: &PlanarTriangle) -> f64 {
    flat.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The triangle beyond each side of each triangle, or `u32::MAX`, for sides that exactly two triangles with the same
/// winding share. Vertices at the same position count as one.
fn neighbours(mesh: &SurfaceMesh, progress: &WorkProgress) -> Result<Vec<[u32; 3]>> {
    let mut welded: HashMap<[u64; 3], u32> = HashMap::with_capacity(mesh.positions.len());
    let mut place: Vec<u32> = Vec::with_capacity(mesh.positions.len());
    for p in &mesh.positions {
        progress.check()?;
        let next = welded.len() as u32;
        // Negative and positive zero are the same.
        place.push(*welded.entry(p.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next));
    }
    drop(welded);
    let mut sides: Vec<([u32; 2], bool, u32, u8)> = Vec::with_capacity(3 * mesh.triangles.len());
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        for side in 0..3 {
            let (a, b) = (place[triangle[side] as usize], place[triangle[(side + 1) % 3] as usize]);
            sides.push(([a.min(b), a.max(b)], a < b, number as u32, side as u8));
        }
    }
    progress.sort(&mut sides, &Ord::cmp)?;
    let mut neighbours = vec![[u32::MAX; 3]; mesh.triangles.len()];
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        if let &[(_, forwards, a, a_side), (_, other_forwards, b, b_side)] = same
            && forwards != other_forwards
            && a != b
        {
            neighbours[a as usize][usize::from(a_side)] = b;
            neighbours[b as usize][usize::from(b_side)] = a;
        }
    }
    Ok(neighbours)
}

/// Rotates a chart so that its bounding box is small and not higher than wide, and moves it to the origin.
fn align(chart: &mut Chart, progress: &WorkProgress) -> Result<()> {
    let hull = hull(chart.flat.iter().flatten().copied().collect(), progress)?;
    let mut best: Option<(f64, [f64; 2])> = None;
    for (i, a) in hull.iter().enumerate() {
        let b = hull[(i + 1) % hull.len()];
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        if length <= 0.0 {
            continue;
        }
        let direction = [dx / length, dy / length];
        let [min, max] = bounds(hull.iter().map(|p| turned(direction, *p)));
        let area = (max[0] - min[0]) * (max[1] - min[1]);
        // The area must be clearly smaller, so that rounding does not decide between equal ones.
        if best.is_none_or(|(least, _)| area < least * (1.0 - 1e-9)) {
            best = Some((area, direction));
        }
        // For an outline with very many corners, a part of them is enough.
        if hull.len() > 512 && i > 64 {
            break;
        }
    }
    let mut direction = best.map_or([1.0, 0.0], |(_, direction)| direction);
    let [min, max] = bounds(hull.iter().map(|p| turned(direction, *p)));
    if max[1] - min[1] > (max[0] - min[0]) * (1.0 + 1e-9) {
        direction = [-direction[1], direction[0]];
    }
    let [min, max] = bounds(hull.iter().map(|p| turned(direction, *p)));
    for corner in chart.flat.iter_mut().flatten() {
        let [x, y] = turned(direction, *corner);
        *corner = [(x - min[0]).max(0.0), (y - min[1]).max(0.0)];
    }
    chart.size = [max[0] - min[0], max[1] - min[1]];
    Ok(())
}

/// Coordinates along `direction` and across it.
fn turned([c, s]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [c * x + s * y, c * y - s * x]
}

/// Smallest and largest coordinates.
pub(super) fn bounds(points: impl Iterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[min, max], [x, y]| {
        [[min[0].min(x), min[1].min(y)], [max[0].max(x), max[1].max(y)]]
    })
}

/// The convex hull, counter-clockwise. Source: Andrew 1979, "Another Efficient Algorithm for Convex Hulls in Two
/// Dimensions".
fn hull(mut points: Vec<[f64; 2]>, progress: &WorkProgress) -> Result<Vec<[f64; 2]>> {
    progress.sort(&mut points, &|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])))?;
    points.dedup();
    if points.len() < 3 {
        return Ok(points);
    }
    let is_left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() >= 2 && !is_left(chain[chain.len() - 2], chain[chain.len() - 1], p) {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    Ok(hull)
}
