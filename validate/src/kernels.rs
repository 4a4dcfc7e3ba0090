//! Timing of the engine's kernels one by one, beside what the machine can do at most.

use crate::json_file;
use crate::machine::{Machine, Software};
use crate::statistics::{Ratio, median, paired_ratio};
use dacrt::Isa;
use dacrt::bench::{Bench, KERNELS, Kernel, multiply_adds};
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::io;
use std::path::Path;
use std::time::Instant;

/// What [`Document::kind`] says. There is no `schema`, so no command takes the file for the
/// [results](crate::results) of a run.
pub const KIND: &str = "kernels";

/// Working sets that portable code is measured on at most: beyond, it would take most of the time of
/// all, and show little, for it is far from any bound of memory.
const MOST_OF_PORTABLE: usize = 16 << 20;

/// What is measured, and how long.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Which instances of the kernels; this processor has them all.
    pub isas: Vec<Isa>,
    /// Working sets.
    pub levels: Vec<Level>,
    /// Samples of each kernel, at least 1.
    pub repeats: usize,
    /// Nanoseconds of a sample at least.
    pub sample_ns: f64,
}

/// A working set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// What it fits into.
    pub name: String,
    /// Its size.
    pub bytes: usize,
}

impl Level {
    /// Sets that fit into the L2 cache, the L3 cache and memory, not more than a 32nd of which is
    /// taken.
    pub fn all(memory_bytes: u64) -> Vec<Level> {
        let memory = (memory_bytes as usize / 32).min(256 << 20);
        [("L2", 256 << 10), ("L3", 8 << 20), ("memory", memory)]
            .map(|(name, bytes)| Level::new(name, bytes))
            .into()
    }

    /// A level.
    pub fn new(name: &str, bytes: usize) -> Level {
        Level {
            name: name.to_owned(),
            bytes,
        }
    }
}

/// All that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// [`KIND`].
    pub kind: String,
    /// Where it ran.
    pub machine: Machine,
    /// What ran.
    pub software: Software,
    /// The command line, one string an argument.
    pub command: Vec<String>,
    /// Billion clocks a second, the median of all samples.
    pub clock_ghz: f64,
    /// Copies of memory.
    pub copies: Vec<Copy>,
    /// The peak of each instruction set.
    pub multiply_adds: Vec<Peak>,
    /// The kernels.
    pub timings: Vec<Timing>,
}

/// Copies of one half of a working set to the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Copy {
    /// The working set.
    pub level: Level,
    /// Billion bytes a second, both those read and those written, the median of all samples.
    pub gb_per_s: f64,
}

/// Fused multiply-adds in registers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Name of the instruction set.
    pub isa: String,
    /// Billion float32 multiply-adds a second, the median of all samples.
    pub billion_per_s: f64,
    /// How many a clock.
    pub per_clock: f64,
}

/// One kernel on one instruction set and working set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// What it does.
    pub kernel: String,
    /// What is counted.
    pub test: String,
    /// Name of the instruction set.
    pub isa: String,
    /// Name of the working set.
    pub level: String,
    /// Tests of a pass.
    pub tests: u64,
    /// Bytes that a test reads and writes at least.
    pub bytes_per_test: f64,
    /// Nanoseconds of a test, of each sample.
    pub samples_ns: Vec<f64>,
    /// Their median and its 95 % bootstrap interval.
    pub ns: Ratio,
    /// Million tests a second, of the median.
    pub million_per_s: f64,
    /// Clocks of a test: the median of the samples by the clock of the same repeat.
    pub clocks: f64,
    /// Nanoseconds that a copy of the bytes of a test takes, of the sample of each repeat.
    pub copy_samples_ns: Vec<f64>,
    /// Time of a test over that of the copy.
    pub over_copy: Ratio,
    /// What the paper has.
    pub mora2011: Option<Printed>,
}

/// A figure of Mora 2011 (sections 3.2, 3.3 and 3.5), from one core of a 3 GHz Core 2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Printed {
    /// What the figure is.
    pub figure: Figure,
    /// Whether ours is at least as good.
    pub reached: bool,
}

/// A speed.
#[derive(Clone, std::marker::Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// Million tests a second, the more the better.
    MillionPerS(f64),
    /// Clocks of a test, the fewer the better.
    Clocks(f64),
}

