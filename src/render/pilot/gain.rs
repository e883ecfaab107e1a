//! What the squares of a pilot and its light paths tell of the time to a given error in each way.

use super::cached::Cached;
use super::size::Size;

/// Time of a ray of sharing over the time of a path's ray without. The rays that sharing adds are shadow rays to common ends, and where there
/// are mirrors or glass, rays that are aimed at these and go on from there.
const TIME_OF_A_SHARED_RAY: f64 = 0.5;
const TIME_OF_A_SHARED_OR_AIMED_RAY: f64 = 0.85;

/// The same for a ray of a light path, with the choice of where it begins.
pub(super) const TIME_OF_A_LIGHT_RAY: f64 = 1.6;

/// Mean time of a ray where pixels share hits, of which many are shadow rays to common ends, where paths by themselves are not known:
/// without rays that are aimed at mirrors and glass, and with them.
pub(super) const TIME_OF_A_RAY_AMONG_SHARED: [f64; 2] = [0.7, 0.95];

/// Time of the ray of one more light sample at the first hit, with the choice of a lamp, over that of a path's ray.
const TIME_OF_A_LIGHT_SAMPLE: f64 = 0.8;

/// The same where lamps are so many that they are chosen by a hierarchy.
const TIME_OF_A_SAMPLE_OF_MANY_LAMPS: f64 = 1.4;

/// What a way with more light samples costs counts so many times, because these often take nothing from the errors of pixels that are left
/// out.
const DOUBT_OF_SAMPLES: f64 = 1.1;

/// Numbers of light samples at the first hit that are considered, in those of other hits, and the one that is rendered.
const TIMES_AS_MANY_SAMPLES: [u32; 4] = [1, 2, 4, MOST_TIMES];
pub(super) const SAMPLES_TRIED: u32 = 4;
pub(in super::super) const MOST_TIMES: u32 = 8;

/// The gain in time from which on another way than that of paths by themselves is taken. Pilots promise a little more than pictures keep.
const LEAST_GAIN: f64 = 1.1;

/// The same for light paths. What their squares tell knows nothing of the even spread of samples, which makes camera paths better than
/// that.
const LEAST_LIGHT_GAIN: f64 = 1.2;

/// The same by a small pilot, which traces few of them.
const LEAST_LIGHT_GAIN_OF_FEW: f64 = 1.5;

/// Numbers of light paths that are considered, in those of [`LightPaths::new`].
pub(super) const TIMES_AS_MANY: [u32; 4] = [1, 2, 4, 8];

/// The least share of a square's error that is taken to have nothing to do with caustics.
const LEAST_REST: f64 = 0.05;

/// What a pilot found.
#[derive(Clone, Debug)]
pub(in super::super) struct Found {
    /// How many times longer a picture takes without shared hits to the same error, where it was asked.
    pub sharing: f64,
    /// How many times longer it takes without light paths, and how many of them are best for each sample; 0 where none are to be traced.
    pub light: f64,
    pub count: u32,
    /// Number of light samples at the hits that the camera sees, in that of other hits.
    pub first_shadow_rays: u32,
    /// What the best of these ways costs.
    pub best: Best,
    /// What was found of the irradiance cache, where it was asked.
    pub cached: Option<Cached>,
    /// Number of rays of the pilot, and their time, in that of a ray of paths by themselves.
    pub rays: u64,
    pub time: f64,
}

/// What the best way of paths costs.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Best {
    /// Error of the samples of the pilot, as the mean over squares.
    pub error: f64,
    /// Time of a sample of a pixel, in that of a ray of paths by themselves.
    pub rays: f64,
}

impl Found {
    /// Whether pixels are to share hits.
    pub fn shares(&self) -> bool {
        self.sharing >= LEAST_GAIN
    }

    /// Whether light paths are to be traced.
    pub fn traces_light(&self) -> bool {
        self.count > 0
    }
}

/// What a square of the pilot came to in one way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    /// Its relMSE, as [`super::measure::Measure`] has it.
    pub error: f64,
    pub rays: u64,
}

