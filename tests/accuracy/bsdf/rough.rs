//! Rough metals, rough glass and what is built from them: values, energy, reciprocity and samplers.

use std::f64::consts::PI;

use etendue::bsdf::{Bsdf, Lobes, Microfacets, Model as _, TransportMode, fresnel_conductor};
use etendue::desc::{BsdfDesc, ConductorDesc, Distribution, Masking, MicrofacetsDesc, PrincipledDesc};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Rng, Sampler as _, SobolSampler, warps};
use etendue::spectrum::Rgb;
use rayon::prelude::*;

use super::{Worst, direction, uniform_3d};
use crate::record::{Case, Entry, Within};
use crate::stats::{DensityCheck, check_density, mean_and_error};
use crate::transport::pick;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "B35", title: "conductors", run: conductors },
        Entry { id: "B36", title: "facets", run: facets },
        Entry { id: "B37", title: "albedo of rough metal", run: albedos },
        Entry { id: "B50", title: "samples of rough models", run: samples },
        Entry { id: "B51", title: "reciprocity of rough models", run: reciprocity },
        Entry { id: "B52", title: "rough models in a furnace", run: furnaces },
        Entry { id: "B53", title: "rough models become smooth", run: limits },
        Entry { id: "B54", title: "thin sheet of glass", run: thin_sheet },
        Entry { id: "B55", title: "diffuse under a coat", run: coated },
    ]
}

/// The facets with this width alpha.
fn wide(alpha: f64) -> MicrofacetsDesc {
    MicrofacetsDesc::rough(alpha.sqrt() as f32)
}

fn metal(conductor: ConductorDesc, microfacets: MicrofacetsDesc) -> Bsdf {
    Bsdf::new(&BsdfDesc::Conductor { conductor, microfacets })
}

/// A rough thin sheet.
fn frosted(transmittance: Rgb, microfacets: MicrofacetsDesc) -> Bsdf {
    Bsdf::new(&BsdfDesc::ThinDielectric { ior: 1.5, exterior_ior: 1.0, transmittance, microfacets })
}

fn white() -> ConductorDesc {
    ConductorDesc::Reflectance { normal: Rgb::ONE, edge: Rgb::ONE }
}

fn once(microfacets: MicrofacetsDesc) -> MicrofacetsDesc {
    MicrofacetsDesc { multiple_scattering: false, ..microfacets }
}

fn glass(ior: f32, microfacets: MicrofacetsDesc) -> Bsdf {
    Bsdf::new(&BsdfDesc::RoughDielectric { ior, exterior_ior: 1.0, microfacets })
}

/// Share of the power of a beam from `wo` that is scattered: the mean weight of samples in terms of power, from replicates.
fn scattered(case: &Case, bsdf: &Bsdf, wo: Vec3, pixel: u32) -> (f64, f64) {
    scattered_of(case.count(1024, 8192) as u32, bsdf, wo, pixel)
}

/// The same by 32 replicates of `size` samples.
fn scattered_of(size: u32, bsdf: &Bsdf, wo: Vec3, pixel: u32) -> (f64, f64) {
    const REPLICATES: u32 = 32;
    let mut sampler = SobolSampler::new(52, size);
    let mut weight = |i| {
        sampler.start(pixel, i);
        let [a, b, c, _] = sampler.next_4d();
        bsdf.sample(wo, [a, b, c], TransportMode::Importance).map_or(0.0, |sample| f64::from(sample.weight.r()))
    };
    let mut replicate = |r: u32| (r * size..(r + 1) * size).map(&mut weight).sum::<f64>() / f64::from(size);
    mean_and_error(&(0..REPLICATES).map(&mut replicate).collect::<Vec<_>>())
}

