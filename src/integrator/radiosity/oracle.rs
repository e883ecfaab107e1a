//! The refinement oracle: it decides whether a pair of nodes is linked, subdivided, or has no transport.
//!
//! A pair of nodes is linked where its error is small against the irradiance of the scene, as root mean square.
//! Otherwise one of the nodes is subdivided and its children form new pairs. The oracle estimates four errors: the
//! variation of the form factor over the receiver, the variation of radiosity over the source, partial visibility, and
//! the approximation of a cluster by a point. Where only the first is large, the receiver is subdivided, because the
//! inner integral over the source is exact. The receiver is also subdivided first where it is the larger node and only
//! a spot of it is near the source.
//!
//! Sources: Hanrahan, Salzman, Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm"; Smits, Arvo, Greenberg 1994,
//! "A Clustering Algorithm for Radiosity in Complex Environments"; Sillion 1995, "A Unified Hierarchical Algorithm for
//! Global Illumination with Scattering Volumes and Object Clusters"; Lischinski, Smits, Greenberg 1994, "Bounds and
//! Error Estimates for Radiosity" (errors from samples of the kernel).

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use super::elements::{Elements, Node, quarter_centres};
use super::form_factor::{mean, point_to_front, quarters, triangle_area};
use super::light::NodeRadiosity;
use super::links::{Link, LinkKind, POINT, PointLight, QuarterWeights, faces, intensity, point_factor};
use crate::math::DVec3;
use crate::sampling::solid_angle;
use crate::scene::Scene;
use crate::shape::Analytic;
use crate::spectrum::Rgb;

/// The oracle's decision on a pair.
#[derive(Clone, Copy, Debug)]
pub(super) enum PairDecision {
    /// The nodes do not face each other, so no light is transported.
    NoTransport,
    Link(Link),
    SubdivideReceiver,
    SubdivideSource,
    SubdivideBoth,
}

/// The oracle: it holds the scene, its elements and the radiosities on which decisions depend.
#[derive(Debug)]
pub(super) struct RefinementOracle {
    pub scene: Scene,
    pub elements: Elements,
    pub radiosity: NodeRadiosity,
    pub lights: Vec<PointLight>,
    /// Allowed error of a link: irradiance times the root of the receiver's area.
    pub threshold: f64,
    /// What `threshold` comes to in the end, by what is known of the scene's light.
    pub allowed: f64,
    /// Irradiance at vertices; empty before the first solution.
    pub at_vertices: Vec<Rgb>,
}

/// Visibility rays that decide on a pair. Their number grows with the pair's light, so that no important shadow is
/// missed.
const TRIAL_RAYS: f64 = 4.0;
const MAX_TRIAL_RAYS: f64 = 64.0;

/// Elements farther apart than this, in the sum of their radii, are points to each other.
const FAR: f64 = 40.0;

/// Fractions of the spread of a form factor over the receiver, and of the factor itself, that count as error. The
/// solution is interpolated, so most of a spread is no error.
pub(super) const SPREAD_ERROR: f64 = 0.15;
const UNSEEN_ERROR: f64 = 0.02;

/// A spot covers less than this fraction of a receiver. This fraction of its height counts as error.
const MAX_SPOT_AREA: f64 = 0.25;
const SPOT_ERROR: f64 = 0.5;

/// The samples missed a peak that is larger than all of them by this factor.
const MISSED_PEAK: f64 = 4.0;

/// Spots are evaluated at this distance from the edge of an element, as a fraction of the distance to its centre.
const INWARDS: f64 = 1e-3;

/// A cluster's link may have an error of this fraction of itself, or of this fraction of the allowed error.
const CLUSTER_ERROR: f64 = 0.1;
const NEGLIGIBLE: f64 = 1.0 / 64.0;

/// Up to this number of patches, clusters are linked only where they are dark, because all pairs of patches can be
/// evaluated.
pub(super) const FEW_PATCHES: usize = 1200;

