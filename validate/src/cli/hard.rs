//! `dacrt hard`: what comes of hard cases.

use super::Verdict;
use super::args::HardArgs;
use super::command_line;
use super::plan::{check_writable, distinct};
use super::progress::Progress;
use super::text::{columns, counted, print, thousands};
use anyhow::{Context, bail};
use dacrt::Isa;
use dacrt_validate::embree::Device;
use dacrt_validate::hard::trial::{Contestant, run};
use dacrt_validate::hard::{Counts, Document, FAMILIES, Family, Finding, KIND};
use dacrt_validate::machine::{Machine, Software};

/// Heads of the table, two lines, in the order of [`Contestant::all`].
const HEADS: [[&str; 2]; 7] = [
    ["", "fast"],
    ["water-", "tight"],
    ["", "exact"],
    ["Embree", "fast"],
    ["Embree", "robust"],
    ["fast", "ftz"],
    ["robust", "ftz"],
];

/// Traces, judges, writes and prints.
pub fn hard(args: &HardArgs) -> anyhow::Result<Verdict> {
    let families = match &args.families {
        None => FAMILIES.to_vec(),
        Some(names) => distinct(names).map(family).collect::<anyhow::Result<_>>()?,
    };
    check_writable(&args.out).context("--out")?;
    let device = Device::new(1)?;
    let mut document = Document {
        kind: KIND.to_owned(),
        machine: Machine::here(Isa::best().name()),
        software: Software::this(Some(device.info().into())),
        seed: args.seed,
        command: command_line(),
        mxcsr_ftz: None,
        families: Vec::new(),
        findings: Vec::new(),
    };
    let progress = Progress::new(&vec![1.0; families.len()]);
    for family in &families {
        progress.step(family.name);
        let outcome = run(family, args.rays as usize, args.seed, &device)?;
        document.families.push(outcome.result);
        document.findings.extend(outcome.findings);
        document.mxcsr_ftz = document.mxcsr_ftz.or(outcome.mxcsr_ftz);
        progress.advance(1.0);
    }
    progress.finish();
    let path = args.out.display();
    (document.write(&args.out)).with_context(|| format!("{path}: cannot be written"))?;
    print(&format!("{}\nresults: {path}\n", text(&document)))?;
    Ok(
        match document.families.iter().any(|f| !f.findings.is_empty()) {
            true => Verdict::Finding,
            false => Verdict::Good,
        },
    )
}

fn family(name: &str) -> anyhow::Result<Family> {
    let names = FAMILIES.map(|family| family.name);
    match FAMILIES.iter().find(|family| family.name == name) {
        Some(family) => Ok(*family),
        None => bail!(
            "--families {name}: there is no such family; there are {}",
            names.join(", ")
        ),
    }
}

/// The table for people, 100 columns at most, and the findings.
fn text(document: &Document) -> String {
    let mut table: Vec<Vec<String>> = Vec::new();
    for line in [0, 1] {
        let start = [["", ""], ["family", "rays"]][line].map(str::to_owned);
        let heads = HEADS.map(|head| head[line].to_owned());
        table.push(start.into_iter().chain(heads).collect());
    }
    for family in &document.families {
        let mark = if family.promised < family.rays {
            " *"
        } else {
            ""
        };
        table.push(vec![family.name.clone() + mark, thousands(family.rays)]);
        let all: Vec<&Counts> = Contestant::all()
            .map(|contestant| &family.contestants[contestant.name()])
            .collect();
        let of = |count: fn(&Counts) -> u64| all.iter().map(|&c| count(c)).collect::<Vec<_>>();
        for (kind, counts) in [
            ("lost", of(|c| c.lost)),
            ("false", of(|c| c.false_hits)),
            ("wrong", of(|c| c.wrong)),
            ("beyond", of(|c| c.beyond_bounds)),
            ("differ", of(|c| c.methods_differ)),
        ] {
            if counts.iter().all(|&n| n == 0) {
                continue;
            }
            let rates = counts.iter().map(|&n| rate(n, family.rays));
            let start = [format!("  {kind}"), String::new()];
            table.push(start.into_iter().chain(rates).collect());
        }
    }
    let right: Vec<usize> = (1..2 + HEADS.len()).collect();
    let mut text = columns(&table, &right);
    text += "\n\
Rays per million that are not answered as by exact arithmetic (0: `.`; kinds that nobody has are
left out). *: for some or all rays fast and watertight promise nothing. More: dacrt hard --help

";
    let of_family = document
        .families
        .iter()
        .map(|family| (family, &family.findings));
    let all = of_family.flat_map(|(family, found)| found.iter().map(move |found| (family, found)));
    let mut any = false;
    for (family, found) in all {
        any = true;
        let is = |f: &&Finding| {
            (&f.family, &f.contestant, f.what) == (&family.name, &found.contestant, found.what)
        };
        let first = document
            .findings
            .iter()
            .find(is)
            .expect("the first are kept");
        text += &format!(
            "finding: {}, {}: {}: {}, first ray {} of '{}'\n",
            family.name,
            found.contestant,
            found.what.words(),
            counted(found.rays, "ray"),
            first.index,
            first.case
        );
    }
    if !any {
        text += "no findings\n";
    }
    text
}

/// Per million, or `.` for none.
fn rate(n: u64, of: u64) -> String {
    match n {
        0 => ".".to_owned(),
        n => thousands((n as f64 * 1e6 / of as f64).round().max(1.0) as u64),
    }
}
