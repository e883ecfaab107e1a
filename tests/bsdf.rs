//! Scattering models: values, reciprocity, energy, and that samples follow the densities they claim.

mod common {
    // Each test program uses its own part.
    #[allow(dead_code)]
    pub mod stats;
}

use common::stats::{SIGNIFICANCE, check_directions, mean_and_error, sidak, z_test};
use etendue::bsdf::{Bsdf, BsdfSample, Dielectric, fresnel_dielectric, refracted_cosine};
use etendue::desc::BsdfDesc;
use etendue::math::Vec3;
use etendue::sampling::{Rng, Sampler, SobolSampler, warps};
use etendue::spectrum::Rgb;

fn direction(theta_deg: f64, phi_deg: f64) -> Vec3 {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
    Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
}

fn lambert(albedo: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Lambert { albedo: Rgb::splat(albedo) })
}

fn oren_nayar(sigma: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::OrenNayar { albedo: Rgb::ONE, sigma })
}

fn fujii(roughness: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Fujii { albedo: Rgb::ONE, roughness })
}

fn mirror() -> Bsdf {
    Bsdf::new(&BsdfDesc::Mirror { reflectance: Rgb::new(0.9, 0.8, 0.7) })
}

fn glass(ior: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Dielectric { ior, exterior_ior: 1.0 })
}

fn diffuse_models() -> Vec<Bsdf> {
    vec![lambert(0.8), oren_nayar(0.1), oren_nayar(0.5), oren_nayar(1.0), fujii(0.1), fujii(0.5), fujii(1.0)]
}

fn uniform_3d(rng: &mut Rng) -> [f32; 3] {
    let [a, b, c, _] = rng.next_4d();
    [a, b, c]
}

/// (theta_i, theta_o, difference of azimuths) in degrees, then per sigma: qualitative and Fujii f / albedo.
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

#[test]
fn rough_diffuse_models_give_the_tabulated_values() {
    for (table, model) in [(QUALITATIVE, oren_nayar as fn(f32) -> Bsdf), (FUJII, fujii)] {
        for (roughness, values) in table {
            for ((theta_i, theta_o, dphi), value) in ANGLES.into_iter().zip(values) {
                // The azimuth itself must not matter.
                for phi in [0.0, 77.0, 200.0] {
                    let f = model(roughness).f(direction(theta_o, phi + dphi), direction(theta_i, phi));
                    let tolerance = if theta_i == 89.0 { 1e-4 } else { 2e-6 };
                    assert_eq!((f.x, f.x), (f.y, f.z));
                    let error = (f64::from(f.x) / value - 1.0).abs();
                    assert!(error < tolerance, "{roughness} at {theta_i}, {theta_o}, {dphi}: {} for {value}", f.x);
                }
            }
        }
    }
}

#[test]
fn lambert_is_albedo_over_pi_and_weighs_exactly_its_albedo() {
    let bsdf = Bsdf::new(&BsdfDesc::Lambert { albedo: Rgb::new(0.1, 0.5, 1.0) });
    let f = bsdf.f(direction(20.0, 0.0), direction(70.0, 50.0));
    for (value, albedo) in f.to_array().into_iter().zip([0.1_f32, 0.5, 1.0]) {
        let exact = f64::from(albedo) / std::f64::consts::PI;
        assert!((f64::from(value) / exact - 1.0).abs() < 1.2e-7);
    }
    let mut rng = Rng::new(1, 0);
    for _ in 0..1000 {
        let sample = bsdf.sample(direction(40.0, 0.0), uniform_3d(&mut rng)).unwrap();
        assert_eq!(sample.weight, Rgb::new(0.1, 0.5, 1.0));
    }
}

