//! The claims of Mora 2011.

use super::pool::{Batch, Pool, counter, preset};
use super::values::best_other;
use super::{Claim, Effect, Found, MemoryUse, Verdict, apart, falsified_above, falsified_below};
use crate::estimate::{Quantity, estimate, geometric};
use crate::statistics::{median, quantile};
use dacrt::Method;

const PRIMARY: &str = "primary";

fn is_primary(batch: &Batch) -> bool {
    batch.key.rays == PRIMARY
}

/// C13: time with the median of space over that with the estimate.
pub fn estimate_of_split(claim: &Claim, pool: &Pool) -> Found {
    let median = preset(Method::Mora2011).with("estimate_from", u32::MAX);
    let views = pool.times(&median, &preset(Method::Mora2011));
    let Some(time) = estimate(&views, geometric) else {
        return Found::not_testable("no batches with the median of space");
    };
    let mut parts = Vec::new();
    for scene in pool.scenes() {
        let own: Vec<_> = views.iter().filter(|v| v.scene == scene).cloned().collect();
        parts.extend(estimate(&own, geometric).map(|e| Effect::new(scene, e)));
    }
    Found {
        verdict: falsified_below(&time, 1.0 + claim.limits["gain"]),
        effect: Some(Effect::new(
            "time with the median over that with the estimate",
            time,
        )),
        parts,
        why: String::new(),
    }
}

/// C14: time at the best other limit.
pub fn limits(claim: &Claim, pool: &Pool) -> Found {
    best_other(
        claim,
        pool,
        Method::Mora2011,
        &["ray_limit", "triangle_limit"],
    )
}

/// C15: ray/box tests a ray.
pub fn tests_a_ray(claim: &Claim, pool: &Pool) -> Found {
    by_scene_in_range(
        claim,
        pool,
        "ray/box tests a ray, median of scenes",
        |batches| {
            let batch = batches.iter().find(|batch| is_primary(batch))?;
            let cell = batch.cell(&preset(Method::Mora2011))?;
            Some(counter(cell, "ray_box") / cell.ray_count as f64)
        },
    )
}

/// C18: time of primary and shadow rays over that of primary rays.
pub fn point_light(claim: &Claim, pool: &Pool) -> Found {
    by_scene_in_range(
        claim,
        pool,
        "time with a light over that without, median of scenes",
        |batches| {
            let ms = |rays: &str| {
                let batch = batches.iter().find(|batch| batch.key.rays == rays)?;
                batch.cell(&preset(Method::Mora2011Cones))?.median_ms
            };
            let (primary, shadow) = (ms(PRIMARY)?, ms("shadow-point")?);
            Some((primary + shadow) / primary)
        },
    )
}

/// Falsified where the medians over the cameras of at least half of the scenes are out of a range.
fn by_scene_in_range(
    claim: &Claim,
    pool: &Pool,
    what: &str,
    of_picture: impl Fn(&[&Batch]) -> Option<f64>,
) -> Found {
    let range = claim.limits["low"]..=claim.limits["high"];
    let (mut parts, mut medians) = (Vec::new(), Vec::new());
    for scene in pool.scenes() {
        let values = pool.by_camera(
            |batch| batch.key.scene == scene,
            |batches| of_picture(batches).map(Quantity::Number),
        );
        let Some(value) = median(&values) else {
            continue;
        };
        medians.push(value);
        parts.push(Effect {
            name: scene.to_owned(),
            value,
            interval: Some([0.05, 0.95].map(|q| quantile(&values, q).unwrap_or(value))),
        });
    }
    let outside = medians
        .iter()
        .filter(|median| !range.contains(median))
        .count();
    let Some(value) = median(&medians) else {
        return Found::not_testable("no batches");
    };
    parts.push(Effect::count("scenes outside", outside as f64));
    Found {
        verdict: match 2 * outside >= medians.len() {
            true => Verdict::Contradicted,
            false => Verdict::Supported,
        },
        effect: Some(Effect {
            name: what.to_owned(),
            value,
            interval: Some([0.0, 1.0].map(|q| quantile(&medians, q).unwrap_or(value))),
        }),
        parts,
        why: "intervals: 5 to 95 % of cameras, least and greatest scene".to_owned(),
    }
}

/// C16: tests of rays sent one by one through stored splits.
pub fn stored_twin(_: &Claim, pool: &Pool) -> Found {
    let cells = pool.batches.iter().flat_map(|batch| &batch.cells);
    let twins = cells.filter_map(|cell| cell.twin.as_ref());
    let twins: Vec<_> = twins
        .filter(|twin| twin.one_by_one_ray_box.is_some())
        .collect();
    if twins.is_empty() {
        return Found::not_testable("no stored splits");
    }
    let unequal = twins.iter().filter(|twin| !twin.is_equal()).count();
    let tests: u64 = twins.iter().map(|t| t.ray_box + t.ray_triangle).sum();
    Found {
        verdict: match unequal {
            0 => Verdict::Supported,
            _ => Verdict::Contradicted,
        },
        effect: Some(Effect::count("traces with other tests", unequal as f64)),
        parts: vec![
            Effect::count("traces", twins.len() as f64),
            Effect::count("tests compared", tests as f64),
        ],
        why: String::new(),
    }
}

