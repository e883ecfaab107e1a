//! The command line: renders a scene file to image files, converts scenes, prints properties of a scene, writes and draws
//! photons, bakes light maps, calculates illuminance and luminance, compares images, measures time and error.
//!
//! `cargo run --release --example etendue -- render scenes/cornell.json -o cornell.exr`; docs/cli.md is the manual. The
//! program uses only what any other host could use.

mod args;
mod bake;
mod bench;
mod checkpoint;
mod compare;
mod console;
mod convert;
mod failure;
mod interrupt;
mod layers;
mod lux;
mod photons;
mod render;
mod stats;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::failure::Failure;

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Render(args) => render::render(&args, &mut render::Alone),
        Command::Convert(args) => convert::convert(&args),
        Command::Info(args) => render::info(&args),
        Command::Merge(args) => checkpoint::merge(&args),
        Command::Photons(args) => photons::photons(&args),
        Command::Bake(args) => bake::bake(&args),
        Command::Lux(args) => lux::lux(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Bench(args) => bench::bench(&args),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(failure) => ExitCode::from(failure.say()),
    }
}
