//! Generated scenes: counts, closedness, determinism.

use dacrt::scene::generators::{NAMES, generate};
use dacrt::{Mesh, Triangle};
use glam::Vec3;
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
    // Where the hall changes its form.
    for size in (10..1000).chain((1000..10_000).step_by(37)) {
        assert_eq!(made("hall", size, 1).len(), size, "hall");
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
    let expected = [
        ("hall", 1_000, 0xabbad33cef1a8781),
        ("hall", 100_000, 0x06f8a3d7ba9306b0),
        ("relief", 1_000, 0x3962c12849e3692c),
        ("relief", 100_000, 0x9098b1d69701565f),
        ("soup", 1_000, 0x7b44ff485c2d0b4d),
        ("soup", 100_000, 0x640e3d920b2ea2da),
    ];
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
                "hall" => (Vec3::new(-1.0, 0.0, -11.5), Vec3::new(54.5, 16.4, 11.5)),
                _ => (Vec3::splat(-1.7), Vec3::splat(1.7)),
            };
            assert!(
                bounds.min.cmpge(min).all() && bounds.max.cmple(max).all(),
                "{name} of {size}: {bounds:?}"
            );
            assert!(
                bounds.diagonal() > 0.5 * (max - min).length(),
                "{name} of {size}"
            );
        }
    }
}

#[test]
fn hall_and_relief_have_no_degenerate_and_no_duplicate_triangles() {
    for name in ["hall", "relief"] {
        for size in SIZES.into_iter().filter(|&size| size <= 250_001) {
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
    assert!(share(1.0) / share(0.001) > 300.0);
    assert!(
        share(0.999) / share(0.1) > 20.0,
        "{} {}",
        share(0.999),
        share(0.1)
    );
}

/// How far a ray gets, by brute force in float64.
fn free_way(mesh: &Mesh, origin: Vec3, direction: Vec3) -> f64 {
    let (o, d) = (origin.as_dvec3(), direction.as_dvec3().normalize());
    let way = |t: &Triangle| {
        let [a, b, c] = corners(t).map(|p| p.as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        let s = o - a;
        let q = s.cross(e1);
        let (u, v) = (s.dot(p) / det, d.dot(q) / det);
        let t = e2.dot(q) / det;
        let hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0;
        if hit { t } else { f64::INFINITY }
    };
    mesh.triangles()
        .iter()
        .map(way)
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn camera_and_light_of_the_hall_stand_free_inside_it() {
    let json = include_str!("../../scenes/hall.json");
    let (eye, look_at) = (Vec3::new(2.0, 2.6, 0.6), Vec3::new(30.0, 5.2, 0.0));
    let light = Vec3::new(24.3, 11.0, 0.4);
    assert!(json.contains(r#""eye": [2, 2.6, 0.6], "look_at": [30, 5.2, 0]"#));
    assert!(json.contains(r#""position": [24.3, 11, 0.4]"#));
    for size in [100, 1000, 4000, 20_000, 200_000] {
        let mesh = made("hall", size, 1);
        for x in [-1.05, 0.03, 0.95] {
            for y in [-1.0, 0.02, 1.1] {
                for z in [-1.1, -0.1, 0.9] {
                    let direction = Vec3::new(x, y, z);
                    let way = free_way(&mesh, eye, direction);
                    assert!(
                        (1.5..60.0).contains(&way),
                        "{size}: {way} along {direction}"
                    );
                    let way = free_way(&mesh, light, direction);
                    assert!(
                        (1.5..60.0).contains(&way),
                        "{size}: {way} along {direction}"
                    );
                }
            }
        }
        let ahead = free_way(&mesh, eye, look_at - eye);
        assert!(ahead > 15.0, "{size}: {ahead}");
        let to_light = light - eye;
        let way = free_way(&mesh, eye, to_light);
        assert!(way > f64::from(to_light.length()), "{size}: light hidden");
    }
}
