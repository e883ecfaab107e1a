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
mod mattes;
mod photons;
mod render;
mod stats;

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::failure::Failure;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(instead) => return ExitCode::from(say_instead(&instead)),
    };
    let outcome = match cli.command {
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

/// Says what is said in place of a command: help, the version, or what is wrong with the arguments. Returns the exit code.
fn say_instead(instead: &clap::Error) -> u8 {
    let code = u8::try_from(instead.exit_code()).unwrap_or(2);
    match instead.print().and_then(|()| io::stdout().flush()) {
        // Who reads the beginning alone has seen what was wanted.
        Err(error) if code == 0 && error.kind() != io::ErrorKind::BrokenPipe => {
            Failure::running(format!("cannot write to standard output: {error}")).say()
        }
        _ => code,
    }
}
