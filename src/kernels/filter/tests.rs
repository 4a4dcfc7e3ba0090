//! Filters of every instance against a plain definition, with the live records of other lists all
//! around.

use super::*;
use crate::kernels::Kernels;
use crate::kernels::Tmax;
use crate::kernels::slab::PADDING;
use crate::methods::Precision;
use crate::rays::active::ActiveRays;
use crate::simd::{Isa, MAX_LANES};
use glam::Vec3;

/// Records that stand in the streams, most of them outside the list that is filtered.
const RECORDS: usize = 256;
/// Where the list starts, and where a copy goes.
const START: usize = 32;
const PLACE: usize = 160;

const BOX: Aabb = Aabb {
    min: Vec3::new(-1.0, -1.0, -1.0),
    max: Vec3::new(1.0, 2.0, 1.0),
};
const SHARED: Vec3 = Vec3::new(-3.0, 0.5, -0.25);

/// One ray as the streams have it.
#[derive(Clone, Copy, Debug)]
struct Record {
    inverse: [f32; 3],
    origin: [f32; 3],
    id: u32,
}

impl Record {
    fn bits(&self) -> ([u32; 3], [u32; 3], u32) {
        (
            self.inverse.map(f32::to_bits),
            self.origin.map(f32::to_bits),
            self.id,
        )
    }
}

/// Why a record is kept or not.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Kept,
    /// Passes by.
    Misses,
    /// Has a hit before the box.
    Ended,
    /// Has a hit where it enters the box: kept, as boxes are culled non-strictly.
    EndsAtEntry,
    /// With special rays: d is zero on y and z, the origin between the planes, on one, or outside.
    Between,
    OnPlane,
    Outside,
}

/// A list in the middle of the streams.
struct Bench {
    memory: ActiveRays,
    t: Vec<f32>,
    rays: Rays,
}

impl Bench {
    /// `kind` by place in the streams, `id` a permutation of them.
    fn new(
        shared: bool,
        special: bool,
        kind: impl Fn(usize) -> Kind,
        id: impl Fn(usize) -> usize,
    ) -> Bench {
        let mut memory = ActiveRays::new(RECORDS);
        let (active, scratch) = memory.streams();
        let mut t = vec![f32::INFINITY; RECORDS];
        for place in 0..RECORDS {
            let mut origin = if shared {
                SHARED
            } else {
                SHARED - Vec3::new(place as f32 / 64.0, 0.0, 0.0)
            };
            let slope = 0.01 + place as f32 / 4096.0;
            let mut d = Vec3::new(1.0, slope, slope / 2.0);
            match kind(place) {
                Kind::Kept => {}
                Kind::Misses => d.y = 3.0 + slope,
                Kind::Ended => t[id(place)] = 1.0,
                Kind::EndsAtEntry => {
                    t[id(place)] = (BOX.min.x - origin.x) * (1.0 - PADDING);
                }
                Kind::Between => (d.y, d.z) = (0.0, -0.0),
                Kind::OnPlane => (d.y, d.z, origin.y) = (-0.0, 1e-39, BOX.max.y),
                Kind::Outside => (d.y, d.z, origin.z) = (0.0, 0.0, BOX.max.z.next_up()),
            }
            let finite = |x: f32| if x.is_finite() { x } else { f32::NAN };
            // SAFETY: the streams have room for so many records.
            unsafe {
                for (axis, o) in origin.to_array().into_iter().enumerate() {
                    *active.inverse[axis].add(place) = finite(1.0 / d[axis]);
                    *active.origin[axis].add(place) = o;
                }
                *active.id.add(place) = id(place) as u32;
            }
        }
        let rays = Rays {
            active,
            scratch,
            directions: std::ptr::null_mut(),
            t: t.as_mut_ptr(),
            prim: std::ptr::null_mut(),
            shared_origin: shared.then_some(SHARED),
            special,
            least_tmin: 0.0,
            any_hit: false,
            precision: Precision::Fast,
            ahead: true,
            tmax: Tmax {
                one: None,
                each: std::ptr::null(),
            },
            scene: Aabb::EMPTY,
        };
        Bench { memory, t, rays }
    }

