//! Fresnel's law for a smooth dielectric, and the choice that follows it.

use etendue::bsdf::{Bsdf, Dielectric, Model as _, TransportMode, fresnel_dielectric, refracted_cosine};
use etendue::desc::BsdfDesc;
use etendue::math::Vec3;
use etendue::sampling::{Rng, warps};

use super::{Worst, direction, uniform_3d};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "B32", title: "Fresnel from outside", run: outside },
        Entry { id: "B32b", title: "Fresnel, extreme indices", run: extreme_indices },
        Entry { id: "B32c", title: "Fresnel, a million pairs", run: everywhere },
        Entry { id: "B33", title: "Fresnel from inside", run: inside },
        Entry { id: "B33b", title: "critical angle ± 1 ulp", run: critical_neighbours },
        Entry { id: "B34", title: "hemispherical Fresnel", run: hemispherical },
    ]
}

const INDICES: [f64; 3] = [1.333, 1.5, 2.417];

const OUTSIDE: [(f64, [f64; 3]); 8] = [
    (0.0, [0.0203731878420, 0.0400000000000, 0.171968832523]),
    (30.0, [0.0214364658634, 0.0415226259758, 0.173460213595]),
    (45.0, [0.0278983645984, 0.0502399110122, 0.181116156648]),
    (60.0, [0.0596909191752, 0.0891867128022, 0.211261437900]),
    (75.0, [0.212377582677, 0.253060562990, 0.330500003127]),
    (85.0, [0.583523478697, 0.612799645265, 0.621708605457]),
    (89.0, [0.896276403745, 0.904184949780, 0.899745971067]),
    (89.9, [0.989067615480, 0.989911876919, 0.989234157905]),
];
/// Brewster's angle, where p-polarised light is not reflected, and F there.
const BREWSTER: [(f64, f64); 3] =
    [(53.1232257604, 0.0391355019711), (56.3099324740, 0.0739644970414), (67.5233573527, 0.250407662529)];

fn outside(case: &mut Case) {
    for (column, n) in INDICES.into_iter().enumerate() {
        let (mut exact, mut rounded) = (Worst::default(), Worst::default());
        let glass = Dielectric::new(n as f32, 1.0);
        for (theta, row) in OUTSIDE {
            exact.add(fresnel_dielectric(theta.to_radians().cos(), n), row[column]);
            rounded.add(f64::from(glass.reflectance(direction(theta, 40.0))), row[column]);
        }
        exact.row(case, format!("1 to {n}, worst of 8 angles"), 1e-11);
        rounded.row(case, format!("1 to {n}, direction in single precision"), 1e-6);
        let (theta, there) = BREWSTER[column];
        let found = fresnel_dielectric(theta.to_radians().cos(), n);
        case.exact(format!("1 to {n}, Brewster's angle"), found, there, Within::Relative(1e-10));
    }
}

/// Cosines that single precision holds exactly, for the table below.
const COSINES: [f32; 10] = [
    1.0_f32.next_down(),
    0.9375,
    0.75,
    0.5,
    0.25,
    1.0 / 16.0,
    1.0 / 256.0,
    1.0 / 4096.0,
    1.0 / 262_144.0,
    1.0 / 16_777_216.0,
];

