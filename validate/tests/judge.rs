//! The judge accepts every answer of the float32 kernel of record, and no sabotaged one.

mod common;

use common::{FORMS, Form, any, nearest, point, rays, soup};
use dacrt::MISS;
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use dacrt_validate::bounds::Kernel;
use dacrt_validate::judge::{Answers, Judge, Verdict, Wrong};
use fastrand::Rng;
use glam::Vec3;

/// Verdicts on nearest hits of all rays.
fn judge(mesh: &Mesh, batch: &Batch, hits: &Hits) -> Vec<Verdict> {
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    Judge::new(mesh)
        .judge(batch, &all, &[(Kernel::Fast, Answers::Nearest(hits))])
        .into_iter()
        .map(|judgement| judgement.verdicts[0])
        .collect()
}

fn judge_any(mesh: &Mesh, batch: &Batch, occluded: &[u8]) -> Vec<Verdict> {
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    Judge::new(mesh)
        .judge(batch, &all, &[(Kernel::Fast, Answers::Any(occluded))])
        .into_iter()
        .map(|judgement| judgement.verdicts[0])
        .collect()
}

/// All answers of all forms of the kernel are accepted; returns the share decided for certain.
fn accepts_kernel(name: &str, mesh: &Mesh, batch: &Batch) -> f64 {
    let mut right = 0;
    for form in FORMS {
        let hits = nearest(mesh, batch, form);
        for (i, verdict) in judge(mesh, batch, &hits).into_iter().enumerate() {
            assert!(
                !verdict.is_wrong() && verdict != Verdict::OutOfRange,
                "{name}, {form:?}, ray {i} {:?}: t {:e}, prim {}: {verdict:?}",
                batch.ray(i),
                hits.t[i],
                hits.prim[i],
            );
            right += (verdict == Verdict::Right) as usize;
        }
        let occluded = any(mesh, batch, form);
        for (i, verdict) in judge_any(mesh, batch, &occluded).into_iter().enumerate() {
            assert!(
                !verdict.is_wrong(),
                "{name}, {form:?}, any, ray {i}: {verdict:?}"
            );
        }
    }
    right as f64 / (FORMS.len() * batch.len()) as f64
}

#[test]
fn accepts_the_kernel_on_random_scenes_and_decides_nearly_all() {
    let mut random = Rng::with_seed(1);
    for size in [0.05, 0.3, 1.0] {
        let mesh = soup(&mut random, 300, size, 1.0, Vec3::ZERO);
        for form in [Form::Shared, Form::Plain] {
            let batch = rays(&mut random, 4000, 1.0, Vec3::ZERO, form);
            let right = accepts_kernel(&format!("soup of {size}"), &mesh, &batch);
            // Otherwise the bounds would excuse too much.
            assert!(right > 0.999, "size {size}: only {right} decided");
        }
    }
}

#[test]
fn accepts_the_kernel_far_from_the_origin() {
    let mut random = Rng::with_seed(2);
    // At 10⁶ all coordinates are multiples of 1/16, so many rays meet edges and ties exactly.
    for (distance, least) in [(1e2, 0.999), (1e4, 0.998), (1e6, 0.95)] {
        let offset = Vec3::new(1.0, 0.3, -0.7) * distance;
        let mesh = soup(&mut random, 200, 0.5, 1.0, offset);
        let batch = rays(&mut random, 3000, 1.0, offset, Form::Plain);
        let right = accepts_kernel(&format!("offset {distance}"), &mesh, &batch);
        assert!(right > least, "offset {distance}: only {right} decided");
    }
}

#[test]
fn accepts_the_kernel_seen_from_far_away() {
    let mut random = Rng::with_seed(3);
    let mesh = soup(&mut random, 300, 0.3, 1.0, Vec3::ZERO);
    // From 10⁶ away, float32 misplaces a ray by as much as the triangles are large.
    for (distance, least) in [(1e2, 0.99), (1e4, 0.4), (1e6, 0.0)] {
        let batch: Batch = (0..3000)
            .map(|_| {
                let eye = point(&mut random).normalize() * distance;
                Ray::new(eye, (point(&mut random) - eye) * 1e-3)
            })
            .collect();
        let right = accepts_kernel(&format!("from {distance}"), &mesh, &batch);
        assert!(right >= least, "from {distance}: only {right} decided");
    }
}

