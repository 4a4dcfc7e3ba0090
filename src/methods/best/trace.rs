//! One trace: a pass over the triangles, then blocks of rays, one after another or dealt to threads.

use super::divide::Divide;
use super::first_pass::first_pass;
use super::memory::{Memory, SplitRoom, Worker};
use super::order::is_incoherent;
use super::splits::Splits;
use super::watched::Watched;
use super::{BestParameters, Sort};
use crate::geometry::Aabb;
use crate::kernels::{BUCKETS, BlockStreams, Rays, SortedRay, Source, Tmax, Window, place_keys};
use crate::methods::Counters;
use crate::methods::job::{Answer, Job, OCCLUDED, Trace};
use crate::methods::observer::Observer;
use crate::methods::stored::Sent;
use crate::methods::watch::Watch;
use crate::rays::MISS;
use crate::rays::active::ActiveRays;
use crate::simd::MAX_LANES;
use rayon::ThreadPool;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Traces a batch with a number of threads for which there is memory.
pub(in crate::methods) fn trace(
    job: &Job,
    parameters: &BestParameters,
    memory: &mut Memory,
    threads: usize,
    mut answer: Answer,
    observer: Observer,
) -> Trace {
    let batch = job.batch;
    let n = batch.len();
    let Observer {
        mut watch,
        stored,
        sent,
        ..
    } = observer;
    // Whoever watches a ray sees it on one thread.
    let threads = match watch {
        Some(_) => 1,
        None => threads,
    };
    let pool = memory.pool.as_ref().filter(|_| threads > 1);
    let workers = &mut memory.workers[..threads];
    let rooms = &mut memory.rooms[..threads];
    let splits = match sent {
        None => first_pass(job, parameters, pool, &mut memory.triangles, rooms),
        Some((tree, how)) => {
            assert_eq!(how, Sent::Together, "blocks of rays are sent together");
            Splits::kept(job, tree.best.as_ref().expect("splits of best"))
        }
    };
    let (scene, triangles) = (splits.node(0).bounds, splits.node(0).weight());
    let sorted = match parameters.sort {
        Sort::Auto => is_incoherent(batch),
        Sort::Never => false,
        Sort::Always => true,
    };
    for worker in &mut *workers {
        worker.counters = Counters::default();
        worker.invalid_rays = 0;
    }
    let out = Out::new(&mut answer);
    let window = match sorted {
        true => parameters.window as usize,
        false => n.max(1),
    };
    for from in (0..n).step_by(window) {
        let range = from..n.min(from + window);
        let mut blocks = Blocks {
            job,
            parameters,
            splits: &splits,
            scene,
            source: Source::Batch(job.batch),
            size: parameters.size_of_block(triangles, range.len().div_ceil(threads), sorted),
            len: range.len(),
            out: &out,
            next: AtomicUsize::new(0),
        };
        if sorted {
            let records = &mut memory.records[..range.len()];
            let places = &mut memory.record_places[..range.len()];
            let keys = &mut memory.keys[..range.len()];
            let buckets = &mut memory.buckets[..threads * BUCKETS];
            put_in_order(
                job,
                pool,
                &scene,
                range,
                buckets,
                keys,
                (&mut *records, &mut *places),
            );
            blocks.source = Source::Records(records, places);
        }
        let tasks = workers.iter_mut().zip(&mut *rooms);
        match threads {
            1 => tasks.for_each(|(worker, room)| blocks.trace(worker, room, watch.as_deref_mut())),
            _ => each(pool, tasks, |(worker, room)| {
                blocks.trace(worker, room, None)
            }),
        }
    }
    if let Some(stored) = stored {
        stored.best = Some(splits.keep());
    }
    if let Answer::Nearest(hits) = answer {
        let share = |i: usize| n * i / threads;
        let (mut t, mut prim) = (&mut hits.t[..], &mut hits.prim[..]);
        let tasks = (0..threads).map(|i| {
            let len = share(i + 1) - share(i);
            (share(i), split_off(&mut prim, len), split_off(&mut t, len))
        });
        each(pool, tasks, |(from, prim, t)| job.round(from, prim, t));
    }
    let mut counters = Counters::default();
    let mut invalid_rays = 0;
    for worker in workers {
        counters.add(&worker.counters);
        invalid_rays += worker.invalid_rays;
    }
    Trace {
        counters,
        shared_origin: job.shared_origin.is_some(),
        invalid_rays,
        variant: None,
    }
}

