//! Judging pairs of nodes: linked as they are, divided, or blind to each other.
//!
//! A pair of nodes is linked as it is where what that may be wrong by is small against all irradiance, in the root of the mean
//! square; else one of them is divided, and its parts are asked. The oracle knows four errors: the form factor that varies over
//! the receiver, the radiosity that varies over the source, visibility that is neither full nor none, and a cluster taken for a
//! point. Where only the first is large, the receiver is divided; the inner integral over the source is exact. So it is, before the
//! source, where it is the larger and only a spot of it is near.
//!
//! Sources: Hanrahan, Salzman, Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm"; Smits, Arvo, Greenberg 1994, "A
//! Clustering Algorithm for Radiosity in Complex Environments"; Sillion 1995, "A Unified Hierarchical Algorithm for Global
//! Illumination with Scattering Volumes and Object Clusters"; Lischinski, Smits, Greenberg 1994, "Bounds and Error Estimates
//! for Radiosity" (errors from samples of the kernel).

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use super::elements::{Elements, Node, quarter_centres};
use super::form_factor::{mean, point_to_front, quarters, triangle_area};
use super::light::Sent;
use super::links::{Kind, Link, POINT, PointLight, Shares, faces, intensity, point_factor};
use crate::math::DVec3;
use crate::sampling::solid_angle;
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// What becomes of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) enum Verdict {
    /// They do not see each other.
    Drop,
    Keep(Link),
    DivideReceiver,
    DivideSource,
    DivideBoth,
}

/// What judging pairs needs.
#[derive(Debug)]
pub(super) struct Judge {
    pub scene: Scene,
    pub elements: Elements,
    pub sent: Sent,
    pub lights: Vec<PointLight>,
    /// Error that is allowed: irradiance times root of area.
    pub threshold: f64,
    /// Irradiance at vertices; empty while that is not known.
    pub at_vertices: Vec<Rgb>,
}

/// Rays that decide on a pair: the more the more light is at stake, so that no shadow is missed that matters.
const RAYS: f64 = 4.0;
const MOST_RAYS: f64 = 64.0;

/// Elements farther apart than this, in their radii, are points to each other.
const FAR: f64 = 40.0;

/// Shares of the spread of a form factor over the receiver, and of the factor itself, that count as its error: the solution is
/// interpolated, so most of a spread is none.
const SPREAD_SHARE: f64 = 0.15;
const UNSEEN_SHARE: f64 = 0.02;

/// A spot is what covers less than this share of a receiver, and this share of its depth counts as error.
const SPOT: f64 = 0.25;
const SPOT_SHARE: f64 = 0.5;

/// A value so much larger than those elsewhere was missed by them.
const MISSED: f64 = 4.0;

/// Spots are looked at so far from the edge of an element, as a share of the way to its middle.
const INWARDS: f64 = 1e-3;

/// A cluster's link may be wrong by this share of itself, or by this share of what is allowed.
const COHERENT: f64 = 0.1;
const NOTHING: f64 = 1.0 / 64.0;

/// Up to so many patches, clusters are only used for what is dark: each pair of patches can be looked at.
const FEW_PATCHES: usize = 1200;

/// Of a source that is seen in part the radiosity may vary by this share of what is allowed: such errors go one way.
const HIDDEN: f64 = 1.0 / 32.0;

/// Of a source that is seen in part this share of what is allowed may be at the wrong places: what is in between is in the way of
/// many sources at once.
const SHADOW: f64 = 1.0 / 16.0;

/// Elements that are cut are divided where a link brings more than this share of what is allowed.
const CUT: f64 = 0.25;

/// Heights over a plane, in distances, that are rounding.
const FLAT: f64 = 1e-6;

impl Judge {
    pub fn node(&self, number: u32) -> &Node {
        &self.elements.nodes[number as usize]
    }

    /// Strength of a source in the unit direction `d`, in its largest channel.
    pub fn strength(&self, source: u32, d: DVec3) -> f64 {
        if source >= POINT {
            return self.lights[(source - POINT) as usize].intensity.max_element();
        }
        let node = self.node(source);
        if node.is_cluster() {
            intensity(node, &self.sent, d).max_element()
        } else {
            self.sent.b[source as usize].max_element()
        }
    }