#[test]
fn accepts_the_kernel_at_tiny_and_huge_scales() {
    let mut random = Rng::with_seed(4);
    for scale in [1e-8, 1e-6, 1e-3, 1e3, 1e6, 5e8] {
        for length in [1e-8, 1.0, 1e8] {
            let mesh = soup(&mut random, 100, 0.5, scale, Vec3::ZERO);
            let mut batch = rays(&mut random, 300, scale, Vec3::ZERO, Form::Plain);
            for axis in &mut batch.direction {
                axis.iter_mut().for_each(|x| *x *= length);
            }
            let name = format!("scale {scale}, direction {length}");
            let right = accepts_kernel(&name, &mesh, &batch);
            assert!(right > 0.98, "{name}: only {right} decided");
        }
    }
}

/// Rays at corners, at edges, along edges, within planes, along axes, from box planes.
#[test]
fn accepts_the_kernel_on_hard_rays() {
    let mut random = Rng::with_seed(5);
    for flat in [false, true] {
        let mut triangles = soup(&mut random, 60, 1.0, 1.0, Vec3::ZERO)
            .triangles()
            .to_vec();
        if flat {
            // Walls and floors, whose boxes have no thickness.
            for (i, t) in triangles.iter_mut().enumerate() {
                let axis = i % 3;
                (t.b[axis], t.c[axis]) = (t.a[axis], t.a[axis]);
            }
        }
        // Duplicates, needles, and triangles without area.
        let first = triangles[0];
        triangles.extend([first, first]);
        for i in 0..20 {
            let t = triangles[i];
            triangles.push(Triangle::new(
                t.a,
                t.b,
                t.a + (t.b - t.a) * 0.5 + point(&mut random) * 1e-6,
            ));
            triangles.push(Triangle::new(t.a, t.b, t.b));
            triangles.push(Triangle::new(t.a, t.a, t.a));
        }
        let mesh = Mesh::new(triangles);
        let mut batch = Batch::default();
        for i in 0..6000 {
            let t = mesh.triangles()[i % mesh.len()];
            let on_edge = t.a + (t.b - t.a) * (random.u8(0..=16) as f32 / 16.0);
            let in_plane = t.a + (t.c - t.a) * 0.3 + (t.b - t.a) * 0.3;
            let eye = point(&mut random) * 3.0;
            let mut ray = match i / mesh.len() % 6 {
                0 => Ray::new(eye, t.a - eye),
                1 => Ray::new(eye, on_edge - eye),
                2 => Ray::new(t.a - (t.b - t.a), t.b - t.a),
                3 => Ray::new(t.b + (t.b - in_plane), in_plane - t.b),
                4 => {
                    let mut d = Vec3::ZERO;
                    d[i % 3] = if i % 2 == 0 { -1.0 } else { 2.0 };
                    Ray::new(in_plane - d, d)
                }
                // Grazing: almost within the plane.
                _ => {
                    let target = in_plane + point(&mut random) * 1e-5;
                    Ray::new(target - 2.0 * (t.b - t.a), t.b - t.a)
                }
            };
            match random.u8(0..4) {
                // The interval ends about where the target is.
                0 => ray.tmax = 1.0,
                1 => ray.tmin = 1.0,
                _ => {}
            }
            batch.push(ray);
        }
        accepts_kernel(&format!("hard, flat: {flat}"), &mesh, &batch);
    }
}

