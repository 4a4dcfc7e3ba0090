//! The command line as typed. Nothing here touches the file system or knows what scenes there are:
//! [`super::plan`] makes sense of it.

use super::knobs::KnobLists;
use super::replay::ReplayArgs;
use super::shard::Shard;
use super::size::{Resolution, Spp};
use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use dacrt_validate::diff::RANDOM_RAYS;
use dacrt_validate::schema::KINDS;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

/// Traces ray batches by divide and conquer (DACRT), checks every hit against Embree 4, and
/// measures both.
#[derive(Parser)]
#[command(
    name = "dacrt",
    version,
    max_term_width = 100,
    after_help = "\
Examples:
  dacrt run                                          the main job: three generated scenes and more
  dacrt run --scenes sibenik,hall --resolution 1024 --rays primary,diffuse-1
  dacrt sweep scripts/sweeps/bins.json
  dacrt table dacrt-run.json --csv
  dacrt plot errors dacrt-run.json --out errors.svg
  dacrt report dacrt-run.json --out report.html
  dacrt paper mora2011
  dacrt claims --quick
  dacrt bench kernels
  dacrt bench growth
  dacrt hard
  dacrt render hall --what shaded,boxes
  dacrt trace --mesh bunny.obj --rays rays.npy --method nabata2013 --out hits.npz
  dacrt replay dacrt-run.json --cell hall/primary/512x512/1/afra2012 --ray 4711
  dacrt compare reference.json new.json
  dacrt scenes

Meshes are looked for beside the scene's description and in the folders of --meshes or
DACRT_MESHES (colon-separated).

Exit code: 0 all good; 1 a finding, such as a wrong hit; 2 usage, input or environment."
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Trace scenes with several methods, check every hit, measure, write a JSON file
    Run(RunArgs),
    /// Measure the product of a sweep file; goes on where it was if it was stopped
    Sweep(SweepArgs),
    /// Put the shards of a sweep, or other pieces, into one result file
    Merge(MergeArgs),
    /// Print a result file as a table or as CSV
    Table(TableArgs),
    /// Draw a result file as SVG
    Plot(PlotArgs),
    /// Make one page of result files to look at in a browser: summary, plots, claims, all cells
    Report(ReportArgs),
    /// Measure what a paper prints, and set its figures beside ours
    Paper(PaperArgs),
    /// Judge the papers' claims one by one by what is measured for each
    Claims(ClaimsArgs),
    /// Measure the inner loops one by one beside what the machine can do, or the throughput of threads
    Bench(BenchArgs),
    /// Trace hard cases with every precision and with Embree, and count errors by exact arithmetic
    Hard(HardArgs),
    /// Compare two result files: has anything become worse?
    Compare(CompareArgs),
    /// Trace your own rays through your own mesh
    Trace(TraceArgs),
    /// Show what becomes of one ray, step by step, and who is right about it
    Replay(ReplayArgs),
    /// Write down each node of a trace: how it was split, and how it might have been
    Nodes(NodesArgs),
    /// Make pictures of a scene
    Render(RenderArgs),
    /// List the scenes and where their meshes are
    Scenes(ScenesArgs),
    /// Print the JSON Schema of result files, scene descriptions or sweep files
    Schema(SchemaArgs),
    /// Show the machine, the instruction sets, Embree and the mesh folders
    Env(EnvArgs),
}

/// Reads a whole number in a range.
fn whole<T: FromStr + PartialOrd + Display + Clone>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|n| range.contains(n));
        let (least, most) = (range.start(), range.end());
        number.ok_or_else(|| format!("expected a whole number from {least} to {most}"))
    }
}

/// Where meshes are.
#[derive(Args)]
pub struct MeshArgs {
    /// Folders to look for meshes in, colon-separated
    #[arg(
        long,
        env = "DACRT_MESHES",
        value_name = "FOLDERS",
        hide_env_values = true
    )]
    pub meshes: Option<String>,
}

/// How the engine works.
#[derive(Args)]
pub struct EngineArgs {
    /// Instruction set: avx512, avx2 or portable [default: the best that the processor has]
    #[arg(long)]
    pub isa: Option<String>,
    /// Threads of method best and of Embree, 0 for all of this machine; other methods take one
    #[arg(
        long,
        default_value_t = 1,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = whole(0..=1024u32)
    )]
    pub threads: u32,
    /// Seed of every random choice
    #[arg(
        long,
        default_value_t = 1,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = whole(0..=u64::MAX)
    )]
    pub seed: u64,
}

/// How often is measured.
#[derive(Args)]
pub struct RepeatArgs {
    /// Measured repeats of each contestant
    #[arg(
        long,
        value_name = "N",
        default_value_t = 5,
        allow_negative_numbers = true,
        value_parser = whole(1..=1000u32)
    )]
    pub repeats: u32,
}

#[derive(Args)]
#[command(after_help = "\
Lists are comma-separated. Each combination of scene, resolution, samples, ray type, method, method
parameters and precision is a cell; a parameter that a method lacks makes no cells of it.

fast        float32: near an edge or an end of the interval, rounding may decide
watertight  a ray hits a triangle as in exact arithmetic: none slips through an edge; t is rounded
exact       the nearest hit of exact arithmetic, t rounded once; nothing is excused by rounding
`fast` is set against Embree's default mode, the others against its robust mode; each against
afra2012 of the same precision.