fn conductors(case: &mut Case) {
    let table = [
        ([2.0, 4.0], [0.68, 0.672878863372, 0.638507924158, 0.930417850703]),
        ([0.2, 3.0], [0.923371647510, 0.921319620693, 0.925223138550, 0.992126321413]),
    ];
    for ([n, k], row) in table {
        let mut worst = 0.0_f64;
        for (degrees, exact) in [0.0_f64, 45.0, 75.0, 89.0].into_iter().zip(row) {
            let found = f64::from(fresnel_conductor(degrees.to_radians().cos() as f32, n as f32, k as f32));
            worst = worst.max((found - exact).abs());
        }
        case.at_most(format!("n = {n}, k = {k}: off the exact reflectance"), worst, 1e-6);
    }
    let mut worst = 0.0_f64;
    for i in 1..1000 {
        let cos = f64::from(i) / 1000.0;
        let glass = etendue::bsdf::fresnel_dielectric(f64::from(cos as f32), 1.5);
        worst = worst.max((f64::from(fresnel_conductor(cos as f32, 1.5, 0.0)) - glass).abs());
    }
    case.at_most("k = 0: off the dielectric", worst, 1e-6);
    let silver = etendue::desc::Metal::by_symbol("Ag").expect("is known").conductor();
    let smooth = metal(silver, MicrofacetsDesc::default());
    let sample = smooth.sample(direction(60.0, 20.0), [0.5; 3], TransportMode::Radiance).expect("reflects");
    let exact = [(0.1394, 4.1288), (0.1248, 3.3396), (0.1517, 2.4704)].map(|(n, k)| fresnel_conductor(0.5, n, k));
    let off = (sample.weight - Rgb::from_array(exact)).abs().max_element();
    case.at_most("silver at 60°: off Fresnel's", f64::from(off), 1e-6);
}

fn facets(case: &mut Case) {
    let normal = |degrees: f64| direction(degrees, 77.0);
    for (alpha, ggx, beckmann) in
        [(0.1, 2.00422537179, 1.51067294943), (0.5, 1.07075420411, 1.19534516494), (1.0, 1.0 / PI, 0.328051141314)]
    {
        for (distribution, exact) in [(Distribution::Ggx, ggx), (Distribution::Beckmann, beckmann)] {
            let facets = Microfacets::new(&MicrofacetsDesc { distribution, ..wide(alpha) }).expect("is rough");
            let name = format!("{distribution:?} {alpha}");
            case.exact(format!("{name}: D at 10°"), facets.d(normal(10.0)).into(), exact, Within::Relative(3e-6));
            let above = facets.d(normal(0.0)).into();
            case.exact(format!("{name}: D at 0°"), above, 1.0 / (PI * alpha * alpha), Within::Relative(3e-6));
            // In tan = alpha s, cos d_omega = tan / (1 + tan^2)^2 d tan d phi; s = t / (1 - t).
            let n = 20_000;
            let projected: f64 = (0..n)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(n);
                    let (s, ds) = (t / (1.0 - t), 1.0 / ((1.0 - t) * (1.0 - t)));
                    let tan = alpha * s;
                    let w = tan / (1.0 + tan * tan).powi(2) * alpha * ds / f64::from(n);
                    let cos = 1.0 / (1.0 + tan * tan).sqrt();
                    2.0 * PI * w * f64::from(facets.d(Vec3::new((tan * cos) as f32, 0.0, cos as f32)))
                })
                .sum();
            case.exact(format!("{name}: integral of D cos"), projected, 1.0, Within::Relative(1e-5));
        }
    }
    for (alpha, degrees, exact) in [
        (0.5, 30.0, 0.979991993594),
        (0.5, 60.0, 0.861001748086),
        (0.5, 85.0, 0.294037426174),
        (1.0, 30.0, 0.928203230276),
        (1.0, 60.0, 2.0 / 3.0),
        (1.0, 85.0, 0.160337179524),
        (0.1, 85.0, 0.794059258605),
    ] {
        let facets = Microfacets::new(&wide(alpha)).expect("is rough");
        let w = normal(degrees);
        let m = Vec3::Z;
        // The density of visible normals is D G1 cos / cos.
        let g1 = f64::from(facets.visible_pdf(w, m)) / f64::from(facets.d(m));
        case.exact(format!("GGX {alpha}: G1 at {degrees}°"), g1, exact, Within::Relative(3e-6));
    }
}

