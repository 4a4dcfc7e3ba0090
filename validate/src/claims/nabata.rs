//! The claims of Nabata 2013.

use super::pool::{Batch, Pool, Who, counter, preset};
use super::values::{OtherValue, best_other, effects, other_values};
use super::{
    Claim, Effect, Found, NodeStatistics, Verdict, apart, falsified_above, falsified_below,
};
use crate::estimate::{Estimate, Quantity, Seen, estimate, geometric, middle, trend};
use crate::statistics::quantile;
use dacrt::Method;

/// Fewer cameras than these have no range.
const CAMERAS: usize = 5;
/// Rays that are "a million".
const MILLION: usize = 1_000_000;

fn baseline() -> Who {
    preset(Method::Afra2012)
}

fn sampling() -> Who {
    preset(Method::Nabata2013)
}

/// C1: time with sampling over that without, scene by scene.
pub fn small_loss(claim: &Claim, pool: &Pool) -> Found {
    let views = pool.times(&sampling(), &baseline());
    let Some(all) = estimate(&views, geometric) else {
        return Found::not_testable("no small batches");
    };
    let limit = 1.0 + claim.limits["loss"];
    let (mut lost, mut perhaps, mut parts) = (0.0, 0.0, Vec::new());
    for scene in pool.scenes() {
        let own: Vec<_> = views.iter().filter(|v| v.scene == scene).cloned().collect();
        let Some(time) = estimate(&own, geometric) else {
            continue;
        };
        match falsified_above(&time, limit) {
            Verdict::Contradicted => lost += 1.0,
            Verdict::Undecided => perhaps += 1.0,
            _ => {}
        }
        parts.push(Effect::new(scene, time));
    }
    parts.push(Effect::count("scenes with more than 1 % lost", lost));
    let scenes = claim.limits["scenes"];
    Found {
        verdict: match () {
            _ if lost >= scenes => Verdict::Contradicted,
            _ if lost + perhaps < scenes => Verdict::Supported,
            _ => Verdict::Undecided,
        },
        effect: Some(Effect::new("time over baseline's", all)),
        parts,
        why: String::new(),
    }
}

/// C2: the share of ray/box tests that are of sample rays.
pub fn overhead(claim: &Claim, pool: &Pool) -> Found {
    let share = |batch: &Batch| {
        let cell = batch.cell(&sampling())?;
        let samples = counter(cell, "sample_box");
        Some(Quantity::Number(
            samples / (samples + counter(cell, "ray_box")),
        ))
    };
    let large = |batch: &Batch| batch.rays >= MILLION;
    let Some(tests) = estimate(&pool.each(large, share), middle) else {
        return Found::not_testable("no batch of a million rays");
    };
    let mut parts = Vec::new();
    for size in sizes(pool) {
        let views = pool.each(|batch| batch.size() == size, share);
        parts.extend(estimate(&views, middle).map(|e| Effect::new(of_size("share", size), e)));
    }
    // What 300 samples more cost, a test, tells what the tests of 100 cost.
    let of_time = |batch: &Batch| {
        let [few, many] = [
            batch.cell(&sampling())?,
            batch.cell(&sampling().with("samples", 400))?,
        ];
        let tests = [few, many].map(|cell| counter(cell, "sample_box"));
        let more = (tests[1] - tests[0]) / tests[0];
        let over = batch
            .times(&sampling().with("samples", 400), &sampling())?
            .value();
        Some(Quantity::Number((over - 1.0) / more))
    };
    let of_time = estimate(&pool.each(large, of_time), middle);
    parts.extend(of_time.map(|time| Effect::new("share of time, by 400 samples", time)));
    let by_tests = falsified_above(&tests, claim.limits["share"]);
    let by_time = of_time.map_or(Verdict::Undecided, |time| {
        falsified_above(&time, claim.limits["time"])
    });
    Found {
        verdict: by_tests.min(by_time),
        effect: Some(Effect::new("share of ray/box tests, median", tests)),
        parts,
        why: String::new(),
    }
}

