//! Films against closed forms and against the method of characteristic matrices.

use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock};

use super::complex::Complex;
use super::{FilmRange, FilmedInterface, FilmedMetal, Stack, complex_index_at};
use crate::bsdf::{Index, MetalFacet, fresnel_conductor, fresnel_dielectric};
use crate::desc::{Dispersion, METALS, ThinFilmDesc};
use crate::math::{DVec3, Vec3};
use crate::spectrum::{Illuminant, REC_709_FROM_XYZ, Rgb, SampledSpectrum, Spectrum, color_matching};

/// Cosines from grazing to normal incidence.
fn cosines() -> impl Iterator<Item = f64> {
    (0..=40).map(|i| (f64::from(i) / 40.0).powi(2)).chain([1e-9, 1e-6, 1e-3])
}

fn exponential(z: Complex) -> Complex {
    Complex::new(z.im.cos(), z.im.sin()) * z.re.exp()
}

/// Reflectance and transmittance of a film by its characteristic matrix. Source: Born and Wolf, *Principles of Optics*, Sec. 1.6.2,
/// Eq. 41, 46 to 48 and 51, with an absorbing last medium as in Sec. 14.4.
fn by_matrix(cos: f64, front: f64, [film, thickness]: [f64; 2], behind: Complex, nanometres: f64) -> [f64; 2] {
    let sin2 = Complex::real(front * front * (1.0 - cos * cos));
    let normal = |n: Complex| (n * n - sin2).upper_root();
    let (n0, n1) = (Complex::real(front), Complex::real(film));
    let (q0, q1, q2) = (Complex::real(front * cos), normal(n1), normal(behind));
    let i = Complex::new(0.0, 1.0);
    let beta = q1 * (TAU * thickness / nanometres);
    let (up, down) = (exponential(i * beta), exponential(Complex::real(0.0) - i * beta));
    let cosine = (up + down) * 0.5;
    let sine = (up - down) * 0.5 / i;
    let mut of = [0.0; 2];
    for parallel in [false, true] {
        let p = |q: Complex, n: Complex| if parallel { q / (n * n) } else { q };
        let (p0, p1, p2) = (p(q0, n0), p(q1, n1), p(q2, behind));
        let minus_i = Complex::new(0.0, -1.0);
        let (m11, m12, m21, m22) = (cosine, minus_i * sine / p1, minus_i * p1 * sine, cosine);
        let (a, b) = ((m11 + m12 * p2) * p0, m21 + m22 * p2);
        let transmitted = p0 * 2.0 / (a + b);
        of[0] += 0.5 * ((a - b) / (a + b)).norm2();
        of[1] += 0.5 * p2.re / p0.re * transmitted.norm2();
    }
    of
}

/// Indices in front, of the film and behind; thickness and wavelength \[nm\]: soap, oil on water, coats of lenses, films that are
/// thinner than both media (frustrated total reflection), light from glass.
const DIELECTRICS: [([f64; 3], f64, f64); 8] = [
    ([1.0, 1.33, 1.0], 300.0, 550.0),
    ([1.0, 1.47, 1.33], 420.0, 480.0),
    ([1.0, 1.38, 1.52], 99.6, 550.0),
    ([1.0, 2.4, 1.5], 1200.0, 640.0),
    ([1.5, 1.0, 1.5], 200.0, 550.0),
    ([1.6, 1.2, 1.4], 90.0, 450.0),
    ([1.5, 1.33, 1.0], 380.0, 600.0),
    ([1.52, 1.9, 1.0], 150.0, 700.0),
];

#[test]
fn without_thickness_or_contrast_a_film_is_not_there() {
    for ([front, film, behind], thickness, nanometres) in DIELECTRICS {
        for cos in cosines() {
            let expected = fresnel_dielectric(cos, behind / front);
            for (film, thickness) in [(film, 0.0), (front, thickness), (behind, thickness)] {
                let stack = Stack::new(front, [film, thickness], Complex::real(behind), nanometres);
                let found = stack.reflectance(cos);
                // A few roundings; they grow where angles crowd at the critical one, where the reflectance has a vertical tangent.
                let critical = 1.0 - (behind / front).powi(2);
                let steep = (1e-15 / (cos * cos - critical).abs()).sqrt();
                assert!(
                    (found - expected).abs() < 1e-13 + 4.0 * steep,
                    "{front} {film} {behind} {cos}: {found} {expected}"
                );
            }
        }
    }
    for (n, k) in [(0.2_f32, 3.4_f32), (1.1, 6.8), (2.7, 0.1)] {
        for cos in cosines() {
            let stack = Stack::new(1.0, [1.7, 0.0], Complex::new(n.into(), k.into()), 500.0);
            let expected = fresnel_conductor(cos as f32, n, k);
            // That of metals is worked out in single precision.
            assert!((stack.reflectance(cos) as f32 - expected).abs() < 1e-5, "{n} {k} {cos}");
        }
    }
}

