//! A process that helps with a render.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::super::checkpoint::Checkpoint;
use super::super::pass::Pass;
use super::super::schedule::Schedule;
use super::super::share::Tiles;
use super::super::{Progress, Render, RenderSettings, Workers};
use super::message::Message;
use super::{Event, Link};
use crate::error::{Error, ErrorKind, Result};
use crate::integrator::light_tracing::LightPictures;
use crate::scene::Scene;

/// Time between two looks for messages while there is nothing to do.
const REST: Duration = Duration::from_micros(300);

/// Helps the process at the other end of a link with its render, until that no longer needs help. The image is the leader's.
///
/// `scene` and `settings` must be those of the leader; threads may differ. Of the settings, the time limit, the target error and the
/// plan of checkpoints are left to the leader.
///
/// # Errors
/// The errors of [`Render::resume`] for a render that is not the leader's, [`ErrorKind::Cancelled`] after the settings' cancel was used,
/// [`ErrorKind::Io`] where the leader is lost. The leader is told why, and goes on without this process.
pub fn help(scene: &Scene, settings: RenderSettings, link: &mut dyn Link) -> Result<()> {
    let mut inbox = Inbox { link, waiting: VecDeque::new(), stopped: 0 };
    let outcome = Helper::new(scene, settings).and_then(|helper| helper.work(&mut inbox));
    if let Err(error) = &outcome {
        inbox.send(&Message::Failed { reason: error.to_string() }, &[]);
        if error.kind() != ErrorKind::Cancelled {
            inbox.wait_for_end();
        }
    }
    outcome
}

/// Messages from the leader.
struct Inbox<'l> {
    link: &'l mut dyn Link,
    waiting: VecDeque<Vec<u8>>,
    /// The last pass that was stopped.
    stopped: u64,
}

impl Inbox<'_> {
    fn send(&mut self, message: &Message, beside: &[u8]) {
        self.link.send(0, message.bytes(beside));
    }

    /// Takes messages until the last one: a leader may have begun to send some before it knew that they are for nobody.
    fn wait_for_end(&mut self) {
        while self.look().is_ok() {
            let is_end = |bytes: Vec<u8>| Message::read(&bytes).is_ok_and(|(message, _)| message == Message::End);
            if self.waiting.drain(..).any(is_end) {
                return;
            }
            std::thread::sleep(REST);
        }
    }

    /// Takes what has arrived, and heeds stops at once.
    fn look(&mut self) -> Result<()> {
        while let Some((_, event)) = self.link.receive() {
            match event {
                Event::Lost(why) => {
                    return Err(Error::new(ErrorKind::Io, format!("the process that leads the render is lost: {why}")));
                }
                Event::Message(bytes) => match Message::read(&bytes)?.0 {
                    Message::Stop { pass } => self.stopped = self.stopped.max(pass),
                    _ => self.waiting.push_back(bytes),
                },
            }
        }
        Ok(())
    }
}

/// A helper between two messages.
struct Helper<'s> {
    scene: &'s Scene,
    settings: RenderSettings,
    workers: Workers,
    /// The render as far as this process needs it, and whether it has what the present pass needs.
    render: Option<Render>,
    is_prepared: bool,
    /// Number of samples that pixels have after the present pass.
    goal: u32,
}

impl<'s> Helper<'s> {
    fn new(scene: &'s Scene, settings: RenderSettings) -> Result<Self> {
        let workers = settings.own_workers()?;
        let settings = RenderSettings {
            workers: Some(workers.clone()),
            time_limit: None,
            target_error: None,
            checkpoint: None,
            ..settings
        };
        Ok(Self { scene, settings, workers, render: None, is_prepared: false, goal: 0 })
    }

    fn work(mut self, inbox: &mut Inbox) -> Result<()> {
        inbox.send(&Message::Hello { threads: self.workers.threads() as u32 }, &[]);
        loop {
            inbox.look()?;
            self.settings.cancel.check()?;
            let Some(bytes) = inbox.waiting.pop_front() else {
                std::thread::sleep(REST);
                continue;
            };
            match Message::read(&bytes)? {
                (Message::Begin, beside) => {
                    let state = Checkpoint::read_from(beside)?;
                    let render = Render::resume(self.scene, self.settings.clone(), state).map_err(|error| {
                        let message = format!("this process was to render something else: {error}");
                        Error::new(error.kind(), message).because(error)
                    })?;
                    self.render = Some(render);
                }
                (Message::Pass { number, from, to, ways }, _) => {
                    let render = self.render.as_mut().ok_or_else(unexpected)?;
                    (render.samples, self.goal) = (from, to);
                    render.set_ways(ways);
                    self.prepare(number, inbox)?;
                }
                (Message::Tiles { pass, tiles, goals }, beside) => self.tiles(pass, &tiles, goals, beside, inbox)?,
                (Message::End, _) => return Ok(()),
                (Message::Hello { .. } | Message::Done { .. } | Message::Failed { .. } | Message::Stop { .. }, _) => {
                    return Err(unexpected());
                }
            }
        }
    }