#[test]
fn no_roughness_is_lambert_to_the_last_bit() {
    let mut rng = Rng::new(2, 0);
    let albedo = Rgb::new(0.123, 0.456, 0.789);
    let lambert = Bsdf::new(&BsdfDesc::Lambert { albedo });
    for smooth in [
        Bsdf::new(&BsdfDesc::OrenNayar { albedo, sigma: 0.0 }),
        Bsdf::new(&BsdfDesc::Fujii { albedo, roughness: 0.0 }),
        Bsdf::new(&BsdfDesc::OrenNayar { albedo, sigma: -0.0 }),
    ] {
        for _ in 0..10_000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let wi = warps::uniform_sphere(rng.next_2d());
            let u = uniform_3d(&mut rng);
            assert_eq!(smooth.f_pdf(wo, wi), lambert.f_pdf(wo, wi));
            assert_eq!(smooth.sample(wo, u), lambert.sample(wo, u));
        }
    }
    for rough in [oren_nayar(1e-4), fujii(1e-4)] {
        for _ in 0..10_000 {
            let (wo, wi) = (warps::cosine_hemisphere(rng.next_2d()), warps::cosine_hemisphere(rng.next_2d()));
            if wo.z.max(wi.z) > 0.2 {
                assert!((rough.f(wo, wi).x * std::f32::consts::PI - 1.0).abs() < 1e-3);
            }
        }
    }
}

#[test]
fn reflection_is_reciprocal() {
    let mut rng = Rng::new(3, 0);
    let models = diffuse_models();
    for i in 0..1_000_000 {
        let bsdf = &models[i % models.len()];
        let a = warps::uniform_sphere(rng.next_2d());
        let b = warps::uniform_sphere(rng.next_2d());
        let (ab, ba) = (bsdf.f(a, b), bsdf.f(b, a));
        assert!((ab.x - ba.x).abs() <= 2e-6 * ab.x, "{bsdf:?} {a} {b}");
        assert_eq!(ab.x > 0.0, a.z * b.z > 0.0, "two-sided, nothing through: {bsdf:?} {a} {b}");
    }
}

#[test]
fn nothing_depends_on_which_side_is_lit() {
    let mut rng = Rng::new(4, 0);
    let flip = |w: Vec3| Vec3::new(w.x, w.y, -w.z);
    for bsdf in diffuse_models().into_iter().chain([mirror()]) {
        for _ in 0..1000 {
            let (wo, wi) = (warps::uniform_hemisphere(rng.next_2d()), warps::uniform_hemisphere(rng.next_2d()));
            let u = uniform_3d(&mut rng);
            assert_eq!(bsdf.f_pdf(wo, wi), bsdf.f_pdf(flip(wo), flip(wi)));
            let (up, down) = (bsdf.sample(wo, u).unwrap(), bsdf.sample(flip(wo), u).unwrap());
            assert_eq!((up.wi, up.weight, up.pdf), (flip(down.wi), down.weight, down.pdf));
        }
    }
}

/// Mean weight of samples, the directional albedo, and its standard error from independent replicates.
fn sampled_albedo(bsdf: &Bsdf, wo: Vec3, pixel: u32) -> (f64, f64) {
    const REPLICATES: u32 = 64;
    const SIZE: u32 = 8192;
    let mut sampler = SobolSampler::new(15, SIZE);
    let mut weight = |i| {
        sampler.start(pixel, i);
        let [a, b, c, _] = sampler.next_4d();
        bsdf.sample(wo, [a, b, c]).map_or(0.0, |sample| f64::from(sample.weight.x))
    };
    let replicate = |r: u32| (r * SIZE..(r + 1) * SIZE).map(&mut weight).sum::<f64>() / f64::from(SIZE);
    mean_and_error(&(0..REPLICATES).map(replicate).collect::<Vec<_>>())
}

/// The same without the sampler: the integral of f cos over the hemisphere, midpoints in root of cosine and azimuth.
fn integrated_albedo(bsdf: &Bsdf, wo: Vec3) -> f64 {
    const N: usize = 600;
    let mut sum = 0.0;
    for i in 0..N {
        // cos = t^2 puts more points at grazing, where f is steep.
        let t = (i as f64 + 0.5) / N as f64;
        let (cos, jacobian) = (t * t, 2.0 * t);
        let sin = (1.0 - cos * cos).sqrt();
        for j in 0..N {
            let (s, c) = (std::f64::consts::TAU * (j as f64 + 0.5) / N as f64).sin_cos();
            let wi = Vec3::new((sin * c) as f32, (sin * s) as f32, cos as f32);
            sum += f64::from(bsdf.f(wo, wi).x) * cos * jacobian;
        }
    }
    sum * std::f64::consts::TAU / (N * N) as f64
}

