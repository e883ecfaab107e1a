//! Queries of several rays at once.
//!
//! Rays without any coherence are traced up to twice as fast in packets as one by one, because the call and its
//! preparation are shared. Embree then traverses each ray by itself, so results have the same bits whatever else is in
//! the packet. Single rays are answered alike to the last bit on some processors only: a ray is therefore traced in a
//! packet even where it is the only one. (Packets for coherent rays would be faster for camera rays, but the choice of
//! a triangle at a shared edge would depend on the other rays.)

use super::ray::{Hit, INVALID};
use super::scene::Scene;
use super::sys;
use super::width::PacketWidth;
use crate::math::{Ray, Vec3, Vec4};

/// Most rays in one packet.
pub const PACKET: usize = 16;

#[inline(always)]
fn transposed([a, b, c, d]: [Vec4; 4]) -> [[f32; 4]; 4] {
    glam::Mat4::from_cols(a, b, c, d).transpose().to_cols_array_2d()
}

macro_rules! packets {
    ($name:ident, $lanes:literal, $align:literal, $Ray:ident, $RayHit:ident, $intersect:ident, $occluded:ident) => {
        mod $name {
            use super::*;

            const LANES: usize = $lanes;

            /// -1 in each lane that holds a ray.
            #[repr(C, align($align))]
            struct Valid([i32; LANES]);

            /// The rays in Embree's form, each up to its `tfar`; lanes without a ray, or with one that is not
            /// traceable, are not valid.
            #[inline(always)]
            fn fill(scene: &Scene, rays: &[Ray], tfar: &impl Fn(usize) -> f32, packet: &mut sys::$Ray) -> Valid {
                packet.mask = [u32::MAX; LANES];
                // Lanes without a ray end before they begin.
                packet.tfar = [-1.0; LANES];
                for (number, four) in rays.chunks(4).enumerate().take(LANES / 4) {
                    // Four rays next to each other become four lanes of each component.
                    let of = |lane: usize| four.get(lane).unwrap_or(&four[0]);
                    let origins: [Vec4; 4] = std::array::from_fn(|lane| of(lane).origin.extend(of(lane).tnear));
                    let directions: [Vec4; 4] = std::array::from_fn(|lane| of(lane).direction.extend(0.0));
                    let [x, y, z, tnear] = transposed(origins);
                    let [dx, dy, dz, _] = transposed(directions);
                    let lanes = 4 * number..4 * number + 4;
                    packet.org_x[lanes.clone()].copy_from_slice(&x);
                    packet.org_y[lanes.clone()].copy_from_slice(&y);
                    packet.org_z[lanes.clone()].copy_from_slice(&z);
                    packet.tnear[lanes.clone()].copy_from_slice(&tnear);
                    packet.dir_x[lanes.clone()].copy_from_slice(&dx);
                    packet.dir_y[lanes.clone()].copy_from_slice(&dy);
                    packet.dir_z[lanes.clone()].copy_from_slice(&dz);
                    for (lane, end) in packet.tfar[lanes].iter_mut().enumerate().take(four.len()) {
                        *end = tfar(4 * number + lane);
                    }
                }
                if scene.inner.features.motion {
                    for (time, ray) in packet.time.iter_mut().zip(rays) {
                        *time = scene.time_of(ray);
                    }
                }
                // `ray::is_traceable`, all lanes side by side.
                let mut valid = Valid([0; LANES]);
                for lane in 0..LANES {
                    let (x, y, z) = (packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]);
                    let not_finite = (packet.org_x[lane] * 0.0 + x * 0.0)
                        + (packet.org_y[lane] * 0.0 + y * 0.0)
                        + (packet.org_z[lane] * 0.0 + z * 0.0);
                    let has_direction = (x != 0.0) | (y != 0.0) | (z != 0.0);
                    let (tnear, tfar) = (packet.tnear[lane], packet.tfar[lane]);
                    let is_valid = (not_finite == 0.0) & has_direction & (tnear >= 0.0) & (tnear <= tfar);
                    valid.0[lane] = -i32::from(is_valid);
                }
                valid
            }

            #[inline(always)]
            pub(super) fn intersect(
                scene: &Scene,
                rays: &[Ray],
                tfar: &impl Fn(usize) -> f32,
                meet: &mut impl FnMut(usize, Hit),
            ) {
                // SAFETY: plain floats and integers, for which all-zero bytes are a value.
                let mut found: sys::$RayHit = unsafe { std::mem::zeroed() };
                let valid = fill(scene, rays, tfar, &mut found.ray);
                found.hit.geomID = [INVALID; LANES];
                found.hit.instID[0] = [INVALID; LANES];
                let mut arguments = scene.intersect_arguments(sys::RTC_RAY_QUERY_FLAG_INCOHERENT);
                // SAFETY: the scene is committed and holds no user geometry (its `width` says so); all structures are
                // local, of the layout that the build script checked, and aligned by their types.
                unsafe {
                    sys::$intersect(valid.0.as_ptr(), scene.inner.raw, &raw mut found, &raw mut arguments);
                }
                for lane in 0..rays.len().min(LANES) {
                    if found.hit.geomID[lane] == INVALID {
                        continue;
                    }
                    let hit = Hit {
                        t: found.ray.tfar[lane],
                        u: found.hit.u[lane],
                        v: found.hit.v[lane],
                        ng: Vec3::new(found.hit.Ng_x[lane], found.hit.Ng_y[lane], found.hit.Ng_z[lane]),
                        prim: found.hit.primID[lane],
                        geom: found.hit.geomID[lane],
                        inst: found.hit.instID[0][lane],
                    };
                    meet(lane, scene.complete_hit(&rays[lane], hit));
                }
            }

            #[inline(always)]
            pub(super) fn occluded(scene: &Scene, rays: &[Ray], blocked: &mut impl FnMut(usize)) {
                // SAFETY: as in `intersect`.
                let mut segments: sys::$Ray = unsafe { std::mem::zeroed() };
                let valid = fill(scene, rays, &|lane| rays[lane].tfar, &mut segments);
                let mut arguments = scene.occluded_arguments();
                // SAFETY: as in `intersect`.
                unsafe {
                    sys::$occluded(valid.0.as_ptr(), scene.inner.raw, &raw mut segments, &raw mut arguments);
                }
                for lane in 0..rays.len().min(LANES) {
                    if valid.0[lane] != 0 && segments.tfar[lane] == f32::NEG_INFINITY {
                        blocked(lane);
                    }
                }
            }
        }
    };
}

