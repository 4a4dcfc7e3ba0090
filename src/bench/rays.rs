//! What is done to rays, one by one or in cones.

use super::triangles::{CUBE, HALF, Indices, Lists, mesh};
use super::{Bench, Work, best, number, point};
use crate::geometry::{Aabb, Mesh};
use crate::kernels::{
    Cones, Done, Item, Keep, Kernels, List, Listed, Range, RayRecords, Rays, Tmax,
};
use crate::methods::Precision;
use crate::rays::active::ActiveRays;
use crate::rays::{Batch, Ray};
use crate::simd::MAX_LANES;
use glam::Vec3;
use std::ptr::null_mut;

/// Rays of a list that meets triangles.
pub(super) const RAYS: usize = 512;
/// Triangles of such a list.
const TRIANGLES: usize = 16;
/// Lists of triangles; the next list of rays takes the next of these.
const LISTS: usize = 64;

/// Rays into the unit cube, none of them along a plane of it: a single such ray makes all tests of a
/// batch slower.
pub(super) fn batch(len: usize, shared: bool) -> Batch {
    let ray = |i| {
        let origin = match shared {
            true => Vec3::splat(0.5),
            false => point(2, i),
        };
        let origin = origin - Vec3::new(0.0, 0.0, 1.5);
        let d = point(3, i) - origin;
        Ray::new(origin, Vec3::select(d.cmpeq(Vec3::ZERO), Vec3::ONE, d))
    };
    (0..len).map(ray).collect()
}

/// The records of a batch and its index list.
struct Indexed {
    batch: Batch,
    /// Two records each.
    slabs: Vec<Line>,
    directions: Vec<[f32; 4]>,
    ids: Vec<u32>,
}

/// A cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([[f32; 4]; 4]);

impl Indexed {
    fn new(len: usize, shared: bool) -> Indexed {
        Indexed {
            batch: batch(len, shared),
            slabs: vec![Line([[0.0; 4]; 4]); len.div_ceil(2)],
            directions: vec![[0.0; 4]; len],
            ids: vec![0; len + crate::kernels::RAYS_AHEAD],
        }
    }

    fn pointers(&mut self, shared: bool) -> RayRecords {
        RayRecords {
            slabs: self.slabs.as_mut_ptr().cast(),
            directions: self.directions.as_mut_ptr(),
            tmin: self.batch.tmin.as_ptr(),
            ids: self.ids.as_mut_ptr(),
            shared_origin: shared.then(|| self.batch.ray(0).origin),
            special: false,
            least_tmin: 0.0,
            one_tmin: true,
            any_hit: false,
            precision: Precision::Fast,
            tmax: Tmax::of(&self.batch),
            scene: CUBE,
        }
    }

    fn reset(&mut self, shared: bool) {
        let rays = self.pointers(shared);
        // SAFETY: the processor was checked; there is room for the batch.
        let prepared = unsafe { (best().prepare_records)(&self.batch, &rays) };
        let as_said = prepared.one_tmin && prepared.least_tmin == 0.0 && !prepared.special;
        assert!(as_said && prepared.valid == self.batch.len());
    }
}

/// Rays by number against a box.
struct IndexedBox<const SHARED: bool>(Indexed);

pub(super) fn indexed_box<const SHARED: bool>(bytes: usize) -> Bench {
    let touched = if SHARED { 16 } else { 32 } + 4;
    let indexed = Indexed::new((bytes / touched).max(1000), SHARED);
    Bench {
        work: Box::new(IndexedBox::<SHARED>(indexed)),
        bytes_per_test: (touched + 4) as f64,
    }
}

impl<const SHARED: bool> Work for IndexedBox<SHARED> {
    fn reset(&mut self) {
        self.0.reset(SHARED);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let rays = self.0.pointers(SHARED);
        let to = self.0.batch.len();
        // SAFETY: the processor is the caller's promise; the list is that of the batch.
        unsafe { (kernels.keep_meeting)(&rays, Range { from: 0, to }, &HALF, None) };
        to
    }

    fn left(&self) -> Vec<u32> {
        self.0.ids[..self.0.batch.len()].to_vec()
    }
}

/// Rays by number against triangles.
struct IndexedTriangles<const SHARED: bool> {
    rays: Indexed,
    mesh: Mesh,
    lists: Lists,
}

