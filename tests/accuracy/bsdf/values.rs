//! Values of the diffuse models: tabulated ones, limits, reciprocity, and the ends of the hemisphere.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::bsdf::{Bsdf, Dielectric, Model as _, TransportMode};
use etendue::desc::BsdfDesc;
use etendue::math::Vec3;
use etendue::sampling::{Rng, warps};
use etendue::spectrum::Rgb;

use super::{Worst, diffuse_models, direction, lambert, oren_nayar, oren_nayar_qualitative, uniform_3d};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "B27", title: "Lambert", run: lambert_values },
        Entry { id: "B28", title: "rough diffuse values", run: rough_values },
        Entry { id: "B30", title: "limits", run: limits },
        Entry { id: "B31", title: "reciprocity", run: reciprocity },
        Entry { id: "B39", title: "grazing weights", run: grazing },
    ]
}

fn lambert_values(case: &mut Case) {
    let tries = case.count(10_000, 1_000_000);
    for albedo in [0.1_f32, 0.5, 1.0] {
        let bsdf = lambert(albedo);
        let (wo, wi) = (direction(20.0, 0.0), direction(70.0, 50.0));
        let exact = f64::from(albedo) / PI;
        case.exact(
            format!("f, albedo {albedo}"),
            f64::from(bsdf.f(wo, wi, TransportMode::Radiance).r()),
            exact,
            Within::Ulps(1.0),
        );
        let mut rng = Rng::new(27, 0);
        let other = (0..tries).filter(|_| {
            let wo = warps::uniform_sphere(rng.next_2d());
            bsdf.sample(wo, uniform_3d(&mut rng), TransportMode::Radiance)
                .is_none_or(|sample| sample.weight != Rgb::splat(albedo))
        });
        case.never(format!("a weight other than {albedo}"), other.count() as u64, tries);
    }
}

/// (theta_i, theta_o, difference of azimuths) in degrees, then per roughness f / albedo.
const ANGLES: [(f64, f64, f64); 5] =
    [(30.0, 45.0, 0.0), (60.0, 60.0, 0.0), (60.0, 60.0, 180.0), (80.0, 70.0, 120.0), (89.0, 89.0, 0.0)];
const QUALITATIVE: [(f32, [f64; 5]); 4] = [
    (0.1, [0.319476584455, 0.335114775763, 0.313628858446, 0.313628858446, 1.13412212679]),
    (0.3, [0.313443885568, 0.391634842108, 0.284205255521, 0.284205255521, 4.38667159723]),
    (0.5, [0.292706602972, 0.407693303767, 0.249708617610, 0.249708617610, 6.28274735542]),
    (1.0, [0.252293377908, 0.395763022937, 0.198644515438, 0.198644515438, 7.72610569289]),
];
const FUJII: [(f32, [f64; 5]); 4] = [
    (0.1, [0.322036825287, 0.355816213012, 0.286199997423, 0.295088958168, 2.08171779418]),
    (0.3, [0.328898297545, 0.424867145672, 0.227084164066, 0.252338124579, 5.32823567543]),
    (0.5, [0.335069257632, 0.486969058114, 0.173917520755, 0.213889570416, 8.24803648675]),
    (1.0, [0.348083279391, 0.617936626922, 0.0617936626922, 0.132804890978, 14.4056441774]),
];

fn rough_values(case: &mut Case) {
    for (name, table, model) in
        [("qualitative", QUALITATIVE, oren_nayar_qualitative as fn(f32) -> Bsdf), ("Fujii", FUJII, oren_nayar)]
    {
        for (roughness, values) in table {
            let (mut upright, mut grazing) = (Worst::default(), Worst::default());
            for ((theta_i, theta_o, dphi), value) in ANGLES.into_iter().zip(values) {
                // The azimuth itself must not matter.
                for phi in [0.0, 77.0, 200.0] {
                    let f = model(roughness).f(
                        direction(theta_o, phi + dphi),
                        direction(theta_i, phi),
                        TransportMode::Radiance,
                    );
                    let worst = if theta_i == 89.0 { &mut grazing } else { &mut upright };
                    worst.add(f64::from(f.r()), value);
                }
            }
            upright.row(case, format!("{name} {roughness}, worst of 4 pairs up to 80°"), 2e-6);
            grazing.row(case, format!("{name} {roughness} at 89°, 89°"), 1e-4);
        }
    }
    // At the pole there is no azimuth.
    let mut bad = 0;
    let poles = [Vec3::Z, Vec3::new(1e-38, 0.0, 1.0), Vec3::new(0.0, -1e-45, 1.0)];
    for wo in poles {
        for wi in poles {
            let tops = [
                oren_nayar_qualitative(0.5).f(wo, wi, TransportMode::Radiance).r(),
                oren_nayar(0.5).f(wo, wi, TransportMode::Radiance).r(),
            ]
            .map(f64::from);
            // Facing it there is no shadow term: A / pi and A.
            let exact = [(1.0 - 0.25 / (2.0 * 0.58)) / PI, 1.0 / (PI + 0.5 * (FRAC_PI_2 - 2.0 / 3.0))];
            bad += tops.into_iter().zip(exact).filter(|(got, exact)| (got / exact - 1.0).abs() > 2e-7).count() as u64;
        }
    }
    case.never("at the pole: other than its value there", bad, 18);
}

