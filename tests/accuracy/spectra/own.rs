//! Lights and materials that have spectra of their own.

use super::{METHODS, build, by_single_wavelengths, channels, room, spectral, white};
use crate::common::scenes::{Job, box_inside, camera, render_scene, scene};
use crate::record::Case;
use crate::transport::{MESH, ball, glass, grey, parallelogram, pick, plane};
use etendue::desc::{
    BsdfDesc, ConductorDesc, DistantLightDesc, EnvironmentDesc, IntegratorDesc, LightDistribution, MaterialDesc,
    MicrofacetsDesc, PhotonDesc, PointLightDesc, RenderDesc, SceneDesc, ShapeDesc, SpectrumDesc, SpectrumKey,
    SpectrumTarget, SpotDesc,
};
use etendue::math::DVec3;
use etendue::spectrum::{Illuminant, REC_709_FROM_XYZ, Rgb, VISIBLE, black_body, color_matching, rec_709, tristimulus};

pub(super) fn samples(pairs: &[[f64; 2]]) -> SpectrumDesc {
    SpectrumDesc::samples("", pairs).expect("samples of the test")
}

/// The value of samples at a wavelength, and what they are beyond their ends: nothing, or the same.
pub(super) fn between(pairs: &[[f64; 2]], nanometres: f64, ends: bool) -> f64 {
    let (first, last) = (pairs[0], pairs[pairs.len() - 1]);
    if nanometres < first[0] || nanometres > last[0] {
        let nearest = if nanometres < first[0] { first[1] } else { last[1] };
        return if ends { nearest } else { 0.0 };
    }
    let above = pairs.iter().position(|pair| pair[0] >= nanometres).unwrap_or(pairs.len() - 1).max(1);
    let ([from, before], [to, after]) = (pairs[above - 1], pairs[above]);
    before + (after - before) * (nanometres - from) / (to - from)
}

/// The colour of a spectrum by tenths of a nanometre, for one that bends within a nanometre.
fn by_tenths(spectrum: impl Fn(f64) -> f64) -> DVec3 {
    let count = ((VISIBLE[1] - VISIBLE[0]) * 10.0) as u32;
    let at = |i: u32| {
        let nanometres = VISIBLE[0] + (f64::from(i) + 0.5) / 10.0;
        *REC_709_FROM_XYZ * color_matching(nanometres) * (spectrum(nanometres) / 10.0)
    };
    (0..count).map(at).sum()
}

/// A ramp, a band, and two peaks.
pub(super) const REFLECTANCES: [&[[f64; 2]]; 3] = [
    &[[400.0, 0.05], [700.0, 0.9]],
    &[[360.0, 0.1], [520.0, 0.1], [530.0, 0.85], [570.0, 0.85], [580.0, 0.1]],
    &[[380.0, 0.6], [450.0, 0.7], [550.0, 0.05], [620.0, 0.8], [830.0, 0.7]],
];

/// The spectrum of an illuminant of luminance 1.
pub(super) fn relative(illuminant: Illuminant) -> impl Fn(f64) -> f64 {
    let scale = 1.0 / tristimulus(|nanometres| illuminant.power(nanometres)).y;
    move |nanometres: f64| illuminant.power(nanometres) * scale
}

