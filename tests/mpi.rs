//! The program for clusters: processes that MPI starts render the picture that one process renders, bit for bit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

#[path = "common/program.rs"]
mod program;

use program::{built, program};
use tempfile::TempDir;

fn mpi_program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| built("etendue-mpi"))
}

/// A command that starts so many processes, each with one thread.
fn mpirun(processes: u32, folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new("mpirun");
    // More processes than cores, also as root, and messages in shared memory where the kernel lets no process read another's.
    let settings = [
        ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
        ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
        ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
        ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"),
        ("OMPI_MCA_hwloc_base_binding_policy", "none"),
        ("OMPI_MCA_btl_vader_single_copy_mechanism", "none"),
    ];
    command.envs(settings).current_dir(folder).args(["-n", &processes.to_string()]).arg(mpi_program()).args(args);
    command.args(["--threads", "1"]).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    path.to_str().expect("a UTF-8 path").to_owned()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// The picture that one process renders.
fn alone(folder: &Path, args: &[&str]) -> Vec<u8> {
    let output = Command::new(program()).current_dir(folder).args(args).args(["-o", "alone.pfm"]).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    fs::read(folder.join("alone.pfm")).unwrap()
}

#[test]
fn any_number_of_processes_renders_the_same_picture() {
    let folder = folder();
    for (name, more) in [
        ("room.json", &["--spp", "8"][..]),
        ("caustic-glass.json", &["--spp", "4", "--integrator", "sppm", "--photons", "4000"]),
        ("materials.json", &["--target-error", "0.05"]),
    ] {
        let scene = scene(name);
        let args: Vec<&str> = ["render", &scene, "--resolution", "80x60"].iter().chain(more).copied().collect();
        let expected = alone(folder.path(), &args);
        for (processes, how) in [(1, &[][..]), (2, &["--scene-per-rank"]), (4, &[])] {
            let args: Vec<&str> = args.iter().chain(&["-o", "together.pfm"]).chain(how).copied().collect();
            let output = mpirun(processes, folder.path(), &args).output().unwrap();
            assert!(output.status.success(), "{processes}: {}", said(&output));
            assert!(!said(&output).contains("helper"), "{}", said(&output));
            let together = fs::read(folder.path().join("together.pfm")).unwrap();
            assert!(together == expected, "{name} by {processes} processes");
        }
    }
}

#[test]
fn what_is_wrong_is_said_once() {
    let folder = folder();
    let room = scene("room.json");
    for (args, what) in [
        (&["render", "none.json", "-o", "a.png"][..], "none.json"),
        (&["render", &room, "-o", "a.txt"], "a.txt"),
        (&["render", &room, "--spp", "x", "-o", "a.png"], "--spp"),
        (
            &["render", &room, "--integrator", "path", "--spectral", "--spectral-layers", "8", "-o", "a.exr"],
            "etendue for",
        ),
        (&["render", &room, "--frames", "1-3", "-o", "a#.png"], "nothing in the scene moves"),
        // The first process knows it only when the others wait for tiles.
        (&["render", &room, "--integrator", "sppm", "--reuse", "-o", "a.png"], "reuse"),
    ] {
        let output = mpirun(3, folder.path(), args).output().unwrap();
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
        assert_eq!(said.lines().filter(|line| line.starts_with("error")).count(), 1, "{args:?}: {said}");
        assert!(said.contains(what), "{args:?}: {said}");
        assert!(fs::read_dir(folder.path()).unwrap().next().is_none(), "{args:?} has left a file");
    }
}

#[test]
fn frames_are_rendered_by_all() {
    let folder = folder();
    let scene = scene("motion-blur.json");
    let args = ["render", &scene, "--resolution", "40x30", "--spp", "4", "--frames", "3-4", "-o", "together#.pfm"];
    let output = mpirun(2, folder.path(), &args).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let mut args = args;
    args[9] = "alone#.pfm";
    let output = Command::new(program()).current_dir(folder.path()).args(args).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    for number in [3, 4] {
        let [one, other] =
            ["alone", "together"].map(|name| fs::read(folder.path().join(format!("{name}{number}.pfm"))).unwrap());
        assert!(one == other, "frame {number}");
    }
}

/// Waits for a process, for a while.
fn ended(child: Child) -> Output {
    let id = child.id();
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || sender.send(child.wait_with_output()));
    match receiver.recv_timeout(Duration::from_secs(120)) {
        Ok(output) => output.unwrap(),
        Err(_) => {
            let _ = Command::new("kill").args(["-9", &id.to_string()]).status();
            panic!("it does not end");
        }
    }
}

/// The processes that a process has started.
#[cfg(target_os = "linux")]
fn children(of: u32) -> Vec<u32> {
    let list = fs::read_to_string(format!("/proc/{of}/task/{of}/children")).unwrap_or_default();
    list.split_whitespace().filter_map(|id| id.parse().ok()).collect()
}

#[cfg(target_os = "linux")]
fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "{} is not written", path.display());
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_process_that_is_killed_leaves_a_checkpoint_from_which_any_number_goes_on() {
    let folder = folder();
    let scene = scene("room.json");
    let args = ["render", &scene, "--resolution", "80x60", "--spp", "100000", "-o", "a.pfm"];
    let keep = ["--checkpoint", "state", "--checkpoint-every", "0.2"];
    let child = mpirun(3, folder.path(), &[&args[..], &keep].concat()).spawn().unwrap();
    let state = folder.path().join("state");
    wait_for(&state);
    // The process with the greatest number is of the last rank.
    let last = children(child.id()).into_iter().max().expect("processes that render");
    assert!(Command::new("kill").args(["-9", &last.to_string()]).status().unwrap().success());
    let output = ended(child);
    assert!(!output.status.success());
    let said = said(&output);
    assert!(said.contains("rank") && said.contains('9'), "{said}");
    // What is there is a state from which two processes go on, and so does one.
    let few = ["render", &scene, "--resolution", "80x60", "--spp", "16", "-o"];
    let go_on = ["--checkpoint", "more", "--resume", "state"];
    let output = mpirun(2, folder.path(), &[&few[..], &["b.pfm"], &go_on].concat()).output().unwrap();
    assert!(output.status.success(), "{}", self::said(&output));
    let output =
        Command::new(program()).current_dir(folder.path()).args(few).args(["c.pfm", "--resume", "state"]).output();
    assert!(output.unwrap().status.success());
    let [two, one] = ["b.pfm", "c.pfm"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(two == one);
}

#[cfg(target_os = "linux")]
#[test]
fn a_signal_stops_all_with_what_there_is() {
    let folder = folder();
    let scene = scene("room.json");
    let args = ["render", &scene, "--resolution", "80x60", "--spp", "1000000", "-o", "a.pfm", "--checkpoint", "state"];
    let child = mpirun(2, folder.path(), &[&args[..], &["--checkpoint-every", "0.2"]].concat()).spawn().unwrap();
    wait_for(&folder.path().join("state"));
    let first = children(child.id()).into_iter().min().expect("processes that render");
    assert!(Command::new("kill").args(["-TERM", &first.to_string()]).status().unwrap().success());
    let output = ended(child);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("stopped after"), "{said}");
    assert!(folder.path().join("a.pfm").exists());
}