fn albedos(case: &mut Case) {
    let correlated = [
        (0.2, 1.0, 0.947657779),
        (0.2, 0.5, 0.895234515),
        (0.25, 0.5, 0.85726),
        (0.5, 1.0, 0.687848515),
        (0.5, 0.5, 0.698250697),
        (0.5, 0.1, 0.860105073),
        (1.0, 1.0, 1.0 - 2.0_f64.ln()),
        (1.0, 0.5, 0.450693856),
        (1.0, 0.1, 0.760210473),
    ];
    let separable = [(0.5, 0.5, 0.686007250), (1.0, 0.5, 0.409137093), (1.0, 0.1, 0.557914217)];
    let rows = correlated.into_iter().map(|row| (Masking::Smith, row));
    let rows = rows.chain(separable.into_iter().map(|row| (Masking::SmithSeparable, row)));
    for (i, (masking, (alpha, cos, exact))) in rows.enumerate() {
        let bsdf = metal(white(), once(MicrofacetsDesc { masking, ..wide(alpha) }));
        let wo = direction(f64::acos(cos).to_degrees(), 31.0);
        let found = scattered(case, &bsdf, wo, i as u32);
        case.mean(format!("{masking:?} {alpha}, cosine {cos}"), found, exact, 1e-3);
    }
}

/// All rough models that are sampled, with their names; `r` is a roughness in (0, 1].
fn models(r: f32) -> Vec<(String, Bsdf)> {
    let facets = MicrofacetsDesc::rough(r);
    let gold = etendue::desc::Metal::by_symbol("Au").expect("is known").conductor();
    let turned = MicrofacetsDesc { anisotropy: 0.7, rotation: 0.6, ..facets };
    let beckmann = MicrofacetsDesc { distribution: Distribution::Beckmann, ..facets };
    let grooves = once(MicrofacetsDesc { masking: Masking::VCavity, ..facets });
    let color = Rgb::new(0.8, 0.5, 0.2);
    let coated =
        |microfacets| Bsdf::new(&BsdfDesc::CoatedDiffuse { albedo: color, ior: 1.5, exterior_ior: 1.0, microfacets });
    let principled = |desc: PrincipledDesc| Bsdf::new(&BsdfDesc::Principled(desc));
    let all = PrincipledDesc {
        base_color: color,
        base_diffuse_roughness: 0.5,
        base_metalness: 0.3,
        specular_roughness: r,
        transmission_weight: 0.3,
        transmission_color: color,
        coat_weight: 0.5,
        coat_roughness: 0.5 * r,
        coat_color: color,
        fuzz_weight: 0.4,
        ..PrincipledDesc::default()
    };
    let named = |name: &str, bsdf| (name.to_owned(), bsdf);
    vec![
        named("metal", metal(gold, facets)),
        named("metal, once", metal(gold, once(facets))),
        named("metal, two widths", metal(gold, turned)),
        named("metal, Beckmann", metal(gold, beckmann)),
        named("metal, grooves", metal(gold, grooves)),
        named("glass", glass(1.5, facets)),
        named("glass, once", glass(1.5, once(facets))),
        named("glass, two widths", glass(1.5, turned)),
        named("glass, Beckmann", glass(1.5, beckmann)),
        named("glass, grooves", glass(1.5, grooves)),
        named("bubble", glass(1.0 / 1.5, facets)),
        named("coated diffuse", coated(facets)),
        named("principled", principled(all)),
        named("frosted sheet", frosted(color, facets)),
        named("frosted sheet, two widths", frosted(Rgb::ONE, turned)),
    ]
}

/// Wide models without facets.
fn other_models() -> Vec<(String, Bsdf)> {
    let color = Rgb::new(0.8, 0.5, 0.2);
    let named = |name: &str, desc: BsdfDesc| (name.to_owned(), Bsdf::new(&desc));
    vec![
        named("EON", BsdfDesc::Eon { albedo: color, roughness: 0.7 }),
        named("sheen", BsdfDesc::Sheen { color, roughness: 0.5 }),
        named(
            "diffuse transmission",
            BsdfDesc::DiffuseTransmission { reflectance: color * 0.3, transmittance: color * 0.6 },
        ),
    ]
}

const ROUGHNESSES: [f32; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0];

/// Incident directions by their angles; the last two come from the inner side.
const ANGLES: [f64; 6] = [0.0, 30.0, 60.0, 85.0, 140.0, 100.0];