/// In a closed room of albedo rho that glows evenly, the radiance is E / (1 - rho) at each wavelength.
pub fn between_walls(case: &mut Case) {
    const LAMP: &[[f64; 2]] = &[[430.0, 0.0], [440.0, 2e-2], [460.0, 1e-3], [545.0, 4e-3], [612.0, 8e-3], [700.0, 0.0]];
    let by_black_body = |nanometres: f64| black_body(2700.0, nanometres);
    type Spectrum<'a> = (&'a str, SpectrumDesc, &'a dyn Fn(f64) -> f64);
    let (a, e) = (relative(Illuminant::A), relative(Illuminant::E));
    let lights: [Spectrum<'_>; 4] = [
        ("black body of 2700 K", SpectrumDesc::BlackBody(2700.0), &by_black_body),
        ("illuminant A", SpectrumDesc::by_name("A").expect("known"), &a),
        ("illuminant E", SpectrumDesc::by_name("E").expect("known"), &e),
        ("samples", samples(LAMP), &|nanometres| between(LAMP, nanometres, false)),
    ];
    let count = case.count(256, 4096) as u32;
    for ((what, spectrum, light), reflectance) in lights.iter().zip(REFLECTANCES.iter().cycle()) {
        let mut desc = room(grey(0.5), Rgb::ZERO);
        desc.set_emission(0, None).expect("a surface");
        desc.set_spectrum(SpectrumTarget::Surface(0), Some(spectrum.clone())).expect("a light");
        let of_walls = SpectrumTarget::Material(0, SpectrumKey::Color);
        desc.set_spectrum(of_walls, Some(samples(reflectance))).expect("a reflectance");
        let scene = build(&desc);
        let exact =
            by_tenths(|nanometres| light(nanometres) / (1.0 - between(reflectance, nanometres, true))).to_array();
        let most = exact.into_iter().fold(0.0, f64::max);
        let job = Job { resolution: [16, 16], samples: count, ..Job::default() };
        for (channel, (mean, error)) in channels(&spectral(&scene, &job)).into_iter().enumerate() {
            let what = format!("{what}, channel {channel}: difference over the largest");
            let off = (mean - exact[channel]) / most;
            case.biased_mean(what, (1.0 + off, error / most), 1.0, (5e-4, pick(case, 1e-2, 2.5e-3)));
        }
    }
    // All methods, in a furnace under E: twice what is emitted, or once and a half where light is reflected once.
    let mut desc = room(grey(0.5), Rgb::ZERO);
    desc.set_emission(0, None).expect("a surface");
    desc.set_spectrum(SpectrumTarget::Surface(0), SpectrumDesc::by_name("E")).expect("a light");
    let scene = build(&desc);
    let exact = rec_709(relative(Illuminant::E)).to_array();
    let white_balance = RenderDesc::white_of("E");
    for integrator in METHODS {
        let is_in_passes =
            !matches!(integrator, IntegratorDesc::Path | IntegratorDesc::Whitted | IntegratorDesc::Direct);
        let once = matches!(integrator, IntegratorDesc::Whitted | IntegratorDesc::Direct);
        let samples = case.count(if is_in_passes { 512 } else { 128 }, if is_in_passes { 8192 } else { 1024 }) as u32;
        let resolution = if is_in_passes { [4, 4] } else { [16, 16] };
        let job = Job { resolution, samples, integrator, ..Job::default() };
        let photons = PhotonDesc { count: Some(1000), ..PhotonDesc::default() };
        let whole = if once { 1.5 } else { 2.0 };
        let bias = if is_in_passes { pick(case, 6e-3, 1e-3) } else { 1e-3 };
        // As it is, and with E as white, under which all channels are alike.
        for white_balance in [None, white_balance] {
            let photons = photons.clone();
            let image = render_scene(&scene, RenderDesc { spectral: true, photons, white_balance, ..job.desc() }).0;
            for (channel, (mean, error)) in channels(&image).into_iter().enumerate() {
                let expected = whole * if white_balance.is_some() { 1.0 } else { exact[channel] };
                let balanced = if white_balance.is_some() { ", balanced" } else { "" };
                let what = format!("furnace under E{balanced}, {}, channel {channel}", integrator.name());
                case.biased_mean(what, (mean / expected, error / expected), 1.0, (bias, pick(case, 6e-3, 1e-3)));
            }
        }
    }
    // In three channels, light of the colour of E is white too.
    let job = Job { resolution: [4, 4], samples: case.count(64, 512) as u32, ..Job::default() };
    let image = render_scene(&scene, RenderDesc { white_balance, ..job.desc() }).0;
    for (channel, (mean, error)) in channels(&image).into_iter().enumerate() {
        let what = format!("furnace under E, balanced, three channels, channel {channel}");
        case.biased_mean(what, (mean / 2.0, error / 2.0), 1.0, (1e-4, pick(case, 1e-2, 2e-3)));
    }
}

