//! Which ingredients keep rays from passing between triangles.

use dacrt::bench::ingredients::{TRIANGLE_TESTS, TriangleTest};
use dacrt::random::{hash, unit_f64};
use dacrt::*;
use dacrt_validate::exact::Arbiter;
use dacrt_validate::ingredients::{Source, hard, measure, of_rays};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

const RAYS: u64 = 100_000;
const SLICES: usize = 16;
const STACKS: usize = 8;

/// A closed mesh without two triangles in one plane: a sphere around the origin with dents.
fn sphere() -> Mesh {
    let point = |stack: usize, slice: usize| {
        let (stack, slice) = match stack {
            0 | STACKS => (stack, 0),
            _ => (stack, slice % SLICES),
        };
        let key = (stack * SLICES + slice) as u64;
        let radius = 0.8 + 0.4 * unit_f64(hash(1, key, 0));
        let (down, around) = (
            PI * stack as f64 / STACKS as f64,
            2.0 * PI * slice as f64 / SLICES as f64,
        );
        let ring = down.sin();
        let unit = DVec3::new(ring * around.cos(), ring * around.sin(), down.cos());
        (radius * unit).as_vec3()
    };
    let mut triangles = Vec::new();
    for stack in 0..STACKS {
        for slice in 0..SLICES {
            let corner = |down, along| point(stack + down, slice + along);
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if stack + 1 < STACKS {
                triangles.push(Triangle::new(a, b, c));
            }
            if stack > 0 {
                triangles.push(Triangle::new(a, c, d));
            }
        }
    }
    Mesh::new(triangles)
}

/// Rays to corners and to points of edges.
fn aimed(mesh: &Mesh, origin: impl Fn(u64) -> Vec3) -> Batch {
    let ray = |i| {
        let number = |k| hash(2, i, k);
        let triangle = mesh.triangles()[number(0) as usize % mesh.len()];
        let corners = [triangle.a, triangle.b, triangle.c];
        let (from, to) = (number(1) as usize % 3, number(2) as usize % 3);
        let along = [0.5, unit_f64(number(3))][number(4) as usize % 2];
        let (from, to) = (corners[from].as_dvec3(), corners[to].as_dvec3());
        let target = from + along * (to - from);
        let origin = origin(i);
        Ray::new(origin, (target - origin.as_dvec3()).as_vec3())
    };
    (0..RAYS).map(ray).collect()
}

/// A point of the cube from -1 to 1.
fn point(i: u64) -> Vec3 {
    let at = |k| unit_f64(hash(3, i, k)) as f32 * 2.0 - 1.0;
    Vec3::new(at(0), at(1), at(2))
}

fn test(name: &str) -> &'static TriangleTest {
    let named = TRIANGLE_TESTS.iter().find(|test| test.name == name);
    named.unwrap_or_else(|| panic!("no test is called {name}"))
}

/// Whether each ray hits any triangle, by trying all.
fn hit(name: &str, isa: Isa, rays: &Batch, mesh: &Mesh) -> Vec<bool> {
    let mut t = vec![f32::INFINITY; rays.len()];
    test(name).nearest(isa, rays, mesh.triangles(), &mut t);
    t.iter().map(|t| t.is_finite()).collect()
}

fn traced(precision: Precision, isa: Isa, rays: &Batch, mesh: &Mesh) -> Vec<bool> {
    let tracer = Tracer::new(Method::Nabata2013.parameters())
        .with_precision(precision)
        .with_isa(isa);
    let mut hits = Hits::misses(rays.len());
    let mut workspace = tracer.workspace(rays.len(), mesh.len());
    tracer.nearest(mesh, rays, &mut workspace, &mut hits);
    hits.prim.iter().map(|&prim| prim != MISS).collect()
}

fn misses(hit: &[bool]) -> usize {
    hit.iter().filter(|&&hit| !hit).count()
}

fn fast_isas() -> impl Iterator<Item = Isa> {
    Isa::available().filter(|&isa| isa != Isa::Portable || Isa::best() == isa)
}

