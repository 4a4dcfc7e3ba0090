//! Cones against their rays, and against boxes by the test of the paper's appendix in float64.

use super::*;
use crate::kernels::Kernels;
use crate::kernels::Tmax;
use crate::kernels::records::RAYS_AHEAD;
use crate::kernels::slab::SlabBox;
use crate::methods::Precision;
use crate::random::{below, hash, numbers};
use crate::rays::Ray;
use crate::simd::MAX_LANES;
use crate::simd::{Isa, Portable};

/// A direction, all equally likely.
fn direction(number: &mut impl FnMut() -> f64) -> DVec3 {
    loop {
        let v = 2.0 * DVec3::new(number(), number(), number()) - 1.0;
        if (0.01..1.0).contains(&v.length_squared()) {
            return v / v.length();
        }
    }
}

/// A unit vector across another one.
fn across(v: DVec3, number: &mut impl FnMut() -> f64) -> DVec3 {
    loop {
        let w = v.cross(direction(number));
        if w.length() > 0.1 {
            return w / w.length();
        }
    }
}

/// The sine of the angle between an axis and a direction of any length; 2 for the half behind.
fn sine(axis: DVec3, direction: DVec3) -> f64 {
    let (axis, direction) = (axis / axis.length(), direction / direction.length());
    if axis.dot(direction) > 0.0 {
        axis.cross(direction).length()
    } else {
        2.0
    }
}

#[test]
fn outlines_of_the_27_positions_have_none_four_or_six_edges() {
    let mut valid = 0;
    for (position, outline) in OUTLINES.iter().enumerate() {
        let of_axis = [0, 1, 2].map(|axis| position >> (2 * axis) & 3);
        let beyond = of_axis.iter().filter(|&&bits| bits != 0).count();
        let expected = match (of_axis.contains(&3), beyond) {
            (true, _) | (_, 0) => 0,
            (_, 1) => 4,
            _ => 6,
        };
        valid += !of_axis.contains(&3) as usize;
        assert_eq!(outline.len, expected, "position {position}");
        // The edges are those of the box, and one begins where another one ends.
        let edges = &outline.edges[..outline.len];
        for &(from, to) in edges {
            assert_eq!((from ^ to).count_ones(), 1);
            assert_eq!(edges.iter().filter(|next| next.0 == to).count(), 1);
            assert_eq!(edges.iter().filter(|before| before.1 == from).count(), 1);
        }
    }
    assert_eq!(valid, 27);
}

#[test]
fn outlines_have_the_box_on_their_inner_side() {
    let mut number = numbers(1);
    for (position, outline) in OUTLINES.iter().enumerate() {
        let of_axis = [0, 1, 2].map(|axis| position >> (2 * axis) & 3);
        if of_axis.contains(&3) {
            continue;
        }
        for _ in 0..100 {
            // Seen from the coordinate origin.
            let (mut lo, mut hi) = (DVec3::ZERO, DVec3::ZERO);
            for axis in 0..3 {
                let (near, more) = (0.01 + number(), 0.01 + 3.0 * number());
                (lo[axis], hi[axis]) = match of_axis[axis] {
                    0 => (-near, more),
                    1 => (near, near + more),
                    _ => (-near - more, -near),
                };
            }
            let corner = |bits: u8| {
                let at = |axis: usize| {
                    if bits >> axis & 1 == 0 {
                        lo[axis]
                    } else {
                        hi[axis]
                    }
                };
                DVec3::new(at(0), at(1), at(2))
            };
            for &(from, to) in &outline.edges[..outline.len] {
                let out = corner(from).cross(corner(to));
                for bits in 0..8 {
                    let side = out.dot(corner(bits)) / out.length();
                    if bits == from || bits == to {
                        assert!(side.abs() < 1e-12);
                    } else {
                        assert!(
                            side < 0.0,
                            "position {position}, {from} {to}, corner {bits}"
                        );
                    }
                }
            }
        }
    }
}