fn limits(case: &mut Case) {
    let tries = case.count(10_000, 1_000_000);
    let albedo = Rgb::new(0.123, 0.456, 0.789);
    let lambert = Bsdf::new(&BsdfDesc::Lambert { albedo });
    for (name, smooth) in [
        ("qualitative 0", BsdfDesc::OrenNayarQualitative { albedo, sigma: 0.0 }),
        ("qualitative -0", BsdfDesc::OrenNayarQualitative { albedo, sigma: -0.0 }),
        ("Fujii 0", BsdfDesc::OrenNayar { albedo, roughness: 0.0 }),
    ] {
        let smooth = Bsdf::new(&smooth);
        let mut rng = Rng::new(30, 0);
        let different = (0..tries).filter(|_| {
            let (wo, wi) = (warps::uniform_sphere(rng.next_2d()), warps::uniform_sphere(rng.next_2d()));
            let u = uniform_3d(&mut rng);
            smooth.f_pdf(wo, wi, TransportMode::Radiance) != lambert.f_pdf(wo, wi, TransportMode::Radiance)
                || smooth.sample(wo, u, TransportMode::Radiance) != lambert.sample(wo, u, TransportMode::Radiance)
        });
        case.never(format!("{name}: any bit unlike Lambert"), different.count() as u64, tries);
    }
    for (name, rough) in [("qualitative 1e-4", oren_nayar_qualitative(1e-4)), ("Fujii 1e-4", oren_nayar(1e-4))] {
        let mut rng = Rng::new(30, 1);
        let mut worst = Worst::default();
        for _ in 0..tries {
            let (wo, wi) = (warps::cosine_hemisphere(rng.next_2d()), warps::cosine_hemisphere(rng.next_2d()));
            // Where a direction grazes, any roughness matters.
            if wo.z.max(wi.z) > 0.2 {
                worst.add(f64::from(rough.f(wo, wi, TransportMode::Radiance).r()), 1.0 / PI);
            }
        }
        worst.row(case, format!("{name} against Lambert, cosine above 0.2"), 1e-3);
    }

    // Media that are equal are invisible, nearly equal ones nearly so.
    let mut bad = 0;
    for (ior, exterior_ior) in [(1.0, 1.0), (1.5, 1.5), (1.333, 1.333)] {
        let bsdf = Bsdf::new(&BsdfDesc::Dielectric { ior, exterior_ior });
        let mut rng = Rng::new(30, 2);
        for _ in 0..tries {
            let wo = warps::uniform_sphere(rng.next_2d());
            let is_straight = bsdf
                .sample(wo, uniform_3d(&mut rng), TransportMode::Radiance)
                .is_some_and(|sample| (sample.wi, sample.weight, sample.eta) == (-wo, Rgb::ONE, 1.0));
            bad += u64::from(!is_straight);
        }
    }
    case.never("equal media: any bit of the direction or weight changed", bad, 3 * tries);
    let (mut largest, mut furthest) = (0.0_f64, 0.0_f64);
    for offset in [1e-6_f32, -1e-6] {
        let dielectric = Dielectric::new(1.0 + offset, 1.0);
        let mut rng = Rng::new(30, 3);
        for _ in 0..tries {
            let wo = warps::uniform_sphere(rng.next_2d());
            if wo.z.abs() > 0.1 {
                let (reflectance, _, refracted) = dielectric.branches(wo);
                largest = largest.max(f64::from(reflectance));
                furthest = furthest.max(refracted.map_or(f64::INFINITY, |(wi, _)| f64::from((wi + wo).length())));
            }
        }
    }
    // F is at most ((eta - 1) / (2 cos^2))^2, the deflection (eta - 1) tan.
    case.at_most("index 1 ± 1e-6, cosine above 0.1: reflectance", largest, 2.6e-9);
    case.at_most("index 1 ± 1e-6, cosine above 0.1: deflection", furthest, 1.05e-5);
}

