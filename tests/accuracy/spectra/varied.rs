//! Temperatures of lamps and thicknesses of films that textures vary, against as many surfaces that each have one of their own.

use super::{build, channels};
use crate::common::scenes::{Job, add, camera, render_scene, scene};
use crate::record::Case;
use crate::textures::{described, image, row_texture};
use crate::transport::{glass, grey, parallelogram, pick, plane};
use etendue::desc::{
    BsdfDesc, ConductorDesc, EnvironmentDesc, IntegratorDesc, MicrofacetsDesc, PhotonDesc, RenderDesc, SceneDesc,
    SpectrumDesc, SpectrumKey, SpectrumTarget, TextureBinding, TextureKey, ThinFilmDesc,
};
use etendue::math::DVec3;
use etendue::spectrum::{Illuminant, Rgb, SmoothSpectrum, rec_709, tristimulus};
use etendue::texture::{ColorSpace, TextureFilter};

/// What textures multiply by, from left to right.
const FACTORS: [f32; 4] = [0.65, 0.8, 1.0, 1.25];

/// A rectangle, whole or as four strips.
struct Strips {
    corner: DVec3,
    u: DVec3,
    v: DVec3,
}

impl Strips {
    fn whole(&self) -> etendue::desc::ShapeDesc {
        parallelogram(self.corner, self.u, self.v)
    }

    fn each(&self) -> [etendue::desc::ShapeDesc; 4] {
        [0, 1, 2, 3].map(|i| parallelogram(self.corner + self.u * (f64::from(i) / 4.0), self.u / 4.0, self.v))
    }
}

/// Binds a texture of [`FACTORS`] to a parameter of material 1.
fn bind(desc: &mut SceneDesc, key: TextureKey) {
    let texture = desc.add_texture(row_texture(&FACTORS)).expect("a texture of the test");
    let mut material = desc.materials[1].clone();
    material.textures.push(TextureBinding::whole(key, texture));
    desc.set_material_desc(1, material).expect("a material of the test");
}

fn compare(case: &mut Case, what: &str, [varied, strips]: [&SceneDesc; 2], methods: &[IntegratorDesc], bias: f64) {
    let [varied, strips] = [varied, strips].map(build);
    for integrator in methods.iter().copied() {
        for spectral in [false, true] {
            let is_in_passes = integrator == IntegratorDesc::Sppm;
            let (resolution, samples) =
                if is_in_passes { ([4, 4], case.count(256, 2048)) } else { ([16, 16], case.count(128, 2048)) };
            let job = Job { resolution, samples: samples as u32, integrator, ..Job::default() };
            let render = |scene, seed| {
                let photons = PhotonDesc { count: Some(2000), ..PhotonDesc::default() };
                let desc = RenderDesc { spectral, photons, ..Job { seed, ..job }.desc() };
                channels(&render_scene(scene, desc).0)
            };
            let (found, expected) = (render(&varied, 1), render(&strips, 2));
            let most = expected.iter().map(|channel| channel.0).fold(0.0, f64::max);
            for (channel, ((mean, error), (exact, noise))) in found.into_iter().zip(expected).enumerate() {
                let of = if spectral { "wavelengths" } else { "colours" };
                let name = integrator.name();
                let what = format!("{what}, {name}, {of}, channel {channel}: difference over the largest");
                let off = (1.0 + (mean - exact) / most, error.hypot(noise) / most);
                let noise = if is_in_passes { pick(case, 3e-2, 1.2e-2) } else { pick(case, 1.5e-2, 4e-3) };
                case.biased_mean(what, off, 1.0, (bias, noise));
            }
        }
    }
}

pub fn all(case: &mut Case) {
    temperatures(case);
    films(case);
    interpolated(case);
}

