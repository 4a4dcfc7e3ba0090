//! Puts the version into the binary, and sets the run path of the binary and the tests to the
//! folder of the Embree that `embree4-sys` found. A build script can pass linker arguments to its
//! own package only, so this one is needed.

use std::env;

#[path = "build/version.rs"]
mod version;

fn main() {
    version::main();
    println!("cargo::rerun-if-changed=build.rs");
    let dir = env::var("DEP_EMBREE4_LIBDIR").expect("embree4-sys is a direct dependency");
    for arg in ["-rpath", &dir] {
        println!("cargo::rustc-link-arg=-Xlinker");
        println!("cargo::rustc-link-arg={arg}");
    }
}