/// C3: triangles binned, and tests of sample rays, over the triangles binned without sampling.
pub fn construction(claim: &Claim, pool: &Pool) -> Found {
    let over = |names: &'static [&str]| {
        move |batch: &Batch| {
            let (with, without) = (batch.cell(&sampling())?, batch.cell(&baseline())?);
            let binned = counter(without, "binned_triangles");
            let sum: f64 = names.iter().map(|name| counter(with, name)).sum();
            (binned > 0.0).then_some(Quantity::Number(sum / binned))
        }
    };
    let large = |batch: &Batch| batch.rays >= MILLION;
    let work = pool.each(large, over(&["binned_triangles", "sample_box"]));
    let Some(work) = estimate(&work, middle) else {
        return Found::not_testable("no batch of a million rays");
    };
    let binned = estimate(&pool.each(large, over(&["binned_triangles"])), middle);
    Found {
        verdict: falsified_above(&work, claim.limits["quotient"]),
        effect: Some(Effect::new(
            "work of construction over baseline's, median",
            work,
        )),
        parts: (binned.map(|e| Effect::new("triangles binned over baseline's", e)))
            .into_iter()
            .collect(),
        why: String::new(),
    }
}

/// C4: time of a trace over that with the splits of the primary rays.
pub fn reuse(claim: &Claim, pool: &Pool) -> Found {
    let of = |scene: &str, who: &Who| {
        let views = pool.each(
            |batch| batch.key.scene == scene,
            |batch| {
                let reuse = batch.cell(who)?.twin.as_ref()?.reuse.as_ref()?;
                let [trace, reused] = reuse.samples_ms.clone();
                Some(Quantity::Times([reused, trace]))
            },
        );
        estimate(&views, geometric)
    };
    let Some(sibenik) = of("sibenik", &baseline()) else {
        return Found::not_testable("no secondary rays on Sibenik");
    };
    let mut parts = Vec::new();
    for scene in pool.scenes() {
        for (who, method) in [(baseline(), "afra2012"), (sampling(), "nabata2013")] {
            let time = of(scene, &who);
            parts.extend(time.map(|time| Effect::new(format!("{scene}, {method}"), time)));
        }
    }
    Found {
        verdict: falsified_below(&sibenik, 1.0 - claim.limits["share"]),
        effect: Some(Effect::new(
            "time with the primary rays' splits over own",
            sibenik,
        )),
        parts,
        why: String::new(),
    }
}

/// C5: what the order by samples gains over that by one ray, bounce by bounce.
pub fn order_by_bounce(claim: &Claim, pool: &Pool) -> Found {
    let gain = |batch: &Batch| batch.times(&sampling().with("order", "one-ray"), &sampling());
    let whole = pool.studies.first().map_or(0, |study| study.rays.len());
    let views = pool.views(
        |_| true,
        |batches| {
            let gains: Vec<Quantity> = batches.iter().filter_map(|b| gain(b)).collect();
            (gains.len() == whole).then_some(gains)
        },
    );
    let Some(rank) = estimate(&views, trend) else {
        return Found::not_testable("no view has all bounces");
    };
    let mut parts = Vec::new();
    for (bounce, rays) in pool.studies[0].rays.iter().enumerate() {
        let only = |seen: &[Seen]| {
            let only = |s: &Seen| s.values[bounce];
            let seen: Vec<Seen> = (seen.iter())
                .map(|s| Seen {
                    scene: s.scene,
                    values: vec![only(s)],
                })
                .collect();
            geometric(&seen)
        };
        let name = format!("one ray over samples, {rays}");
        parts.extend(estimate(&views, only).map(|e| Effect::new(name, e)));
    }
    Found {
        verdict: falsified_above(&rank, claim.limits["rank"]),
        effect: Some(Effect::new("rank correlation of gain and bounce", rank)),
        parts,
        why: String::new(),
    }
}