#[test]
fn quarters_and_halves_of_a_wave() {
    let nanometres = 550.0;
    for behind in [1.33, 1.5, 1.9, 4.0] {
        // Of the root of the index, a quarter of a wave reflects nothing.
        let film = f64::sqrt(behind);
        let of = |film: f64, thickness: f64| {
            Stack::new(1.0, [film, thickness], Complex::real(behind), nanometres).reflectance(1.0)
        };
        let quarter = nanometres / (4.0 * film);
        assert!(of(film, quarter) < 1e-30, "{}", of(film, quarter));
        // Two hundredths more of either are seen.
        assert!(of(film, 1.02 * quarter) > 1e-6 && of(1.02 * film, quarter) > 1e-6);
        for film in [1.2, 1.38, 2.3] {
            let quarter = nanometres / (4.0 * film);
            let expected = ((behind - film * film) / (behind + film * film)).powi(2);
            assert!((of(film, quarter) - expected).abs() < 1e-14);
            assert!((of(film, 3.0 * quarter) - expected).abs() < 1e-14);
            assert!((of(film, 1.02 * quarter) - expected).abs() > 1e-7, "{film} {behind}");
            // A half is absent.
            assert!((of(film, 2.0 * quarter) - fresnel_dielectric(1.0, behind)).abs() < 1e-14);
        }
    }
}

#[test]
fn films_reflect_and_transmit_what_their_matrices_say() {
    for ([front, film, behind], thickness, nanometres) in DIELECTRICS {
        let mut seen = [0.0_f64; 2];
        for cos in cosines().filter(|cos| *cos > 0.0) {
            let of = |film: [f64; 2]| Stack::new(front, film, Complex::real(behind), nanometres).reflectance(cos);
            let found = of([film, thickness]);
            let [reflected, transmitted] = by_matrix(cos, front, [film, thickness], Complex::real(behind), nanometres);
            // Hyperbolic functions of the matrix cost it a few digits, and grazing angles the sine.
            assert!(
                (found - reflected).abs() < 1e-11 / cos.min(0.1),
                "{front} {film} {behind} {cos}: {found} {reflected}"
            );
            assert!((1.0 - found - transmitted).abs() < 1e-10 / cos.min(0.1), "{front} {film} {behind} {cos}");
            seen[0] = seen[0].max((of([film, 1.02 * thickness]) - reflected).abs());
            seen[1] = seen[1].max((of([1.02 * film, thickness]) - reflected).abs());
            // From the other side, at the angle to which light is refracted.
            let ratio = behind / front;
            let cos2 = ((ratio - 1.0) * (ratio + 1.0) + cos * cos) / (ratio * ratio);
            if cos2 > 0.0 {
                let back = Stack::new(behind, [film, thickness], Complex::real(front), nanometres);
                let back = back.reflectance(cos2.sqrt());
                // The cosine on the other side has lost digits towards the critical angle.
                assert!((back - found).abs() < 1e-14 / cos2.min(cos * cos), "{front} {film} {behind} {cos}");
            } else {
                assert_eq!(found, 1.0);
            }
        }
        // Two hundredths of the thickness or of the index are far more than the tolerance.
        assert!(seen[0].min(seen[1]) > 1e-4, "{front} {film} {behind}: {seen:?}");
    }
    for behind in [Complex::new(0.2, 3.4), Complex::new(1.1, 6.8), Complex::new(3.1, 3.3), Complex::new(0.7, 0.0)] {
        for (film, thickness) in [(1.5, 120.0), (2.4, 45.0), (0.6, 80.0), (1.8, 900.0)] {
            for cos in cosines().filter(|cos| *cos > 0.0) {
                let found = Stack::new(1.0, [film, thickness], behind, 520.0).reflectance(cos);
                let [reflected, _] = by_matrix(cos, 1.0, [film, thickness], behind, 520.0);
                assert!(
                    (found - reflected).abs() < 1e-11 / cos.min(0.1),
                    "{behind:?} {film} {cos}: {found} {reflected}"
                );
            }
        }
    }
}