    /// What a link brings if all of its source is seen: irradiance times root of area.
    pub fn stake(&self, link: &Link) -> f64 {
        let receiver = self.node(link.receiver);
        let d = if link.source >= POINT { DVec3::ZERO } else { receiver.centre - self.node(link.source).centre };
        f64::from(link.factor) * self.strength(link.source, d.normalize_or_zero()) * receiver.area.sqrt()
    }

    /// Whether a link is no longer good enough.
    pub fn is_stale(&self, link: &Link) -> bool {
        let receiver = self.node(link.receiver);
        let root = receiver.area.sqrt();
        let is_cut = link.kind == Kind::Element && receiver.is_cut && self.elements.is_divisible(link.receiver);
        if is_cut && self.stake(link) > CUT * self.threshold {
            return true;
        }
        if link.kind == Kind::Dim {
            return f64::from(self.sent.most[link.source as usize]) * f64::from(link.error) * root > self.threshold;
        }
        let strength = if link.source >= POINT {
            self.strength(link.source, DVec3::ZERO)
        } else {
            let source = self.node(link.source);
            if !source.is_cluster() {
                // The error is the larger where the factor is a spot's, whose mean says little of its square.
                let spread = self.spread(link.source, link.shares) * f64::from(link.factor.max(link.error)) * root;
                let seen = f64::from(link.seen);
                let hidden = 2.0 * seen * (1.0 - seen);
                if spread * seen > self.threshold || spread * hidden > HIDDEN * self.threshold {
                    return true;
                }
            }
            self.strength(link.source, (receiver.centre - source.centre).normalize_or_zero())
        };
        strength * f64::from(link.error) * root > self.threshold
    }

    /// How far, at most, radiosities below a source's quarters are from those of the quarters.
    fn spread(&self, source: u32, shares: Shares) -> f64 {
        let spread = |number: usize| f64::from(self.sent.spread[number]);
        let node = self.node(source);
        if shares == Shares::EVEN || node.children != 4 {
            return spread(source as usize);
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| spread(node.first as usize + k));
        a.max(b).max(c).max(d)
    }

    /// What becomes of a pair.
    pub fn judge(&self, receiver: u32, source: u32) -> Verdict {
        if source >= POINT {
            return self.by_point(receiver, source);
        }
        let (r, s) = (self.node(receiver), self.node(source));
        if receiver == source {
            return self.itself(receiver);
        }
        if r.is_cluster() || s.is_cluster() { self.clusters(receiver, source) } else { self.polygons(receiver, source) }
    }

    fn itself(&self, number: u32) -> Verdict {
        let node = self.node(number);
        // A flat element does not see itself; a bent one does on its hollow side.
        let is_flat = !node.is_cluster() && self.elements.shape(node.patch).is_none();
        if is_flat {
            return Verdict::Drop;
        }
        let is_bright = f64::from(self.sent.most[number as usize]) * node.area.sqrt() > NOTHING * self.threshold;
        if is_bright && (node.is_cluster() || self.elements.is_divisible(number)) {
            return Verdict::DivideBoth;
        }
        if !node.is_cluster() && is_bright {
            return Verdict::Drop;
        }
        self.dim(number, number)
    }

    fn dim(&self, receiver: u32, source: u32) -> Verdict {
        Verdict::Keep(Link {
            receiver,
            source,
            factor: 0.0,
            visible: 1.0,
            seen: 1.0,
            shares: Shares::EVEN,
            error: (1.0 / NOTHING) as f32,
            kind: Kind::Dim,
        })
    }

    /// Divides the wider of two.
    fn divide(&self, receiver: u32, source: u32) -> Option<Verdict> {
        let clusters = (self.node(receiver).is_cluster(), self.node(source).is_cluster());
        let is_few = self.elements.patches.len() <= FEW_PATCHES && clusters.0 != clusters.1;
        let can_receiver = if is_few { clusters.0 } else { self.elements.is_divisible(receiver) };
        let can_source = if is_few { clusters.1 } else { self.elements.is_divisible(source) };
        match (can_receiver, can_source) {
            (false, false) => None,
            (true, false) => Some(Verdict::DivideReceiver),
            (false, true) => Some(Verdict::DivideSource),
            (true, true) if self.node(receiver).radius >= self.node(source).radius => Some(Verdict::DivideReceiver),
            (true, true) => Some(Verdict::DivideSource),
        }
    }

