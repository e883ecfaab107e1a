//! Density estimation: from photons around a point to the radiance that leaves the point.
//!
//! The kernel lies on a disk in the tangent plane whose radius is that of the estimate. Photons on another side of the
//! surface or too far off the plane belong to other surfaces and do not count. Kernels are normalised so that they integrate
//! to 1 over the whole disk. Maps are therefore queried only where the surface covers the disk (see
//! [`super::coverage::DiskCoverage`]), or the disk is clipped to the surface.
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

/// Half the thickness of the disk, in radii: the height by which a surface may bend within the disk.
pub(super) const THICKNESS: f32 = 0.25;

/// Least cosine between the normal of a photon and the normal at the point of the estimate for the photon to count.
const SAME_SIDE: f32 = 0.8;

/// A kernel, normalised for the unit disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel(KernelDesc);

impl Kernel {
    /// Creates a kernel from a checked description.
    pub fn new(desc: KernelDesc) -> Self {
        Self(desc)
    }

    /// Density [length^-2] at this squared distance from the centre of a disk of this radius; 0 beyond the radius.
    #[inline]
    pub fn density(self, distance2: f32, radius: f32) -> f32 {
        let radius2 = radius * radius;
        let q = distance2 / radius2;
        if q >= 1.0 {
            return 0.0;
        }
        let shape = match self.0 {
            KernelDesc::Flat => 1.0,
            // This is Jensen's normalisation, 1 - 2 / (3 k).
            KernelDesc::Cone { k } => (1.0 - q.sqrt() / k) / (1.0 - 2.0 / (3.0 * k)),
            KernelDesc::Epanechnikov => 2.0 * (1.0 - q),
        };
        shape * FRAC_1_PI / radius2
    }
}

impl Kernel {
    /// The part of the kernel's integral within this share of the radius.
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

/// The parameters of a query of a photon map.
#[derive(Clone, Copy, Debug)]
pub struct MapQuery {
    /// The kernel that weights photons by their distance.
    pub kernel: Kernel,
    /// The radius, or the largest radius where `neighbours` is set; above 0 and such that single precision holds its square.
    pub radius: f32,
    /// Number of nearest photons that the estimate uses, 2 or more; `None` uses all photons within the radius.
    pub neighbours: Option<u32>,
}

/// The result of a density estimate.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate<C: Spectrum> {
    /// Radiance that the point scatters back along the path.
    pub radiance: C,
    /// The same radiance by a kernel of 1 / sqrt(2) of the radius; the difference of the two estimates the bias.
    pub narrow: C,
    /// Number of photons that count.
    pub count: u32,
    /// The radius that was used.
    pub radius: f32,
}

impl<C: Spectrum> Estimate<C> {
    /// The bias of the radiance to the second order, where light varies over the disk.
    ///
    /// The bias of a kernel is c r^2 (Laplacian of the irradiance times half the kernel's second moment). The bias of the
    /// narrow kernel is half as large, so the bias of the radiance is twice the difference of the two estimates. Hachisuka,
    /// Jarosz, Jensen 2010, "A Progressive Error Estimation Framework for Photon Density Estimation", Eq. 15, with the
    /// Laplacian by a difference of kernels.
    pub fn bias(&self) -> C {
        (self.radiance - self.narrow) * 2.0
    }
}

/// The light of a map's photons that a vertex scatters back along the path.
///
/// `cut` says whether a photon's position lies on the part of the disk that the surface covers; always `true` for a whole
/// disk.
#[inline]
pub(super) fn radiance<C: Spectrum>(
    map: &PhotonMap<C>,
    vertex: &Vertex<'_, C>,
    query: MapQuery,
    cut: impl Fn(Vec3) -> bool,
    nearest: &mut Nearest,
) -> Estimate<C> {
    Gathered::of_vertex(vertex, query).gather(map, query, cut, nearest)
}

/// Irradiance [W m^-2] by the photons on a flat surface at `p`, on the side of the unit normal `normal`; scene frame.
///
/// The kernel's disk is taken to be whole: along an edge half of the disk is empty, in a corner three quarters. `nearest`
/// keeps its memory between calls. With `query.neighbours` k the only bias of the estimate is the kernel's, and its relative
/// standard deviation is 1 / sqrt(k - 2) (flat kernel), which is not finite for k = 2.
pub fn irradiance(map: &PhotonMap, p: Vec3, normal: Vec3, query: MapQuery, nearest: &mut Nearest) -> Rgb {
    Gathered::new(p, normal, query).gather(map, query, |_| true, nearest).radiance
}

/// Sums over photons for one estimate.
struct Gathered<'v, C: Spectrum> {
    p: Vec3,
    kernel: Kernel,
    radius: f32,
    narrow_radius2: f32,
    height: f32,
    normal: Vec3,
    packed_normal: Octahedral,
    /// The vertex that scatters each photon's light; `None` where the Bsdf is constant and scales the sum of powers.
    scatters: Option<&'v Vertex<'v, C>>,
    /// Factor of the sum: the constant Bsdf, or 1.
    factor: C,
    /// Whether the path that asks has its first wavelength alone.
    alone: C::Alone,
    /// Sum over the latest photons.
    sum: C,
    narrow: C,
    /// Sums over the photons before, in double precision: single precision cannot add hundreds of thousands of small
    /// numbers.
    sums: [C::Wide; 2],
    count: u32,
}

impl<'v, C: Spectrum> Gathered<'v, C> {
    /// Starts sums of powers.
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
            alone: C::Alone::default(),
            sum: C::ZERO,
            narrow: C::ZERO,
            sums: Default::default(),
            count: 0,
        }
    }

    /// Starts sums of the radiance that a vertex scatters back along the path.
    #[inline]
    fn of_vertex(vertex: &'v Vertex<'v, C>, query: MapQuery) -> Self {
        let is_flat = vertex.surface.ng == vertex.surface.ns;
        let (scatters, factor) = match vertex.bsdf.constant_f() {
            Some(f) if is_flat => (None, f),
            _ => (Some(vertex), C::ONE),
        };
        let alone = vertex.alone;
        Self { scatters, factor, alone, ..Self::new(vertex.surface.point.p, vertex.facing(), query) }
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
        // The radius is the distance of the farthest photon, which therefore does not count: with it the density would be
        // too large by k / (k - 1).
        let found = match found {
            [nearer @ .., (farthest, _)] if found.len() == count as usize => {
                let radius = farthest.sqrt();
                if radius < f32::MIN_POSITIVE.sqrt() {
                    // All photons lie in one point, where no density exists; the widest disk has one.
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
        let mut power = photon.power_for(self.alone);
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

/// The scattering function for a photon's light. With interpolated normals the photon's power is per area of the face
/// instead of per area perpendicular to the shading normal, so the function is multiplied by the ratio of the cosines. The
/// face is the one that the photon hit, since fewer photons arrive there the more they graze it. To the vertex's own face a
/// photon on a neighbouring face may be edge-on, and its contribution would be unbounded.
fn scattered<C: Spectrum>(vertex: &Vertex<'_, C>, photon: &Photon<C>) -> C {
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

/// The report's estimate of direct light: `None` where a shadow photon lies within the radius or fewer than `least` photons
/// count.
#[inline]
pub(super) fn direct<C: Spectrum>(
    map: &PhotonMap<C>,
    vertex: &Vertex<'_, C>,
    query: MapQuery,
    least: u32,
) -> Option<C> {
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