#[test]
fn all_films_reflect_between_nothing_and_everything() {
    let indices = [1e-30, 0.3, 1.0, 1.5, 100.0, 1e30];
    for front in indices {
        for film in [1e-30, 0.3, 1.0, 1.5, 100.0] {
            for behind in indices.into_iter().flat_map(|n| [0.0, 1e-3, 1e6, f64::INFINITY].map(|k| Complex::new(n, k)))
            {
                for thickness in [0.0, 1e-30, 500.0, 1e4] {
                    for cos in [0.0, 1e-30, 1e-3, 0.7, 1.0, 1.1, -0.5, f64::NAN] {
                        let found = Stack::new(front, [film, thickness], behind, 360.0).reflectance(cos);
                        assert!((0.0..=1.0).contains(&found), "{front} {film} {behind:?} {thickness} {cos}: {found}");
                        assert!(cos != 0.0 || found == 1.0);
                    }
                }
            }
        }
    }
    // At the critical angle of the film itself, where both its faces reflect everything.
    for (film, behind) in [(1.2_f64, 1.7), (1.2, 1.5)] {
        let cos = (1.0 - (film / 1.5).powi(2)).sqrt();
        let at = |cos: f64| Stack::new(1.5, [film, 300.0], Complex::real(behind), 500.0).reflectance(cos);
        assert!((at(cos) - at(cos + 1e-7)).abs() < 1e-5 && (at(cos) - at(cos - 1e-7)).abs() < 1e-5);
    }
}

/// The mean over the spectrum of D65 by 0.1 nm.
fn mean(reflectance: impl Fn(f64) -> f64) -> DVec3 {
    static NODES: LazyLock<Vec<(f64, DVec3)>> = LazyLock::new(|| {
        let seen = |nanometres: f64| *REC_709_FROM_XYZ * color_matching(nanometres) * Illuminant::D65.power(nanometres);
        let nodes = (0..=4700).map(|i| 360.0 + 0.1 * f64::from(i)).map(|nanometres| (nanometres, seen(nanometres)));
        let nodes: Vec<(f64, DVec3)> = nodes.collect();
        let sum: DVec3 = nodes.iter().map(|(_, weight)| *weight).sum();
        nodes.into_iter().map(|(nanometres, weight)| (nanometres, weight / sum)).collect()
    });
    let mean: DVec3 = NODES.iter().map(|(nanometres, weight)| *weight * reflectance(*nanometres)).sum();
    mean.clamp(DVec3::ZERO, DVec3::ONE)
}

fn plain(ior: f32) -> Index {
    Index { ior, dispersion: None }
}

#[test]
fn tables_have_the_mean_over_the_spectrum() {
    for ([front, film, behind], _, _) in DIELECTRICS {
        for thickness in [90.0, 350.0, 1000.0, 4000.0] {
            let desc = ThinFilmDesc { thickness, ior: film as f32 };
            let interface = FilmedInterface::new(plain(behind as f32), plain(front as f32), desc);
            let stack = |film: f64, nanometres: f64| {
                Stack::new(
                    f64::from(front as f32),
                    [film, thickness.into()],
                    Complex::real(f64::from(behind as f32)),
                    nanometres,
                )
            };
            let mut seen = 0.0_f64;
            for i in 0..=40 {
                // Between the cosines of the table.
                let cos = (f64::from(i) + 0.37) / 40.8;
                let expected = mean(|nanometres| stack(f64::from(desc.ior), nanometres).reflectance(cos));
                let found: Rgb = interface.reflectance(cos as f32, true, &());
                let error = (found.to_f64() - expected).abs().max_element();
                // Next to the critical angle of the film itself, fringes are narrower than a step of the table.
                let squared = (film / front - 1.0) * (film / front + 1.0) + cos * cos;
                let is_narrow = film < front.min(behind) && squared.abs() < 0.1;
                assert!(
                    error < if is_narrow { 1e-2 } else { 5e-4 },
                    "{front} {film} {behind} {thickness} {cos}: {error}"
                );
                let other = mean(|nanometres| stack(1.02 * f64::from(desc.ior), nanometres).reflectance(cos));
                seen = seen.max((found.to_f64() - other).abs().max_element());
            }
            assert!(seen > 2e-3, "{front} {film} {behind} {thickness}: {seen}");
        }
    }
    let mut worst = 0.0_f64;
    for metal in METALS.iter() {
        let index = [0, 1, 2].map(|channel| metal.conductor().index(channel).unwrap());
        let (eta, k) = (Vec3::from(index.map(|[n, _]| n)), Vec3::from(index.map(|[_, k]| k)));
        for (thickness, ior) in [(60.0, 2.4), (300.0, 1.5), (2000.0, 1.77)] {
            let filmed = FilmedMetal::new(eta, k, ThinFilmDesc { thickness, ior });
            for i in 0..=20 {
                let cos = (f64::from(i) + 0.37) / 20.8;
                let expected = mean(|nanometres| {
                    let metal = complex_index_at(eta, k, nanometres);
                    by_matrix(cos, 1.0, [ior.into(), thickness.into()], metal, nanometres)[0]
                });
                let found: Rgb = filmed.reflectance(cos as f32, &());
                worst = worst.max((found.to_f64() - expected).abs().max_element());
            }
        }
    }
    assert!(worst < 5e-4, "{worst}");
}