fn reciprocity(case: &mut Case) {
    let tries = case.count(20_000, 1_000_000);
    for (name, bsdf) in diffuse_models() {
        let mut rng = Rng::new(31, 0);
        let (mut worst, mut through) = (0.0_f64, 0);
        for _ in 0..tries {
            let (a, b) = (warps::uniform_sphere(rng.next_2d()), warps::uniform_sphere(rng.next_2d()));
            let (ab, ba) = (
                f64::from(bsdf.f(a, b, TransportMode::Radiance).r()),
                f64::from(bsdf.f(b, a, TransportMode::Radiance).r()),
            );
            if ab != ba {
                worst = worst.max((ab - ba).abs() / ab.max(ba));
            }
            // Fujii at roughness 1 may reach 0 from above.
            through += u64::from((ab > 0.0) != (a.z * b.z > 0.0));
        }
        case.at_most(format!("{name}: relative difference of f(a, b), f(b, a)"), worst, 2e-6);
        case.never(format!("{name}: light that passes, or none on its side"), through, tries);
    }
    // Through an interface: f(a, b) / n_b^2 is symmetric where the weights (n_a / n_b)^2 (1 - F) / (1 - F) cancel.
    let glass = Dielectric::new(1.5, 1.0);
    let mut rng = Rng::new(31, 1);
    let (mut fresnel, mut scaling) = (0.0_f64, 0.0_f64);
    for _ in 0..tries {
        let wo = warps::uniform_hemisphere(rng.next_2d());
        let (there, _, refracted) = glass.branches(wo);
        let Some((wi, eta)) = refracted else { continue };
        let (back, _, again) = glass.branches(wi);
        // At grazing a rounded direction inside says nothing about the one outside.
        if wo.z > 0.05 {
            fresnel = fresnel.max(f64::from((there - back).abs()) / f64::from(1.0 - there));
            scaling = scaling.max(again.map_or(1.0, |(_, back)| (f64::from(eta) * f64::from(back) - 1.0).abs()));
        }
    }
    case.at_most("glass: relative difference of 1 - F both ways", fresnel, 1e-4);
    case.at_most("glass: eta there times eta back, off 1", scaling, 2e-7);
}

/// Bound on pi f cos / albedo over all pairs of directions: s is at most 1, and t at least either cosine.
fn bound(bsdf: &Bsdf, name: &str) -> f64 {
    let roughness: f64 = name.rsplit(' ').next().and_then(|number| number.parse().ok()).unwrap_or(0.0);
    match bsdf {
        Bsdf::OrenNayarQualitative(_) => {
            let s2 = roughness * roughness;
            1.0 - s2 / (2.0 * (s2 + 0.33)) + 0.45 * s2 / (s2 + 0.09)
        }
        Bsdf::OrenNayar(_) => (1.0 + roughness) * PI / (PI + (FRAC_PI_2 - 2.0 / 3.0) * roughness),
        _ => 0.8,
    }
}

/// Cosines down to denormal numbers.
const COSINES: [f32; 8] = [1e-3, 1e-5, 1e-7, 1e-20, 1e-30, 1e-38, 1e-45, 0.0];

fn grazing(case: &mut Case) {
    let tries = case.count(200, 20_000);
    for (name, bsdf) in diffuse_models() {
        let bound = bound(&bsdf, name) * (1.0 + 1e-6);
        let mut rng = Rng::new(39, 0);
        let (mut bad_values, mut values, mut bad_samples, mut samples) = (0, 0, 0, 0);
        for cos in COSINES {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let mirrored = Vec3::new(-wo.x, 0.0, cos);
            let mut wis = vec![-wo, wo, mirrored, Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X];
            wis.extend(COSINES.map(|z| Vec3::new(0.0, (1.0 - z * z).sqrt(), z)));
            wis.extend((0..tries).map(|_| warps::uniform_sphere(rng.next_2d())));
            for wi in wis {
                let (f, pdf) = bsdf.f_pdf(wo, wi, TransportMode::Radiance);
                let larger = f64::from(wo.z.abs().max(wi.z.abs()));
                let fine = f.is_finite()
                    && f.r() >= 0.0
                    && PI * f64::from(f.r()) * larger <= bound
                    && pdf.is_finite()
                    && pdf >= 0.0
                    && (f.r() == 0.0 || pdf > 0.0);
                values += 1;
                bad_values += u64::from(!fine);
            }
            // The extreme numbers of a sampler among the others.
            let ends = [0.0, 0.5, 1.0_f32.next_down()];
            let corners = ends.into_iter().flat_map(|u| ends.map(|v| [u, v, v]));
            let numbers: Vec<_> = corners.chain((0..tries).map(|_| uniform_3d(&mut rng))).collect();
            for u in numbers {
                let fine = match bsdf.sample(wo, u, TransportMode::Radiance) {
                    Some(sample) => {
                        let larger = f64::from(cos.max(sample.wi.z));
                        sample.weight.is_finite()
                            && sample.pdf > 0.0
                            && sample.wi.z > 0.0
                            && f64::from(sample.weight.r()) * larger <= bound
                    }
                    None => cos == 0.0,
                };
                samples += 1;
                bad_samples += u64::from(!fine);
            }
        }
        case.never(format!("{name}: f, pdf not finite or above the bound"), bad_values, values);
        case.never(format!("{name}: weights not finite or above the bound"), bad_samples, samples);
    }
}
