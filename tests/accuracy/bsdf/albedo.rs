//! Energy of the rough diffuse models: directional and mean albedos.

use etendue::bsdf::{Bsdf, Model as _, TransportMode};
use etendue::math::Vec3;
use etendue::sampling::{Rng, Sampler, SobolSampler, warps};

use super::{Worst, direction, oren_nayar, oren_nayar_qualitative, uniform_3d};
use crate::record::{Case, Entry};
use crate::stats::mean_and_error;

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "B29", title: "albedo", run: albedo }]
}

/// Albedo for facets of albedo 1 at five angles of incidence, by quadrature.
type Column = (&'static str, fn(f32) -> Bsdf, f32, [f64; 5]);

const ANGLES: [f64; 5] = [0.0, 30.0, 60.0, 80.0, 89.0];
const DIRECTIONAL: [Column; 6] = [
    ("Fujii", oren_nayar, 0.3, [0.920523795583, 0.924808861500, 0.952103140699, 0.983798074275, 0.998454039543]),
    ("Fujii", oren_nayar, 0.5, [0.874204808855, 0.880987224927, 0.924188697546, 0.974355540020, 0.997553048832]),
    ("Fujii", oren_nayar, 1.0, [0.776522067008, 0.788571178827, 0.865319548261, 0.954442050949, 0.995652937254]),
    (
        "qualitative",
        oren_nayar_qualitative,
        0.3,
        [0.892857142857, 0.920221656848, 0.959936192514, 0.991431190528, 1.00409029412],
    ),
    (
        "qualitative",
        oren_nayar_qualitative,
        0.5,
        [0.784482758621, 0.824724690960, 0.883128419881, 0.929444593430, 0.948060922238],
    ),
    (
        "qualitative",
        oren_nayar_qualitative,
        1.0,
        [0.624060150376, 0.674270267791, 0.747140975434, 0.804929962615, 0.828157675623],
    ),
];
/// Mean albedo of Fujii's model, in closed form.
const MEAN: [(f32, f64); 3] = [(0.3, 0.940541932923), (0.5, 0.905889580813), (1.0, 0.832810763579)];

fn albedo(case: &mut Case) {
    for (place, (name, model, roughness, column)) in DIRECTIONAL.into_iter().enumerate() {
        let bsdf = model(roughness);
        let mut quadrature = Worst::default();
        for (angle, (theta, exact)) in ANGLES.into_iter().zip(column).enumerate() {
            let wo = direction(theta, 13.0);
            quadrature.add(integrated_albedo(case, &bsdf, wo), exact);
            let sampled = sampled_albedo(case, &bsdf, wo, (place * ANGLES.len() + angle) as u32);
            case.mean(format!("{name} {roughness} at {theta}°: mean weight"), sampled, exact, 1e-3);
        }
        quadrature.row(case, format!("{name} {roughness}: integral of f cos, worst"), 1e-3);
    }
    for (roughness, exact) in MEAN {
        let bsdf = oren_nayar(roughness);
        let mut rng = Rng::new(29, 0);
        let weights: Vec<f64> = (0..case.count(300_000, 4_000_000))
            .map(|_| {
                let wo = warps::cosine_hemisphere(rng.next_2d());
                bsdf.sample(wo, uniform_3d(&mut rng), TransportMode::Radiance)
                    .map_or(0.0, |sample| f64::from(sample.weight.r()))
            })
            .collect();
        case.mean(format!("Fujii {roughness}: mean over all directions"), mean_and_error(&weights), exact, 1e-3);
    }
}

/// Mean weight of samples and its standard error from independent replicates.
fn sampled_albedo(case: &Case, bsdf: &Bsdf, wo: Vec3, pixel: u32) -> (f64, f64) {
    const REPLICATES: u32 = 32;
    let size = case.count(4096, 65_536) as u32;
    let mut sampler = SobolSampler::new(29, size);
    let mut weight = |i| {
        sampler.start(pixel, i);
        let [a, b, c, _] = sampler.next_4d();
        bsdf.sample(wo, [a, b, c], TransportMode::Radiance).map_or(0.0, |sample| f64::from(sample.weight.r()))
    };
    let mut replicate = |r: u32| (r * size..(r + 1) * size).map(&mut weight).sum::<f64>() / f64::from(size);
    mean_and_error(&(0..REPLICATES).map(&mut replicate).collect::<Vec<_>>())
}

/// The same without the sampler: the integral of f cos over the hemisphere, midpoints in root of cosine and azimuth.
fn integrated_albedo(case: &Case, bsdf: &Bsdf, wo: Vec3) -> f64 {
    let n = case.count(300, 1200) as usize;
    let mut sum = 0.0;
    for i in 0..n {
        // cos = t^2 puts more points at grazing, where f is steep.
        let t = (i as f64 + 0.5) / n as f64;
        let (cos, jacobian) = (t * t, 2.0 * t);
        let sin = (1.0 - cos * cos).sqrt();
        for j in 0..n {
            let (s, c) = (std::f64::consts::TAU * (j as f64 + 0.5) / n as f64).sin_cos();
            let wi = Vec3::new((sin * c) as f32, (sin * s) as f32, cos as f32);
            sum += f64::from(bsdf.f(wo, wi, TransportMode::Radiance).r()) * cos * jacobian;
        }
    }
    sum * std::f64::consts::TAU / (n * n) as f64
}