/// A wall between red and blue texels, and between two dark ones, under light of a known spectrum: at each wavelength it reflects the mean
/// of both. The spectrum of the mean colour is another one, as the last comparison says.
fn interpolated(case: &mut Case) {
    let pairs = [
        ([0.8, 0.05, 0.05], [0.05, 0.1, 0.7], 1e-2),
        // The colours of pbrt-v4's issue 82.
        ([0.213_324_93, 0.044_518_38, 0.003_814_985], [0.046_028_335, 0.056_155_182, 0.077_383_96], 1e-3),
    ];
    let lamp = SpectrumDesc::by_name("A").expect("known");
    let scale = 1.0 / tristimulus(|nanometres| Illuminant::A.power(nanometres)).y;
    for (number, (left, right, apart)) in pairs.into_iter().enumerate() {
        let sheet = BsdfDesc::DiffuseTransmission { reflectance: Rgb::ONE, transmittance: Rgb::ZERO };
        let walls = [
            (TextureFilter::Bilinear, "wall", grey(1.0)),
            (TextureFilter::Mip, "wall", grey(1.0)),
            (TextureFilter::Bilinear, "sheet", sheet),
        ];
        for (filter, of, bsdf) in walls {
            // Half way between the two texels, and nearly nothing of the way to either.
            let view = camera(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO, 0.01);
            let wall = parallelogram(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
            let mut desc = scene(view, vec![(wall, bsdf, None)]);
            let sky = EnvironmentDesc { spectrum: Some(lamp.clone()), ..EnvironmentDesc::even(Rgb::ONE) };
            desc.set_environment_desc(Some(sky)).expect("a sky");
            let image = image(2, 1, 3, |x, _, c| if x == 0 { left[c as usize] } else { right[c as usize] });
            let texture = described("colours", &image, ColorSpace::Linear, filter, 1.0);
            let texture = desc.add_texture(texture).expect("a texture of the test");
            let mut material = desc.materials[0].clone();
            material.textures.push(TextureBinding::whole(TextureKey::Color, texture));
            desc.set_material_desc(0, material).expect("a material of the test");
            let job = Job { resolution: [8, 8], samples: case.count(1024, 8192) as u32, ..Job::default() };
            let found = channels(&render_scene(&build(&desc), RenderDesc { spectral: true, ..job.desc() }).0);
            let color = |reflectance: &dyn Fn(f64) -> f64| {
                rec_709(|nanometres| reflectance(nanometres) * Illuminant::A.power(nanometres) * scale).to_array()
            };
            let [a, b] = [left, right].map(|it| SmoothSpectrum::of_color(Rgb::from_array(it)));
            let exact = color(&|nanometres| 0.5 * f64::from(a.at(nanometres as f32) + b.at(nanometres as f32)));
            let most = exact.into_iter().fold(0.0, f64::max);
            for (channel, (mean, error)) in found.into_iter().enumerate() {
                let what = format!("pair {number}, {of}, {filter:?}, channel {channel}: difference over the largest");
                let off = (1.0 + (mean - exact[channel]) / most, error / most);
                case.biased_mean(what, off, 1.0, (5e-4, pick(case, 1e-2, 3e-3)));
            }
            let mean = SmoothSpectrum::of_color(Rgb::from_array([0, 1, 2].map(|c: usize| 0.5 * (left[c] + right[c]))));
            let other = color(&|nanometres| f64::from(mean.at(nanometres as f32)));
            let away = (0..3).map(|c| (other[c] - exact[c]).abs() / most).fold(0.0, f64::max);
            let what = format!("pair {number}, {of}, {filter:?}: the spectrum of the mean colour is another");
            case.holds(what, &format!("> {apart}"), format!("{away:.4}"), away > apart);
        }
    }
}

/// A grey floor under a lamp that glows at four temperatures, and the lamp itself.
fn temperatures(case: &mut Case) {
    const KELVIN: f64 = 3200.0;
    let lamp = Strips { corner: DVec3::new(-1.0, 0.6, -0.6), u: DVec3::X * 2.0, v: DVec3::new(0.0, 0.8, 0.3) };
    let floor = || {
        let view = camera(DVec3::new(0.0, 1.2, 4.0), DVec3::new(0.0, 0.4, 0.0), 35.0);
        scene(view, vec![(plane(DVec3::ZERO, DVec3::Y, 3.0), grey(0.7), None)])
    };
    let glow = |desc: &mut SceneDesc, shape, kelvin: f64| {
        add(desc, 1, shape, BsdfDesc::Black, None);
        let number = desc.materials.len() - 1;
        let of = SpectrumTarget::Material(number, SpectrumKey::Emission);
        desc.set_spectrum(of, Some(SpectrumDesc::BlackBody(kelvin))).expect("a black body");
    };
    let mut varied = floor();
    glow(&mut varied, lamp.whole(), KELVIN);
    bind(&mut varied, TextureKey::Temperature);
    let mut strips = floor();
    for (shape, factor) in lamp.each().into_iter().zip(FACTORS) {
        glow(&mut strips, shape, KELVIN * f64::from(factor));
    }
    compare(case, "temperatures", [&varied, &strips], &[IntegratorDesc::Path, IntegratorDesc::Sppm], 1e-3);
}

/// Films before a lamp and before a bright wall: soap, coated glass that is smooth or rough, an oxide that is smooth or rough.
fn films(case: &mut Case) {
    let sheet = Strips { corner: DVec3::new(-1.0, -1.0, 0.0), u: DVec3::X * 2.0, v: DVec3::Y * 2.0 };
    let rough = MicrofacetsDesc { roughness: 0.4, ..MicrofacetsDesc::default() };
    let metal = |microfacets| BsdfDesc::Conductor {
        conductor: ConductorDesc::Index { eta: Rgb::new(2.74, 2.54, 2.27), k: Rgb::new(3.81, 3.43, 3.04) },
        microfacets,
    };
    let film = |thickness: f32, ior: f32| ThinFilmDesc { thickness, ior };
    let models = [
        ("soap", glass(1.0, 1.0), film(400.0, 1.33)),
        ("coated glass", glass(1.5, 1.0), film(120.0, 2.0)),
        (
            "rough coated glass",
            BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets: rough },
            film(120.0, 2.0),
        ),
        ("oxide", metal(MicrofacetsDesc::default()), film(45.0, 2.4)),
        ("rough oxide", metal(rough), film(45.0, 2.4)),
    ];
    for (what, bsdf, film) in models {
        let around = || {
            let view = camera(DVec3::new(0.4, 0.3, 3.0), DVec3::ZERO, 30.0);
            let mut desc = scene(
                view,
                vec![(
                    parallelogram(DVec3::new(-2.0, -3.0, 2.5), DVec3::Y * 6.0, DVec3::Z * 3.0),
                    BsdfDesc::Black,
                    Some(Rgb::splat(3.0)),
                )],
            );
            desc.set_environment(Some(Rgb::splat(0.5))).expect("a sky");
            desc
        };
        let mut varied = around();
        add(&mut varied, 1, sheet.whole(), bsdf, None);
        varied.materials[1].film = Some(film);
        bind(&mut varied, TextureKey::FilmThickness);
        let mut strips = around();
        for (number, (shape, factor)) in sheet.each().into_iter().zip(FACTORS).enumerate() {
            add(&mut strips, number + 1, shape, bsdf, None);
            strips.materials[number + 1].film = Some(ThinFilmDesc { thickness: film.thickness * factor, ..film });
        }
        // Tables of films of all thicknesses are off by 2e-3 at most.
        compare(case, what, [&varied, &strips], &[IntegratorDesc::Path], 2e-3);
    }
}