#[test]
fn directional_albedo_is_the_tabulated_one() {
    // Columns: Fujii 0.3, 0.5, 1, qualitative 0.3, 0.5, 1.
    let table = [
        (0.0, [0.920523795583, 0.874204808855, 0.776522067008, 0.892857142857, 0.784482758621, 0.624060150376]),
        (30.0, [0.924808861500, 0.880987224927, 0.788571178827, 0.920221656848, 0.824724690960, 0.674270267791]),
        (60.0, [0.952103140699, 0.924188697546, 0.865319548261, 0.959936192514, 0.883128419881, 0.747140975434]),
        (80.0, [0.983798074275, 0.974355540020, 0.954442050949, 0.991431190528, 0.929444593430, 0.804929962615]),
        (89.0, [0.998454039543, 0.997553048832, 0.995652937254, 1.00409029412, 0.948060922238, 0.828157675623]),
    ];
    for (theta, row) in table {
        for (column, exact) in row.into_iter().enumerate() {
            let roughness = [0.3, 0.5, 1.0][column % 3];
            let bsdf = if column < 3 { fujii(roughness) } else { oren_nayar(roughness) };
            let wo = direction(theta, 13.0);
            let integrated = integrated_albedo(&bsdf, wo);
            assert!((integrated - exact).abs() < 3e-4, "theta {theta}, column {column}: {integrated} for {exact}");
            let (mean, error) = sampled_albedo(&bsdf, wo, theta as u32 * 6 + column as u32);
            assert!(error < 1e-3 * exact);
            // At normal incidence all weights are equal; what is left is rounding.
            let p = z_test(mean, error.max(1e-7), exact);
            assert!(p > sidak(SIGNIFICANCE, 30), "theta {theta}, column {column}: {mean} +- {error} for {exact}");
        }
    }
}

#[test]
fn mean_albedo_of_fujii_is_the_closed_form() {
    for (roughness, exact) in [(0.3, 0.940541932923), (0.5, 0.905889580813), (1.0, 0.832810763579)] {
        let bsdf = fujii(roughness);
        let mut rng = Rng::new(5, 0);
        let weights: Vec<f64> = (0..1_000_000)
            .map(|_| {
                let wo = warps::cosine_hemisphere(rng.next_2d());
                f64::from(bsdf.sample(wo, uniform_3d(&mut rng)).unwrap().weight.x)
            })
            .collect();
        let (mean, error) = mean_and_error(&weights);
        assert!(error < 1e-3);
        assert!(z_test(mean, error, exact) > sidak(SIGNIFICANCE, 3), "{roughness}: {mean} +- {error} for {exact}");
    }
}

#[test]
fn weight_is_f_cos_over_pdf_and_pdf_is_the_one_asked_for() {
    let mut rng = Rng::new(6, 0);
    for bsdf in diffuse_models() {
        for _ in 0..100_000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let Some(BsdfSample { wi, weight, pdf, is_delta, eta }) = bsdf.sample(wo, uniform_3d(&mut rng)) else {
                panic!("{bsdf:?} scatters every direction");
            };
            let f = bsdf.f(wo, wi);
            assert!(!is_delta && eta == 1.0 && pdf > 0.0);
            assert_eq!(pdf, bsdf.pdf(wo, wi));
            assert!((weight.x - f.x * wi.z.abs() / pdf).abs() <= 1e-5 * weight.x);
            assert!((wi.length() - 1.0).abs() < 3e-7);
        }
    }
}