Rays that share no origin (all but primary and shadow-point) are traced by mora2011 and
mora2011-cones in the same way as by mora2011-random; `variant` in the result says so.
--terminate-as-printed true ends a ray as Mora 2011 prints it, which is wrong: such a cell has the
number of wrong rays and no times, and the exit code is 1.

--threads N is for best and for Embree, which builds with N threads and traces with N more that take
blocks of 4,096 rays; other methods are traced with one thread all the same, and `threads` of each
cell in the result says so. Hits are the same for any number.

Without --scenes, hall, relief and soup (generated) and sibenik, conference and sponza (where
their meshes are found) are traced, with 3 repeats unless --repeats says otherwise.

Examples:
  dacrt run --scenes sibenik,conference,sponza --resolution 1024 \\
            --rays primary,diffuse-1,diffuse-2 --repeats 5 --out result.json
  dacrt run --scenes sibenik --rays primary --samples 25,50,100,200 --threshold 0,1.5,3
  dacrt run --scenes sibenik --resolution 512 --spp 64 --rays primary
  dacrt run --scenes sibenik --precision fast,watertight,exact

The table: a line a cell, the slowest method first. `vs afra2012` is the time of afra2012 over that
of this method with its 95 % bootstrap interval, marked `<` if all of it is below 1; `vs Embree`
is the best time of Embree over that of this method. `diff` is two counts of rays: those for which
our hit is wrong, by exact arithmetic and by more than the precision allows, and all those on
which our hits differ from either Embree mode. The first has to be 0: else the cell has no times,
the result file has the rays (`dacrt replay` shows one, the command is printed), and the exit
code is 1. Exact arithmetic judges every ray on which an answer differs, up to 1,000,000 a cell
(more count as wrong), and --exact-all others.")]
pub struct RunArgs {
    /// Scenes to trace (see `dacrt scenes`) [default: hall,relief,soup,sibenik,conference,sponza]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub scenes: Option<Vec<String>>,
    /// Cameras of the scenes by name; generated: 16 that the program makes, of which generated-1 is
    /// the first; generated-lens: with the lens of a camera of the scene
    /// [default: the first of each scene]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub cameras: Option<Vec<String>>,
    /// Ray types: primary, shadow-point, shadow-area, reflection, ambient-occlusion, dof,
    /// diffuse-1 ... diffuse-8, random
    /// [default: primary,shadow-point,diffuse-1, those that the scene is for]
    #[arg(long, value_delimiter = ',', value_name = "TYPES")]
    pub rays: Option<Vec<String>>,
    /// Methods: afra2012, nabata2013, mora2011, mora2011-cones, mora2011-random, best
    /// [default: afra2012, nabata2013, best, and of Mora's the first two for primary and shadow-point
    /// rays, the last for all others]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub methods: Option<Vec<String>>,
    /// Precisions of the triangle test: fast, watertight, exact
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "fast"
    )]
    pub precision: Vec<String>,
    /// Picture sizes in pixels
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "N|WxH",
        default_value = "512",
        allow_negative_numbers = true
    )]
    pub resolution: Vec<Resolution>,
    /// Samples per pixel, square numbers
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "N",
        default_value = "1",
        allow_negative_numbers = true
    )]
    pub spp: Vec<Spp>,
    /// Measured repeats of each contestant [default: 5; 3 without --scenes]
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = whole(1..=1000u32)
    )]
    pub repeats: Option<u32>,
    /// Random rays of each cell that are held against exact arithmetic, whether or not Embree agrees
    #[arg(
        long,
        value_name = "N",
        default_value_t = RANDOM_RAYS,
        allow_negative_numbers = true,
        value_parser = whole(0..=u32::MAX)
    )]
    pub exact_all: u32,
    /// Where the results go, as JSON
    #[arg(long, value_name = "FILE", default_value = "dacrt-run.json")]
    pub out: PathBuf,
    /// Keep the finished cells of the file given by --out
    #[arg(long)]
    pub resume: bool,
    /// Time other libraries, too: obvhs, bvh (dacrt must be built with --features peers)
    #[arg(long)]
    pub peers: bool,
    /// Keep the splits of each trace (not of best, cones and octants) as a tree and send its rays
    /// through that, together and one by one; `dacrt table --twins` shows it
    #[arg(long)]
    pub twins: bool,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
    #[command(flatten)]
    pub knobs: KnobLists,
}

#[derive(Args)]
#[command(after_help = "\
The file says what to measure; scripts/sweeps has some. Lists of scenes, sizes, ray types, methods
and values of method parameters, by the names that they have in result files:
  {
    \"about\": \"Bins around the paper's 32\",
    \"scenes\": [\"sibenik\", \"sponza\"],
    \"resolution\": [512, [1280, 800]],
    \"spp\": [1],
    \"rays\": [\"primary\", \"diffuse-1\"],
    \"methods\": [\"afra2012\", \"nabata2013\"],
    \"precision\": [\"fast\"],
    \"parameters\": { \"bins\": [4, 8, 16, 32, 64, 128] }
  }
`about`, `spp`, `precision` and `parameters` may be left out. Each combination is a cell; a
parameter that a method lacks makes no cells of it.

The result file is written, whole or not at all, after each batch (scene, size and ray type: its
cells are measured in turns, so that their ratios are of the same minutes). A sweep that is called
again goes on with what is missing, if program, machine, seed and the rest are the same; cells that
are not of this sweep are an error, and nothing is overwritten.

