//! What points of a leaf gather over the links that end at the leaf or above it.

use std::f64::consts::FRAC_1_PI;

use super::elements::{NONE, Node};
use super::light::DirectionalPolynomial;
use super::links::{Link, LinkKind, POINT, intensity, intensity_by, point_factor};
use super::oracle::RefinementOracle;
use super::refine::LinkHierarchy;
use super::rows::Rows;
use crate::math::DVec3;

/// Farther from a point than this, in its radii, an element is treated as a point.
const FAR: f64 = 12.0;

/// A source's radiosity is uneven where it varies by more than this fraction of its mean. At distances below `NEAR`, in
/// radii of the source, the kernel is uneven as well, and its values at the corners do not describe it.
const UNEVEN: f64 = 0.02;
const NEAR: f64 = 2.0;

/// Irradiance that some points of a leaf gather.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered<const N: usize> {
    /// Of lights that are points.
    of_points: [DVec3; N],
    /// Of surfaces.
    of_surfaces: [DVec3; N],
    /// What of this light lamps emit; 0 without rows.
    of_lamps: [DVec3; N],
    /// Of what surfaces reflect, each link times the doubt in it; 0 without rows.
    in_doubt: [DVec3; N],
    /// What surfaces would bring if all radiosities were one, and the same times doubts; 0 without rows.
    row: [f64; N],
    row_in_doubt: [f64; N],
}

impl<const N: usize> Gathered<N> {
    /// Irradiance at a point, as one of lights that are points and one of surfaces. `rows`: those of the leaf's hierarchy, and the leaf's
    /// shift.
    pub fn at(&self, k: usize, leaf: u32, rows: Option<(&Rows, f64)>) -> [DVec3; 2] {
        let of_surfaces = match rows {
            None => self.of_surfaces[k],
            Some((rows, _)) if rows.is_blind(leaf) => self.of_lamps[k],
            Some((_, shift)) => (self.of_surfaces[k] + shift * self.in_doubt[k]).max(DVec3::ZERO),
        };
        [self.of_points[k], of_surfaces]
    }

    /// Adds what a source brings to a point, what it would bring if all radiosities were one, and what of its light it emits.
    fn add(&mut self, k: usize, [light, emitted]: [DVec3; 2], unit: f64, doubt: f64) {
        self.of_surfaces[k] += light;
        self.of_lamps[k] += emitted;
        self.in_doubt[k] += doubt * (light - emitted).max(DVec3::ZERO);
        self.row[k] += unit;
        self.row_in_doubt[k] += doubt * unit;
    }

    /// The row of the leaf and the doubt in it, by weights of the points.
    pub fn row(&self, weights: [f64; N]) -> [f64; 2] {
        let sum = |of: &[f64; N]| of.iter().zip(weights).map(|(row, weight)| row * weight).sum::<f64>();
        [sum(&self.row), sum(&self.row_in_doubt)]
    }
}

/// Irradiance at some points of a leaf by its own links and those of the elements above it, and what clusters bring to the whole leaf.
/// `is_hidden`: links that bring no light; `visible`: the visible fraction of a link's source from one of the points, given the source's
/// strength.
pub(super) fn gather_over<const N: usize>(
    hierarchy: &LinkHierarchy,
    leaf: u32,
    places: &[DVec3; N],
    received: &[DirectionalPolynomial],
    is_hidden: impl Fn(&Link) -> bool,
    visible: &impl Fn(&Link, usize, DVec3) -> f64,
) -> Gathered<N> {
    let elements = &hierarchy.oracle.elements;
    let node = &elements.nodes[leaf as usize];
    let mut gathered = Gathered {
        of_points: [DVec3::ZERO; N],
        of_surfaces: [DVec3::ZERO; N],
        of_lamps: [DVec3::ZERO; N],
        in_doubt: [DVec3::ZERO; N],
        row: [0.0; N],
        row_in_doubt: [0.0; N],
    };
    let mut at = leaf;
    loop {
        for link in hierarchy.links_of(at).iter().filter(|link| link.kind == LinkKind::Element && !is_hidden(link)) {
            gather_at(hierarchy, link, node, places, visible, &mut gathered);
        }
        match elements.parent_element(at) {
            Some(above) => at = above,
            None => break,
        }
    }
    let parent = elements.nodes[at as usize].parent;
    if parent != NONE {
        let cluster = elements.nodes[parent as usize].corners[2] as usize;
        let at_leaf = |of: &[DirectionalPolynomial]| of[cluster].at(node.normal);
        let from_clusters = at_leaf(received);
        match &hierarchy.rows {
            None => gathered.of_surfaces.iter_mut().for_each(|e| *e += from_clusters),
            Some(rows) => {
                let part = |of: &[DirectionalPolynomial]| if of.is_empty() { DVec3::ZERO } else { at_leaf(of) };
                let from_points = part(&rows.from_points).min(from_clusters);
                let from_lamps = part(&rows.from_lamps).min(from_clusters - from_points);
                let (in_doubt, row) = (at_leaf(&rows.in_doubt), at_leaf(&rows.unit));
                for k in 0..N {
                    gathered.of_points[k] += from_points;
                    gathered.of_surfaces[k] += from_clusters - from_points;
                    gathered.of_lamps[k] += from_lamps;
                    gathered.in_doubt[k] += in_doubt;
                    gathered.row[k] += row.x;
                    gathered.row_in_doubt[k] += row.y;
                }
            }
        }
    }
    gathered
}