pub(super) fn indexed_triangles<const SHARED: bool>(bytes: usize) -> Bench {
    let touched = if SHARED { 16 } else { 32 } + 16 + 4;
    let mesh = mesh(LISTS * TRIANGLES);
    Bench {
        work: Box::new(IndexedTriangles::<SHARED> {
            rays: Indexed::new(whole_lists(bytes / touched), SHARED),
            lists: Lists::new(&mesh),
            mesh,
        }),
        bytes_per_test: touched as f64 / TRIANGLES as f64,
    }
}

pub(super) fn whole_lists(rays: usize) -> usize {
    (rays / RAYS).max(1) * RAYS
}

impl<const SHARED: bool> Work for IndexedTriangles<SHARED> {
    fn reset(&mut self) {
        self.rays.reset(SHARED);
        self.lists.prepare(&self.mesh);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let rays = self.rays.pointers(SHARED);
        let lists = self.lists.pointers();
        // As traces of such a batch have it.
        let when = match SHARED {
            true => Done::BeforeExit,
            false => Done::Never,
        };
        let len = self.rays.batch.len();
        for (i, from) in (0..len).step_by(RAYS).enumerate() {
            let list = Range {
                from,
                to: from + RAYS,
            };
            let mut lists = lists;
            // SAFETY: the processor is the caller's promise; lists are those of batch and mesh.
            unsafe {
                lists.ids = lists.ids.add(i % LISTS * TRIANGLES);
                let triangles = Listed {
                    lists: &lists,
                    triangles: self.mesh.triangles(),
                    len: TRIANGLES,
                    duplicates: &mut 0,
                };
                (kernels.naive_indexed)(&rays, list, triangles, &CUBE, when);
            }
        }
        len * TRIANGLES
    }

    fn left(&self) -> Vec<u32> {
        let found = self.rays.directions.iter().map(|d| d[3].to_bits());
        found.chain(self.rays.ids.iter().copied()).collect()
    }
}

/// The lists of copied rays of a batch.
pub(super) struct Copied {
    batch: Batch,
    active: ActiveRays,
    directions: Vec<[f32; 4]>,
    t: Vec<f32>,
    prim: Vec<u32>,
}

impl Copied {
    pub fn new(len: usize, shared: bool) -> Copied {
        Copied::with_room(len, len, shared)
    }

    /// With lists for a batch of `room` rays.
    pub fn with_room(len: usize, room: usize, shared: bool) -> Copied {
        Copied {
            batch: batch(len, shared),
            active: ActiveRays::new(room),
            directions: vec![[0.0; 4]; len],
            t: vec![0.0; len],
            prim: vec![0; len],
        }
    }

    pub fn len(&self) -> usize {
        self.batch.len()
    }

    /// Ids of all places of the lists.
    pub fn ids(&self) -> &[u32] {
        self.active.ids()
    }

    /// The triangle that each ray hits.
    pub fn found(&self) -> &[u32] {
        &self.prim
    }

    pub fn pointers(&mut self, shared: bool) -> Rays {
        let (active, scratch) = self.active.streams();
        Rays {
            active,
            scratch,
            directions: self.directions.as_mut_ptr(),
            t: self.t.as_mut_ptr(),
            prim: self.prim.as_mut_ptr(),
            shared_origin: shared.then(|| self.batch.ray(0).origin),
            special: false,
            least_tmin: 0.0,
            any_hit: false,
            precision: Precision::Fast,
            tmax: Tmax::of(&self.batch),
            ahead: true,
            scene: CUBE,
        }
    }

    pub fn reset(&mut self, shared: bool) {
        let rays = self.pointers(shared);
        self.prim.fill(crate::rays::MISS);
        // SAFETY: the processor was checked; there is room for the batch.
        let prepared = unsafe { (best().prepare_rays)(&self.batch, &rays) };
        let as_said = prepared.least_tmin == 0.0 && !prepared.special;
        assert!(as_said && prepared.valid == self.batch.len());
    }
}

/// Copied rays against a box.
struct CopiedBox<const SHARED: bool, const IN_PLACE: bool> {
    rays: Copied,
    kept: usize,
}

pub(super) fn copied_box<const SHARED: bool, const IN_PLACE: bool>(bytes: usize) -> Bench {
    let record = if SHARED { 12 } else { 24 } + 4;
    // With t. Half of the records go somewhere else, at least on the way.
    let touched = record + 4 + record / 2;
    let len = (bytes / touched).max(1000);
    let mut work = CopiedBox::<SHARED, IN_PLACE> {
        rays: Copied::new(len, SHARED),
        kept: 0,
    };
    work.reset();
    // SAFETY: the processor was checked.
    unsafe { work.run(best()) };
    let written = match IN_PLACE {
        true => len,
        false => work.kept,
    };
    let share = written as f64 / len as f64;
    Bench {
        work: Box::new(work),
        bytes_per_test: (record + 4) as f64 + share * record as f64,
    }
}