/// Does tasks, side by side if there are threads for that. The first is the caller's own: a caller that
/// slept meanwhile left its processor empty, and two threads that it woke shared the other one.
pub(super) fn each<T: Send>(
    pool: Option<&ThreadPool>,
    mut tasks: impl Iterator<Item = T>,
    work: impl Fn(T) + Sync,
) {
    let Some(pool) = pool else {
        return tasks.for_each(work);
    };
    let work = &work;
    let own = tasks.next();
    pool.in_place_scope(|scope| {
        for task in tasks {
            scope.spawn(move |_| work(task));
        }
        own.map(work);
    });
}

/// Takes the first `n` from what is left of a slice.
pub(super) fn split_off<'a, T>(rest: &mut &'a mut [T], n: usize) -> &'a mut [T] {
    let (first, others) = std::mem::take(rest).split_at_mut(n);
    *rest = others;
    first
}

/// Puts a window of the batch in order, each thread a part of it; there are [`BUCKETS`] counts for each.
fn put_in_order(
    job: &Job,
    pool: Option<&ThreadPool>,
    scene: &Aabb,
    window: Range<usize>,
    buckets: &mut [u32],
    keys: &mut [u16],
    (records, places): (&mut [SortedRay], &mut [u32]),
) {
    let (kernels, batch) = (job.kernels, job.batch);
    let threads = buckets.len() / BUCKETS;
    let len = window.len().div_ceil(threads).next_multiple_of(MAX_LANES);
    let from = |i: usize| window.end.min(window.start + i * len);
    let part = |i: usize| from(i)..from(i + 1);
    let shared = job.shared_origin.is_some();
    let mut rest = &mut *keys;
    let tasks = buckets.chunks_mut(BUCKETS).enumerate();
    let tasks = tasks.map(|(i, counts)| (part(i), split_off(&mut rest, part(i).len()), counts));
    each(pool, tasks, |(part, keys, counts)| {
        // SAFETY: the processor was checked.
        unsafe { (kernels.count_keys)(batch, part, shared, scene, keys, counts) }
    });
    place_keys(buckets);
    let to = Window {
        records: records.as_mut_ptr(),
        places: places.as_mut_ptr(),
    };
    let tasks = buckets.chunks_mut(BUCKETS).enumerate();
    each(pool, tasks, |(i, next)| {
        let keys = &keys[part(i).start - window.start..][..part(i).len()];
        // SAFETY: the processor was checked; each part has places of its own.
        unsafe { (kernels.put_in_order)(batch, part(i), keys, next, to) }
    });
}

/// Where answers go: each ray's is written by the one thread that has its block.
struct Out {
    t: *mut f32,
    prim: *mut u32,
    /// Null for nearest hits.
    occluded: *mut u8,
}

// SAFETY: no two threads write to the same place.
unsafe impl Sync for Out {}

impl Out {
    fn new(answer: &mut Answer) -> Out {
        match answer {
            Answer::Nearest(hits) => Out {
                t: hits.t.as_mut_ptr(),
                prim: hits.prim.as_mut_ptr(),
                occluded: std::ptr::null_mut(),
            },
            Answer::Any(occluded) => Out {
                t: std::ptr::null_mut(),
                prim: std::ptr::null_mut(),
                occluded: occluded.as_mut_ptr(),
            },
        }
    }

    fn is_any(&self) -> bool {
        !self.occluded.is_null()
    }
}

/// Rays that are dealt to threads, a block at a time.
struct Blocks<'a> {
    job: &'a Job<'a>,
    parameters: &'a BestParameters,
    splits: &'a Splits<'a>,
    scene: Aabb,
    source: Source<'a>,
    /// How many there are in the source, and in a block.
    len: usize,
    size: usize,
    out: &'a Out,
    /// The first ray that nobody has taken.
    next: AtomicUsize,
}

