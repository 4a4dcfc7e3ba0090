//! A replay as JSON.

use super::Replay;
use dacrt::{Aabb, Event, Step, Sure, TriangleTest};
use dacrt_validate::diff::Number;
use dacrt_validate::npy::ray_floats;
use dacrt_validate::parameters::own_fields;
use serde::Serialize;
use serde_json::{Value, json};

/// Digits of exact t.
const DIGITS: usize = 60;

impl Replay {
    /// All of it. Floats that JSON has no number for are words: `inf`, `-inf`, `nan`.
    pub fn json(&self) -> Value {
        let case = &self.case;
        let ray = case.ray();
        let floats = ray_floats(&ray);
        let opinions: Vec<Value> = (self.opinions.iter())
            .map(|o| json!({ "who": o.who, "answer": plain(&o.answer), "verdict": plain(&o.verdict) }))
            .collect();
        let hits: Vec<Value> = (self.hits.iter())
            .map(|hit| {
                let t = hit.t.to_f32();
                json!({
                    "prim": hit.prim, "t": hit.t.decimal(DIGITS), "t_float32": number(t),
                    "t_bits": bits(t),
                })
            })
            .collect();
        json!({
            "from": case.from,
            "index": case.index,
            "ray_count": case.batch.len(),
            "ray": floats.map(number),
            "ray_bits": floats.map(bits),
            "valid": ray.is_valid(),
            "any_hit": case.any_hit,
            "triangles": case.mesh.len(),
            "shared_origin": self.trace.shared_origin,
            "method": case.method.name(),
            "precision": case.precision.name(),
            "parameters": own_fields(case.method, &case.parameters),
            "seed": case.seed,
            "hits_as_in_file": self.as_then,
            "steps": self.steps.iter().map(step).collect::<Vec<_>>(),
            "answers": opinions,
            "exact_hits": hits,
            "findings": self.findings,
        })
    }
}

fn step(step: &Step) -> Value {
    let Step {
        depth,
        bounds: Aabb { min, max },
        triangles,
        rays,
        interval,
        best: (t, prim),
        ref event,
    } = *step;
    let mut value = json!({
        "depth": depth,
        "box": [min.to_array().map(number), max.to_array().map(number)],
        "triangles": triangles,
        "rays": rays,
        "interval": interval.map(number),
        "best": { "t": number(t), "prim": prim },
        "event": match event {
            Event::Kept => "kept",
            Event::Rejected => "rejected",
            Event::Skipped { .. } => "skipped",
            Event::KeptWithCone => "kept_with_cone",
            Event::RejectedWithCone => "rejected_with_cone",
            Event::KeptWithGroup => "kept_with_group",
            Event::RejectedWithGroup => "rejected_with_group",
            Event::Empty => "empty",
            Event::Leaf(_) => "leaf",
            Event::Terminated => "terminated",
        },
    });
    match event {
        Event::Skipped { ratio } => value["ratio"] = number(*ratio),
        Event::Leaf(tests) => value["tests"] = tests.iter().map(test).collect(),
        _ => {}
    }
    value
}

fn test(test: &TriangleTest) -> Value {
    json!({
        "prim": test.prim,
        "u": number(test.u),
        "v": number(test.v),
        "w": number(test.w),
        "edge_error": number(test.edge_error),
        "num": number(test.num),
        "den": number(test.den),
        "t": number(test.t),
        "clip": test.clip.map(number),
        "sure": match test.sure {
            Sure::Hit => "hit",
            Sure::Miss => "miss",
            Sure::Open => "open",
        },
        "exact_t": test.exact.map(number),
    })
}

fn number(x: f32) -> Value {
    plain(&Number(x))
}

/// With float32 in the fewest digits that tell them apart, which a [`Value`] made directly lacks.
fn plain(x: &impl Serialize) -> Value {
    let text = serde_json::to_string(x).expect("numbers and words");
    serde_json::from_str(&text).expect("JSON that was just made")
}

fn bits(x: f32) -> String {
    format!("{:#010x}", x.to_bits())
}