/// Compares samples with their density over all directions, in polar coordinates about the middle of the lobe that are
/// stretched where the lobe is.
///
/// Only directions on `wo`'s side are looked at if `reflects`, and only those on the other side if not; all others are rejected.
fn check_lobe(bsdf: &Bsdf, wo: Vec3, (reflects, ior): (bool, f64), draws: usize, rng: &mut Rng) -> DensityCheck {
    let is_wanted = |w: DVec3| (w.z * f64::from(wo.z) > 0.0) == reflects;
    let w = wo.as_dvec3();
    // Under total reflection lobes lie along the horizon.
    let eta = if w.z > 0.0 { ior } else { 1.0 / ior };
    let cos_t = (1.0 - (1.0 - w.z * w.z) / (eta * eta)).max(0.0).sqrt();
    let pole = if reflects {
        DVec3::new(-w.x, -w.y, w.z).normalize()
    } else {
        DVec3::new(-w.x / eta, -w.y / eta, -cos_t.copysign(w.z)).normalize()
    };
    let width = f64::from(bsdf.narrowest());
    let (s, t) = pole.any_orthonormal_pair();
    // theta = width (exp(k x) - 1) with x in [0, 1] for theta in [0, pi]: cells for lobes of every width from the narrowest on.
    let k = (PI / width).ln_1p();
    check_density(
        (36, 40),
        ((0.0, 1.0), (-PI, PI)),
        draws,
        || match bsdf.sample(wo, uniform_3d(rng), TransportMode::Radiance) {
            None => (f64::NAN, 0.0, 0.0),
            Some(sample) if !is_wanted(sample.wi.as_dvec3()) => (f64::NAN, 0.0, 0.0),
            Some(sample) => {
                let w = sample.wi.as_dvec3();
                let theta = w.dot(s).hypot(w.dot(t)).atan2(w.dot(pole));
                let jacobian = theta.sin() * k * (theta + width);
                ((theta / width).ln_1p() / k, w.dot(t).atan2(w.dot(s)), f64::from(sample.pdf) * jacobian)
            }
        },
        |x, phi| {
            let theta = width * (k * x).exp_m1();
            let (sin, cos) = theta.sin_cos();
            let w = (s * phi.cos() + t * phi.sin()) * sin + pole * cos;
            if !is_wanted(w) {
                return 0.0;
            }
            f64::from(bsdf.pdf(wo, w.as_vec3a())) * sin * k * (theta + width)
        },
    )
}

/// What [`samples`] finds worst of one model, over its roughnesses, incident directions and both sides.
struct Sampled {
    p_value: f64,
    /// The integral of the density and what is rejected, off 1 beyond four standard errors.
    integral: f64,
    mismatch: f64,
    weight: f64,
}

impl Sampled {
    fn new(name: &str, bsdfs: &[Bsdf], stream: usize, draws: usize) -> Self {
        let ior = match name {
            "bubble" => 1.0 / 1.5,
            _ if name.starts_with("frosted sheet") => 1.0,
            _ => 1.5,
        };
        let mut worst = Self { p_value: 1.0, integral: 0.0, mismatch: 0.0, weight: 0.0 };
        for (k, bsdf) in bsdfs.iter().enumerate() {
            for (j, degrees) in ANGLES.into_iter().enumerate() {
                let wo = direction(degrees, 40.0 + 50.0 * j as f64);
                let mut rng = Rng::new(50, (1000 * stream + 10 * k + j) as u64);
                for reflects in [true, false] {
                    if !reflects && !bsdf.lobes().intersects(Lobes::TRANSMISSION) {
                        continue;
                    }
                    let found = check_lobe(bsdf, wo, (reflects, ior), draws, &mut rng);
                    worst.p_value = worst.p_value.min(found.p_value);
                    let share = found.rejected;
                    let error = (share * (1.0 - share) / draws as f64).sqrt();
                    let off = (found.integral + share - 1.0).abs();
                    worst.integral = worst.integral.max(off - 4.0 * error);
                    worst.mismatch = worst.mismatch.max(found.mismatch);
                }
                for _ in 0..200 {
                    let Some(sample) = bsdf.sample(wo, uniform_3d(&mut rng), TransportMode::Radiance) else { continue };
                    let f = f64::from(bsdf.f(wo, sample.wi, TransportMode::Radiance).r());
                    let weight = f * f64::from(sample.wi.z.abs()) / f64::from(sample.pdf);
                    worst.weight = worst.weight.max((weight / f64::from(sample.weight.r()) - 1.0).abs());
                }
            }
        }
        worst
    }
}

