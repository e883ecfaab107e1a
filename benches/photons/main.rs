//! Photon look-ups, timed against each other on one set of photons and queries.
//!
//! boxes   the library's: photons along a curve, a tree of boxes over blocks of them
//! kiddo   the crate's immutable k-d tree, with indices into photons that stay where they are
//! grid    photons sorted by hashed cell; the cells twice as wide as the first radius asked for
//!
//! `cargo bench --bench photons [-- PHOTONS...]` (100000, 1000000 and 10000000 unless told otherwise). Each round times every
//! way once, so that the machine's mood hits all alike; the best of the rounds is printed, in seconds for which the slower
//! thread ran. With two threads, each builds a map of its own, and both ask one.
//!
//! The scene: a room with photons on its walls and on a ball, and a third of them in a caustic on a ten-thousandth of the
//! area. Queries are, as a camera's, spread evenly over the area, with the radius that holds so many photons on a wall; or,
//! `mixed`, a third of them in the caustic, with radii for 20 to 200 photons at the local density, the largest 200 times
//! the smallest.

mod grid;

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};

use etendue::Cancel;
use etendue::integrator::photon::{Nearest, Photon, PhotonMap};
use etendue::math::Vec3;
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;
use grid::Grid;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rustix::time::{ClockId, clock_gettime};

const ROUNDS: usize = 5;
const QUERIES: usize = 1 << 13;

/// Counts the bytes that are allocated, and the most that ever were.
struct Counting;

static BYTES: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all calls are passed on unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let bytes = BYTES.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(bytes, Ordering::Relaxed);
        // SAFETY: as the caller promised.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let bytes = BYTES.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(bytes, Ordering::Relaxed);
        // SAFETY: as the caller promised.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        BYTES.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as the caller promised.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A way to look photons up. Queries add up what they find, so that each photon is read.
trait LookUp: Sync + Sized {
    /// What a query may keep between uses.
    type Scratch: Default;

    /// `radius`: one that will be asked for often.
    fn build(photons: Vec<Photon>, radius: f32) -> Self;

    /// How many there are, and the sum of their power.
    fn within(&self, p: Vec3, radius: f32, scratch: &mut Self::Scratch) -> (usize, f32);

    fn nearest(&self, p: Vec3, count: usize, scratch: &mut Self::Scratch) -> (usize, f32);
}

impl LookUp for PhotonMap {
    type Scratch = Nearest;

    fn build(photons: Vec<Photon>, _: f32) -> Self {
        Self::build(photons, &Cancel::new()).expect("built")
    }

    fn within(&self, p: Vec3, radius: f32, _: &mut Nearest) -> (usize, f32) {
        let (mut count, mut sum) = (0, 0.0);
        self.within(p, radius, |photon, distance2| {
            count += 1;
            sum += photon.power[0] * distance2;
        });
        (count, sum)
    }

    fn nearest(&self, p: Vec3, count: usize, nearest: &mut Nearest) -> (usize, f32) {
        self.nearest(p, count, f32::INFINITY, nearest);
        let one = |&(distance2, index): &(f32, u32)| self.photons()[index as usize].power[0] * distance2;
        (nearest.found().len(), nearest.found().iter().map(one).sum())
    }
}

struct Kiddo {
    tree: ImmutableKdTree<f32, 3>,
    photons: Vec<Photon>,
}

impl LookUp for Kiddo {
    type Scratch = ();

    fn build(photons: Vec<Photon>, _: f32) -> Self {
        let places: Vec<[f32; 3]> = photons.iter().map(|photon| photon.p).collect();
        Self { tree: ImmutableKdTree::new_from_slice(&places).expect("built"), photons }
    }

    fn within(&self, p: Vec3, radius: f32, _: &mut ()) -> (usize, f32) {
        let (mut count, mut sum) = (0, 0.0);
        let p = p.to_array();
        let query = self.tree.query(&p).within::<SquaredEuclidean<f32>>(radius * radius);
        query.exclusive_boundaries().unsorted().visit(|found| {
            count += 1;
            sum += self.photons[found.item as usize].power[0] * found.distance;
        });
        (count, sum)
    }

    fn nearest(&self, p: Vec3, count: usize, _: &mut ()) -> (usize, f32) {
        let p = p.to_array();
        let count = NonZero::new(count).expect("some");
        let found = self.tree.query(&p).nearest_n::<SquaredEuclidean<f32>>(count).execute();
        (found.len(), found.iter().map(|one| self.photons[one.item as usize].power[0] * one.distance).sum())
    }
}

