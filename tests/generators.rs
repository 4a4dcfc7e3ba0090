//! Generated scenes: counts, closedness, determinism.

use dacrt::scene::generators::{NAMES, generate};
use dacrt::{Mesh, Triangle};
use glam::{DVec3, Vec3};
use std::collections::{HashMap, HashSet};

const SIZES: [usize; 16] = [
    10, 11, 12, 13, 20, 37, 64, 100, 333, 1000, 3001, 8000, 20_000, 100_000, 250_001, 1_000_000,
];

fn made(name: &str, triangles: usize, seed: u64) -> Mesh {
    generate(name, triangles, seed).unwrap()
}

/// FNV-1a over the bytes of the corners.
fn fingerprint(mesh: &Mesh) -> u64 {
    mesh.triangles()
        .iter()
        .flat_map(|t| [t.a, t.b, t.c])
        .flat_map(|p| p.to_array())
        .flat_map(|x| x.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |h, byte| {
            (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

/// The bits of a position, 0 and −0 being the same.
fn key(p: Vec3) -> [u32; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

fn corners(t: &Triangle) -> [Vec3; 3] {
    [t.a, t.b, t.c]
}

fn area(t: &Triangle) -> f64 {
    let [a, b, c] = corners(t).map(|p| p.as_dvec3());
    (b - a).cross(c - a).length() / 2.0
}

#[test]
fn counts_are_those_asked_for() {
    for name in NAMES {
        for size in SIZES {
            let expected = if name == "relief" { size / 2 * 2 } else { size };
            assert_eq!(made(name, size, 1).len(), expected, "{name} of {size}");
        }
        assert_eq!(made(name, 0, 1).len(), 10, "{name}");
    }
    assert!(generate("Hall", 100, 1).is_none());
}

/// Takes some seconds and 2 GB.
#[test]
#[ignore = "large"]
fn thirty_million_triangles() {
    for name in NAMES {
        let mesh = made(name, 30_000_000, 1);
        assert_eq!(mesh.len(), 30_000_000, "{name}");
        assert_eq!(mesh.dropped(), 0, "{name}");
        if name != "soup" {
            assert!(mesh.triangles().iter().all(|t| area(t) > 0.0), "{name}");
        }
    }
}

#[test]
fn same_bits_everywhere() {
    let mut found = Vec::new();
    for name in NAMES {
        for size in [1000, 100_000] {
            found.push((name, size, fingerprint(&made(name, size, 1))));
        }
    }
    let expected = [("hall", 1000, 0)];
    assert_eq!(found, expected, "{found:x?}");
}

#[test]
fn seed_counts() {
    for name in NAMES {
        let [one, same, two] = [1, 1, 2].map(|seed| fingerprint(&made(name, 20_000, seed)));
        assert_eq!(one, same, "{name}");
        assert_ne!(one, two, "{name}");
    }
}

#[test]
fn all_triangles_are_valid_and_within_the_stated_space() {
    for name in NAMES {
        for size in SIZES {
            let mesh = made(name, size, 3);
            assert_eq!(mesh.dropped(), 0, "{name} of {size}");
            let bounds = mesh.bounds();
            let (min, max) = match name {
                "hall" => (Vec3::new(-1.5, -0.01, -12.0), Vec3::new(54.1, 16.5, 12.0)),
                _ => (Vec3::splat(-1.7), Vec3::splat(1.7)),
            };
            assert!(
                bounds.min.cmpge(min).all() && bounds.max.cmple(max).all(),
                "{name} of {size}: {bounds:?}"
            );
            assert!(
                bounds.diagonal() > 0.5 * (max - min).length() / 1.7,
                "{name} of {size}"
            );
        }
    }
}

#[test]
fn hall_and_relief_have_no_degenerate_and_no_duplicate_triangles() {
    for name in ["hall", "relief"] {
        for size in SIZES {
            let mesh = made(name, size, 5);
            let mut seen = HashMap::new();
            for (i, t) in mesh.triangles().iter().enumerate() {
                assert!(area(t) > 0.0, "{name} of {size}: {i} {t:?}");
                let mut k = corners(t).map(key);
                k.sort();
                assert!(k[0] != k[1] && k[1] != k[2], "{name} of {size}: {i} {t:?}");
                if let Some(j) = seen.insert(k, i) {
                    panic!("{name} of {size}: {j} and {i} are {t:?}");
                }
            }
        }
    }
}

#[test]
fn relief_is_a_closed_sphere() {
    for size in (10..400).chain(SIZES) {
        let mesh = made("relief", size, size as u64);
        // How often each edge is passed from its lesser to its greater end, and back.
        let mut edges: HashMap<_, [u32; 2]> = HashMap::new();
        let mut vertices = HashSet::new();
        for t in mesh.triangles() {
            let k = corners(t).map(key);
            vertices.extend(k);
            for (p, q) in [(k[0], k[1]), (k[1], k[2]), (k[2], k[0])] {
                edges.entry((p.min(q), p.max(q))).or_default()[usize::from(p > q)] += 1;
            }
        }
        assert!(edges.values().all(|&e| e == [1, 1]), "relief of {size}");
        assert_eq!(
            vertices.len() + mesh.len(),
            edges.len() + 2,
            "relief of {size}"
        );
    }
}

#[test]
fn relief_faces_outward_and_its_triangles_are_alike() {
    let mesh = made("relief", 100_000, 1);
    let mut longest: Vec<f64> = Vec::new();
    for t in mesh.triangles() {
        let [a, b, c] = corners(t).map(|p| p.as_dvec3());
        assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        longest.push(a.distance(b).max(b.distance(c)).max(c.distance(a)));
    }
    longest.sort_by(f64::total_cmp);
    let (least, most) = (longest[0], longest[longest.len() - 1]);
    assert!(most < 12.0 * least, "{least} to {most}");
}

#[test]
fn soup_sizes_spread_over_orders_of_magnitude() {
    let mesh = made("soup", 1_000_000, 1);
    let mut sizes: Vec<f64> = mesh.triangles().iter().map(|t| area(t).sqrt()).collect();
    sizes.sort_by(f64::total_cmp);
    let share = |s: f64| sizes[(s * (sizes.len() - 1) as f64) as usize];
    assert!(share(1.0) / share(0.001) > 1e3);
    assert!(
        share(0.999) / share(0.1) > 20.0,
        "{} {}",
        share(0.999),
        share(0.1)
    );
}
