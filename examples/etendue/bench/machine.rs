//! The machine on which a benchmark ran.

use std::fs;
use std::thread;

use etendue::scene::Scene;

use super::results::Machine;

/// The machine as the system describes it; `scene` gives the version of the ray kernel.
pub fn describe(scene: &Scene) -> Machine {
    let [major, minor, patch] = scene.device().version();
    Machine {
        cpu: cpu().unwrap_or_else(|| "unknown processor".to_owned()),
        logical_cores: thread::available_parallelism().map_or(1, usize::from),
        os: os(),
        renderer: renderer(),
        embree: format!("{major}.{minor}.{patch}"),
        build: build(),
    }
}

/// Name and version of this renderer.
pub fn renderer() -> String {
    format!("etendue {}", env!("CARGO_PKG_VERSION"))
}

/// Resets the maximum of [`crate::console::peak_memory`] where the system supports that (Linux); returns whether it
/// did.
pub fn reset_peak_memory() -> bool {
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

fn cpu() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn os() -> String {
    let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
    let name = release.lines().find_map(|line| line.strip_prefix("PRETTY_NAME="));
    let name = name.map_or(std::env::consts::OS, |name| name.trim_matches('"'));
    format!("{name}, {}", std::env::consts::ARCH)
}

fn build() -> String {
    let features = [
        ("sse4.2", cfg!(target_feature = "sse4.2")),
        ("avx", cfg!(target_feature = "avx")),
        ("avx2", cfg!(target_feature = "avx2")),
        ("fma", cfg!(target_feature = "fma")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("neon", cfg!(target_feature = "neon")),
    ];
    let features: Vec<_> = features.iter().filter(|(_, there)| *there).map(|(name, _)| *name).collect();
    let profile = if cfg!(debug_assertions) { "with debug assertions" } else { "optimised" };
    let features = if features.is_empty() { "baseline instructions".to_owned() } else { features.join(" ") };
    format!("{profile}, {features}")
}
