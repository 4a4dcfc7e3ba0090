//! What a result must say about where it comes from.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

/// Where a run took place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Instruction set that the engine uses: `avx512`, `avx2` or `portable`.
    pub isa: String,
    /// Hardware threads that this process may use.
    pub cores: usize,
    /// Main memory.
    pub memory_bytes: u64,
    /// Load averages over 1, 5 and 15 minutes at the start.
    pub load: [f64; 3],
    /// Control bits of the MXCSR register; `None` where there is no such register.
    pub mxcsr: Option<u32>,
}

impl Machine {
    /// Asks the operating system.
    pub fn here(isa: &str) -> Machine {
        let system = System::new_with_specifics(
            RefreshKind::nothing()
                .with_cpu(CpuRefreshKind::nothing())
                .with_memory(MemoryRefreshKind::nothing().with_ram()),
        );
        let load = System::load_average();
        Machine {
            cpu: system
                .cpus()
                .first()
                .map_or("unknown".to_owned(), |cpu| cpu.brand().trim().to_owned()),
            isa: isa.to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            memory_bytes: system.total_memory(),
            load: [load.one, load.five, load.fifteen],
            mxcsr: crate::embree::mxcsr(),
        }
    }
}

/// Bytes of main memory that nobody uses.
pub fn available_memory() -> u64 {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory));
    system.available_memory()
}

/// What ran.
///
/// Commit and state are those at build time (`build/version.rs`): they say which source is in the
/// binary, while the folder it came from may have moved on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Software {
    /// Git commit; `None` if it was not built from a checkout.
    pub commit: Option<String>,
    /// Whether tracked files differed from that commit.
    pub dirty: Option<bool>,
    /// Version of the compiler.
    pub rustc: String,
    /// The reference; `None` if it was not used.
    pub embree: Option<Embree>,
}

/// Which Embree answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Embree {
    /// For instance `4.4.0`.
    pub version: String,
    /// Widest instruction set that it uses here.
    pub isa: String,
    /// File name of the library.
    pub library: String,
}

impl From<&crate::embree::Info> for Embree {
    fn from(info: &crate::embree::Info) -> Embree {
        Embree {
            version: info.version.clone(),
            isa: info.isa.clone(),
            library: info.library.clone(),
        }
    }
}

impl Software {
    /// This program.
    pub fn this(embree: Option<Embree>) -> Software {
        let known = |text: &'static str| (!text.is_empty()).then_some(text);
        Software {
            commit: known(env!("DACRT_COMMIT")).map(str::to_owned),
            dirty: known(env!("DACRT_DIRTY")).map(|dirty| dirty == "true"),
            rustc: env!("DACRT_RUSTC").to_owned(),
            embree,
        }
    }
}