/// F at [`COSINES`] from outside and from inside, from 40 digits for the index as single precision holds it.
#[rustfmt::skip]
const EXTREME: [(f32, [f64; 10], [f64; 10]); 8] = [
    (1.000_000_1,
     [3.5527132552841157e-15, 3.620153383919693e-15, 5.701884560505938e-15, 3.5527102059683177e-14, 8.029101463861189e-13,
      2.3100463284351041e-10, 1.5023126767747294e-05, 0.14589800263784775, 0.9692335398707331, 0.999511837897467],
     [3.5527132552841157e-15, 3.6201534205083124e-15, 5.701886382381691e-15, 3.5527163046044474e-14, 8.029162450222487e-13,
      2.3103283293705277e-10, 1.5500036612674698e-05, 1.0, 1.0, 1.0]),
    (0.999_999_9,
     [3.552714102317063e-15, 3.6201542836202526e-15, 5.701887741817611e-15, 3.552717151638485e-14, 8.029164364527853e-13,
      2.3103288802126013e-10, 1.5500040337385715e-05, 1.0, 1.0, 1.0],
     [3.552714102317063e-15, 3.62015424703162e-15, 5.701885919941206e-15, 3.5527110530001744e-14, 8.029103378144745e-13,
      2.3100468791763263e-10, 1.5023130321881206e-05, 0.14589801819408083, 0.9692335416760162, 0.9995118379265566]),
    (1.001,
     [2.4977351792760965e-07, 2.5450412463737984e-07, 4.0033533356945004e-07, 2.4798734753703124e-06, 5.469932865727402e-05,
      0.0105153324566284, 0.70525311576045, 0.978384665077135, 0.9996586133410522, 0.9999946649369642],
     [2.4977351792760965e-07, 2.545256934254897e-07, 4.014093238553449e-07, 2.5158259761788463e-06, 5.829708056710714e-05,
      0.03119076991856641, 1.0, 1.0, 1.0, 1.0]),
    (1.333,
     [0.02037318203983339, 0.020569845151994174, 0.025282644332513263, 0.05969090876415683, 0.22334229226561994,
      0.6782423154891045, 0.9757101748130667, 0.9984629465077195, 0.9999759639279096, 0.9999996244315827],
     [0.020373182039833727, 0.02110959313013406, 0.06820715262559908, 1.0, 1.0,
      1.0, 1.0, 1.0, 1.0, 1.0]),
    (1.5,
     [0.04000000000000023, 0.0402871701479452, 0.046780747425307426, 0.08918671280221278, 0.26419037343407115,
      0.7016149235619307, 0.977582950874545, 0.9985817765029936, 0.9999778224840655, 0.9999996534719714],
     [0.040000000000001174, 0.04188400953345951, 0.5, 1.0, 1.0,
      1.0, 1.0, 1.0, 1.0, 1.0]),
    (2.417,
     [0.171968840381358, 0.1722617834930704, 0.1781784792686917, 0.21126144409970385, 0.3387580765333794,
      0.7022542515247386, 0.9761444684908952, 0.9984834942612169, 0.9999762780188088, 0.9999996293375487],
     [0.17196884038136612, 0.20242711004670638, 1.0, 1.0, 1.0,
      1.0, 1.0, 1.0, 1.0, 1.0]),
    (1000.0,
     [0.99600798801598, 0.9959997212091838, 0.9958426779718322, 0.9950169524919835, 0.9915638714004863,
      0.9688749685143759, 0.6754355065311948, 0.6845489995251598, 0.9924284703623939, 0.9998808047412336],
     [0.9959999933683534, 1.0, 1.0, 1.0, 1.0,
      1.0, 1.0, 1.0, 1.0, 1.0]),
    (0.001,
     [0.9959999931803653, 1.0, 1.0, 1.0, 1.0,
      1.0, 1.0, 1.0, 1.0, 1.0],
     [0.9960079878267485, 0.9959997210195627, 0.9958426777748131, 0.9950169522561044, 0.9915638710028075,
      0.968874967082394, 0.6754354973992878, 0.6845490086278846, 0.9924284707192879, 0.9998808047468944]),
];

fn extreme_indices(case: &mut Case) {
    let mut rng = Rng::new(32, 0);
    for (n, outside, inside) in EXTREME {
        let glass = Bsdf::new(&BsdfDesc::Dielectric { ior: n, exterior_ior: 1.0 });
        let (mut exact, mut chosen, mut not_total) = (Worst::default(), Worst::default(), 0);
        for (side, eta, row) in [(1.0, f64::from(n), outside), (-1.0, 1.0 / f64::from(n), inside)] {
            for (cos, f) in COSINES.into_iter().zip(row) {
                let found = fresnel_dielectric(f64::from(cos), eta);
                exact.add(found, f);
                if f == 1.0 {
                    not_total += u64::from(found != 1.0 || refracted_cosine(f64::from(cos), eta).is_some());
                } else {
                    // Near total reflection what passes counts as well.
                    exact.add(1.0 - found, 1.0 - f);
                }
                let azimuth = std::f32::consts::TAU * rng.next_f32();
                let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                let wo = Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), side * cos);
                chosen.add(reflected_share(&glass, wo), f);
            }
        }
        exact.row(case, format!("index {n}: F and 1 - F, worst of 20 cosines"), 1e-6);
        chosen.row(case, format!("index {n}: share that samples reflect, worst"), 1e-6);
        case.never(format!("index {n}: F below 1 beyond the critical angle"), not_total, 20);
    }
}

