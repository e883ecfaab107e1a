//! Which helper has which tiles.

use std::collections::BTreeMap;

/// Greatest number of tiles that a helper is given at once.
const MOST_TILES: usize = 256;

/// Greatest number of batches that a helper has at a time: one that it renders, and one on its way.
pub(super) const MOST_BATCHES: usize = 2;

/// All threads together are given one of so many parts of the tiles that are left. Two batches of a helper that is a quarter as fast as the
/// others are then less than its share of all tiles.
const PART: usize = 6;

/// A tile that is out with a helper is given to a second one, which has nothing else to do, after this many times as long as the slowest
/// batch that came back, and this many seconds more; after so many seconds where none came back.
const LATE: (f64, f64) = (2.0, 0.5);
const LATE_AT_FIRST: f64 = 2.0;

/// The leader takes a tile over after so many times as long as that, and this many seconds more.
const TOO_LATE: (f64, f64) = (4.0, 10.0);

/// Tiles that were given to helpers and have not come back.
#[derive(Debug, Default)]
pub(super) struct Dispatch {
    helpers: Vec<Helper>,
    out: BTreeMap<usize, Out>,
    /// Threads of the process that leads.
    own_threads: usize,
    /// The longest time in seconds that a batch was out before it came back.
    longest: f64,
}

/// What is known of a helper.
#[derive(Clone, Debug)]
struct Helper {
    /// `None` until it has said how many threads it has, and once it is lost.
    threads: Option<usize>,
    /// Numbers of batches that are out: of this pass and of earlier ones.
    batches: usize,
}

/// A tile that is out.
#[derive(Clone, Debug)]
struct Out {
    /// Who has it.
    holders: Vec<usize>,
    /// When the first of them was given it [s].
    since: f64,
}

impl Dispatch {
    pub fn new(helpers: usize, own_threads: usize) -> Self {
        Self { helpers: vec![Helper { threads: None, batches: 0 }; helpers], own_threads, ..Self::default() }
    }

    /// The process that leads renders with so many threads.
    pub fn lead_with(&mut self, threads: usize) {
        self.own_threads = threads;
    }

    /// A helper has so many threads.
    pub fn greet(&mut self, helper: usize, threads: usize) {
        self.helpers[helper].threads = Some(threads.max(1));
    }

    /// Whether a helper is there.
    #[cfg(test)]
    fn is_there(&self, helper: usize) -> bool {
        self.helpers[helper].threads.is_some()
    }

    /// The tiles to give to a helper at the time `now` [s], none where it has enough or there are none. `left` tiles were not given to
    /// anyone, and `claim` takes one of them.
    ///
    /// A part of what is left is spread over all threads at a time, so that batches are large at first, and small towards the end, where
    /// all are to be done at the same time (guided self-scheduling, Polychronopoulos and Kuck 1987). Batches have as many tiles for each
    /// thread of the helper, since these take no longer together than one of them, and none is smaller: where a second batch, which
    /// is rendered after the first, would be, there is none.
    pub fn give(
        &mut self,
        helper: usize,
        now: f64,
        left: usize,
        mut claim: impl FnMut() -> Option<usize>,
    ) -> Vec<usize> {
        let Helper { threads: Some(threads), batches } = self.helpers[helper] else { return Vec::new() };
        if batches >= MOST_BATCHES {
            return Vec::new();
        }
        let all = self.own_threads + self.helpers.iter().filter_map(|helper| helper.threads).sum::<usize>();
        let least = threads.min(MOST_TILES);
        let size = (left * threads / (PART * all)).min(MOST_TILES);
        if batches > 0 && size < least {
            return Vec::new();
        }
        let size = (size / least * least).max(least);
        let mut tiles: Vec<usize> = std::iter::from_fn(&mut claim).take(size).collect();
        for tile in &tiles {
            self.out.insert(*tile, Out { holders: Vec::new(), since: now });
        }
        if tiles.is_empty() && batches == 0 {
            tiles = self.late(helper, now, threads);
        }
        for tile in &tiles {
            if let Some(out) = self.out.get_mut(tile) {
                out.holders.push(helper);
            }
        }
        self.helpers[helper].batches += usize::from(!tiles.is_empty());
        tiles
    }