/// Incident directions of the chi-square tests; the last two look from below and along the surface.
fn incident() -> Vec<Vec3> {
    let grazing = 0.05_f64.acos().to_degrees();
    vec![
        direction(0.0, 0.0),
        direction(30.0, 45.0),
        direction(60.0, 200.0),
        direction(grazing, 10.0),
        direction(150.0, 300.0),
    ]
}

#[test]
fn diffuse_samples_follow_their_density() {
    let models = diffuse_models();
    let tests = models.len() * incident().len();
    for (i, bsdf) in models.iter().enumerate() {
        for (j, wo) in incident().into_iter().enumerate() {
            let mut rng = Rng::new(7, (i * 100 + j) as u64);
            let check = check_directions(
                500_000,
                || {
                    let sample = bsdf.sample(wo, uniform_3d(&mut rng)).unwrap();
                    (sample.wi.to_array(), sample.pdf)
                },
                |wi| bsdf.pdf(wo, Vec3::from_array(wi)),
            );
            assert!(check.passes(sidak(SIGNIFICANCE, tests)), "{bsdf:?} {wo}: {check:?}");
        }
    }
}

#[test]
fn the_density_check_finds_wrong_densities() {
    let bsdf = oren_nayar(0.5);
    let wo = direction(30.0, 0.0);
    let check = |density: &dyn Fn([f32; 3]) -> f32| {
        let mut rng = Rng::new(8, 0);
        check_directions(
            500_000,
            || {
                let wi = bsdf.sample(wo, uniform_3d(&mut rng)).unwrap().wi.to_array();
                (wi, density(wi))
            },
            density,
        )
    };
    let pdf = |wi| bsdf.pdf(wo, Vec3::from_array(wi));
    assert!(check(&pdf).passes(SIGNIFICANCE));
    // Too large or too small by 2 %.
    assert!(!check(&|wi| 1.02 * pdf(wi)).passes(1e-6));
    assert!(!check(&|wi| 0.98 * pdf(wi)).passes(1e-6));
    // The cosine dropped: normalised, of the right support, and wrong.
    let no_cosine = check(&|wi| if wi[2] > 0.0 { warps::uniform_hemisphere_pdf() } else { 0.0 });
    assert!((no_cosine.integral - 1.0).abs() < 1e-3 && no_cosine.p_value < 1e-6, "{no_cosine:?}");
    // A tilt of 10 % that leaves the integral alone.
    let tilted = check(&|wi| pdf(wi) * (1.0 + 0.1 * wi[0]));
    assert!((tilted.integral - 1.0).abs() < 1e-3 && tilted.p_value < 1e-6, "{tilted:?}");
}

#[test]
fn grazing_directions_stay_finite_and_bounded() {
    let mut rng = Rng::new(9, 0);
    for bsdf in diffuse_models() {
        for cos in [1e-3_f32, 1e-5, 1e-7, 1e-20, 1e-38, 0.0] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let mirrored = Vec3::new(-wo.x, 0.0, cos);
            let mut wis = vec![-wo, wo, mirrored, Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X];
            wis.extend((0..1000).map(|_| warps::uniform_sphere(rng.next_2d())));
            for wi in wis {
                let (f, pdf) = bsdf.f_pdf(wo, wi);
                // albedo (a + b) / pi bounds f times either cosine: at most 2.25 / pi over these models.
                let bounded = f.x * wi.z.abs() <= 0.72 && f.x * cos <= 0.72;
                assert!(f.is_finite() && f.x >= 0.0 && bounded, "{bsdf:?} {wo} {wi}: {f}");
                assert!(pdf.is_finite() && pdf >= 0.0);
                assert!(f.x == 0.0 || pdf > 0.0);
            }
            for _ in 0..1000 {
                match bsdf.sample(wo, uniform_3d(&mut rng)) {
                    Some(sample) => assert!(sample.weight.is_finite() && sample.pdf > 0.0 && sample.wi.z > 0.0),
                    None => assert_eq!(cos, 0.0),
                }
            }
            // The extreme numbers of a sampler.
            for u in [0.0, 0.5, 1.0_f32.next_down()] {
                for v in [0.0, 0.5, 1.0_f32.next_down()] {
                    if let Some(sample) = bsdf.sample(wo, [u, v, v]) {
                        assert!(sample.weight.is_finite() && sample.pdf > 0.0 && sample.wi.z > 0.0);
                    }
                }
            }
        }
    }
}