/// Memory of cones and of the rays' index list.
struct Memory {
    cones: Vec<[f32; 4]>,
    rays: Vec<[u32; 2]>,
    ids: Vec<u32>,
    done: Vec<u64>,
    ray_ids: Vec<u32>,
}

impl Memory {
    fn new(rays: usize) -> Memory {
        let cones = rays / LEAST_PACKET + 1;
        Memory {
            cones: vec![[f32::NAN; 4]; cones],
            rays: vec![[u32::MAX; 2]; cones],
            ids: vec![0; cones + MAX_LANES],
            done: vec![!0; rays / 64 + 2],
            ray_ids: vec![0; rays + RAYS_AHEAD],
        }
    }

    fn cones(&mut self) -> Cones {
        Cones {
            cones: self.cones.as_mut_ptr(),
            rays: self.rays.as_mut_ptr(),
            ids: self.ids.as_mut_ptr(),
            done: self.done.as_mut_ptr(),
        }
    }

    fn rays(&mut self) -> RayRecords {
        RayRecords {
            slabs: std::ptr::null_mut(),
            directions: std::ptr::null_mut(),
            tmin: std::ptr::null(),
            ids: self.ray_ids.as_mut_ptr(),
            shared_origin: Some(Vec3::ZERO),
            special: false,
            least_tmin: 0.0,
            one_tmin: true,
            any_hit: false,
            precision: Precision::Fast,
            tmax: Tmax {
                one: None,
                each: std::ptr::null(),
            },
            scene: Aabb::EMPTY,
        }
    }
}

/// What a pass over a batch has made.
#[derive(Clone, Debug, PartialEq)]
struct Made {
    cones: Vec<[u32; 4]>,
    rays: Vec<[u32; 2]>,
    loose: Vec<u32>,
    done: Vec<bool>,
}

impl Made {
    fn cone(&self, i: usize) -> (DVec3, f64) {
        let [x, y, z, sine] = self.cones[i].map(f32::from_bits);
        (Vec3::new(x, y, z).as_dvec3(), sine as f64)
    }
}

/// The cosine of the widest half-angle here.
fn least_cosine() -> f32 {
    libm::cos(4f64.to_radians()) as f32
}

/// The cones of a batch, which are the same on every instruction set, and keep their promises.
fn made(batch: &Batch) -> Made {
    let n = batch.len();
    let mut first = None;
    for isa in Isa::available() {
        let mut memory = Memory::new(n);
        let (rays, cones) = (memory.rays(), memory.cones());
        // SAFETY: the processor was checked; there is room for the batch.
        let found =
            unsafe { (Kernels::of(isa).prepare_cones)(batch, &rays, &cones, least_cosine()) };
        assert!(
            memory
                .ids
                .iter()
                .take(found.cones)
                .copied()
                .eq(0..found.cones as u32)
        );
        let made = Made {
            cones: memory.cones[..found.cones]
                .iter()
                .map(|cone| cone.map(f32::to_bits))
                .collect(),
            rays: memory.rays[..found.cones].to_vec(),
            loose: memory.ray_ids[..found.loose].to_vec(),
            done: (0..n)
                .map(|i| memory.done[i / 64] >> (i % 64) & 1 == 1)
                .collect(),
        };
        assert_eq!(first.get_or_insert_with(|| made.clone()), &made, "{isa}");
    }
    let made = first.unwrap();
    check(batch, &made);
    made
}

