//! Rays of a host in columns of its memory, and the columns that receive what they hit.

use super::boundary::need;
use super::host_rays::{HostRay, HostRays, in_lengths};
use super::status::{Failure, Result};
use super::types::{ETD_NONE, etd_ray_query};
use crate::math::Ray;
use crate::scene::{Hit, Scene};

/// Values of one kind, `N` numbers for each ray, in the host's memory.
#[derive(Clone, Copy)]
struct Column<T, const N: usize> {
    /// The numbers of the first ray; NULL where the host has or wants none.
    first: *mut T,
    /// Bytes from the numbers of one ray to those of the next.
    stride: usize,
}

impl<T: Copy, const N: usize> Column<T, N> {
    const NONE: Self = Self { first: std::ptr::null_mut(), stride: 0 };

    /// A column as the host describes it. `name`: of the pointer.
    fn new(first: *const T, stride: usize, count: usize, name: &str) -> Result<Self> {
        if first.is_null() || count == 0 {
            return Ok(Self::NONE);
        }
        need(first, name)?;
        let least = N * size_of::<T>();
        let stride = if stride == 0 { least } else { stride };
        if stride < least || stride % align_of::<T>() != 0 {
            let message = format!(
                "{name}_stride is {stride}, expected 0 or at least {least} bytes in steps of {}",
                align_of::<T>()
            );
            return Err(Failure::argument(message));
        }
        if count.checked_mul(stride).is_none_or(|bytes| isize::try_from(bytes).is_err()) {
            return Err(Failure::argument(format!("{name} of {count} rays is more than any memory holds")));
        }
        Ok(Self { first: first.cast_mut(), stride })
    }

    fn is_some(self) -> bool {
        !self.first.is_null()
    }

    /// # Safety
    /// The numbers of the ray must be readable, or the column NULL.
    #[inline(always)]
    unsafe fn read(self, ray: usize) -> Option<[T; N]> {
        // SAFETY: the caller keeps this function's contract; arrays have the alignment of their items.
        self.is_some().then(|| unsafe { self.first.byte_add(ray * self.stride).cast::<[T; N]>().read() })
    }

    /// Writes the numbers of a ray, where they are wanted.
    ///
    /// # Safety
    /// The numbers of the ray must be writable, or the column NULL. They need not be initialised.
    #[inline(always)]
    unsafe fn write(self, ray: usize, numbers: [T; N]) {
        if self.is_some() {
            // SAFETY: as in `read`.
            unsafe { self.first.byte_add(ray * self.stride).cast::<[T; N]>().write(numbers) };
        }
    }
}

/// Rays in the memory of a host, and what it wants to know of each.
#[derive(Clone, Copy)]
pub(super) struct RayColumns {
    pub count: usize,
    origins: Column<f32, 3>,
    directions: Column<f32, 3>,
    tnear: Column<f32, 1>,
    tfar: Column<f32, 1>,
    times: Column<f32, 1>,
    active: Column<u8, 1>,
    occluded: Column<u8, 1>,
    t: Column<f32, 1>,
    positions: Column<f64, 3>,
    barycentric: Column<f32, 2>,
    uv: Column<f32, 2>,
    ng: Column<f32, 3>,
    ns: Column<f32, 3>,
    surfaces: Column<u32, 1>,
    materials: Column<u32, 1>,
    primitives: Column<u32, 1>,
}

// SAFETY: the pointers are to memory that the host lets the call use, on whatever threads; threads write to different rays.
unsafe impl Send for RayColumns {}
// SAFETY: as above.
unsafe impl Sync for RayColumns {}

