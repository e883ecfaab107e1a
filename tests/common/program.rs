//! The command line programs, for tests that run them.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The program `etendue`, built for the same profile as this test.
#[allow(dead_code, reason = "each test runs its own program")]
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| built("etendue"))
}

/// An example, built for the same profile as this test. It may not be there yet, or an outdated one
/// may.
pub fn built(example: &str) -> PathBuf {
    // target/<profile>/deps/cli-<hash>
    let test = std::env::current_exe().expect("the path of this test");
    let profile = test.ancestors().nth(2).expect("the folder of the profile");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into()));
    cargo.args(["build", "--quiet", "--example", example, "--manifest-path"]);
    cargo.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"));
    // The folder of the development profile has another name than its profile.
    match profile.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => {}
        Some(name) => _ = cargo.args(["--profile", name]),
    }
    // The features are those of this test, so that existing build results are used again.
    let features =
        [("capi", cfg!(feature = "capi")), ("mpi", cfg!(feature = "mpi")), ("schema", cfg!(feature = "schema"))];
    for (feature, is_on) in features {
        if is_on {
            cargo.args(["--features", feature]);
        }
    }
    assert!(cargo.status().expect("cargo").success(), "the example does not build");
    let program = profile.join("examples").join(format!("{example}{}", std::env::consts::EXE_SUFFIX));
    assert!(program.is_file(), "{} is missing", program.display());
    program
}