impl<const SHARED: bool, const IN_PLACE: bool> Work for CopiedBox<SHARED, IN_PLACE> {
    fn reset(&mut self) {
        self.rays.reset(SHARED);
        self.kept = 0;
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let rays = self.rays.pointers(SHARED);
        let len = self.rays.batch.len();
        let keep = match IN_PLACE {
            true => Keep::InPlace,
            false => Keep::Copy(len.next_multiple_of(MAX_LANES)),
        };
        // SAFETY: the processor is the caller's promise; the list is that of the batch, and there is
        // room for another of its length.
        self.kept = unsafe { (kernels.filter)(&rays, List { start: 0, len }, &HALF, keep) };
        len
    }

    fn left(&self) -> Vec<u32> {
        let len = self.rays.batch.len();
        let (start, len) = match IN_PLACE {
            true => (0, len),
            false => (len.next_multiple_of(MAX_LANES), self.kept),
        };
        let ids = self.rays.active.ids();
        ids[start..start + len].to_vec()
    }
}

/// Copied rays against triangles.
struct CopiedTriangles<const SHARED: bool> {
    rays: Copied,
    mesh: Mesh,
    items: Vec<Item>,
    precision: Precision,
    scene: Aabb,
}

pub(super) fn copied_triangles<const SHARED: bool>(bytes: usize) -> Bench {
    in_precision::<SHARED>(bytes, Precision::Fast)
}

pub(super) fn watertight_triangles(bytes: usize) -> Bench {
    in_precision::<false>(bytes, Precision::Watertight)
}

pub(super) fn exact_triangles(bytes: usize) -> Bench {
    in_precision::<false>(bytes, Precision::Exact)
}

fn in_precision<const SHARED: bool>(bytes: usize, precision: Precision) -> Bench {
    // With t, direction and tmin.
    let touched = if SHARED { 12 } else { 24 } + 4 + 4 + 16;
    let mesh = mesh(LISTS * TRIANGLES);
    let item = |(prim, triangle)| Item::new(triangle, prim as u32);
    Bench {
        work: Box::new(CopiedTriangles::<SHARED> {
            rays: Copied::new(whole_lists(bytes / touched), SHARED),
            items: mesh.triangles().iter().enumerate().map(item).collect(),
            scene: mesh.bounds(),
            mesh,
            precision,
        }),
        bytes_per_test: touched as f64 / TRIANGLES as f64,
    }
}

impl<const SHARED: bool> Work for CopiedTriangles<SHARED> {
    fn reset(&mut self) {
        self.rays.reset(SHARED);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let rays = Rays {
            precision: self.precision,
            scene: self.scene,
            ..self.rays.pointers(SHARED)
        };
        let len = self.rays.batch.len();
        for (i, start) in (0..len).step_by(RAYS).enumerate() {
            let list = List { start, len: RAYS };
            let items = &self.items[i % LISTS * TRIANGLES..][..TRIANGLES];
            // SAFETY: the processor is the caller's promise; the list is a part of that of the batch.
            unsafe { (kernels.naive)(&rays, list, self.mesh.triangles(), items) };
        }
        len * TRIANGLES
    }

    fn left(&self) -> Vec<u32> {
        self.rays.prim.clone()
    }
}

/// Cones against boxes.
struct Packets {
    cones: Vec<[f32; 4]>,
    indices: Indices,
}

/// Cones of a list.
const CONES: usize = 256;
const PACKET: usize = 64;
/// Boxes: one for each outline that one has from outside.
const BOXES: usize = 26;

/// The `i`-th box, seen from the origin: below, around or above it on each axis, but not around it on
/// all.
fn seen(i: usize) -> Aabb {
    // 13 of 27 is the one around the origin.
    let i = if i < 13 { i } else { i + 1 };
    let digit = |power: usize| (i / power % 3) as f32 - 1.0;
    let center = 3.0 * Vec3::new(digit(1), digit(3), digit(9));
    Aabb {
        min: center - Vec3::ONE,
        max: center + Vec3::ONE,
    }
}

