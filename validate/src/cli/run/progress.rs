//! A progress bar at a terminal, nothing elsewhere, and warnings on standard error.

use crate::cli::text;
use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

/// How far a run is. Drawn only between measurements: nothing ticks while a clock runs.
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar of `groups` batches; hidden where standard error is not a terminal, cleared on drop.
    pub fn new(groups: usize) -> Progress {
        let bar = ProgressBar::new(groups as u64).with_finish(ProgressFinish::AndClear);
        let style = ProgressStyle::with_template("{bar:24} {pos}/{len} {elapsed} {wide_msg}");
        bar.set_style(style.expect("a template that is right"));
        Progress(bar)
    }

    /// Says what is being done.
    pub fn step(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }

    /// Counts a batch as done.
    pub fn advance(&self) {
        self.0.inc(1);
    }

    /// A warning, above the bar.
    pub fn warn(&self, message: &str) {
        self.0
            .suspend(|| text::complain(&format!("warning: {message}")));
    }

    /// Writes to standard output, above the bar.
    pub fn print(&self, text: &str) -> anyhow::Result<()> {
        self.0.suspend(|| text::print(text))
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}
