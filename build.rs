//! Finds Embree, writes Rust declarations for it from the header that is installed, and checks them with the C
//! compiler.
//!
//! The size of Embree's ray structures depends on how the library was configured, so declarations made for another
//! build of it corrupt memory. Hence the header of the very library that is linked is read here, at build time.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::panic;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio, exit};

/// The oldest Embree this crate works with, in the form of the macro `RTC_VERSION`.
const OLDEST: u32 = 40300;

const NO_COMPILER: &str =
    "no C compiler could be started: install build-essential (Debian), or set CC to one that works";

/// The structures whose layout the crate relies on.
const STRUCTS: [&str; 17] = [
    "RTCRay",
    "RTCHit",
    "RTCRayHit",
    "RTCRay8",
    "RTCHit8",
    "RTCRayHit8",
    "RTCRay16",
    "RTCHit16",
    "RTCRayHit16",
    "RTCBounds",
    "RTCRayQueryContext",
    "RTCIntersectArguments",
    "RTCOccludedArguments",
    "RTCBoundsFunctionArguments",
    "RTCIntersectFunctionNArguments",
    "RTCOccludedFunctionNArguments",
    "RTCFilterFunctionNArguments",
];

fn main() {
    for variable in ["EMBREE_DIR", "LIBCLANG_PATH", "CC"] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    println!("cargo::rerun-if-changed=build.rs");

    let prefix = env::var_os("EMBREE_DIR").filter(|dir| !dir.is_empty()).map(PathBuf::from);
    let include = find_header(prefix.as_deref());
    find_library(prefix.as_deref());

    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_else(|| stop("OUT_DIR is not set: build with cargo")));
    let bindings = generate(&include);
    let file = out.join("embree.rs");
    if let Err(error) = fs::write(&file, &bindings) {
        stop(&format!("{} cannot be written: {error}", file.display()));
    }
    check_layout(&bindings, &include, &out);
}

/// Ends the build with one sentence and nothing else.
fn stop(message: &str) -> ! {
    eprintln!("etendue: {message}");
    exit(1)
}

/// The include folder that holds `embree4/rtcore.h` of a version that will do.
fn find_header(prefix: Option<&Path>) -> PathBuf {
    let folders: Vec<PathBuf> = match prefix {
        Some(prefix) => vec![prefix.join("include")],
        None => vec!["/usr/local/include".into(), "/usr/include".into(), "/opt/homebrew/include".into()],
    };
    let mut found: Option<u32> = None;
    for folder in &folders {
        let config = folder.join("embree4/rtcore_config.h");
        // A file that is missing counts as changed, each time: then every build would start anew.
        if config.is_file() {
            println!("cargo::rerun-if-changed={}", config.display());
        }
        let Some(version) = fs::read_to_string(&config).ok().and_then(|text| header_version(&text)) else { continue };
        if version >= OLDEST && folder.join("embree4/rtcore.h").is_file() {
            println!("cargo::metadata=include={}", folder.display());
            return folder.clone();
        }
        found = found.max(Some(version));
    }
    let seen = match found {
        Some(version) => format!(" (only {}.{}.{})", version / 10_000, version / 100 % 100, version % 100),
        None => String::new(),
    };
    match prefix {
        Some(prefix) => stop(&format!(
            "EMBREE_DIR={} holds no include/embree4/rtcore.h of Embree 4.3 or newer{seen}: point it at an unpacked \
             Embree, or unset it and install libembree-dev (Debian 13)",
            prefix.display()
        )),
        None => stop(&format!(
            "Embree 4.3 or newer was not found{seen}: install libembree-dev (Debian 13), run `make setup`, or set \
             EMBREE_DIR to an unpacked Embree"
        )),
    }
}

/// The value of the macro `RTC_VERSION`.
fn header_version(text: &str) -> Option<u32> {
    text.lines().find_map(|line| line.strip_prefix("#define RTC_VERSION ")?.trim().parse().ok())
}

/// Tells cargo what to link with and where it is.
fn find_library(prefix: Option<&Path>) {
    let name = match env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("macos") => "libembree4.dylib",
        Ok("windows") => "embree4.lib",
        _ => "libembree4.so",
    };
    let folder = match prefix {
        Some(prefix) => ["lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu"]
            .iter()
            .map(|folder| prefix.join(folder))
            .find(|folder| folder.join(name).is_file()),
        None => system_library(name),
    };
    let Some(folder) = folder else {
        match prefix {
            Some(prefix) => stop(&format!(
                "EMBREE_DIR={} holds no {name} in lib, lib64 or lib/x86_64-linux-gnu: point it at an unpacked Embree",
                prefix.display()
            )),
            None => stop(&format!(
                "Embree's header is there, but {name} is not: install libembree-dev (Debian 13), run `make setup`, or \
                 set EMBREE_DIR to an unpacked Embree"
            )),
        }
    };
    println!("cargo::rerun-if-changed={}", folder.join(name).display());
    println!("cargo::rustc-link-lib=dylib=embree4");
    println!("cargo::metadata=lib_dir={}", folder.display());
    // Only a folder the linker does not know by itself is named: naming a system one could put it before others.
    if prefix.is_some() {
        println!("cargo::rustc-link-search=native={}", folder.display());
        if env::var("CARGO_CFG_TARGET_FAMILY").as_deref() == Ok("unix") {
            println!("cargo::rustc-link-arg=-Wl,-rpath,{}", folder.display());
        }
    }
}