impl Blocks<'_> {
    /// Traces rays until there are none left.
    fn trace(&self, worker: &mut Worker, room: &mut SplitRoom, mut watch: Option<&mut Watch>) {
        loop {
            let from = self.next.fetch_add(self.size, Ordering::Relaxed);
            if from >= self.len {
                return;
            }
            let range = from..self.len.min(from + self.size);
            self.trace_block(worker, room, range, watch.as_deref_mut());
        }
    }

    /// Traces some rays of the source.
    fn trace_block(
        &self,
        worker: &mut Worker,
        room: &mut SplitRoom,
        range: Range<usize>,
        watch: Option<&mut Watch>,
    ) {
        let (job, kernels) = (self.job, self.job.kernels);
        let streams = BlockStreams {
            ordered: worker.ordered(),
            tmax: worker.tmax.as_mut_ptr(),
            places: worker.places.as_mut_ptr(),
        };
        let groups = worker.groups();
        let capacity = ActiveRays::capacity(worker.active.rays());
        let (active, scratch) = worker.active.streams();
        let mut rays = Rays {
            active,
            scratch,
            directions: worker.directions.as_mut_ptr(),
            t: worker.t.as_mut_ptr(),
            prim: worker.prim.as_mut_ptr(),
            shared_origin: job.shared_origin,
            special: false,
            least_tmin: 0.0,
            any_hit: self.out.is_any(),
            precision: job.precision,
            tmax: Tmax {
                one: None,
                each: streams.tmax,
            },
            ahead: range.len() > AHEAD_FROM,
            scene: self.scene,
        };
        // SAFETY: the processor was checked; the memory has room for the block.
        let prepared =
            unsafe { (kernels.load_block)(&self.source, range.clone(), &rays, &streams) };
        rays.special = prepared.special;
        rays.least_tmin = prepared.least_tmin;
        rays.tmax.one = prepared.one_tmax;
        worker.invalid_rays += (range.len() - prepared.valid) as u64;
        let places = &worker.places[..prepared.valid];
        if self.splits.node(0).weight() > 0 && prepared.valid > 0 {
            let watch = watch.and_then(|watch| {
                let ray = places.iter().position(|&place| place == watch.id)?;
                watch.ray.least_tmin = prepared.least_tmin;
                Some(Watched { watch, ray })
            });
            // SAFETY: the processor was checked.
            unsafe { (kernels.bound_groups)(&rays, &groups, prepared.valid) };
            let mut divide = Divide {
                kernels,
                parameters: self.parameters,
                splits: self.splits,
                room,
                rays,
                ordered: streams.ordered,
                groups,
                entries: &mut worker.entries,
                in_groups: &mut worker.in_groups,
                capacity,
                counters: &mut worker.counters,
                watch,
            };
            divide.start(prepared.valid);
        }
        // SAFETY: the memory is the worker's own.
        unsafe { self.write(&rays, range, places) }
    }

    /// Writes the answers of rays of the source, of which the valid ones have these places in the batch.
    ///
    /// # Safety
    /// The best hits in `rays` are there for each of them.
    unsafe fn write(&self, rays: &Rays, range: Range<usize>, places: &[u32]) {
        let all_valid = places.len() == range.len();
        let place = |i: usize| match &self.source {
            Source::Batch(_) => i,
            Source::Records(_, places) => places[i] as usize,
        };
        // SAFETY: places of the batch that no other thread has.
        unsafe {
            if self.out.is_any() {
                if !all_valid {
                    range.for_each(|i| *self.out.occluded.add(place(i)) = 0);
                }
                for (i, &place) in places.iter().enumerate() {
                    let occluded = *rays.t.add(i) == OCCLUDED;
                    *self.out.occluded.add(place as usize) = occluded as u8;
                }
                return;
            }
            if !all_valid {
                for i in range {
                    *self.out.t.add(place(i)) = f32::INFINITY;
                    *self.out.prim.add(place(i)) = MISS;
                }
            }
            let (t, prim) = (self.out.t, self.out.prim);
            (self.job.kernels.store_hits)(rays, places, t, prim);
        }
    }
}

/// Blocks of more rays than this do not fit the second-level cache: what is looked up by number is
/// fetched ahead.
const AHEAD_FROM: usize = 1 << 16;