/// A lost hit on a wall is no matter of rounding: its flat box must not make every ray undecided.
#[test]
fn decides_walls() {
    let mut random = Rng::with_seed(6);
    let triangles = (0..100)
        .map(|i| {
            let (a, axis) = (point(&mut random), i % 3);
            let flat = |mut p: Vec3| {
                p[axis] = a[axis];
                p
            };
            Triangle::new(a, flat(point(&mut random)), flat(point(&mut random)))
        })
        .collect();
    let mesh = Mesh::new(triangles);
    let batch = rays(&mut random, 5000, 1.0, Vec3::ZERO, Form::Plain);
    let right = accepts_kernel("walls", &mesh, &batch);
    assert!(right > 0.999, "only {right} decided");
}

/// Replaces the answers of rays that hit and counts how many of the changed ones are rejected.
fn rejected(change: impl Fn(&mut Rng, &Mesh, &Ray, &mut f32, &mut u32) -> bool) -> (usize, usize) {
    let mut random = Rng::with_seed(8);
    let mesh = soup(&mut random, 300, 0.4, 1.0, Vec3::ZERO);
    let batch = rays(&mut random, 5000, 1.0, Vec3::ZERO, Form::Plain);
    let mut hits = nearest(&mesh, &batch, Form::Plain);
    let changed: Vec<usize> = (0..batch.len())
        .filter(|&i| {
            let (t, prim) = (&mut hits.t[i], &mut hits.prim[i]);
            *prim != MISS && change(&mut random, &mesh, &batch.ray(i), t, prim)
        })
        .collect();
    let verdicts = judge(&mesh, &batch, &hits);
    let rejected = changed.iter().filter(|&&i| verdicts[i].is_wrong());
    (rejected.count(), changed.len())
}

#[test]
fn rejects_a_moved_distance() {
    for (factor, least) in [(1.001, 0.995), (0.999, 0.995), (1.00001, 0.95)] {
        let (rejected, all) = rejected(|_, _, _, t, _| {
            *t *= factor;
            true
        });
        // Only in almost grazing hits can float32 be this far off.
        assert!(
            rejected as f64 > least * all as f64,
            "{factor}: {rejected} of {all}"
        );
        assert!(all > 1000);
    }
}

#[test]
fn rejects_another_triangle() {
    let (rejected, all) = rejected(|random, mesh, _, _, prim| {
        *prim = (*prim + 1 + random.u32(0..mesh.len() as u32 - 1)) % mesh.len() as u32;
        true
    });
    assert_eq!(rejected, all);
}

#[test]
fn rejects_a_lost_hit() {
    let (rejected, all) = rejected(|_, _, _, t, prim| {
        (*t, *prim) = (f32::INFINITY, MISS);
        true
    });
    assert!(rejected as f64 > 0.999 * all as f64, "{rejected} of {all}");
}

#[test]
fn rejects_a_far_hit_in_place_of_a_near_one() {
    let (rejected, all) = rejected(|_, mesh, ray, t, prim| {
        let beyond = Ray {
            tmin: *t * 1.0001,
            ..*ray
        };
        let far = nearest(mesh, &std::iter::once(beyond).collect(), Form::Plain);
        (*t, *prim) = (far.t[0], far.prim[0]);
        *prim != MISS
    });
    assert!(rejected as f64 > 0.999 * all as f64, "{rejected} of {all}");
    assert!(all > 500);
}

#[test]
fn rejects_what_is_no_answer() {
    let (mesh, ray) = one_triangle();
    let batch: Batch = [ray, Ray { tmin: -1.0, ..ray }].into_iter().collect();
    let verdict = |t: f32, prim: u32| {
        judge(
            &mesh,
            &batch,
            &Hits {
                t: vec![t; 2],
                prim: vec![prim; 2],
            },
        )
    };
    assert_eq!(
        verdict(2.0, 0),
        [Verdict::Right, Verdict::Wrong(Wrong::InvalidRay)]
    );
    assert_eq!(verdict(f32::INFINITY, MISS)[1], Verdict::Right);
    assert_eq!(verdict(2.0, 9)[0], Verdict::Wrong(Wrong::NoSuchTriangle));
    assert_eq!(verdict(2.0, MISS)[0], Verdict::Wrong(Wrong::NoSuchTriangle));
    // The second triangle has no area, the third is invalid.
    assert_eq!(verdict(2.0, 1)[0], Verdict::Wrong(Wrong::NoSuchTriangle));
    assert_eq!(verdict(2.0, 2)[0], Verdict::Wrong(Wrong::NoSuchTriangle));
    for t in [f32::NAN, f32::INFINITY, -2.0, 0.0, 2.0001] {
        let verdict = verdict(t, 0)[0];
        assert!(
            matches!(verdict, Verdict::Wrong(Wrong::Distance { .. })),
            "{t}: {verdict:?}"
        );
    }
}

