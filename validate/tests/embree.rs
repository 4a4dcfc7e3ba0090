//! Embree as the reference: every build quality, query and mode against float64, and the
//! conventions on which all comparisons rest.

use dacrt::rays::MISS;
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use dacrt_validate::embree::{Device, Lanes, Quality, Query, Scene, mxcsr};
use embree4_sys as sys;
use glam::{DVec3, Vec3};

/// Numbers in `[-1, 1)`, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// All ways to ask Embree for the hits of one mesh, with one thread and with three.
fn for_all(mesh: &Mesh, mut check: impl FnMut(&Scene, Query, &str)) {
    for threads in [1, 3] {
        let device = Device::new(threads).unwrap();
        for robust in [false, true] {
            for quality in Quality::ALL {
                let scene = Scene::build(&device, mesh, quality, robust).unwrap();
                for query in queries() {
                    let what = format!(
                        "{} {} robust={robust}, {threads} threads",
                        quality.name(),
                        query.name()
                    );
                    check(&scene, query, &what);
                }
            }
        }
    }
}

/// Ray by ray, and packets of all widths.
fn queries() -> Vec<Query> {
    let widths = [Lanes::Four, Lanes::Eight, Lanes::Sixteen];
    let packets = widths.map(|lanes| [Query::Packet(lanes), Query::CoherentPacket(lanes)]);
    std::iter::once(Query::Single)
        .chain(packets.into_iter().flatten())
        .collect()
}

fn nearest(scene: &Scene, batch: &Batch, query: Query) -> Hits {
    // What was there before must not shine through.
    let mut hits = Hits {
        t: vec![f32::NAN; batch.len()],
        prim: vec![7; batch.len()],
    };
    scene.nearest(batch, query, &mut hits);
    hits
}

fn any(scene: &Scene, batch: &Batch, query: Query) -> Vec<u8> {
    let mut occluded = vec![9; batch.len()];
    scene.any(batch, query, &mut occluded);
    occluded
}

