//! Light-map coordinates for all surfaces of a scene: a square of texels in which every point of the surfaces has its
//! own place.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::chart::{self, Chart};
use super::mesh_uvs;
use super::mesh_uvs::doubled_area;
use super::options::{AtlasOptions, Layout, MAX_GUTTER, MAX_SIDE};
use super::placement::{ChartPlacement, ChartRect};
use super::raster;
use crate::control::{Cancel, WorkProgress};
use crate::embree::Charge;
use crate::error::{Error, ErrorKind, Result};
use crate::integrator::{Piece, Sites};
use crate::math::{DVec3, Vec3};
use crate::scene::{Scene, SurfaceMesh};

/// A corner of a light-mapped triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtlasVertex {
    /// World frame.
    pub position: DVec3,
    /// Unit normal: the shading normal of a smooth surface, else the mean normal of the chart's triangles at the
    /// vertex.
    pub normal: Vec3,
    /// Position in the light map, in [0, 1]^2: (0, 0) is the outer corner of the first texel of row 0, (1, 1) that of
    /// the last texel of the last row.
    pub uv: [f32; 2],
    /// Index of the vertex in the mesh as it was given; of a triangle or quad, index of the corner; of an analytic
    /// shape, a running number.
    pub source: u32,
}

/// A surface in a light map.
#[derive(Clone, Debug, PartialEq)]
pub struct AtlasSurface {
    /// Index in [`crate::desc::SceneDesc::surfaces`].
    pub surface: u32,
    /// Range of its vertices in [`Atlas::vertices`].
    pub vertices: std::ops::Range<u32>,
    /// Range of its triangles in [`Atlas::triangles`].
    pub triangles: std::ops::Range<u32>,
    /// Where the mesh's own texture coordinates are the layout: (u, v) times the first two values, plus the others, is
    /// the position in the light map.
    pub scale_offset: Option<[f32; 4]>,
}

/// Light-map coordinates for all surfaces of a scene.
#[derive(Clone, Debug)]
pub struct Atlas {
    side: u32,
    texels_per_unit: f64,
    padding: u32,
    surfaces: Vec<AtlasSurface>,
    vertices: Vec<AtlasVertex>,
    triangles: Vec<[u32; 3]>,
    primitives: Vec<u32>,
    chart_numbers: Vec<u32>,
    charts: Vec<ChartRect>,
    sites: Arc<Sites>,
    texels: Vec<u32>,
    coverage: Vec<f32>,
    warnings: Vec<String>,
    _charge: Option<Arc<Charge>>,
}

/// Bytes for a texel while it is baked, besides its pieces: sums of the film, results, and their copies.
const BYTES_PER_SITE: u64 = 320;

/// Bytes for each texel of the square, covered or not.
const BYTES_PER_TEXEL: u64 = 40;

/// Approximate number of packings until the density of the charts is found.
const PACKING_ATTEMPTS: usize = 12;

/// Approximate fraction of all work that is done when each stage ends.
mod stage {
    pub const MESHES: f64 = 0.05;
    pub const CHARTS: f64 = 0.5;
    pub const PLACEMENT: f64 = 0.6;
    pub const COUNT: f64 = 0.7;
    pub const TRIANGLES: f64 = 0.75;
    pub const FRAGMENTS: f64 = 0.9;
    pub const SITES: f64 = 1.0;
}

impl Atlas {
    /// Lays out all surfaces of a scene.
    ///
    /// The same scene and options give the same atlas.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for options out of their range, a scene without a surface, charts that do not fit,
    /// and unsuitable texture coordinates if [`Layout::Own`] requires them; `OutOfMemory` past `memory` or the device's
    /// limit; `Cancelled`.
    pub fn new(scene: &Scene, options: &AtlasOptions, cancel: &Cancel) -> Result<Self> {
        Self::make(scene, options, &WorkProgress::new(cancel))
    }