Shards are whole batches, dealt out by rays times contestants; `dacrt merge` joins their files.

Examples:
  dacrt sweep scripts/sweeps/bins.json
  dacrt sweep scripts/sweeps/samples.json --scenes hall --resolution 256
  dacrt sweep scripts/sweeps/bins.json --shard 2/3 --out bins-2.json       on the second of three
  dacrt merge bins-1.json bins-2.json bins-3.json --out bins.json")]
pub struct SweepArgs {
    /// What to measure: JSON
    pub file: PathBuf,
    /// Scenes instead of those of the file
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub scenes: Option<Vec<String>>,
    /// Picture sizes in pixels instead of those of the file
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "N|WxH",
        allow_negative_numbers = true
    )]
    pub resolution: Option<Vec<Resolution>>,
    /// Precisions of the triangle test instead of those of the file: fast, watertight, exact
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub precision: Option<Vec<String>>,
    /// Only the I-th, from 1, of N parts
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    #[command(flatten)]
    pub repeats: RepeatArgs,
    /// Where the results go, as JSON [default: dacrt-NAME.json for a sweep NAME.json]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
}

#[derive(Args)]
#[command(after_help = "\
The pieces must have been made by the same program (commit, compiler, Embree) with the same seed,
number of threads and instruction set on processors of the same model, cells of one batch must have
the same rays, no cell may be in two pieces, and of a sweep in shards none may be missing. Else the
exit code is 2, and nothing is written.

Examples:
  dacrt merge dacrt-bins-1of2.json dacrt-bins-2of2.json --out dacrt-bins.json")]
