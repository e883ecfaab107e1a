//! Density estimation: from photons around a point to the radiance that leaves it.
//!
//! The kernel lies on a disk in the tangent plane, of the radius of the estimate; photons on another side of the surface
//! or too far off the plane belong to other surfaces and do not count. Kernels are normalised so that they integrate to 1
//! over the disk: the area is that of a whole disk, so estimates are asked for only where it is whole (see
//! [`super::DiskCoverage`]) or cut it down.
//!
//! Sources: Jensen 2001, *Realistic Image Synthesis Using Photon Mapping*, Sec. 7.2; Silverman 1986, *Density Estimation
//! for Statistics and Data Analysis*.

use std::f32::consts::{FRAC_1_PI, SQRT_2};

use super::super::vertex::Vertex;
use super::{Nearest, Octahedral, Photon, PhotonMap};
use crate::bsdf::Model as _;
use crate::desc::KernelDesc;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// Half the thickness of the disk, in radii: a surface may bend by so much within it.
pub(super) const THICKNESS: f32 = 0.25;

/// Cosine between the normals of photons and that of where they count.
const SAME_SIDE: f32 = 0.8;

/// A kernel, normalised for the unit disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel(KernelDesc);

impl Kernel {
    /// A checked kernel.
    pub fn new(desc: KernelDesc) -> Self {
        Self(desc)
    }

    /// Density [length^-2] at this squared distance from the middle of a disk of this radius; 0 beyond it.
    #[inline]
    pub fn density(self, distance2: f32, radius: f32) -> f32 {
        let radius2 = radius * radius;
        let q = distance2 / radius2;
        if q >= 1.0 {
            return 0.0;
        }
        let shape = match self.0 {
            KernelDesc::Flat => 1.0,
            // Jensen's normalisation, 1 - 2 / (3 k).
            KernelDesc::Cone { k } => (1.0 - q.sqrt() / k) / (1.0 - 2.0 / (3.0 * k)),
            KernelDesc::Epanechnikov => 2.0 * (1.0 - q),
        };
        shape * FRAC_1_PI / radius2
    }
}

impl Kernel {
    /// The part of the integral within this share of the radius.
    #[inline]
    pub fn mass(self, share: f32) -> f32 {
        let t = share.clamp(0.0, 1.0);
        match self.0 {
            KernelDesc::Flat => t * t,
            KernelDesc::Cone { k } => t * t * (1.0 - 2.0 * t / (3.0 * k)) / (1.0 - 2.0 / (3.0 * k)),
            KernelDesc::Epanechnikov => t * t * (2.0 - t * t),
        }
    }
}

/// How a map is asked.
#[derive(Clone, Copy, Debug)]
pub struct MapQuery {
    /// How photons weigh by their distance.
    pub kernel: Kernel,
    /// The radius, or the largest one; above 0 and such that single precision holds its square.
    pub radius: f32,
    /// How many of the nearest photons make the estimate, 2 or more, where not all within the radius do.
    pub neighbours: Option<u32>,
}

/// What the photons around a point come to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate<C: Spectrum> {
    /// Radiance that they make the point send back along the path.
    pub radiance: C,
    /// The same from a kernel of 1 / sqrt(2) the radius: the difference tells the bias.
    pub narrow: C,
    /// Photons that count.
    pub count: u32,
    /// Radius that was used.
    pub radius: f32,
}

impl<C: Spectrum> Estimate<C> {
    /// How much too large the radiance is because light is not the same all over the disk, to the second order.
    ///
    /// The bias of a kernel is c r^2 (Laplacian of the irradiance times half the kernel's second moment); that of the
    /// narrow one is half of it, so it is twice their difference. Hachisuka, Jarosz, Jensen 2010, "A Progressive Error
    /// Estimation Framework for Photon Density Estimation", Eq. 15, with the Laplacian by a difference of kernels.
    pub fn bias(&self) -> C {
        (self.radiance - self.narrow) * 2.0
    }
}

/// The light that photons bring to a vertex and that is scattered back along the path.
///
/// `cut`: the share of the kernel that the surface holds, 1 for a whole disk.
#[inline]
pub(super) fn radiance<C: Spectrum>(
    map: &PhotonMap<C>,
    vertex: &Vertex<C>,
    query: MapQuery,
    cut: impl Fn(Vec3) -> bool,
    nearest: &mut Nearest,
) -> Estimate<C> {
    Gathered::of_vertex(vertex, query).gather(map, query, cut, nearest)
}

/// Irradiance [W m^-2] that photons bring to a flat surface at `p`, on the side of the unit normal `normal`; scene frame.
///
/// The kernel lies on a whole disk: along an edge half of one is empty, in a corner three quarters. `nearest` keeps its
/// memory between calls. With `query.neighbours` k the estimate has no bias but the kernel's, and a relative standard
/// deviation of 1 / sqrt(k - 2) (flat kernel), so none for k = 2.
pub fn irradiance(map: &PhotonMap, p: Vec3, normal: Vec3, query: MapQuery, nearest: &mut Nearest) -> Rgb {
    Gathered::new(p, normal, query).gather(map, query, |_| true, nearest).radiance
}

/// Sums over photons.
struct Gathered<'v, C: Spectrum> {
    p: Vec3,
    kernel: Kernel,
    radius: f32,
    narrow_radius2: f32,
    height: f32,
    normal: Vec3,
    packed_normal: Octahedral,
    /// What makes of each photon's light what it becomes; none where the sum of powers is scattered as one.
    scatters: Option<&'v Vertex<C>>,
    /// Factor of the sum: by Lambert's law, or 1.
    factor: C,
    /// Of the last photons.
    sum: C,
    narrow: C,
    /// Of those before: hundreds of thousands of small numbers are more than single precision can add.
    sums: [C::Wide; 2],
    count: u32,
}