    /// Lays out all surfaces of a scene, with a callback. `progress` is called on this thread about ten times a second,
    /// and once at the beginning, with the fraction of the work that is done, which only grows. `Break` stops the work.
    ///
    /// # Errors
    /// As for [`Atlas::new`].
    pub fn watched(
        scene: &Scene,
        options: &AtlasOptions,
        progress: &mut (dyn FnMut(f64) -> ControlFlow<()> + Send),
    ) -> Result<Self> {
        Self::make(scene, options, &WorkProgress::by_time(progress))
    }

    fn make(scene: &Scene, options: &AtlasOptions, progress: &WorkProgress) -> Result<Self> {
        options.check()?;
        let limit = u64::from(options.memory) << 20;
        let mut bytes = scene.surface_mesh_bytes() as u64;
        let fits = |bytes: u64, what: &str| {
            if bytes <= limit {
                return Ok(());
            }
            let message =
                format!("{what} takes {} MiB, past the limit of {} (memory)", bytes.div_ceil(1 << 20), options.memory);
            Err(Error::new(ErrorKind::OutOfMemory, message))
        };
        // Charts and the atlas's own vertices take several times the memory of the meshes.
        bytes = bytes.saturating_mul(5);
        fits(bytes, "a light map of all triangles")?;
        let meshes_charge = scene.device().charge(usize::try_from(bytes).unwrap_or(usize::MAX))?;
        progress.stage(stage::MESHES, scene.surface_mesh_items())?;
        let meshes = scene.watched_surface_meshes(progress)?;
        if meshes.iter().all(|mesh| mesh.triangles.is_empty()) {
            return Err(Error::new(ErrorKind::InvalidScene, "the scene has no surface to make a light map for"));
        }
        let mut warnings = Vec::new();
        let triangles = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        progress.stage(stage::CHARTS, triangles)?;
        let charts = charts(&meshes, options, &mut warnings, progress)?;
        progress.stage(stage::PLACEMENT, PACKING_ATTEMPTS.saturating_mul(charts.len()))?;
        let placement = ChartPlacement::find(&charts, options, progress)?;

        let texels = u64::from(placement.side) * u64::from(placement.side);
        // The least memory is known at once; the rest is known after a pass over all texels.
        let least = texels.saturating_mul(BYTES_PER_TEXEL);
        let what = format!("a light map of {0} x {0} texels", placement.side);
        fits(bytes.saturating_add(least), &what)?;
        drop(scene.device().charge(usize::try_from(least).unwrap_or(usize::MAX))?);
        progress.stage(stage::COUNT, triangles)?;
        let (pieces, sites_at_most) = count_pieces(&charts, &placement, progress)?;
        let wanted = pieces
            .saturating_mul((size_of::<Piece>() + size_of::<TexelFragment>()) as u64)
            .saturating_add(sites_at_most.saturating_mul(BYTES_PER_SITE))
            .saturating_add(least);
        fits(bytes.saturating_add(wanted), &what)?;
        let charge = scene.device().charge(usize::try_from(wanted).unwrap_or(usize::MAX))?;

        let mut atlas = Self {
            side: placement.side,
            texels_per_unit: placement.density,
            padding: options.gutter.max(1),
            surfaces: Vec::new(),
            vertices: Vec::new(),
            triangles: Vec::new(),
            primitives: Vec::new(),
            chart_numbers: Vec::new(),
            charts: placement.rects.clone(),
            sites: Arc::default(),
            texels: Vec::new(),
            coverage: Vec::new(),
            warnings,
            _charge: charge.map(Arc::new),
        };
        progress.stage(stage::TRIANGLES, triangles)?;
        atlas.add_triangles(&meshes, &charts, &placement, progress)?;
        progress.stage(stage::FRAGMENTS, pieces as usize)?;
        let fragments = texel_fragments(&meshes, &charts, &placement, pieces as usize, progress)?;
        progress.stage(stage::SITES, pieces as usize)?;
        atlas.build_sites(&meshes, fragments, progress)?;
        drop(meshes_charge);
        Ok(atlas)
    }

    /// Texels along a side of the square.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// Texels for a unit of length, along the plane of a chart; the mean for meshes with their own layout.
    pub fn texels_per_unit(&self) -> f64 {
        self.texels_per_unit
    }

