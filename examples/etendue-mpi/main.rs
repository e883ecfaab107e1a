//! The command line for clusters: `render` by several processes, which MPI starts and connects.
//!
//! `mpirun -n 4 etendue-mpi render scenes/cornell.json -o cornell.exr`; docs/cluster.md is the manual. The process of rank 0 leads: it
//! reads the scene, has the film, speaks to the user and writes the images. It is a program of its own, since one that is linked with MPI
//! runs with that MPI alone.

#[allow(dead_code, reason = "other commands have options of their own")]
#[path = "../etendue/args.rs"]
mod args;
#[allow(dead_code, reason = "parts are merged by another command")]
#[path = "../etendue/checkpoint.rs"]
mod checkpoint;
#[allow(dead_code, reason = "other commands say more")]
#[path = "../etendue/console.rs"]
mod console;
#[path = "../etendue/failure.rs"]
mod failure;
#[path = "../etendue/interrupt.rs"]
mod interrupt;
#[path = "../etendue/layers.rs"]
mod layers;
mod link;
#[path = "../etendue/mattes.rs"]
mod mattes;
#[allow(dead_code, reason = "other commands show scenes")]
#[path = "../etendue/render.rs"]
mod render;
mod scene_files;
#[path = "../etendue/stats.rs"]
mod stats;

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::{Args, Parser, Subcommand};
use etendue::desc::{self, SceneDesc};
use etendue::render::{Crew, Progress, Render, RenderSettings, Summary, Workers, help};
use mpi::Threading;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

use crate::args::RenderArgs;
use crate::failure::Failure;
use crate::link::MpiLink;
use crate::render::Runner;

/// Physically based rendering of scene files by the processes that mpirun starts.
///
/// The image has the same bits as that of `etendue`, whatever the number of processes. Exit codes are those of `etendue`.
#[derive(Debug, Parser)]
#[command(name = "etendue-mpi", version, args_override_self = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to image files.
    Render(Box<MpiArgs>),
}

#[derive(Debug, Args)]
struct MpiArgs {
    #[command(flatten)]
    render: RenderArgs,
    /// Each process reads the scene by itself, in place of getting it from the first one.
    #[arg(long)]
    scene_per_rank: bool,
}

/// How long a process that fails waits for the first one to say why all do.
const GRACE: Duration = Duration::from_secs(5);

fn main() -> ExitCode {
    // Workers render, and the main thread alone sends and receives.
    let Some((universe, threading)) = mpi::initialize_with_threading(Threading::Funneled) else {
        console::say("error: MPI cannot be started twice");
        return ExitCode::from(1);
    };
    let world = universe.world();
    let is_leader = world.rank() == 0;
    let code = match Cli::try_parse() {
        // Every process has the same arguments, and one says what is wrong with them.
        Err(error) => {
            if is_leader {
                let _ = error.print();
            }
            u8::try_from(error.exit_code()).unwrap_or(2)
        }
        Ok(_) if threading < Threading::Funneled => {
            console::say("error: this MPI cannot be used by programs with threads");
            1
        }
        Ok(Cli { command: Command::Render(args) }) => {
            let work = || if is_leader { lead(&world, &args) } else { follow(&world, &args) };
            // The others would wait for a process that has panicked.
            catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| world.abort(1))
        }
    };
    ExitCode::from(code)
}

/// Says from the first process to all others whether the next step is taken.
fn agree(world: &SimpleCommunicator, mut goes_on: bool) -> bool {
    world.process_at_rank(0).broadcast_into(&mut goes_on);
    goes_on
}

/// The process of rank 0.
fn lead(world: &SimpleCommunicator, args: &MpiArgs) -> u8 {
    let mut leader =
        Leader { world, link: MpiLink::new(world), args, has_read: false, is_building: false, was_led: false };
    let outcome = if args.render.spectral_layers.is_some() {
        let message =
            "--spectral-layers: these films are rendered by one process, expected the program etendue for them";
        Err(Failure::usage(message))
    } else {
        render::render(&args.render, &mut leader)
    };
    let code = outcome.unwrap_or_else(|failure| failure.say());
    if !leader.has_read {
        // The others wait for a scene.
        agree(world, false);
    } else if leader.is_building {
        // They are building it too, or wait for what to do with it.
        world.abort(code.into());
    }
    code
}

/// The process of rank 0 while it renders.
struct Leader<'w> {
    world: &'w SimpleCommunicator,
    link: MpiLink<'w>,
    args: &'w MpiArgs,
    /// Whether the others know that there is a scene.
    has_read: bool,
    /// Whether the others expect a frame.
    is_building: bool,
    /// Whether the others were led through the present frame.
    was_led: bool,
}

impl Runner for Leader<'_> {
    const HAS_OTHERS: bool = true;

    fn has_read(&mut self, description: &SceneDesc) -> Result<(), Failure> {
        // What cannot be sent must be known before the others expect it.
        let files = if self.args.scene_per_rank { None } else { Some(scene_files::pack(description)?) };
        agree(self.world, true);
        (self.has_read, self.is_building) = (true, true);
        if let Some(files) = files {
            scene_files::send(self.world, &files);
        }
        Ok(())
    }

    fn run(
        &mut self,
        render: &mut Render,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> etendue::Result<Summary> {
        self.was_led = true;
        render.run_with(&mut Crew::new(&mut self.link), progress)
    }

    fn end_frame(&mut self, is_last: bool) {
        if !std::mem::take(&mut self.was_led) {
            // The frame failed before it began: the others are no longer to wait for it.
            drop(Crew::new(&mut self.link));
        }
        self.link.flush();
        agree(self.world, !is_last);
        self.is_building = !is_last;
    }
}

/// A process of another rank.
fn follow(world: &SimpleCommunicator, args: &MpiArgs) -> u8 {
    match assist(world, args) {
        Ok(code) => code,
        Err(failure) => {
            // What is wrong for all, the first process has found too, and says.
            std::thread::sleep(GRACE);
            Failure::running(format!("rank {}: {failure}", world.rank())).say();
            // The others would wait for this process for ever.
            world.abort(1);
        }
    }
}

/// Reads the scene, and helps with each frame of it.
fn assist(world: &SimpleCommunicator, args: &MpiArgs) -> Result<u8, Failure> {
    interrupt::install()?;
    // A signal is for the first process, which tells this one when to stop.
    interrupt::begin();
    if !agree(world, false) {
        return Ok(0);
    }
    let began = Instant::now();
    let render = &args.render;
    let description = if args.scene_per_rank {
        desc::load_with(&render.scene, render.params.as_deref(), &render.choices())?
    } else {
        scene_files::receive(world)?
    };
    let workers = Workers::pool(render.threads)?;
    let mut link = MpiLink::new(world);
    render::for_each_frame(render, description, began, false, |description, scene, number, _| {
        let settings = RenderSettings {
            fingerprint: Some(description.fingerprint()?),
            ..render::settings(render, description, number.is_some(), &workers)
        };
        // Why this process could not help is told to the first one, which says so.
        let _ = help(scene, settings, &mut link);
        link.flush();
        Ok(u8::from(!agree(world, false)))
    })?;
    Ok(0)
}
