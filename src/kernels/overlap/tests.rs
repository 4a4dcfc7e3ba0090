//! Separating axes against two other ways to find out whether a triangle touches a cell, both in
//! float64: it is clipped to the cell; and how far apart they are on each axis.

use super::*;
use crate::geometry::{Mesh, Triangle};
use crate::kernels::Kernels;
use crate::random::{below, hash, numbers};
use crate::simd::{Isa, MAX_LANES};
use glam::{DVec3, Vec3};

fn corners_of(t: &Triangle) -> [DVec3; 3] {
    [t.a, t.b, t.c].map(|v| v.as_dvec3())
}

/// The indices after the test, as every instruction set has them, and how many are kept.
fn kept(triangles: &[Triangle], by: Overlap) -> (Vec<u32>, usize) {
    let n = triangles.len();
    let mesh = Mesh::new(triangles.to_vec());
    let mut first = None;
    for isa in Isa::available() {
        let mut spans = [0, 1, 2].map(|_| vec![[0f32; 2]; n]);
        let mut rest = vec![[0f32; 4]; n];
        let mut ids: Vec<u32> = vec![0; n + MAX_LANES];
        let lists = TriangleLists {
            spans: spans.each_mut().map(|list| list.as_mut_ptr()),
            rest: rest.as_mut_ptr(),
            ids: ids.as_mut_ptr(),
        };
        // SAFETY: the processor was checked; there is room for the mesh and a vector. Triangles
        // without an area are held against the cell, too.
        let kept = unsafe {
            (Kernels::of(isa).prepare_lists)(&mesh, &lists);
            for i in 0..n {
                *lists.ids.add(i) = i as u32;
            }
            (Kernels::of(isa).keep_overlapping)(&lists, n, by)
        };
        ids.truncate(n);
        let found = (ids, kept);
        assert_eq!(first.get_or_insert_with(|| found.clone()), &found, "{isa}");
    }
    first.unwrap()
}

/// Whether anything is left of a triangle that is clipped to a box (Sutherland and Hodgman 1974).
fn touches(t: &Triangle, cell: &Aabb) -> bool {
    let mut polygon = corners_of(t).to_vec();
    for axis in 0..3 {
        for (sign, plane) in [(1.0, cell.max[axis]), (-1.0, cell.min[axis])] {
            let outside = |p: DVec3| sign * (p[axis] - plane as f64);
            let mut clipped = vec![];
            for i in 0..polygon.len() {
                let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let (a, b) = (outside(p), outside(q));
                if a <= 0.0 {
                    clipped.push(p);
                }
                if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
                    let mut r = p + (q - p) * (a / (a - b));
                    r[axis] = plane as f64;
                    clipped.push(r);
                }
            }
            polygon = clipped;
        }
    }
    !polygon.is_empty()
}

/// How far a triangle and a box are apart on an axis; negative where they overlap or it is no axis.
fn gap(t: &Triangle, cell: &Aabb, axis: DVec3) -> f64 {
    if axis == DVec3::ZERO {
        return f64::NEG_INFINITY;
    }
    let axis = axis / axis.abs().max_element();
    let axis = axis / axis.length();
    let center = 0.5 * (cell.min.as_dvec3() + cell.max.as_dvec3());
    let half = 0.5 * (cell.max.as_dvec3() - cell.min.as_dvec3());
    let at = corners_of(t).map(|p| axis.dot(p - center));
    let (least, greatest) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
    (least.max(-greatest)) - axis.abs().dot(half)
}

/// The widest gap on the nine axes that are across an edge of each.
fn edge_gap(t: &Triangle, cell: &Aabb) -> f64 {
    let [a, b, c] = corners_of(t);
    let mut widest = f64::NEG_INFINITY;
    for edge in [b - a, c - b, a - c] {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            widest = widest.max(gap(t, cell, axis.cross(edge)));
        }
    }
    widest
}

fn plane_gap(t: &Triangle, cell: &Aabb) -> f64 {
    let [a, b, c] = corners_of(t);
    gap(t, cell, (b - a).cross(c - a))
}

/// The margin as it is documented: how far a hit may be from its triangle, and what is lost far from
/// the coordinate origin.
fn margin(t: &Triangle, by: &Overlap) -> f64 {
    let furthest = |p: DVec3| {
        let from_least = (p - by.origins.min.as_dvec3()).abs();
        from_least
            .max((p - by.origins.max.as_dvec3()).abs())
            .element_sum()
    };
    let corner = |bits: usize| {
        let b = &by.cell;
        let at = |axis: usize| {
            if bits >> axis & 1 == 0 {
                b.min[axis]
            } else {
                b.max[axis]
            }
        };
        Vec3::new(at(0), at(1), at(2)).as_dvec3()
    };
    let far = (0..8)
        .map(|bits| furthest(corner(bits)))
        .fold(0.0, f64::max);
    let coordinates = (by.cell.min.as_dvec3().abs() + by.cell.max.as_dvec3().abs()).element_sum();
    MARGIN as f64 * (far + furthest(t.a.as_dvec3())) + coordinates * 4.0 / (1 << 24) as f64
}