    /// Surfaces in the order of the description, except those without area.
    pub fn surfaces(&self) -> &[AtlasSurface] {
        &self.surfaces
    }

    /// Vertices, grouped by surface. A vertex on the seam of two charts occurs once for each.
    pub fn vertices(&self) -> &[AtlasVertex] {
        &self.vertices
    }

    /// Three vertex indices for each triangle, counter-clockwise seen from outside, grouped by surface and in the order
    /// in which they were given. Triangles without area are left out.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Index of each triangle in its mesh as it was given; 0 or 1 for the half of a quad; a running number for analytic
    /// shapes.
    pub fn primitives(&self) -> &[u32] {
        &self.primitives
    }

    /// Index of each triangle's chart.
    pub fn chart_numbers(&self) -> &[u32] {
        &self.chart_numbers
    }

    /// The rectangles of the charts; no two have a texel in common.
    pub fn charts(&self) -> &[ChartRect] {
        &self.charts
    }

    /// Distance in texels over which covered texels are copied to uncovered ones: the gutter, at least one.
    pub fn padding(&self) -> u32 {
        self.padding
    }

    /// The part of the surfaces that each covered texel covers. Facets have the indices of [`Atlas::triangles`].
    pub fn sites(&self) -> &Arc<Sites> {
        &self.sites
    }

    /// The texel of each site: row times side plus column.
    pub fn texels(&self) -> &[u32] {
        &self.texels
    }

    /// Fraction of each site's texel that triangles cover, in (0, 1].
    pub fn coverage(&self) -> &[f32] {
        &self.coverage
    }

    /// Warnings: texture coordinates that were not used, and the reason.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The position in the light map of a point of a triangle, by the weights of its second and third corner.
    pub fn uv(&self, triangle: usize, [b1, b2]: [f32; 2]) -> [f32; 2] {
        let [a, b, c] = self.triangles[triangle].map(|corner| self.vertices[corner as usize].uv);
        [0, 1].map(|i| a[i] + b1 * (b[i] - a[i]) + b2 * (c[i] - a[i]))
    }

    /// Adds vertices and triangles, surface by surface.
    fn add_triangles(
        &mut self,
        meshes: &[SurfaceMesh],
        charts: &[Chart],
        placement: &ChartPlacement,
        progress: &WorkProgress,
    ) -> Result<()> {
        let side = f64::from(placement.side);
        let mut first_chart = 0;
        for (number, mesh) in meshes.iter().enumerate() {
            progress.check()?;
            let own_charts = charts[first_chart..].iter().take_while(|chart| chart.mesh == number).count();
            let range = first_chart..first_chart + own_charts;
            first_chart = range.end;
            if mesh.triangles.is_empty() {
                continue;
            }
            // The chart of each triangle, and the triangle's index in the chart.
            let mut places = vec![(0, 0); mesh.triangles.len()];
            for number in range.clone() {
                for (at, &triangle) in charts[number].triangles.iter().enumerate() {
                    places[triangle as usize] = (number, at);
                }
            }
            let (first_vertex, first_triangle) = (self.vertices.len() as u32, self.triangles.len() as u32);
            let mut known: HashMap<(u32, u32), u32> = HashMap::with_capacity(mesh.positions.len());
            let mut normals: Vec<DVec3> = Vec::new();
            progress.each(mesh.triangles.len(), 1.0, |i| {
                let triangle = mesh.triangles[i];
                let (chart, at) = places[i];
                let flat = placement.in_texels(chart, &charts[chart], at);
                let corners = triangle.map(|corner| mesh.positions[corner as usize]);
                let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let mut numbers = [0; 3];
                for corner in 0..3 {
                    let source = triangle[corner];
                    numbers[corner] = *known.entry((chart as u32, source)).or_insert_with(|| {
                        self.vertices.push(AtlasVertex {
                            position: corners[corner],
                            normal: Vec3::ZERO,
                            uv: flat[corner].map(|x| (x / side).clamp(0.0, 1.0) as f32),
                            source,
                        });
                        normals.push(DVec3::ZERO);
                        self.vertices.len() as u32 - 1
                    });
                    normals[(numbers[corner] - first_vertex) as usize] += cross;
                }
                self.triangles.push(numbers);
                self.primitives.push(mesh.primitives[i]);
                self.chart_numbers.push(chart as u32);
            })?;
            for (vertex, mean) in self.vertices[first_vertex as usize..].iter_mut().zip(normals) {
                let shading = mesh.normals.as_ref().map_or(Vec3::ZERO, |normals| normals[vertex.source as usize]);
                let is_given = shading != Vec3::ZERO;
                vertex.normal = if is_given { shading } else { mean.normalize_or_zero().as_vec3a() };
            }
            let scale_offset = charts[range.start].uses_mesh_uvs.then(|| {
                let (scale, [x, y]) = (placement.scale(&charts[range.start]), placement.corner(range.start));
                [scale / side, scale / side, x / side, y / side].map(|x| x as f32)
            });
            self.surfaces.push(AtlasSurface {
                surface: mesh.surface,
                vertices: first_vertex..self.vertices.len() as u32,
                triangles: first_triangle..self.triangles.len() as u32,
                scale_offset,
            });
        }
        Ok(())
    }

