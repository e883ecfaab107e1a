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
mod interrupt;
mod layers;
mod lux;
mod photons;
mod render;
mod stats;

use std::fmt::Display;
use std::process::ExitCode;

use clap::Parser;
use etendue::{Error, ErrorKind};

use crate::args::{Cli, Command};

/// Reason for an early end of the program: message and exit code.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    message: String,
}

impl Failure {
    /// Work began and failed: exit code 1.
    pub fn running(reason: impl Display) -> Self {
        Self { code: 1, message: reason.to_string() }
    }

    /// The command cannot be carried out as given: exit code 2.
    pub fn usage(reason: impl Display) -> Self {
        Self { code: 2, message: reason.to_string() }
    }
}

impl From<Error> for Failure {
    /// For errors before the work begins: the input is at fault, unless the machine is.
    fn from(error: Error) -> Self {
        match error.kind() {
            ErrorKind::Device | ErrorKind::OutOfMemory | ErrorKind::Internal => Self::running(error),
            _ => Self::usage(error),
        }
    }
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Render(args) => render::render(&args),
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
        Err(failure) => {
            console::say(&format!("error: {}", failure.message.replace('\n', " ")));
            ExitCode::from(failure.code)
        }
    }
}
