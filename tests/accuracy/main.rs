//! Hard cases with known answers, and how near to them the library comes.
//!
//! `cargo test --test accuracy` tries every case with small numbers of rays and samples; `make accuracy` with large ones,
//! and prints the tables, which `docs/accuracy-tables.md` holds and `docs/accuracy.md` counts. Each case fails alone, so that
//! a name is a filter, as with any test.

#[path = "../common/mod.rs"]
mod common;
use common::stats;

mod record;
mod table;

mod arithmetic;
mod bsdf;
mod intersection;
mod leaving;
mod light_paths;
mod lights;
mod media;
mod mirrors;
mod motion;
mod photometry;
mod photons;
mod radiosity;
mod reuse;
mod sampling;
mod spectra;
mod textures;
mod transport;

use std::process::ExitCode;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use libtest_mimic::{Arguments, Failed, Trial};
use record::{Case, Entry};

/// The groups in the order of the document, with their names there.
fn groups() -> Vec<(&'static str, Vec<Entry>)> {
    vec![
        ("intersection", intersection::cases()),
        ("leaving", leaving::cases()),
        ("bsdf", bsdf::cases()),
        ("lights", lights::cases()),
        ("sampling", sampling::cases()),
        ("transport", transport::cases()),
        ("reuse", reuse::cases()),
        ("light_paths", light_paths::cases()),
        ("mirrors", mirrors::cases()),
        ("photons", photons::cases()),
        ("radiosity", radiosity::cases()),
        ("media", media::cases()),
        ("textures", textures::cases()),
        ("motion", motion::cases()),
        ("photometry", photometry::cases()),
        ("spectra", spectra::cases()),
        ("arithmetic", arithmetic::cases()),
    ]
}

fn main() -> ExitCode {
    // Tables that were edited by hand are counted without trying their cases.
    if std::env::var("ETENDUE_WRITE").is_ok_and(|what| what == "front") {
        return match table::write_front() {
            Ok(()) => ExitCode::SUCCESS,
            Err(message) => {
                eprintln!("{message}");
                ExitCode::FAILURE
            }
        };
    }
    let is_full = std::env::var("ETENDUE_ACCURACY").is_ok_and(|value| value == "full");
    let mut arguments = Arguments::from_args();
    if is_full {
        // Times are taken.
        arguments.test_threads = Some(1);
    }
    let found = Arc::new(Mutex::new(table::Table::default()));
    let mut trials = Vec::new();
    for (group, entries) in groups() {
        for (place, entry) in entries.into_iter().enumerate() {
            let found = Arc::clone(&found);
            let name = format!("{group}::{} {}", entry.id, entry.title);
            trials.push(Trial::test(name, move || {
                let mut case = Case::new(&entry, is_full);
                let started = Instant::now();
                (entry.run)(&mut case);
                let seconds = started.elapsed().as_secs_f64();
                let failures = case.failures();
                found.lock().expect("no case panics while it holds this").add(group, place, case, seconds);
                failures.map_or(Ok(()), |failures| Err(Failed::from(failures)))
            }));
        }
    }
    // A run that writes the document makes it true.
    if std::env::var_os("ETENDUE_WRITE").is_none() {
        trials.push(Trial::test("document::front page", || table::check_front().map_err(Failed::from)));
    }
    // A group's own name as the filter is enough to write its table.
    let one = std::env::var("ETENDUE_WRITE").ok().map(|group| format!("{group}::"));
    let is_one = one.is_some() && arguments.filter == one;
    let is_whole = (arguments.filter.is_none() || is_one) && arguments.skip.is_empty() && !arguments.list;
    let conclusion = libtest_mimic::run(&arguments, trials);
    let table = found.lock().expect("no case panics while it holds this");
    if !arguments.list {
        print!("{}", table.to_text(is_full));
    }
    if is_whole && let Err(message) = table.check_document(is_full) {
        eprintln!("{message}");
        return ExitCode::FAILURE;
    }
    conclusion.exit_code()
}