/// The share of the numbers in [0, 1) with which a sample is reflected, by bisection over single precision.
fn reflected_share(bsdf: &Bsdf, wo: Vec3) -> f64 {
    let is_reflected =
        |u: f32| bsdf.sample(wo, [0.5, 0.5, u], TransportMode::Radiance).is_some_and(|sample| sample.wi.z * wo.z > 0.0);
    if is_reflected(1.0_f32.next_down()) {
        return 1.0;
    }
    // Positive numbers are in the order of their bits.
    let (mut low, mut high) = (0_u32, 1.0_f32.to_bits() - 1);
    if !is_reflected(0.0) {
        return 0.0;
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        *(if is_reflected(f32::from_bits(middle)) { &mut low } else { &mut high }) = middle;
    }
    f64::from(f32::from_bits(high))
}

/// The textbook form in double precision: exact enough where the indices differ.
fn textbook_fresnel(c: f64, eta: f64) -> f64 {
    let g = (eta * eta - 1.0 + c * c).sqrt();
    let (rs, rp) = ((c - g) / (c + g), (eta * eta * c - g) / (eta * eta * c + g));
    0.5 * (rs * rs + rp * rp)
}

fn everywhere(case: &mut Case) {
    let tries = case.count(100_000, 10_000_000);
    let mut rng = Rng::new(32, 1);
    let (mut worst, mut both_ways, mut bad) = (Worst::default(), 0.0_f64, 0);
    for i in 0..tries {
        let eta = f64::from(0.2 + 4.0 * rng.next_f32());
        let c = f64::from(if i % 4 == 0 { 10.0_f32.powf(-38.0 * rng.next_f32()) } else { rng.next_f32() });
        let f = fresnel_dielectric(c, eta);
        let reference = textbook_fresnel(c, eta);
        bad += u64::from(!(0.0..=1.0).contains(&f) || f != fresnel_dielectric(-c, eta));
        if reference.is_nan() {
            bad += u64::from(f != 1.0);
        } else if (eta - 1.0).abs() > 1e-3 {
            worst.add(f, reference);
        }
        // Both ways through the interface.
        if let Some(cos_t) = refracted_cosine(c, eta).filter(|_| c > 1e-3) {
            both_ways = both_ways.max((fresnel_dielectric(cos_t, 1.0 / eta) - f).abs());
        }
    }
    worst.row(case, "index 0.2 to 4.2, any cosine down to 1e-38: worst", 1e-6);
    case.at_most("F one way less F the other way", both_ways, 1e-9);
    for (c, eta) in
        [(0.0, 1.5), (0.0, 1.0), (1.0, 1.0), (0.3, 1.0), (0.0, 0.5), (1.0, 1e-3), (1.0, 1e3), (1.0 + 1e-7, 1.5)]
    {
        let f = fresnel_dielectric(c, eta);
        bad += u64::from(!(0.0..=1.0).contains(&f) || f != fresnel_dielectric(-c, eta));
    }
    case.never("outside [0, 1], odd in the cosine, or not total", bad, tries + 8);
}

/// From inside glass of index 1.5, in degrees.
const INSIDE: [(f64, f64, f64, f64); 6] = [
    (10.0, 0.0400829591551, 1e-11, 1e-7),
    (30.0, 0.0551901672954, 1e-11, 1e-6),
    (40.0, 0.245291204287, 1e-11, 1e-5),
    (41.0, 0.379751265962, 1e-11, 1e-5),
    (41.8, 0.890771921500, 1e-10, 3e-3),
    (41.81, 0.979855365126, 1e-9, 3e-3),
];

fn inside(case: &mut Case) {
    let glass = Dielectric::new(1.5, 1.0);
    for (theta, exact, tolerance, rounded_tolerance) in INSIDE {
        let found = fresnel_dielectric(theta.to_radians().cos(), 1.0 / 1.5);
        case.exact(format!("{theta}°"), found, exact, Within::Absolute(tolerance));
        let rounded = f64::from(glass.reflectance(direction(180.0 - theta, 0.0)));
        case.exact(format!("{theta}°, single precision"), rounded, exact, Within::Absolute(rounded_tolerance));
    }
    for (n, critical) in INDICES.into_iter().zip([48.6066263917_f64, 41.8103148958, 24.4397438655]) {
        let (mut total, mut partial) = (0, 0);
        for i in 0..1000 {
            let step = 1e-9 + f64::from(i) * 1e-2;
            let f = |theta: f64| fresnel_dielectric(theta.min(90.0).to_radians().cos(), 1.0 / n);
            total += u64::from(f(critical + step) != 1.0);
            partial += u64::from(f((critical - step).max(0.0)) >= 1.0);
        }
        case.never(format!("index {n}: F not 1 beyond the critical angle"), total, 1000);
        case.never(format!("index {n}: F not below 1 before it"), partial, 1000);
    }
}