/// Films whose thickness varies reflect at each thickness what one of that thickness does.
#[test]
fn ranges_have_the_reflectance_of_each_thickness() {
    let mut worst = 0.0_f64;
    // The last ones are gaps of air, which reflect everything beyond their critical angle.
    let films = [
        ([1.0, 1.33, 1.0], [0.0, 900.0]),
        ([1.0, 1.47, 1.33], [200.0, 700.0]),
        ([1.0, 2.4, 1.5], [40.0, 2700.0]),
        ([1.5, 1.0, 1.5001], [0.0, 2000.0]),
        ([1.4, 1.2, 1.6], [100.0, 600.0]),
    ];
    for ([front, film, behind], range) in films {
        let films = FilmRange { ior: film, thickness: range };
        let all = FilmedInterface::new(plain(behind), plain(front), films);
        let mut seen = 0.0_f64;
        for part in [0.0_f32, 0.013, 0.21, 0.5, 0.77, 0.995, 1.0] {
            let thickness = range[0] + part * (range[1] - range[0]);
            let found = all.with_thickness(thickness);
            let exact = |factor: f64, cos: f64| {
                let film = [f64::from(film), factor * f64::from(thickness)];
                let stack = |nm: f64| Stack::new(front.into(), film, Complex::real(behind.into()), nm);
                mean(|nanometres| stack(nanometres).reflectance(cos))
            };
            for i in 10..=60 {
                let cos = i as f32 / 60.0;
                let found: Rgb = found.reflectance(cos, true, &());
                let expected = exact(1.0, cos.into());
                let off = (found.to_f64() - expected).abs().max_element();
                worst = worst.max(off);
                seen = seen.max((exact(1.02, cos.into()) - expected).abs().max_element());
            }
        }
        assert!(seen > 4e-3, "{seen}");
        assert_eq!(all.with_thickness(1e9), all.with_thickness(range[1]));
    }
    assert!(worst < 2e-3, "{worst}");
    let aluminium = METALS.iter().find(|metal| metal.symbol == "Al").unwrap().conductor();
    let index = [0, 1, 2].map(|channel| aluminium.index(channel).unwrap());
    let (eta, k) = (Vec3::from(index.map(|[n, _]| n)), Vec3::from(index.map(|[_, k]| k)));
    let all = FilmedMetal::new(eta, k, FilmRange { ior: 1.8, thickness: [5.0, 400.0] });
    let mut worst = 0.0_f64;
    for thickness in [5.0, 31.0, 120.0, 250.0, 399.0] {
        let one = FilmedMetal::new(eta, k, ThinFilmDesc { thickness, ior: 1.8 });
        let found = all.with_thickness(thickness);
        for i in 10..=60 {
            let cos = i as f32 / 60.0;
            worst = worst.max((found.observed(cos) - one.observed(cos)).to_f64().abs().max_element());
        }
        let mean = MetalFacet::Filmed(Arc::new(one)).mean_reflectance();
        worst = worst.max((found.mean().unwrap() - mean).to_f64().abs().max_element());
    }
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn both_sides_of_a_film_reflect_alike() {
    let film = ThinFilmDesc { thickness: 420.0, ior: 1.9 };
    let interface = FilmedInterface::new(plain(1.5), plain(1.2), film);
    let wavelengths = SampledSpectrum::sample_wavelengths(|| 0.3);
    for i in 1..100 {
        // Cosine on the inner side, beyond and below the critical angle.
        let inside = i as f32 / 100.0;
        let radicand = 1.0 - (1.5_f64 / f64::from(1.2_f32)).powi(2) * (1.0 - f64::from(inside).powi(2));
        let back: Rgb = interface.reflectance(inside, false, &());
        let spectral: SampledSpectrum = interface.reflectance(inside, false, &wavelengths);
        if radicand <= 0.0 {
            assert_eq!((back, spectral), (Rgb::ONE, SampledSpectrum::ONE));
            continue;
        }
        let front: Rgb = interface.reflectance(radicand.sqrt() as f32, true, &());
        assert!((back.to_f64() - front.to_f64()).abs().max_element() < 1e-5, "{inside}");
        let front: SampledSpectrum = interface.reflectance(radicand.sqrt() as f32, true, &wavelengths);
        let off = (spectral - front).map(f32::abs).max_element();
        assert!(off < 1e-5, "{inside}: {off}");
    }
}

/// Each wavelength has its own index in the body, and all weights are bounded.
#[test]
fn wavelengths_have_their_own_shares() {
    let film = ThinFilmDesc { thickness: 250.0, ior: 1.38 };
    for dispersion in [None, Some(Dispersion::Abbe(20.0))] {
        let inner = Index { ior: 1.7, dispersion };
        let interface = FilmedInterface::new(inner, plain(1.0), film);
        assert_eq!(interface.disperses(), dispersion.is_some());
        for u in [0.1, 0.6] {
            let wavelengths = SampledSpectrum::sample_wavelengths(|| u);
            for (cos, front) in [(1.0_f32, true), (0.4, true), (0.02, true), (0.95, false), (0.82, false), (0.3, false)]
            {
                let shares = interface.shares::<SampledSpectrum>(cos, front, &wavelengths);
                let expected = wavelengths.nanometres.to_array().map(|nanometres| {
                    let n = inner.at(Some(nanometres));
                    let (here, beyond) = if front { (1.0, n) } else { (n, 1.0) };
                    let film = [film.ior, film.thickness].map(f64::from);
                    Stack::new(here, film, Complex::real(beyond), nanometres.into()).reflectance(cos.into())
                });
                for (i, (found, expected)) in shares.reflected.to_array().into_iter().zip(expected).enumerate() {
                    assert!((f64::from(found) - expected).abs() < 1e-6);
                    let passes = if dispersion.is_some() {
                        1.0 - f64::from(shares.reflected.to_array()[0])
                    } else {
                        1.0 - expected
                    };
                    assert!((f64::from(shares.transmitted.to_array()[i]) - passes).abs() < 1e-6);
                }
                for weight in [shares.reflected_weight(), shares.transmitted_weight()] {
                    assert!(weight.max_element() <= 2.0 + 1e-5, "{cos}: {weight:?}");
                }
            }
        }
    }
}

#[test]
fn the_index_of_a_metal_is_linear_between_its_channels() {
    let (eta, k) = (Vec3::new(1.0, 2.0, 4.0), Vec3::new(3.0, 5.0, f32::INFINITY));
    for (nanometres, n, k_expected) in [
        (700.0, 1.0, 3.0),
        (650.0, 1.0, 3.0),
        (600.0, 1.5, 4.0),
        (550.0, 2.0, 5.0),
        (500.0, 3.0, f64::INFINITY),
        (450.0, 4.0, f64::INFINITY),
        (400.0, 4.0, f64::INFINITY),
    ] {
        assert_eq!(complex_index_at(eta, k, nanometres), Complex::new(n, k_expected), "{nanometres}");
    }
    // Perfect reflectors stay perfect.
    let perfect = FilmedMetal::new(Vec3::ONE, Vec3::INFINITY, ThinFilmDesc { thickness: 300.0, ior: 1.5 });
    assert_eq!(perfect.observed(0.3), Rgb::ONE);
}