/// C6: how far intersection ratios are from the ratios of areas, bounce by bounce.
pub fn area_by_bounce(claim: &Claim, pool: &Pool) -> Found {
    let rays = pool.studies.first().map_or(&[][..], |study| &study.rays);
    let views = pool.node_views(|nodes| {
        let by_bounce = rays.iter().map(|rays| {
            let nodes = nodes.iter().find(|n| n.rays == *rays)?;
            Some(Quantity::Number(nodes.area_distance))
        });
        by_bounce.collect()
    });
    let Some(rank) = estimate(&views, trend) else {
        return Found::not_testable("no view has all bounces");
    };
    let mut parts = Vec::new();
    for rays in rays {
        let only = |value: fn(&NodeStatistics) -> f64| {
            pool.node_views(|nodes| {
                let nodes = nodes.iter().find(|n| n.rays == *rays)?;
                Some(vec![Quantity::Number(value(nodes))])
            })
        };
        let distance = estimate(&only(|n| n.area_distance), middle);
        parts.extend(distance.map(|e| Effect::new(format!("distance, {rays}"), e)));
        let regret = estimate(&only(|n| n.area_regret), middle);
        parts.extend(regret.map(|e| Effect::new(format!("cost over the least, {rays}"), e)));
    }
    Found {
        verdict: falsified_above(&rank, claim.limits["rank"]),
        effect: Some(Effect::new("rank correlation of distance and bounce", rank)),
        parts,
        why: String::new(),
    }
}

/// C7: time at the best limit for skipping outside a range over that at the best one inside.
pub fn best_skip(claim: &Claim, pool: &Pool) -> Found {
    let mut limits = other_values(pool, Method::Nabata2013, "skip");
    // The paper's own value over itself.
    limits.push(OtherValue {
        value: 0.5,
        name: "skip 0.5".to_owned(),
        views: Vec::new(),
    });
    let time = |limit: &OtherValue| limit.time().map_or(1.0, |e| e.value);
    let range = claim.limits["low"]..=claim.limits["high"];
    let best = |inside: bool| {
        let some = limits.iter().filter(|l| range.contains(&l.value) == inside);
        let best = some.min_by(|a, b| time(a).total_cmp(&time(b)))?;
        Some(best.value)
    };
    let (Some(outside), Some(inside)) = (best(false), best(true)) else {
        return Found::not_testable("no limits for skipping");
    };
    let with = |limit: f64| sampling().with("skip", limit);
    let Some(quotient) = estimate(&pool.times(&with(outside), &with(inside)), geometric) else {
        return Found::not_testable("no limits for skipping");
    };
    Found {
        verdict: falsified_below(&quotient, 1.0 - claim.limits["gain"]),
        effect: Some(Effect::new(
            format!("time at {outside} over that at {inside}"),
            quotient,
        )),
        parts: effects(&limits),
        why: String::new(),
    }
}

/// C8: time with eq. 6 at leaves over that with eq. 5, by scene and ray type.
pub fn leaf_criterion(claim: &Claim, pool: &Pool) -> Found {
    let without = sampling().with("leaf_criterion", false);
    let Some(all) = estimate(&pool.times(&without, &sampling()), geometric) else {
        return Found::not_testable("no batches with the other criterion");
    };
    let mut parts = Vec::new();
    let (mut gains, mut perhaps) = (0.0, 0.0);
    for (scene, rays) in groups(pool) {
        let group = |b: &Batch| (b.key.scene.as_str(), b.key.rays.as_str()) == (scene, rays);
        let views = pool.each(group, |batch| batch.times(&without, &sampling()));
        let Some(time) = estimate(&views, geometric) else {
            continue;
        };
        match falsified_below(&time, claim.limits["gain"]) {
            Verdict::Supported => gains += 1.0,
            Verdict::Undecided => perhaps += 1.0,
            _ => {}
        }
        parts.push(Effect::new(format!("{scene} {rays}"), time));
    }
    let most = parts.iter().max_by(|a, b| a.value.total_cmp(&b.value));
    let most = most.map(|most| Effect {
        name: format!("most gained by eq. 5: {}", most.name),
        ..most.clone()
    });
    parts.push(Effect::new("geometric mean of all", all));
    let sum =
        |of: fn(&NodeStatistics) -> usize| pool.nodes.iter().map(|nodes| of(nodes) as f64).sum();
    parts.push(Effect::count("groups that gain", gains));
    parts.push(Effect::count(
        "leaves with more than 1,000 rays",
        sum(|n| n.large_leaves),
    ));
    parts.push(Effect::count(
        "nodes likewise that are split",
        sum(|n| n.splits),
    ));
    Found {
        verdict: match () {
            _ if gains > 0.0 => Verdict::Supported,
            _ if perhaps > 0.0 => Verdict::Undecided,
            _ => Verdict::Contradicted,
        },
        effect: most,
        parts,
        why: String::new(),
    }
}

