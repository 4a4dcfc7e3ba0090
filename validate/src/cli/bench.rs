//! `dacrt bench`: the kernels one by one, what each numerical ingredient does, how time grows, and
//! threads that trace a batch each.

use super::Verdict;
use super::args::{Bench, BenchArgs, ThroughputArgs};
use super::growth::growth;
use super::ingredients::ingredients;
use super::plan::{check_writable, distinct, isa};
use super::progress::Progress;
use super::text::{columns, complain, print};
use super::throughput::throughput;
use anyhow::{Context, ensure};
use dacrt::Isa;
use dacrt::bench::KERNELS;
use dacrt_validate::kernels::{Document, Figure, Level, Plan, Printed, Timing, measure};
use dacrt_validate::machine::Machine;

/// Measures, writes and prints. A finding is a kernel that answers differently on two instruction
/// sets, a precision that breaks its promise, or a wrong hit.
pub fn bench(args: &BenchArgs) -> anyhow::Result<Verdict> {
    let isas = match &args.isa {
        None => Isa::available().collect(),
        Some(names) => distinct(names).map(isa).collect::<anyhow::Result<_>>()?,
    };
    let ThroughputArgs {
        resolution,
        rays,
        methods,
        threads,
    } = &args.throughput;
    for (option, is_given) in [
        ("--resolution", resolution.is_some()),
        ("--rays", rays.is_some()),
        ("--methods", methods.is_some()),
        ("--threads", threads.is_some()),
    ] {
        ensure!(
            !is_given || matches!(args.what, Bench::Throughput),
            "{option} is for `bench throughput`"
        );
    }
    check_writable(&args.out).context("--out")?;
    ensure!(
        matches!(args.what, Bench::Growth) || (args.max_rays, args.max_triangles) == (None, None),
        "--max-rays and --max-triangles are for `bench growth`"
    );
    match args.what {
        Bench::Kernels => kernels(args, isas),
        Bench::Ingredients => ingredients(args, isas),
        Bench::Throughput => throughput(args, isas),
        Bench::Growth => growth(args),
    }
}

fn kernels(args: &BenchArgs, isas: Vec<Isa>) -> anyhow::Result<Verdict> {
    ensure!(
        args.scenes.is_none(),
        "--scenes is for `bench ingredients` and `bench throughput`: the data of kernels are made up"
    );
    let plan = Plan {
        isas,
        levels: match args.quick {
            true => vec![Level::new("tiny", 64 << 10)],
            false => Level::all(Machine::here("").memory_bytes),
        },
        repeats: args.repeats as usize,
        sample_ns: if args.quick { 2e4 } else { 2e6 },
    };
    let progress = Progress::new(&vec![1.0; KERNELS.len() * plan.levels.len()]);
    let measured = measure(&plan, |kernel, level| {
        progress.step(&format!("{}: {}", kernel.name, level.name));
        progress.advance(1.0);
    });
    progress.finish();
    let document = match measured {
        Ok(document) => document,
        Err(differ) => {
            complain(&format!("finding: {differ}"));
            return Ok(Verdict::Finding);
        }
    };
    let path = args.out.display();
    (document.write(&args.out)).with_context(|| format!("{path}: cannot be written"))?;
    print(&format!("{}\nresults: {path}\n", text(&document)))?;
    Ok(Verdict::Good)
}

/// The tables for people, 100 columns at most.
fn text(document: &Document) -> String {
    let mut text = format!("clock: {:.2} GHz\n", document.clock_ghz);
    for copy in &document.copies {
        text += &format!(
            "copy, {} ({}): {:.1} GB/s, read + written\n",
            copy.level.name,
            size(copy.level.bytes),
            copy.gb_per_s
        );
    }
    for peak in &document.multiply_adds {
        text += &format!(
            "\n{}: at most {:.1} billion fused multiply-adds a second, {:.1} a clock\n\n",
            peak.isa, peak.billion_per_s, peak.per_clock
        );
        let row = |cells: [&str; 7]| cells.map(str::to_owned).to_vec();
        let mut rows = vec![row([
            "kernel",
            "set",
            "ns [95 %]",
            "M/s",
            "clocks",
            "x copy",
            "Mora 2011",
        ])];
        let of_isa = |t: &&Timing| t.isa == peak.isa;
        for t in document.timings.iter().filter(of_isa) {
            let [low, high] = t.ns.interval.map(short);
            rows.push(row([
                &t.kernel,
                &t.level,
                &format!("{} [{low}, {high}]", short(t.ns.ratio)),
                &short(t.million_per_s),
                &short(t.clocks),
                &short(t.over_copy.ratio),
                &t.mora2011.as_ref().map_or(String::new(), verdict),
            ]));
        }
        text += &columns(&rows, &[2, 3, 4, 5]);
    }
    text
}

/// The figure of the paper, and whether ours is as good: `300 M/s yes`.
fn verdict(printed: &Printed) -> String {
    let figure = match printed.figure {
        Figure::MillionPerS(figure) => format!("{figure} M/s"),
        Figure::Clocks(figure) => format!("{figure} clocks"),
    };
    let reached = if printed.reached { "yes" } else { "no" };
    format!("{reached} ({figure})")
}

fn size(bytes: usize) -> String {
    match bytes >> 20 {
        0 => format!("{} KiB", bytes >> 10),
        mib => format!("{mib} MiB"),
    }
}

/// Three digits that count, or all before the point.
pub(super) fn short(x: f64) -> String {
    match x {
        _ if x < 9.995 => format!("{x:.2}"),
        _ if x < 99.95 => format!("{x:.1}"),
        _ => format!("{x:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let numbers = [0.0123, 9.996, 99.96, 12_345.6];
        assert_eq!(numbers.map(short), ["0.01", "10.0", "100", "12346"]);
        assert_eq!([256 << 10, 8 << 20].map(size), ["256 KiB", "8 MiB"]);
    }
}