    /// Tiles that one other helper has for longer than is usual.
    fn late(&self, helper: usize, now: f64, most: usize) -> Vec<usize> {
        let usual = self.usual();
        let is_late = |out: &Out| out.holders.len() == 1 && out.holders[0] != helper && now - out.since > usual;
        self.out.iter().filter(|(_, out)| is_late(out)).map(|(tile, _)| *tile).take(most).collect()
    }

    /// The time after which a tile that is out is late [s].
    fn usual(&self) -> f64 {
        if self.longest > 0.0 { LATE.0 * self.longest + LATE.1 } else { LATE_AT_FIRST }
    }

    /// Takes tiles away from helpers that have them for so long that nobody waits for them any more. Returns how many.
    pub fn take_over(&mut self, now: f64) -> usize {
        let limit = TOO_LATE.0 * self.usual() + TOO_LATE.1;
        let before = self.out.len();
        self.out.retain(|_, out| now - out.since <= limit);
        before - self.out.len()
    }

    /// A batch has come back from a helper at the time `now` [s]. Returns those of its tiles that are wanted: not those that another one
    /// has brought before.
    pub fn take_back(&mut self, helper: usize, now: f64, tiles: &[usize]) -> Vec<usize> {
        self.helpers[helper].batches = self.helpers[helper].batches.saturating_sub(1);
        let mut wanted = Vec::new();
        for tile in tiles {
            let is_out = self.out.get(tile).is_some_and(|out| out.holders.contains(&helper));
            if let (true, Some(out)) = (is_out, self.out.remove(tile)) {
                // The second holder of a tile that was late says nothing about usual times.
                if out.holders.len() == 1 {
                    self.longest = self.longest.max(now - out.since);
                }
                wanted.push(*tile);
            }
        }
        wanted
    }

    /// A helper is no longer there. Returns how many tiles nobody has now.
    pub fn lose(&mut self, helper: usize) -> usize {
        self.helpers[helper] = Helper { threads: None, batches: 0 };
        let before = self.out.len();
        self.out.retain(|_, out| {
            out.holders.retain(|holder| *holder != helper);
            !out.holders.is_empty()
        });
        before - self.out.len()
    }

    /// Number of tiles that are out.
    pub fn out(&self) -> usize {
        self.out.len()
    }

    /// The helpers that have batches.
    pub fn busy(&self) -> impl Iterator<Item = usize> {
        (0..self.helpers.len()).filter(|helper| self.helpers[*helper].batches > 0)
    }