/// What the paper says of a kernel.
fn printed(kernel: &Kernel) -> Option<Figure> {
    match (kernel.name, kernel.test) {
        ("cone/box", _) => Some(Figure::MillionPerS(80.0)),
        (_, "ray/triangle") => Some(Figure::Clocks(25.0)),
        // "Can perform as many simplified triangle-box intersections."
        ("triangle/cell, nine axes", _) => Some(Figure::MillionPerS(300.0)),
        (name, _) => name
            .starts_with("triangle/plane")
            .then_some(Figure::MillionPerS(300.0)),
    }
}

/// Two instruction sets that give different answers: a bug of the engine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kernel}: {isa} and portable code give different answers")]
pub struct Differ {
    /// The kernel.
    pub kernel: String,
    /// The instruction set.
    pub isa: Isa,
}

/// Measures all kernels of the plan; `step` hears of each kernel and level before its turn.
///
/// Kernels are measured one after the other. In each repeat of one, a copy and all instruction sets
/// take turns, with the clock in between.
///
/// # Errors
/// If two instruction sets differ.
pub fn measure(plan: &Plan, mut step: impl FnMut(&Kernel, &Level)) -> Result<Document, Differ> {
    let mut clocks = Vec::new();
    let mut copies = vec![Vec::new(); plan.levels.len()];
    let peaks = peaks(plan, &mut clocks);
    let mut timings = Vec::new();
    for kernel in KERNELS {
        agree(kernel, &plan.isas)?;
        for (level, copies) in plan.levels.iter().zip(&mut copies) {
            step(kernel, level);
            let takes_part = |&isa: &Isa| isa != Isa::Portable || level.bytes <= MOST_OF_PORTABLE;
            let isas: Vec<Isa> = plan.isas.iter().copied().filter(takes_part).collect();
            if isas.is_empty() {
                continue;
            }
            let mut turns = Turns::new(kernel, level, isas, plan);
            turns.take(plan);
            copies.extend(turns.copy_ns_per_byte.iter().copied());
            clocks.extend(turns.clocks.iter().flatten().copied());
            timings.extend(turns.timings(kernel, level));
        }
    }
    let clock_ghz = middle(&clocks);
    Ok(Document {
        kind: KIND.to_owned(),
        machine: Machine::here(plan.isas.first().map_or("none", |isa| isa.name())),
        software: Software::this(None),
        // Without the folders before the program's name.
        command: std::iter::once("dacrt".to_owned())
            .chain(std::env::args().skip(1))
            .collect(),
        clock_ghz,
        copies: (plan.levels.iter().zip(&copies))
            .filter(|(_, ns_per_byte)| !ns_per_byte.is_empty())
            .map(|(level, ns_per_byte)| Copy {
                level: level.clone(),
                gb_per_s: 1.0 / middle(ns_per_byte),
            })
            .collect(),
        multiply_adds: peaks,
        timings,
    })
}

/// The median of what was measured, which is something.
fn middle(samples: &[f64]) -> f64 {
    median(samples).unwrap_or(f64::NAN)
}

/// Compares what each instruction set makes of a small working set.
fn agree(kernel: &Kernel, isas: &[Isa]) -> Result<(), Differ> {
    let mut bench = kernel.prepare(64 << 10);
    let mut answer = |isa| {
        bench.reset();
        (bench.run(isa), bench.digest())
    };
    let expected = answer(Isa::Portable);
    match isas.iter().find(|&&isa| answer(isa) != expected) {
        Some(&isa) => Err(Differ {
            kernel: kernel.name.to_owned(),
            isa,
        }),
        None => Ok(()),
    }
}

/// One kernel and one level.
struct Turns {
    isas: Vec<Isa>,
    bench: Bench,
    tests: u64,
    /// Passes of a sample, for each instruction set.
    passes: Vec<usize>,
    from: Vec<u8>,
    to: Vec<u8>,
    copies: usize,
    copy_ns_per_byte: Vec<f64>,
    /// Samples for each instruction set, and the clock right after each.
    ns: Vec<Vec<f64>>,
    clocks: Vec<Vec<f64>>,
}