    /// Builds the sites: the part of the surfaces that each texel covers.
    fn build_sites(
        &mut self,
        meshes: &[SurfaceMesh],
        mut fragments: Vec<TexelFragment>,
        progress: &WorkProgress,
    ) -> Result<()> {
        progress.sort(&mut fragments, &|a, b| (a.key, a.facet, a.order).cmp(&(b.key, b.facet, b.order)))?;
        let mut pieces = Vec::with_capacity(fragments.len());
        let mut starts = vec![0];
        for same in fragments.chunk_by(|a, b| a.texel == b.texel) {
            progress.check()?;
            let whole: f64 = same.iter().map(|fragment| fragment.area).sum();
            let mut sum = 0.0;
            for fragment in same {
                sum += fragment.area;
                pieces.push(Piece { facet: fragment.facet, corners: fragment.corners, until: (sum / whole) as f32 });
            }
            if let Some(last) = pieces.last_mut() {
                last.until = 1.0;
            }
            starts.push(pieces.len() as u32);
            self.texels.push(same[0].texel);
            self.coverage.push(same.iter().map(|fragment| fragment.texels).sum::<f64>().min(1.0) as f32);
            progress.spend(same.len());
        }
        // Facets have the same indices as triangles.
        let facets = meshes.iter().flat_map(|mesh| mesh.facets.iter().copied()).collect();
        self.sites = Arc::new(Sites::new(facets, pieces, starts));
        Ok(())
    }
}

/// The part of a triangle inside one texel.
struct TexelFragment {
    /// Morton code of the texel, by which neighbours stay together.
    key: u32,
    texel: u32,
    facet: u32,
    order: u8,
    corners: [[f32; 2]; 3],
    /// Area in the map [texels].
    texels: f64,
    /// Area in the scene.
    area: f64,
}

/// The triangles of all charts, clipped to texels, in `count` fragments; a unit of work is one fragment.
fn texel_fragments(
    meshes: &[SurfaceMesh],
    charts: &[Chart],
    placement: &ChartPlacement,
    count: usize,
    progress: &WorkProgress,
) -> Result<Vec<TexelFragment>> {
    let mut fragments = Vec::with_capacity(count);
    let mut first = 0;
    let firsts: Vec<u32> = meshes.iter().map(|mesh| (first, first += mesh.facets.len() as u32).0).collect();
    for (number, chart) in charts.iter().enumerate() {
        let mesh = &meshes[chart.mesh];
        for (at, &triangle) in chart.triangles.iter().enumerate() {
            let facet = firsts[chart.mesh] + triangle;
            let flat = placement.rasterizable(number, chart, at);
            // Points of a site are uniform on the surface, not in the map.
            let corners = mesh.triangles[triangle as usize].map(|corner| mesh.positions[corner as usize]);
            let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
            let stretch = area / doubled_area(&flat).abs();
            raster::for_each_texel(&flat, progress, |[x, y], part| {
                for (order, (fan, texels)) in part.fan().enumerate() {
                    let corners = fan.map(|p| raster::weights(&flat, p));
                    let (texel, order) = (y * placement.side + x, order as u8);
                    let (key, area) = (morton_code([x, y]), texels * stretch);
                    fragments.push(TexelFragment { key, texel, order, facet, corners, texels, area });
                    progress.spend(1);
                }
            })?;
        }
    }
    Ok(fragments)
}

