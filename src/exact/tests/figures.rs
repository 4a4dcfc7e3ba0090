//! Times, for the documentation: `cargo test --release --lib figures -- --ignored --nocapture`.

use super::{Pair, pair};
use crate::exact::area::decide;
use crate::exact::estimate::Estimates;
use crate::exact::{Meeting, has_area, meet, whole};
use crate::kernels::Kernels;
use crate::scene::Scene;
use crate::simd::Isa;
use crate::{Batch, Ray, Triangle, random};
use glam::Vec3;
use std::hint::black_box;
use std::time::Instant;

/// Prints the nanoseconds of a call, the least of some rounds over all items.
fn time<T>(what: &str, items: &[T], mut call: impl FnMut(&T)) {
    let mut least = f64::INFINITY;
    for _ in 0..7 {
        let start = Instant::now();
        items.iter().for_each(&mut call);
        least = least.min(start.elapsed().as_secs_f64());
    }
    println!(
        "{what}: {:.1} ns ({} items)",
        least * 1e9 / items.len() as f64,
        items.len()
    );
}

#[test]
#[ignore = "measures"]
fn pairs_one_at_a_time() {
    for (family, name) in [
        "one size",
        "grid",
        "aimed",
        "mixed scales",
        "small",
        "large",
        "all exponents",
    ]
    .into_iter()
    .enumerate()
    {
        let pairs: Vec<Pair> = (0..2000).map(|i| pair(family as u32, i)).collect();
        println!("{name}");
        let estimate = |p: &Pair| Estimates::new(p.origin, p.direction, &p.triangle).meets();
        let (open, told): (Vec<Pair>, Vec<Pair>) =
            pairs.iter().partition(|p| estimate(p).is_none());
        let call = |p: &Pair| {
            black_box(meet(p.origin, p.direction, &p.triangle));
        };
        time("  meet, told by float64", &told, call);
        time("  meet, left open", &open, call);
        time("  meet in whole numbers", &pairs, |p| {
            black_box(whole::meets(p.origin, p.direction, &p.triangle));
        });
        let met: Vec<Meeting> = pairs
            .iter()
            .filter_map(|p| meet(p.origin, p.direction, &p.triangle))
            .collect();
        time("  rounded", &met, |m| {
            black_box(m.rounded());
        });
        time("  rounded in whole numbers", &met, |m| {
            black_box(m.exact().rounded());
        });
        time("  cmp of equals in whole numbers", &met, |m| {
            black_box(m.exact().cmp(&m.exact()));
        });
        time("  cmp_t in whole numbers", &met, |m| {
            black_box(m.exact().cmp_f32(1.5));
        });
        time("  has_area", &pairs, |p| {
            black_box(has_area(&p.triangle));
        });
        let lines: Vec<Triangle> = pairs
            .iter()
            .map(|p| {
                Triangle::new(
                    p.triangle.a,
                    p.triangle.b,
                    0.5 * p.triangle.a + 0.5 * p.triangle.b,
                )
            })
            .collect();
        time("  has_area of slivers", &lines, |t| {
            black_box(has_area(t));
        });
    }
}

#[test]
#[ignore = "measures"]
fn a_million_coherent_hits() {
    // A relief of 512 by 512 squares below 1024 by 1024 rays.
    const SIDE: usize = 512;
    let height = |x: usize, y: usize| {
        Vec3::new(
            x as f32,
            y as f32,
            random::unit_f64(random::hash(1, x as u64, y as u64)) as f32,
        )
    };
    let mut triangles = Vec::new();
    for y in 0..SIDE {
        for x in 0..SIDE {
            let [a, b, c, d] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| height(x + i, y + j));
            triangles.extend([Triangle::new(a, b, c), Triangle::new(d, c, b)]);
        }
    }
    let mut batch = Batch::default();
    let mut prim = Vec::new();
    for y in 0..2 * SIDE {
        for x in 0..2 * SIDE {
            let (px, py) = (0.5 * x as f32 + 0.2, 0.5 * y as f32 + 0.1);
            let origin = Vec3::new(300.0, 200.0, 900.0);
            batch.push(Ray::new(origin, Vec3::new(px, py, 0.5) - origin));
            let upper = px.fract() + py.fract() > 1.0;
            prim.push(2 * ((py as usize) * SIDE + px as usize) as u32 + u32::from(upper));
        }
    }
    let mut t = vec![0.0; prim.len()];
    for isa in Isa::available() {
        let kernel = Kernels::of(isa).round_hits;
        time(&format!("round_hits of a million, {isa}"), &[()], |()| {
            // SAFETY: the processor was checked.
            unsafe { kernel(&batch, 0, &triangles, &prim, &mut t) }
        });
    }
}

#[test]
#[ignore = "measures"]
fn areas_of_a_scene() {
    let Some(folder) = std::env::var_os("DACRT_MESHES") else {
        return println!("notice: DACRT_MESHES is not set");
    };
    for name in ["conference", "sibenik"] {
        let json =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.json"));
        let scene = Scene::load(&json, &[folder.clone().into()]).unwrap();
        let triangles = scene.mesh.triangles();
        let (with, without): (Vec<Triangle>, Vec<Triangle>) =
            triangles.iter().partition(|t| has_area(t));
        for (what, triangles) in [("with", &with), ("without", &without)] {
            time(&format!("{name} {what} area"), triangles, |t| {
                black_box(has_area(t));
            });
            let open = triangles.iter().filter(|t| decide(t).is_none()).count();
            println!("left open: {open}");
        }
    }
}
