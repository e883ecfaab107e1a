//! Light from infinity, the same from all directions.

use std::f64::consts::PI;

use super::infinite_ball::InfiniteBall;
use super::{Departure, EmitterSample, Receiver};
use crate::math::{DVec3, Frame, HitPoint, Vec3};
use crate::sampling::warps;
use crate::spectrum::Rgb;

/// An environment of uniform radiance, infinitely far away.
///
/// A receiver with a normal is given cosine-distributed directions, any other uniform ones. Photons begin on the ball that
/// holds the scene.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentEmitter {
    /// Radiance from every direction [W m^-2 sr^-1].
    pub radiance: Rgb,
    /// Whether camera rays see it.
    pub visible: bool,
    /// The ball that holds the scene.
    pub ball: InfiniteBall,
}

impl EnvironmentEmitter {
    /// An environment that camera rays see, around everything that lies in the ball, scene frame.
    pub fn new(radiance: Rgb, ball: InfiniteBall) -> Self {
        Self { radiance, visible: true, ball }
    }

    /// Power that enters the ball (W): pi L A.
    pub(super) fn power(&self) -> DVec3 {
        PI * self.ball.area() * self.radiance.to_f64()
    }

    /// Samples a direction for a receiver.
    #[inline]
    pub(super) fn sample(&self, receiver: &Receiver, u: [f32; 2]) -> EmitterSample {
        let wi = match receiver.normal() {
            Some(normal) => Frame::from_normal(normal).to_world(warps::cosine_hemisphere(u)).normalize(),
            None => warps::uniform_sphere(u),
        };
        let target = self.ball.beyond(receiver.p, wi);
        EmitterSample { wi, target, radiance: self.radiance, pdf: self.pdf(receiver, wi), emitter: 0, is_delta: false }
    }

    /// Density of a direction (sr^-1).
    #[inline]
    pub(super) fn pdf(&self, receiver: &Receiver, wi: Vec3) -> f32 {
        match receiver.normal() {
            Some(normal) => warps::cosine_hemisphere_pdf(normal.dot(wi)),
            None => (0.25 / PI) as f32,
        }
    }

