//! `dacrt replay`: one ray, step by step, and who is right about it.

mod args;
mod case;
mod json;
mod text;
mod words;

pub use args::ReplayArgs;

use super::Verdict;
use super::run::Answers;
use super::text::print;
use case::Case;
use dacrt::{Batch, Hits, Method, Precision, Step, Trace, Tracer};
use dacrt_validate::bounds::Kernel;
use dacrt_validate::embree::{Device, Quality, Query, Scene};
use dacrt_validate::exact::{Nearest, every_hit};
use dacrt_validate::hash::hit_hash;
use dacrt_validate::judge::{self, Answer, Judge};

/// What became of the ray.
struct Replay {
    case: Case,
    trace: Trace,
    steps: Vec<Step>,
    /// Whether the hits of the batch are those that the result file has.
    as_then: Option<bool>,
    opinions: Vec<Opinion>,
    /// All hits in exact arithmetic, the nearest first.
    hits: Vec<Nearest>,
    /// What must not be, in words.
    findings: Vec<String>,
}

/// What somebody says of the ray.
struct Opinion {
    who: String,
    answer: Answer,
    verdict: judge::Verdict,
    ours: bool,
}

/// Traces the batch with an eye on one ray, and asks everybody.
pub fn replay(args: &ReplayArgs) -> anyhow::Result<Verdict> {
    let case = Case::new(args)?;
    let replay = Replay::of(case)?;
    print(&match args.json {
        true => serde_json::to_string_pretty(&replay.json())? + "\n",
        false => replay.text(),
    })?;
    Ok(match replay.findings.is_empty() {
        true => Verdict::Good,
        false => Verdict::Finding,
    })
}

impl Replay {
    fn of(case: Case) -> anyhow::Result<Replay> {
        let Case {
            mesh,
            batch,
            index,
            any_hit,
            precision,
            ..
        } = &case;
        let (index, any) = (*index, *any_hit);
        let tracer = case.tracer();
        let mut workspace = tracer.workspace(batch.len(), mesh.len());
        let (trace, steps, answers) = if any {
            let mut occluded = vec![0; batch.len()];
            let (trace, steps) =
                tracer.watch_any(mesh, batch, &mut workspace, &mut occluded, index);
            (trace, steps, Answers::Any(occluded))
        } else {
            let mut hits = Hits::misses(batch.len());
            let (trace, steps) =
                tracer.watch_nearest(mesh, batch, &mut workspace, &mut hits, index);
            (trace, steps, Answers::Nearest(hits))
        };
        let as_then = (case.hit_hash.as_ref()).map(|then| *then == hit_hash(&answers.view()));

        // Alone, and by the baseline: which must change nothing.
        let alone = Batch::from_iter([case.ray()]);
        let mut asked = vec![(
            format!("{} {precision}, in the batch", case.method),
            Kernel::of(*precision),
            only(&answers, index),
        )];
        for precision in Precision::ALL {
            let tracer = Tracer::new(Method::Afra2012.parameters())
                .with_isa(case.isa)
                .with_precision(precision)
                .with_own_origins(!trace.shared_origin);
            let mut answers = Answers::room(1, any);
            let mut workspace = tracer.workspace(1, mesh.len());
            answers.trace(&tracer, mesh, &alone, &mut workspace);
            asked.push((
                format!("{precision}, alone"),
                Kernel::of(precision),
                answers,
            ));
        }
        let ours = asked.len();
        let device = Device::new(1)?;
        for (name, robust, kernel) in [
            ("Embree fast", false, Kernel::EmbreeFast),
            ("Embree robust", true, Kernel::EmbreeRobust),
        ] {
            let scene = Scene::build(&device, mesh, Quality::Medium, robust)?;
            let mut answers = Answers::room(1, any);
            answers.trace_embree(&scene, &alone, Query::Single);
            asked.push((name.to_owned(), kernel, answers));
        }

        let judge = Judge::new(mesh);
        let views: Vec<_> = asked.iter().map(|(_, k, a)| (*k, a.view())).collect();
        let judgement = judge.judge(&alone, &[0], &views).remove(0);
        let opinions = asked.iter().zip(judgement.verdicts).enumerate();
        let opinions: Vec<Opinion> = opinions
            .map(|(i, ((who, _, answers), verdict))| Opinion {
                who: who.clone(),
                answer: answers.view().get(0),
                verdict,
                ours: i < ours,
            })
            .collect();
        let hits = every_hit(mesh, &case.ray());

        let mut findings = Vec::new();
        for opinion in opinions.iter().filter(|o| o.ours && o.verdict.is_wrong()) {
            findings.push(format!("{}: a wrong answer", opinion.who));
        }
        let same = Precision::ALL.iter().position(|p| p == precision);
        let same = same.and_then(|place| opinions.get(1 + place));
        if let Some(alone) = same.filter(|alone| alone.answer != opinions[0].answer) {
            findings.push(format!("{} and {} differ", opinions[0].who, alone.who));
        }
        if judgement.nearest.as_ref() != hits.first() {
            findings.push("the exact arbiter's search and all triangles tried differ".to_owned());
        }
        Ok(Replay {
            case,
            trace,
            steps,
            as_then,
            opinions,
            hits,
            findings,
        })
    }
}

/// The answer for one ray.
fn only(answers: &Answers, ray: usize) -> Answers {
    match answers {
        Answers::Nearest(hits) => Answers::Nearest(Hits {
            t: vec![hits.t[ray]],
            prim: vec![hits.prim[ray]],
        }),
        Answers::Any(occluded) => Answers::Any(vec![occluded[ray]]),
    }
}
