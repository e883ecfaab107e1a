//! Surfaces as triangles with irradiance at their vertices.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::reflection;
use crate::control::{Cancel, WorkProgress};
use crate::embree::Charge;
use crate::error::{Error, ErrorKind, Result};
use crate::integrator::{Piece, Sites};
use crate::math::{DVec3, Vec3};
use crate::scene::{Scene, SurfaceMesh};
use crate::spectrum::Rgb;

/// Options for the choice of vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexOptions {
    /// Greatest length of a side in scene units, > 0: triangles are subdivided until they satisfy it, all triangles of
    /// a surface alike. `None`: the vertices as they were given.
    pub spacing: Option<f64>,
    /// Most memory that vertices and bake may take together, MiB.
    pub memory: u32,
}

impl Default for VertexOptions {
    fn default() -> Self {
        Self { spacing: None, memory: 4096 }
    }
}

/// A vertex whose irradiance is baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitVertex {
    /// World frame.
    pub position: DVec3,
    /// Unit normal: the shading normal of a smooth surface, else the mean normal of the triangles at the vertex; zero
    /// where there are none.
    pub normal: Vec3,
    /// Index in [`crate::desc::SceneDesc::surfaces`].
    pub surface: u32,
}

/// All surfaces of a scene as triangles whose vertices are baked.
///
/// A vertex represents the part of the surface that is nearest to it: in each triangle around it, the quadrilateral
/// between the vertex, the middles of the two sides and the triangle's centre. Its irradiance is the mean over that
/// part. The sum of area times irradiance is therefore the light that the surface receives, and no irradiance is
/// evaluated in the very corner of a room.
#[derive(Clone, Debug)]
pub struct Vertices {
    vertices: Vec<LitVertex>,
    triangles: Vec<[u32; 3]>,
    /// First vertex of each surface that has any, by the index of the surface.
    firsts: Vec<(u32, u32)>,
    sites: Arc<Sites>,
    /// The vertex of each site.
    numbers: Vec<u32>,
    /// Area of each site.
    areas: Vec<f64>,
    /// Reflectances on the outer and on the inner side, and emitted radiosities, of each surface that has vertices.
    reflections: HashMap<u32, [[Rgb; 2]; 2]>,
    /// The same of each vertex of surfaces on which it varies.
    varying: HashMap<u32, [[Rgb; 2]; 2]>,
    _charge: Option<Arc<Charge>>,
}

/// Approximate fraction of all work that is done when the meshes are there, and when they are subdivided.
const MESHES_END: f64 = 0.2;
const SUBDIVISION_END: f64 = 0.7;

/// Bytes for each vertex, including its sums and results.
const BYTES_PER_VERTEX: u64 = 400;

/// Bytes for each triangle, including its pieces.
const BYTES_PER_TRIANGLE: u64 = 6 * (size_of::<Piece>() as u64 + 24) + 64;

impl Vertices {
    /// The vertices of all surfaces, in the order of the description.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for an invalid spacing and a scene without a surface; `OutOfMemory` past `memory` or
    /// the device's limit; `Cancelled`.
    pub fn new(scene: &Scene, options: &VertexOptions, cancel: &Cancel) -> Result<Self> {
        Self::of_surfaces(scene, options, None, cancel)
    }

    /// The vertices of all surfaces, or of the surface with index `only` in [`crate::desc::SceneDesc::surfaces`].
    ///
    /// # Errors
    /// As for [`Vertices::new`]; also `InvalidScene` where there is no such surface.
    pub fn of_surfaces(scene: &Scene, options: &VertexOptions, only: Option<u32>, cancel: &Cancel) -> Result<Self> {
        Self::make(scene, options, only, &WorkProgress::new(cancel))
    }

    /// The same with a callback `progress`, as in [`super::Atlas::watched`].
    ///
    /// # Errors
    /// As for [`Vertices::of_surfaces`].
    pub fn watched(
        scene: &Scene,
        options: &VertexOptions,
        only: Option<u32>,
        progress: &mut (dyn FnMut(f64) -> ControlFlow<()> + Send),
    ) -> Result<Self> {
        Self::make(scene, options, only, &WorkProgress::by_time(progress))
    }