pub struct MergeArgs {
    /// Result files
    #[arg(required = true, value_name = "FILES")]
    pub files: Vec<PathBuf>,
    /// Where the whole goes, as JSON
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

#[derive(Args)]
#[command(after_help = "\
Without an option, the table that `dacrt run` printed. --over has a line a batch and a column a
value: how many times as fast as with the default value, and as afra2012 (`<`, `>`: the 95 %
interval lies below, above 1). --errors has times and counts of wrong answers of ours and of both
modes of Embree, batches with the most errors of ours first; the more rays `dacrt run --exact-all`
judged, the more it can tell. --memory has a line a cell: our workspace beside the trees of Embree
and of other libraries. --csv has a line a cell and a column for each key of the result file.

Examples:
  dacrt table results/2026-11-23-granite-rapids-1024.json.gz
  dacrt table dacrt-bins.json --over bins
  dacrt table dacrt-run.json --over method
  dacrt table dacrt-run.json --errors
  dacrt table dacrt-run.json --memory
  dacrt table dacrt-run.json --csv > run.csv")]
pub struct TableArgs {
    /// Result file, plain or gzip
    pub file: PathBuf,
    /// Compare the values of this parameter, of `precision`, or of `method`
    #[arg(long, value_name = "PARAMETER")]
    pub over: Option<String>,
    /// Speed against error: times, and answers that are not those of exact arithmetic
    #[arg(long, conflicts_with = "over")]
    pub errors: bool,
    /// Write comma-separated values instead
    #[arg(long, conflicts_with_all = ["over", "errors"])]
    pub csv: bool,
    /// Memory: our workspace beside the trees of Embree and of other libraries
    #[arg(long, conflicts_with_all = ["over", "errors", "csv"])]
    pub memory: bool,
    /// Cost function, order and skipping of ray sampling: what each gives alone, beside the others,
    /// and together, of a file that has all eight combinations (`dacrt sweep ablation`)
    #[arg(long, conflicts_with_all = ["over", "errors", "csv", "memory"])]
    pub ablation: bool,
    /// Stored splits: a trace beside its rays sent through the tree of its splits
    #[arg(long, conflicts_with_all = ["over", "errors", "csv", "memory", "ablation"])]
    pub twins: bool,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Plot {
    Errors,
    Growth,
    Nodes,
}

#[derive(Args)]
#[command(after_help = "\
errors  Nanoseconds a ray against answers that are not those of exact arithmetic, per million rays,
        both logarithmic: our precisions by the method that is the fastest in each batch, and
        Embree's modes with their builds; a panel for each ray type. What has no error stands on the
        line at the bottom. For few errors to be seen, many rays have to be judged: --exact-all.
growth  Milliseconds against the number of rays and of triangles, both logarithmic, of a file of
        `dacrt bench growth`; the grey line is n log n through the last point of best.
nodes   Of a table of `dacrt nodes` as .csv: estimated against true intersection ratios; wrong
        skips by the number of rays; regret, and share of the box tests, by depth.

Examples:
  dacrt run --scenes hall,soup --precision fast,watertight,exact --exact-all 1000000
  dacrt plot errors dacrt-run.json --out errors.svg
  dacrt plot growth growth.json --out growth.svg
  dacrt plot nodes dacrt-nodes.csv --out nodes.svg")]
pub struct PlotArgs {
    /// What to draw
    #[arg(value_enum)]
    pub what: Plot,
    /// Result files, plain or gzip
    #[arg(required = true, value_name = "FILES")]
    pub files: Vec<PathBuf>,
    /// Where the picture goes: .svg
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

#[derive(Args)]
#[command(after_help = "\
One HTML file that needs nothing else: no network, no server. Wrong hits and lost cells come first;
then plots of what the files have (speed against error, the acceleration ratio against resolution
and bounce, ratios to Embree, ablation, sweeps as curves and heat maps, growth), figures of the
papers, claims with their verdicts, hard cases, all cells in a table that can be sorted and
filtered, and where each file comes from. What the files do not have is not there.

Files are those of `dacrt run`, `sweep`, `merge`, `paper`, `bench growth`, `hard` and `claims`
(claims.json and *.json.gz), of one machine or of several: no ratio is made of two files. The same
files give the same bytes.

The view of the table stands in the address of the page, as it does in links such as
  report.html#sort=-ms&filter=sibenik&method=best

Examples:
  dacrt report dacrt-run.json
  dacrt report results/*.json.gz --out report.html
  dacrt report dacrt-run.json --pictures hall,sibenik")]
pub struct ReportArgs {
    /// Result files, plain or gzip
    #[arg(required = true, value_name = "FILES")]
    pub files: Vec<PathBuf>,
    /// Where the page goes: .html
    #[arg(long, value_name = "FILE", default_value = "dacrt-report.html")]
    pub out: PathBuf,
    /// Scenes to make pictures of now: how it looks, ray/box tests, and where Embree differs
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub pictures: Option<Vec<String>>,
    /// Their size in pixels
    #[arg(
        long,
        value_name = "N|WxH",
        default_value = "256",
        allow_negative_numbers = true
    )]
    pub picture_resolution: Resolution,
    #[command(flatten)]
    pub meshes: MeshArgs,
}

/// A paper with figures to set ours beside.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Paper {
    Nabata2013,
    Mora2011,
}

#[derive(Args)]
#[command(after_help = "\
nabata2013  The pictures of Figs. 4 to 7 at 512x512 pixels with 1, 4, 16 and 64 samples, each the
            sum of its batches (primary, reflected and shadow rays, or all bounces), without and
            with ray sampling; how the ratio goes with the size and the bounce (Fig. 8); the
            ablation of section 5; rates. Cameras are ours, the paper prints none: the scene's own
            and, for the range that the paper's ratios are held against, --cameras N that the
            program makes. Embree judges the hits and is not timed. Our own cameras take half an
            hour with 3 repeats, 16 more some five hours with one; --quick takes minutes.
mora2011    Fig. 8: ray/box, cone/box, triangle/box and ray/triangle tests, nodes and frames a
            second of mora2011 (basic) and mora2011-cones, primary rays, and of the latter with
            the shadow rays of a point light; then what the cones save. Beside ours stand the
            least and the greatest figure that the paper has over its scenes.

Everything is checked as by `dacrt run` (no time without right hits), and the result file is of the
same kind. Scenes whose mesh is not found are left out unless --scenes names them.

Examples:
  dacrt paper nabata2013 --quick
  dacrt paper nabata2013 --cameras 16 --sizes 3 --repeats 1 --resume
  dacrt paper mora2011
  dacrt paper mora2011 --scenes hall --resolution 320x200        needs no mesh file
  dacrt paper mora2011 --from results/2026-11-23-granite-rapids-mora2011.json.gz")]
pub struct PaperArgs {
    /// Which paper
    #[arg(value_enum)]
    pub paper: Paper,
    /// Scenes to trace (see `dacrt scenes`) [default: those of the paper; of mora2011
    /// sibenik,conference,sponza,bunny]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub scenes: Option<Vec<String>>,
    /// Picture size in pixels; the default is the paper's: 512x512, 1280x800
    #[arg(long, value_name = "N|WxH", allow_negative_numbers = true)]
    pub resolution: Option<Resolution>,
    /// Cameras of nabata2013 besides our own, at most 16
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true,
        value_parser = whole(0..=dacrt::workloads::GENERATED_CAMERAS as u32)
    )]
    pub cameras: u32,
    /// Of the four sizes of nabata2013, how many, the smallest first
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = whole(1..=4usize))]
    pub sizes: usize,
    /// Of nabata2013 one camera, 1 and 4 samples a pixel, at most 3 repeats; of mora2011 at most 3
    /// repeats
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    pub repeats: RepeatArgs,
    /// Measure nothing: print the table of this result file
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "resume", "quick", "cameras", "sizes"])]
    pub from: Option<PathBuf>,
    /// Where the results go, as JSON
    #[arg(long, value_name = "FILE", default_value = "dacrt-paper.json")]
    pub out: PathBuf,
    /// Keep the finished cells of the file given by --out
    #[arg(long)]
    pub resume: bool,
    /// Precision of the triangle test: fast, watertight or exact
    #[arg(long, value_name = "NAME", default_value = "fast")]
    pub precision: String,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
}

#[derive(Args)]
#[command(after_help = "\
What the claims are, what is measured of each, and what would falsify it stands in
validate/claims.json and was fixed before the runs. Each study is measured with several seeds;
every seed has the scene's own camera and some of those that the program makes, so that 10 seeds
have all 16 between them. A verdict is `contradicted` if the whole 95 % interval is where the
claim is falsified, `supported` if none of it is, else `undecided`; `not testable` if what it
needs was not measured.

Results go to a folder: cells-N.json.gz, embree-N.json.gz and twins-N.json.gz of seed N (result
files as of `dacrt run`), nodes.json, memory.json, and claims.json with the verdicts. What is
there already is not measured again; seeds may be measured on different machines, in different
sessions.

Examples:
  dacrt claims --quick
  dacrt claims --only C13,C17 --seeds 3
  dacrt claims --first-seed 4 --seeds 2 --out claims
  dacrt claims --from claims --only C7             verdicts of what there is, with all numbers")]
pub struct ClaimsArgs {
    /// Claims by number, such as C7; all their numbers are shown [default: all]
    #[arg(long, value_delimiter = ',', value_name = "IDS")]
    pub only: Option<Vec<String>>,
    /// One seed, the scene's own camera and one more, smaller pictures in the largest studies
    #[arg(long, conflicts_with_all = ["cameras", "seeds"])]
    pub quick: bool,
    /// Cameras of each scene besides its own, at most 16
    #[arg(
        long,
        value_name = "N",
        default_value_t = 16,
        allow_negative_numbers = true,
        value_parser = whole(0..=dacrt::workloads::GENERATED_CAMERAS as u32)
    )]
    pub cameras: u32,
    /// How many seeds
    #[arg(
        long,
        value_name = "N",
        default_value_t = 10,
        allow_negative_numbers = true,
        value_parser = whole(1..=100u64)
    )]
    pub seeds: u64,
    /// The first of them
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        allow_negative_numbers = true,
        value_parser = whole(1..=100u64)
    )]
    pub first_seed: u64,
    /// Measured repeats of each contestant
    #[arg(
        long,
        value_name = "N",
        default_value_t = 3,
        allow_negative_numbers = true,
        value_parser = whole(1..=1000u32)
    )]
    pub repeats: u32,
    /// Measure nothing: judge by what is in this folder
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["quick", "cameras", "seeds", "first_seed", "repeats", "out"])]
    pub from: Option<PathBuf>,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "FOLDER", default_value = "dacrt-claims")]
    pub out: PathBuf,
    #[command(flatten)]
    pub meshes: MeshArgs,
}

/// What can be measured on its own.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Bench {
    Kernels,
    Ingredients,
    Throughput,
    Growth,
}

#[derive(Args)]
#[command(after_help = "\
kernels  Every inner loop that takes much of the time of a trace, called as a trace calls it, on
         made-up data that fit into the L2 cache (256 KiB), the L3 cache (8 MiB) or only into memory
         (256 MiB; not portable code). Filters keep about half. Each pass does the same work: index
         lists and all that passes change are put back between them, outside of the time. What the
         instruction sets answer is compared first; if they differ, the exit code is 1.

The table: `ns` is the median time of a test with its 95 % bootstrap interval, `clocks` the same in
processor clocks, which are measured in turns (a chain of dependent integer additions takes one
each). `x copy` is that time over the time that a memory copy of as many bytes takes at the same
level, all bytes counted that are read or written: near 1, the kernel is at the bound of memory.
`Mora 2011` says whether our figure is at least as good as the one that the paper prints: 300
million triangles a second, 80 million cones a second, 25 clocks a ray and triangle, on a 3 GHz
Core 2.

ingredients  What each numerical ingredient does alone: tests of a ray and a triangle that differ
         from precision fast in one thing each (products fused or not, t as N·C / N·d or as e2·q /
         det, division or reciprocal estimate and Newton step, origin folded into the triangle),
         Woop, Benthin and Wald's shear with four ways to compute its edge functions, and the
         kernels of record of the three precisions; tests of boxes, padded or not. Errors against
         exact arithmetic on pairs of a ray and a triangle: those of --scenes (primary and
         diffuse-1 rays at 512x512 with what they hit and a neighbour of it, then the same rays
         sent to edges and corners) and made-up hard ones. Then times, in turns, on made-up data
         in the L1 cache. If watertight or exact break a promise, the exit code is 1. About a
         minute a scene.

In its tables: hits that a test loses and misses that it takes for hits, per million pairs; how
far t of hits is off, in units in the last place (0.5 at most if rounded correctly) and relative
to t. Of boxes: of a million hits, those whose own box the ray misses, and those whose t, as fast
computes it or exact, lies outside of the interval of their own box: what padding is for.

growth   Time of best, afra2012, nabata2013 and Embree (low and medium build) against the number of
         rays (10,000 to --max-rays, 200,000 triangles) and of triangles (1,000 to --max-triangles,
         a million rays), in steps of half a decade: primary and diffuse-1 rays of the generated
         scene hall, square pictures, one thread. Every hit is checked as by `dacrt run`, and there
         is no time without right hits; if some are wrong, the exit code is 1. A point that would
         take more than 30 minutes by the time of the one before it is left out, and so is one that
         would take more than 80 % of the free memory; where best and one build of Embree fit,
         they alone are measured. The file and the last lines say so. --repeats 3 is enough; an hour
         or so.

In its table and its file: `exponent` is p if time went with the p-th power of the number from one
point to the next (`all`: from the first to the last); `over n log n` is the time over n log n, 1 at
the first point: it stays below 1 if time grows no faster than n log n. Embree's times are build +
trace by its fastest query (the file has both). MiB: our workspace; Embree's memory, of the build
whose sum with the trace is the least. `dacrt plot growth` draws the file.

throughput  Mora 2011, section 4.2: N threads trace N copies of a batch at once, each with a
         workspace of its own that is made beforehand; mesh and rays are shared. The time is from a
         barrier to the last thread that is done. Embree does the same on one shared tree of the
         quality, by the query, with which one thread traces the batch fastest; its build is not in
         any time. Of best there is also one trace by N threads, latency. All take turns. The hits
         are checked as by `dacrt run`, and those of each thread have to be the same bits: else
         there are no times, and the exit code is 1.

Its table: million rays a second of all threads together, and how many times those of one thread
that is, with its 95 % bootstrap interval; then the same of one trace by all threads.

Examples:
  dacrt bench kernels
  dacrt bench growth --repeats 3 --out growth.json
  dacrt bench kernels --isa avx512 --repeats 21 --out kernels.json
  dacrt bench ingredients --scenes sibenik,conference --out ingredients.json
  dacrt bench throughput --scenes hall,sibenik --methods mora2011-cones,best --threads 1,2,4,8")]
pub struct BenchArgs {
    /// What to measure
    #[arg(value_enum)]
    pub what: Bench,
    /// Instruction sets: avx512, avx2, portable [default: all that the processor has; of throughput,
    /// which takes one, the best]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub isa: Option<Vec<String>>,
    /// Scenes whose rays are taken, of ingredients and throughput [default: hall]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub scenes: Option<Vec<String>>,
    #[command(flatten)]
    pub meshes: MeshArgs,
    /// The most rays of growth [default: 16000000]
    #[arg(long, value_name = "N", value_parser = whole(1_000..=1_000_000_000usize))]
    pub max_rays: Option<usize>,
    /// The most triangles of growth [default: 30000000]
    #[arg(long, value_name = "N", value_parser = whole(1_000..=1_000_000_000usize))]
    pub max_triangles: Option<usize>,
    /// Samples of each kernel, or of each contestant
    #[arg(
        long,
        value_name = "N",
        default_value_t = 7,
        allow_negative_numbers = true,
        value_parser = whole(1..=1000u32)
    )]
    pub repeats: u32,
    /// Only see whether it works: little data and short samples, times that mean little
    #[arg(long)]
    pub quick: bool,
    /// Where the results go, as JSON
    #[arg(long, value_name = "FILE", default_value = "dacrt-bench.json")]
    pub out: PathBuf,
    #[command(flatten)]
    pub throughput: ThroughputArgs,
}

/// What only `bench throughput` takes.
#[derive(Args)]
#[command(next_help_heading = "Of throughput")]
pub struct ThroughputArgs {
    /// Picture sizes in pixels [default: 512; 32 with --quick]
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "N|WxH",
        allow_negative_numbers = true
    )]
    pub resolution: Option<Vec<Resolution>>,
    /// Ray types, as of `dacrt run` [default: primary,shadow-point,diffuse-1, those that the scene is
    /// for]
    #[arg(long, value_delimiter = ',', value_name = "TYPES")]
    pub rays: Option<Vec<String>>,
    /// Methods [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub methods: Option<Vec<String>>,
    /// Numbers of threads; one thread is always measured [default: 1,2,4,... and all of this machine]
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = whole(1..=1024u32)
    )]
    pub threads: Option<Vec<u32>>,
}

#[derive(Args)]
#[command(after_help = "\
Each family of cases is made by a generator, from nothing but the seed, and traced by fast,
watertight and exact (each by all methods on all instruction sets), by Embree's default (fast) and
robust modes, and by both with flush-to-zero and denormals-are-zero set (ftz). Exact arithmetic on
the float32 numbers judges every ray.

The table has, for each family, rays per million (of all rays of the family)
  lost     that hit something, and the answer is a miss
  false    whose answer is a hit with a triangle that the ray does not meet
  wrong    with any other answer that is not the exact one: not the nearest hit, nor one exactly as
           near; or t off by more than the bound of the contestant. Of `exact`: any other bit
  beyond   of all these, that no rounding of the contestant within its proven bounds explains
  differ   on which methods, instruction sets, or nearest and any hit differ
Lines of zeros are left out.

Findings, which make the exit code 1:
  - exact: any answer that is not the exact one, to the bit
  - watertight: a lost ray on a closed mesh
  - fast, watertight: beyond the bounds
  - any of these: a difference between methods, instruction sets, or nearest and any hit; or another
    answer than the exact one where float32 computes without rounding (copies, interval, grid ...)
  - the exact arbiter: another answer than the construction of a case says
For fast and watertight only where they promise right hits: coordinates, edges and the largest
component of d zero or between 1e-9 and 1e9 in size (`*`: not all rays). Embree's errors are no
findings.

Examples:
  dacrt hard
  dacrt hard --families edges,needles --rays 1000000 --out hard.json")]
pub struct HardArgs {
    /// Families [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub families: Option<Vec<String>>,
    /// Rays of a family, about
    #[arg(
        long,
        value_name = "N",
        default_value_t = 8192,
        allow_negative_numbers = true,
        value_parser = whole(64..=100_000_000u32)
    )]
    pub rays: u32,
    /// Seed of every random choice
    #[arg(
        long,
        default_value_t = 1,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = whole(0..=u64::MAX)
    )]
    pub seed: u64,
    /// Where the results go, as JSON
    #[arg(long, value_name = "FILE", default_value = "dacrt-hard.json")]
    pub out: PathBuf,
}

/// What a comparison is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompareFormat {
    Table,
    Markdown,
    Json,
    Junit,
    Bencher,
}

/// What becomes of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Times {
    Judged,
    Shown,
}

/// How much more of a counter (or of `all`) is allowed, as a share of it.
#[derive(Clone, Debug)]
pub struct Tolerance {
    pub counter: String,
    pub share: f64,
}

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Tolerance, String> {
        let (counter, share) = text.split_once('=').ok_or("expected NAME=SHARE")?;
        let share = share
            .parse()
            .ok()
            .filter(|x: &f64| *x >= 0.0 && x.is_finite());
        Ok(Tolerance {
            counter: counter.to_owned(),
            share: share.ok_or("expected a share of 0 or more, such as 0.01 for 1 %")?,
        })
    }
}

#[derive(Args)]
#[command(after_help = "\
Both files must be about the same rays: the same seed, and in each cell the same ray_hash.

A regression is
- any change of hit_hash, or of what the validation says of our own hits (ours_wrong, both_wrong,
  t_drift); of its other classes if both files have the same Embree; times that are
  gone because hits are wrong;
- more of a counter than --tolerance allows, if both cells are of one thread; more leaves,
  skips_near, skips_far and terminated_rays is none;
- a method that is slower, if both files have the same processor, instruction set and threads.
  Times are compared as ratios within each file: to afra2012 (for that, or without it, to the first
  other method), to Embree's best with its build and to its best trace; those to Embree if both
  files have the same one. Slower: each of them has fallen below 1/1.05 of what it was, or both to
  Embree below 1/1.4 (1/1.2 where a batch has no other method), with all of the 98 % bootstrap
  interval and by the least times, too. Few repeats or a busy machine make wide intervals, which
  find little: take 5 repeats or more.
What cannot be judged is shown, and the report says why.

bencher is Bencher's metric format (BMF) with the ratios and counters of the second file. A cell's
name has scene, ray type, pixels, samples a pixel and method, and those parameters in brackets that
tell it from others.

Examples:
  dacrt compare reference.json new.json
  dacrt compare reference.json.gz new.json --subset --times shown --format markdown
  dacrt compare reference.json new.json --tolerance ray_box=0.01,nodes=0.05
  dacrt compare reference.json new.json --accept 'bins from the centres of triangles'

Exit code: 0 nothing is worse, or it is accepted; 1 a regression; 2 not comparable.")]
pub struct CompareArgs {
    /// The reference: a result file, plain or gzip
    pub reference: PathBuf,
    /// The result file to judge
    pub new: PathBuf,
    /// Compare the cells that both files have, and list the others
    #[arg(long)]
    pub subset: bool,
    /// How much more of a counter is allowed, as a share: ray_box=0.01; all=0.01 is for every counter
    /// [default: all=0]
    #[arg(long, value_delimiter = ',', value_name = "NAME=SHARE")]
    pub tolerance: Vec<Tolerance>,
    /// Whether a slower method is a regression, or only shown
    #[arg(long, value_enum, default_value = "judged")]
    pub times: Times,
    /// What is written to standard output
    #[arg(long, value_enum, default_value = "table")]
    pub format: CompareFormat,
    /// Accept what has changed: the new file takes the place of the reference, with this note
    #[arg(long, value_name = "NOTE")]
    pub accept: Option<String>,
}

#[derive(Args)]
#[command(
    override_usage = "\
dacrt trace --mesh <FILE> --rays <FILE> --method <NAME> --out <FILE> [OPTIONS]
       dacrt trace --scene <NAME> --rays <FILE> --method <NAME> --out <FILE> [OPTIONS]",
    after_help = "\
The rays are a little-endian float32 array [N, 8] in C order: ox oy oz tmin dx dy dz tmax; a hit
lies at tmin < t <= tmax. The hits are written as `t` (float32) and `prim` (uint32, the number of
the triangle in file order); a miss is t = +inf, prim = 4294967295. With --any-hit there is one
array `occluded` (uint8) instead. Exit code 0 with or without hits.

Examples:
  python3 -c \"import numpy as n; r = n.zeros((1000, 8), '<f4'); r[:, 2] = 9; r[:, 4:6] = \\
      n.random.rand(1000, 2) - .5; r[:, 6] = -1; r[:, 7] = n.inf; n.save('rays.npy', r)\"
  dacrt trace --mesh bunny.ply --rays rays.npy --method nabata2013 --out hits.npz

The offending rays that `dacrt run` kept of a cell, here the first of the file, once more (with
--own-origins where the cell says \"shared_origin\": false):
  python3 -c \"import json, numpy as n; c = json.load(open('dacrt-run.json'))['cells'][0]; \\
      r = [o['ray'] for o in c['diff']['offending']]; \\
      n.save('rays.npy', n.array(r, '<f4').reshape(-1, 8))\"
  dacrt trace --scene hall --rays rays.npy --method nabata2013 --out hits.npz"
)]
pub struct TraceArgs {
    #[command(flatten)]
    pub target: TargetArgs,
    /// Rays: .npy, float32 [N, 8]
    #[arg(long, value_name = "FILE")]
    pub rays: PathBuf,
    /// Method: afra2012, nabata2013, mora2011, mora2011-cones, mora2011-random or best
    #[arg(long, value_name = "NAME")]
    pub method: String,
    /// Where the hits go: .npz
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Ask only whether each ray hits anything
    #[arg(long)]
    pub any_hit: bool,
    /// Print what the traversal counted
    #[arg(long)]
    pub counters: bool,
    /// Trace rays of one origin by the kernel for different origins, as where they are a part of a
    /// batch whose cell says `"shared_origin": false`
    #[arg(long)]
    pub own_origins: bool,
    /// Precision of the triangle test: fast, watertight or exact
    #[arg(long, value_name = "NAME", default_value = "fast")]
    pub precision: String,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
    #[command(flatten)]
    pub knobs: KnobLists,
}

/// What is traced: one of the two.
#[derive(Args)]
#[group(required = true, multiple = false)]
pub struct TargetArgs {
    /// Mesh: OBJ or PLY, plain or gzip
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// The meshes of a scene instead (see `dacrt scenes`)
    #[arg(long, value_name = "NAME")]
    pub scene: Option<String>,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum What {
    Shaded,
    Depth,
    Prim,
    Boxes,
    Diff,
}

impl What {
    /// As on the command line and in file names.
    pub fn name(self) -> &'static str {
        match self {
            What::Shaded => "shaded",
            What::Depth => "depth",
            What::Prim => "prim",
            What::Boxes => "boxes",
            What::Diff => "diff",
        }
    }
}

#[derive(Args)]
#[command(after_help = "\
A row is a node, in the order in which they are come to: how it was split, how the surface area
heuristic and all active rays would have split it and what that costs, intersection ratios as
estimated by samples and as they are, sample counts, box tests. As .csv, or columns as .npz; the
documentation of dacrt_validate::nodes has the columns. All candidates are tested with all rays,
which takes some 60 times as long as the trace.

Examples:
  dacrt nodes sibenik --out nodes.csv
  dacrt nodes sibenik --rays diffuse-2 --second-sample true --out nodes.npz
  dacrt plot nodes nodes.csv --out nodes.svg")]
pub struct NodesArgs {
    /// Scene (see `dacrt scenes`)
    pub scene: String,
    /// Camera by name, or generated-1 ... generated-16 [default: the first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Ray type
    #[arg(long, value_name = "TYPE", default_value = "primary")]
    pub rays: String,
    /// Picture size in pixels
    #[arg(
        long,
        value_name = "N|WxH",
        default_value = "512",
        allow_negative_numbers = true
    )]
    pub resolution: Resolution,
    /// Samples per pixel, a square number
    #[arg(
        long,
        value_name = "N",
        default_value = "1",
        allow_negative_numbers = true
    )]
    pub spp: Spp,
    /// Method: afra2012 or nabata2013
    #[arg(long, value_name = "NAME", default_value = "nabata2013")]
    pub method: String,
    /// Precision of the triangle test: fast, watertight or exact
    #[arg(long, value_name = "NAME", default_value = "fast")]
    pub precision: String,
    /// Where the nodes go: .csv or .npz
    #[arg(long, value_name = "FILE", default_value = "dacrt-nodes.csv")]
    pub out: PathBuf,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
    #[command(flatten)]
    pub knobs: KnobLists,
}

#[derive(Args)]
#[command(after_help = "\
shaded  grey surfaces in the light of the camera, the scene's point light (with shadows) and an
        even sky (ambient occlusion)
depth   distance, near is bright
prim    a colour for each triangle
boxes   ray/box tests a ray in false colour, from black (none) over blue, green and yellow to red
        (the most there are): each tile of 8 x 8 pixels is traced as a batch of its own, so large
        scenes take a while
diff    the class of each ray against Embree in the mode that the precision is set against: grey
        where both agree; tie blue, edge green, Embree wrong yellow, ours wrong (t included) red,
        both wrong violet

Examples:
  dacrt render hall                                  hall-shaded.png
  dacrt render sibenik --what shaded,prim,boxes --resolution 1280x720 --out pictures/")]
pub struct RenderArgs {
    /// Scene (see `dacrt scenes`)
    pub scene: String,
    /// Camera by name, or generated-1 ... generated-16 [default: the first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// What to show
    #[arg(long, value_enum, value_delimiter = ',', default_value = "shaded")]
    pub what: Vec<What>,
    /// Picture size in pixels
    #[arg(
        long,
        value_name = "N|WxH",
        default_value = "512",
        allow_negative_numbers = true
    )]
    pub resolution: Resolution,
    /// Samples per pixel of the shaded picture, a square number
    #[arg(
        long,
        value_name = "N",
        default_value = "16",
        allow_negative_numbers = true
    )]
    pub spp: Spp,
    /// A .png file (one picture), or a folder for SCENE-WHAT.png [default: this folder]
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Method: afra2012, nabata2013, mora2011, mora2011-cones, mora2011-random or best
    #[arg(long, value_name = "NAME", default_value = "nabata2013")]
    pub method: String,
    /// Precision of the triangle test: fast, watertight or exact
    #[arg(long, value_name = "NAME", default_value = "fast")]
    pub precision: String,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
    #[command(flatten)]
    pub knobs: KnobLists,
}

#[derive(Args)]
pub struct ScenesArgs {
    /// Load every scene that is there, to count its triangles
    #[arg(long)]
    pub load: bool,
    #[command(flatten)]
    pub meshes: MeshArgs,
}

#[derive(Args)]
pub struct SchemaArgs {
    /// Which files
    #[arg(value_parser = PossibleValuesParser::new(KINDS.map(|kind| kind.name)))]
    pub kind: String,
}

#[derive(Args)]
pub struct EnvArgs {
    /// Write JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub meshes: MeshArgs,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn check(command: &clap::Command) {
        for line in command
            .get_after_help()
            .map(|text| text.to_string())
            .iter()
            .flat_map(|text| text.lines())
        {
            let width = line.chars().count();
            assert!(
                width <= 100,
                "{} --help: {width}: {line}",
                command.get_name()
            );
        }
        command.get_subcommands().for_each(check);
    }

    #[test]
    fn no_line_of_a_help_is_torn() {
        check(&Cli::command());
    }
}