fn check(batch: &Batch, made: &Made) {
    let n = batch.len();
    let mut places = vec![0; n];
    for &id in &made.loose {
        places[id as usize] += 1;
    }
    assert!(made.loose.is_sorted());
    let mut end = 0;
    for (i, &[first, len]) in made.rays.iter().enumerate() {
        assert!(end <= first, "cones are in the order of their rays");
        end = first + len;
        assert!(len <= PACKET as u32 && end as usize <= n);
        assert!(len >= LEAST_PACKET as u32 || end as usize == n);
        let (axis, sine_of_cone) = made.cone(i);
        assert!((axis.length() - 1.0).abs() < 1e-6);
        let mut widest = 0f64;
        for ray in first..end {
            let ray = ray as usize;
            if batch.ray(ray).is_valid() {
                places[ray] += 1;
                widest = widest.max(sine(axis, batch.ray(ray).direction.as_dvec3()));
            }
        }
        assert!(
            widest <= sine_of_cone,
            "cone {i}: {widest:e} {sine_of_cone:e}"
        );
        let tight = widest + 2.0 * TOLERANCE as f64;
        assert!(
            sine_of_cone <= tight,
            "cone {i}: {widest:e} {sine_of_cone:e}"
        );
        assert!((1.0 - widest * widest).sqrt() >= least_cosine() as f64 - 1e-6);
    }
    for (i, ray) in batch.iter().enumerate() {
        assert_eq!(places[i], ray.is_valid() as usize, "ray {i}");
        assert_eq!(made.done[i], !ray.is_valid(), "ray {i}");
    }
}

/// A ray that is not valid, one of each kind.
fn invalid(kind: u64, d: Vec3) -> Ray {
    let ray = Ray::new(Vec3::ZERO, d);
    match kind % 5 {
        0 => Ray { tmin: -1.0, ..ray },
        1 => Ray {
            direction: Vec3::ZERO,
            ..ray
        },
        2 => Ray {
            direction: Vec3::new(1.0, f32::NAN, 0.0),
            ..ray
        },
        3 => Ray {
            origin: Vec3::new(0.0, f32::INFINITY, 0.0),
            ..ray
        },
        _ => Ray {
            direction: Vec3::new(f32::NEG_INFINITY, 1.0, 0.0),
            ..ray
        },
    }
}

#[test]
fn every_ray_is_in_one_cone_or_in_the_list() {
    let (mut cones, mut loose) = (0, 0);
    for seed in 0..200 {
        let mut number = numbers(seed);
        let n = match seed {
            0..70 => seed as usize,
            _ => 64 + (300.0 * number()) as usize,
        };
        let mut d = direction(&mut number);
        // Steps from one ray to the next, jumps, and invalid rays.
        let step = 10f64.powf(-7.0 + 5.0 * number());
        let (jumps, bad) = (
            0.05 * number(),
            [0.0, 0.1, 0.5][below(hash(seed, 1, 0), 3) as usize],
        );
        let batch: Batch = (0..n as u64)
            .map(|i| {
                d = match number() < jumps {
                    true => direction(&mut number),
                    false => d + step * across(d, &mut number),
                };
                let of_length = (d * 10f64.powf(6.0 * number() - 3.0)).as_vec3();
                match number() < bad {
                    true => invalid(i, of_length),
                    false => Ray::new(Vec3::ZERO, of_length),
                }
            })
            .collect();
        let made = made(&batch);
        cones += made.cones.len();
        loose += made.loose.len();
    }
    assert!(cones > 400 && loose > 400, "{cones} {loose}");
}

#[test]
fn narrow_packets_are_cones_of_64_rays() {
    // 2.5 degrees across.
    let batch: Batch = (0..200)
        .map(|i| {
            let (x, y) = ((i % 8) as f32, (i / 8 % 8) as f32);
            Ray::new(Vec3::ZERO, Vec3::new(0.005 * x, 1.0, 0.005 * y - 0.3))
        })
        .collect();
    let made = made(&batch);
    assert_eq!(made.rays, [[0, 64], [64, 64], [128, 64], [192, 8]]);
    assert!(made.loose.is_empty());
}