    fn make(scene: &Scene, options: &VertexOptions, only: Option<u32>, progress: &WorkProgress) -> Result<Self> {
        if let Some(spacing) = options.spacing
            && !(spacing > 0.0 && spacing.is_finite())
        {
            return Err(Error::invalid("spacing", format!("{spacing}; expected a finite length above 0")));
        }
        let limit = u64::from(options.memory) << 20;
        let mut bytes = scene.surface_mesh_bytes() as u64;
        let past = |bytes: u64| {
            let message = format!("{} MiB for vertices are past the limit of {} (memory)", bytes >> 20, options.memory);
            Error::new(ErrorKind::OutOfMemory, message)
        };
        if bytes > limit {
            return Err(past(bytes));
        }
        let meshes_charge = scene.device().charge(usize::try_from(bytes).unwrap_or(usize::MAX))?;
        progress.stage(MESHES_END, scene.surface_mesh_items())?;
        let mut meshes = scene.watched_surface_meshes(progress)?;
        meshes.retain(|mesh| only.is_none_or(|only| mesh.surface == only));
        let subdivisions: Vec<u64> = meshes.iter().map(|mesh| subdivisions(mesh, options.spacing)).collect();
        for (mesh, &n) in meshes.iter().zip(&subdivisions) {
            let triangles = (mesh.triangles.len() as u64).saturating_mul(n.saturating_mul(n));
            // A triangle divided into n x n has at most as many new vertices as triangles.
            let vertices = if n > 1 { triangles.saturating_mul(2) } else { 0 } + mesh.positions.len() as u64;
            bytes = bytes.saturating_add(triangles.saturating_mul(BYTES_PER_TRIANGLE));
            bytes = bytes.saturating_add(vertices.saturating_mul(BYTES_PER_VERTEX));
        }
        if bytes > limit {
            return Err(past(bytes));
        }
        let charge = scene.device().charge(usize::try_from(bytes).unwrap_or(usize::MAX))?;
        progress.stage(SUBDIVISION_END, meshes.iter().map(|mesh| mesh.triangles.len()).sum())?;
        let mut builder = VertexBuilder::default();
        let mut vertices = Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
            firsts: Vec::new(),
            sites: Arc::default(),
            numbers: Vec::new(),
            areas: Vec::new(),
            reflections: HashMap::new(),
            varying: HashMap::new(),
            _charge: charge.map(Arc::new),
        };
        for (mesh, n) in meshes.iter().zip(subdivisions) {
            vertices.add(scene, mesh, n as u32, &mut builder, progress)?;
        }
        drop(meshes_charge);
        if vertices.triangles.is_empty() {
            return Err(Error::new(ErrorKind::InvalidScene, "the scene has no surface whose vertices could be lit"));
        }
        progress.stage(1.0, builder.cells.len())?;
        vertices.finish(&meshes, builder, progress)?;
        Ok(vertices)
    }

    /// Vertices, grouped by surface: of a mesh all as they were given, in that order; of a triangle or quad its
    /// corners; of an analytic shape points of it; then the vertices that subdivision added.
    pub fn vertices(&self) -> &[LitVertex] {
        &self.vertices
    }

    /// Three vertex indices for each triangle, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The vertices of a surface, by its index in [`crate::desc::SceneDesc::surfaces`]; empty where it has none.
    pub fn of_surface(&self, surface: u32) -> std::ops::Range<usize> {
        let Ok(at) = self.firsts.binary_search_by_key(&surface, |(surface, _)| *surface) else { return 0..0 };
        let end = self.firsts.get(at + 1).map_or(self.vertices.len(), |(_, first)| *first as usize);
        self.firsts[at].1 as usize..end
    }

    /// The parts of surfaces that vertices represent; a vertex that belongs to no triangle has none.
    pub fn sites(&self) -> &Arc<Sites> {
        &self.sites
    }

    /// The vertex of each site.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// The area of each site [length^2].
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Distributes values of sites to their vertices; zero for vertices that belong to no triangle.
    pub fn spread(&self, values: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mut spread = vec![[0.0; 3]; self.vertices.len()];
        for (&vertex, value) in self.numbers.iter().zip(values) {
            spread[vertex as usize] = *value;
        }
        spread
    }

    /// Radiosity [W m^-2] on the outer side (`front`) or the inner one of each vertex, from its irradiance on that
    /// side: the light that a diffuse surface reflects, plus what it emits on that side. Mirrors and glass reflect nothing
    /// here.
    pub fn radiosity(&self, irradiance: &[[f32; 3]], front: bool) -> Vec<[f32; 3]> {
        let of = |(number, (vertex, irradiance)): (u32, (&LitVertex, &[f32; 3]))| {
            let own = self.varying.get(&number).or_else(|| self.reflections.get(&vertex.surface));
            let [reflectance, emitted] = own.copied().unwrap_or_default().map(|sides| sides[usize::from(!front)]);
            (reflectance * Rgb::from(*irradiance) + emitted).to_array()
        };
        (0..).zip(self.vertices.iter().zip(irradiance)).map(of).collect()
    }

    /// Adds vertices and triangles of a surface, each triangle divided into n x n.
    fn add(
        &mut self,
        scene: &Scene,
        mesh: &SurfaceMesh,
        n: u32,
        builder: &mut VertexBuilder,
        progress: &WorkProgress,
    ) -> Result<()> {
        let first = self.vertices.len() as u32;
        self.firsts.push((mesh.surface, first));
        let vertex = |position| LitVertex { position, normal: Vec3::ZERO, surface: mesh.surface };
        self.vertices.extend(mesh.positions.iter().map(|&position| vertex(position)));
        let smooth = |number: usize| mesh.normals.as_ref().map_or(Vec3::ZERO, |normals| normals[number]);
        builder.normals.extend((0..mesh.positions.len()).map(|i| (smooth(i).as_dvec3(), DVec3::ZERO)));
        let mut edge_vertices: HashMap<(u32, u32, u32), u32> = HashMap::new();
        let varies = mesh.facets.first().is_some_and(|facet| {
            scene.material(scene.facet_point(facet, 0.0, 0.0).material).is_varying() || scene.emitters().has_textured()
        });
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            progress.check()?;
            progress.spend(1);
            let facet = mesh.facets[i];
            let facet_number = builder.facet_count;
            builder.facet_count += 1;
            let corners = triangle.map(|corner| mesh.positions[corner as usize]);
            let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let fraction = |k: u32| k as f32 / n as f32;
            // Weights of the second and third corner, in units of 1/n.
            let mut number = |j: u32, k: u32| {
                let weights = [n - j - k, j, k];
                if let Some(corner) = weights.iter().position(|&weight| weight == n) {
                    return first + triangle[corner];
                }
                let mut make = || {
                    let point = scene.facet_point(&facet, fraction(j), fraction(k));
                    self.vertices.push(vertex(point.point.p.as_dvec3() + scene.centre()));
                    let ns = if mesh.normals.is_some() { point.ns.as_dvec3() } else { DVec3::ZERO };
                    builder.normals.push((ns, DVec3::ZERO));
                    self.vertices.len() as u32 - 1
                };
                // A vertex on a side belongs to the neighbour too.
                match weights.iter().position(|&weight| weight == 0) {
                    Some(zero) => {
                        let (a, b) = ((zero + 1) % 3, (zero + 2) % 3);
                        let (from, to, at) =
                            if triangle[a] < triangle[b] { (a, b, weights[b]) } else { (b, a, weights[a]) };
                        *edge_vertices.entry((triangle[from], triangle[to], at)).or_insert_with(make)
                    }
                    None => make(),
                }
            };
            // Row by row, because inner vertices belong to several of the small triangles.
            let mut rows: Vec<Vec<u32>> = Vec::with_capacity(n as usize + 1);
            for k in 0..=n {
                rows.push((0..=n - k).map(|j| number(j, k)).collect());
            }
            if varies {
                for (k, row) in (0..).zip(&rows) {
                    for (j, number) in (0..).zip(row) {
                        let at = || reflection(scene, &facet, [fraction(j), fraction(k)]);
                        self.varying.entry(*number).or_insert_with(at);
                    }
                }
            }
            let area = 0.5 * cross.length() / (f64::from(n) * f64::from(n));
            let mut part = |at: [[u32; 2]; 3]| {
                let numbers = at.map(|[j, k]| rows[k as usize][j as usize]);
                for number in numbers {
                    builder.normals[number as usize].1 += cross;
                }
                builder.cells(facet_number, at.map(|[j, k]| [fraction(j), fraction(k)]), numbers, area);
                self.triangles.push(numbers);
            };
            for k in 0..n {
                for j in 0..n - k {
                    part([[j, k], [j + 1, k], [j, k + 1]]);
                    if j + k + 1 < n {
                        part([[j + 1, k], [j + 1, k + 1], [j, k + 1]]);
                    }
                }
            }
        }
        if let Some(facet) = mesh.facets.first() {
            self.reflections.insert(mesh.surface, reflection(scene, facet, [1.0 / 3.0; 2]));
        }
        Ok(())
    }

    fn finish(&mut self, meshes: &[SurfaceMesh], mut builder: VertexBuilder, progress: &WorkProgress) -> Result<()> {
        for (vertex, (smooth, mean)) in self.vertices.iter_mut().zip(builder.normals) {
            let normal = if smooth != DVec3::ZERO { smooth } else { mean };
            vertex.normal = normal.normalize_or_zero().as_vec3a();
        }
        progress.sort(&mut builder.cells, &|a, b| (a.vertex, a.number).cmp(&(b.vertex, b.number)))?;
        let mut pieces = Vec::with_capacity(builder.cells.len());
        let mut starts = vec![0];
        for cells in builder.cells.chunk_by(|a, b| a.vertex == b.vertex) {
            progress.check()?;
            progress.spend(cells.len());
            let whole: f64 = cells.iter().map(|cell| cell.area).sum();
            let mut sum = 0.0;
            for cell in cells {
                sum += cell.area;
                pieces.push(Piece { facet: cell.facet, corners: cell.corners, until: (sum / whole) as f32 });
            }
            if let Some(last) = pieces.last_mut() {
                last.until = 1.0;
            }
            starts.push(u32::try_from(pieces.len()).map_err(|_| {
                Error::new(ErrorKind::OutOfMemory, "the vertices' surroundings are more than can be numbered")
            })?);
            self.numbers.push(cells[0].vertex);
            self.areas.push(whole);
        }
        let facets = meshes.iter().flat_map(|mesh| mesh.facets.iter().copied()).collect();
        self.sites = Arc::new(Sites::new(facets, pieces, starts));
        Ok(())
    }
}