/// What is known of a square.
#[derive(Clone, Debug)]
pub(super) struct Square {
    /// For each way: by itself, with shared hits where these are open, and in some squares the last of these with more light samples.
    pub costs: Vec<Cost>,
    /// What light paths tell of it, for each way but the one with more light samples.
    pub caustics: Vec<Caustics>,
}

/// What is known beside the squares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Given {
    /// Number of ways with few light samples.
    pub ways: usize,
    /// Number of light paths for each sample of all pixels, and of their rays for the samples of the squares.
    pub light: Option<(u32, f64)>,
    /// Mean time of a ray in the first of the ways, over that of a path's.
    pub ray: f64,
    /// Whether rays of the last way are aimed at mirrors and glass.
    pub has_aims: bool,
    /// Whether lamps are so many that they are chosen by a hierarchy.
    pub has_many_lamps: bool,
    pub size: Size,
}

/// The part of an error that is of caustics, in one way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Caustics {
    /// By paths from the camera alone.
    pub alone: f64,
    /// By these with the weights that they have beside light paths.
    pub weighted: f64,
    /// With light paths beside, for each of [`TIMES_AS_MANY`].
    pub beside: [f64; TIMES_AS_MANY.len()],
}

impl Caustics {
    /// Adds others, times `scale`.
    pub fn add(&mut self, other: &Self, scale: f64) {
        self.alone += scale * other.alone;
        self.weighted += scale * other.weighted;
        self.beside.iter_mut().zip(other.beside).for_each(|(sum, of)| *sum += scale * of);
    }
}

/// What squares tell of the time to a given error, in that of paths by themselves.
struct Model {
    /// For each way the error that has nothing to do with caustics, what is known of these, and the time of a sample.
    rest: Vec<f64>,
    caustics: Vec<Caustics>,
    times: Vec<f64>,
    /// Number of light paths for each sample of all pixels, and their time.
    light: Option<(u32, f64)>,
    /// Error that is of light samples at the hits that the camera sees.
    direct: f64,
    /// The time of one more of these.
    sample_time: f64,
}

impl Model {
    fn of(squares: &[Square], &Given { ways, light, ray, has_aims, has_many_lamps, .. }: &Given) -> Self {
        let rays = |way: usize| squares.iter().map(|square| square.costs[way].rays).sum::<u64>() as f64;
        let few = rays(0).max(1.0);
        let of_a_ray = if has_aims { TIME_OF_A_SHARED_OR_AIMED_RAY } else { TIME_OF_A_SHARED_RAY };
        let times = (0..ways).map(|way| 1.0 + of_a_ray * (rays(way) / few - 1.0)).collect();
        let light = light.map(|(count, rays)| (count, TIME_OF_A_LIGHT_RAY * rays / (few * ray)));
        let errors: Vec<f64> =
            (0..ways).map(|way| squares.iter().map(|square| square.costs[way].error).sum()).collect();
        let caustics: Vec<Caustics> = (0..ways)
            .map(|way| {
                squares.iter().filter_map(|square| square.caustics.get(way)).fold(Caustics::default(), |mut sum, of| {
                    sum.add(of, 1.0);
                    sum
                })
            })
            .collect();
        let rest = errors.iter().zip(&caustics).map(|(error, of)| (error - of.weighted).max(LEAST_REST * error));
        let rest = rest.collect();
        // Of squares that were rendered with more light samples too: errors with few and with more, and rays of paths by themselves, with
        // few light samples and with more.
        let mut sums = [0.0; 5];
        for square in squares {
            let (Some(few), Some(more)) = (square.costs.get(ways - 1), square.costs.get(ways)) else { continue };
            let [rays, rays_of_few, rays_of_more] = [&square.costs[0], few, more].map(|cost| cost.rays as f64);
            let of = [few.error, more.error, rays, rays_of_few, rays_of_more];
            sums.iter_mut().zip(of).for_each(|(sum, of)| *sum += of);
        }
        let [with_few, with_more, alone, rays_of_few, rays_of_more] = sums;
        let tried = f64::from(SAMPLES_TRIED);
        let (mut direct, mut sample_time) = (0.0, 0.0);
        if with_few > 0.0 && alone > 0.0 {
            let share: f64 = (1.0 - with_more / with_few) * tried / (tried - 1.0);
            direct = share.clamp(0.0, 1.0) * errors[ways - 1];
            // Paths of other random numbers have other numbers of rays.
            let more = (rays_of_more - rays_of_few).max(0.0);
            let of_a_ray = if has_many_lamps { TIME_OF_A_SAMPLE_OF_MANY_LAMPS } else { TIME_OF_A_LIGHT_SAMPLE };
            sample_time = of_a_ray * more / (alone * ray * (tried - 1.0));
        }
        Self { rest, caustics, times, light, direct, sample_time }
    }