/// Morton code of a texel.
fn morton_code([x, y]: [u32; 2]) -> u32 {
    let spread = |x: u32| {
        let x = (x | x << 8) & 0x00ff_00ff;
        let x = (x | x << 4) & 0x0f0f_0f0f;
        let x = (x | x << 2) & 0x3333_3333;
        (x | x << 1) & 0x5555_5555
    };
    spread(x) | spread(y) << 1
}

impl AtlasOptions {
    /// Checks that each option is in its range.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at the option.
    pub(crate) fn check(&self) -> Result<()> {
        let invalid = |path: &str, message: String| Err(Error::invalid(path, message));
        if let Some(side) = self.resolution
            && !(1..=MAX_SIDE).contains(&side)
        {
            return invalid("resolution", format!("{side} texels along a side; expected 1 to {MAX_SIDE}"));
        }
        if let Some(density) = self.texels_per_unit
            && !(density > 0.0 && density.is_finite())
        {
            return invalid("texelsPerUnit", format!("{density}; expected a finite number above 0"));
        }
        if self.gutter > MAX_GUTTER {
            return invalid("gutter", format!("{} texels; expected at most {MAX_GUTTER}", self.gutter));
        }
        let angle = self.max_angle_deg;
        if !(angle > 0.0 && angle < 90.0) {
            return invalid("maxAngle", format!("{angle}; expected degrees between 0 and 90"));
        }
        Ok(())
    }
}

/// The charts of all meshes, those of a mesh together.
fn charts(
    meshes: &[SurfaceMesh],
    options: &AtlasOptions,
    warnings: &mut Vec<String>,
    progress: &WorkProgress,
) -> Result<Vec<Chart>> {
    let cos_angle = options.max_angle_deg.to_radians().cos();
    let mut charts = Vec::new();
    for (number, mesh) in meshes.iter().enumerate() {
        if mesh.triangles.is_empty() {
            continue;
        }
        if mesh.uvs.is_some() && options.layout != Layout::Charts || options.layout == Layout::Own && mesh.is_mesh {
            match mesh_uvs::layout(number, mesh, progress)? {
                Ok(chart) => {
                    charts.push(chart);
                    continue;
                }
                Err(why) if options.layout == Layout::Own => {
                    return Err(Error::invalid(format!("surfaces[{}]", mesh.surface), why));
                }
                Err(why) => warnings.push(format!(
                    "surfaces[{}]: its texture coordinates are no layout of a light map, charts are used instead: {why}",
                    mesh.surface
                )),
            }
        }
        chart::grow(number, mesh, cos_angle, progress, &mut charts)?;
    }
    Ok(charts)
}

/// The number of pieces, and an upper bound on the number of sites.
fn count_pieces(charts: &[Chart], placement: &ChartPlacement, progress: &WorkProgress) -> Result<(u64, u64)> {
    let (mut pieces, mut sites) = (0_u64, 0_u64);
    for (number, chart) in charts.iter().enumerate() {
        for at in 0..chart.triangles.len() {
            raster::for_each_texel(&placement.rasterizable(number, chart, at), progress, |_, part| {
                sites += 1;
                pieces += part.fan().count() as u64;
            })?;
            progress.spend(1);
        }
    }
    if pieces > u64::from(u32::MAX) {
        return Err(Error::new(
            ErrorKind::OutOfMemory,
            format!("{pieces} parts of texels are more than can be numbered"),
        ));
    }
    let texels = u64::from(placement.side) * u64::from(placement.side);
    Ok((pieces, sites.min(texels)))
}