impl Turns {
    fn new(kernel: &Kernel, level: &Level, isas: Vec<Isa>, plan: &Plan) -> Turns {
        let n = isas.len();
        let half = level.bytes / 2;
        let mut turns = Turns {
            isas,
            bench: kernel.prepare(level.bytes),
            tests: 0,
            passes: vec![1; n],
            from: vec![1; half],
            to: vec![2; half],
            copies: 1,
            copy_ns_per_byte: Vec::new(),
            ns: vec![Vec::new(); n],
            clocks: vec![Vec::new(); n],
        };
        for i in 0..n {
            let isa = turns.isas[i];
            // The first pass brings everything near.
            let mut ns = turns.pass(isa);
            if ns < plan.sample_ns {
                ns = turns.pass(isa);
            }
            turns.passes[i] = (plan.sample_ns / ns).ceil() as usize;
        }
        turns.copy();
        turns.copies = (plan.sample_ns / turns.copy()).ceil() as usize;
        turns
    }

    /// Nanoseconds of a pass.
    fn pass(&mut self, isa: Isa) -> f64 {
        self.bench.reset();
        let start = Instant::now();
        self.tests = self.bench.run(isa);
        nanoseconds(start)
    }

    /// Nanoseconds of a copy.
    fn copy(&mut self) -> f64 {
        let start = Instant::now();
        self.to.copy_from_slice(black_box(&self.from));
        black_box(&mut self.to);
        nanoseconds(start)
    }

    fn take(&mut self, plan: &Plan) {
        for _ in 0..plan.repeats {
            if self.copies > 1 {
                self.copy();
            }
            let ns: f64 = (0..self.copies).map(|_| self.copy()).sum();
            let bytes = self.copies * (self.from.len() + self.to.len());
            self.copy_ns_per_byte.push(ns / bytes as f64);
            for i in 0..self.isas.len() {
                let isa = self.isas[i];
                // Small working sets are near again after a pass.
                if self.passes[i] > 1 {
                    self.pass(isa);
                }
                let ns: f64 = (0..self.passes[i]).map(|_| self.pass(isa)).sum();
                self.ns[i].push(ns / (self.passes[i] as u64 * self.tests) as f64);
                self.clocks[i].push(clock_ghz(plan));
            }
        }
    }

    fn timings(&self, kernel: &Kernel, level: &Level) -> Vec<Timing> {
        let bytes_per_test = self.bench.bytes_per_test();
        let per_byte = &self.copy_ns_per_byte;
        let copy_samples_ns: Vec<f64> = per_byte.iter().map(|ns| ns * bytes_per_test).collect();
        let timing = |(i, isa): (usize, &Isa)| {
            let samples = &self.ns[i];
            let by_clock = samples.iter().zip(&self.clocks[i]);
            let clocks = middle(&by_clock.map(|(ns, ghz)| ns * ghz).collect::<Vec<_>>());
            let ns = ratio(samples, &vec![1.0; samples.len()]);
            let million_per_s = 1e3 / ns.ratio;
            let mora2011 = printed(kernel).map(|figure| Printed {
                figure,
                reached: match figure {
                    Figure::MillionPerS(theirs) => million_per_s >= theirs,
                    Figure::Clocks(theirs) => clocks <= theirs,
                },
            });
            Timing {
                kernel: kernel.name.to_owned(),
                test: kernel.test.to_owned(),
                isa: isa.name().to_owned(),
                level: level.name.clone(),
                tests: self.tests,
                bytes_per_test,
                samples_ns: samples.clone(),
                ns,
                million_per_s,
                clocks,
                copy_samples_ns: copy_samples_ns.clone(),
                over_copy: ratio(samples, &copy_samples_ns),
                mora2011,
            }
        };
        self.isas.iter().enumerate().map(timing).collect()
    }
}

/// As [`paired_ratio`] of samples that pair.
fn ratio(numerators: &[f64], denominators: &[f64]) -> Ratio {
    paired_ratio(numerators, denominators).expect("as many samples of both, at least one")
}

fn nanoseconds(start: Instant) -> f64 {
    // A clock may be coarse; no sample takes no time.
    (start.elapsed().as_nanos() as f64).max(1.0)
}

