//! A progress bar at a terminal, nothing elsewhere, and warnings on standard error.

use super::text;
use super::time_to_go::TimeToGo;
use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};
use std::cell::{Cell, RefCell};
use std::time::Instant;

/// How far a run is. Drawn only between measurements: nothing ticks while a clock runs.
pub struct Progress {
    bar: ProgressBar,
    time: RefCell<TimeToGo>,
    /// When the last part was finished.
    since: Cell<Instant>,
}

impl Progress {
    /// A bar of so many parts, each worth some work; hidden where standard error is not a terminal,
    /// cleared on drop.
    pub fn new(work: &[f64]) -> Progress {
        let bar = ProgressBar::new(work.len() as u64).with_finish(ProgressFinish::AndClear);
        let style =
            ProgressStyle::with_template("{bar:24} {pos}/{len} {elapsed} {prefix}{wide_msg}");
        bar.set_style(style.expect("a template that is right"));
        Progress {
            bar,
            time: RefCell::new(TimeToGo::new(work.iter().sum())),
            since: Cell::new(Instant::now()),
        }
    }

    /// Says what is being done.
    pub fn step(&self, what: &str) {
        self.bar.set_message(what.to_owned());
    }

    /// Counts a part as done that was done before.
    pub fn skip(&self, work: f64) {
        self.time.borrow_mut().skip(work);
        self.since.set(Instant::now());
        self.bar.inc(1);
    }

    /// Counts a part as done that was worked on since the last one.
    pub fn advance(&self, work: f64) {
        let seconds = self.since.replace(Instant::now()).elapsed().as_secs_f64();
        self.time.borrow_mut().measured(work, seconds);
        let to_go = self.to_go();
        let comma = if to_go.is_empty() { "" } else { "; " };
        self.bar.set_prefix(to_go + comma);
        self.bar.inc(1);
    }

    /// Parts that are done, such as `3/12`.
    pub fn done(&self) -> String {
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
        format!("{done}/{all}")
    }

    /// How long the rest will take, such as `2 to 5 min to go`; may be empty.
    pub fn to_go(&self) -> String {
        self.time.borrow().text()
    }

    /// A warning, above the bar.
    pub fn warn(&self, message: &str) {
        self.note(&format!("warning: {message}"));
    }

    /// Writes a line to standard error, above the bar.
    pub fn note(&self, line: &str) {
        self.bar.suspend(|| text::complain(line));
    }

    /// Writes to standard output, above the bar.
    pub fn print(&self, text: &str) -> anyhow::Result<()> {
        self.bar.suspend(|| text::print(text))
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