/// C17: time with the test of planes, and without the nine axes.
pub fn triangle_tests(claim: &Claim, pool: &Pool) -> Found {
    let own = || preset(Method::Mora2011);
    let of = |with| estimate(&pool.times(&with, &own()), geometric);
    let planes = of(own().with("plane_test", true));
    let without_axes = of(own().with("nine_axes_below", 0));
    let (Some(planes), Some(without_axes)) = (planes, without_axes) else {
        return Found::not_testable("no batches with the other tests");
    };
    // Both must be slower than without that change.
    let limit = 1.0 - claim.limits["gain"];
    let verdicts = [&planes, &without_axes].map(|time| falsified_below(time, limit));
    let parts = vec![
        Effect::new("time with the plane test over without", planes),
        Effect::new("time without the nine axes over with", without_axes),
    ];
    Found {
        verdict: verdicts[0].min(verdicts[1]),
        effect: parts
            .iter()
            .min_by(|a, b| a.value.total_cmp(&b.value))
            .cloned(),
        parts,
        why: String::new(),
    }
}

/// C19: frames a second of Embree's trace alone, and of stored splits.
pub fn stored_tree(claim: &Claim, pool: &Pool) -> Found {
    let embree = |batch: &Batch| {
        let cell = batch.cell(&preset(Method::Mora2011Cones))?;
        Some(Quantity::Number(
            cell.median_ms? / cell.embree.as_ref()?.best_trace_ms,
        ))
    };
    let Some(faster) = estimate(&pool.each(is_primary, embree), geometric) else {
        return Found::not_testable("no primary rays in cones beside Embree");
    };
    let twin = |batch: &Batch| {
        let twin = batch.cell(&preset(Method::Mora2011))?.twin.as_ref()?;
        Some(Quantity::Number(twin.trace_over_twin))
    };
    let mut parts = Vec::new();
    let splits = estimate(&pool.each(is_primary, twin), geometric);
    parts.extend(splits.map(|e| Effect::new("own splits, stored, over a trace without cones", e)));
    for scene in pool.scenes() {
        let views = pool.each(|b| is_primary(b) && b.key.scene == scene, embree);
        parts.extend(estimate(&views, geometric).map(|e| Effect::new(scene, e)));
    }
    Found {
        verdict: falsified_above(&faster, claim.limits["mean"]),
        effect: Some(Effect::new(
            "frames a second of Embree's trace alone over ours",
            faster,
        )),
        parts,
        why: String::new(),
    }
}

/// C22: bytes a ray and a triangle as batches and meshes grow, and stack.
pub fn memory(claim: &Claim, pool: &Pool) -> Found {
    type Count = fn(&MemoryUse) -> usize;
    let (rays, triangles): (Count, Count) = (|m| m.rays, |m| m.triangles);
    let slopes = |grown: Count, fixed: Count| {
        let mut growths = Vec::new();
        for first in pool.memory {
            let mut line: Vec<&MemoryUse> = (pool.memory.iter())
                .filter(|m| fixed(m) == fixed(first) && m.method == first.method)
                .collect();
            line.sort_by_key(|m| grown(m));
            line.dedup_by_key(|m| grown(m));
            let slope = |pair: &[&MemoryUse]| {
                let [a, b] = [pair[0], pair[1]];
                let bytes = b.workspace_bytes as f64 - a.workspace_bytes as f64;
                bytes / (grown(b) as f64 - grown(a) as f64)
            };
            let slopes: Vec<f64> = line.windows(2).map(slope).collect();
            growths.extend(slopes.windows(2).map(|pair| pair[1] / pair[0] - 1.0));
        }
        growths.into_iter().fold(f64::NAN, f64::max)
    };
    let growth = [slopes(rays, triangles), slopes(triangles, rays)];
    let stack = pool.memory.iter().map(|m| m.stack_bytes).max();
    let (Some(stack), [a, b]) = (stack, growth) else {
        return Found::not_testable("no memory was measured");
    };
    let stack = stack as f64 / 1024.0;
    let mut parts = vec![
        Effect::count("greatest growth of bytes a ray", a),
        Effect::count("greatest growth of bytes a triangle", b),
    ];
    for of in pool.memory {
        let name = format!("stack KiB, {} {} rays {}", of.scene, of.method, of.rays);
        parts.push(Effect::count(name, of.stack_bytes as f64 / 1024.0));
    }
    let holds = a <= claim.limits["growth"] && b <= claim.limits["growth"];
    Found {
        verdict: match holds && stack <= claim.limits["stack_kib"] {
            true => Verdict::Supported,
            false => Verdict::Contradicted,
        },
        effect: Some(Effect::count("greatest stack, KiB", stack)),
        parts,
        why: String::new(),
    }
}

/// C23: time by octants over that by counts of directions.
pub fn octants(claim: &Claim, pool: &Pool) -> Found {
    let octants = preset(Method::Mora2011).with("octants", true);
    let without_origin = |batch: &Batch| !is_primary(batch);
    let views = pool.each(without_origin, |b| {
        b.times(&octants, &preset(Method::Mora2011))
    });
    let Some(time) = estimate(&views, geometric) else {
        return Found::not_testable("no rays of many origins");
    };
    Found {
        verdict: apart(&time, claim.limits["difference"]),
        effect: Some(Effect::new("time by octants over that by counts", time)),
        parts: Vec::new(),
        why: String::new(),
    }
}