/// A triangle at t = 2, one without area, an invalid one; and a ray.
fn one_triangle() -> (Mesh, Ray) {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let mesh = Mesh::new(vec![
        Triangle::new(-x - y, x - y, y),
        Triangle::new(-x - y, y, y),
        Triangle::new(-x, x, y * f32::NAN),
    ]);
    (mesh, Ray::new(-2.0 * z, z))
}

#[test]
fn respects_the_ends_of_the_interval() {
    let (mesh, ray) = one_triangle();
    let with = |tmin, tmax| Ray { tmin, tmax, ..ray };
    let batch: Batch = [
        with(0.0, 1.999),
        with(2.001, 9.0),
        with(1.999, 2.001),
        with(2.0, 3.0),
        with(1.0, 2.0),
    ]
    .into_iter()
    .collect();
    let hit = Hits {
        t: vec![2.0; 5],
        prim: vec![0; 5],
    };
    let wrong: Vec<bool> = judge(&mesh, &batch, &hit)
        .iter()
        .map(|v| v.is_wrong())
        .collect();
    // tmin is exclusive, tmax inclusive, and t itself is a float32 that can be compared.
    assert_eq!(wrong, [true, true, false, true, false]);
    let wrong =
        |verdicts: Vec<Verdict>| -> Vec<bool> { verdicts.iter().map(|v| v.is_wrong()).collect() };
    // At the very ends rounding may lose the hit.
    let ends = [false, false, true, false, false];
    assert_eq!(wrong(judge(&mesh, &batch, &Hits::misses(5))), ends);
    assert_eq!(wrong(judge_any(&mesh, &batch, &[0; 5])), ends);
    let ends = [true, true, false, false, false];
    assert_eq!(wrong(judge_any(&mesh, &batch, &[1; 5])), ends);
}

/// In the plane of a triangle t has no bound, but it still must lie in the triangle's box.
#[test]
fn a_ray_in_a_plane_excuses_no_far_hit() {
    let mesh = Mesh::new(vec![Triangle::new(
        Vec3::new(-0.31, -0.7, 0.13),
        Vec3::new(0.9, -0.6, 0.41),
        Vec3::new(0.1, 0.8, 0.77),
    )]);
    let t = mesh.triangles()[0];
    let target = (t.a + t.b + t.c) / 3.0;
    let batch: Batch =
        std::iter::once(Ray::new(t.a + 4.0 * (t.a - target), target - t.a)).collect();
    let answer = |x: f32| {
        judge(
            &mesh,
            &batch,
            &Hits {
                t: vec![x],
                prim: vec![0],
            },
        )[0]
    };
    assert!(!judge(&mesh, &batch, &Hits::misses(1))[0].is_wrong());
    assert!(!answer(4.9).is_wrong(), "{:?}", answer(4.9));
    assert!(answer(50.0).is_wrong() && answer(1.0).is_wrong());
}

#[test]
fn leaves_out_rays_whose_products_overflow() {
    let huge = |x: f32| Vec3::splat(x) * Vec3::new(1.0, 0.5, -0.3);
    let mesh = Mesh::new(vec![Triangle::new(
        huge(1e18),
        huge(-1e18),
        Vec3::new(1e18, 0.0, 1e17),
    )]);
    let batch: Batch = std::iter::once(Ray::new(Vec3::ZERO, Vec3::splat(1e20))).collect();
    assert_eq!(
        judge(&mesh, &batch, &Hits::misses(1)),
        [Verdict::OutOfRange]
    );
}