#[test]
fn delta_models_have_neither_value_nor_density() {
    let mut rng = Rng::new(10, 0);
    for bsdf in [mirror(), glass(1.5), glass(1.0)] {
        assert!(bsdf.is_delta() && !bsdf.is_black());
        for _ in 0..1000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let sample = bsdf.sample(wo, uniform_3d(&mut rng)).unwrap();
            assert!(sample.is_delta && sample.pdf == 0.0);
            assert_eq!(bsdf.f_pdf(wo, sample.wi), (Rgb::ZERO, 0.0));
        }
    }
    let black = Bsdf::new(&BsdfDesc::Black);
    assert!(!black.is_delta() && black.is_black() && black.albedo() == Rgb::ZERO);
    assert!(black.sample(Vec3::Z, [0.5; 3]).is_none());
    assert_eq!(black.f_pdf(Vec3::Z, Vec3::Z), (Rgb::ZERO, 0.0));
}

#[test]
fn mirror_reflects_on_both_sides() {
    for wo in [direction(50.0, 20.0), direction(130.0, 20.0)] {
        let sample = mirror().sample(wo, [0.3; 3]).unwrap();
        assert_eq!(sample.wi, Vec3::new(-wo.x, -wo.y, wo.z));
        assert_eq!((sample.weight, sample.eta), (Rgb::new(0.9, 0.8, 0.7), 1.0));
    }
}

#[test]
fn fresnel_matches_the_tables() {
    let outside = [
        (0.0, [0.0203731878420, 0.0400000000000, 0.171968832523]),
        (30.0, [0.0214364658634, 0.0415226259758, 0.173460213595]),
        (45.0, [0.0278983645984, 0.0502399110122, 0.181116156648]),
        (60.0, [0.0596909191752, 0.0891867128022, 0.211261437900]),
        (75.0, [0.212377582677, 0.253060562990, 0.330500003127]),
        (85.0, [0.583523478697, 0.612799645265, 0.621708605457]),
        (89.0, [0.896276403745, 0.904184949780, 0.899745971067]),
        (89.9, [0.989067615480, 0.989911876919, 0.989234157905]),
    ];
    for (theta, row) in outside {
        for (n, exact) in [1.333, 1.5, 2.417].into_iter().zip(row) {
            let f = fresnel_dielectric(f64::to_radians(theta).cos(), n);
            assert!((f / exact - 1.0).abs() < 1e-11, "{theta} degrees, n = {n}: {f}");
        }
    }
    for (n, theta, exact) in [
        (1.333, 53.1232257604, 0.0391355019711),
        (1.5, 56.3099324740, 0.0739644970414),
        (2.417, 67.5233573527, 0.250407662529),
    ] {
        let f = fresnel_dielectric(f64::to_radians(theta).cos(), n);
        assert!((f / exact - 1.0).abs() < 1e-10, "Brewster's angle, n = {n}: {f}");
    }
    let inside = [
        (10.0, 0.0400829591551, 1e-11),
        (30.0, 0.0551901672954, 1e-11),
        (40.0, 0.245291204287, 1e-11),
        (41.0, 0.379751265962, 1e-11),
        (41.8, 0.890771921500, 1e-10),
        (41.81, 0.979855365126, 1e-9),
        (41.8103148959, 1.0, 0.0),
        (60.0, 1.0, 0.0),
        (90.0, 1.0, 0.0),
    ];
    for (theta, exact, tolerance) in inside {
        let f = fresnel_dielectric(f64::to_radians(theta).cos(), 1.0 / 1.5);
        assert!((f - exact).abs() <= tolerance, "{theta} degrees from inside: {f}");
    }
    // Through the single-precision interface, within what a rounded direction allows.
    let glass = Dielectric::new(1.5, 1.0);
    for (theta, exact, tolerance) in
        [(10.0, 0.0400829591551, 1e-7), (41.0, 0.379751265962, 1e-5), (41.81, 0.979855365126, 3e-3)]
    {
        let f = f64::from(glass.reflectance(direction(180.0 - theta, 0.0)));
        assert!((f - exact).abs() < tolerance, "{theta} degrees from inside: {f}");
    }
}