/// Nearest hit in float64, or `None` if the ray passes an edge, or its interval ends at a
/// triangle, so closely that float32 may see it otherwise.
fn brute_force(triangles: &[Triangle], ray: Ray) -> Option<(f64, u32)> {
    const CLOSE: f64 = 1e-3;
    let mut best = (f64::INFINITY, MISS);
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    for (prim, triangle) in (0..).zip(triangles) {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
        let (e1, e2, s): (DVec3, DVec3, DVec3) = (b - a, c - a, o - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        let u = s.dot(p) / det;
        let v = d.dot(s.cross(e1)) / det;
        let t = e2.dot(s.cross(e1)) / det;
        let inside = u.min(v).min(1.0 - u - v);
        if inside.abs() < CLOSE {
            return None;
        }
        if inside < 0.0 {
            continue;
        }
        let ends = [f64::from(ray.tmin), f64::from(ray.tmax), best.0];
        if ends.iter().any(|end| (t - end).abs() < CLOSE) {
            return None;
        }
        if f64::from(ray.tmin) < t && t <= f64::from(ray.tmax) && t < best.0 {
            best = (t, prim);
        }
    }
    Some(best)
}

/// 300 triangles and 5,003 rays (two blocks for threads), every seventh of them invalid, some with short intervals.
fn soup() -> (Mesh, Batch) {
    let mut random = Random(1);
    let triangle = |random: &mut Random| {
        let center = random.point();
        let mut corner = || center + 0.2 * random.point();
        Triangle::new(corner(), corner(), corner())
    };
    let mesh = Mesh::new((0..300).map(|_| triangle(&mut random)).collect());
    let ray = |i: usize| Ray {
        origin: 1.5 * random.point(),
        direction: random.point(),
        tmin: if i % 7 == 3 {
            -1.0
        } else {
            0.3 * (i % 2) as f32
        },
        tmax: if i.is_multiple_of(3) {
            1.0
        } else {
            f32::INFINITY
        },
    };
    (mesh, (0..5_003).map(ray).collect())
}

/// Packets wider than Embree's vectors are traced ray by ray, which made its times of coherent rays on
/// processors with AVX2 twice those of its packets of 8.
#[test]
fn packets_are_as_wide_as_embrees_vectors() {
    let widths = [
        (
            sys::RTCDeviceProperty::NATIVE_RAY16_SUPPORTED,
            Lanes::Sixteen,
        ),
        (sys::RTCDeviceProperty::NATIVE_RAY8_SUPPORTED, Lanes::Eight),
        (sys::RTCDeviceProperty::NATIVE_RAY4_SUPPORTED, Lanes::Four),
    ];
    // SAFETY: the device is alive until it is released, and the calls read numbers.
    let widest = unsafe {
        let device = sys::rtcNewDevice(c"threads=1,start_threads=0".as_ptr());
        let mut native = widths
            .into_iter()
            .filter(|&(p, _)| sys::rtcGetDeviceProperty(device, p) != 0);
        let widest = native.next();
        sys::rtcReleaseDevice(device);
        widest
    };
    let (_, lanes) = widest.expect("Embree is built with packets");
    assert_eq!(Device::new(1).unwrap().queries(), Query::all(lanes));
}

#[test]
fn all_ways_find_what_float64_finds() {
    let (mesh, batch) = soup();
    let expected: Vec<_> = batch
        .iter()
        .map(|ray| match ray.is_valid() {
            true => brute_force(mesh.triangles(), ray),
            false => Some((f64::INFINITY, MISS)),
        })
        .collect();
    let clear = expected.iter().flatten().count();
    let hits = expected.iter().flatten().filter(|e| e.1 != MISS).count();
    assert!(clear > 2_000 && hits > 500, "{clear} clear, {hits} hits");
    for_all(&mesh, |scene, query, what| {
        let hits = nearest(scene, &batch, query);
        let occluded = any(scene, &batch, query);
        for (i, expected) in expected.iter().enumerate() {
            let Some((t, prim)) = *expected else { continue };
            assert_eq!(hits.prim[i], prim, "ray {i}, {what}");
            assert_eq!(occluded[i], u8::from(prim != MISS), "ray {i}, {what}");
            if prim == MISS {
                assert_eq!(hits.t[i], f32::INFINITY, "ray {i}, {what}");
            } else {
                let error = (f64::from(hits.t[i]) - t).abs() / t;
                assert!(error < 1e-5, "ray {i}, {what}: t off by {error}");
            }
        }
    });
}

#[test]
fn any_hit_says_whether_there_is_a_nearest_one() {
    let (mesh, batch) = soup();
    for_all(&mesh, |scene, query, what| {
        let hits = nearest(scene, &batch, query);
        let hit: Vec<_> = hits.prim.iter().map(|&p| u8::from(p != MISS)).collect();
        assert_eq!(any(scene, &batch, query), hit, "{what}");
    });
}

#[test]
fn packed_batches_hit_the_same_again_and_again() {
    let (mesh, batch) = soup();
    for_all(&mesh, |scene, query, what| {
        let expected = nearest(scene, &batch, query).hit_count();
        let mut packed = scene.pack(&batch, query);
        for _ in 0..3 {
            scene.trace_packed(&mut packed, true);
            packed.reset();
            scene.trace_packed(&mut packed, false);
            assert_eq!(packed.hit_count(), expected, "{what}");
            packed.reset();
        }
    });
}

/// A triangle around the z axis.
fn wall(z: f32) -> Triangle {
    Triangle::new(
        Vec3::new(-8.0, -8.0, z),
        Vec3::new(8.0, -8.0, z),
        Vec3::new(0.0, 8.0, z),
    )
}

/// A ray along the z axis.
fn along_z(tmin: f32, tmax: f32) -> Ray {
    Ray {
        tmin,
        tmax,
        ..Ray::new(Vec3::ZERO, Vec3::Z)
    }
}

#[test]
fn the_interval_is_open_below_and_closed_above() {
    let mesh = Mesh::new(vec![wall(2.0)]);
    let cases = [
        (along_z(0.0, 2.0), true),
        (along_z(0.0, 2.0_f32.next_down().next_down()), false),
        (along_z(2.0, f32::INFINITY), false),
        (along_z(2.0_f32.next_down().next_down(), 4.0), true),
        (along_z(0.0, f32::MAX), true),
        (along_z(-0.0, f32::INFINITY), true),
    ];
    let at_wall = Ray::new(Vec3::new(0.0, 0.0, 2.0), Vec3::Z);
    let batch: Batch = cases.map(|c| c.0).into_iter().chain([at_wall]).collect();
    for_all(&mesh, |scene, query, what| {
        let occluded = any(scene, &batch, query);
        let hits = nearest(scene, &batch, query);
        for (i, (_, expected)) in cases.iter().enumerate() {
            assert_eq!(hits.prim[i] == 0, *expected, "case {i}, {what}");
            assert_eq!(occluded[i] == 1, *expected, "case {i}, {what}");
        }
        assert_eq!(hits.prim[cases.len()], MISS, "t = 0, {what}");
        assert_eq!(occluded[cases.len()], 0, "t = 0, {what}");
    });
}

#[test]
fn invalid_rays_miss() {
    let mesh = Mesh::new(vec![wall(2.0), wall(-2.0)]);
    let mut rays = vec![
        along_z(1.0, 1.0),
        along_z(3.0, 1.0),
        along_z(-1.0, 5.0),
        along_z(f32::NAN, 5.0),
        along_z(0.0, f32::NAN),
        along_z(0.0, f32::NEG_INFINITY),
        along_z(f32::INFINITY, f32::INFINITY),
        Ray::new(Vec3::ZERO, Vec3::ZERO),
        Ray::new(Vec3::ZERO, -Vec3::ZERO),
    ];
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            // Not `odd * axis`, which is NaN everywhere.
            let odd = Vec3::select(axis.cmpeq(Vec3::ONE), Vec3::splat(odd), Vec3::ZERO);
            rays.push(Ray::new(odd, Vec3::Z));
            rays.push(Ray::new(Vec3::ZERO, Vec3::Z + odd));
        }
    }
    // Whole packets of them, and some beside a ray that hits.
    let mut all = [rays.clone(), rays.clone()].concat();
    all.push(along_z(0.0, f32::INFINITY));
    all.extend(rays);
    let batch: Batch = all.iter().copied().collect();
    for_all(&mesh, |scene, query, what| {
        let hits = nearest(scene, &batch, query);
        let occluded = any(scene, &batch, query);
        for (i, ray) in all.iter().enumerate() {
            let expected = if ray.is_valid() { (0, 1) } else { (MISS, 0) };
            assert_eq!((hits.prim[i], occluded[i]), expected, "{ray:?}, {what}");
            assert_eq!(hits.t[i].is_finite(), ray.is_valid(), "{ray:?}, {what}");
        }
        assert_eq!(hits.hit_count(), 1, "{what}");
    });
}

