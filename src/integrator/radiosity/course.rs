//! The course of a solution that has to be there at some time: how far links are refined, and what is done of the steps that follow.
//!
//! A solution that ends early is a pure function of where it ended. So a render that goes on later, and helpers of a render, come to
//! the same one.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::error::Result;

/// Where a solution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Steps {
    /// Number of times that refinement was found to have time left, or [`u32::MAX`] for one that was not ended.
    links: u32,
    /// Number of steps after it.
    after: u32,
    /// Whether vertices have the means of the leaves around them, and no irradiance of their own. Checkpoints of before do not say it.
    #[serde(default)]
    means: bool,
}

impl Steps {
    /// All that the settings ask for.
    pub const WHOLE: Self = Self { links: u32::MAX, after: u32::MAX, means: false };

    pub fn is_whole(self) -> bool {
        self == Self::WHOLE
    }
}

/// How far a solution is to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// As far as another one went, or as the settings ask for.
    Steps(Steps),
    /// As far as it comes until this moment.
    Until(Instant),
}

/// Times of what follows the refinement, over that of a pair that refinement evaluates: to measure a link (0.8 to 2.4 in the project's
/// scenes), and for each link of each leaf to balance the leaves (0.02 to 0.14) and to find the irradiance at vertices (the same).
const MEASURING: f64 = 1.6;
const BALANCE: f64 = 0.08;
const VERTICES: f64 = 0.08;

/// Time of the last balance, in which leaves trace rays, over that of one before: 1.3 to 3.8.
const LAST_BALANCE: f64 = 2.0;

/// The share of the time until a solution is to be there by which it may be late for the irradiance at vertices. That is the last step, and
/// what takes most of the time where links are many; a limit leaves a third as much as this time again for samples.
const LATE: f64 = 0.25;

/// A step after the refinement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Measuring,
    Balance,
    LastBalance,
}

/// How far a solution has come.
#[derive(Debug)]
pub(super) struct Course {
    extent: Extent,
    start: Instant,
    /// Number of links between all surfaces, be they inaccurate, and of those that leaves gather over; 0 before there are any, where
    /// nothing ends.
    links: usize,
    gathered: usize,
    /// Number of pairs that were evaluated, and when the last of them were.
    pairs: u64,
    refined: Instant,
    /// Number of times that refinement was asked whether it goes on, and whether it does not.
    asked: u32,
    is_coarse: bool,
    /// Number of steps after it, whether there were fewer than all of them, and how long the last one took (s).
    after: u32,
    is_short: bool,
    last: f64,
    means: bool,
}

impl Course {
    /// A solution that begins now.
    pub fn new(extent: Extent) -> Self {
        let start = Instant::now();
        Self {
            extent,
            start,
            links: 0,
            gathered: 0,
            pairs: 0,
            refined: start,
            asked: 0,
            is_coarse: false,
            after: 0,
            is_short: false,
            last: 0.0,
            means: false,
        }
    }

    /// Notes that so many pairs were evaluated.
    pub fn evaluated(&mut self, pairs: u64) {
        self.pairs += pairs;
        self.refined = Instant::now();
    }

    /// Notes that all surfaces are linked.
    pub fn linked(&mut self, links: usize, gathered: impl FnOnce() -> usize) {
        self.links = links;
        if let Extent::Until(_) = self.extent {
            self.gathered = gathered();
        }
    }

    /// Time (s) in which refinement evaluates so many pairs.
    fn time_of(&self, pairs: f64) -> f64 {
        pairs * (self.refined - self.start).as_secs_f64() / self.pairs.max(1) as f64
    }

    /// Whether refinement ends before all links are as accurate as they are to be. `links`: how many there are, or will be at least;
    /// `waiting`: how many pairs are to be evaluated for that.
    pub fn refines_no_more(&mut self, links: usize, waiting: usize) -> bool {
        if self.is_coarse || self.links == 0 {
            return self.is_coarse;
        }
        let gathered = self.gathered as f64 / self.links as f64;
        let a_link = MEASURING + (BALANCE + VERTICES) * gathered;
        self.is_coarse = match self.extent {
            Extent::Steps(steps) => self.asked >= steps.links,
            Extent::Until(end) => left(end) < self.time_of(a_link * links as f64 + waiting as f64),
        };
        self.asked += u32::from(!self.is_coarse);
        self.is_coarse
    }