/// Data that is needed only while vertices are built.
#[derive(Default)]
struct VertexBuilder {
    cells: Vec<VertexCell>,
    /// For each vertex, the shading normal and the sum of its triangles' normals.
    normals: Vec<(DVec3, DVec3)>,
    facet_count: u32,
}

/// A part of the area that a vertex represents.
struct VertexCell {
    vertex: u32,
    /// Order of creation.
    number: u32,
    facet: u32,
    corners: [[f32; 2]; 3],
    area: f64,
}

impl VertexBuilder {
    /// Adds the two parts of a triangle that belong to each of its corners.
    fn cells(&mut self, facet: u32, corners: [[f32; 2]; 3], numbers: [u32; 3], area: f64) {
        let mean = |a: [f32; 2], b: [f32; 2]| [0, 1].map(|i| 0.5 * (a[i] + b[i]));
        let centre = [0, 1].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0);
        for i in 0..3 {
            let [own, next, last] = [corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]];
            for corners in [[own, mean(own, next), centre], [own, centre, mean(own, last)]] {
                let number = self.cells.len() as u32;
                self.cells.push(VertexCell { vertex: numbers[i], number, facet, corners, area: area / 6.0 });
            }
        }
    }
}

/// Number of parts into which the sides of a mesh's triangles are divided.
fn subdivisions(mesh: &SurfaceMesh, spacing: Option<f64>) -> u64 {
    let Some(spacing) = spacing else { return 1 };
    let longest = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        })
        .fold(0.0, f64::max);
    // A ratio that is whole except for rounding counts as whole.
    ((longest / spacing - 1e-6).ceil().max(1.0) as u64).min(1 << 20)
}