/// Of a partly visible source, the radiosity may vary by this fraction of the allowed error, because such errors have
/// the same sign.
const HIDDEN_SPREAD: f64 = 1.0 / 32.0;

/// Of a partly visible source, this fraction of the allowed error may be at the wrong points of the receiver, because
/// one blocker hides many sources at once.
pub(super) const SHADOW_ERROR: f64 = 1.0 / 16.0;

/// Discontinuous elements are subdivided where a link brings more than this fraction of the allowed error.
const DISCONTINUOUS_ERROR: f64 = 0.25;

/// Heights over a plane below this multiple of the distance are rounding.
const PLANE_TOLERANCE: f64 = 1e-6;

/// The shape reaches no farther behind a hollow element than this many times its depth in the middle.
const REACH: f64 = 1.5;

/// A link that brings no light.
fn empty_link(receiver: u32, source: u32, kind: LinkKind, error: f32) -> Link {
    Link { receiver, source, factor: 0.0, visible: 1.0, seen: 1.0, quarter_weights: QuarterWeights::EVEN, error, kind }
}

impl RefinementOracle {
    pub fn node(&self, number: u32) -> &Node {
        &self.elements.nodes[number as usize]
    }

    /// Strength of a source in the unit direction `d`: the largest channel of its radiosity or radiant intensity.
    pub fn strength(&self, source: u32, d: DVec3) -> f64 {
        if source >= POINT {
            return self.lights[(source - POINT) as usize].intensity.max_element();
        }
        let node = self.node(source);
        if node.is_cluster() {
            intensity(node, &self.radiosity, d).max_element()
        } else {
            self.radiosity.b[source as usize].max_element()
        }
    }

    /// Irradiance times the root of the receiver's area that a link brings if its source is fully visible.
    pub fn unoccluded_transport(&self, link: &Link) -> f64 {
        let receiver = self.node(link.receiver);
        let d = if link.source >= POINT { DVec3::ZERO } else { receiver.centre - self.node(link.source).centre };
        f64::from(link.factor) * self.strength(link.source, d.normalize_or_zero()) * receiver.area.sqrt()
    }

    /// Whether a link's error exceeds the allowed error with the current radiosities.
    pub fn exceeds_error(&self, link: &Link) -> bool {
        let receiver = self.node(link.receiver);
        let root = receiver.area.sqrt();
        let is_discontinuous =
            link.kind == LinkKind::Element && receiver.is_discontinuous && self.elements.is_divisible(link.receiver);
        if is_discontinuous && self.unoccluded_transport(link) > DISCONTINUOUS_ERROR * self.threshold {
            return true;
        }
        if link.kind == LinkKind::Negligible {
            return f64::from(self.radiosity.largest[link.source as usize]) * f64::from(link.error) * root
                > self.threshold;
        }
        let strength = if link.source >= POINT {
            self.strength(link.source, DVec3::ZERO)
        } else {
            let source = self.node(link.source);
            if !source.is_cluster() {
                // The error exceeds the factor where the factor is a spot's, whose mean says little about its mean
                // square.
                let spread =
                    self.spread(link.source, link.quarter_weights) * f64::from(link.factor.max(link.error)) * root;
                let seen = f64::from(link.seen);
                let hidden = 2.0 * seen * (1.0 - seen);
                if spread * seen > self.threshold || spread * hidden > HIDDEN_SPREAD * self.threshold {
                    return true;
                }
            }
            self.strength(link.source, (receiver.centre - source.centre).normalize_or_zero())
        };
        strength * f64::from(link.error) * root > self.threshold
    }

    /// Largest difference of a radiosity below a source's quarters from the radiosity of its quarter.
    fn spread(&self, source: u32, quarter_weights: QuarterWeights) -> f64 {
        let spread = |number: usize| f64::from(self.radiosity.spread[number]);
        let node = self.node(source);
        if quarter_weights == QuarterWeights::EVEN || node.children != 4 {
            return spread(source as usize);
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| spread(node.first as usize + k));
        a.max(b).max(c).max(d)
    }

