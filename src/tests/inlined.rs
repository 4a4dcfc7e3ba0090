//! No vector operation is a call.
//!
//! A function or closure that is not inlined into its `#[target_feature]` shell loses the
//! instruction set, and each operation in it becomes a call: right, but three to ten times slower.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use dacrt::*;
use std::process::Command;

#[test]
fn no_vector_operation_is_a_call() {
    // So that the kernels are in this binary.
    let (mesh, batch) = (Mesh::default(), Batch::default());
    for method in Method::ALL {
        let tracer = Tracer::new(method.parameters());
        let mut workspace = tracer.workspace(0, 0);
        tracer.nearest(&mesh, &batch, &mut workspace, &mut Hits::misses(0));
        tracer.any(&mesh, &batch, &mut workspace, &mut []);
    }

    let this = std::env::current_exe().unwrap();
    let output = match Command::new("nm").arg(this).output() {
        Ok(output) => output,
        Err(error) => return println!("notice: no nm to look for calls of intrinsics: {error}"),
    };
    assert!(output.status.success());
    let symbols = String::from_utf8_lossy(&output.stdout);
    assert!(symbols.contains("avx512") && symbols.contains("prepare_rays"));
    // All operations of `core::arch` on vectors are called _mm….
    let calls: Vec<&str> = symbols
        .lines()
        .filter(|line| line.contains("core_arch") && line.contains("_mm"))
        .collect();
    assert!(calls.is_empty(), "not inlined:\n{}", calls.join("\n"));
}