fn samples(case: &mut Case) {
    let draws = case.count(10_000, 50_000) as usize;
    let chosen = pick(case, &[0.2, 0.85][..], &ROUGHNESSES);
    let names = models(0.5).into_iter().map(|(name, _)| name).enumerate();
    let mut work: Vec<(String, Vec<Bsdf>, usize)> =
        names.map(|(i, name)| (name, chosen.iter().map(|r| models(*r).swap_remove(i).1).collect(), i)).collect();
    work.extend(other_models().into_iter().enumerate().map(|(i, (name, bsdf))| (name, vec![bsdf], 100 + i)));
    let tests = work.iter().map(|(_, bsdfs, _)| 2 * bsdfs.len() * ANGLES.len()).sum();
    let found: Vec<Sampled> =
        work.par_iter().map(|(name, bsdfs, stream)| Sampled::new(name, bsdfs, *stream, draws)).collect();
    for ((name, ..), found) in work.iter().zip(found) {
        case.p_value(format!("{name}: chi-square in cells"), found.p_value, tests);
        case.at_most(format!("{name}: integral of the density and what is rejected, off 1"), found.integral, 2e-3);
        case.at_most(format!("{name}: density asked for, off the sample's"), found.mismatch, 2e-3);
        case.at_most(format!("{name}: weight against f cos / pdf"), found.weight, 2e-3);
    }
}

fn reciprocity(case: &mut Case) {
    let pairs = case.count(20_000, 100_000);
    for r in [0.2, 0.6, 1.0] {
        for (name, bsdf) in models(r).into_iter().chain(other_models()) {
            let mut residuals = Vec::new();
            let mut rng = Rng::new(51, 7);
            for _ in 0..pairs {
                let [a, b] = [0, 1].map(|_| warps::uniform_sphere(rng.next_2d()));
                // Away from the horizon, where a cosine has few digits.
                if a.z.abs() < 0.02 || b.z.abs() < 0.02 {
                    continue;
                }
                let there = bsdf.f(a, b, TransportMode::Radiance);
                // What comes from a light along the same way.
                let back = bsdf.f(b, a, TransportMode::Importance);
                let (there, back) = (f64::from(there.r()), f64::from(back.r()));
                if there.max(back) > 1e-6 {
                    residuals.push((there - back).abs() / there.max(back));
                }
            }
            // Close to the critical angle what is transmitted is a root of a difference that has few digits.
            residuals.sort_unstable_by(f64::total_cmp);
            let most = residuals[residuals.len() * 999 / 1000];
            case.at_most(format!("{name} {r}: f(a, b) as radiance, off f(b, a) as power, 99.9 % of pairs"), most, 1e-3);
        }
    }
}