    /// Decides on a pair.
    pub fn decide(&self, receiver: u32, source: u32) -> PairDecision {
        if source >= POINT {
            return self.decide_point_light(receiver, source);
        }
        let (r, s) = (self.node(receiver), self.node(source));
        if receiver == source {
            return self.decide_self(receiver);
        }
        if r.is_cluster() || s.is_cluster() {
            self.decide_clusters(receiver, source)
        } else {
            self.decide_elements(receiver, source)
        }
    }

    fn decide_self(&self, number: u32) -> PairDecision {
        let node = self.node(number);
        // A flat element does not see itself; a curved element does on its concave side.
        let is_flat = !node.is_cluster()
            && self.elements.shape(node.patch).is_none_or(|shape| matches!(shape, Analytic::Disk(_)));
        if is_flat {
            return PairDecision::NoTransport;
        }
        let is_bright =
            f64::from(self.radiosity.largest[number as usize]) * node.area.sqrt() > NEGLIGIBLE * self.threshold;
        if is_bright && (node.is_cluster() || self.elements.is_divisible(number)) {
            return PairDecision::SubdivideBoth;
        }
        if !node.is_cluster() && is_bright {
            return PairDecision::NoTransport;
        }
        self.negligible_link(number, number)
    }

    fn negligible_link(&self, receiver: u32, source: u32) -> PairDecision {
        PairDecision::Link(empty_link(receiver, source, LinkKind::Negligible, (1.0 / NEGLIGIBLE) as f32))
    }

    /// Subdivides the node with the larger radius, or the one that can be subdivided.
    fn subdivide_wider(&self, receiver: u32, source: u32) -> Option<PairDecision> {
        let clusters = (self.node(receiver).is_cluster(), self.node(source).is_cluster());
        let is_few = self.elements.patches.len() <= FEW_PATCHES && clusters.0 != clusters.1;
        let can_receiver = if is_few { clusters.0 } else { self.elements.is_divisible(receiver) };
        let can_source = if is_few { clusters.1 } else { self.elements.is_divisible(source) };
        match (can_receiver, can_source) {
            (false, false) => None,
            (true, false) => Some(PairDecision::SubdivideReceiver),
            (false, true) => Some(PairDecision::SubdivideSource),
            (true, true) if self.node(receiver).radius >= self.node(source).radius => {
                Some(PairDecision::SubdivideReceiver)
            }
            (true, true) => Some(PairDecision::SubdivideSource),
        }
    }

