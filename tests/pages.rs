//! Manual pages and completions are what the command line says. `ETENDUE_WRITE=1 cargo test --test pages` writes them
//! anew.

// The grammar is a part of the program; the rest of what the program does with it is not looked at here.
#[path = "../examples/etendue/args.rs"]
#[allow(dead_code)]
mod args;

use std::path::{Path, PathBuf};
use std::{env, fs};

use clap::CommandFactory;
use clap_complete::Shell;

/// Each file with its text: the pages of the program and of its commands, and a completion for each shell.
fn pages() -> Vec<(PathBuf, String)> {
    // `etendue help` has no page of its own to refer to.
    let mut command = args::Cli::command().disable_help_subcommand(true);
    command.build();
    let mut pages = Vec::new();
    let commands = command.get_subcommands().map(|sub| {
        let name: &'static str = format!("etendue-{}", sub.get_name()).leak();
        sub.clone().name(name).display_name(name)
    });
    for page in std::iter::once(command.clone()).chain(commands) {
        let page = page.version(env!("CARGO_PKG_VERSION"));
        let path = PathBuf::from("docs/man").join(format!("{}.1", page.get_name()));
        let mut text = Vec::new();
        clap_mangen::Man::new(page).manual("Étendue").render(&mut text).expect("a page in memory");
        pages.push((path, text));
    }
    for (shell, name) in [(Shell::Bash, "etendue.bash"), (Shell::Zsh, "_etendue"), (Shell::Fish, "etendue.fish")] {
        let mut text = Vec::new();
        clap_complete::generate(shell, &mut args::Cli::command(), "etendue", &mut text);
        pages.push((Path::new("packaging/completions").join(name), text));
    }
    pages.into_iter().map(|(path, text)| (path, String::from_utf8(text).expect("UTF-8"))).collect()
}

#[test]
fn manual_and_completions_are_what_the_program_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (path, text) in pages() {
        let file = root.join(&path);
        if env::var_os("ETENDUE_WRITE").is_some() {
            fs::create_dir_all(file.parent().expect("a folder")).expect("a folder for the page");
            fs::write(&file, &text).expect("the page can be written");
        }
        let there = fs::read_to_string(&file).unwrap_or_default();
        // Reported by name alone: the texts are long.
        assert!(there == text, "{} is not what the program says: write it with ETENDUE_WRITE=1", path.display());
    }
}

#[test]
fn every_option_is_in_the_manual() {
    let pages = pages();
    for (name, sub) in [
        ("render", "etendue-render.1"),
        ("convert", "etendue-convert.1"),
        ("merge", "etendue-merge.1"),
        ("info", "etendue-info.1"),
        ("photons", "etendue-photons.1"),
        ("bake", "etendue-bake.1"),
        ("lux", "etendue-lux.1"),
        ("compare", "etendue-compare.1"),
        ("bench", "etendue-bench.1"),
    ] {
        let (_, text) = pages.iter().find(|(path, _)| path.ends_with(sub)).expect("a page for each command");
        let text = text.replace("\\-", "-");
        let command = args::Cli::command();
        let options = command.find_subcommand(name).expect("the command").get_arguments();
        for long in options.filter_map(clap::Arg::get_long) {
            assert!(text.contains(&format!("--{long}")), "--{long} is not in {sub}");
        }
    }
}