/// The peak of each instruction set; adds samples of the clock.
fn peaks(plan: &Plan, clocks: &mut Vec<f64>) -> Vec<Peak> {
    let mut samples = vec![(Vec::new(), Vec::new()); plan.isas.len()];
    for _ in 0..plan.repeats {
        for (&isa, (per_ns, per_clock)) in plan.isas.iter().zip(&mut samples) {
            let mut rounds = 1000;
            let rate = loop {
                let start = Instant::now();
                let done = multiply_adds(isa, rounds);
                let ns = nanoseconds(start);
                if ns >= plan.sample_ns / 4.0 {
                    break done as f64 / ns;
                }
                rounds *= 2;
            };
            let ghz = clock_ghz(plan);
            per_ns.push(rate);
            per_clock.push(rate / ghz);
            clocks.push(ghz);
        }
    }
    (plan.isas.iter().zip(&samples))
        .map(|(isa, (per_ns, per_clock))| Peak {
            isa: isa.name().to_owned(),
            billion_per_s: middle(per_ns),
            per_clock: middle(per_clock),
        })
        .collect()
}

/// Billion clocks a second: a chain of integer operations each of which waits for the one before
/// and takes a clock. The best of three, for whatever interrupts it makes it longer.
fn clock_ghz(plan: &Plan) -> f64 {
    const OPERATIONS: usize = 2;
    let rounds = (plan.sample_ns / 10.0) as usize;
    let (add, flip) = (black_box(0x9e37_79b9u64), black_box(0x85eb_ca6bu64));
    let chain = || {
        let start = Instant::now();
        let mut x = 0u64;
        for _ in 0..rounds {
            x = x.wrapping_add(add) ^ flip;
        }
        black_box(x);
        (OPERATIONS * rounds) as f64 / nanoseconds(start)
    };
    (0..3).map(|_| chain()).fold(0.0, f64::max)
}

impl Document {
    /// Writes the file whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        json_file::write(path, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quick() -> Plan {
        Plan {
            isas: Isa::available().collect(),
            levels: vec![Level::new("tiny", 32 << 10)],
            repeats: 2,
            sample_ns: 1e4,
        }
    }

    #[test]
    fn figures_of_a_timing_are_those_of_its_samples() {
        let plan = quick();
        let document = measure(&plan, |_, _| ()).unwrap();
        assert_eq!(document.timings.len(), KERNELS.len() * plan.isas.len());
        for t in &document.timings {
            assert_eq!(
                (t.samples_ns.len(), t.copy_samples_ns.len()),
                (2, 2),
                "{t:?}"
            );
            let ns = (t.samples_ns[0] + t.samples_ns[1]) / 2.0;
            let copy = (t.copy_samples_ns[0] + t.copy_samples_ns[1]) / 2.0;
            approx::assert_relative_eq!(t.ns.ratio, ns, max_relative = 1e-9);
            approx::assert_relative_eq!(t.million_per_s, 1e3 / ns, max_relative = 1e-9);
            approx::assert_relative_eq!(t.over_copy.ratio, ns / copy, max_relative = 1e-9);
            let reached = t.mora2011.as_ref().map(|m| m.reached);
            let expected = match t.test.as_str() {
                "ray/triangle" => Some(t.clocks <= 25.0),
                "cone/box" => Some(t.million_per_s >= 80.0),
                "triangle/box" => Some(t.million_per_s >= 300.0),
                "triangle" if t.kernel.contains("plane") => Some(t.million_per_s >= 300.0),
                _ => None,
            };
            assert_eq!(reached, expected, "{t:?}");
        }
        for peak in &document.multiply_adds {
            assert!(peak.billion_per_s > 0.0, "{peak:?}");
        }
    }

    /// A chain that the compiler shortens would give hundreds of gigahertz.
    #[test]
    fn the_clock_is_one_of_a_processor() {
        let ghz = clock_ghz(&Plan {
            sample_ns: 1e6,
            ..quick()
        });
        assert!((0.2..8.0).contains(&ghz), "{ghz}");
    }

    #[test]
    fn no_level_takes_more_than_a_part_of_memory() {
        let bytes = |memory| Level::all(memory).last().unwrap().bytes;
        assert_eq!(bytes(64 << 30), 256 << 20);
        assert_eq!(bytes(4 << 30), 128 << 20);
    }
}