    fn decide_elements(&self, receiver: u32, source: u32) -> PairDecision {
        let (r, s) = (self.node(receiver), self.node(source));
        if r.patch == s.patch && self.elements.shape(r.patch).is_none() {
            return PairDecision::NoTransport;
        }
        // The two sides of a curved wall do not see each other, although a small element of the one may be before a large flat one of the
        // other.
        let [one, other] = [r, s].map(|node| &self.elements.patches[node.patch as usize]);
        if (r.is_hollow || s.is_hollow) && one.shape == other.shape && one.is_front != other.is_front {
            return PairDecision::NoTransport;
        }
        let (from, to) = (self.elements.triangle(r), self.elements.triangle(s));
        let way = s.centre - r.centre;
        let distance = way.length();
        let margin = PLANE_TOLERANCE * (distance + r.radius + s.radius);
        let height = |corners: &[DVec3; 3], over: &Node| {
            corners.iter().map(|p| (p - over.centre).dot(over.normal)).fold(f64::NEG_INFINITY, f64::max)
        };
        // What is behind the flat element of a hollow one may still be before the shape.
        let above = height(&to, r);
        if above <= margin - REACH * r.depth || (!s.is_hollow && height(&from, s) <= margin) {
            return PairDecision::NoTransport;
        }
        // A hollow receiver does not see it, but the elements below the receiver do, which are evaluated by themselves.
        let of_children = || PairDecision::Link(empty_link(receiver, source, LinkKind::Element, 0.0));
        if above <= margin {
            return of_children();
        }

        let (factor, error, root_mean_square, quarter_weights) = if distance > FAR * (r.radius + s.radius) {
            let d = way / distance;
            let cosines = d.dot(r.normal).max(0.0) * (-d.dot(s.normal)).max(0.0);
            let factor = cosines * s.window() * FRAC_1_PI / (distance * distance);
            (factor, factor / FAR, factor, QuarterWeights::EVEN)
        } else {
            let f = |p: DVec3| self.elements.factor_at(p, r.normal, s);
            match spot(r, &from, s.centre, s.radius) {
                Some((place, width)) => {
                    // Integrated over the smaller of the two, the factor includes all visible parts of the larger one;
                    // the other order might miss some.
                    let back = |p: DVec3| self.elements.factor_at(p, s.normal, r) / r.area_ratio;
                    // A hollow element is seen through its flat one, an element at the edge of a disk is seen to the edge.
                    let area = |node: &Node, flat| {
                        if node.bends.is_some() && !node.is_hollow { node.area } else { triangle_area(flat) }
                    };
                    let areas = s.area_ratio * area(s, &to) / area(r, &from);
                    let factor = areas * mean(&back, &to, 1e-3, 2);
                    let quarters = quarters(&to).map(|[a, b, c]| back((a + b + c) / 3.0));
                    let root_mean_square = factor.max(width * f(place));
                    (factor, SPOT_ERROR * root_mean_square, root_mean_square, self.quarter_weights(s, quarters))
                }
                None => {
                    let places = quarter_centres(&from);
                    let FormFactorSamples { mean: mut factor, mut error, largest, is_uneven } =
                        FormFactorSamples::of(&f, &from, &places);
                    let mut root_mean_square = factor;
                    if distance < r.radius + s.radius {
                        let (place, width) = strip(r, s, &from, &to);
                        let peak = f(place);
                        if peak > MISSED_PEAK * largest {
                            root_mean_square = width * peak;
                            factor = factor.max(0.5 * width * width * peak);
                            error = error.max(SPOT_ERROR * root_mean_square);
                        }
                    }
                    let places = if is_uneven { &places[..] } else { &places[3..] };
                    let quarters = quarters(&to)
                        .map(|part| places.iter().map(|&p| point_to_front(p, r.normal, &part, s.normal)).sum());
                    (factor, error, root_mean_square, self.quarter_weights(s, quarters))
                }
            }
        };
        if factor <= 0.0 {
            return if r.is_hollow { of_children() } else { PairDecision::NoTransport };
        }
        let root = r.area.sqrt();
        let strength = self.radiosity.b[source as usize].max_element();
        let allowed = self.threshold / root;
        if error * strength > allowed && self.elements.is_divisible(receiver) {
            return PairDecision::SubdivideReceiver;
        }
        let source_spread = self.spread(source, quarter_weights);
        if root_mean_square * source_spread > allowed && !s.is_leaf() {
            // Most of a large receiver is far from a source that is near one spot of it, and would be served as well by
            // larger sources.
            let is_spot = root_mean_square > factor && r.radius > s.radius;
            return if is_spot && self.elements.is_divisible(receiver) {
                PairDecision::SubdivideReceiver
            } else {
                PairDecision::SubdivideSource
            };
        }
        let all = factor * strength;
        let rays = (TRIAL_RAYS * all / allowed).clamp(TRIAL_RAYS, MAX_TRIAL_RAYS) as u32;
        let seen = self.trial_visibility(receiver, source, rays);
        let mut partly_visible = 2.0 * seen * (1.0 - seen);
        let mut error = error;
        if all * partly_visible > SHADOW_ERROR * allowed {
            if let Some(decision) = self.subdivide_wider(receiver, source) {
                return decision;
            }
            (error, partly_visible) = (0.0, 0.0);
        }
        // The hidden part of a source may be its dark part, such as the floor under a box.
        let hidden = factor * source_spread * 2.0 * seen * (1.0 - seen);
        if hidden > HIDDEN_SPREAD * allowed && !s.is_leaf() {
            return PairDecision::SubdivideSource;
        }
        let is_strong = all > DISCONTINUOUS_ERROR * allowed;
        if is_strong && r.is_discontinuous && self.elements.is_divisible(receiver) {
            return PairDecision::SubdivideReceiver;
        }
        if is_strong && s.is_discontinuous && self.elements.is_divisible(source) {
            return PairDecision::SubdivideSource;
        }
        let error = error * seen + factor * (partly_visible + UNSEEN_ERROR);
        let is_last = !self.elements.is_divisible(receiver) && !self.elements.is_divisible(source);
        PairDecision::Link(Link {
            receiver,
            source,
            factor: factor as f32,
            visible: seen as f32,
            seen: seen as f32,
            error: if is_last { 0.0 } else { error as f32 },
            quarter_weights,
            kind: LinkKind::Element,
        })
    }