#[test]
fn wide_packets_are_no_cones() {
    // Neighbours 10 degrees apart.
    let batch: Batch = (0..100)
        .map(|i| {
            let (sin, cos) = (10.0 * i as f32).to_radians().sin_cos();
            Ray::new(Vec3::ZERO, Vec3::new(sin, 0.2, cos))
        })
        .collect();
    let made = made(&batch);
    assert!(made.cones.is_empty());
    assert!(made.loose.into_iter().eq(0..100));
}

#[test]
fn a_packet_ends_before_a_jump_but_not_before_its_eighth_ray() {
    for k in 1..64u32 {
        // The ray at the jump, and one before it, may be invalid: they are nowhere.
        for bad in [None, Some(k), Some(k - 1), Some(0)] {
            let batch: Batch = (0..80)
                .map(|i| {
                    let x = if i < k { 0.0 } else { 0.05 };
                    let d = Vec3::new(x + 0.001 * (i % 5) as f32, 1.0, 0.0);
                    match bad == Some(i) {
                        // Its direction is not a number: the first one must not spoil the others.
                        true => invalid(1 + (k % 2) as u64, d),
                        false => Ray::new(Vec3::ZERO, d),
                    }
                })
                .collect();
            let made = made(&batch);
            assert!(made.loose.is_empty(), "{k} {bad:?}");
            let first = match bad {
                // All are as far from nowhere.
                Some(0) => 64,
                Some(i) if i == k => k + 1,
                _ => k,
            };
            let first = if first < LEAST_PACKET as u32 {
                64
            } else {
                first
            };
            assert_eq!(made.rays[0], [0, first], "{k} {bad:?}");
            assert_eq!(made.rays[1], [first, (80 - first).min(64)], "{k} {bad:?}");
        }
    }
}

#[test]
fn directions_without_a_length_in_float32_are_not_in_cones() {
    let d = Vec3::new(0.6, 0.0, 0.8);
    for (x, y, z) in [
        (1.0, 1.0, 1.0),
        (1.0, 0.0, 0.0),
        (0.0, 0.0, -1.0),
        (-1.0, 1.0, 0.0),
    ] {
        for size in [1e30, 1e-30, 1e-38, 3e38] {
            let odd = size * Vec3::new(x, y, z);
            for at in 0..20 {
                let of = |i| Ray::new(Vec3::ZERO, if i == at { odd } else { d });
                let made = made(&(0..20).map(of).collect());
                assert!(made.loose.contains(&at), "{odd:?} at {at}");
            }
            let made = made(&(0..20).map(|_| Ray::new(Vec3::ZERO, odd)).collect());
            assert_eq!(made.loose.len(), 20, "{odd:?}");
        }
    }
}

// Squares of lengths around 1e-20 are so small that they have few digits.
#[test]
fn cones_contain_their_rays_whatever_the_length_of_directions() {
    for exponent in -40..=38 {
        for seed in 0..20 {
            let mut number = numbers(hash(1, exponent as u64, seed));
            let middle = direction(&mut number);
            let batch: Batch = (0..24)
                .map(|_| {
                    let d = middle + 0.05 * number() * across(middle, &mut number);
                    let length = (0.1 + number()) * 10f64.powi(exponent);
                    Ray::new(Vec3::ZERO, (d * length).as_vec3())
                })
                .collect();
            made(&batch);
        }
    }
}