/// Whether the product of the normal and a corner may overflow: then nothing is said to be apart.
fn overflows(t: &Triangle, cell: &Aabb) -> bool {
    let b = t.bounds().union(*cell);
    b.extent().as_dvec3().element_sum().powi(3) > f32::MAX as f64
}

/// Triangles around a cell: of any shape, slivers, along axes, larger than the cell, on its planes.
fn triangles(mut number: impl FnMut() -> f64, cell: &Aabb, n: usize) -> Vec<Triangle> {
    let (center, half) = (cell.center().as_dvec3(), 0.5 * cell.extent().as_dvec3());
    (0..n)
        .map(|i| {
            let mut vector = || DVec3::new(number(), number(), number()) * 2.0 - 1.0;
            let middle = 2.0 * vector();
            let [p, q, r] = [vector(), vector(), vector()];
            let size = match i % 4 {
                0 => 0.1,
                1 => 1.0,
                2 => 3.0,
                _ => 30.0,
            };
            let mut corners = [p, q, r].map(|v| middle + size * v);
            let kind = i / 4 % 5;
            match kind {
                1 => corners[2] = corners[0] + 0.3 * (corners[1] - corners[0]) + 1e-6 * r,
                2 => {
                    let axis = (i / 20) % 3;
                    (corners[1][axis], corners[2][axis]) = (corners[0][axis], corners[0][axis]);
                }
                3 => {
                    let axis = (i / 20) % 3;
                    let along = corners[1][axis];
                    corners[1] = corners[0];
                    corners[1][axis] = along;
                }
                4 => {
                    // Some coordinates are those of the cell.
                    for (k, corner) in corners.iter_mut().enumerate() {
                        for axis in 0..3 {
                            match below(hash(5, i as u64, (3 * k + axis) as u64), 6) {
                                0 => corner[axis] = 1.0,
                                1 => corner[axis] = -1.0,
                                _ => {}
                            }
                        }
                    }
                }
                _ => {}
            }
            let place = |v: DVec3| {
                let mut p = (center + v * half).as_vec3();
                for axis in 0..3 {
                    if v[axis] == 1.0 {
                        p[axis] = cell.max[axis];
                    } else if v[axis] == -1.0 {
                        p[axis] = cell.min[axis];
                    }
                }
                p
            };
            let [a, b, c] = corners.map(place);
            Triangle::new(a, b, c)
        })
        .collect()
}

/// How many triangles there were of each sort.
#[derive(Debug, Default)]
struct Seen {
    touching: usize,
    dropped: usize,
    clear_of_edges: usize,
    clear_of_plane: usize,
}

/// Holds the kernel's answers for one cell against those of float64.
fn check(triangles: &[Triangle], by: Overlap, seen: &mut Seen) {
    let (ids, n) = kept(triangles, by);
    let mut keeps = vec![false; triangles.len()];
    for &id in &ids[..n] {
        keeps[id as usize] = true;
    }
    let mut sorted = ids.clone();
    sorted.sort();
    assert!(sorted.into_iter().eq(0..triangles.len() as u32));
    for (t, kept) in triangles.iter().zip(keeps) {
        let Side { axis, plane, upper } = by.side;
        let b = t.bounds();
        let reaches = if upper {
            b.max[axis] >= plane
        } else {
            b.min[axis] <= plane
        };
        let (edges, of_plane) = (edge_gap(t, &by.cell), plane_gap(t, &by.cell));
        let at = || {
            let (cell, origins) = (by.cell, by.origins);
            format!("{t:?} {cell:?} {origins:?} edges {edges:e} plane {of_plane:e}")
        };
        if touches(t, &by.cell) {
            seen.touching += 1;
            assert!(kept, "it touches: {}", at());
        }
        if !kept {
            seen.dropped += 1;
            // For a reason, and no other one.
            let apart = !reaches || edges > 0.0 || (by.plane && of_plane > 0.0);
            assert!(apart, "no axis separates: {}", at());
        }
        if !reaches {
            assert!(!kept, "it does not reach the split plane: {}", at());
            continue;
        }
        // A gap on an axis shrinks by the margin on each coordinate.
        let clear = 1.1 * 3f64.sqrt() * margin(t, &by);
        if edges > clear {
            seen.clear_of_edges += 1;
            assert!(!kept, "an edge's axis separates, {clear:e}: {}", at());
        } else if by.plane && edges <= 0.0 && of_plane > clear && !overflows(t, &by.cell) {
            seen.clear_of_plane += 1;
            assert!(!kept, "the plane separates, {clear:e}: {}", at());
        }
    }
}