/// A grey floor under a lamp of some kind, whose spectrum has a colour of Rec. 709: paths in three channels see the same floor.
pub fn lamps(case: &mut Case) {
    let spectrum = SpectrumDesc::BlackBody(4000.0);
    let floor = || {
        let view = camera(DVec3::new(0.0, 2.0, 2.0), DVec3::ZERO, 20.0);
        scene(view, vec![(plane(DVec3::ZERO, DVec3::Y, 3.0), grey(0.7), None)])
    };
    let with_surface = |shape: ShapeDesc| {
        let mut desc = floor();
        crate::common::scenes::add(&mut desc, 1, shape, BsdfDesc::Black, Some(Rgb::splat(2.0)));
        (desc, SpectrumTarget::Surface(1))
    };
    let with_light = |distribution: LightDistribution| {
        let mut desc = floor();
        let even = PointLightDesc::even(DVec3::new(0.3, 1.5, 0.0), Rgb::splat(2.0));
        desc.add_light_desc(PointLightDesc { distribution, ..even }).expect("a light");
        (desc, SpectrumTarget::PointLight(0))
    };
    let spot = SpotDesc { outer_deg: 60.0, inner_deg: 20.0, ..SpotDesc::new(DVec3::NEG_Y) };
    let sun = {
        let mut desc = floor();
        let towards = DVec3::new(0.2, 1.0, 0.1);
        let light = DistantLightDesc { angle_deg: 3.0, ..DistantLightDesc::parallel(towards, Rgb::splat(2.0)) };
        desc.add_distant_light(light).expect("a light");
        (desc, SpectrumTarget::DistantLight(0))
    };
    let sky = {
        let mut desc = floor();
        desc.set_environment_desc(Some(EnvironmentDesc::even(Rgb::ONE))).expect("a sky");
        (desc, SpectrumTarget::Environment)
    };
    let glowing = {
        let mut desc = floor();
        let glow = MaterialDesc { name: "glow".into(), emission: Some(Rgb::splat(2.0)), ..MaterialDesc::default() };
        let material = desc.add_material_desc(glow).expect("a material");
        let shape = ball(DVec3::new(0.2, 1.0, 0.0), 0.3);
        crate::common::scenes::add(&mut desc, 1, shape, BsdfDesc::Black, None);
        desc.set_surface_material(1, Some(material)).expect("a surface");
        (desc, SpectrumTarget::Material(material, SpectrumKey::Emission))
    };
    let lamp = parallelogram(DVec3::new(-0.5, 1.5, -0.5), DVec3::X, DVec3::Z);
    let disk = ShapeDesc::disk(DVec3::new(0.0, 1.5, 0.0), DVec3::NEG_Y, 0.5).expect("a disk").0;
    let lamps: [(&str, (SceneDesc, SpectrumTarget)); 8] = [
        ("point", with_light(LightDistribution::Even)),
        ("spot", with_light(LightDistribution::Spot(spot))),
        ("quad", with_surface(lamp)),
        ("sphere", with_surface(ball(DVec3::new(0.2, 1.0, 0.0), 0.3))),
        ("disk", with_surface(disk)),
        ("sun", sun),
        ("sky", sky),
        ("material", glowing),
    ];
    for (what, (mut desc, of)) in lamps {
        desc.set_spectrum(of, Some(spectrum.clone())).expect("a spectrum");
        let scene = build(&desc);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Sppm] {
            let is_in_passes = integrator == IntegratorDesc::Sppm;
            let samples =
                case.count(if is_in_passes { 256 } else { 64 }, if is_in_passes { 2048 } else { 1024 }) as u32;
            let resolution = if is_in_passes { [4, 4] } else { [16, 16] };
            let job = Job { resolution, samples, integrator, ..Job::default() };
            let photons = PhotonDesc { count: Some(2000), ..PhotonDesc::default() };
            let found = render_scene(&scene, RenderDesc { spectral: true, photons, ..job.desc() }).0;
            let plain = Job { seed: 5, integrator: IntegratorDesc::Path, resolution: [16, 16], samples: 256, ..job };
            let expected = channels(&render_scene(&scene, plain.desc()).0);
            for (channel, (mean, error)) in channels(&found).into_iter().enumerate() {
                let (exact, noise) = expected[channel];
                // The photon method sees a floor a little smaller, since it blurs, and shares wavelengths by pass.
                let bias = if is_in_passes { pick(case, 1.5e-2, 6e-3) } else { 1e-3 };
                let what = format!("{what}, {}, channel {channel}", integrator.name());
                let error = (error / mean).hypot(noise / exact);
                case.biased_mean(what, (mean / exact, error), 1.0, (bias, pick(case, 1.5e-2, 4e-3)));
            }
        }
    }
}