/// Cones as the kernels take them, without rays.
fn keep(cones: &[[f32; 4]], bounds: &Aabb, origin: Vec3) -> Vec<bool> {
    let n = cones.len();
    let mut cones = cones.to_vec();
    let mut first = None;
    for isa in Isa::available() {
        // Others before and behind the list stay where they are.
        let (before, behind) = (3, MAX_LANES);
        let mut ids: Vec<u32> = (0..before + n + behind)
            .map(|i| (if i < before { 0 } else { (i - before) % n }) as u32)
            .collect();
        let all = ids.clone();
        let memory = Cones {
            cones: cones.as_mut_ptr(),
            rays: std::ptr::null_mut(),
            ids: ids.as_mut_ptr(),
            done: std::ptr::null_mut(),
        };
        let list = Range {
            from: before,
            to: before + n,
        };
        // SAFETY: the processor was checked; there are valid indices behind the list.
        let kept = unsafe { (Kernels::of(isa).keep_cones)(&memory, list, bounds, origin) };
        assert_eq!(ids[..before], all[..before]);
        assert_eq!(ids[list.to..], all[list.to..]);
        let mut sorted = ids[before..list.to].to_vec();
        sorted.sort();
        assert!(sorted.into_iter().eq(0..n as u32));
        let found = (ids, kept);
        assert_eq!(first.get_or_insert_with(|| found.clone()), &found, "{isa}");
    }
    let (ids, kept) = first.unwrap();
    let mut keeps = vec![false; n];
    for &id in &ids[3..3 + kept] {
        keeps[id as usize] = true;
    }
    keeps
}

