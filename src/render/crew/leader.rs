//! The process that leads a render: it gives tiles to its helpers, and takes them back.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::super::checkpoint::Checkpoint;
use super::super::pass::Pass;
use super::super::ways::Ways;
use super::dispatch::{Dispatch, MOST_BATCHES};
use super::message::Message;
use super::{Event, Link};
use crate::error::Result;
use crate::film::Film;

/// Number of the last pass of any crew of this process. A late word of a helper about a pass of an earlier crew is known by it.
static PASSES: AtomicU64 = AtomicU64::new(0);

/// How long the leader waits for tiles of a helper after a stop.
const PATIENCE: Duration = Duration::from_secs(60);

/// The helpers of a render, as the process that leads sees them ([`Render::run_with`](crate::render::Render::run_with)). Once it is
/// dropped, they are told that they are no longer needed.
pub struct Crew<'l> {
    link: &'l mut dyn Link,
    dispatch: Dispatch,
    start: Instant,
    /// Number of the present pass.
    pass: u64,
    /// When the helpers were told to stop, where they were.
    stopped: Option<Instant>,
    /// What is to be said about helpers that were lost.
    notes: Vec<String>,
}

impl<'l> Crew<'l> {
    /// The helpers at the other ends of a link.
    pub fn new(link: &'l mut dyn Link) -> Self {
        let dispatch = Dispatch::new(link.peers(), 1);
        Self { link, dispatch, start: Instant::now(), pass: 0, stopped: None, notes: Vec::new() }
    }

    fn tell_all(&mut self, message: &Message, beside: &[u8]) {
        (0..self.link.peers()).for_each(|helper| self.link.send(helper, message.bytes(beside)));
    }

    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// A run begins at a state of the render.
    pub(in super::super) fn begin(&mut self, state: &Checkpoint, own_threads: usize) -> Result<()> {
        let mut bytes = Vec::new();
        state.without_samples()?.write_to(&mut bytes)?;
        self.dispatch.lead_with(own_threads);
        self.tell_all(&Message::Begin, &bytes);
        Ok(())
    }

    /// A pass begins that brings pixels from `from` to `to` samples.
    pub(in super::super) fn begin_pass(&mut self, from: u32, to: u32, ways: Ways) {
        self.pass = PASSES.fetch_add(1, Ordering::Relaxed) + 1;
        self.dispatch.begin_pass();
        self.stopped = None;
        self.tell_all(&Message::Pass { number: self.pass, from, to, ways }, &[]);
    }

    /// Takes tiles back, and gives new ones. It is called often while a pass is rendered.
    pub(in super::super) fn serve(&mut self, pass: &Pass) {
        while let Some((helper, event)) = self.link.receive() {
            match event {
                Event::Lost(why) => self.lose(helper, &why, pass),
                Event::Message(bytes) => self.hear(helper, &bytes, pass),
            }
        }
        pass.check_time();
        if pass.is_stopped() {
            self.stop(pass);
        } else {
            // Each has one before one has two.
            let peers = self.link.peers();
            for helper in (0..MOST_BATCHES).flat_map(|_| 0..peers) {
                self.give(helper, pass);
            }
            if pass.left() == 0 {
                // They become a pass of their own, of which late answers of this one are no part.
                let taken = self.dispatch.take_over(self.now());
                pass.abandoned.fetch_add(taken, Ordering::AcqRel);
            }
        }
        pass.out.store(self.dispatch.out(), Ordering::Release);
    }

    /// The pass is at its end: who still has a tile that another one has brought is told that it is not wanted.
    pub(in super::super) fn end_pass(&mut self) {
        self.tell_busy();
    }