    /// Prepares a pass, unless it is stopped meanwhile.
    fn prepare(&mut self, number: u64, inbox: &mut Inbox) -> Result<()> {
        if inbox.stopped >= number {
            // Others were faster. What a later pass needs of this one is made for it.
            self.is_prepared = false;
            return Ok(());
        }
        let render = self.render.as_mut().ok_or_else(unexpected)?;
        let schedule = Schedule::new(&render.settings, 1, false);
        let mut failure = None;
        let mut heed = |_: &Progress| {
            failure = failure.take().or(inbox.look().err());
            if failure.is_some() || inbox.stopped >= number {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let count = self.goal.saturating_sub(render.samples).min(LightPictures::most_samples(&render.film));
        let mut ended = render.prepare(&schedule, Instant::now(), &mut heed)?;
        if ended.is_none() {
            ended = render.trace_light(count, &schedule, Instant::now(), &mut heed)?;
        }
        self.is_prepared = ended.is_none();
        failure.map_or(Ok(()), Err)
    }

    /// Renders tiles, and sends them back.
    fn tiles(
        &mut self,
        number: u64,
        tiles: &[(u32, bool)],
        has_goals: bool,
        mut beside: &[u8],
        inbox: &mut Inbox,
    ) -> Result<()> {
        let render = self.render.as_ref().ok_or_else(unexpected)?;
        let film = render.film();
        let pixels: usize = film.options().resolution.map(|side| side as usize).iter().product();
        let mut goals = vec![0; if has_goals { pixels } else { 0 }];
        let mut take = |count: usize| {
            let (taken, rest) = beside.split_at_checked(count).ok_or_else(unexpected)?;
            beside = rest;
            Ok::<_, Error>(taken)
        };
        for (tile, has_samples) in tiles {
            let tile = *tile as usize;
            if tile >= film.tile_count() {
                return Err(unexpected());
            }
            if has_goals {
                for pixel in film.pixels_of_tile(tile) {
                    goals[pixel] = take(4)?.try_into().map_or(0, u32::from_le_bytes);
                }
            }
            film.forget_tile(tile);
            if *has_samples {
                film.get_tile(tile, take(film.tile_bytes(tile))?).ok_or_else(unexpected)?;
            }
        }
        let mut pass = Pass::new(render.pass_input(), self.goal, None, self.settings.cancel.clone());
        pass.goals = has_goals.then_some(goals);
        pass.tiles = Tiles::list(tiles.iter().map(|(tile, _)| *tile as usize).collect());
        pass.is_shared = true;
        let mut failure = None;
        let is_stopped = !self.is_prepared || inbox.stopped >= number;
        pass.stop.store(is_stopped, Ordering::Relaxed);
        let pass = self.workers.run(pass, &mut |pass| {
            failure = failure.take().or(inbox.look().err());
            if failure.is_some() || inbox.stopped >= number {
                pass.stop.store(true, Ordering::Relaxed);
            }
        })?;
        if let Some(failure) = failure {
            return Err(failure);
        }
        if let Some(kernel) = self.scene.kernel() {
            kernel.check()?;
        }
        let mut beside = Vec::new();
        let list = tiles.iter().map(|(tile, _)| {
            let has_samples = film.put_tile(*tile as usize, &mut beside);
            film.forget_tile(*tile as usize);
            (*tile, has_samples)
        });
        let done = Message::Done {
            pass: number,
            tiles: list.collect(),
            is_complete: pass.is_complete(),
            rays: pass.rays.load(Ordering::Relaxed),
            first: pass.first_non_finite(),
        };
        inbox.send(&done, &beside);
        Ok(())
    }
}

fn unexpected() -> Error {
    Error::new(ErrorKind::Internal, "what the leader has sent is not as expected")
}