/// Rays from the origin in tiles of 8 × 8, whose middles go to points of a box that is twice as long
/// as the one that they will meet, for [`CONES`] tiles of each box.
fn tiles() -> Batch {
    let ray = |i: usize| {
        let (tile, in_tile) = (i / PACKET, i % PACKET);
        let bounds = seen(tile / CONES);
        let middle = point(4, tile) * Vec3::new(2.0, 1.0, 1.0) * bounds.extent() + bounds.min;
        let across = middle.any_orthonormal_vector();
        let up = middle.cross(across).normalize() * middle.length();
        let across = across * middle.length();
        let size = 0.01 * (0.2 + number(5, tile));
        let at = |place: usize| size * (place as f32 - 3.5);
        let direction = middle + at(in_tile % 8) * across + at(in_tile / 8) * up;
        Ray::new(Vec3::ZERO, direction)
    };
    (0..BOXES * CONES * PACKET).map(ray).collect()
}

pub(super) fn cones(bytes: usize) -> Bench {
    let touched = 16 + 4;
    let len = (bytes / touched / CONES).max(1) * CONES;
    let batch = tiles();
    let most = batch.len() / crate::kernels::LEAST_PACKET + 1;
    let mut rays = Indexed::new(0, true);
    rays.ids = vec![0; batch.len() + MAX_LANES];
    rays.batch = batch;
    let (mut cones, mut of_rays) = (vec![[0.0; 4]; most], vec![[0; 2]; most]);
    let (mut ids, mut done) = (vec![0; most], vec![0; rays.batch.len() / 64 + 2]);
    let pointers = Cones {
        cones: cones.as_mut_ptr(),
        rays: of_rays.as_mut_ptr(),
        ids: ids.as_mut_ptr(),
        done: done.as_mut_ptr(),
    };
    let records = rays.pointers(true);
    // SAFETY: the processor was checked; there is room for the cones of the batch, whose rays start
    // at one point, and in the index list for its rays.
    let made = unsafe { (best().prepare_cones)(&rays.batch, &records, &pointers, 0.5) };
    assert_eq!((made.cones, made.loose), (BOXES * CONES, 0));
    cones.truncate(made.cones);
    let work = Packets {
        cones: cones.iter().copied().cycle().take(len).collect(),
        indices: Indices::in_order(len),
    };
    Bench {
        work: Box::new(work),
        bytes_per_test: (touched + 4) as f64,
    }
}

impl Work for Packets {
    fn reset(&mut self) {
        self.indices.reset();
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let cones = Cones {
            cones: self.cones.as_mut_ptr(),
            rays: null_mut(),
            ids: self.indices.ids.as_mut_ptr(),
            done: null_mut(),
        };
        let len = self.indices.len();
        for (i, from) in (0..len).step_by(CONES).enumerate() {
            let list = Range {
                from,
                to: from + CONES,
            };
            // SAFETY: the processor is the caller's promise; the list is one of these cones, of which
            // the kernel needs no rays.
            unsafe { (kernels.keep_cones)(&cones, list, &seen(i % BOXES), Vec3::ZERO) };
        }
        len
    }

    fn left(&self) -> Vec<u32> {
        self.indices.left()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Isa;

    /// Filters that keep all or nothing would be easier than those of a trace.
    #[test]
    fn neither_all_nor_none_of_the_cones_meet_their_box() {
        let mut bench = cones(BOXES * CONES * 20);
        bench.reset();
        assert_eq!(bench.run(Isa::best()) as usize, BOXES * CONES);
        let left = bench.work.left();
        for (i, list) in left.chunks(CONES).enumerate() {
            // Those that are kept come first: the order breaks where they end, if anywhere.
            let first = (i * CONES) as u32;
            assert!(
                list.iter()
                    .all(|id| (first..first + CONES as u32).contains(id))
            );
            assert!(!list.is_sorted(), "box {i}");
        }
    }

    #[test]
    fn rays_hit_some_triangles() {
        let mut rays = Copied::new(RAYS * LISTS, false);
        rays.reset(false);
        let mut bench = CopiedTriangles::<false> {
            rays,
            items: (0..)
                .zip(mesh(LISTS * TRIANGLES).triangles())
                .map(|(i, t)| Item::new(t, i))
                .collect(),
            mesh: mesh(LISTS * TRIANGLES),
            precision: Precision::Fast,
            scene: CUBE,
        };
        // SAFETY: the processor has what is best.
        unsafe { bench.run(best()) };
        let hits = bench
            .left()
            .iter()
            .filter(|&&prim| prim != crate::rays::MISS)
            .count();
        let share = hits as f64 / (RAYS * LISTS) as f64;
        assert!((0.2..0.95).contains(&share), "{share}");
    }
}