    /// Takes the next step after refinement if there is time for it; returns whether there was.
    ///
    /// # Errors
    /// Those of the step.
    pub fn step(&mut self, step: Step, take: impl FnOnce() -> Result<()>) -> Result<bool> {
        let now = Instant::now();
        let gathered = self.gathered as f64;
        let goes_on = match self.extent {
            Extent::Steps(steps) => self.after < steps.after,
            Extent::Until(end) => {
                let own = match step {
                    Step::Measuring => self.time_of(MEASURING * self.links as f64),
                    Step::Balance if self.after < 2 => self.time_of(BALANCE * gathered),
                    Step::Balance => self.last,
                    Step::LastBalance => LAST_BALANCE * self.last,
                };
                left(end) >= own + self.time_of(VERTICES * gathered)
            }
        };
        if self.is_short || !goes_on {
            self.is_short = true;
            return Ok(false);
        }
        self.after += 1;
        take()?;
        self.last = now.elapsed().as_secs_f64();
        Ok(true)
    }

    /// Whether there is time to gather light at vertices, at the end.
    pub fn gathers_at_vertices(&mut self) -> bool {
        self.means = match self.extent {
            Extent::Steps(steps) => steps.means,
            Extent::Until(end) => {
                let late = LATE * end.saturating_duration_since(self.start).as_secs_f64();
                left(end) + late < self.time_of(VERTICES * self.gathered as f64)
            }
        };
        !self.means
    }

    /// Whether the steps after refinement ended before all were taken.
    pub fn is_short(&self) -> bool {
        self.is_short
    }

    /// What to tell of a solution that ended early. `coarser`: allowed errors of its links over those that were asked for.
    pub fn note(&self, coarser: f64) -> String {
        let links = match self.is_coarse {
            true if coarser > 1.5 => format!("links have up to {coarser:.0} times the allowed error"),
            true => "elements at the edges of shadows are larger".to_owned(),
            false => "links are as accurate as they were to be".to_owned(),
        };
        let means = if self.means { "; vertices have the means of the elements around them" } else { "" };
        let after = match (self.is_short, self.after) {
            (false, _) => "",
            (true, 0) => {
                ", visibility is not measured by the light that it blocks, leaves are not balanced, and light is gathered a few times only"
            }
            (true, 1) => ", leaves are not balanced, and light is gathered a few times only",
            (true, _) => ", leaves are not balanced to the end, and light is gathered a few times only",
        };
        format!("radiosity: the time limit ended the solution early: {links}{after}{means}")
    }

    /// Where it ended.
    pub fn steps(&self) -> Steps {
        let of = |is_early, count| if is_early { count } else { u32::MAX };
        Steps { links: of(self.is_coarse, self.asked), after: of(self.is_short, self.after), means: self.means }
    }
}

/// Time until a moment (s).
fn left(end: Instant) -> f64 {
    end.saturating_duration_since(Instant::now()).as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Alone;
    use crate::desc::{self, RadiosityDesc};
    use crate::integrator::radiosity::Radiosity;
    use crate::math::DVec3;
    use crate::scene::{BuildOptions, Scene};

    /// Wherever a solution ends, one that is to end there is the same, and the later it is, the nearer to the whole.
    #[test]
    fn solutions_end_where_others_did() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.json");
        let desc = desc::load(file.as_ref(), None).unwrap();
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let solve = |extent| {
            let settings = RadiosityDesc { error: 8.0, ..RadiosityDesc::default() };
            let solution = Radiosity::solve_to(&scene, &settings, extent, &mut Alone::default()).unwrap();
            let places = (0..desc.surfaces.len() as u32).flat_map(|surface| [0.1_f32, 0.3, 0.45].map(|s| (surface, s)));
            let at =
                |(surface, s)| solution.irradiance_on(surface, 0, [s, s], DVec3::ZERO, true).map_or(0.0, |e| e.r());
            (places.map(at).collect::<Vec<f32>>(), solution.steps(), solution.notes().join("; "))
        };
        let (whole, steps, notes) = solve(Extent::Steps(Steps::WHOLE));
        assert!(steps.is_whole() && !notes.contains("early"), "{notes}");

        let (over, steps, notes) = solve(Extent::Until(Instant::now()));
        assert_eq!(steps, Steps { links: 0, after: 0, means: true });
        assert!(notes.contains("64 times the allowed error"), "{notes}");
        assert_eq!(solve(Extent::Steps(steps)).0, over);

        let far = |found: &[f32]| found.iter().zip(&whole).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt();
        let size = whole.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>().sqrt();
        let mut last = far(&over) / size;
        assert!(last < 0.6, "{last}");
        for (links, after, means) in [(0, 0, false), (4, 1, true), (4, 1, false), (u32::MAX, 2, false)] {
            let steps = Steps { links, after, means };
            let (found, at, notes) = solve(Extent::Steps(steps));
            assert_eq!(at, steps, "{notes}");
            let now = far(&found) / size;
            println!("{steps:?}: {now:.4}, {notes}");
            assert!(now < last, "{steps:?}: {now}, before {last}");
            last = now;
        }
        // Until a moment that is far away, nothing ends.
        let end = Instant::now() + std::time::Duration::from_secs(1 << 20);
        assert!(solve(Extent::Until(end)).1.is_whole());
    }
}