    /// Weights of a source's quarters by form factors; by area for a curved source.
    fn quarter_weights(&self, source: &Node, factors: [f64; 4]) -> QuarterWeights {
        match self.elements.shape(source.patch) {
            Some(_) => QuarterWeights::EVEN,
            None => QuarterWeights::new(factors),
        }
    }

    /// Whether a node is entirely on the side of another one's plane or normal cone that the other never sees.
    fn is_hidden(&self, node: &Node, other: &Node, d: DVec3, distance: f64) -> bool {
        if !node.is_cluster() {
            let rounding = PLANE_TOLERANCE * (distance + other.radius);
            let bulge = if self.elements.shape(node.patch).is_some() { node.radius } else { 0.0 };
            return distance * d.dot(node.normal) + other.radius + bulge <= rounding;
        }
        let radii = node.radius + other.radius;
        if distance <= radii || node.cone >= FRAC_PI_2 {
            return false;
        }
        let angle = d.dot(node.normal).clamp(-1.0, 1.0).acos();
        angle - node.cone - (radii / distance).asin() > FRAC_PI_2
    }

    fn decide_clusters(&self, receiver: u32, source: u32) -> PairDecision {
        let (r, s) = (self.node(receiver), self.node(source));
        let way = s.centre - r.centre;
        let distance = way.length();
        let d = way.normalize_or_zero();
        if self.is_hidden(r, s, d, distance) || self.is_hidden(s, r, -d, distance) {
            return PairDecision::NoTransport;
        }
        let allowed = self.threshold / r.area.sqrt();
        let gap = distance - r.radius - s.radius;
        if gap < 0.3 * r.radius.max(s.radius) {
            if f64::from(self.radiosity.largest[source as usize]) > NEGLIGIBLE * allowed
                && let Some(decision) = self.subdivide_wider(receiver, source)
            {
                return decision;
            }
            return self.negligible_link(receiver, source);
        }
        let inverse2 = 1.0 / (distance * distance);
        let kind = self.facing(r, d);
        let cosine = if kind == LinkKind::Element { d.dot(r.normal).max(0.0) } else { 1.0 };
        let factor = if s.is_cluster() {
            cosine * inverse2
        } else {
            cosine * inverse2 * FRAC_1_PI * s.window() * (-d.dot(s.normal)).max(0.0)
        };
        let lobes = |is_mixed: bool| if is_mixed { 0.15 } else { 0.0 };
        let mixed = lobes(kind == LinkKind::Mixed) + lobes(s.is_cluster() && !faces(s, -d));
        // A source whose centre is just behind a plane is still partly visible.
        let grazing = 0.25 * inverse2 * if s.is_cluster() { s.radius / distance } else { s.area * s.radius / distance };
        // Since centres are means by area, the error is of second order in the mean, and of first order from point to
        // point.
        let (wide, narrow) = (r.radius.max(s.radius) / distance, r.radius / distance);
        let error = factor * (0.5 * narrow + 1.5 * wide * wide + mixed) + 0.2 * grazing;
        // The errors of all cluster links of a surface add up. Each error must therefore be a small part of its link,
        // or negligible.
        let own = factor + grazing;
        let strength = self.strength(source, -d);
        let is_divided = if self.elements.patches.len() <= FEW_PATCHES {
            f64::from(self.radiosity.largest[source as usize]) > 0.0
        } else {
            error > CLUSTER_ERROR * own && error * strength > NEGLIGIBLE * self.threshold / r.area.sqrt()
        };
        if is_divided && let Some(decision) = self.subdivide_wider(receiver, source) {
            return decision;
        }
        self.decide_by_visibility(receiver, source, [factor, error], kind, -d)
    }