/// (index, bits of a cosine in single precision, F from inside), from 40 digits for the same ratio in double precision.
const NEIGHBOURS: [(f32, u32, f64); 10] = [
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

fn critical_neighbours(case: &mut Case) {
    let (mut exact, mut chosen, mut bad) = (Worst::default(), Worst::default(), 0);
    for (ior, bits, f) in NEIGHBOURS {
        let cos = f32::from_bits(bits);
        let eta = 1.0 / f64::from(ior);
        let found = fresnel_dielectric(f64::from(cos), eta);
        if f < 1.0 {
            exact.add(1.0 - found, 1.0 - f);
        }
        bad += u64::from((found == 1.0) != (f == 1.0) || refracted_cosine(f64::from(cos), eta).is_none() != (f == 1.0));
        let glass = Bsdf::new(&BsdfDesc::Dielectric { ior, exterior_ior: 1.0 });
        let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, -cos);
        chosen.add(reflected_share(&glass, wo), f);
        // What is refracted there runs along the surface: finite, on the other side, of unit length.
        bad +=
            u64::from(!Dielectric::new(ior, 1.0).branches(wo).2.is_none_or(|(wi, eta)| {
                wi.z > 0.0 && (wi.length() - 1.0).abs() < 4e-7 && (eta - 1.0 / ior).abs() < 1e-7
            }));
    }
    exact.row(case, "1 - F next to the critical cosine, worst of 7", 1e-6);
    chosen.row(case, "share that samples reflect there, worst of 10", 1e-6);
    case.never("refraction beyond it, none before it, or a bad direction", bad, 20);
}

/// Reflectance for a diffuse field from outside and from inside, in closed form.
const HEMISPHERICAL: [(f64, f64); 3] =
    [(0.0664057647831, 0.474590570814), (0.0917779593424, 0.596345759708), (0.212187588324, 0.865144234737)];

fn hemispherical(case: &mut Case) {
    let points = case.count(100_000, 1_000_000);
    let draws = case.count(200_000, 20_000_000);
    for (n, (outside, inside)) in INDICES.into_iter().zip(HEMISPHERICAL) {
        let glass = Bsdf::new(&BsdfDesc::Dielectric { ior: n as f32, exterior_ior: 1.0 });
        let mut both = [0.0; 2];
        for ((side, up, exact), sum) in
            [("outside", 1.0_f32, outside), ("inside", -1.0, inside)].into_iter().zip(&mut both)
        {
            let eta = if up > 0.0 { n } else { 1.0 / n };
            // Midpoints in cos^2, which is the measure of a diffuse field.
            let f = |i| fresnel_dielectric(((i as f64 + 0.5) / points as f64).sqrt(), eta);
            let mean = (0..points).map(f).sum::<f64>() / points as f64;
            case.exact(format!("{side}, index {n}: integral"), mean, exact, Within::Absolute(1e-6));
            *sum = mean;
            let mut rng = Rng::new(34, n.to_bits() + u64::from(up > 0.0));
            let reflected = (0..draws).filter(|_| {
                let wo = up * warps::cosine_hemisphere(rng.next_2d());
                glass
                    .sample(wo, uniform_3d(&mut rng), TransportMode::Radiance)
                    .is_some_and(|sample| sample.wi.z * wo.z > 0.0)
            });
            let share = reflected.count() as f64 / draws as f64;
            let error = (exact * (1.0 - exact) / draws as f64).sqrt();
            case.mean(format!("{side}, index {n}: share of samples"), (share, error), exact, 1e-2);
        }
        let identity = 1.0 - (1.0 - both[0]) / (n * n);
        case.exact(format!("index {n}: inside by Egan and Hilgeman"), both[1], identity, Within::Absolute(1e-6));
    }
}
