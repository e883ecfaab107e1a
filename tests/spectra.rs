//! Light transport is written once over what a path carries: four grey wavelengths bring the image of three grey channels.

mod common;

use std::ops::ControlFlow;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub, SubAssign};
use std::sync::Arc;

use common::scenes::{box_inside, camera, point_light, scene};
use etendue::Alone;
use etendue::camera::Camera;
use etendue::desc::{
    BsdfDesc, DistantLightDesc, IntegratorDesc, RenderDesc, SceneDesc, ShapeDesc, SpectrumDesc, SpectrumKey,
    SpectrumTarget,
};
use etendue::integrator::photon::Plan;
use etendue::integrator::{Context, Direct, Path, SceneTracer, Transport, Whitted};
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings};
use etendue::sampling::{Sampler as _, SobolSampler};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::{Rgb, Sensor, Spectrum};

/// Side of the images, and samples of each pixel.
const SIDE: u32 = 12;
const SAMPLES: u32 = 4;

/// Four wavelengths that see every grey as what it is, and tell other colours apart by their green.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct FourWavelengths([f32; 4]);

impl FourWavelengths {
    fn by_channel(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

macro_rules! operators {
    ($($op:ident $f:ident $assign:ident $g:ident;)*) => {$(
        impl $op for FourWavelengths {
            type Output = Self;
            fn $f(self, other: Self) -> Self {
                self.by_channel(other, $op::$f)
            }
        }
        impl $op<f32> for FourWavelengths {
            type Output = Self;
            fn $f(self, factor: f32) -> Self {
                Self(self.0.map(|value| $op::$f(value, factor)))
            }
        }
        impl $assign for FourWavelengths {
            fn $g(&mut self, other: Self) {
                *self = $op::$f(*self, other);
            }
        }
        impl $assign<f32> for FourWavelengths {
            fn $g(&mut self, factor: f32) {
                *self = $op::$f(*self, factor);
            }
        }
    )*};
}

operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}

impl Spectrum for FourWavelengths {
    /// Nanometres, and the density of each.
    type Wavelengths = [(f32, f32); 4];
    type Packed = [f32; 4];
    type Wide = Sums;
    type Alone = ();

    const HAS_WAVELENGTHS: bool = true;
    const ZERO: Self = Self([0.0; 4]);
    const ONE: Self = Self([1.0; 4]);

    fn splat(value: f32) -> Self {
        Self([value; 4])
    }

    fn max_element(self) -> f32 {
        self.0.into_iter().fold(f32::MIN, f32::max)
    }

    fn recip(self) -> Self {
        Self(self.0.map(f32::recip))
    }

    fn is_finite(self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }

    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    /// Asks for no number, so that paths take the same turns as in RGB.
    fn sample_wavelengths(_: impl FnOnce() -> f32) -> Self::Wavelengths {
        [420.0, 510.0, 600.0, 690.0].map(|nanometres| (nanometres, 1.0 / 400.0))
    }

    fn from_reflectance(color: Rgb, _: &Self::Wavelengths) -> Self {
        Self::splat(color.g())
    }

    /// A factor for each wavelength that the sensor takes out again: channels may not be mixed up on the way.
    fn from_emission(color: Rgb, _: &Self::Wavelengths) -> Self {
        Self(std::array::from_fn(|i| color.g() * (1 << i) as f32))
    }

    fn to_rgb(self, _: &Self::Wavelengths) -> Rgb {
        let values: [f32; 4] = std::array::from_fn(|i| self.0[i] / (1 << i) as f32);
        assert!(values.iter().all(|value| *value == values[0] || value.is_nan()), "{self:?}");
        Rgb::splat(values[0])
    }

    fn pack(self, (): ()) -> [f32; 4] {
        self.0
    }

    fn unpack(packed: [f32; 4], (): ()) -> Self {
        Self(packed)
    }

    fn scale_packed(packed: [f32; 4], factor: f64) -> [f32; 4] {
        packed.map(|value| (f64::from(value) * factor) as f32)
    }

    fn widen(self) -> Sums {
        Sums(self.0.map(f64::from))
    }

    fn narrow(wide: Sums) -> Self {
        Self(wide.0.map(|value| value as f32))
    }

    fn at_wavelengths(wavelengths: &Self::Wavelengths, f: impl Fn(Option<f32>) -> f32) -> Self {
        Self(wavelengths.map(|(nanometres, _)| f(Some(nanometres))))
    }