/// A patch with a spectrum in a room that glows evenly, against the same with a grey of its value at each wavelength.
pub fn models(case: &mut Case) {
    // Without the steep flanks at which wavelengths by 10 nm would be off.
    let of: &[[f64; 2]] = &[[400.0, 0.2], [470.0, 0.25], [550.0, 0.6], [630.0, 0.35], [700.0, 0.3]];
    let at = |nanometres: f32| between(of, f64::from(nanometres), true) as f32;
    const ETA: &[[f64; 2]] = &[[400.0, 1.6], [500.0, 0.9], [600.0, 0.25], [800.0, 0.15]];
    const K: &[[f64; 2]] = &[[400.0, 1.9], [500.0, 1.8], [600.0, 3.1], [800.0, 4.9]];
    let splat = |of: &[[f64; 2]], nanometres: f32| Rgb::splat(between(of, f64::from(nanometres), true) as f32);
    let index = |nanometres: f32| ConductorDesc::Index { eta: splat(ETA, nanometres), k: splat(K, nanometres) };
    let by_reflectance =
        |nanometres: f32| ConductorDesc::Reflectance { normal: Rgb::splat(at(nanometres)), edge: Rgb::ONE };
    let (smooth, rough) = (MicrofacetsDesc::default(), MicrofacetsDesc::rough(0.6));
    let color = vec![(SpectrumKey::Color, samples(of))];
    let both = vec![(SpectrumKey::Eta, samples(ETA)), (SpectrumKey::K, samples(K))];
    let reflectance = vec![(SpectrumKey::Reflectance, samples(of))];
    type Model<'a> = (&'a str, Vec<(SpectrumKey, SpectrumDesc)>, &'a dyn Fn(f32) -> BsdfDesc);
    let grey_at = |nanometres: f32| Rgb::splat(at(nanometres));
    let models: [Model<'_>; 9] = [
        ("Lambert", color.clone(), &|nm| BsdfDesc::Lambert { albedo: grey_at(nm) }),
        ("Oren and Nayar", color.clone(), &|nm| BsdfDesc::OrenNayar { albedo: grey_at(nm), roughness: 0.6 }),
        ("Oren and Nayar, qualitative", color.clone(), &|nm| BsdfDesc::OrenNayarQualitative {
            albedo: grey_at(nm),
            sigma: 0.5,
        }),
        ("EON", color.clone(), &|nm| BsdfDesc::Eon { albedo: grey_at(nm), roughness: 0.8 }),
        ("mirror", color.clone(), &|nm| BsdfDesc::Mirror { reflectance: grey_at(nm) }),
        ("fibres", color.clone(), &|nm| BsdfDesc::Sheen { color: grey_at(nm), roughness: 0.4 }),
        ("smooth metal", both.clone(), &|nm| BsdfDesc::Conductor { conductor: index(nm), microfacets: smooth }),
        ("rough metal", both, &|nm| BsdfDesc::Conductor { conductor: index(nm), microfacets: rough }),
        ("metal by its reflectance", reflectance, &|nm| BsdfDesc::Conductor {
            conductor: by_reflectance(nm),
            microfacets: rough,
        }),
    ];
    let make = |bsdf: BsdfDesc| {
        let view = camera(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO, 20.0);
        let patch = parallelogram(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(4.0, 0.0, -1.0), DVec3::Y * 4.0);
        let mut desc = scene(view, vec![(patch, bsdf, None), (MESH, BsdfDesc::Black, Some(Rgb::ONE))]);
        desc.meshes.push(box_inside(DVec3::splat(-5.0), DVec3::splat(5.0)).into());
        desc
    };
    let count = case.count(128, 2048) as u32;
    let job = Job { resolution: [16, 16], samples: count, integrator: IntegratorDesc::Direct, ..Job::default() };
    for (what, spectra, model) in models {
        let mut desc = make(model(550.0));
        let bsdf = desc.materials[0].bsdf;
        desc.set_material_desc(0, MaterialDesc { bsdf, spectra, ..MaterialDesc::default() }).expect("a material");
        let found = channels(&spectral(&build(&desc), &job));
        let single = Job { samples: (count / 8).max(16), ..job };
        let expected = by_single_wavelengths(|nanometres| make(model(nanometres)), |nanometres| nanometres, &single);
        let most = expected.iter().map(|channel| channel.0).fold(0.0, f64::max);
        for channel in 0..3 {
            let (a, b) = (found[channel], expected[channel]);
            let what = format!("{what}, channel {channel}: difference over the largest");
            // Single wavelengths by 10 nm are off by less than this.
            let error = a.1.hypot(b.1) / most;
            case.biased_mean(what, (1.0 + (a.0 - b.0) / most, error), 1.0, (2e-3, pick(case, 1.5e-2, 4e-3)));
        }
    }
    // A sheet that reflects one band and transmits another, with light on both sides.
    let sheet = BsdfDesc::DiffuseTransmission { reflectance: Rgb::splat(0.1), transmittance: Rgb::splat(0.1) };
    let spectra = vec![
        (SpectrumKey::Color, samples(&[[500.0, 0.6], [520.0, 0.05]])),
        (SpectrumKey::Transmittance, samples(&[[500.0, 0.1], [520.0, 0.75]])),
    ];
    let mut desc = make(sheet);
    desc.set_material_desc(0, MaterialDesc { bsdf: sheet, spectra, ..MaterialDesc::default() }).expect("a material");
    let sum = [[500.0, 0.7], [520.0, 0.8]];
    let exact = rec_709(|nanometres| between(&sum, nanometres, true) * white(nanometres)).to_array();
    for (channel, (mean, error)) in channels(&spectral(&build(&desc), &job)).into_iter().enumerate() {
        let what = format!("sheet, channel {channel}");
        let found = (mean / exact[channel], error / exact[channel]);
        case.biased_mean(what, found, 1.0, (1e-3, pick(case, 1.5e-2, 4e-3)));
    }
}