/// Adds one link's irradiance at some points of a leaf, where the leaf is the link's receiver or below it.
fn gather_at<const N: usize>(
    hierarchy: &LinkHierarchy,
    link: &Link,
    leaf: &Node,
    places: &[DVec3; N],
    visible: &impl Fn(&Link, usize, DVec3) -> f64,
    gathered: &mut Gathered<N>,
) {
    let oracle = &hierarchy.oracle;
    if link.source >= POINT {
        let light = &oracle.lights[(link.source - POINT) as usize];
        for (k, p) in places.iter().enumerate() {
            let factor = point_factor(light.position - *p, leaf.normal);
            if factor > 0.0 {
                gathered.of_points[k] += visible(link, k, light.intensity) * factor * light.intensity;
            }
        }
        return;
    }
    let source = &oracle.elements.nodes[link.source as usize];
    let doubt = link.doubt(source.is_cluster());
    if source.is_cluster() {
        for (k, p) in places.iter().enumerate() {
            let way = source.centre - *p;
            let factor = point_factor(way, leaf.normal);
            if factor > 0.0 {
                let d = -way.normalize_or_zero();
                let intensity = intensity(source, &oracle.radiosity, d);
                let factor = visible(link, k, intensity) * factor;
                let (unit, emitted) = match &hierarchy.rows {
                    Some(rows) => (intensity_by(source, &rows.intensity, d).x, rows.emitted(source, d)),
                    None => (0.0, DVec3::ZERO),
                };
                gathered.add(k, [factor * intensity, factor * emitted], factor * unit, doubt);
            }
        }
        return;
    }
    if oracle.radiosity.largest[link.source as usize] == 0.0 && hierarchy.rows.is_none() {
        return;
    }
    let emitted = oracle.elements.emitted(link.source);
    for (k, &p) in places.iter().enumerate() {
        let (factor, light) = from_element(oracle, p, leaf.normal, link.source);
        if factor > 0.0 {
            let visible = visible(link, k, light / factor);
            gathered.add(k, [visible * light, visible * factor * emitted], visible * factor, doubt);
        }
    }
}

/// The form factor of an element from a point with this normal, and the irradiance of the fully visible element. Lamps with a texture
/// are evaluated by the children of the element, whose radiosities the link took as accurate: edges of a texture are nothing linear.
fn from_element(oracle: &RefinementOracle, p: DVec3, n: DVec3, number: u32) -> (f64, DVec3) {
    let source = &oracle.elements.nodes[number as usize];
    if oracle.elements.is_uneven_lamp(number) && !source.is_leaf() {
        return sum_of_parts(source, |part| from_part(oracle, p, n, part));
    }
    from_part(oracle, p, n, number)
}

/// The sum of factors and irradiances over the children of an element.
fn sum_of_parts(source: &Node, of: impl Fn(u32) -> (f64, DVec3)) -> (f64, DVec3) {
    let parts = source.range().map(|part| of(part as u32));
    parts.fold((0.0, DVec3::ZERO), |sum, part| (sum.0 + part.0, sum.1 + part.1))
}

/// [`from_element`] of an element whose radiosity varies about linearly. A near and uneven element is evaluated by its children.
fn from_part(oracle: &RefinementOracle, p: DVec3, n: DVec3, number: u32) -> (f64, DVec3) {
    let source = &oracle.elements.nodes[number as usize];
    let way = source.centre - p;
    let distance2 = way.length_squared();
    let b = oracle.radiosity.b[number as usize];
    let is_uneven = f64::from(oracle.radiosity.spread[number as usize]) > UNEVEN * b.max_element();
    if is_uneven && distance2 < (NEAR * source.radius).powi(2) {
        return sum_of_parts(source, |part| from_part(oracle, p, n, part));
    }
    let corners = oracle.elements.triangle(source);
    let factor = if distance2 > (FAR * source.radius).powi(2) {
        let cosine = (-way.dot(source.normal)).max(0.0) / distance2.sqrt();
        point_factor(way, n) * cosine * source.window() * FRAC_1_PI
    } else {
        oracle.elements.factor_at(p, n, source)
    };
    let is_tilted = is_uneven && factor > 0.0;
    (factor, factor * if is_tilted { radiosity_seen_from(p, n, &corners, oracle, number) } else { b })
}

/// The mean radiosity of a source as weighted by the kernel at a point: a part that is near usually is bright as well,
/// so that the mean by area would be too small. The kernel is interpolated linearly between its values at the corners.
fn radiosity_seen_from(p: DVec3, n: DVec3, corners: &[DVec3; 3], oracle: &RefinementOracle, source: u32) -> DVec3 {
    let node = &oracle.elements.nodes[source as usize];
    let kernel = corners.map(|corner| {
        let way = corner - p;
        let facing = oracle.elements.normal_at(corner, node);
        let cosines = way.dot(n).max(0.0) * (-way.dot(facing)).max(0.0);
        cosines / way.length_squared().powi(2)
    });
    let total = kernel[0] + kernel[1] + kernel[2];
    let b = oracle.radiosity.b[source as usize];
    if total > 0.0 {
        let [first, second] = oracle.radiosity.tilt[source as usize].map(|tilt| tilt.to_f64());
        let more = first * (kernel[0] - kernel[2]) + second * (kernel[1] - kernel[2]);
        (b + 3.0 / total * more).max(DVec3::ZERO)
    } else {
        b
    }
}
