//! Elements: the subdivision of a scene's surfaces, and the hierarchy of clusters above them.
//!
//! A *patch* is one side of a triangle of the scene, or of a triangle inscribed in an analytic shape. Patches are the
//! roots of quadtrees of *elements*: halving the sides of an element gives its four children, whose new corners are
//! projected onto the shape where there is one. Above the patches is a binary tree of *clusters*. Elements and clusters
//! are nodes of one array.
//!
//! Corners are vertices that neighbours on flat and smooth surfaces share, so that the solution is continuous over
//! them. A hanging vertex lies in the middle of a side that only one neighbour has halved; its value is the mean of the
//! side's ends.

mod clusters;
mod curved;
mod lookup;

use std::collections::HashMap;

use curved::{bend_of, curved_area, middle_on, settle};

use super::albedo::mean_albedos;
use super::form_factor::{self, Outline, quarters};
use super::tessellate::tessellate;
use super::textured::ElementTextures;
use crate::error::{Error, ErrorKind, Result};
use crate::math::{DVec3, HitPoint, Vec3};
use crate::room::check_room;
use crate::scene::{Body, Scene};
use crate::shape::Analytic;
use crate::spectrum::Rgb;

/// Index that stands for "none".
pub(super) const NONE: u32 = u32::MAX;

/// An element or a cluster.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub centre: DVec3,
    /// Unit normal; of a cluster the mean of its normals, or zero.
    pub normal: DVec3,
    pub area: f64,
    /// Radius of a bounding sphere around `centre`.
    pub radius: f64,
    pub parent: u32,
    /// Index of the first child; children follow each other.
    pub first: u32,
    pub children: u32,
    /// The patch that an element belongs to; [`NONE`] for a cluster.
    pub patch: u32,
    /// Vertices of an element. Of a cluster, its patches as a range of [`Elements::order`], and its number.
    pub corners: [u32; 3],
    /// Largest angle between `normal` and the normal of a surface below.
    pub cone: f64,
    /// Area over the area of the flat element, on convex sides; 1 on others.
    pub area_ratio: f64,
    /// Area of the flat element over the area, on hollow sides; 1 on others. The flat element is the opening through which all light
    /// comes and goes; of the light that leaves the element, the rest comes back to it.
    pub opening: f64,
    /// Whether it is a part of a shape that curves towards its normal, as the inner side of a ball does.
    pub is_hollow: bool,
    /// How far the shape reaches behind a hollow element; 0 for others.
    pub depth: f64,
    /// The bends of its sides where it is seen by an outline that follows its shape: as hollow elements are, and those at the edge of a disk.
    pub bends: Option<Box<[DVec3; 3]>>,
    /// Whether another surface touches the element, or its vertices interpolate the irradiance inside badly.
    pub is_discontinuous: bool,
}

impl Node {
    pub fn is_cluster(&self) -> bool {
        self.patch == NONE
    }

    pub fn is_leaf(&self) -> bool {
        self.children == 0
    }

    /// The area from which its light is seen.
    pub fn window(&self) -> f64 {
        self.area * self.opening
    }

    pub fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.children) as usize
    }
}

/// The root of a tree of elements.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub surface: u32,
    pub is_front: bool,
    /// Reflected fraction of irradiance; where textures vary it, each element has its own ([`Elements::albedo`]).
    pub albedo: DVec3,
    /// Emitted radiosity [W m^-2]; where a texture varies it, each element has its own ([`Elements::emitted`]), and this is the mean over
    /// the whole lamp's face.
    pub emitted: DVec3,
    /// Index of the shape that the corners lie on, or [`NONE`].
    pub shape: u32,
    pub node: u32,
    /// Error bound of [`HitPoint`] for points of the patch. On a shape, each point has its own bound.
    pub error: f32,
}

/// The patches of one side of a face.
#[derive(Clone, Copy, Debug, Default)]
struct PatchRange {
    first: u32,
    count: u32,
}