packets!(eight, 8, 32, RTCRay8, RTCRayHit8, rtcIntersect8, rtcOccluded8);
packets!(sixteen, 16, 64, RTCRay16, RTCRayHit16, rtcIntersect16, rtcOccluded16);

impl Scene {
    /// The first hit of each ray: the same as [`Scene::intersect`] but for the rounding of distance and place, and faster. Calls `meet` with the index of each ray
    /// that hits a surface. `tfar`: the end of each ray, in place of its own.
    #[inline]
    pub fn intersect_many(&self, rays: &[Ray], tfar: impl Fn(usize) -> f32, mut meet: impl FnMut(usize, Hit)) {
        self.for_each_packet(rays, |begin, rays, width| match width {
            PacketWidth::One => rays.iter().enumerate().for_each(|(lane, ray)| {
                let ray = Ray { tfar: tfar(begin + lane), ..*ray };
                if let Some(hit) = self.intersect(&ray) {
                    meet(begin + lane, hit);
                }
            }),
            PacketWidth::Eight => {
                eight::intersect(self, rays, &|lane| tfar(begin + lane), &mut |lane, hit| meet(begin + lane, hit))
            }
            PacketWidth::Sixteen => {
                sixteen::intersect(self, rays, &|lane| tfar(begin + lane), &mut |lane, hit| meet(begin + lane, hit))
            }
        });
    }

    /// Whether each ray hits any surface: the same as [`Scene::occluded`], but faster. Calls `blocked` with the index
    /// of each ray that does.
    #[inline]
    pub fn occluded_many(&self, rays: &[Ray], mut blocked: impl FnMut(usize)) {
        self.for_each_packet(rays, |begin, rays, width| match width {
            PacketWidth::One => rays.iter().enumerate().for_each(|(lane, ray)| {
                if self.occluded(ray) {
                    blocked(begin + lane);
                }
            }),
            PacketWidth::Eight => eight::occluded(self, rays, &mut |lane| blocked(begin + lane)),
            PacketWidth::Sixteen => sixteen::occluded(self, rays, &mut |lane| blocked(begin + lane)),
        });
    }