fn furnaces(case: &mut Case) {
    let angles = [0.0, 30.0, 60.0, 80.0, 85.0];
    let size = case.count(512, 8192) as u32;
    let mut pixel = 0;
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for r in [0.01, 0.1, 0.2, 0.3, 0.45, 0.6, 0.7, 0.85, 1.0] {
            if !case.is_full() && ![0.01, 0.2, 0.6, 1.0].contains(&r) {
                continue;
            }
            for (name, anisotropy) in [("", 0.0), (", two widths", 0.8)] {
                let facets = MicrofacetsDesc { distribution, anisotropy, ..MicrofacetsDesc::rough(r) };
                let models = [
                    ("white metal", metal(white(), facets), 0.0, 1.0),
                    ("glass from outside", glass(1.5, facets), 0.0, 1.0),
                    ("glass from inside", glass(1.5, facets), 180.0, -1.0),
                    ("frosted sheet", frosted(Rgb::ONE, facets), 0.0, 1.0),
                ];
                for (what, bsdf, turn, sign) in models {
                    if anisotropy > 0.0 && !case.is_full() && r != 0.6 {
                        continue;
                    }
                    let mut worst = (0.0_f64, 0.0);
                    for degrees in angles {
                        pixel += 1;
                        let wo = direction(turn + sign * degrees, 20.0);
                        let (mean, error) = scattered_of(size, &bsdf, wo, pixel);
                        let beyond = ((mean - 1.0).abs() - 4.0 * error).max(0.0);
                        if beyond >= worst.0 {
                            worst = (beyond, error);
                        }
                    }
                    case.at_most(format!("{what}{name}, {distribution:?} {r}: off 1 beyond 4 s"), worst.0, 1e-3);
                }
            }
        }
    }
    for roughness in [0.3, 1.0] {
        let bsdf = Bsdf::new(&BsdfDesc::Eon { albedo: Rgb::ONE, roughness });
        for degrees in angles {
            pixel += 1;
            let found = scattered_of(size, &bsdf, direction(degrees, 20.0), pixel);
            case.mean(format!("white EON {roughness} at {degrees}°"), found, 1.0, 1e-3);
        }
    }
    let sheet = BsdfDesc::DiffuseTransmission { reflectance: Rgb::splat(0.3), transmittance: Rgb::splat(0.5) };
    let found = scattered_of(size, &Bsdf::new(&sheet), direction(50.0, 20.0), pixel + 1);
    case.mean("diffuse sheet: both shares", found, 0.8, 1e-3);
    // What is put together never gains, and loses little where its base is opaque.
    let mut most = 0.0_f64;
    let mut least = f64::INFINITY;
    let mut least_clear = f64::INFINITY;
    for r in [0.0, 0.3, 1.0] {
        for (coat, coat_ior) in [(0.0, 1.6), (0.5, 1.6), (1.0, 1.6), (1.0, 2.5)] {
            for (metalness, fuzz) in [(0.0, 0.0), (0.5, 0.5), (1.0, 0.0), (0.0, 1.0)] {
                for (rough, transmission) in [(0.0, 0.0), (0.6, 0.0), (0.0, 0.5), (0.0, 1.0)] {
                    if !case.is_full() && (coat == 0.5 || rough == 0.6 || r == 0.3) {
                        continue;
                    }
                    let bsdf = Bsdf::new(&BsdfDesc::Principled(PrincipledDesc {
                        base_color: Rgb::ONE,
                        base_metalness: metalness,
                        base_diffuse_roughness: rough,
                        specular_roughness: r,
                        transmission_weight: transmission,
                        coat_weight: coat,
                        coat_ior,
                        coat_roughness: 0.5 * r,
                        fuzz_weight: fuzz,
                        ..PrincipledDesc::default()
                    }));
                    // From within as well, where light passes.
                    let sides = if transmission > 0.0 { &[0.0, 180.0][..] } else { &[0.0][..] };
                    for (side, degrees) in sides.iter().flat_map(|side| angles.map(|degrees| (side, degrees))) {
                        pixel += 1;
                        let (mean, error) = scattered_of(size, &bsdf, direction(side + degrees, 20.0), pixel);
                        most = most.max(mean - 4.0 * error);
                        let least = if transmission > 0.0 { &mut least_clear } else { &mut least };
                        *least = least.min(mean + 4.0 * error);
                    }
                }
            }
        }
    }
    case.at_most("principled in white: greatest albedo", most, 1.001);
    case.at_most("principled in white: greatest loss", 1.0 - least, 0.06);
    case.at_most("principled in white, with transmission: greatest loss", 1.0 - least_clear, 0.3);
}