/// Woop, Benthin and Wald 2013 need a·b − c·d that is −(c·d − a·b), or at least has its sign.
#[test]
fn plainly_fused_edge_functions_lose_rays_and_those_with_exact_signs_do_not() {
    let mesh = sphere();
    // From within: each ray hits.
    let rays = aimed(&mesh, |i| 0.3 * point(i));
    for isa in fast_isas() {
        let lost = |name| misses(&hit(name, isa, &rays, &mesh));
        assert!(lost("shear, fused") > 0, "{isa}");
        for name in ["shear, separate", "shear, Kahan", "shear, float64"] {
            assert_eq!(lost(name), 0, "{name}, {isa}");
        }
        for precision in [Precision::Watertight, Precision::Exact] {
            assert_eq!(
                misses(&traced(precision, isa, &rays, &mesh)),
                0,
                "{precision}, {isa}"
            );
        }
    }
}

/// The shear rounds corners relative to the origin of the ray: from afar it hits another mesh, whose
/// outline is elsewhere. So `watertight` decides on corners as they are.
#[test]
fn exact_signs_after_a_shear_lose_rays_from_afar_and_watertight_does_not() {
    let mesh = sphere();
    let rays = aimed(&mesh, |i| 1e5 * (point(i) + Vec3::new(1.0, 2.0, 3.0)));
    let arbiter = Arbiter::new(&mesh);
    let expected: Vec<bool> = rays
        .iter()
        .map(|ray| arbiter.nearest(&ray).is_some())
        .collect();
    for isa in fast_isas() {
        let lost = |hit: Vec<bool>| {
            let both = expected.iter().zip(&hit);
            both.filter(|&(&expected, &hit)| expected && !hit).count()
        };
        for name in ["shear, Kahan", "shear, float64"] {
            assert!(lost(hit(name, isa, &rays, &mesh)) > 0, "{name}, {isa}");
        }
        for precision in [Precision::Watertight, Precision::Exact] {
            assert_eq!(
                lost(traced(precision, isa, &rays, &mesh)),
                0,
                "{precision}, {isa}"
            );
        }
    }
}

fn sources() -> Vec<Source> {
    let mesh = sphere();
    let rays = (0..500).map(|i| Ray::new(0.3 * point(i), point(i + 500)));
    let of_sphere = of_rays("sphere", &Arbiter::new(&mesh), &rays.collect(), 1);
    hard(1000, 1).into_iter().chain(of_sphere).collect()
}

#[test]
fn each_kind_of_pair_has_hits_and_misses() {
    for source in sources() {
        let set = measure(&source, Isa::best());
        assert!(set.pairs >= 990, "{}: {}", set.name, set.pairs);
        let share = set.hits as f64 / set.pairs as f64;
        assert!((0.2..0.8).contains(&share), "{}: {share}", set.name);
        assert!(set.box_pairs > 0, "{}", set.name);
    }
}

#[test]
fn errors_are_those_that_each_ingredient_is_known_for() {
    for source in sources() {
        let set = measure(&source, Isa::best());
        let of = |name: &str, record| {
            let mut tests = set.triangle_tests.iter();
            let found = tests.find(|e| e.test == name && e.record == record);
            found.unwrap_or_else(|| panic!("{name}"))
        };
        for name in ["watertight", "exact"] {
            let e = of(name, true);
            assert_eq!((e.lost, e.false_hits), (0, 0), "{}, {name}", set.name);
        }
        let exact = of("exact", true).ulps.clone().unwrap();
        assert!(exact.max <= 0.5 + 1e-6, "{}: {exact:?}", set.name);
        // Ours rejects no hit. Where boxes are flat, those without padding do.
        let boxes = &set.box_tests;
        assert_eq!(boxes[0].exact_t_outside, 0, "{}: {:?}", set.name, boxes[0]);
        if set.name.starts_with("flat") {
            assert!(boxes[1].exact_t_outside > 0, "{}: {:?}", set.name, boxes[1]);
        }
        if set.name.starts_with("far") {
            let median = |name| of(name, false).ulps.clone().unwrap().median;
            assert!(median("e2·q / N·d") > median("fast"), "{}", set.name);
        }
    }
}