#[test]
fn fresnel_is_exact_next_to_the_critical_angle() {
    // (index, bits of an f32 cosine, reflectance from inside), evaluated with 40 digits for the same f64 ratio.
    let neighbours = [
        (1.5, 0x3f3ecfa6, 1.0),
        (1.5, 0x3f3ecfa7, 0.9981330251242137),
        (1.5, 0x3f3ecfa8, 0.996_804_253_786_144_7),
        (1.5, 0x3f3ecfa9, 0.995_885_707_237_247),
        (1.25, 0x3f199999, 1.0),
        (1.25, 0x3f19999a, 0.998_556_308_168_392_7),
        (1.25, 0x3f19999b, 0.997_300_879_379_658_4),
        (2.0, 0x3f5db3d7, 1.0),
        (2.0, 0x3f5db3d8, 0.996_817_007_613_779_3),
        (2.0, 0x3f5db3d9, 0.995_123_325_309_273_2),
    ];
    for (ior, bits, exact) in neighbours {
        let cos = f64::from(f32::from_bits(bits));
        let f = fresnel_dielectric(cos, 1.0 / ior);
        assert!(((1.0 - f) - (1.0 - exact)).abs() <= 1e-6 * (1.0 - exact), "{ior}, {cos}: {f} for {exact}");
        assert_eq!(refracted_cosine(cos, 1.0 / ior).is_none(), exact == 1.0);
    }
}

#[test]
fn fresnel_keeps_its_digits_for_nearly_equal_media() {
    let (up, down, more) = (1.0 + 2.0_f64.powi(-20), 1.0 - 2.0_f64.powi(-20), 1.0 + 2.0_f64.powi(-10));
    let table = [
        (up, 0, 2.2737345860295266e-13),
        (up, 1, 2.273_718_973_635_495e-12),
        (up, 3, 9.025_624_806_436_589e-10),
        (up, 7, 5.917132129899928e-5),
        (up, 12, 0.4948625167759531),
        (up, 20, 0.997_241_673_572_165_9),
        (down, 0, 2.2737389228382165e-13),
        (down, 1, 2.273_754_535_466_754e-12),
        (down, 3, 9.027_845_261_184_272e-10),
        (down, 7, 6.298_846_506_404_976e-5),
        (down, 12, 1.0),
        (down, 20, 1.0),
        (more, 0, 2.3818591887721063e-7),
        (more, 1, 2.3652234535043447e-6),
        (more, 3, 0.000_839_102_957_688_535_3),
        (more, 7, 0.49459993893689384),
        (more, 12, 0.978_129_537_453_591_3),
        (more, 20, 0.999_913_623_736_340_3),
    ];
    for (eta, power, exact) in table {
        let f = fresnel_dielectric(2.0_f64.powi(-power), eta);
        assert!((f / exact - 1.0).abs() < 1e-12, "eta {eta}, cos 2^-{power}: {f:e} for {exact:e}");
    }
}

/// The textbook form, in f64.
fn textbook_fresnel(c: f64, eta: f64) -> f64 {
    let g = (eta * eta - 1.0 + c * c).sqrt();
    let (rs, rp) = ((c - g) / (c + g), (eta * eta * c - g) / (eta * eta * c + g));
    0.5 * (rs * rs + rp * rp)
}