/// All elements and clusters.
#[derive(Debug, Default)]
pub(super) struct Elements {
    pub nodes: Vec<Node>,
    pub patches: Vec<Patch>,
    /// Patches in the order of the cluster tree.
    pub order: Vec<u32>,
    pub clusters: u32,
    /// The root; [`NONE`] where the scene has no patches.
    pub top: u32,
    pub vertices: Vec<DVec3>,
    /// For each vertex, the ends of the side that it halves.
    pub side_ends: Vec<[u32; 2]>,
    middles: HashMap<[u32; 2], u32>,
    shapes: Vec<Analytic>,
    sides: Vec<[PatchRange; 2]>,
    /// Where textures vary albedos or emissions.
    textured: Option<Box<ElementTextures>>,
    /// Square of the longest side below which no element is subdivided.
    min_side2: f64,
    /// Limit of memory, bytes.
    limit: usize,
}

/// The vertices at a position on one side of a surface, each with the normal of its first patch.
type Welds = HashMap<([u64; 3], u32, bool), Vec<(u32, DVec3)>>;

/// Neighbouring patches of a flat surface share vertices where the cosine of their normals is above this.
const FLAT_WELD_COSINE: f64 = 0.9999;
/// The same for a smooth surface, where a smaller cosine is a real edge.
const SMOOTH_WELD_COSINE: f64 = 0.2;

/// Memory of a patch, with its vertices and its part of the clusters.
const BYTES_PER_PATCH: usize = 2 * size_of::<Node>() + size_of::<Patch>() + 200;

/// Number of patches from which on room is asked for whenever there are an eighth more of them.
const FIRST_ROOM: usize = 1 << 10;

/// An element is hollow where its middle lies so far behind its flat element, in its radii.
const FLATNESS: f64 = 1e-6;

/// Sides of elements that are seen by their outline are divided nearer to a point than this, in lengths of the side.
const BEND_DISTANCE: f64 = 1.0;

/// Most levels of subdivision below a patch.
const MAX_DEPTH: u32 = 16;