/// A lamp behind an absorbing body that does not refract.
pub fn absorption(case: &mut Case) {
    const COEFFICIENT: &[[f64; 2]] = &[[400.0, 3.0], [500.0, 0.2], [560.0, 0.1], [600.0, 2.5], [700.0, 0.4]];
    let exact = rec_709(|nanometres| (-between(COEFFICIENT, nanometres, true)).exp() * white(nanometres)).to_array();
    let view = camera(DVec3::new(0.0, 0.0, -2.0), DVec3::ZERO, 1.0);
    let face = |z: f64, normal| (plane(DVec3::Z * z, normal, 20.0), glass(1.0, 1.0), None);
    let lamp = (plane(DVec3::Z * 5.0, DVec3::NEG_Z, 100.0), BsdfDesc::Black, Some(Rgb::ONE));
    let mut desc = scene(view, vec![face(0.0, DVec3::NEG_Z), face(1.0, DVec3::Z), lamp]);
    for material in 0..2 {
        let of = SpectrumTarget::Material(material, SpectrumKey::Absorption);
        desc.set_spectrum(of, Some(samples(COEFFICIENT))).expect("a medium");
    }
    let scene = build(&desc);
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
        let job = Job { resolution: [16, 16], samples: case.count(256, 2048) as u32, integrator, ..Job::default() };
        let most = exact.into_iter().fold(0.0, f64::max);
        for (channel, (mean, error)) in channels(&spectral(&scene, &job)).into_iter().enumerate() {
            let found = (1.0 + (mean - exact[channel]) / most, error / most);
            let what = format!("{}, channel {channel}: difference over the largest", integrator.name());
            case.biased_mean(what, found, 1.0, (1e-3, pick(case, 8e-3, 2e-3)));
        }
    }
}