/// Whether a cone meets a box, relative to its apex: the axis meets the box, or the cone one of its
/// twelve edges (Mora 2011, appendix).
fn meets(lo: DVec3, hi: DVec3, axis: DVec3, half_angle: f64) -> bool {
    let axis = axis / axis.length();
    let (mut near, mut far) = (0f64, f64::INFINITY);
    for i in 0..3 {
        if axis[i] == 0.0 {
            if lo[i] > 0.0 || hi[i] < 0.0 {
                far = f64::NEG_INFINITY;
            }
        } else {
            let (a, b) = (lo[i] / axis[i], hi[i] / axis[i]);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    if near <= far {
        return true;
    }
    let cosine_squared = libm::cos(half_angle).powi(2);
    let corner = |bits: usize| {
        let at = |i: usize| if bits >> i & 1 == 0 { lo[i] } else { hi[i] };
        DVec3::new(at(0), at(1), at(2))
    };
    for bits in 0..8 {
        let p = corner(bits);
        let inside = axis.dot(p) > 0.0 && axis.dot(p).powi(2) >= cosine_squared * p.dot(p);
        if inside || p == DVec3::ZERO {
            return true;
        }
        for i in 0..3 {
            if bits >> i & 1 == 1 {
                continue;
            }
            let v = corner(bits | 1 << i) - p;
            let a = v.dot(axis).powi(2) - cosine_squared * v.dot(v);
            let b = 2.0 * (p.dot(axis) * v.dot(axis) - cosine_squared * p.dot(v));
            let c = p.dot(axis).powi(2) - cosine_squared * p.dot(p);
            let discriminant = b * b - 4.0 * a * c;
            if discriminant < 0.0 {
                continue;
            }
            let q = -0.5 * (b + b.signum() * discriminant.sqrt());
            for t in [q / a, c / q] {
                if (0.0..=1.0).contains(&t) && axis.dot(p + v * t) > 0.0 {
                    return true;
                }
            }
        }
    }
    false
}

/// A box at any distance from where it is seen: small, large, flat, around the origin, touching it.
fn some_box(number: &mut impl FnMut() -> f64, kind: usize) -> (Vec3, Aabb) {
    let origin = match kind % 3 {
        0 => Vec3::ZERO,
        1 => (4.0 * direction(number)).as_vec3(),
        _ => Vec3::new(148376.0, 1234.0, -223423.0),
    };
    let scale = match kind / 3 % 4 {
        0 => 1.0,
        1 => 1e-4,
        2 => 1e4,
        _ => 100.0,
    };
    let distance = scale * (0.1 + 3.0 * number());
    let size = scale * 10f64.powf(-3.0 + 3.5 * number());
    let min = origin + (distance * direction(number)).as_vec3();
    let extent = (size * DVec3::new(number(), number(), number())).as_vec3();
    let mut b = Aabb {
        min,
        max: min + extent,
    };
    for axis in 0..3 {
        match (number() * 12.0) as usize {
            0 => b.max[axis] = b.min[axis],
            // The origin between the planes, and on either one.
            1 | 2 => {
                (b.min[axis], b.max[axis]) = (
                    origin[axis] - 0.3 * extent[axis],
                    origin[axis] + extent[axis],
                )
            }
            3 => b.min[axis] = origin[axis],
            4 => b.max[axis] = origin[axis],
            _ => {}
        }
        if b.min[axis] > b.max[axis] {
            (b.min[axis], b.max[axis]) = (b.max[axis], b.min[axis]);
        }
    }
    (origin, b)
}

/// A point of a box, often one on an edge or a corner.
fn some_point(number: &mut impl FnMut() -> f64, lo: DVec3, hi: DVec3) -> DVec3 {
    let mut p = lo;
    for axis in 0..3 {
        let x = match (4.0 * number()) as usize {
            0 => 0.0,
            1 => 1.0,
            _ => number(),
        };
        p[axis] = lo[axis] + x * (hi[axis] - lo[axis]);
    }
    p
}

#[test]
fn cones_that_meet_a_box_are_kept_and_those_clearly_outside_are_dropped() {
    let mut number = numbers(1);
    let (mut touching, mut outside, mut close) = (0, 0, 0);
    for kind in 0..3000 {
        let (origin, bounds) = some_box(&mut number, kind);
        let (lo, hi) = (
            bounds.min.as_dvec3() - origin.as_dvec3(),
            bounds.max.as_dvec3() - origin.as_dvec3(),
        );
        let mut cones = vec![];
        for i in 0..40 {
            let p = some_point(&mut number, lo, hi);
            // From 10⁻⁶ to 64 degrees.
            let half_angle = 10f64.powf(-6.0 + 6.05 * number());
            let axis = if i % 4 == 0 || p == DVec3::ZERO {
                direction(&mut number)
            } else {
                // The point is on the rim, or some 10⁻⁵ from there.
                let u = p / p.length();
                let turn = half_angle + [0.0, 1e-5, 3e-5, 1e-3][i % 4] * (2.0 * number() - 0.5);
                let w = across(u, &mut number);
                u * libm::cos(turn) + w * libm::sin(turn)
            };
            let sine = libm::sin(half_angle.min(1.1)) as f32 + TOLERANCE;
            cones.push([axis.x as f32, axis.y as f32, axis.z as f32, sine]);
        }
        // Seen from within its plane, a box of no thickness has no inner side.
        let edge_on = (0..3).any(|axis| lo[axis] == 0.0 && hi[axis] == 0.0);
        let keeps = keep(&cones, &bounds, origin);
        for (&[x, y, z, sine], kept) in cones.iter().zip(keeps) {
            let axis = Vec3::new(x, y, z).as_dvec3();
            let at = || format!("{axis:?} {sine:e} {bounds:?} from {origin:?}");
            let within = libm::asin((sine - TOLERANCE) as f64);
            let around = libm::asin(sine as f64) + 1e-5;
            if meets(lo, hi, axis, within) {
                touching += 1;
                assert!(kept, "{}", at());
            } else if !meets(lo, hi, axis, around) && !edge_on {
                outside += 1;
                close += meets(lo, hi, axis, around + 1e-5) as usize;
                assert!(!kept, "{}", at());
            }
        }
    }
    assert!(
        touching > 30_000 && outside > 20_000,
        "{touching} {outside}"
    );
    assert!(close > 300, "{close}");
}

#[test]
fn cones_are_kept_for_every_ray_that_passes_the_slab_test() {
    let mut number = numbers(2);
    let mut grazing = 0;
    for kind in 0..3000 {
        let (origin, bounds) = some_box(&mut number, kind);
        let (lo, hi) = (
            bounds.min.as_dvec3() - origin.as_dvec3(),
            bounds.max.as_dvec3() - origin.as_dvec3(),
        );
        let middle = 0.5 * (lo + hi);
        // SAFETY: portable code runs everywhere.
        let slabs = unsafe { SlabBox::<Portable>::new(&bounds, Some(origin)) };
        let (mut cones, mut rays) = (vec![], vec![]);
        for i in 0..40 {
            // Up to the padding outside, where rays still pass.
            let p = some_point(&mut number, lo, hi);
            let beyond = [0.0, 1e-6, 3e-6, 5e-6][i % 4] * number();
            let away = p - middle;
            let p = p + beyond * p.length() * away / away.length().max(1e-300);
            if p == DVec3::ZERO {
                continue;
            }
            let ray = (p * 10f64.powf(4.0 * number() - 2.0)).as_vec3();
            let inverse = ray.to_array().map(|x| {
                let inverse = 1.0 / x;
                [if inverse.is_finite() {
                    inverse
                } else {
                    f32::NAN
                }; 4]
            });
            // SAFETY: as above.
            let (near, far) = unsafe { slabs.interval::<true, true>(&inverse, &inverse, [0.0; 4]) };
            if near[0] > far[0] {
                continue;
            }
            let u = ray.as_dvec3() / ray.as_dvec3().length();
            let half_angle = 10f64.powf(-7.0 + 7.0 * number());
            // Away from the box, or anywhere.
            let w = match i % 3 {
                0 => across(u, &mut number),
                _ => {
                    let w = away - u * u.dot(away);
                    if w.length() < 1e-9 * p.length() {
                        continue;
                    }
                    w / w.length()
                }
            };
            let axis = (u * libm::cos(half_angle) + w * libm::sin(half_angle)).as_vec3();
            cones.push([
                axis.x,
                axis.y,
                axis.z,
                sine(axis.as_dvec3(), ray.as_dvec3()) as f32 + TOLERANCE,
            ]);
            rays.push((ray, half_angle));
        }
        if cones.is_empty() {
            continue;
        }
        for (i, kept) in keep(&cones, &bounds, origin).into_iter().enumerate() {
            let (ray, half_angle) = rays[i];
            grazing += !meets(lo, hi, Vec3::from_slice(&cones[i]).as_dvec3(), half_angle) as usize;
            assert!(
                kept,
                "{ray:?} in {:?}: {bounds:?} from {origin:?}",
                cones[i]
            );
        }
    }
    // There only for the padding.
    assert!(grazing > 1000, "{grazing}");
}

#[test]
fn lists_of_cones_of_every_length() {
    let bounds = Aabb {
        min: Vec3::new(1.0, -1.0, -1.0),
        max: Vec3::new(2.0, 1.0, 1.0),
    };
    for n in 1..100 {
        let cone = |i: usize| {
            let x = if hash(1, n as u64, i as u64).is_multiple_of(3) {
                -1.0
            } else {
                1.0
            };
            [x, 0.0, 0.0, 0.01]
        };
        let cones: Vec<[f32; 4]> = (0..n).map(cone).collect();
        let keeps = keep(&cones, &bounds, Vec3::ZERO);
        assert!(keeps.into_iter().eq(cones.iter().map(|cone| cone[0] > 0.0)));
        // From within all are kept.
        assert!(!keep(&cones, &bounds, Vec3::new(1.5, 0.0, 0.0)).contains(&false));
        assert!(!keep(&cones, &bounds, Vec3::new(1.0, 1.0, 1.0)).contains(&false));
    }
}

#[test]
fn termination_bits_of_packets_that_begin_at_any_bit() {
    const RAYS: usize = 256;
    for first in 0..130 {
        for len in 1..=64 {
            let mut memory = Memory::new(RAYS);
            memory.rays[1] = [first, len];
            memory.done.fill(0);
            let cones = memory.cones();
            let mut ended = [false; RAYS];
            // Those right before and behind the packet, and some of its own.
            let random = (0..8).map(|i| below(hash(len as u64, first as u64, i), RAYS as u32));
            let around = [first.wrapping_sub(1), first, first + len - 1, first + len];
            for (i, ray) in around.into_iter().chain(random).enumerate() {
                if ray < RAYS as u32 && !(first + len + i as u32).is_multiple_of(3) {
                    // SAFETY: it is a ray.
                    unsafe { cones.end(ray) };
                    ended[ray as usize] = true;
                }
            }
            let mut expected = !0u64;
            for i in 0..len {
                if !ended[(first + i) as usize] {
                    expected &= !(1 << i);
                }
            }
            // SAFETY: it is a cone.
            let bits = unsafe { cones.bits(1) };
            assert_eq!(bits, expected, "{len} rays from {first}");
            for (ray, &ended) in ended.iter().enumerate() {
                assert_eq!(memory.done[ray / 64] >> (ray % 64) & 1 == 1, ended);
            }
        }
    }
}

#[test]
fn all_rays_of_a_cone_that_are_not_done_are_flushed_in_their_order() {
    for isa in Isa::available() {
        for seed in 0..100 {
            // Packets of any length; cones of some of them, in any order.
            let mut packets = vec![];
            let mut n = 0;
            for i in 0..1 + seed % 9 {
                let len = 1 + below(hash(seed, 1, i), 64);
                packets.push([n, len]);
                n += len;
            }
            let mut memory = Memory::new(8 * n as usize);
            memory.rays[..packets.len()].copy_from_slice(&packets);
            memory.done.fill(0);
            let mut ended = vec![false; n as usize];
            for ray in 0..n {
                ended[ray as usize] = hash(seed, 2, ray as u64) % 4 < seed % 5;
                if ended[ray as usize] {
                    // SAFETY: it is a ray.
                    unsafe { memory.cones().end(ray) };
                }
            }
            let mut chosen: Vec<u32> = (0..packets.len() as u32).collect();
            chosen.sort_by_key(|&cone| hash(seed, 3, cone as u64));
            for (id, &cone) in memory.ids.iter_mut().zip(&chosen) {
                *id = cone;
            }
            let list = Range {
                from: (chosen.len() / 4).min(1),
                to: chosen.len(),
            };
            let to = 2;
            memory.ray_ids[..to].copy_from_slice(&[77, 78]);
            let (rays, cones) = (memory.rays(), memory.cones());
            // SAFETY: the processor was checked; there is room for all rays.
            let end = unsafe { (Kernels::of(isa).flush)(&cones, list, &rays, to) };
            let expected: Vec<u32> = chosen[list.from..list.to]
                .iter()
                .map(|&cone| packets[cone as usize])
                .flat_map(|[first, len]| first..first + len)
                .filter(|&ray| !ended[ray as usize])
                .collect();
            assert_eq!(memory.ray_ids[to..end], expected, "{isa}");
            assert_eq!(memory.ray_ids[..to], [77, 78], "{isa}");
        }
    }
}

#[test]
fn behind_flushed_rays_there_are_numbers_of_rays() {
    // The filter and the naive step look up whole vectors.
    for isa in Isa::available() {
        for n in 1..130 {
            let batch: Batch = (0..n).map(|_| Ray::new(Vec3::ZERO, Vec3::X)).collect();
            let mut memory = Memory::new(n);
            let (rays, cones) = (memory.rays(), memory.cones());
            // SAFETY: the processor was checked; there is room for the batch.
            let end = unsafe {
                let made = (Kernels::of(isa).prepare_cones)(&batch, &rays, &cones, least_cosine());
                let list = Range {
                    from: 0,
                    to: made.cones,
                };
                (Kernels::of(isa).flush)(&cones, list, &rays, 0)
            };
            assert_eq!(end, n);
            let behind = &memory.ray_ids[end..end + MAX_LANES];
            assert!(
                behind.iter().all(|&id| id < n as u32),
                "{isa}, {n} rays: {behind:?}"
            );
        }
    }
}