    fn first_wavelength(wavelengths: &Self::Wavelengths) -> Option<f32> {
        Some(wavelengths[0].0)
    }

    /// Nothing in these scenes disperses.
    fn keep_first(self, (): &mut ()) -> Self {
        unreachable!("no surface disperses")
    }
}

/// Sums of four wavelengths.
#[derive(Clone, Copy, Debug, Default)]
struct Sums([f64; 4]);

impl Add for Sums {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl AddAssign for Sums {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// A closed grey room with a glass ball, a mirror ball, a rough ball and two lights.
fn grey_room() -> SceneDesc {
    let ball = |x: f64, z: f64| ShapeDesc::Sphere { centre: DVec3::new(x, -0.65, z), radius: 0.35 };
    let glow = Some(Rgb::splat(0.5));
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::new(0.0, -0.2, -1.0), 70.0),
        vec![
            (ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Lambert { albedo: Rgb::splat(0.6) }, None),
            (ball(-0.6, -0.2), BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None),
            (ball(0.2, -0.6), BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
            (ball(0.65, 0.1), BsdfDesc::OrenNayar { albedo: Rgb::splat(0.8), roughness: 0.5 }, glow),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc.lights.push(point_light(DVec3::new(0.1, 0.8, 0.0), 1.0));
    desc.render.resolution = [SIDE; 2];
    desc.render.photons.count = Some(20_000);
    desc.render.photons.caustic_count = Some(20_000);
    desc
}

/// The image as colours, by the samples of each pixel one after another.
fn image<C: Spectrum, I: Transport<C>>(scene: &Scene, integrator: &I) -> Vec<[f32; 3]> {
    let camera = Camera::new(scene.camera(), [SIDE; 2], scene.centre()).unwrap();
    let mut sampler = SobolSampler::new(5, u32::MAX);
    let mut tracer = SceneTracer::new(scene);
    let pixel = |pixel: u32| {
        let mut sum = Rgb::ZERO;
        for sample in 0..SAMPLES {
            sampler.start(pixel, sample);
            let [x, y] = sampler.pixel_2d();
            let ray = camera.ray((pixel % SIDE) as f32 + x, (pixel / SIDE) as f32 + y);
            let wavelengths = integrator.wavelengths(&mut sampler, Sensor::Observer);
            let mut context = Context { scene, sampler: &mut sampler, tracer: &mut tracer, wavelengths };
            sum += integrator.li(ray, &mut context, &mut |_| {}).to_rgb(&wavelengths);
        }
        sum.to_array()
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

fn built() -> (SceneDesc, Scene) {
    let desc = grey_room();
    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    (desc, scene)
}

fn assert_lit(image: &[[f32; 3]]) {
    let lit = image.iter().filter(|pixel| pixel[0] > 0.0).count();
    assert!(lit > image.len() / 2, "{lit} of {} pixels have light", image.len());
}

#[test]
fn paths_of_four_grey_wavelengths_bring_the_image_of_rgb() {
    let (_, scene) = built();
    let path = Path::new(None, 1);
    let rgb = image::<Rgb, _>(&scene, &path);
    assert_lit(&rgb);
    assert!(rgb == image::<FourWavelengths, _>(&scene, &path), "paths");
    let whitted = Whitted { max_depth: None, shadow_rays: 2 };
    assert!(image::<Rgb, _>(&scene, &whitted) == image::<FourWavelengths, _>(&scene, &whitted), "whitted");
    let direct = Direct { shadow_rays: 1 };
    assert!(image::<Rgb, _>(&scene, &direct) == image::<FourWavelengths, _>(&scene, &direct), "direct light");
}

#[test]
fn photons_of_four_grey_wavelengths_bring_the_image_of_rgb() {
    let (desc, scene) = built();
    let camera = Camera::new(scene.camera(), [SIDE; 2], scene.centre()).unwrap();
    let settings = Arc::new(desc.render);
    for method in [IntegratorDesc::Sppm, IntegratorDesc::Ppm, IntegratorDesc::Caustic] {
        let rgb = Plan::new(&scene, &camera, &settings, method).unwrap().gather(0, &mut Alone::default()).unwrap();
        let mut plan = Plan::<FourWavelengths>::in_spectrum(&scene, &camera, &settings, method).unwrap();
        let four = plan.gather_in_spectrum(0, &mut Alone::default()).unwrap();
        let rgb = image::<Rgb, _>(&scene, &rgb);
        assert_lit(&rgb);
        assert!(rgb == image::<FourWavelengths, _>(&scene, &four), "{method:?}");
    }
}

#[test]
fn maps_with_one_set_of_wavelengths_for_the_whole_image_are_refused() {
    let (desc, scene) = built();
    let camera = Camera::new(scene.camera(), [SIDE; 2], scene.centre()).unwrap();
    let settings = Arc::new(desc.render);
    for method in [IntegratorDesc::Photon, IntegratorDesc::PhotonDirect, IntegratorDesc::IrradianceCache] {
        let mut plan = Plan::<FourWavelengths>::in_spectrum(&scene, &camera, &settings, method).unwrap();
        let error = plan.gather_in_spectrum(0, &mut Alone::default()).unwrap_err();
        assert_eq!(error.kind(), etendue::ErrorKind::Unsupported, "{method:?}: {error}");
    }
}

/// An edited spectrum shows in the picture of a scene that is rebuilt, and `info` says how many there are.
#[test]
fn spectra_are_edited() {
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 30.0),
        vec![(
            ShapeDesc::sphere(DVec3::ZERO, 0.9).unwrap().0,
            BsdfDesc::Lambert { albedo: Rgb::splat(0.5) },
            Some(Rgb::splat(0.25)),
        )],
    );
    desc.lights.push(point_light(DVec3::new(2.0, 2.0, 3.0), 9.0));
    desc.add_distant_light(DistantLightDesc::parallel(DVec3::Z, Rgb::ONE)).unwrap();
    desc.set_environment(Some(Rgb::splat(0.25))).unwrap();
    let picture = |scene: &Scene| {
        let desc = RenderDesc { resolution: [6, 6], samples: 4, spectral: true, ..RenderDesc::default() };
        let settings = RenderSettings { desc, threads: 1, ..RenderSettings::default() };
        let mut render = Render::new(scene, settings).unwrap();
        render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        render.image().rgb
    };
    let options = BuildOptions::default();
    let mut built = Scene::build(&desc, &options).unwrap();
    let mut before = picture(&built);
    let ramp = || SpectrumDesc::samples("", [[400.0, 0.9], [700.0, 0.1]]).unwrap();
    for (number, of) in [
        SpectrumTarget::PointLight(0),
        SpectrumTarget::DistantLight(0),
        SpectrumTarget::Environment,
        SpectrumTarget::Surface(0),
        SpectrumTarget::Material(0, SpectrumKey::Color),
    ]
    .into_iter()
    .enumerate()
    {
        for spectrum in [SpectrumDesc::BlackBody(2500.0), ramp()] {
            if matches!(of, SpectrumTarget::Material(..)) && !matches!(spectrum, SpectrumDesc::Samples(_)) {
                assert!(desc.set_spectrum(of, Some(spectrum)).is_err());
                continue;
            }
            desc.set_spectrum(of, Some(spectrum.clone())).unwrap();
            assert_eq!(desc.spectrum(of), Some(&spectrum));
            built = built.rebuild(&desc, &options).unwrap();
            let after = picture(&built);
            assert!(after != before, "{of:?}: the picture is the old one");
            assert_eq!(after, picture(&Scene::build(&desc, &options).unwrap()), "{of:?}");
            before = after;
        }
        let lamps = (number + 1).min(4);
        let expected = format!("{lamps} emitters and {} materials have spectra", number / 4);
        assert!(built.info().to_string().contains(&expected), "{}", built.info());
    }
    // Taken away again, the colours stay and the spectra do not.
    let colors = (desc.lights[0].intensity, desc.surfaces[0].emission);
    desc.set_spectrum(SpectrumTarget::PointLight(0), None).unwrap();
    desc.set_spectrum(SpectrumTarget::Surface(0), None).unwrap();
    assert_eq!((desc.lights[0].intensity, desc.surfaces[0].emission), colors);
    let after = picture(&built.rebuild(&desc, &options).unwrap());
    assert!(after != before);
    assert_eq!(after, picture(&Scene::build(&desc, &options).unwrap()));
    assert!(desc.set_spectrum(SpectrumTarget::PointLight(7), None).is_err());
    assert!(desc.set_spectrum(SpectrumTarget::Material(0, SpectrumKey::Eta), Some(ramp())).is_err());
}