/// C9: time at the best other value of a parameter.
pub fn printed_values(claim: &Claim, pool: &Pool) -> Found {
    let names = ["samples", "bins", "min_rays", "threshold"];
    best_other(claim, pool, Method::Nabata2013, &names)
}

/// C10: the acceleration ratio of each bounce of each scene.
pub fn every_bounce(claim: &Claim, pool: &Pool) -> Found {
    let ratio = |batch: &Batch| batch.times(&baseline(), &sampling());
    let mut worst: Option<(String, Estimate)> = None;
    let (mut parts, mut verdict) = (Vec::new(), Verdict::Supported);
    let bounces = groups(pool)
        .into_iter()
        .filter(|(_, rays)| *rays != "primary");
    for (scene, rays) in bounces {
        let group = |b: &Batch| (b.key.scene.as_str(), b.key.rays.as_str()) == (scene, rays);
        let Some(ratio) = estimate(&pool.each(group, ratio), geometric) else {
            continue;
        };
        verdict = verdict.min(falsified_below(&ratio, claim.limits["ratio"]));
        let name = format!("{scene} {rays}");
        if worst
            .as_ref()
            .is_none_or(|(_, w)| ratio.interval[1] < w.interval[1])
        {
            worst = Some((name.clone(), ratio));
        }
        parts.push(Effect::new(name, ratio));
    }
    let Some((name, ratio)) = worst else {
        return Found::not_testable("no batches");
    };
    Found {
        verdict,
        effect: Some(Effect::new(
            format!("least acceleration ratio: {name}"),
            ratio,
        )),
        parts,
        why: String::new(),
    }
}

/// C11: the acceleration ratio of a picture over cameras, at the largest size.
pub fn up_to_two(claim: &Claim, pool: &Pool) -> Found {
    let Some(size) = sizes(pool).pop() else {
        return Found::not_testable("no pictures");
    };
    let ray_types = pool.studies[0].rays.len();
    let sum = |batches: &[&Batch], who: &Who| {
        let samples = batches
            .iter()
            .map(|batch| batch.cell(who)?.samples_ms.as_ref());
        let samples: Vec<&Vec<f64>> = samples.collect::<Option<_>>()?;
        let repeats = samples.iter().map(|s| s.len()).min()?;
        let of = |i: usize| samples.iter().map(|s| s[i]).sum();
        Some((0..repeats).map(of).collect::<Vec<f64>>())
    };
    let picture = |batches: &[&Batch]| {
        let is_whole = batches.len() + pool.empty_beside(batches[0]) == ray_types;
        let times = [sum(batches, &baseline())?, sum(batches, &sampling())?];
        is_whole.then_some(Quantity::Times(times))
    };
    let is_largest = |batch: &Batch| batch.size() == size;
    let views = pool.views(is_largest, |batches| Some(vec![picture(batches)?]));
    let ratios = pool.by_camera(is_largest, picture);
    let Some(mean) = estimate(&views, geometric) else {
        return Found::not_testable("no whole picture");
    };
    let greatest = ratios.iter().copied().fold(f64::NAN, f64::max);
    let side = f64::from(size[0]) * f64::from(size[1]).sqrt();
    let why = format!("pictures of {side} x {side} rays");
    let mut parts = vec![Effect::count("greatest", greatest)];
    let cameras = ratios.len();
    if cameras < CAMERAS {
        parts.push(Effect::new("mean", mean));
        return Found {
            parts,
            ..Found::not_testable(&format!(
                "{why} of {cameras} cameras; a range needs {CAMERAS}"
            ))
        };
    }
    let range = [0.05, 0.95].map(|q| quantile(&ratios, q).unwrap_or(f64::NAN));
    let [low, high] = range;
    let (most, printed_mean) = (claim.limits["most"], claim.limits["mean"]);
    Found {
        verdict: match most > high && !(low..=high).contains(&printed_mean) {
            true => Verdict::Contradicted,
            false => Verdict::Supported,
        },
        effect: Some(Effect {
            name: "acceleration ratio of pictures, 5 to 95 % of cameras".to_owned(),
            value: mean.value,
            interval: Some(range),
        }),
        parts,
        why,
    }
}