fn limits(case: &mut Case) {
    let wo = direction(40.0, 15.0);
    // The facets' width at which they are left out, and just above.
    for (name, make) in [
        ("metal", Box::new(|r: f32| metal(white(), MicrofacetsDesc::rough(r))) as Box<dyn Fn(f32) -> Bsdf>),
        ("glass", Box::new(|r: f32| glass(1.5, MicrofacetsDesc::rough(r)))),
        ("sheet", Box::new(|r: f32| frosted(Rgb::ONE, MicrofacetsDesc::rough(r)))),
    ] {
        let (smooth, rough) = (make(0.0), make(0.0101));
        let mut rng = Rng::new(53, 1);
        let (mut off, mut weights, mut bad) = (0, 0.0_f64, 0);
        let tries = case.count(20_000, 200_000);
        for _ in 0..tries {
            let u = uniform_3d(&mut rng);
            let a = smooth.sample(wo, u, TransportMode::Radiance).expect("scatters");
            let Some(b) = rough.sample(wo, u, TransportMode::Radiance) else {
                bad += 1;
                continue;
            };
            if a.wi.z * b.wi.z > 0.0 {
                off += u64::from(a.wi.distance(b.wi) > 0.01);
                weights = weights.max(f64::from((a.weight - b.weight).abs().max_element()));
            }
            let (f, pdf) = bsdf_values(&rough, wo, b.wi);
            let is_fine = f.is_finite() && pdf.is_finite() && b.weight.max_element() < 4.0;
            bad += u64::from(!is_fine);
        }
        let (sum, _) = scattered(case, &rough, wo, 5300);
        case.exact(format!("{name} of width 1e-4: albedo"), sum, 1.0, Within::Absolute(1e-4));
        case.rarely(format!("{name} of width 1e-4: lost or not finite"), bad, tries, 1e-4);
        case.at_most(format!("{name} of width 1e-4: weight off the smooth one's"), weights, 1e-2);
        // Trowbridge and Reitz's distribution has tails: alpha^2 / (alpha^2 + s^2) of the facets are steeper than s, which is
        // 4e-4 of them beyond half of this angle.
        case.rarely(format!("{name} of width 1e-4: direction off the smooth one's by 0.01"), off, tries, 1e-3);
    }
}