    fn facing(&self, r: &Node, d: DVec3) -> LinkKind {
        if !r.is_cluster() {
            LinkKind::Element
        } else if faces(r, d) {
            LinkKind::Facing
        } else {
            LinkKind::Mixed
        }
    }

    /// The decision for pairs with clusters or point lights, including visibility. `d`: direction from the source to
    /// the receiver.
    fn decide_by_visibility(
        &self,
        receiver: u32,
        source: u32,
        [factor, error]: [f64; 2],
        kind: LinkKind,
        d: DVec3,
    ) -> PairDecision {
        let allowed = self.threshold / self.node(receiver).area.sqrt();
        let strength = self.strength(source, d);
        let divide = || if source >= POINT { None } else { self.subdivide_wider(receiver, source) };
        let divide = || match divide() {
            None if self.elements.is_divisible(receiver) => Some(PairDecision::SubdivideReceiver),
            decision => decision,
        };
        if error * strength > allowed
            && let Some(decision) = divide()
        {
            return decision;
        }
        let all = factor * strength;
        let rays = (TRIAL_RAYS * all / allowed).clamp(TRIAL_RAYS, MAX_TRIAL_RAYS) as u32;
        let seen = self.trial_visibility(receiver, source, rays);
        let mut partly_visible = 2.0 * seen * (1.0 - seen);
        let enough = if source < POINT && self.node(source).is_cluster() { HIDDEN_SPREAD * allowed } else { allowed };
        if all * partly_visible > enough {
            if let Some(decision) = divide() {
                return decision;
            }
            partly_visible = 0.0;
        }
        let is_discontinuous =
            kind == LinkKind::Element && self.node(receiver).is_discontinuous && self.elements.is_divisible(receiver);
        if is_discontinuous && all > DISCONTINUOUS_ERROR * allowed {
            return PairDecision::SubdivideReceiver;
        }
        let is_last = divide().is_none();
        let error = if is_last { 0.0 } else { error + factor * (partly_visible + UNSEEN_ERROR) };
        PairDecision::Link(Link {
            receiver,
            source,
            factor: factor as f32,
            visible: seen as f32,
            seen: seen as f32,
            error: error as f32,
            quarter_weights: QuarterWeights::EVEN,
            kind,
        })
    }

    fn decide_point_light(&self, receiver: u32, source: u32) -> PairDecision {
        let r = self.node(receiver);
        let light = &self.lights[(source - POINT) as usize];
        let way = light.position - r.centre;
        let distance = way.length();
        let d = way.normalize_or_zero();
        if r.is_cluster() {
            if distance < 2.0 * r.radius {
                return PairDecision::SubdivideReceiver;
            }
            let angle = d.dot(r.normal).clamp(-1.0, 1.0).acos();
            if r.cone < FRAC_PI_2 && angle - r.cone - (r.radius / distance).asin() > FRAC_PI_2 {
                return PairDecision::NoTransport;
            }
            let kind = self.facing(r, d);
            let factor = 1.0 / (distance * distance);
            let error = factor * (r.radius / distance + if kind == LinkKind::Mixed { 0.15 } else { 0.0 });
            return self.decide_by_visibility(receiver, source, [factor, error], kind, -d);
        }
        let from = self.elements.triangle(r);
        if !from.iter().any(|p| (light.position - p).dot(r.normal) > PLANE_TOLERANCE * distance) {
            return PairDecision::NoTransport;
        }
        let f = |p: DVec3| point_factor(light.position - p, r.normal);
        let [factor, error] = match spot(r, &from, light.position, 0.0) {
            Some((place, width)) => {
                let factor = solid_angle(from.map(|p| p - light.position)) / triangle_area(&from);
                [factor, SPOT_ERROR * width * f(place)]
            }
            None => {
                let FormFactorSamples { mean, error, .. } = FormFactorSamples::of(&f, &from, &quarter_centres(&from));
                [mean, error]
            }
        };
        self.decide_by_visibility(receiver, source, [factor, error], LinkKind::Element, -d)
    }
}