/// The folder in which the C compiler's linker finds `name`.
fn system_library(name: &str) -> Option<PathBuf> {
    let compiler = compiler();
    if !compiler.is_like_msvc() {
        let Ok(output) = compiler.to_command().arg(format!("-print-file-name={name}")).output() else {
            stop(NO_COMPILER)
        };
        if let Ok(path) = fs::canonicalize(String::from_utf8_lossy(&output.stdout).trim()) {
            return path.parent().map(Path::to_owned);
        }
    }
    ["/usr/local/lib", "/usr/lib64", "/usr/lib", "/opt/homebrew/lib"]
        .iter()
        .map(PathBuf::from)
        .find(|folder| folder.join(name).is_file())
}

fn compiler() -> cc::Tool {
    let build = cc::Build::new().cargo_metadata(false).warnings(false).try_get_compiler();
    build.unwrap_or_else(|_| stop(NO_COMPILER))
}

/// Rust declarations of everything whose name starts with rtc or RTC.
fn generate(include: &Path) -> String {
    let header = include.join("embree4/rtcore.h");
    let Ok(rust) = bindgen::RustTarget::stable(88, 0) else { stop("this version of bindgen knows no Rust 1.88") };
    let builder = bindgen::Builder::default()
        .rust_target(rust)
        .header(header.to_string_lossy())
        .clang_arg(format!("-I{}", include.display()))
        .allowlist_function("rtc.*")
        .allowlist_type("RTC.*")
        .allowlist_var("RTC.*")
        .prepend_enum_name(false)
        .generate_comments(false)
        .layout_tests(true)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .formatter(bindgen::Formatter::None);
    // The binding generator panics where it finds no libclang; the trace of that would bury the one useful sentence.
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let outcome = panic::catch_unwind(panic::AssertUnwindSafe(|| builder.generate()));
    panic::set_hook(hook);
    match outcome {
        Ok(Ok(bindings)) => bindings.to_string(),
        Ok(Err(error)) => {
            let reason = error.to_string();
            let first = reason.lines().next().unwrap_or("no reason given");
            stop(&format!("{} cannot be read with libclang ({first}): install libclang-dev (Debian)", header.display()))
        }
        Err(_) => stop(
            "libclang was not found, and Embree's header is read with it: install libclang-dev (Debian), run `make \
             setup`, or set LIBCLANG_PATH to the folder that holds libclang.so",
        ),
    }
}

/// Has the C compiler confirm every size, alignment and offset that the declarations rest on.
fn check_layout(bindings: &str, include: &Path, out: &Path) {
    let mut source = String::from("#include <stddef.h>\n#include <embree4/rtcore.h>\n");
    let mut count = 0;
    // Each claim has the form  ["Size of RTCRay"][...size_of::<RTCRay>() - 48usize].
    for claim in bindings.split("[\"").skip(1) {
        let Some((label, rest)) = claim.split_once("\"]") else { continue };
        let value = rest.split_once("usize").and_then(|(before, _)| before.rsplit([' ', '-']).next());
        let Some(value) = value.and_then(|digits| digits.parse::<usize>().ok()) else { continue };
        let expression = if let Some(name) = label.strip_prefix("Size of ") {
            STRUCTS.contains(&name).then(|| format!("sizeof(struct {name})"))
        } else if let Some(name) = label.strip_prefix("Alignment of ") {
            STRUCTS.contains(&name).then(|| format!("_Alignof(struct {name})"))
        } else if let Some(field) = label.strip_prefix("Offset of field: ") {
            field
                .split_once("::")
                .filter(|(name, _)| STRUCTS.contains(name))
                .map(|(name, field)| format!("offsetof(struct {name}, {field})"))
        } else {
            None
        };
        if let Some(expression) = expression {
            let _ = writeln!(source, "_Static_assert({expression} == {value}, \"{label}\");");
            count += 1;
        }
    }
    // A generator that words its claims differently would leave nothing to check.
    if count < 2 * STRUCTS.len() {
        stop("the declarations made from Embree's header carry no layout claims: this version of bindgen will not do");
    }
    let file = out.join("layout.c");
    if let Err(error) = fs::write(&file, source) {
        stop(&format!("{} cannot be written: {error}", file.display()));
    }
    let compiler = compiler();
    let mut command = compiler.to_command();
    if compiler.is_like_msvc() {
        command.arg("/std:c11").arg("/Zs");
    } else {
        command.arg("-std=c11").arg("-fsyntax-only");
    }
    command.arg(format!("-I{}", include.display())).arg(&file);
    let Ok(output) = command.stdin(Stdio::null()).output() else { stop(NO_COMPILER) };
    if !output.status.success() {
        let reason = String::from_utf8_lossy(&output.stderr);
        let first = reason.lines().find(|line| line.contains("error")).unwrap_or("no reason given").trim();
        stop(&format!(
            "libclang and the C compiler {} disagree about the layout of Embree's structures ({first}): set CC and \
             LIBCLANG_PATH to a matching pair",
            describe(&compiler.to_command())
        ));
    }
}

fn describe(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}
