//! Threads that trace, made beforehand: a batch user has them, so Embree is not charged for starting them.

use anyhow::Context;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex};

/// Rays of a block, one of which a thread takes at a time; whole packets.
pub(super) const BLOCK: usize = 4096;

#[derive(Clone, Debug)]
pub(super) enum Threads {
    /// The thread that calls.
    Caller,
    Pool(Arc<ThreadPool>),
    /// One for each processor, as the exact arbiter has them: for what is not timed.
    All,
}

impl Threads {
    /// As many as asked for, at least one; one is the caller's own.
    pub fn new(threads: usize) -> anyhow::Result<Threads> {
        if threads <= 1 {
            return Ok(Threads::Caller);
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.with_context(|| format!("cannot start {threads} threads"))?;
        Ok(Threads::Pool(Arc::new(pool)))
    }

    /// Deals blocks of work to the threads, in order, and waits for the last of them.
    pub fn deal<T: Send>(&self, blocks: impl Iterator<Item = T> + Send, work: impl Fn(T) + Sync) {
        let blocks = Mutex::new(blocks);
        let next = || blocks.lock().expect("iterators do not panic").next();
        // The lock is held while a block is taken, not while it is worked on.
        let work = || {
            while let Some(block) = next() {
                work(block);
            }
        };
        match self {
            Threads::Caller => work(),
            Threads::Pool(pool) => drop(pool.broadcast(|_| work())),
            Threads::All => drop(rayon::broadcast(|_| work())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::sync::Barrier;

    #[test]
    fn every_block_is_dealt_once() {
        let some = [1, 2, 5].map(|threads| Threads::new(threads).unwrap());
        for threads in some.into_iter().chain([Threads::All]) {
            let mut numbers = vec![0u32; 1000];
            let blocks = numbers.chunks_mut(7).enumerate();
            threads.deal(blocks, |(i, block)| {
                block.iter_mut().for_each(|number| *number += i as u32 + 1);
            });
            assert!((numbers.iter().enumerate()).all(|(i, &n)| n == (i / 7) as u32 + 1));
        }
    }

    #[test]
    fn there_are_as_many_threads_as_asked_for() {
        for threads in [1, 2, 5] {
            let dealt = Threads::new(threads).unwrap();
            let (seen, barrier) = (Mutex::new(HashSet::new()), Barrier::new(threads));
            for _ in 0..3 {
                // None goes on before all have come.
                dealt.deal(0..threads, |_| {
                    barrier.wait();
                    seen.lock().unwrap().insert(std::thread::current().id());
                });
            }
            assert_eq!(seen.lock().unwrap().len(), threads);
        }
    }
}