/// Mean of a form factor over a receiver from a few points.
struct FormFactorSamples {
    mean: f64,
    /// The part of its variation that interpolation does not reproduce.
    error: f64,
    /// The largest value at the points.
    largest: f64,
    /// Whether the factor varies considerably.
    is_uneven: bool,
}

impl FormFactorSamples {
    /// `places`: the points that are evaluated first.
    fn of(f: &impl Fn(DVec3) -> f64, from: &[DVec3; 3], places: &[DVec3; 4]) -> Self {
        let [a, b, c, middle] = places.map(f);
        let plain_mean = 0.25 * (a + b + c + middle);
        let largest = a.max(b).max(c).max(middle);
        let spread = largest - a.min(b).min(c).min(middle);
        let bend = (middle - (a + b + c) / 3.0).abs();
        let is_uneven = spread > 0.05 * plain_mean;
        let mean = if is_uneven { mean(f, from, 1e-4 * plain_mean.max(1e-3), 4) } else { plain_mean };
        Self { mean, error: bend + SPREAD_ERROR * spread, largest, is_uneven }
    }
}

/// The point of a receiver that is closest to a near and small source, and the width of the bright spot there as a
/// fraction of the receiver's width. Points that were chosen without regard to the source would miss the spot.
fn spot(r: &Node, from: &[DVec3; 3], source: DVec3, radius: f64) -> Option<(DVec3, f64)> {
    let nearest = closest(from, source);
    let share = PI * (source.distance_squared(nearest) + radius * radius) / r.area;
    (share < MAX_SPOT_AREA).then(|| (nearest + INWARDS * (r.centre - nearest), share.sqrt()))
}

/// The same for a source that is not small: the point of a bright strip where source and receiver are closest, such as
/// in a narrow gap.
fn strip(r: &Node, s: &Node, from: &[DVec3; 3], to: &[DVec3; 3]) -> (DVec3, f64) {
    let mut nearest = closest(from, s.centre);
    for _ in 0..3 {
        nearest = closest(from, closest(to, nearest));
    }
    let gap = closest(to, nearest).distance(nearest);
    let share = gap * (PI * gap + 4.0 * r.radius.min(s.radius)) / r.area;
    (nearest + INWARDS * (r.centre - nearest), share.min(1.0).sqrt())
}

/// The point of a triangle that is closest to `p`.
///
/// Source: Ericson 2004, "Real-Time Collision Detection", 5.1.5.
fn closest(&[a, b, c]: &[DVec3; 3], p: DVec3) -> DVec3 {
    let on_side = |a: DVec3, b: DVec3| {
        let side = b - a;
        a + ((p - a).dot(side) / side.length_squared()).clamp(0.0, 1.0) * side
    };
    let n = (b - a).cross(c - a);
    let is_inside = [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| n.cross(b - a).dot(p - a) >= 0.0);
    if is_inside {
        return p - (p - a).dot(n) / n.length_squared() * n;
    }
    let ends = [on_side(a, b), on_side(b, c), on_side(c, a)];
    ends.into_iter().min_by(|q, r| p.distance_squared(*q).total_cmp(&p.distance_squared(*r))).unwrap_or(a)
}