    /// What a way costs with light paths at this place of [`TIMES_AS_MANY`] or without, with the number of light samples at the first hit
    /// that makes it least.
    fn cost(&self, way: usize, place: Option<usize>) -> WayCost {
        let (mut error, mut time) = (self.rest[way], self.times[way]);
        match (place, self.light) {
            (Some(place), Some((_, light))) => {
                error += self.caustics[way].beside[place];
                time += light * f64::from(TIMES_AS_MANY[place]);
            }
            _ => error += self.caustics[way].alone,
        }
        let with = |times: u32| {
            let gone = self.direct * (1.0 - 1.0 / f64::from(times));
            let error = (error - gone).max(LEAST_REST * error);
            WayCost { error, time: time + f64::from(times - 1) * self.sample_time, first_shadow_rays: times }
        };
        let costs = TIMES_AS_MANY_SAMPLES.map(with).into_iter();
        costs.min_by(|a, b| a.counted().total_cmp(&b.counted())).unwrap_or_else(|| with(1))
    }
}

/// What a way costs.
#[derive(Clone, Copy, Debug)]
struct WayCost {
    /// Sum of the errors of the squares.
    error: f64,
    /// In that of paths by themselves.
    time: f64,
    /// Number of light samples at the hits that the camera sees, in that of other hits.
    first_shadow_rays: u32,
}

impl WayCost {
    /// Error times time, as it counts against other ways.
    fn counted(&self) -> f64 {
        let doubt = if self.first_shadow_rays > 1 { DOUBT_OF_SAMPLES } else { 1.0 };
        doubt * self.error * self.time
    }
}