#[test]
fn fresnel_is_a_share_everywhere() {
    let mut rng = Rng::new(11, 0);
    for i in 0..1_000_000_u32 {
        let eta = f64::from(0.2 + 4.0 * rng.next_f32());
        let c = f64::from(match i % 4 {
            0 => 10.0_f32.powf(-38.0 * rng.next_f32()),
            _ => rng.next_f32(),
        });
        let f = fresnel_dielectric(c, eta);
        assert!((0.0..=1.0).contains(&f), "eta {eta}, cos {c}: {f}");
        let reference = textbook_fresnel(c, eta);
        if reference.is_nan() {
            assert_eq!(f, 1.0);
        } else if (eta - 1.0).abs() > 1e-3 {
            assert!((f / reference - 1.0).abs() < 1e-6, "eta {eta}, cos {c}: {f} for {reference}");
        }
        // Both ways through the interface.
        if let Some(cos_t) = refracted_cosine(c, eta).filter(|_| c > 1e-3) {
            let back = fresnel_dielectric(cos_t, 1.0 / eta);
            assert!((back - f).abs() < 1e-9, "eta {eta}, cos {c}: {f} and {back}");
        }
    }
    for (c, eta) in
        [(0.0, 1.5), (0.0, 1.0), (1.0, 1.0), (0.3, 1.0), (0.0, 0.5), (1.0, 1e-3), (1.0, 1e3), (1.0 + 1e-7, 1.5)]
    {
        let f = fresnel_dielectric(c, eta);
        assert!((0.0..=1.0).contains(&f) && f == fresnel_dielectric(-c, eta), "eta {eta}, cos {c}: {f}");
    }
}

#[test]
fn fresnel_averages_to_the_closed_forms() {
    for (n, outside, inside) in [
        (1.333, 0.0664057647831, 0.474590570814),
        (1.5, 0.0917779593424, 0.596345759708),
        (2.417, 0.212187588324, 0.865144234737),
    ] {
        // Midpoints in cos^2, which is the measure of a diffuse field.
        const N: usize = 1_000_000;
        let mean = |eta: f64| {
            let f = |i| fresnel_dielectric(((i as f64 + 0.5) / N as f64).sqrt(), eta);
            (0..N).map(f).sum::<f64>() / N as f64
        };
        assert!((mean(n) - outside).abs() < 1e-7, "{n}: {}", mean(n));
        assert!((mean(1.0 / n) - inside).abs() < 1e-7, "{n}: {}", mean(1.0 / n));
        // And the choice between the branches follows it.
        for (side, exact) in [(1.0_f32, outside), (-1.0, inside)] {
            let bsdf = glass(n as f32);
            let mut rng = Rng::new(12, n.to_bits());
            let draws = 1_000_000;
            let reflected = (0..draws)
                .filter(|_| {
                    let wo = side * warps::cosine_hemisphere(rng.next_2d());
                    bsdf.sample(wo, uniform_3d(&mut rng)).unwrap().wi.z * wo.z > 0.0
                })
                .count();
            let share = reflected as f64 / f64::from(draws);
            let error = (exact * (1.0 - exact) / f64::from(draws)).sqrt();
            assert!(z_test(share, error, exact) > sidak(SIGNIFICANCE, 6), "{n}, side {side}: {share} for {exact}");
        }
    }
}