    /// Divides rays into packets, and calls `trace` with the index of the first ray, the rays, and the packet's width.
    #[inline(always)]
    fn for_each_packet(&self, rays: &[Ray], mut trace: impl FnMut(usize, &[Ray], PacketWidth)) {
        let lanes = match self.inner.width {
            PacketWidth::Eight => 8,
            PacketWidth::One | PacketWidth::Sixteen => PACKET,
        };
        for (number, packet) in rays.chunks(lanes).enumerate() {
            trace(number * lanes, packet, self.inner.width);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::embree::{
        BuildQuality, Device, DeviceOptions, SceneBuilder, SceneOptions, TriangleMesh, UserGeometry, UserHit,
    };
    use crate::math::{DAffine3, DQuat, DVec3};
    use crate::sampling::Rng;

    fn random(rng: &mut Rng) -> Vec3 {
        Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - Vec3::ONE
    }

    /// Loose triangles, tiny ones among them, and the same as an instance.
    fn triangles(rng: &mut Rng, options: SceneOptions) -> Scene {
        let device = Device::new(&DeviceOptions::default()).unwrap();
        let mut vertices = Vec::new();
        for i in 0..300 {
            let (p, size) = (random(rng), if i % 4 == 0 { 1e-10 } else { 0.3 });
            // Tiny ones around the origin, where coordinates are fine enough for them.
            let p = if i % 4 == 0 { 1e-10 * p } else { p };
            vertices.extend([0; 3].map(|_| (p + size * random(rng)).to_array()));
        }
        let indices = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::new(vertices, indices).unwrap();
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_triangles(mesh.clone()).unwrap();
        let child = builder.commit(None).unwrap();
        let mut builder = SceneBuilder::new(&device, options).unwrap();
        builder.add_triangles(mesh).unwrap();
        let turn = DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7);
        let (stretch, shift) = (DVec3::new(1.3, 0.7, 0.9), DVec3::new(0.5, 0.25, -0.5));
        builder.add_instance(&child, &DAffine3::from_scale_rotation_translation(stretch, turn, shift)).unwrap();
        builder.commit(None).unwrap()
    }

    /// Rays of all lengths, every fourth of them odd, some towards the tiny triangles.
    fn rays(rng: &mut Rng, count: usize) -> Vec<Ray> {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        (0..count)
            .map(|i| {
                let mut ray = Ray { tfar: 3.0 * rng.next_f32(), ..Ray::new(random(rng), random(rng)) };
                let (which, axis) = (odd[i / 40 % 3], i / 120 % 3);
                match i % 40 {
                    3 => ray.origin[axis] = which,
                    7 => ray.direction[axis] = which,
                    11 => ray.direction = Vec3::ZERO,
                    15 => ray.tnear = ray.tfar + 0.1,
                    19 => ray.tfar = f32::NAN,
                    23 => ray.tnear = f32::NAN,
                    27 => ray.tnear = -0.1,
                    31 => ray.direction[axis] = 0.0,
                    // At tiny triangles, whose weights leave the kernel's range.
                    35 | 39 => {
                        let way = 1e-3 * random(rng);
                        ray = Ray::new(1e-10 * random(rng) - 1e-6 * way, way);
                    }
                    _ if i % 3 == 0 => ray.tfar = f32::INFINITY,
                    _ => {}
                }
                ray
            })
            .collect()
    }

    fn bits(hit: Option<Hit>) -> Option<[u32; 9]> {
        let Hit { t, u, v, ng, prim, geom, inst } = hit?;
        Some([t.to_bits(), u.to_bits(), v.to_bits(), ng.x.to_bits(), ng.y.to_bits(), ng.z.to_bits(), prim, geom, inst])
    }

    /// The same hit, and distance, place and normal within a few roundings, which count for more in narrow triangles: on some
    /// processors Embree's packets take other reciprocals than its single rays.
    fn is_alike(a: Option<Hit>, b: Option<Hit>) -> bool {
        let (Some(a), Some(b)) = (a, b) else { return a.is_none() == b.is_none() };
        let [x, y] = [a, b].map(|hit| [hit.t, hit.u, hit.v, hit.ng.x, hit.ng.y, hit.ng.z]);
        let is_near = x.iter().zip(y).all(|(x, y)| (x - y).abs() <= 1e-5 * x.abs().max(1.0));
        (a.prim, a.geom, a.inst) == (b.prim, b.geom, b.inst) && is_near
    }

    /// Packets of any number answer as single rays do, and to the last bit as packets of one ray do: no ray depends on others. Narrower
    /// packets than the processor's are answered too.
    #[test]
    fn packets_of_any_width_and_number_answer_as_single_rays_do() {
        let mut rng = Rng::new(11, 0);
        let with = |robust, compact, quality| SceneOptions { robust, quality, compact };
        for options in [
            SceneOptions::default(),
            with(true, false, BuildQuality::High),
            with(true, true, BuildQuality::Medium),
            with(false, false, BuildQuality::Medium),
            with(false, true, BuildQuality::Low),
        ] {
            let mut scene = triangles(&mut rng, options);
            if scene.inner.width == PacketWidth::One {
                eprintln!("SKIPPED: this Embree has no packets of rays");
                return;
            }
            let widest = scene.inner.width;
            for width in [PacketWidth::One, PacketWidth::Eight, widest] {
                Arc::get_mut(&mut scene.inner).unwrap().width = width;
                let mut met = 0;
                for count in (0..40).chain([4000]) {
                    let rays = rays(&mut rng, count);
                    let end = |number: usize| {
                        if number.is_multiple_of(5) { 0.5 * rays[number].tfar } else { rays[number].tfar }
                    };
                    let mut found = vec![None; count];
                    scene.intersect_many(&rays, end, |number, hit| found[number] = Some(hit));
                    let mut blocked = vec![false; count];
                    scene.occluded_many(&rays, |number| blocked[number] = true);
                    for (i, ray) in rays.iter().enumerate() {
                        let alone = scene.intersect(&Ray { tfar: end(i), ..*ray });
                        assert!(
                            is_alike(found[i], alone),
                            "{options:?}, {width:?}: {ray:?}, {:?}, {alone:?}",
                            found[i]
                        );
                        let mut only = None;
                        scene.intersect_many(std::slice::from_ref(ray), |_| end(i), |_, hit| only = Some(hit));
                        assert_eq!(bits(found[i]), bits(only), "{options:?}, {width:?}: {ray:?}");
                        assert_eq!(blocked[i], scene.occluded(ray), "{options:?}, {width:?}: {ray:?}");
                    }
                    met += found.iter().flatten().count();
                }
                assert!(met > 1000, "{met} rays met anything");
            }
        }
    }

    #[test]
    fn user_geometry_is_asked_one_ray_at_a_time() {
        struct Square;
        impl UserGeometry for Square {
            fn len(&self) -> usize {
                1
            }
            fn bounds(&self, _: usize) -> ([f32; 3], [f32; 3]) {
                ([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0])
            }
            fn intersect(&self, _: usize, ray: &Ray) -> Option<UserHit> {
                let t = -ray.origin.z / ray.direction.z;
                (ray.tnear..=ray.tfar).contains(&t).then_some(UserHit { t, u: 0.5, v: 0.5, ng: Vec3::Z })
            }
        }
        let mut rng = Rng::new(12, 0);
        let device = Device::new(&DeviceOptions::default()).unwrap();
        // Packets are used where they can be, unless this Embree was built without.
        assert_eq!(triangles(&mut rng, SceneOptions::default()).inner.width, PacketWidth::of(device.inner.raw));
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_user(Arc::new(Square)).unwrap();
        let scene = builder.commit(None).unwrap();
        assert_eq!(scene.inner.width, PacketWidth::One);
        let rays = rays(&mut rng, 100);
        let mut met = Vec::new();
        scene.intersect_many(&rays, |number| rays[number].tfar, |number, _| met.push(number));
        let expected: Vec<usize> = (0..100).filter(|&i| scene.intersect(&rays[i]).is_some()).collect();
        assert_eq!(met, expected);
        assert!(met.len() > 10);
    }
}