/// The gain of other ways than the first, by the squares' costs.
pub(super) fn compare(squares: &[Square], given: &Given) -> Found {
    let &Given { ways, light, ray, has_aims, size, .. } = given;
    let rays = squares.iter().flat_map(|square| &square.costs).map(|cost| cost.rays).sum();
    let rays_of_more = squares.iter().flat_map(|square| square.costs.get(ways)).map(|cost| cost.rays).sum::<u64>();
    let model = Model::of(squares, given);
    // Black squares, and those without noise, gain nothing.
    let gain = |before: f64, after: f64| if before > 0.0 { before / after.max(f64::MIN_POSITIVE) } else { 0.0 };
    let gain_of_second = |costs: &[WayCost]| match costs {
        [first, second, ..] => gain(first.counted(), second.counted()),
        _ => 0.0,
    };
    let plain: Vec<_> = (0..ways).map(|way| model.cost(way, None)).collect();
    let sharing = gain_of_second(&plain);
    let chosen = |sharing: f64| usize::from(sharing >= LEAST_GAIN);
    let few = squares.iter().map(|square| square.costs[0].rays).sum::<u64>() as f64;
    let count = squares.len().max(1) as f64;
    let best = |cost: WayCost| Best { error: cost.error / count, rays: cost.time * few * ray / size.samples_of(count) };
    let without = chosen(sharing);
    let without = Found {
        sharing,
        light: 0.0,
        count: 0,
        first_shadow_rays: plain[without].first_shadow_rays,
        best: best(plain[without]),
        cached: None,
        rays,
        time: ray * few * model.times.iter().sum::<f64>()
            + TIME_OF_A_RAY_AMONG_SHARED[usize::from(has_aims)] * rays_of_more as f64,
    };
    let Some((count, _)) = light else { return without };
    // For each way the least cost, and of how many light paths it is.
    let lit: Vec<_> = (0..ways)
        .map(|way| {
            let costs = (0..TIMES_AS_MANY.len()).map(|place| (model.cost(way, Some(place)), TIMES_AS_MANY[place]));
            costs.min_by(|a, b| a.0.counted().total_cmp(&b.0.counted())).unwrap_or((model.cost(way, None), 1))
        })
        .collect();
    let lit_sharing = gain_of_second(&lit.iter().map(|(cost, _)| *cost).collect::<Vec<_>>());
    let way = chosen(lit_sharing);
    let (cost, times) = lit[way];
    let gained = gain(plain[chosen(sharing)].counted(), cost.counted());
    let count = count.saturating_mul(times);
    let least = if size.is_large() { LEAST_LIGHT_GAIN } else { LEAST_LIGHT_GAIN_OF_FEW };
    if gained < least {
        return Found { light: gained, ..without };
    }
    let first_shadow_rays = cost.first_shadow_rays;
    Found { sharing: lit_sharing, light: gained, count, first_shadow_rays, best: best(cost), ..without }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { across: 6, samples: 16 };

    /// Squares with these errors without and with shared hits.
    fn squares(errors: [f64; 2], rays: [u64; 2]) -> Vec<Square> {
        let costs = [0, 1].map(|way| Cost { error: errors[way], rays: rays[way] }).to_vec();
        vec![Square { costs, caustics: vec![Caustics::default(); 2] }; 36]
    }

    /// What is found without and with shared hits.
    fn of_two(squares: &[Square], light: Option<(u32, f64)>) -> Found {
        compare(squares, &Given { ways: 2, light, ray: 1.0, has_aims: false, has_many_lamps: true, size: SIZE })
    }

    #[test]
    fn the_gain_is_that_of_errors_over_that_of_rays() {
        let found = of_two(&squares([0.3, 0.1], [100, 300]), None);
        assert!((found.sharing - 3.0 / 2.0).abs() < 1e-12, "{found:?}");
        assert_eq!(found.rays, 36 * 400);
        assert!(found.shares() && !found.traces_light());
        // Rays that are aimed at mirrors and glass take longer.
        let aimed = Given { ways: 2, light: None, ray: 1.0, has_aims: true, has_many_lamps: true, size: SIZE };
        let found = compare(&squares([0.3, 0.1], [100, 300]), &aimed);
        assert!((found.sharing - 3.0 / 2.7).abs() < 1e-12, "{found:?}");
        assert!(!of_two(&squares([0.3, 0.2], [100, 300]), None).shares());
    }

    #[test]
    fn squares_without_light_or_noise_share_nothing() {
        let of = |errors, rays| of_two(&squares(errors, rays), None).shares();
        assert!(!of([0.0; 2], [100, 100]));
        assert!(!of([0.0; 2], [0, 0]));
        assert!(of([0.1, 0.0], [100, 100]));
        let dark = of_two(&squares([0.0; 2], [100, 100]), Some((10, 5.0)));
        assert!(!dark.shares() && !dark.traces_light(), "{dark:?}");
    }

    #[test]
    fn more_light_samples_are_taken_where_these_are_most_of_the_noise() {
        // Ways by themselves and with shared hits, and the latter with four times as many light samples at the first hit.
        let tried = |errors: [f64; 2], [error, rays]: [f64; 2]| {
            let mut squares = squares(errors, [100, 300]);
            squares.iter_mut().step_by(2).for_each(|square| square.costs.push(Cost { error, rays: rays as u64 }));
            of_two(&squares, None)
        };
        // Of 0.1, 0.08 are of light samples: 0.1 (A + B / n) (T + n t) is least for 4 of 1, 2, 4 and 8.
        let found = tried([0.3, 0.1], [0.04, 360.0]);
        assert_eq!(found.first_shadow_rays, 4, "{found:?}");
        let sample = TIME_OF_A_SAMPLE_OF_MANY_LAMPS * 0.2;
        assert!((found.sharing - 0.3 / (DOUBT_OF_SAMPLES * 0.04 * (2.0 + 3.0 * sample))).abs() < 1e-9, "{found:?}");
        assert_eq!(found.rays, 36 * 400 + 18 * 360);
        // Not where they take much time, and not where they bring nothing.
        assert_eq!(tried([0.3, 0.1], [0.04, 600.0]).first_shadow_rays, 1);
        assert_eq!(tried([0.3, 0.1], [0.09, 360.0]).first_shadow_rays, 1);
        assert_eq!(tried([0.3, 0.1], [0.2, 360.0]).first_shadow_rays, 1);
        // Fewer rays by chance are no time that is gained.
        let few = tried([0.3, 0.1], [0.098, 100.0]);
        assert!(few.first_shadow_rays == 1 && few.sharing > 0.0 && few.sharing < 2.0, "{few:?}");
        // Among few lamps a sample takes less time.
        let mut few = squares([0.3, 0.1], [100, 300]);
        few.iter_mut().for_each(|square| square.costs.push(Cost { error: 0.04, rays: 360 }));
        let few = compare(
            &few,
            &Given { ways: 2, light: None, ray: 1.0, has_aims: false, has_many_lamps: false, size: SIZE },
        );
        assert_eq!(few.first_shadow_rays, 8, "{few:?}");
        let sample = TIME_OF_A_LIGHT_SAMPLE * 0.2;
        assert!((few.sharing - 0.3 / (DOUBT_OF_SAMPLES * 0.03 * (2.0 + 7.0 * sample))).abs() < 1e-9, "{few:?}");
        // Sharing takes the noise of what is not shared to account.
        let apart = tried([0.2, 0.15], [0.0395, 360.0]);
        assert!(apart.shares() && apart.first_shadow_rays == 8, "{apart:?}");
        assert!(!of_two(&squares([0.2, 0.15], [100, 300]), None).shares());
    }

    /// Squares in which light paths tell of caustics, in both ways.
    fn with_caustics(errors: [f64; 2], caustics: [Caustics; 2]) -> Vec<Square> {
        let mut squares = squares(errors, [100, 300]);
        squares.iter_mut().for_each(|square| square.caustics = caustics.to_vec());
        squares
    }

    #[test]
    fn light_paths_are_traced_where_caustics_are_most_of_the_noise() {
        let caustics = |alone, beside: f64| Caustics {
            alone,
            weighted: 0.0,
            beside: [1.0, 0.5, 0.25, 0.125].map(|it| it * beside),
        };
        let errors = [0.1, 0.08];
        // A few light rays beside 3600 of paths: as many of them as make their noise small.
        let found = of_two(&with_caustics(errors, [caustics(0.9, 0.1); 2]), Some((10, 36.0)));
        assert!(found.traces_light() && !found.shares(), "{found:?}");
        let with = |times: f64, noise: f64| (0.1 + noise) * (1.0 + TIME_OF_A_LIGHT_RAY * times * 0.01);
        assert_eq!(found.count, 80);
        assert!((found.light - 1.0 / with(8.0, 0.0125)).abs() < 1e-9, "{found:?}");
        // Where they are little of it, they are not worth their time, and sharing is chosen as without.
        let errors = [0.3, 0.1];
        let found = of_two(&with_caustics(errors, [caustics(0.01, 0.001); 2]), Some((10, 36.0)));
        assert!(!found.traces_light() && found.shares(), "{found:?}");
        // Both.
        let found = of_two(&with_caustics(errors, [caustics(0.9, 0.1), caustics(0.6, 0.1)]), Some((10, 36.0)));
        assert!(found.traces_light() && found.shares(), "{found:?}");
        // Light rays that take longer than all paths.
        let found = of_two(&with_caustics(errors, [caustics(0.1, 0.01); 2]), Some((10, 36000.0)));
        assert!(!found.traces_light(), "{found:?}");
    }
}
