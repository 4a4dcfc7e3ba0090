//! Finds Embree 4, links to it, and hands its folder to direct dependents as `DEP_EMBREE4_LIBDIR`.
//!
//! Searched in this order: `EMBREE_DIR` (alone, if it is set), the folder `.embree` of this
//! repository that `scripts/embree` fills, the system's library folders.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=EMBREE_DIR");
    match find() {
        Ok(library) => link(&library),
        Err(message) => println!("cargo::error={message}"),
    }
}

fn find() -> Result<PathBuf, String> {
    let embree_dir = env::var_os("EMBREE_DIR").filter(|dir| !dir.is_empty());
    if let Some(dir) = embree_dir {
        let dir = PathBuf::from(dir);
        let folders = [dir.join("lib"), dir.join("lib64"), dir.clone()];
        return library_in(&folders).ok_or_else(|| {
            format!(
                "EMBREE_DIR is {}, but neither it nor its lib or lib64 holds libembree4{}; \
                 set it to the folder of an Embree 4, or unset it and run scripts/dacrt",
                dir.display(),
                too_old(&folders),
            )
        });
    }
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let arch = env::var("CARGO_CFG_TARGET_ARCH").expect("cargo sets it");
    let folders = [
        manifest.join("../../.embree"),
        PathBuf::from(format!("/usr/lib/{arch}-linux-gnu")),
        PathBuf::from("/usr/lib64"),
        PathBuf::from("/usr/lib"),
        PathBuf::from("/usr/local/lib64"),
        PathBuf::from("/usr/local/lib"),
        PathBuf::from("/opt/homebrew/lib"),
    ];
    library_in(&folders).ok_or_else(|| {
        format!(
            "Embree 4 not found{}; run scripts/dacrt once, which fetches it into the folder \
             .embree, or set EMBREE_DIR to the folder of an Embree 4",
            too_old(&folders),
        )
    })
}

fn library_in(folders: &[PathBuf]) -> Option<PathBuf> {
    folders.iter().find_map(|dir| named_in(dir, "libembree4"))
}

/// A file of `dir` whose name starts with `stem` and is that of a shared library.
/// Of several the first by name, so that the choice does not depend on the file system.
fn named_in(dir: &Path, stem: &str) -> Option<PathBuf> {
    let dir = dir.canonicalize().ok()?;
    let entries = fs::read_dir(&dir).ok()?;
    entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.starts_with(stem))
        .filter(|name| name.contains(".so") || name.ends_with(".dylib"))
        .map(|name| dir.join(name))
        .filter(|path| path.is_file())
        .min()
}

fn too_old(folders: &[PathBuf]) -> String {
    let old = folders.iter().find_map(|dir| named_in(dir, "libembree3"));
    old.map_or_else(String::new, |path| {
        format!(" (too old: {})", path.display())
    })
}

fn link(library: &Path) {
    let dir = library.parent().expect("a file has a folder");
    let name = library.file_name().expect("a file has a name");
    println!("cargo::rerun-if-changed={}", library.display());
    println!("cargo::rustc-link-search=native={}", dir.display());
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        // By its full name: without the -dev package there is no plain libembree4.so, and the
        // Python wheel's library has a hash in its name.
        let name = name.to_string_lossy();
        println!("cargo::rustc-link-lib=dylib:+verbatim={name}");
    } else {
        println!("cargo::rustc-link-lib=dylib=embree4");
    }
    println!("cargo::metadata=LIBDIR={}", dir.display());
    // For this crate's own tests; dependents do the same.
    for arg in ["-rpath", &dir.to_string_lossy()] {
        println!("cargo::rustc-link-arg=-Xlinker");
        println!("cargo::rustc-link-arg={arg}");
    }
}