#[test]
fn refraction_obeys_snell_and_carries_the_radiance_factor() {
    let mut rng = Rng::new(13, 0);
    for (ior, exterior) in [(1.5_f32, 1.0_f32), (1.333, 1.0), (2.417, 1.0), (1.0, 1.5), (1.0, 1.333), (1.000001, 1.0)] {
        let dielectric = Dielectric::new(ior, exterior);
        for _ in 0..100_000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let (n_o, n_i) = if wo.z > 0.0 { (exterior, ior) } else { (ior, exterior) };
            let (reflectance, mirrored, refracted) = dielectric.branches(wo);
            assert_eq!(mirrored, Vec3::new(-wo.x, -wo.y, wo.z));
            assert!((0.0..=1.0).contains(&reflectance));
            let Some((wi, eta)) = refracted else {
                let sin = f64::from(wo.x).hypot(f64::from(wo.y));
                assert!(reflectance == 1.0 && sin * f64::from(n_o) > f64::from(n_i) * (1.0 - 1e-6));
                let sample = dielectric.sample(wo, 1.0_f32.next_down());
                assert_eq!((sample.wi, sample.weight, sample.eta), (mirrored, Rgb::ONE, 1.0));
                continue;
            };
            assert!(wi.z * wo.z <= 0.0 && (wi.length() - 1.0).abs() < 4e-7, "{wo} {wi}");
            let residual =
                f64::from(n_o) * f64::from(wo.truncate().length()) - f64::from(n_i) * f64::from(wi.truncate().length());
            assert!(residual.abs() < 1e-6, "{wo} {wi}: {residual}");
            assert!((eta - n_i / n_o).abs() <= 2e-7 * eta);
            // In the plane of incidence, onwards.
            assert!(wi.x * wo.x <= 0.0 && wi.y * wo.y <= 0.0);

            let reflection = dielectric.sample(wo, 0.0);
            let refraction = dielectric.sample(wo, 1.0_f32.next_down());
            if reflectance > 0.0 {
                assert_eq!((reflection.wi, reflection.weight, reflection.eta), (mirrored, Rgb::ONE, 1.0));
            }
            if reflectance < 1.0_f32.next_down() {
                assert_eq!((refraction.wi, refraction.eta), (wi, eta));
                let factor = f64::from(n_o / n_i).powi(2);
                assert!((f64::from(refraction.weight.x) / factor - 1.0).abs() < 1e-6);
                // Out again the factors cancel, so that a furnace stays at 1.
                let back = dielectric.sample(wi, 1.0_f32.next_down());
                let product = back.weight.x * refraction.weight.x;
                assert!(back.eta == 1.0 || (product - 1.0).abs() < 5e-7, "{wo} {wi} {back:?} {refraction:?}");
            }
        }
    }
    // Seen from inside glass at normal incidence: n^2 (1 - F).
    let dielectric = Dielectric::new(1.5, 1.0);
    let sample = dielectric.sample(-Vec3::Z, 0.5);
    let seen = sample.weight.x * (1.0 - dielectric.reflectance(-Vec3::Z));
    assert!((seen - 2.16).abs() < 1e-6, "{seen}");
    assert_eq!(sample.wi, Vec3::Z);
}

#[test]
fn equal_media_are_invisible() {
    let mut rng = Rng::new(14, 0);
    for (ior, exterior) in [(1.0, 1.0), (1.5, 1.5), (1.333, 1.333)] {
        let bsdf = Bsdf::new(&BsdfDesc::Dielectric { ior, exterior_ior: exterior });
        for _ in 0..10_000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let sample = bsdf.sample(wo, uniform_3d(&mut rng)).unwrap();
            assert_eq!((sample.wi, sample.weight, sample.eta), (-wo, Rgb::ONE, 1.0));
        }
    }
    // And nearly equal ones nearly so, without a jump.
    for offset in [1e-6_f32, -1e-6] {
        let dielectric = Dielectric::new(1.0 + offset, 1.0);
        for _ in 0..10_000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let (reflectance, _, refracted) = dielectric.branches(wo);
            if wo.z.abs() > 0.1 {
                let (wi, _) = refracted.unwrap();
                assert!(reflectance < 1e-7 && (wi + wo).length() < 3e-5, "{wo} {wi} {reflectance}");
            }
        }
    }
}

#[test]
fn directions_that_are_not_numbers_scatter_nothing() {
    let nan = Vec3::splat(f32::NAN);
    for bsdf in diffuse_models().into_iter().chain([mirror(), glass(1.5)]) {
        assert!(bsdf.sample(nan, [0.5; 3]).is_none());
        assert_eq!(bsdf.f_pdf(nan, Vec3::Z), (Rgb::ZERO, 0.0));
        assert!(bsdf.sample(Vec3::X, [0.5; 3]).is_none());
    }
}