    fn records(&self) -> Vec<Record> {
        let s = &self.rays.active;
        (0..RECORDS)
            // SAFETY: as above.
            .map(|place| unsafe {
                Record {
                    inverse: s.inverse.map(|p| *p.add(place)),
                    origin: s.origin.map(|p| *p.add(place)),
                    id: *s.id.add(place),
                }
            })
            .collect()
    }

    /// The contract in plain words: where the slabs overlap, widened by the padding, no further
    /// away than the best hit.
    fn keeps(&self, record: &Record) -> bool {
        let origin = self
            .rays
            .shared_origin
            .map_or(record.origin, |o| o.to_array());
        let (mut near, mut far) = (0f32, f32::INFINITY);
        for (axis, o) in origin.into_iter().enumerate() {
            let (lo, hi) = (BOX.min[axis], BOX.max[axis]);
            let inverse = record.inverse[axis];
            if inverse.is_nan() {
                if !(lo <= o && o <= hi) {
                    return false;
                }
            } else {
                let (a, b) = ((lo - o) * inverse, (hi - o) * inverse);
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
        }
        let (near, far) = (near * (1.0 - PADDING), far * (1.0 + PADDING));
        near <= far && near <= self.t[record.id as usize]
    }

    /// Filters in both ways on one instruction set and compares all records with what they should be.
    fn check(&mut self, isa: Isa, len: usize, keep: Keep, at: &str) {
        let before = self.records();
        let list = List { start: START, len };
        let members = &before[START..START + len];
        let (kept, rejected): (Vec<Record>, Vec<Record>) =
            members.iter().partition(|record| self.keeps(record));
        let kernels = Kernels::of(isa);
        // SAFETY: the processor was checked; the list and the room for a copy are within the streams.
        let (counted, n) = unsafe {
            (
                (kernels.count)(&self.rays, list, &BOX, 1),
                (kernels.filter)(&self.rays, list, &BOX, keep),
            )
        };
        assert_eq!(n, kept.len(), "{at}");
        assert_eq!(counted, (n, len), "{at}");

        let after = self.records();
        let mut expected = before.clone();
        let place = match keep {
            Keep::Copy(place) => place,
            Keep::InPlace => START,
        };
        expected[place..place + n].copy_from_slice(&kept);
        if keep == Keep::InPlace {
            expected[START + n..START + len].copy_from_slice(&rejected);
        }
        for i in 0..RECORDS {
            // A copy may write whole vectors: what follows it is free.
            if keep != Keep::InPlace && (place + n..place + n + MAX_LANES).contains(&i) {
                continue;
            }
            // Where the origin is shared, those in the streams are not moved along.
            let [mut a, mut b] = [after[i], expected[i]];
            if self.rays.shared_origin.is_some() {
                assert_eq!(
                    a.origin.map(f32::to_bits),
                    before[i].origin.map(f32::to_bits)
                );
                (a.origin, b.origin) = ([0.0; 3], [0.0; 3]);
            }
            assert_eq!(a.bits(), b.bits(), "record {i}, {at}");
        }
    }
}

/// What stands at a place.
type Pattern = Box<dyn Fn(usize) -> Kind>;

/// Patterns of kinds that matter: all, none, ends, every other, runs, and mixtures.
fn patterns(special: bool) -> Vec<(&'static str, Pattern)> {
    use Kind::*;
    let when = |keep: fn(usize) -> bool| -> Pattern {
        Box::new(move |place| {
            if keep(place) {
                Kept
            } else if place % 3 == 0 {
                Ended
            } else {
                Misses
            }
        })
    };
    let random = |special: bool, seed: u64| -> Pattern {
        let kinds: &[Kind] = if special {
            &[Kept, Misses, Ended, EndsAtEntry, Between, OnPlane, Outside]
        } else {
            &[Kept, Misses, Ended, EndsAtEntry]
        };
        Box::new(move |place| {
            let bits = crate::random::hash(seed, 0, place as u64);
            kinds[crate::random::below(bits, kinds.len() as u32) as usize]
        })
    };
    vec![
        ("all", when(|_| true)),
        ("none", when(|_| false)),
        ("first", when(|place| place == START)),
        ("all but the first", when(|place| place != START)),
        ("even", when(|place| place % 2 == 0)),
        ("odd", when(|place| place % 2 == 1)),
        ("runs of five", when(|place| place / 5 % 2 == 0)),
        ("all but every 16th", when(|place| place % 16 != 15)),
        ("front half", when(|place| place < START + 20)),
        ("back half", when(|place| place >= START + 20)),
        ("random 1", random(special, 1)),
        ("random 2", random(special, 2)),
        ("random 3", random(special, 3)),
    ]
}

fn check_all(shared: bool, special: bool) {
    // Neighbours in the batch are loaded, others are gathered.
    let in_order = |place| place;
    let reversed = |place| RECORDS - 1 - place;
    let scattered = |place| place * 37 % RECORDS;
    let ids: [fn(usize) -> usize; 3] = [in_order, reversed, scattered];
    // Some of them in Miri, which is a thousand times as slow.
    let (skipped, stride) = if cfg!(miri) { (2, 31) } else { (0, 1) };
    for isa in Isa::available() {
        for (order, id) in ids.into_iter().enumerate().skip(skipped) {
            for (pattern, kind) in patterns(special).into_iter().skip(2 * skipped) {
                for len in (0..=67).step_by(stride) {
                    for keep in [Keep::Copy(PLACE), Keep::InPlace] {
                        let mut bench = Bench::new(shared, special, &kind, id);
                        let how = if keep == Keep::InPlace {
                            "in place"
                        } else {
                            "copy"
                        };
                        let at = format!("{isa}, {how}, ids {order}, {pattern}, {len} rays");
                        bench.check(isa, len, keep, &at);
                    }
                }
            }
        }
    }
}

#[test]
fn own_origins() {
    check_all(false, false);
}

#[test]
fn a_shared_origin() {
    check_all(true, false);
}

#[test]
fn own_origins_with_axes_of_no_direction() {
    check_all(false, true);
}

#[test]
fn a_shared_origin_with_axes_of_no_direction() {
    check_all(true, true);
}

#[test]
fn kinds_are_what_they_are_called() {
    use Kind::*;
    for (kind, kept) in [
        (Kept, true),
        (Misses, false),
        (Ended, false),
        (EndsAtEntry, true),
        (Between, true),
        (OnPlane, true),
        (Outside, false),
    ] {
        let bench = Bench::new(false, true, move |_| kind, |place| place);
        let records = bench.records();
        assert!(records.iter().all(|r| bench.keeps(r) == kept), "{kind:?}");
        assert_eq!(bench.memory.rays(), RECORDS);
    }
}

#[test]
fn a_probe_counts_every_so_manieth_block() {
    for isa in Isa::available() {
        for stride in [1, 2, 3, 5] {
            for len in (1..100).step_by(if cfg!(miri) { 33 } else { 1 }) {
                let kind = |place| {
                    if place % 3 == 0 {
                        Kind::Kept
                    } else {
                        Kind::Misses
                    }
                };
                let bench = Bench::new(false, false, kind, |place| place);
                let records = bench.records();
                let probed: Vec<&Record> = records[START..START + len]
                    .chunks(BLOCK)
                    .step_by(stride)
                    .flatten()
                    .collect();
                let kept = probed.iter().filter(|r| bench.keeps(r)).count();
                let list = List { start: START, len };
                // SAFETY: the processor was checked; the list is within the streams.
                let counted = unsafe { (Kernels::of(isa).count)(&bench.rays, list, &BOX, stride) };
                assert_eq!(
                    counted,
                    (kept, probed.len()),
                    "{isa}, stride {stride}, {len} rays"
                );
            }
        }
    }
}