impl<'v, C: Spectrum> Gathered<'v, C> {
    /// Sums of powers.
    #[inline]
    fn new(p: Vec3, normal: Vec3, query: MapQuery) -> Self {
        let radius = query.radius;
        Self {
            p,
            kernel: query.kernel,
            radius,
            narrow_radius2: 0.5 * radius * radius,
            height: THICKNESS * radius,
            normal,
            packed_normal: Octahedral::new(normal),
            scatters: None,
            factor: C::ONE,
            sum: C::ZERO,
            narrow: C::ZERO,
            sums: Default::default(),
            count: 0,
        }
    }

    /// Sums of what a vertex sends back along the path.
    #[inline]
    fn of_vertex(vertex: &'v Vertex<C>, query: MapQuery) -> Self {
        let is_flat = vertex.surface.ng == vertex.surface.ns;
        let (scatters, factor) = match vertex.bsdf.constant_f() {
            Some(f) if is_flat => (None, f),
            _ => (Some(vertex), C::ONE),
        };
        Self { scatters, factor, ..Self::new(vertex.surface.point.p, vertex.facing(), query) }
    }

    #[inline]
    fn gather(
        mut self,
        map: &PhotonMap<C>,
        query: MapQuery,
        cut: impl Fn(Vec3) -> bool,
        nearest: &mut Nearest,
    ) -> Estimate<C> {
        let p = self.p;
        let all = |gathered: &mut Self| {
            map.within(p, query.radius, |photon, distance2| {
                if cut(photon.position()) {
                    gathered.add(photon, distance2);
                }
            });
        };
        let Some(count) = query.neighbours else {
            all(&mut self);
            return self.finish();
        };
        map.nearest(p, count as usize, query.radius, nearest);
        let found = nearest.found();
        // The radius is the distance of the last one, which therefore does not count: with it the density would be too
        // large by k / (k - 1).
        let found = match found {
            [nearer @ .., (farthest, _)] if found.len() == count as usize => {
                let radius = farthest.sqrt();
                if radius < f32::MIN_POSITIVE.sqrt() {
                    // All in one point, which has no density; the widest disk has.
                    all(&mut self);
                    return self.finish();
                }
                self.set_radius(radius);
                nearer
            }
            all => all,
        };
        for &(distance2, index) in found {
            let photon = &map.photons()[index as usize];
            if cut(photon.position()) {
                self.add(photon, distance2);
            }
        }
        self.finish()
    }

    fn set_radius(&mut self, radius: f32) {
        self.radius = radius;
        self.narrow_radius2 = 0.5 * radius * radius;
        self.height = THICKNESS * radius;
    }

    #[inline]
    fn add(&mut self, photon: &Photon<C>, distance2: f32) {
        let height = (photon.position() - self.p).dot(self.normal);
        if height.abs() > self.height
            || (photon.normal != self.packed_normal && photon.normal.get().dot(self.normal) < SAME_SIDE)
        {
            return;
        }
        self.count += 1;
        let mut power = photon.power();
        if let Some(vertex) = self.scatters {
            power *= scattered(vertex, photon);
        }
        self.sum += power * self.kernel.density(distance2, self.radius);
        if distance2 < self.narrow_radius2 {
            self.narrow += power * self.kernel.density(distance2, self.radius * (1.0 / SQRT_2));
        }
        if self.count & 0xff == 0 {
            self.sums[0] += std::mem::take(&mut self.sum).widen();
            self.sums[1] += std::mem::take(&mut self.narrow).widen();
        }
    }

    #[inline]
    fn finish(self) -> Estimate<C> {
        let f = self.factor;
        let [sum, narrow] = [(self.sums[0], self.sum), (self.sums[1], self.narrow)]
            .map(|(before, last)| C::narrow(before + last.widen()));
        Estimate { radiance: f * sum, narrow: f * narrow, count: self.count, radius: self.radius }
    }
}

/// The scattering function for a photon's light; with interpolated normals, per power on the face rather than on the shading
/// normal's: on that which the photon met, as there it came the more rarely the more it grazed. To the vertex's own face a photon
/// of its neighbour may be edge-on, and would count without bound.
fn scattered<C: Spectrum>(vertex: &Vertex<C>, photon: &Photon<C>) -> C {
    let wi = photon.wi.get();
    let local = vertex.to_local(wi);
    let f = vertex.f(local);
    let (ng, ns) = (vertex.surface.ng, vertex.surface.ns);
    if ng == ns {
        return f;
    }
    let ratio = (local.z / wi.dot(photon.normal.get())).abs();
    if ratio.is_finite() { f * ratio } else { C::ZERO }
}

/// The report's estimate of direct light: `None` where a shadow photon is within the radius or fewer than `least` others.
#[inline]
pub(super) fn direct<C: Spectrum>(map: &PhotonMap<C>, vertex: &Vertex<C>, query: MapQuery, least: u32) -> Option<C> {
    let mut gathered = Gathered::of_vertex(vertex, query);
    let mut in_shadow = false;
    map.within(vertex.surface.point.p, query.radius, |photon, distance2| {
        let before = gathered.count;
        gathered.add(photon, distance2);
        in_shadow |= gathered.count > before && photon.is_shadow();
    });
    let estimate = gathered.finish();
    (!in_shadow && estimate.count >= least).then_some(estimate.radiance)
}
