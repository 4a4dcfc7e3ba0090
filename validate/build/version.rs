//! Puts commit, state of the source and compiler version into the binary.

use std::env;
use std::path::Path;
use std::process::Command;

/// Sets `DACRT_COMMIT`, `DACRT_DIRTY` (`true` or `false`), both empty outside a checkout, and
/// `DACRT_RUSTC`.
pub fn main() {
    let commit = output("git", &["rev-parse", "HEAD"]);
    let changes = output("git", &["status", "--porcelain", "--untracked-files=no"]);
    let dirty = match (&commit, changes) {
        (Some(_), Some(changes)) => (!changes.is_empty()).to_string(),
        _ => String::new(),
    };
    let rustc = output(&env::var("RUSTC").expect("set by cargo"), &["--version"]);
    println!(
        "cargo::rustc-env=DACRT_COMMIT={}",
        commit.unwrap_or_default()
    );
    println!("cargo::rustc-env=DACRT_DIRTY={dirty}");
    println!("cargo::rustc-env=DACRT_RUSTC={}", rustc.unwrap_or_default());

    let mut watched: Vec<String> = ["build", "build.rs", "src", "../src", "../Cargo.toml"]
        .map(str::to_owned)
        .into();
    // Written by each commit and checkout.
    watched.extend(output("git", &["rev-parse", "--git-path", "logs/HEAD"]));
    // Cargo runs a build script each time if a file that it watches does not exist.
    for path in watched.iter().filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new(program);
    // A look at the state must not write to the repository.
    command.args(arguments).env("GIT_OPTIONAL_LOCKS", "0");
    let output = command.output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
