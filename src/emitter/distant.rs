//! Light that comes from one direction of infinity, such as that of the sun.

use std::f64::consts::PI;

use super::infinite_ball::InfiniteBall;
use super::{EmitterSample, Receiver};
use crate::math::{DVec3, Vec3};
use crate::sampling::DirectionCone;
use crate::spectrum::Rgb;

/// A disk of even radiance at infinity, or parallel light.
#[derive(Clone, Copy, Debug)]
pub struct DistantEmitter {
    /// Irradiance of a surface across the light [W m^-2].
    irradiance: Rgb,
    /// The directions of the disk; a cone without width for parallel light.
    cone: DirectionCone,
    /// `None` for parallel light.
    radiance: Option<Rgb>,
    /// Whether camera rays see the disk.
    pub visible: bool,
    /// The ball that holds the scene.
    pub ball: InfiniteBall,
}

impl DistantEmitter {
    /// Light that comes from the unit direction `towards` and gives a surface across it this irradiance [W m^-2]. `diameter`: the
    /// angular diameter of its disk \[radian\], from 0 for parallel light to pi.
    pub fn new(irradiance: Rgb, towards: Vec3, diameter: f64, ball: InfiniteBall) -> Self {
        let half = (0.5 * diameter).sin();
        // Irradiance is pi L sin^2 of the angular radius.
        let radiance = (half > 0.0).then(|| Rgb::from_f64(irradiance.to_f64() / (PI * half * half)));
        let cone = DirectionCone { axis: towards, one_minus_cos: (2.0 * (0.25 * diameter).sin().powi(2)) as f32 };
        Self { irradiance, cone, radiance, visible: true, ball }
    }

    /// Whether it is a disk, which rays find, and not parallel light.
    pub fn is_disk(&self) -> bool {
        self.radiance.is_some()
    }

    /// 1 - cos of the angular radius; 0 of parallel light.
    pub fn one_minus_cos(&self) -> f32 {
        self.cone.one_minus_cos
    }

    /// Power that enters the ball (W).
    pub(super) fn power(&self) -> DVec3 {
        let across = match self.radiance {
            None => self.irradiance.to_f64(),
            Some(radiance) => 2.0 * PI * f64::from(self.cone.one_minus_cos) * radiance.to_f64(),
        };
        across * self.ball.cross_section()
    }

    /// A direction towards the light (unit), its density \[sr^-1\] and the radiance; for parallel light the density is 1 and the radiance
    /// stands for the irradiance across the light. `u` uniform in [0, 1)^2.
    #[inline]
    pub fn sample_direction(&self, u: [f32; 2]) -> (Vec3, f32, Rgb) {
        match self.radiance {
            None => (self.cone.axis, 1.0, self.irradiance),
            Some(radiance) => (self.cone.sample(u).normalize(), self.cone.pdf(), radiance),
        }
    }

    /// Samples a direction for a receiver.
    #[inline]
    pub(super) fn sample(&self, receiver: &Receiver, u: [f32; 2]) -> EmitterSample {
        let (wi, pdf, radiance) = self.sample_direction(u);
        EmitterSample {
            wi,
            target: self.ball.beyond(receiver.p, wi),
            radiance,
            pdf,
            emitter: 0,
            is_delta: !self.is_disk(),
        }
    }

    /// The radiance from a unit direction, and the density \[sr^-1\] with which that is sampled; `None` where the disk is not.
    #[inline]
    pub fn seen(&self, direction: Vec3) -> Option<(Rgb, f32)> {
        self.radiance.filter(|_| self.cone.holds(direction)).map(|radiance| (radiance, self.cone.pdf()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Frame;
    use crate::sampling::Rng;

    const SUN: f64 = 0.533;

    fn emitter(degrees: f64) -> DistantEmitter {
        let ball = InfiniteBall::new(Vec3::new(1.0, 2.0, 3.0), 4.0);
        DistantEmitter::new(Rgb::new(3.0, 2.0, 1.0), Vec3::new(0.36, 0.48, 0.8), degrees.to_radians(), ball)
    }

    /// The mean of the light samples' cosine with the axis, over their density, is the irradiance across it; all samples are seen where
    /// they come from, with their density.
    #[test]
    fn samples_give_the_irradiance_across_the_light() {
        for degrees in [1e-3, SUN, 30.0, 180.0] {
            let light = emitter(degrees);
            let mut rng = Rng::new(5, 1);
            let (mut sum, count) = (0.0, 1 << 14);
            let mut unseen = 0;
            for _ in 0..count {
                let (wi, pdf, radiance) = light.sample_direction(rng.next_2d());
                assert!(wi.is_normalized());
                sum += f64::from(radiance.r() * wi.dot(light.cone.axis) / pdf) / f64::from(count);
                match light.seen(wi) {
                    Some(seen) => assert_eq!(seen, (radiance, pdf)),
                    None => unseen += 1,
                }
            }
            // At the edge, rounding puts few on the wrong side; a disk of a thousandth of a degree is hardly wider than that.
            assert!(degrees < 0.01 || unseen * 1000 < count, "{degrees}: {unseen}");
            let tolerance = if degrees > 90.0 { 0.02 } else { 3e-3 };
            assert!((sum / 3.0 - 1.0).abs() < tolerance, "{degrees}: {sum}");
        }
    }

    /// The solid angle in which directions see the disk, by directions around it.
    #[test]
    fn the_disk_of_the_sun_has_its_solid_angle() {
        let light = emitter(SUN);
        let mut rng = Rng::new(6, 1);
        let height = 2.0 * (SUN.to_radians() * 0.25).sin().powi(2) * 4.0;
        let (mut inside, count) = (0, 1 << 18);
        for _ in 0..count {
            let [a, b] = rng.next_2d();
            let fall = f64::from(a) * height;
            let (sine, phi) = ((fall * (2.0 - fall)).sqrt(), 2.0 * PI * f64::from(b));
            let local = DVec3::new(sine * phi.cos(), sine * phi.sin(), 1.0 - fall).as_vec3a();
            inside += u32::from(light.seen(Frame::from_normal(light.cone.axis).to_world(local)).is_some());
        }
        let share = 4.0 * f64::from(inside) / f64::from(count);
        assert!((share - 1.0).abs() < 0.014, "{share}");
    }

    #[test]
    fn parallel_light_is_sampled_alone_and_not_seen() {
        let light = emitter(0.0);
        assert!(!light.is_disk() && light.seen(light.cone.axis).is_none());
        assert_eq!(light.sample_direction([0.3, 0.7]), (light.cone.axis, 1.0, Rgb::new(3.0, 2.0, 1.0)));
        assert!((light.power().x - 3.0 * PI * 16.0).abs() < 1e-3);
        // A small disk brings as much.
        assert!((emitter(0.1).power().x / light.power().x - 1.0).abs() < 1e-5);
    }
}