    fn polygons(&self, receiver: u32, source: u32) -> Verdict {
        let (r, s) = (self.node(receiver), self.node(source));
        if r.patch == s.patch && self.elements.shape(r.patch).is_none() {
            return Verdict::Drop;
        }
        let (from, to) = (self.elements.triangle(r), self.elements.triangle(s));
        let way = s.centre - r.centre;
        let distance = way.length();
        let margin = FLAT * (distance + r.radius + s.radius);
        let height = |corners: &[DVec3; 3], over: &Node| {
            corners.iter().map(|p| (p - over.centre).dot(over.normal)).fold(f64::NEG_INFINITY, f64::max)
        };
        if height(&to, r) <= margin || height(&from, s) <= margin {
            return Verdict::Drop;
        }

        let (factor, error, root_mean_square, shares) = if distance > FAR * (r.radius + s.radius) {
            let d = way / distance;
            let cosines = d.dot(r.normal).max(0.0) * (-d.dot(s.normal)).max(0.0);
            let factor = cosines * s.area * FRAC_1_PI / (distance * distance);
            (factor, factor / FAR, factor, Shares::EVEN)
        } else {
            let f = |p: DVec3| point_to_front(p, r.normal, &to, s.normal) * s.swell;
            match spot(r, &from, s.centre, s.radius) {
                Some((place, width)) => {
                    // From the smaller of the two all that it sees of the larger is found, which the other way round might be
                    // missed.
                    let back = |p: DVec3| point_to_front(p, s.normal, &from, r.normal);
                    let areas = s.swell * triangle_area(&to) / triangle_area(&from);
                    let factor = areas * mean(&back, &to, 1e-3, 2);
                    let quarters = quarters(&to).map(|[a, b, c]| back((a + b + c) / 3.0));
                    let root_mean_square = factor.max(width * f(place));
                    (factor, SPOT_SHARE * root_mean_square, root_mean_square, self.shares(s, quarters))
                }
                None => {
                    let places = quarter_centres(&from);
                    let Rough { mean: mut factor, mut error, most, is_uneven } = Rough::of(&f, &from, &places);
                    let mut root_mean_square = factor;
                    if distance < r.radius + s.radius {
                        let (place, width) = strip(r, s, &from, &to);
                        let peak = f(place);
                        if peak > MISSED * most {
                            root_mean_square = width * peak;
                            factor = factor.max(0.5 * width * width * peak);
                            error = error.max(SPOT_SHARE * root_mean_square);
                        }
                    }
                    let places = if is_uneven { &places[..] } else { &places[3..] };
                    let quarters = quarters(&to)
                        .map(|part| places.iter().map(|&p| point_to_front(p, r.normal, &part, s.normal)).sum());
                    (factor, error, root_mean_square, self.shares(s, quarters))
                }
            }
        };
        if factor <= 0.0 {
            return Verdict::Drop;
        }
        let root = r.area.sqrt();
        let strength = self.sent.b[source as usize].max_element();
        let allowed = self.threshold / root;
        if error * strength > allowed && self.elements.is_divisible(receiver) {
            return Verdict::DivideReceiver;
        }
        let source_spread = self.spread(source, shares);
        if root_mean_square * source_spread > allowed && !s.is_leaf() {
            // Of a large receiver most is far from what is close to some of it, and would do with larger sources.
            let is_spot = root_mean_square > factor && r.radius > s.radius;
            return if is_spot && self.elements.is_divisible(receiver) {
                Verdict::DivideReceiver
            } else {
                Verdict::DivideSource
            };
        }
        let all = factor * strength;
        let rays = (RAYS * all / allowed).clamp(RAYS, MOST_RAYS) as u32;
        let seen = self.seen(receiver, source, rays);
        let mut unsure = 2.0 * seen * (1.0 - seen);
        let mut error = error;
        if all * unsure > SHADOW * allowed {
            if let Some(verdict) = self.divide(receiver, source) {
                return verdict;
            }
            (error, unsure) = (0.0, 0.0);
        }
        // What is hidden of a source may be what is dark of it: the floor under a box.
        let hidden = factor * source_spread * 2.0 * seen * (1.0 - seen);
        if hidden > HIDDEN * allowed && !s.is_leaf() {
            return Verdict::DivideSource;
        }
        let much = all > CUT * allowed;
        if much && r.is_cut && self.elements.is_divisible(receiver) {
            return Verdict::DivideReceiver;
        }
        if much && s.is_cut && self.elements.is_divisible(source) {
            return Verdict::DivideSource;
        }
        let error = error * seen + factor * (unsure + UNSEEN_SHARE);
        let is_last = !self.elements.is_divisible(receiver) && !self.elements.is_divisible(source);
        Verdict::Keep(Link {
            receiver,
            source,
            factor: factor as f32,
            visible: seen as f32,
            seen: seen as f32,
            error: if is_last { 0.0 } else { error as f32 },
            shares,
            kind: Kind::Element,
        })
    }