#[test]
fn dropped_triangles_keep_their_numbers() {
    let mut nan = wall(1.0);
    nan.b.y = f32::NAN;
    let mut infinite = wall(1.0);
    infinite.c.x = f32::NEG_INFINITY;
    let mut large = wall(1.0);
    large.a.x = -1.844e18;
    let point = Triangle::new(Vec3::Z, Vec3::Z, Vec3::Z);
    let mesh = Mesh::new(vec![nan, infinite, large, point, wall(3.0), nan, wall(2.0)]);
    assert_eq!(mesh.dropped(), 4);
    let batch: Batch = [along_z(0.0, f32::INFINITY), along_z(2.5, f32::INFINITY)]
        .into_iter()
        .collect();
    for_all(&mesh, |scene, query, what| {
        assert_eq!(nearest(scene, &batch, query).prim, [6, 4], "{what}");
        assert_eq!(any(scene, &batch, query), [1, 1], "{what}");
    });
}

#[test]
fn nothing_to_hit_and_nothing_to_trace() {
    let batch: Batch = [along_z(0.0, f32::INFINITY); 17].into_iter().collect();
    for_all(&Mesh::default(), |scene, query, what| {
        assert_eq!(nearest(scene, &batch, query), Hits::misses(17), "{what}");
        assert_eq!(any(scene, &batch, query), [0; 17], "{what}");
    });
    for_all(&Mesh::new(vec![wall(1.0)]), |scene, query, what| {
        let none = Batch::default();
        assert!(nearest(scene, &none, query).is_empty(), "{what}");
        assert!(any(scene, &none, query).is_empty(), "{what}");
        scene.trace_packed(&mut scene.pack(&none, query), false);
    });
}

#[test]
fn info_names_the_library_in_use() {
    let device = Device::new(2).unwrap();
    let info = device.info();
    eprintln!("{info:?}");
    assert!(info.version.starts_with("4."), "{info:?}");
    assert!(info.library.starts_with("libembree4"), "{info:?}");
    assert!(!info.library.contains('/'), "{info:?}");
    assert!(["avx512", "avx2", "avx", "sse"].contains(&info.isa.as_str()));
    assert_eq!(info.threads, 2);
    assert!(Device::new(0).unwrap().info().threads >= 1);
}

#[test]
fn bytes_are_those_of_the_scene_alone() {
    let (mesh, _) = soup();
    let device = Device::new(1).unwrap();
    let build = |mesh: &Mesh| Scene::build(&device, mesh, Quality::Medium, false).unwrap();
    let alone = build(&mesh);
    let beside = build(&mesh);
    assert_eq!(alone.bytes(), beside.bytes());
    assert!(alone.bytes() > 48 * mesh.len(), "{}", alone.bytes());
    assert!(build(&Mesh::default()).bytes() < alone.bytes());
}

#[test]
fn embree_leaves_the_control_register_alone() {
    let before = mxcsr();
    let (mesh, batch) = soup();
    for_all(&mesh, |scene, query, what| {
        nearest(scene, &batch, query);
        any(scene, &batch, query);
        assert_eq!(mxcsr(), before, "{what}");
    });
}