impl RayColumns {
    /// The columns of a query. Errors name the field.
    pub fn of_query(query: &etd_ray_query) -> Result<Self> {
        macro_rules! columns {
            ($($name:ident $stride:ident,)*) => {
                Self {
                    count: query.count,
                    $($name: Column::new(query.$name, query.$stride, query.count, concat!("query.", stringify!($name)))?,)*
                }
            };
        }
        if query.count > 0 {
            need(query.origins, "query.origins")?;
            need(query.directions, "query.directions")?;
        }
        Ok(columns! {
            origins origins_stride,
            directions directions_stride,
            tnear tnear_stride,
            tfar tfar_stride,
            times times_stride,
            active active_stride,
            occluded occluded_stride,
            t t_stride,
            positions positions_stride,
            barycentric barycentric_stride,
            uv uv_stride,
            ng ng_stride,
            ns ns_stride,
            surfaces surfaces_stride,
            materials materials_stride,
            primitives primitives_stride,
        })
    }

    /// Whether it is wanted what was hit.
    fn wants_numbers(&self) -> bool {
        self.surfaces.is_some() || self.materials.is_some() || self.primitives.is_some() || self.barycentric.is_some()
    }

    /// Whether anything is wanted that is computed from the shape of the surface.
    fn wants_surface(&self) -> bool {
        self.positions.is_some() || self.ng.is_some() || self.ns.is_some()
    }
}

impl HostRays for RayColumns {
    #[inline(always)]
    fn wants_first_hit(&self) -> bool {
        self.t.is_some() || self.wants_numbers() || self.wants_surface() || self.uv.is_some()
    }

    #[inline(always)]
    fn wants_data_of_triangles(&self) -> bool {
        self.wants_surface() || self.uv.is_some()
    }

    #[inline(always)]
    unsafe fn is_active(&self, number: usize) -> bool {
        // SAFETY: the caller keeps this function's contract.
        unsafe { self.active.read(number) != Some([0]) }
    }

    #[inline(always)]
    unsafe fn ray(&self, number: usize) -> HostRay {
        // SAFETY: the caller keeps this function's contract.
        unsafe {
            HostRay {
                origin: self.origins.read(number).unwrap_or_default(),
                direction: self.directions.read(number).unwrap_or_default(),
                tnear: self.tnear.read(number).map_or(0.0, |[it]| it),
                tfar: self.tfar.read(number).map_or(f32::INFINITY, |[it]| it),
                time: self.times.read(number).map_or(0.0, |[it]| it),
            }
        }
    }

    #[inline(always)]
    unsafe fn write_hit(&self, number: usize, scene: &Scene, ray: &Ray, length: f32, hit: &Hit) {
        // SAFETY: the caller keeps this function's contract.
        unsafe {
            self.t.write(number, [in_lengths(hit.t, length)]);
            self.occluded.write(number, [1]);
            if self.wants_numbers() {
                let (surface, material) = scene.hit_owner(hit);
                let (barycentric, primitive) = scene.hit_part(hit);
                self.surfaces.write(number, [surface]);
                self.materials.write(number, [material.unwrap_or(ETD_NONE)]);
                self.primitives.write(number, [primitive]);
                self.barycentric.write(number, barycentric);
            }
            if self.wants_surface() {
                let at = scene.interaction(ray, hit);
                self.ng.write(number, at.ng.to_array());
                self.ns.write(number, at.ns.to_array());
                self.positions.write(number, (at.point.p.as_dvec3() + scene.centre()).to_array());
            }
            if self.uv.is_some() {
                self.uv.write(number, scene.uv(hit));
            }
        }
    }

    #[inline(always)]
    unsafe fn write_miss(&self, number: usize) {
        // SAFETY: the caller keeps this function's contract.
        unsafe {
            self.t.write(number, [f32::INFINITY]);
            self.occluded.write(number, [0]);
            self.surfaces.write(number, [ETD_NONE]);
            self.materials.write(number, [ETD_NONE]);
            self.primitives.write(number, [0]);
            self.barycentric.write(number, [0.0; 2]);
            self.ng.write(number, [0.0; 3]);
            self.ns.write(number, [0.0; 3]);
            self.positions.write(number, [0.0; 3]);
            self.uv.write(number, [0.0; 2]);
        }
    }

    #[inline(always)]
    unsafe fn write_occluded(&self, number: usize, is_occluded: bool) {
        // SAFETY: the caller keeps this function's contract.
        unsafe { self.occluded.write(number, [u8::from(is_occluded)]) };
    }
}
