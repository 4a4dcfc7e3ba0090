//! The command line: [`args`] is what was typed, [`plan`] what it means, the rest does it.

mod args;
mod bench;
mod claims;
mod color;
mod compare;
mod engine;
mod env;
mod growth;
mod hard;
mod ingredients;
mod knobs;
mod merge;
mod nodes;
mod paper;
mod picture;
mod plan;
mod plot;
mod progress;
mod render;
mod replay;
mod report;
mod run;
mod scenes;
mod schema;
mod shade;
mod shard;
mod size;
mod source;
mod sweep;
mod table;
mod text;
mod throughput;
mod time_to_go;
mod trace;

use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;

/// How a command that came to its end went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// All good: exit code 0.
    Good,
    /// A finding, such as a wrong hit: exit code 1.
    Finding,
}

/// The command line for result files, without the folders before the program's name.
fn command_line() -> Vec<String> {
    let arguments = std::env::args().skip(1);
    std::iter::once("dacrt".to_owned())
        .chain(arguments)
        .collect()
}

/// Runs the command that the arguments ask for. Every error is a message and exit code 2.
pub fn main() -> ExitCode {
    // On a usage error clap writes its own message and exits with 2.
    let cli = Cli::parse();
    let result = match cli.command {
        Command::Run(args) => run::run(&args),
        Command::Sweep(args) => sweep::sweep(&args),
        Command::Merge(args) => merge::merge(&args),
        Command::Table(args) => table::table(&args),
        Command::Plot(args) => plot::plot(&args),
        Command::Report(args) => report::report(&args),
        Command::Paper(args) => paper::paper(&args),
        Command::Claims(args) => claims::claims(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::Nodes(args) => nodes::nodes(&args),
        Command::Render(args) => render::render(&args),
        Command::Scenes(args) => scenes::scenes(&args),
        Command::Schema(args) => schema::schema(&args),
        Command::Replay(args) => replay::replay(&args),
        Command::Trace(args) => trace::trace(&args),
        Command::Hard(args) => hard::hard(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Env(args) => env::env(&args),
    };
    match result {
        Ok(Verdict::Good) => ExitCode::SUCCESS,
        Ok(Verdict::Finding) => ExitCode::from(1),
        Err(error) => {
            text::complain(&format!("error: {}", text::one_line(&error)));
            ExitCode::from(2)
        }
    }
}