/// Side of the caustic.
const CAUSTIC: f32 = 0.0255;

/// A place in the room by number: the first twelfth of an area on the ball, the others on walls.
fn on_surfaces(i: usize, rng: &mut Rng) -> [f32; 3] {
    let [u, v, w, _] = rng.next_4d();
    if i.is_multiple_of(13) {
        let z = 2.0 * u - 1.0;
        let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
        let r = 0.2 * (1.0 - z * z).sqrt();
        return [0.5 + r * cos, 0.3 + r * sin, 0.5 + 0.2 * z];
    }
    let mut p = [u, v, w];
    p[i % 3] = (i / 3 % 2) as f32;
    p
}

fn in_caustic(rng: &mut Rng) -> [f32; 3] {
    let [u, v] = rng.next_2d();
    [0.3 + CAUSTIC * u, 0.0, 0.7 + CAUSTIC * v]
}

fn room(count: usize) -> Vec<Photon> {
    let mut rng = Rng::new(1, 1);
    let one = |i| {
        let p = if i % 3 == 0 { in_caustic(&mut rng) } else { on_surfaces(i / 3 * 2 + i % 3, &mut rng) };
        Photon::new(Vec3::from(p), Vec3::Z, Vec3::Z, Rgb::ONE)
    };
    (0..count).map(one).collect()
}

/// The radius of a disk that holds so many photons of a density.
fn radius_for(photons: f32, density: f32) -> f32 {
    (photons / (std::f32::consts::PI * density)).sqrt()
}

#[derive(Clone, Copy)]
enum Kind {
    Within(f32),
    Nearest(usize),
}

struct Task {
    name: &'static str,
    queries: Vec<(Vec3, Kind)>,
}

fn tasks(count: usize) -> (f32, Vec<Task>) {
    let density = count as f32 * (2.0 / 3.0) / 6.5;
    let caustic = count as f32 / 3.0 / (CAUSTIC * CAUSTIC);
    let mut rng = Rng::new(2, 1);
    let mut even = |kind: Kind| (0..QUERIES).map(|i| (on_surfaces(i, &mut rng).into(), kind)).collect();
    let mut tasks = vec![
        Task { name: "within, 50", queries: even(Kind::Within(radius_for(50.0, density))) },
        Task { name: "within, 200", queries: even(Kind::Within(radius_for(200.0, density))) },
        Task { name: "nearest 50", queries: even(Kind::Nearest(50)) },
        Task { name: "nearest 200", queries: even(Kind::Nearest(200)) },
    ];
    let mut mixed = |i: usize| {
        let k = 20.0 * 10_f32.powf(rng.next_f32());
        match i % 3 {
            0 => (in_caustic(&mut rng).into(), Kind::Within(radius_for(k, caustic))),
            _ => (on_surfaces(i, &mut rng).into(), Kind::Within(radius_for(k, density))),
        }
    };
    tasks.insert(2, Task { name: "within, mixed", queries: (0..QUERIES).map(&mut mixed).collect() });
    // Off the surfaces: nothing is near.
    let empty = |i: usize| {
        let p = Vec3::from(on_surfaces(i, &mut rng));
        let p = if i.is_multiple_of(13) { p + (p - Vec3::new(0.5, 0.3, 0.5)) * 0.3 } else { p * 0.98 + 0.01 };
        (p, Kind::Within(radius_for(50.0, density).min(0.005)))
    };
    tasks.insert(3, Task { name: "within, nothing", queries: (0..QUERIES).map(empty).collect() });
    (radius_for(50.0, density), tasks)
}

/// Seconds for which the calling thread has run: others on the machine take none of these away.
fn seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Seconds of the slower thread and photons found.
fn ask<L: LookUp>(map: &L, queries: &[(Vec3, Kind)], threads: usize) -> (f64, usize) {
    let work = |queries: &[(Vec3, Kind)]| {
        let start = seconds();
        let mut scratch = L::Scratch::default();
        let mut found = 0;
        for &(p, kind) in queries {
            let (count, sum) = match kind {
                Kind::Within(radius) => map.within(p, radius, &mut scratch),
                Kind::Nearest(count) => map.nearest(p, count, &mut scratch),
            };
            black_box(sum);
            found += count;
        }
        (seconds() - start, found)
    };
    std::thread::scope(|scope| {
        let parts = queries.chunks(queries.len().div_ceil(threads));
        let helpers: Vec<_> = parts.map(|part| scope.spawn(move || work(part))).collect();
        let parts = helpers.into_iter().map(|helper| helper.join().expect("no panic"));
        parts.fold((0.0, 0), |all, part| (part.0.max(all.0), all.1 + part.1))
    })
}

