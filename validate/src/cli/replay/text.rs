//! A replay as text for people.

use super::words::{self, best, digits, five};
use super::{Opinion, Replay};
use crate::cli::text::{WIDTH, columns, counted, thousands};
use dacrt::{Event, Ray, Step, TriangleTest};
use dacrt_validate::npy::ray_floats;

/// Triangles of a leaf that are shown.
const MOST_TESTS: usize = 32;
/// Exact hits that are shown.
const MOST_HITS: usize = 6;
/// Digits of exact t.
const DIGITS: usize = 30;

impl Replay {
    /// All of it; no line is longer than 100 columns, but for names.
    pub fn text(&self) -> String {
        let mut text = self.head();
        text += &self.path();
        text += &self.judged();
        text += &self.nearest();
        for finding in &self.findings {
            text += &format!("\nFINDING: {finding}");
        }
        text.trim_end().to_owned() + "\n"
    }

    fn head(&self) -> String {
        let case = &self.case;
        let ray = case.ray();
        let mut text = format!(
            "ray {} of {}, {} on {}\n",
            thousands(case.index as u64),
            counted(case.batch.len() as u64, "ray"),
            if case.any_hit {
                "any hit"
            } else {
                "nearest hit"
            },
            counted(case.mesh.len() as u64, "triangle"),
        );
        text += &format!("from {}\n\n", case.from);
        let names = ["ox", "oy", "oz", "tmin", "dx", "dy", "dz", "tmax"];
        let rows: Vec<Vec<String>> = (names.iter().zip(ray_floats(&ray)))
            .map(|(name, x)| {
                vec![
                    (*name).to_owned(),
                    digits(x),
                    format!("{:#010x}", x.to_bits()),
                ]
            })
            .collect();
        text += &columns(&rows, &[1]);
        if !ray.is_valid() {
            text += &format!("invalid, and so a miss: {}\n", words::why_invalid(&ray));
        }
        let origin = match self.trace.shared_origin {
            true => "the batch shares its origin",
            false => "the rays have origins of their own",
        };
        text += &format!("{origin}\n");
        text += match self.as_then {
            None => "",
            Some(true) => "the batch has the hits that the result file says\n",
            Some(false) => "the batch has OTHER HITS than the result file says\n",
        };
        text
    }

    /// The steps.
    fn path(&self) -> String {
        let case = &self.case;
        let leaves = self
            .steps
            .iter()
            .filter(|s| matches!(s.event, Event::Leaf(_)));
        let leaves = leaves.count();
        let boxes = self.steps.len() - leaves;
        let mut text = format!(
            "\npath: {} {}, {} and {}\n",
            case.method,
            case.precision,
            counted(boxes as u64, "step"),
            if leaves == 1 {
                "1 leaf".to_owned()
            } else {
                format!("{leaves} leaves")
            }
        );
        let mut rows = vec![];
        let head = [
            "depth",
            "triangles",
            "rays",
            "near",
            "far",
            "best t (prim)",
            "",
        ];
        rows.push(head.map(str::to_owned).to_vec());
        for step in &self.steps {
            let [near, far] = step.interval;
            rows.push(vec![
                step.depth.to_string(),
                thousands(step.triangles as u64),
                thousands(step.rays as u64),
                digits(near),
                digits(far),
                best(step.best),
                words::event(step),
            ]);
        }
        let table = columns(&rows, &[0, 1, 2, 3, 4, 5]);
        let mut lines = table.lines();
        text += lines.next().unwrap_or_default();
        text.push('\n');
        for (line, step) in lines.zip(&self.steps) {
            text += &format!("{line}\n");
            match &step.event {
                Event::Leaf(tests) => text += &self.leaf(step, tests),
                _ => text += &bounds(step),
            }
        }
        text
    }

    /// The triangles of a leaf.
    fn leaf(&self, step: &Step, tests: &[TriangleTest]) -> String {
        let (ray, precision) = (self.case.ray(), self.case.precision);
        let head = ["", "prim", "U", "V", "W", "±", "t", ""];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let mut details = vec![String::new()];
        for test in tests.iter().take(MOST_TESTS) {
            rows.push(vec![
                String::new(),
                test.prim.to_string(),
                five(test.u),
                five(test.v),
                five(test.w),
                format!("{:.1e}", test.edge_error),
                digits(test.t),
                words::test(test, precision, &ray, step.best.0),
            ]);
            details.push(detail(test, &ray));
        }
        let table = columns(&rows, &[1, 2, 3, 4, 5, 6]);
        let mut text = String::new();
        for (line, detail) in table.lines().zip(details) {
            text += &format!("{line}\n{detail}");
        }
        if tests.len() > MOST_TESTS {
            let more = counted((tests.len() - MOST_TESTS) as u64, "more triangle");
            text += &format!("    and {more} (--json has them all)\n");
        }
        text
    }

    fn judged(&self) -> String {
        let mut rows = vec![];
        for Opinion {
            who,
            answer,
            verdict,
            ..
        } in &self.opinions
        {
            rows.push(vec![
                who.clone(),
                words::answer(*answer),
                words::verdict(*verdict),
            ]);
        }
        format!("\nanswers: prim, t\n{}", columns(&rows, &[]))
    }

    fn nearest(&self) -> String {
        let all = counted(self.case.mesh.len() as u64, "triangle");
        let mut text = match self.hits.len() {
            0 => format!("\nin exact arithmetic, of {all}, none is hit\n"),
            n => format!(
                "\nin exact arithmetic, of {all}, {} hit, nearest first\n",
                match n {
                    1 => "1 is".to_owned(),
                    n => format!("{} are", thousands(n as u64)),
                }
            ),
        };
        let mut rows = Vec::new();
        for (i, hit) in self.hits.iter().enumerate().take(MOST_HITS) {
            let tie = i > 0 && self.hits[i - 1].t == hit.t;
            rows.push(vec![
                hit.prim.to_string(),
                hit.t.decimal(DIGITS),
                format!("rounded {}", words::float(hit.t.to_f32())),
                if tie { "as near" } else { "" }.to_owned(),
            ]);
        }
        text += &columns(&rows, &[0]);
        text
    }
}

/// The box of a step.
fn bounds(step: &Step) -> String {
    let side = |axis: usize| {
        let (lo, hi) = (step.bounds.min[axis], step.bounds.max[axis]);
        format!("{} {} .. {}", ["x", "y", "z"][axis], five(lo), five(hi))
    };
    format!("       {}   {}   {}\n", side(0), side(1), side(2))
}

/// More of a triangle that the ray is inside of, or may be.
fn detail(test: &TriangleTest, ray: &Ray) -> String {
    let least = -test.edge_error;
    if ray.is_valid() && [test.u, test.v, test.w].iter().any(|x| *x < least) {
        return String::new();
    }
    let TriangleTest {
        num,
        den,
        clip: [near, far],
        ..
    } = *test;
    let exact = match test.exact {
        Some(t) => format!("exactly met at {}", digits(t)),
        None => "exactly not met".to_owned(),
    };
    let line = format!(
        "         {} / {}, in its box {} .. {},",
        digits(num),
        digits(den),
        digits(near),
        digits(far)
    );
    match line.len() + 1 + exact.len() <= WIDTH {
        true => format!("{line} {exact}\n"),
        false => format!("{line}\n         {exact}\n"),
    }
}
