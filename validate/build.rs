//! Sets the run path of the binary and the tests to the folder of the Embree that `embree4-sys`
//! found. A build script can pass linker arguments to its own package only, so this one is needed.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let dir = env::var("DEP_EMBREE4_LIBDIR").expect("embree4-sys is a direct dependency");
    for arg in ["-rpath", &dir] {
        println!("cargo::rustc-link-arg=-Xlinker");
        println!("cargo::rustc-link-arg={arg}");
    }
}