/// The best figures so far.
struct Best {
    name: &'static str,
    build: f64,
    bytes: usize,
    peak: usize,
    /// Seconds and photons found, by task.
    tasks: Vec<(f64, usize)>,
}

impl Best {
    fn new(name: &'static str, tasks: usize) -> Self {
        Self { name, build: f64::INFINITY, bytes: 0, peak: 0, tasks: vec![(f64::INFINITY, 0); tasks] }
    }

    fn round<L: LookUp + Send>(&mut self, photons: &[Photon], radius: f32, tasks: &[Task], threads: usize) {
        let inputs: Vec<_> = (0..threads).map(|_| photons.to_vec()).collect();
        let given = BYTES.load(Ordering::Relaxed) - threads * size_of_val(photons);
        PEAK.store(BYTES.load(Ordering::Relaxed), Ordering::Relaxed);
        let work = |photons| {
            let start = seconds();
            let map = L::build(photons, radius);
            (seconds() - start, map)
        };
        let (times, mut maps): (Vec<f64>, Vec<L>) = std::thread::scope(|scope| {
            let helpers: Vec<_> = inputs.into_iter().map(|photons| scope.spawn(move || work(photons))).collect();
            helpers.into_iter().map(|helper| helper.join().expect("no panic")).unzip()
        });
        self.build = self.build.min(times.into_iter().fold(0.0, f64::max));
        self.bytes = (BYTES.load(Ordering::Relaxed) - given) / threads;
        self.peak = (PEAK.load(Ordering::Relaxed) - given) / threads;
        let map = maps.pop().expect("one");
        drop(maps);
        for (best, task) in self.tasks.iter_mut().zip(tasks) {
            let (seconds, found) = ask(&map, &task.queries, threads);
            *best = (best.0.min(seconds), found);
        }
    }

    fn print(&self, count: usize, threads: usize) {
        let bytes = |bytes: usize| bytes as f64 / count as f64;
        let (held, peak) = (bytes(self.bytes), bytes(self.peak));
        print!("| {count} | {threads} | {} | {:.3} | {held:.0} / {peak:.0} |", self.name, self.build);
        for &(seconds, found) in &self.tasks {
            print!(" {:.0} / {:.1} |", QUERIES as f64 / seconds / 1e3, found as f64 / seconds / 1e6);
        }
        println!();
    }
}

fn main() {
    let counts: Vec<usize> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let counts = if counts.is_empty() { vec![100_000, 1_000_000, 10_000_000] } else { counts };
    println!(
        "Thousands of queries a second / millions of photons found a second; bytes a photon held / while building."
    );
    for (row, &count) in counts.iter().enumerate() {
        let photons = room(count);
        let (radius, tasks) = tasks(count);
        if row == 0 {
            let names: Vec<&str> = tasks.iter().map(|task| task.name).collect();
            println!("\n| photons | threads | | build, s | bytes | {} |", names.join(" | "));
            println!("|{}", "---|".repeat(5 + tasks.len()));
        }
        for threads in [1, 2] {
            let mut best = ["boxes", "kiddo", "grid"].map(|name| Best::new(name, tasks.len()));
            for _ in 0..if count > 2_000_000 { ROUNDS.min(3) } else { ROUNDS } {
                best[0].round::<PhotonMap>(&photons, radius, &tasks, threads);
                best[1].round::<Kiddo>(&photons, radius, &tasks, threads);
                best[2].round::<Grid>(&photons, radius, &tasks, threads);
            }
            best.iter().for_each(|best| best.print(count, threads));
            let found = |best: &Best| best.tasks.iter().map(|task| task.1).collect::<Vec<_>>();
            // Boundaries round differently, by single photons.
            for (a, b) in found(&best[0]).iter().zip(found(&best[1])).chain(found(&best[0]).iter().zip(found(&best[2])))
            {
                assert!(a.abs_diff(b) as f64 <= 1e-5 * *a as f64 + 1.0, "{a} photons found by one, {b} by another");
            }
        }
    }
}