    fn hear(&mut self, helper: usize, bytes: &[u8], pass: &Pass) {
        match Message::read(bytes) {
            Ok((Message::Hello { threads }, _)) => self.dispatch.greet(helper, threads as usize),
            Ok((Message::Failed { reason }, _)) => self.lose(helper, &reason, pass),
            Ok((Message::Done { pass: number, tiles, is_complete, rays, first }, beside)) => {
                let numbers: Vec<usize> = tiles.iter().map(|(tile, _)| *tile as usize).collect();
                // A batch of an earlier pass is that of a helper that was late, and nobody waits for it.
                let numbers = if number == self.pass { numbers } else { Vec::new() };
                let wanted = self.dispatch.take_back(helper, self.now(), &numbers);
                // Only what is wanted of this pass can be replayed, and only what is in the picture.
                let first = if wanted.is_empty() { Vec::new() } else { first };
                let is_inside = |&(_, y, x): &(u32, u32, u32)| pass.film().has_pixel([x, y]);
                let first: Vec<_> = first.into_iter().filter(is_inside).collect();
                if !fill(pass.film(), &tiles, beside, &wanted) {
                    pass.abandoned.fetch_add(wanted.len(), Ordering::AcqRel);
                    return self.lose(helper, "it has sent tiles that no render comes to", pass);
                }
                pass.count_done(if is_complete { wanted.len() } else { 0 }, rays, &first);
                if !is_complete && !wanted.is_empty() && !pass.is_stopped() {
                    // It was stopped by itself.
                    pass.abandoned.fetch_add(wanted.len(), Ordering::AcqRel);
                    self.lose(helper, "it was stopped", pass);
                }
            }
            Ok(_) | Err(_) => self.lose(helper, "it has sent what is no message", pass),
        }
    }

    fn lose(&mut self, helper: usize, why: &str, pass: &Pass) {
        let abandoned = self.dispatch.lose(helper);
        pass.abandoned.fetch_add(abandoned, Ordering::AcqRel);
        self.notes.push(format!("helper {} was lost, and others did its work: {why}", helper + 1));
    }

    fn give(&mut self, helper: usize, pass: &Pass) {
        let now = self.now();
        let tiles = self.dispatch.give(helper, now, pass.left(), || pass.claim());
        if tiles.is_empty() {
            return;
        }
        let mut beside = Vec::new();
        let mut list = Vec::new();
        for tile in tiles {
            if let Some(goals) = &pass.goals {
                let pixels = pass.film().pixels_of_tile(tile);
                pixels.for_each(|pixel| beside.extend(goals[pixel].to_le_bytes()));
            }
            list.push((tile as u32, pass.film().put_tile(tile, &mut beside)));
        }
        let message = Message::Tiles { pass: self.pass, tiles: list, goals: pass.goals.is_some() };
        self.link.send(helper, message.bytes(&beside));
    }

    /// Tells helpers to stop, and gives up those that do not answer.
    fn stop(&mut self, pass: &Pass) {
        match self.stopped {
            None => {
                self.stopped = Some(Instant::now());
                self.tell_busy();
            }
            Some(since) if since.elapsed() > PATIENCE => {
                let silent: Vec<_> = self.dispatch.busy().collect();
                for helper in silent {
                    self.lose(helper, "it did not answer", pass);
                }
            }
            Some(_) => {}
        }
    }

    fn tell_busy(&mut self) {
        let busy: Vec<_> = self.dispatch.busy().collect();
        for helper in busy {
            self.link.send(helper, Message::Stop { pass: self.pass }.bytes(&[]));
        }
    }

    /// A run is at its end. Returns what is to be said about helpers that were lost.
    pub(in super::super) fn end_run(&mut self) -> Vec<String> {
        // Some may still be preparing what is no longer needed.
        self.tell_all(&Message::Stop { pass: self.pass }, &[]);
        std::mem::take(&mut self.notes)
    }
}

impl Drop for Crew<'_> {
    fn drop(&mut self) {
        // Nobody is to finish what is no longer needed.
        self.tell_all(&Message::Stop { pass: self.pass }, &[]);
        self.tell_all(&Message::End, &[]);
    }
}

/// Fills the tiles that are `wanted` of a batch; `false` where the bytes are not those of tiles.
fn fill(film: &Arc<Film>, tiles: &[(u32, bool)], mut beside: &[u8], wanted: &[usize]) -> bool {
    for (tile, has_samples) in tiles {
        let tile = *tile as usize;
        if tile >= film.tile_count() {
            return false;
        }
        if !has_samples {
            continue;
        }
        let Some((bytes, rest)) = beside.split_at_checked(film.tile_bytes(tile)) else { return false };
        beside = rest;
        if wanted.contains(&tile) && film.get_tile(tile, bytes).is_none() {
            return false;
        }
    }
    beside.is_empty()
}