/// Cells of a size somewhere, with origins not far from them.
fn check_cells(place: Vec3, size: f32, seed: u64) -> Seen {
    let mut seen = Seen::default();
    let mut number = numbers(seed);
    for i in 0..40 {
        let mut vector = || {
            let v = DVec3::new(number(), number(), number());
            Vec3::new(v.x as f32, v.y as f32, v.z as f32)
        };
        let min = place + size * (vector() - 0.5);
        let mut extent = vector();
        if i % 10 == 9 {
            // A cell of no thickness.
            extent[i / 10 % 3] = 0.0;
        }
        let cell = Aabb {
            min,
            max: min + size * extent,
        };
        let o = place + 4.0 * size * (vector() - 0.5);
        let origins = match i % 3 {
            0 => Aabb { min: o, max: o },
            _ => Aabb {
                min: o,
                max: o + size * vector(),
            },
        };
        let (axis, upper) = (i % 3, i / 3 % 2 == 0);
        let plane = if upper {
            cell.min[axis]
        } else {
            cell.max[axis]
        };
        let by = Overlap {
            cell,
            side: Side { axis, plane, upper },
            origins,
            plane: i % 2 == 0,
        };
        check(
            &triangles(numbers(seed + 1 + i as u64), &cell, 1000),
            by,
            &mut seen,
        );
    }
    seen
}

#[test]
fn only_triangles_that_an_axis_separates_are_dropped_and_all_with_a_clear_gap() {
    for (i, size) in [1.0, 1e-6, 1e6, 1e11].into_iter().enumerate() {
        let seen = check_cells(Vec3::ZERO, size, 100 * i as u64);
        assert!(seen.touching > 5000, "{seen:?}");
        assert!(seen.clear_of_edges > 2000, "{seen:?}");
        assert!(seen.clear_of_plane > 50, "{seen:?}");
    }
}

#[test]
fn far_from_the_coordinate_origin() {
    let place = Vec3::new(148376.0, 1234.0, -223423.0);
    for (i, size) in [1.0, 30.0, 1000.0].into_iter().enumerate() {
        let seen = check_cells(place, size, 1000 + 100 * i as u64);
        assert!(seen.touching > 5000, "{seen:?}");
        assert!(i == 0 || seen.clear_of_edges > 1000, "{seen:?}");
    }
}

#[test]
fn coordinates_as_large_as_they_may_be() {
    // Triangles are up to 30 times as large as the cell.
    let seen = check_cells(Vec3::ZERO, 1e16, 2000);
    assert!(
        seen.touching > 5000 && seen.clear_of_edges > 1000,
        "{seen:?}"
    );
}

#[test]
fn lists_of_every_length() {
    let cell = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };
    let by = Overlap {
        cell,
        side: Side {
            axis: 0,
            plane: 0.0,
            upper: true,
        },
        origins: cell,
        plane: true,
    };
    for n in 0..70 {
        check(&triangles(numbers(7), &cell, n), by, &mut Seen::default());
    }
}

#[test]
fn a_corner_cut_off_by_an_edge_and_one_by_a_plane() {
    let cell = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };
    let with = |plane| Overlap {
        cell,
        side: Side {
            axis: 0,
            plane: 1.0,
            upper: false,
        },
        origins: cell,
        plane,
    };
    // Across the cell's upper corner in x and y, beyond it by 0.1, at the height of its middle.
    let past_an_edge = Triangle::new(
        Vec3::new(2.2, 0.0, 0.4),
        Vec3::new(0.0, 2.2, 0.4),
        Vec3::new(2.2, 2.2, 0.6),
    );
    // x + y + z = 3.3, and within the cell's shadow along every axis and every edge.
    let past_the_plane = Triangle::new(
        Vec3::new(5.3, -1.0, -1.0),
        Vec3::new(-1.0, 5.3, -1.0),
        Vec3::new(-1.0, -1.0, 5.3),
    );
    for plane in [false, true] {
        assert_eq!(kept(&[past_an_edge], with(plane)).1, 0);
        assert_eq!(kept(&[past_the_plane], with(plane)).1, !plane as usize);
    }
}