fn bsdf_values(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> (f64, f64) {
    let (f, pdf) = bsdf.f_pdf(wo, wi, TransportMode::Radiance);
    (f64::from(f.r()), f64::from(pdf))
}

fn thin_sheet(case: &mut Case) {
    let sheet = |transmittance| frosted(transmittance, MicrofacetsDesc::default());
    // (1 - R) / (1 + R), by polarisation and not by the mean of both: at 60 degrees the two differ.
    for (degrees, exact) in [(0.0_f64, 12.0 / 13.0), (30.0, f64::NAN), (60.0, f64::NAN), (85.0, f64::NAN)] {
        let cos = degrees.to_radians().cos();
        let [s, p] = etendue::bsdf::fresnel_polarised(f64::from(cos as f32), 1.5);
        let both = 0.5 * ((1.0 - s) / (1.0 + s) + (1.0 - p) / (1.0 + p));
        let exact = if exact.is_nan() { both } else { exact };
        let [reflected, _, transmitted] =
            sheet(Rgb::ONE).specular_lobes(direction(degrees, 10.0), TransportMode::Radiance);
        let [r, t] = [reflected, transmitted].map(|lobe| f64::from(lobe.expect("is there").weight.r()));
        case.exact(format!("clear, {degrees}°: transmitted"), t, exact, Within::Relative(2e-6));
        case.exact(format!("clear, {degrees}°: all"), r + t, 1.0, Within::Relative(2e-6));
    }
    // At Brewster's angle half of the light passes whole.
    let brewster = 1.5_f64.atan().to_degrees();
    let [s, p] = etendue::bsdf::fresnel_polarised(brewster.to_radians().cos(), 1.5);
    case.at_most("reflectance in the plane of incidence at Brewster's angle", p, 1e-12);
    case.exact("across it", 0.5 * s, 0.0739644970414, Within::Relative(1e-6));
    // Tinted: all reflections between the faces, summed one after another.
    let lobes = sheet(Rgb::splat(0.5)).specular_lobes(direction(60.0, 10.0), TransportMode::Radiance);
    let [s, p] = etendue::bsdf::fresnel_polarised(0.5, 1.5);
    let a = 0.5_f64.powf(1.0 / (1.0 - 0.75_f64 / 2.25).sqrt());
    let mut sums = [0.0, 0.0];
    for r in [s, p] {
        let mut inside = 0.5 * (1.0 - r) * a;
        sums[0] += 0.5 * r;
        for way in 0..200 {
            sums[usize::from(way % 2 == 0)] += inside * (1.0 - r);
            inside *= r * a;
        }
    }
    for (lobe, exact, name) in [(lobes[0], sums[0], "reflected"), (lobes[2], sums[1], "transmitted")] {
        let found = f64::from(lobe.expect("is there").weight.g());
        case.exact(format!("tinted, 60°: {name}"), found, exact, Within::Relative(1e-5));
    }
    // Frosted: one facet has the shares of the smooth sheet at the angle to it, on either side.
    let rough = frosted(Rgb::splat(0.5), once(MicrofacetsDesc::rough(0.5)));
    let white = metal(white(), once(MicrofacetsDesc::rough(0.5)));
    let (wo, wi) = (direction(50.0, 10.0), direction(35.0, 230.0));
    let cos = wo.dot((wo + wi).normalize());
    let at_facet = sheet(Rgb::splat(0.5))
        .specular_lobes(direction(f64::from(cos).acos().to_degrees(), 0.0), TransportMode::Radiance);
    let facets = f64::from(white.f(wo, wi, TransportMode::Radiance).r());
    for (lobe, z, name) in [(at_facet[0], 1.0, "reflected"), (at_facet[2], -1.0, "transmitted")] {
        let exact = facets * f64::from(lobe.expect("is there").weight.r());
        let found = f64::from(rough.f(wo, Vec3::new(wi.x, wi.y, z * wi.z), TransportMode::Radiance).r());
        case.exact(format!("frosted: f of what is {name}"), found, exact, Within::Relative(1e-5));
    }
}

fn coated(case: &mut Case) {
    // Smooth coat: the closed form of all bounces between coat and base.
    let (eta, rho) = (1.5, 0.6_f32);
    let outside = 0.0917779593424;
    let inside = 0.596345759708;
    let bsdf = Bsdf::new(&BsdfDesc::CoatedDiffuse {
        albedo: Rgb::splat(rho),
        ior: 1.5,
        exterior_ior: 1.0,
        microfacets: MicrofacetsDesc::default(),
    });
    let mut worst = Worst::default();
    for (a, b) in [(0.0, 0.0), (30.0, 60.0), (70.0, 10.0), (80.0, 85.0)] {
        let (wo, wi) = (direction(a, 0.0), direction(b, 130.0));
        let passes = |w: Vec3| 1.0 - etendue::bsdf::fresnel_dielectric(f64::from(w.z), eta);
        let exact = passes(wo) * passes(wi) / (eta * eta) * f64::from(rho) / (PI * (1.0 - f64::from(rho) * inside));
        worst.add(f64::from(bsdf.f(wo, wi, TransportMode::Radiance).g()), exact);
    }
    worst.row(case, "smooth coat: f off the closed form", 2e-5);
    let mean = outside + (1.0 - outside) * f64::from(rho) * (1.0 - inside) / (1.0 - f64::from(rho) * inside);
    case.exact("smooth coat: mean albedo", f64::from(bsdf.albedo().g()), mean, Within::Relative(1e-3));
    for (i, degrees) in [0.0, 45.0, 80.0].into_iter().enumerate() {
        let wo = direction(degrees, 0.0);
        let passes = 1.0 - etendue::bsdf::fresnel_dielectric(f64::from(wo.z), eta);
        let exact = 1.0 - passes + passes * f64::from(rho) * (1.0 - inside) / (1.0 - f64::from(rho) * inside);
        case.mean(
            format!("smooth coat: albedo at {degrees}°"),
            scattered(case, &bsdf, wo, 5500 + i as u32),
            exact,
            1e-3,
        );
    }
    for r in [0.2, 0.5, 1.0] {
        let white = Bsdf::new(&BsdfDesc::CoatedDiffuse {
            albedo: Rgb::ONE,
            ior: 1.5,
            exterior_ior: 1.0,
            microfacets: MicrofacetsDesc::rough(r),
        });
        for (i, degrees) in [0.0, 60.0, 85.0].into_iter().enumerate() {
            let found = scattered(case, &white, direction(degrees, 0.0), 5600 + i as u32);
            case.biased_mean(format!("white under a coat of roughness {r} at {degrees}°"), found, 1.0, (1e-3, 1e-3));
        }
    }
}