    /// Shares of a source's quarters; of one that is bent, by area.
    fn shares(&self, source: &Node, factors: [f64; 4]) -> Shares {
        match self.elements.shape(source.patch) {
            Some(_) => Shares::EVEN,
            None => Shares::new(factors),
        }
    }

    /// Where a node is on the side of a plane or cone that another one never sees.
    fn is_hidden(&self, node: &Node, other: &Node, d: DVec3, distance: f64) -> bool {
        if !node.is_cluster() {
            let rounding = FLAT * (distance + other.radius);
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

    fn clusters(&self, receiver: u32, source: u32) -> Verdict {
        let (r, s) = (self.node(receiver), self.node(source));
        let way = s.centre - r.centre;
        let distance = way.length();
        let d = way.normalize_or_zero();
        if self.is_hidden(r, s, d, distance) || self.is_hidden(s, r, -d, distance) {
            return Verdict::Drop;
        }
        let allowed = self.threshold / r.area.sqrt();
        let gap = distance - r.radius - s.radius;
        if gap < 0.3 * r.radius.max(s.radius) {
            if f64::from(self.sent.most[source as usize]) > NOTHING * allowed
                && let Some(verdict) = self.divide(receiver, source)
            {
                return verdict;
            }
            return self.dim(receiver, source);
        }
        let inverse2 = 1.0 / (distance * distance);
        let kind = self.facing(r, d);
        let cosine = if kind == Kind::Element { d.dot(r.normal).max(0.0) } else { 1.0 };
        let factor = if s.is_cluster() {
            cosine * inverse2
        } else {
            cosine * inverse2 * FRAC_1_PI * s.area * (-d.dot(s.normal)).max(0.0)
        };
        let lobes = |is_mixed: bool| if is_mixed { 0.15 } else { 0.0 };
        let mixed = lobes(kind == Kind::Mixed) + lobes(s.is_cluster() && !faces(s, -d));
        // A source whose middle is just behind a plane is still seen in part.
        let grazing = 0.25 * inverse2 * if s.is_cluster() { s.radius / distance } else { s.area * s.radius / distance };
        // Centres by area leave errors of the second order in the mean, of the first from place to place.
        let (wide, narrow) = (r.radius.max(s.radius) / distance, r.radius / distance);
        let error = factor * (0.5 * narrow + 1.5 * wide * wide + mixed) + 0.2 * grazing;
        // Errors of all that a surface receives from clusters add up: each has to be a small part of its link, or next to
        // nothing.
        let own = factor + grazing;
        let strength = self.strength(source, -d);
        let is_divided = if self.elements.patches.len() <= FEW_PATCHES {
            f64::from(self.sent.most[source as usize]) > 0.0
        } else {
            error > COHERENT * own && error * strength > NOTHING * self.threshold / r.area.sqrt()
        };
        if is_divided && let Some(verdict) = self.divide(receiver, source) {
            return verdict;
        }
        self.settle(receiver, source, [factor, error], kind, -d)
    }

    fn facing(&self, r: &Node, d: DVec3) -> Kind {
        if !r.is_cluster() {
            Kind::Element
        } else if faces(r, d) {
            Kind::Facing
        } else {
            Kind::Mixed
        }
    }

    /// The verdict where clusters or points take part. `d`: from the source to the receiver.
    fn settle(&self, receiver: u32, source: u32, [factor, error]: [f64; 2], kind: Kind, d: DVec3) -> Verdict {
        let allowed = self.threshold / self.node(receiver).area.sqrt();
        let strength = self.strength(source, d);
        let divide = || if source >= POINT { None } else { self.divide(receiver, source) };
        let divide = || match divide() {
            None if self.elements.is_divisible(receiver) => Some(Verdict::DivideReceiver),
            verdict => verdict,
        };
        if error * strength > allowed
            && let Some(verdict) = divide()
        {
            return verdict;
        }
        let all = factor * strength;
        let rays = (RAYS * all / allowed).clamp(RAYS, MOST_RAYS) as u32;
        let seen = self.seen(receiver, source, rays);
        let mut unsure = 2.0 * seen * (1.0 - seen);
        let enough = if source < POINT && self.node(source).is_cluster() { HIDDEN * allowed } else { allowed };
        if all * unsure > enough {
            if let Some(verdict) = divide() {
                return verdict;
            }
            unsure = 0.0;
        }
        let is_cut = kind == Kind::Element && self.node(receiver).is_cut && self.elements.is_divisible(receiver);
        if is_cut && all > CUT * allowed {
            return Verdict::DivideReceiver;
        }
        let is_last = divide().is_none();
        let error = if is_last { 0.0 } else { error + factor * (unsure + UNSEEN_SHARE) };
        Verdict::Keep(Link {
            receiver,
            source,
            factor: factor as f32,
            visible: seen as f32,
            seen: seen as f32,
            error: error as f32,
            shares: Shares::EVEN,
            kind,
        })
    }

    fn by_point(&self, receiver: u32, source: u32) -> Verdict {
        let r = self.node(receiver);
        let light = &self.lights[(source - POINT) as usize];
        let way = light.position - r.centre;
        let distance = way.length();
        let d = way.normalize_or_zero();
        if r.is_cluster() {
            if distance < 2.0 * r.radius {
                return Verdict::DivideReceiver;
            }
            let angle = d.dot(r.normal).clamp(-1.0, 1.0).acos();
            if r.cone < FRAC_PI_2 && angle - r.cone - (r.radius / distance).asin() > FRAC_PI_2 {
                return Verdict::Drop;
            }
            let kind = self.facing(r, d);
            let factor = 1.0 / (distance * distance);
            let error = factor * (r.radius / distance + if kind == Kind::Mixed { 0.15 } else { 0.0 });
            return self.settle(receiver, source, [factor, error], kind, -d);
        }
        let from = self.elements.triangle(r);
        if !from.iter().any(|p| (light.position - p).dot(r.normal) > FLAT * distance) {
            return Verdict::Drop;
        }
        let f = |p: DVec3| point_factor(light.position - p, r.normal);
        let [factor, error] = match spot(r, &from, light.position, 0.0) {
            Some((place, width)) => {
                let factor = solid_angle(from.map(|p| p - light.position)) / triangle_area(&from);
                [factor, SPOT_SHARE * width * f(place)]
            }
            None => {
                let Rough { mean, error, .. } = Rough::of(&f, &from, &quarter_centres(&from));
                [mean, error]
            }
        };
        self.settle(receiver, source, [factor, error], Kind::Element, -d)
    }
}

/// A form factor's mean over a receiver, from a few places.
struct Rough {
    mean: f64,
    /// What of its spread an interpolation would not follow.
    error: f64,
    /// The largest value there.
    most: f64,
    /// Whether it varies by much.
    is_uneven: bool,
}

impl Rough {
    /// `places`: where to look first.
    fn of(f: &impl Fn(DVec3) -> f64, from: &[DVec3; 3], places: &[DVec3; 4]) -> Self {
        let [a, b, c, middle] = places.map(f);
        let rough = 0.25 * (a + b + c + middle);
        let most = a.max(b).max(c).max(middle);
        let spread = most - a.min(b).min(c).min(middle);
        let bend = (middle - (a + b + c) / 3.0).abs();
        let is_uneven = spread > 0.05 * rough;
        let mean = if is_uneven { mean(f, from, 1e-4 * rough.max(1e-3), 4) } else { rough };
        Self { mean, error: bend + SPREAD_SHARE * spread, most, is_uneven }
    }
}

/// Where what is close to a receiver and small against it shines most, and how wide that spot is as a share of the receiver's
/// width. Places that were chosen without regard to the source would miss it.
fn spot(r: &Node, from: &[DVec3; 3], source: DVec3, radius: f64) -> Option<(DVec3, f64)> {
    let nearest = closest(from, source);
    let share = PI * (source.distance_squared(nearest) + radius * radius) / r.area;
    (share < SPOT).then(|| (nearest + INWARDS * (r.centre - nearest), share.sqrt()))
}

/// The same for a source that is not small: where along a strip it is closest to the receiver, such as in a narrow gap.
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