    /// A pass begins, of which no tile is out. Batches of the pass before may still come back.
    pub fn begin_pass(&mut self) {
        self.out.clear();
        self.longest = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    /// A helper as the simulation has it: seconds that a tile takes one of its threads, and when it dies.
    #[derive(Clone, Copy)]
    struct Machine {
        threads: usize,
        pace: f64,
        dies: f64,
    }

    /// A picture of 4096 tiles, rendered by machines as they are: how often each tile came back, how many were lost, and how long it
    /// took [s]. The process that leads only leads.
    fn simulated(machines: &[Machine]) -> (Vec<u32>, usize, f64) {
        const TILES: usize = 4096;
        let mut dispatch = Dispatch::new(machines.len(), 0);
        (0..machines.len()).for_each(|helper| dispatch.greet(helper, machines[helper].threads));
        let mut queues = vec![VecDeque::<(f64, Vec<usize>)>::new(); machines.len()];
        let mut free = vec![0.0_f64; machines.len()];
        let mut done = vec![0; TILES];
        let (mut next, mut abandoned, mut now) = (0, 0, 0.0);
        let mut again = Vec::new();
        while next < TILES || dispatch.out() > 0 || !again.is_empty() {
            for (helper, machine) in machines.iter().enumerate() {
                if machine.dies <= now && dispatch.is_there(helper) {
                    abandoned += dispatch.lose(helper);
                    queues[helper].clear();
                    // What nobody has is a pass of its own.
                    again = (0..next).filter(|tile| done[*tile] == 0 && !dispatch.out.contains_key(tile)).collect();
                }
                while queues[helper].front().is_some_and(|(at, _)| *at <= now) {
                    let (_, tiles) = queues[helper].pop_front().unwrap();
                    dispatch.take_back(helper, now, &tiles).into_iter().for_each(|tile| done[tile] += 1);
                }
                let left = TILES - next + again.len();
                let tiles = dispatch.give(helper, now, left, || {
                    again.pop().or_else(|| {
                        next += 1;
                        (next <= TILES).then_some(next - 1)
                    })
                });
                next = next.min(TILES);
                if !tiles.is_empty() {
                    let takes = tiles.len().div_ceil(machine.threads) as f64 * machine.pace;
                    free[helper] = free[helper].max(now) + takes;
                    queues[helper].push_back((free[helper], tiles));
                }
            }
            now += 0.05;
            assert!(now < 1e4, "it does not end");
        }
        (done, abandoned, now)
    }

    const USUAL: Machine = Machine { threads: 4, pace: 1.0, dies: f64::INFINITY };

    #[test]
    fn equal_helpers_end_together() {
        let (done, abandoned, time) = simulated(&[USUAL; 16]);
        assert!(done.iter().all(|times| *times == 1) && abandoned == 0);
        // 64 tiles for each thread.
        assert!((64.0..67.0).contains(&time), "{time}");
    }

    #[test]
    fn fast_helpers_do_more() {
        let machines: Vec<_> =
            (0..16).map(|number| Machine { pace: if number < 8 { 0.5 } else { 2.0 }, ..USUAL }).collect();
        let (done, _, time) = simulated(&machines);
        assert!(done.iter().all(|times| *times == 1));
        // 32 threads do two tiles a second, and 32 one every other second.
        let ideal = 4096.0 / (32.0 * 2.5);
        assert!(time < 1.1 * ideal, "{time} where {ideal} is possible");
    }

    #[test]
    fn stragglers_do_not_hold_up_the_others() {
        let mut machines = [USUAL; 16];
        machines[3].pace = 50.0;
        machines[11].pace = 80.0;
        let (done, _, time) = simulated(&machines);
        assert!(done.iter().all(|times| *times == 1));
        let ideal = 4096.0 / (14.0 * 4.0);
        assert!(time < 1.5 * ideal, "{time} where {ideal} is possible");
    }

    #[test]
    fn tiles_that_do_not_come_back_are_taken_over() {
        let mut dispatch = Dispatch::new(1, 1);
        dispatch.greet(0, 2);
        let mut next = 0..;
        assert_eq!(dispatch.give(0, 0.0, 20, || next.next()), [0, 1]);
        assert_eq!(dispatch.give(0, 0.0, 18, || next.next()), [2, 3]);
        assert!(dispatch.give(0, 0.0, 16, || next.next()).is_empty(), "two batches are enough");
        assert_eq!(dispatch.take_back(0, 1.0, &[0, 1]), [0, 1]);
        assert_eq!((dispatch.take_over(20.0), dispatch.out()), (0, 2));
        assert_eq!((dispatch.take_over(20.1), dispatch.out()), (2, 0), "after 4 (2 + 0.5) + 10 s");
        assert!(dispatch.take_back(0, 30.0, &[2, 3]).is_empty());
    }

    #[test]
    fn tiles_of_the_dead_are_given_to_others() {
        let mut machines = [USUAL; 16];
        machines[0].dies = 10.0;
        machines[5].dies = 0.4;
        machines[9].dies = 55.0;
        machines[2].pace = 30.0;
        let (done, abandoned, time) = simulated(&machines);
        assert!(done.iter().all(|times| *times == 1) && abandoned > 0);
        assert!(time < 130.0, "{time}");
    }
}