impl Elements {
    /// The patches of a scene and their clusters. `size`: longest side below which no element is subdivided; `limit`:
    /// bytes.
    pub fn new(scene: &Scene, size: Option<f64>, limit: usize) -> Result<Self> {
        let bounds = &scene.info().bounds;
        let extent = if bounds.is_empty() { 1.0 } else { (bounds.max - bounds.min).length().max(f64::MIN_POSITIVE) };
        let least = size.unwrap_or(extent / 64.0);
        let mut elements = Self { min_side2: least * least, limit, top: NONE, ..Self::default() };
        let bytes = 2 * scene.face_count() * BYTES_PER_PATCH;
        elements.check(bytes)?;
        // Vectors that grow have their old items beside the new ones.
        check_room(bytes.saturating_mul(2))?;
        let albedos: Vec<[DVec3; 2]> = scene.materials().iter().map(|material| mean_albedos(material.mean())).collect();
        elements.textured = ElementTextures::new(scene).map(Box::new);
        let mut welds = Welds::new();
        let mut roots = Vec::new();
        // How many patches and vertices there may be before room is asked for again: shapes have as many as they need, and triangles
        // that share no vertices have three each.
        let mut expected = FIRST_ROOM;
        let emitters = scene.emitters();
        scene.each_face(|face| {
            let (triangles, outer, error, shape, is_smooth) = match &face.body {
                Body::Triangle { corners, normal, error, is_smooth } => {
                    (vec![*corners], Some(normal.as_dvec3()), *error, NONE, *is_smooth)
                }
                Body::Shape(shape) => {
                    let triangles = tessellate(shape);
                    elements.shapes.push(shape.clone());
                    (triangles, None, 0.0, elements.shapes.len() as u32 - 1, true)
                }
            };
            let mut sides = [PatchRange::default(); 2];
            let each_albedo = albedos[face.material as usize];
            for ((is_front, albedo), side) in [true, false].into_iter().zip(each_albedo).zip(&mut sides) {
                let lamp = face.emitter.and_then(|front| if is_front { Some(front) } else { emitters.back_of(front) });
                let radiance = lamp.map_or(Rgb::ZERO, |lamp| emitters.emitters()[lamp as usize].mean_radiance());
                let emitted = std::f64::consts::PI * radiance.to_f64();
                if albedo == DVec3::ZERO && emitted == DVec3::ZERO {
                    continue;
                }
                side.first = elements.patches.len() as u32;
                for corners in &triangles {
                    let Some(flat) = form_factor::normal(corners) else { continue };
                    let outer = outer.unwrap_or_else(|| {
                        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                        elements.shapes[shape as usize].project(middle).1
                    });
                    let normal = if (flat.dot(outer) < 0.0) == is_front { -flat } else { flat };
                    if let Some(textured) = &mut elements.textured {
                        let facet = if shape == NONE { face.facet } else { face.facet.part(*corners) };
                        textured.add_patch(&face, lamp, &facet, *corners);
                    }
                    let least = if is_smooth { SMOOTH_WELD_COSINE } else { FLAT_WELD_COSINE };
                    let corners =
                        corners.map(|p| elements.welded(&mut welds, p, (face.surface, is_front), normal, least));
                    let patch = elements.patches.len() as u32;
                    elements.patches.push(Patch {
                        surface: face.surface,
                        is_front,
                        albedo,
                        emitted,
                        shape,
                        node: NONE,
                        error,
                    });
                    roots.push(elements.element(corners, normal, patch, NONE, None));
                    side.count += 1;
                }
            }
            elements.sides.push(sides);
            let made = roots.len().max(elements.vertices.len());
            if made >= expected {
                check_room(made.saturating_mul(2 * BYTES_PER_PATCH))?;
                expected = made + made / 8;
            }
            elements.check(roots.len() * BYTES_PER_PATCH)
        })?;
        drop(welds);
        // The nodes, twice the numbers of the patches, and the bends of hollow ones once more.
        check_room(roots.len().saturating_mul(2 * size_of::<Node>() + size_of::<[DVec3; 3]>() + 64))?;
        elements.cluster(roots);
        (0..elements.nodes.len()).for_each(|number| elements.add_means(number));
        Ok(elements)
    }

    /// Reflected fraction of the irradiance of an element.
    pub fn albedo(&self, element: u32) -> DVec3 {
        match &self.textured {
            Some(textured) => textured.albedo(element),
            None => self.patches[self.nodes[element as usize].patch as usize].albedo,
        }
    }

    /// Radiosity [W m^-2] that an element emits.
    pub fn emitted(&self, element: u32) -> DVec3 {
        match &self.textured {
            Some(textured) => textured.emitted(element),
            None => self.patches[self.nodes[element as usize].patch as usize].emitted,
        }
    }

    /// Whether textures vary albedos or emissions of elements.
    pub fn is_textured(&self) -> bool {
        self.textured.is_some()
    }

    /// Whether a texture varies the albedo or the emission over the surface of an element.
    pub fn varies(&self, element: u32) -> bool {
        let patch = self.nodes[element as usize].patch;
        self.textured.as_ref().is_some_and(|textured| textured.varies(patch))
    }

    /// Whether a texture varies the emission so much over an element that it has to be divided.
    pub fn is_uneven_lamp(&self, element: u32) -> bool {
        self.textured.as_ref().is_some_and(|textured| textured.is_uneven_lamp(element)) && self.is_divisible(element)
    }

    /// Works out albedo and emission of a new node, after those of all before it.
    fn add_means(&mut self, number: usize) {
        let node = &self.nodes[number];
        let corners = |node: &Node| node.corners.map(|vertex| self.vertices[vertex as usize]);
        let element = self.patches.get(node.patch as usize).map(|patch| (patch, node.patch, corners(node)));
        if let Some(textured) = &mut self.textured {
            textured.add_node(element);
        }
    }