    /// A place on the ball, uniformly by area, with the normal inwards.
    #[inline]
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        let outwards = warps::uniform_sphere(u);
        Departure {
            point: HitPoint::new(self.ball.centre() + outwards * self.ball.radius(), 0.0),
            normal: Some(-outwards),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::Alone;
    use crate::bsdf::{Bsdf, Lambert, Model as _, TransportMode};
    use crate::camera::Camera;
    use crate::desc::{BsdfDesc, IntegratorDesc, PhotonDesc, RenderDesc, SceneDesc, ShapeDesc, SurfaceLook};
    use crate::emitter::{Emitter, EmitterSet, TriangleEmitter};
    use crate::integrator::photon::{MapKind, NARROW, PhotonJob, Plan, shoot};
    use crate::integrator::{Direct, Integrator, Path, SceneTracer, Whitted};
    use crate::math::Ray;
    use crate::sampling::{Rng, Sampler as _, SobolSampler};
    use crate::scene::{BuildOptions, Scene};
    use crate::shape::Triangle;

    const RADIANCE: Rgb = Rgb::new(0.5, 1.0, 2.0);

    fn environment(centre: Vec3) -> Emitter {
        Emitter::Environment(EnvironmentEmitter::new(RADIANCE, InfiniteBall::new(centre, 2.0)))
    }

    /// A ball of radius 1 about the origin, alone in a uniform environment.
    fn ball(bsdf: BsdfDesc) -> Scene {
        let mut desc = SceneDesc::default();
        let material = desc.add_material("ball", bsdf, None).unwrap();
        let (shape, local) = ShapeDesc::sphere(DVec3::ZERO, 1.0).unwrap();
        let look = SurfaceLook { material: Some(material), ..Default::default() };
        desc.add_surface(shape, local, look).unwrap();
        let mut scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let near_ball = scene.to_scene(DVec3::new(0.1, -0.2, 0.3));
        scene.set_emitters(EmitterSet::new(vec![environment(near_ball)]));
        scene
    }

    /// Mean of estimates of the radiance along rays at the ball, and its standard error.
    fn mean(scene: &Scene, integrator: &impl Integrator) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        const SAMPLES: u32 = 4096;
        let mut sampler = SobolSampler::new(7, u32::MAX);
        let mut tracer = SceneTracer::new(scene);
        for sample in 0..SAMPLES {
            sampler.start(sample % 64, sample / 64);
            let [x, y] = sampler.pixel_2d();
            let origin = Vec3::new(0.9 * (x - 0.5), 0.9 * (y - 0.5), 3.0) + scene.to_scene(DVec3::ZERO);
            let radiance =
                integrator.radiance(scene, Ray::new(origin, -Vec3::Z), &mut sampler, &mut tracer, &mut |_| {});
            let value = f64::from((radiance / RADIANCE).g());
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(SAMPLES);
        let variance = (squares / f64::from(SAMPLES) - mean * mean).max(0.0);
        (mean, (variance / f64::from(SAMPLES)).sqrt())
    }

    #[test]
    fn bodies_in_a_uniform_environment_send_what_they_scatter() {
        let path = Path::new(None, 1);
        let whitted = Whitted { max_depth: None, shadow_rays: 1 };
        // Light meets a convex diffuse body once, so it sends its albedo; what absorbs nothing cannot be seen.
        let albedo = Rgb::splat(0.6);
        let cases = [
            (BsdfDesc::Lambert { albedo }, 0.6),
            (BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, 0.9),
            (BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, 1.0),
            (BsdfDesc::Black, 0.0),
        ];
        for (bsdf, exact) in cases {
            let scene = ball(bsdf);
            let direct = Direct { shadow_rays: 1 };
            let mut means = vec![("path", mean(&scene, &path)), ("whitted", mean(&scene, &whitted))];
            // Through glass, local illumination sees no light.
            if !matches!(bsdf, BsdfDesc::Dielectric { .. }) {
                means.push(("direct", mean(&scene, &direct)));
            }
            let camera = Camera::new(scene.camera(), [8; 2], scene.centre()).unwrap();
            for method in [IntegratorDesc::Sppm, IntegratorDesc::Caustic, IntegratorDesc::PhotonDirect] {
                let photons = PhotonDesc { count: Some(1000), ..PhotonDesc::default() };
                let settings = RenderDesc { resolution: [8; 2], photons, ..RenderDesc::default() };
                let mut plan = Plan::new(&scene, &camera, &Arc::new(settings), method).unwrap();
                let gather = plan.gather(0, &mut Alone::default()).unwrap();
                if method != IntegratorDesc::PhotonDirect || !matches!(bsdf, BsdfDesc::Lambert { .. }) {
                    means.push((method.name(), mean(&scene, &gather)));
                }
            }
            for (name, (mean, error)) in means {
                let tolerance = 4.0 * error + 1e-5;
                assert!((mean - exact).abs() < tolerance, "{bsdf:?}, {name}: {mean} ± {error}, not {exact}");
                assert!(tolerance < 0.02, "{bsdf:?}, {name}: {error} shows nothing of 2 %");
            }
        }
    }

    #[test]
    fn a_ray_that_meets_nothing_sees_the_environment() {
        let mut scene = Scene::build(&SceneDesc::default(), &BuildOptions::default()).unwrap();
        let path = Path::new(Some(1), 1);
        let see = |scene: &Scene| {
            let (mut sampler, mut tracer) = (SobolSampler::new(1, 1), SceneTracer::new(scene));
            path.radiance(scene, Ray::new(Vec3::ZERO, Vec3::X), &mut sampler, &mut tracer, &mut |_| {})
        };
        assert_eq!(see(&scene), Rgb::ZERO);
        scene.set_emitters(EmitterSet::new(vec![environment(Vec3::ZERO)]));
        assert_eq!(see(&scene), RADIANCE);
    }

    /// Of the power that enters the ball around the scene, a body gets its share of the surface: pi L times its own area.
    #[test]
    fn photons_bring_the_light_of_the_environment() {
        let scene = ball(BsdfDesc::Lambert { albedo: Rgb::splat(0.5) });
        let job = PhotonJob {
            kind: MapKind::Global,
            paths: 1 << 16,
            pass: 0,
            most: usize::MAX,
            narrow_below: NARROW,
            time: 0.0,
        };
        let batch = shoot(&scene, &RenderDesc::default(), job, &mut Alone::default()).unwrap();
        let exact = PI * 4.0 * PI * RADIANCE.to_f64();
        let stored: DVec3 = batch.photons.iter().map(|photon| photon.power().to_f64()).sum();
        let ratio = stored / exact;
        // Of 65536 paths about a quarter meet the ball: a binomial error of 0.7 %.
        assert!((ratio - 1.0).abs().max_element() < 0.02, "{ratio}");
        let emitted = batch.tally.emitted / (PI * 16.0 * PI * RADIANCE.to_f64());
        assert!((emitted - 1.0).abs().max_element() < 1e-5, "{emitted}");
    }

    /// Among many lamps with a place, too: probabilities of both ways to ask agree, and irradiance is right.
    #[test]
    fn environments_are_chosen_beside_a_tree_of_lights() {
        let lamp = |i: usize| {
            let corner = Vec3::new(i as f32, 5.0, 0.0);
            let triangle = Triangle::new([corner, corner + Vec3::X * 0.1, corner + Vec3::Z * 0.1]).unwrap();
            Emitter::Triangle(TriangleEmitter::new(triangle, Rgb::splat(1e-6), 0.0))
        };
        let mut emitters: Vec<Emitter> = (0..10).map(lamp).collect();
        emitters.insert(3, environment(Vec3::ZERO));
        let set = EmitterSet::new(emitters);
        let receiver = Receiver::facing(Vec3::ZERO, Vec3::Y);
        let total: f32 = (0..11).map(|index| set.probability(index, receiver)).sum();
        assert!((total - 1.0).abs() < 1e-5, "{total}");
        let mut rng = Rng::new(3, 1);
        let bsdf: Bsdf = Bsdf::Lambert(Lambert::new(Rgb::ONE));
        let (mut sum, count) = (0.0, 1 << 14);
        for _ in 0..count {
            let Some(sample) = set.sample(receiver, rng.next_4d()) else { continue };
            if sample.radiance == RADIANCE {
                let pdf = set.pdf_infinite(3, receiver, sample.wi);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-4, "{pdf} and {}", sample.pdf);
            }
            let f = bsdf.f(Vec3::Z, Vec3::Z, TransportMode::Radiance).g();
            sum += f64::from(f * sample.radiance.g() * sample.wi.y.max(0.0) / sample.pdf);
        }
        let mean = sum / f64::from(count);
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    }
}