/// C12: the acceleration ratio with many samples a pixel over that with as many pixels.
pub fn samples_as_pixels(claim: &Claim, pool: &Pool) -> Found {
    let mut pairs = sizes(pool);
    pairs.retain(|[side, spp]| {
        let rays = side * side * spp;
        let as_many = |other: &[u32; 2]| {
            other[0] * other[0] * other[1] == rays && (other[1] == 1) != (*spp == 1)
        };
        sizes(pool).iter().any(as_many)
    });
    let rays = |[side, spp]: &[u32; 2]| side * side * spp;
    let most = pairs.iter().map(rays).max();
    pairs.retain(|size| Some(rays(size)) == most);
    // One sample a pixel comes last.
    pairs.sort_by_key(|[_, spp]| std::cmp::Reverse(*spp));
    let [many, one] = pairs[..] else {
        return Found::not_testable("no two pictures of as many rays");
    };
    let ray_types = pool.studies.first().map_or(&[][..], |study| &study.rays);
    let views = pool.views(
        |_| true,
        |batches| {
            let ratios = ray_types.iter().map(|rays| {
                let of = |size: [u32; 2]| {
                    let is_it = |b: &&&Batch| b.key.rays == *rays && b.size() == size;
                    batches.iter().find(is_it)?.times(&baseline(), &sampling())
                };
                Some([of(many)?, of(one)?])
            });
            let ratios: Vec<[Quantity; 2]> = ratios.collect::<Option<_>>()?;
            Some(ratios.into_iter().flatten().collect())
        },
    );
    let over = |seen: &[Seen]| {
        let of = |s: &Seen| s.values.chunks(2).map(|pair| pair[0] / pair[1]).collect();
        let seen: Vec<Seen> = (seen.iter())
            .map(|s| Seen {
                scene: s.scene,
                values: of(s),
            })
            .collect();
        geometric(&seen)
    };
    let Some(quotient) = estimate(&views, over) else {
        return Found::not_testable("no view has both pictures");
    };
    Found {
        verdict: apart(&quotient, claim.limits["difference"]),
        effect: Some(Effect::new(
            "ratio with many samples over that with many pixels",
            quotient,
        )),
        parts: Vec::new(),
        why: format!(
            "{0} x {0} pixels with {1} samples and {2} x {2} with 1",
            many[0], many[1], one[0]
        ),
    }
}

/// Scenes and ray types that there are batches of.
fn groups<'p>(pool: &'p Pool) -> Vec<(&'p str, &'p str)> {
    let mut groups: Vec<(&str, &str)> = Vec::new();
    for scene in pool.scenes() {
        for batch in pool.batches.iter().filter(|b| b.key.scene == scene) {
            let group = (scene, batch.key.rays.as_str());
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
    }
    groups
}

/// Pixels a side and samples a pixel, fewest rays first.
fn sizes(pool: &Pool) -> Vec<[u32; 2]> {
    let mut sizes: Vec<[u32; 2]> = pool.batches.iter().map(Batch::size).collect();
    sizes.sort_by_key(|&[side, spp]| (side * side * spp, side));
    sizes.dedup();
    sizes
}

fn of_size(what: &str, [side, spp]: [u32; 2]) -> String {
    match spp {
        1 => format!("{what}, {side} x {side}"),
        _ => format!("{what}, {side} x {side} x {spp}"),
    }
}