    /// Fails where this many bytes exceed the limit.
    pub fn check(&self, bytes: usize) -> Result<()> {
        if bytes <= self.limit {
            return Ok(());
        }
        let message = format!(
            "radiosity needs more than the {} MiB that radiosityMemory allows, after {} patches and {} elements: allow more, or \
             a larger radiosityError or radiosityElementSize",
            self.limit >> 20,
            self.patches.len(),
            self.nodes.len()
        );
        Err(Error::new(ErrorKind::OutOfMemory, message))
    }

    /// Memory of the elements, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Node>() * self.nodes.len()
            + size_of::<Patch>() * self.patches.len()
            // A vertex takes its position, its ends and its entry in the table of midpoints.
            + (24 + 8 + 24) * self.vertices.len()
            + size_of::<[PatchRange; 2]>() * self.sides.len()
            + self.textured.as_ref().map_or(0, |textured| textured.bytes())
    }

    fn vertex(&mut self, p: DVec3, ends: [u32; 2]) -> u32 {
        self.vertices.push(p);
        self.side_ends.push(ends);
        self.vertices.len() as u32 - 1
    }

    fn welded(&mut self, welds: &mut Welds, p: DVec3, side: (u32, bool), normal: DVec3, least: f64) -> u32 {
        // Adding zero turns negative zero into positive zero.
        let key = ((p + DVec3::ZERO).to_array().map(f64::to_bits), side.0, side.1);
        let here = welds.entry(key).or_default();
        if let Some((vertex, _)) = here.iter().find(|(_, other)| other.dot(normal) > least) {
            return *vertex;
        }
        let vertex = self.vertices.len() as u32;
        here.push((vertex, normal));
        self.vertex(p, [NONE; 2])
    }

    pub fn triangle(&self, node: &Node) -> [DVec3; 3] {
        node.corners.map(|vertex| self.vertices[vertex as usize])
    }

    pub fn shape(&self, patch: u32) -> Option<&Analytic> {
        self.shapes.get(self.patches[patch as usize].shape as usize)
    }

    /// An element with these corners. `area` is its area where the area of a flat element is known.
    fn element(&self, corners: [u32; 3], normal: DVec3, patch: u32, parent: u32, area: Option<f64>) -> Node {
        let [a, b, c] = corners.map(|vertex| self.vertices[vertex as usize]);
        let centre = (a + b + c) / 3.0;
        let flat = 0.5 * (b - a).cross(c - a).length();
        let radius = [a, b, c].iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
        let (mut whole, mut area_ratio, mut opening) = (area.unwrap_or(flat), 1.0, 1.0);
        let (mut is_hollow, mut depth, mut bends) = (false, 0.0, None);
        if let Some(shape) = self.shape(patch) {
            whole = curved_area(shape, &[a, b, c]);
            // Convex sides are seen from far away, where their area counts. Hollow sides surround their receivers, which see their
            // outlines.
            // Along the normal of the shape: that of a narrow triangle may be far from it.
            let (middle, outer) = settle(shape, centre);
            let bulge = (middle - centre).dot(if outer.dot(normal) < 0.0 { -outer } else { outer });
            if bulge > 0.0 && flat > 0.0 {
                area_ratio = whole / flat;
            }
            is_hollow = bulge < -FLATNESS * radius;
            if is_hollow && whole > 0.0 {
                opening = (flat / whole).min(1.0);
                depth = -bulge;
            }
            let is_outlined = is_hollow
                || matches!(shape, Analytic::Disk(disk) if [a, b, c].iter().filter(|p| disk.is_on_edge(**p)).count() == 2);
            bends = is_outlined.then(|| Box::new([[a, b], [b, c], [c, a]].map(|[a, b]| bend_of(shape, a, b))));
        }
        Node {
            centre,
            normal,
            area: whole,
            radius,
            parent,
            first: 0,
            children: 0,
            patch,
            corners,
            cone: 0.0,
            area_ratio,
            opening,
            is_hollow,
            depth,
            bends,
            is_discontinuous: false,
        }
    }

    /// The form factor of a fully visible element from a point with unit normal `n`.
    ///
    /// A hollow element is seen by its outline on the shape, whatever is in between. Neighbours have the same outline where they meet,
    /// whether they are divided or not, so that a point inside a closed shape sees all of it and no more. Flat elements of different
    /// sizes do not close: a small one would look under the edges of larger ones beside it.
    pub fn factor_at(&self, p: DVec3, n: DVec3, node: &Node) -> f64 {
        let corners = self.triangle(node);
        let (shape, bends) = match (self.shape(node.patch), &node.bends) {
            (Some(shape), Some(bends)) => (shape, bends),
            _ => return form_factor::point_to_front(p, n, &corners, node.normal) * node.area_ratio,
        };
        let [a, b, c] = corners;
        let mut outline = Outline::<true>::begin(p, n, a);
        let sides = [[a, b], [b, c], [c, a]];
        for (ends, bend) in sides.into_iter().zip(bends.iter()) {
            self.go_along(shape, &mut outline, ends, p, Some(*bend), MAX_DEPTH);
        }
        let is_clockwise = (b - a).cross(c - a).dot(node.normal) < 0.0;
        let factor = outline.end();
        (if is_clockwise { -factor } else { factor }).clamp(0.0, 1.0)
    }

    /// The unit normal of an element at one of its corners: that of the shape where it is hollow.
    pub fn normal_at(&self, corner: DVec3, node: &Node) -> DVec3 {
        match self.shape(node.patch) {
            Some(shape) if node.is_hollow => {
                let (_, outer) = shape.project(corner);
                if self.patches[node.patch as usize].is_front { outer } else { -outer }
            }
            _ => node.normal,
        }
    }

    /// Follows the side of an element along its shape. The side is halved as those of its children are until it is short for its distance
    /// from `p`, and there has one bend, `bend` where it is known.
    fn go_along(
        &self,
        shape: &Analytic,
        outline: &mut Outline<true>,
        [a, b]: [DVec3; 2],
        p: DVec3,
        bend: Option<DVec3>,
        levels: u32,
    ) {
        let middle = 0.5 * (a + b);
        let length2 = a.distance_squared(b);
        let is_far = length2 <= p.distance_squared(middle) / (BEND_DISTANCE * BEND_DISTANCE);
        if levels == 0 || is_far || length2 <= 0.25 * self.min_side2 {
            outline.go_to(bend.unwrap_or_else(|| bend_of(shape, a, b)));
            return outline.go_to(b);
        }
        let middle = middle_on(shape, a, b);
        self.go_along(shape, outline, [a, middle], p, None, levels - 1);
        self.go_along(shape, outline, [middle, b], p, None, levels - 1);
    }

    /// Whether an element has children, or may be subdivided.
    pub fn is_divisible(&self, number: u32) -> bool {
        let node = &self.nodes[number as usize];
        if !node.is_leaf() {
            return true;
        }
        let [a, b, c] = self.triangle(node);
        let longest2 = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        // Sides are not halved where rounding would make a half degenerate.
        let reach = a.abs().max(b.abs()).max(c.abs()).max_element();
        longest2 > self.min_side2 && longest2 > (1e-11 * reach).powi(2) && self.depth(number) < MAX_DEPTH
    }

    fn depth(&self, mut number: u32) -> u32 {
        let mut depth = 0;
        while self.nodes[number as usize].parent != NONE
            && !self.nodes[self.nodes[number as usize].parent as usize].is_cluster()
        {
            number = self.nodes[number as usize].parent;
            depth += 1;
        }
        depth
    }

    /// The children of a node, which is subdivided now if it has none.
    pub fn children_of(&mut self, number: u32) -> std::ops::Range<u32> {
        if self.nodes[number as usize].is_leaf() {
            self.subdivide(number);
        }
        let node = &self.nodes[number as usize];
        debug_assert_ne!(node.children, 0);
        node.first..node.first + node.children
    }

    /// The parent of a node, where that is an element.
    pub fn parent_element(&self, number: u32) -> Option<u32> {
        let parent = self.nodes[number as usize].parent;
        (parent != NONE && !self.nodes[parent as usize].is_cluster()).then_some(parent)
    }

    /// Subdivides an element that has no children into [corner, corner, corner, middle], each with its corners in the
    /// same order.
    fn subdivide(&mut self, number: u32) {
        let Node { corners: [a, b, c], normal, patch, area, .. } = self.nodes[number as usize];
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|ends| self.middle(ends, patch));
        let first = self.nodes.len() as u32;
        let is_flat = self.shape(patch).is_none();
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]] {
            let own = form_factor::normal(&corners.map(|vertex| self.vertices[vertex as usize])).unwrap_or(normal);
            let normal = match is_flat {
                true => normal,
                false if own.dot(normal) < 0.0 => -own,
                false => own,
            };
            let child = self.element(corners, normal, patch, number, is_flat.then_some(0.25 * area));
            self.nodes.push(child);
            self.add_means(self.nodes.len() - 1);
        }
        let node = &mut self.nodes[number as usize];
        (node.first, node.children) = (first, 4);
    }

    /// The vertex in the middle of a side, which is added where it does not exist.
    fn middle(&mut self, mut ends: [u32; 2], patch: u32) -> u32 {
        ends.sort_unstable();
        if let Some(vertex) = self.middles.get(&ends) {
            return *vertex;
        }
        let [a, b] = ends.map(|end| self.vertices[end as usize]);
        let p = self.shape(patch).map_or_else(|| 0.5 * (a + b), |shape| middle_on(shape, a, b));
        let vertex = self.vertex(p, ends);
        self.middles.insert(ends, vertex);
        vertex
    }

    /// The vertex in the middle of a side, where an element has halved that side.
    pub fn known_middle(&self, mut ends: [u32; 2]) -> Option<u32> {
        ends.sort_unstable();
        self.middles.get(&ends).copied()
    }

    /// A point of an element by barycentric coordinates, as the origin of rays, and the normal there on the element's
    /// side. The point is on the shape where there is one.
    pub fn point(&self, node: &Node, [s, t]: [f64; 2]) -> (HitPoint, Vec3) {
        let [a, b, c] = self.triangle(node);
        let p = a + s * (b - a) + t * (c - a);
        match self.shape(node.patch) {
            None => {
                let error = self.patches[node.patch as usize].error;
                (HitPoint::new(p.as_vec3a(), error), node.normal.as_vec3a())
            }
            Some(shape) => {
                let (p, outer) = settle(shape, p);
                let n = if self.patches[node.patch as usize].is_front { outer } else { -outer }.as_vec3a();
                let p = p.as_vec3a();
                (HitPoint::new(p, HitPoint::rounding_error(p, n)), n)
            }
        }
    }

    /// The irradiance of a leaf, given the mean irradiance `gathered` of its opening by other elements. What the leaf reflects and does
    /// not leave through the opening comes back to it.
    pub fn kept(&self, leaf: u32, gathered: DVec3, sampled: DVec3) -> DVec3 {
        let opening = self.nodes[leaf as usize].opening;
        if opening == 1.0 {
            return gathered + sampled;
        }
        (opening * gathered + sampled) / (1.0 - (1.0 - opening) * self.albedo(leaf))
    }
}

pub(super) fn empty() -> Node {
    Node {
        centre: DVec3::ZERO,
        normal: DVec3::ZERO,
        area: 0.0,
        radius: 0.0,
        parent: NONE,
        first: 0,
        children: 0,
        patch: NONE,
        corners: [0; 3],
        cone: 0.0,
        area_ratio: 1.0,
        opening: 1.0,
        is_hollow: false,
        depth: 0.0,
        bends: None,
        is_discontinuous: false,
    }
}

/// The centres of a triangle's quarters: a quadrature rule whose points the quarters share.
pub(super) fn quarter_centres(triangle: &[DVec3; 3]) -> [DVec3; 4] {
    quarters(triangle).map(|[a, b, c]| (a + b + c) / 3.0)
}
