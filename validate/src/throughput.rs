//! Throughput: several threads that each trace a whole batch of their own, as Mora 2011, section
//! 4.2, does with images. Latency, several threads in one trace, is another thing; both are in the
//! document.

use crate::json_file;
use crate::machine::{Machine, Software};
use crate::statistics::Ratio;
use anyhow::Context;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;
use std::sync::Barrier;
use std::time::Instant;

/// What [`Document::kind`] says. There is no `schema`, so no command takes the file for the
/// [results](crate::results) of a run.
pub const KIND: &str = "throughput";

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
    /// Seed of every random choice.
    pub seed: u64,
    /// The batches.
    pub batches: Vec<BatchTimes>,
}

/// One batch of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatchTimes {
    /// Name of the scene.
    pub scene: String,
    /// Name of the camera.
    pub camera: String,
    /// Pixels.
    pub resolution: [u32; 2],
    /// Ray type.
    pub rays: String,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Rays of the batch.
    pub ray_count: usize,
    /// SHA-256 of the rays, as in results of runs.
    pub ray_hash: String,
    /// Those whose hits are right.
    pub timings: Vec<Timing>,
    /// Wrong hits, in words; of who has any, there are no times.
    pub findings: Vec<String>,
}

/// How threads share the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// Each traces the whole batch.
    Throughput,
    /// All trace one batch together.
    Latency,
}

/// One tracer with a number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Name of the method, or `embree` with quality of the build and query: `embree low_16`.
    pub tracer: String,
    /// How the threads share the work; one thread alone is of throughput.
    pub scheme: Scheme,
    /// How many there are.
    pub threads: usize,
    /// Milliseconds from the barrier to the last thread that is done, of each repeat.
    pub samples_ms: Vec<f64>,
    /// Million rays a second of all threads together, of the median.
    pub mrays_per_s: f64,
    /// Rays a second over those of one thread, with its 95 % bootstrap interval.
    pub over_one_thread: Ratio,
    /// SHA-256 of the hits, as in results of runs.
    pub hit_hash: String,
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

/// Threads that are there beforehand and start together, each on a processor of its own: threads that are
/// woken together may share one for tens of milliseconds while another has nothing to do.
#[derive(Debug)]
pub struct Crew {
    pool: ThreadPool,
    barrier: Barrier,
}

impl Crew {
    /// So many threads, at least 1.
    ///
    /// # Errors
    /// If they cannot be started.
    pub fn new(threads: usize) -> anyhow::Result<Crew> {
        let processors = core_affinity::get_core_ids().unwrap_or_default();
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .start_handler(move |thread| {
                // Where it does not work, threads are wherever the system puts them.
                let own = processors.get(thread);
                own.map(|processor| core_affinity::set_for_current(*processor));
            })
            .build();
        let pool = pool.with_context(|| format!("cannot start {threads} threads"))?;
        Ok(Crew {
            barrier: Barrier::new(pool.current_num_threads()),
            pool,
        })
    }

    /// How many there are.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Each thread works once, given its number. Returns the milliseconds from the first that left
    /// the barrier to the last that was done.
    ///
    /// # Panics
    /// If the work does.
    pub fn milliseconds(&self, work: impl Fn(usize) + Sync) -> f64 {
        let spans = self.pool.broadcast(|thread| {
            self.barrier.wait();
            let start = Instant::now();
            work(thread.index());
            (start, Instant::now())
        });
        let start = spans.iter().map(|span| span.0).min();
        let end = spans.iter().map(|span| span.1).max();
        let both = start.zip(end).expect("there is a thread");
        (both.1 - both.0).as_secs_f64() * 1e3
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::time::Duration;

    #[test]
    fn every_thread_works_once_and_all_at_once() {
        for threads in [1, 2, 5] {
            let crew = Crew::new(threads).unwrap();
            assert_eq!(crew.threads(), threads);
            let (seen, all) = (Mutex::new(Vec::new()), Barrier::new(threads));
            for _ in 0..3 {
                crew.milliseconds(|thread| {
                    // None goes on before all have come.
                    all.wait();
                    seen.lock().unwrap().push(thread);
                });
                let mut seen = std::mem::take(&mut *seen.lock().unwrap());
                seen.sort();
                assert_eq!(seen, (0..threads).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn the_slowest_thread_counts() {
        let ms = Crew::new(3).unwrap().milliseconds(|thread| {
            std::thread::sleep(Duration::from_millis(30 * thread as u64));
        });
        assert!(ms >= 60.0, "{ms}");
    }
}
