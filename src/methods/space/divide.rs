//! Divide-and-conquer ray tracing: Algorithm 1 of Mora 2011.

use super::SpaceParameters;
use super::cell::Cell;
use crate::geometry::{Aabb, Triangle};
use crate::kernels::{
    Cones, Copies, Directions, Done, IndexList, Kernels, Listed, Overlap, Range, RayRecords, Side,
    TriangleLists,
};
use crate::methods::Counters;
use crate::methods::stored::Stored;
use crate::methods::watch::Watch;

/// One trace under way.
///
/// A subproblem's triangles are the first ones of the index list, up to its triangle pivot; its rays
/// are those from the terminated-ray pivot, which all subproblems share, to its ray pivot (Fig. 2).
pub(super) struct Divide<'a> {
    pub kernels: &'a Kernels,
    pub parameters: &'a SpaceParameters,
    pub rays: RayRecords,
    pub lists: TriangleLists,
    pub triangles: &'a [Triangle],
    pub cones: Cones,
    /// The box around all origins.
    pub origins: Aabb,
    /// Which half of a cell comes first.
    pub order: Order,
    /// terminatedRayPivot: rays before it are done.
    pub terminated: usize,
    /// terminatedConePivot.
    pub terminated_cones: usize,
    pub counters: Counters,
    /// Who watches a ray, if somebody does.
    pub watch: Option<&'a mut Watch>,
    /// Where the splits are kept, if they are.
    pub stored: Option<&'a mut Stored>,
}

/// Which half of a cell comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// The one that the origin is on (section 3.2).
    FromOrigin,
    /// The one where rays of an octant of directions come from; bits are set for the axes that they
    /// go down (section 3.4).
    FromOctant(usize),
    /// The one where most of the rays come from (section 3.4, after Reshetov 2006): hits are kept by t.
    Majority,
}

/// What of a subproblem is in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The pivot of rays, or of cones.
    pub rays: usize,
    pub triangles: usize,
    pub directions: Directions,
}

impl Divide<'_> {
    /// Algorithm 1.
    pub fn divide(&mut self, cell: &Cell, mut part: Part) {
        self.counters.nodes += 1;
        part.triangles = self.drop_copies(part.triangles);
        let few = part.rays - self.terminated < self.parameters.ray_limit as usize
            || part.triangles < self.parameters.triangle_limit as usize;
        let split = if few {
            None
        } else {
            self.split(cell, part.triangles)
        };
        let Some(split) = split else {
            return self.naive(cell, part);
        };
        let mut first_share = None;
        let sides = self.sides(split, part.directions);
        self.store_split(cell, sides.map(|side| cell.half(side).bounds), false);
        for (place, side) in sides.into_iter().enumerate() {
            self.store_child(place);
            let all = Range {
                from: self.terminated,
                to: part.rays,
            };
            let entered = self.enter(cell, side, part, all, Divide::filter, &mut first_share);
            self.watch_half(&cell.half(side), part.triangles, all, &entered);
            if let Some((half, inside)) = entered {
                self.divide(&half, inside);
            }
        }
        self.store_child(2);
    }

    /// The number of triangles without copies, which come first in the list from now on.
    pub fn drop_copies(&self, triangles: usize) -> usize {
        // SAFETY: the list has so many triangles of the mesh.
        let mut list = unsafe { IndexList::new(&self.lists, triangles) };
        list.drop_copies(2 * self.parameters.triangle_limit as usize);
        list.len()
    }

    /// R ∩ E and P ∩ E, for a half E on one side of its cell: rays first, for without any there is no
    /// need to look at the triangles.
    fn filter(&mut self, half: &Cell, side: Side, part: Part) -> Part {
        let list = Range {
            from: self.terminated,
            to: part.rays,
        };
        let (rays, directions) = self.filter_rays(half, list);
        let triangles = match rays {
            0 => 0,
            _ => self.filter_triangles(half, side, part.triangles),
        };
        Part {
            rays: list.from + rays,
            triangles,
            directions,
        }
    }

    /// The number of rays that meet a cell, which come first in the list from now on; and, where that
    /// decides the order, where they go on the axis across which it will be split.
    pub fn filter_rays(&mut self, cell: &Cell, list: Range) -> (usize, Directions) {
        self.counters.ray_box += list.len() as u64;
        let axis = (self.order == Order::Majority).then(|| cell.longest_axis());
        // SAFETY: the processor was checked, the list is one of rays of the batch.
        unsafe { (self.kernels.keep_meeting)(&self.rays, list, &cell.bounds, axis) }
    }

    /// The number of triangles that reach into a half, which come first in the list from now on
    /// (section 3.5).
    pub fn filter_triangles(&mut self, half: &Cell, side: Side, triangles: usize) -> usize {
        self.counters.triangle_box += triangles as u64;
        if triangles >= self.parameters.nine_axes_below as usize {
            // SAFETY: the processor was checked, the list is one of triangles of the mesh.
            return unsafe { (self.kernels.keep_side)(&self.lists, triangles, side) };
        }
        let by = Overlap {
            cell: half.bounds,
            side,
            origins: self.origins,
            plane: self.parameters.plane_test,
        };
        // SAFETY: as above.
        unsafe { (self.kernels.keep_overlapping)(&self.lists, triangles, by) }
    }

    /// NaiveRT, and early ray termination.
    pub(super) fn naive(&mut self, cell: &Cell, part: Part) {
        let list = Range {
            from: self.terminated,
            to: part.rays,
        };
        self.counters.leaves += 1;
        self.counters.ray_triangle += (list.len() * part.triangles) as u64;
        self.watch_leaf(cell, part.triangles, list);
        self.store_leaf(cell, part.triangles);
        let triangles = Listed {
            lists: &self.lists,
            triangles: self.triangles,
            len: part.triangles,
            duplicates: &mut self.counters.duplicates,
        };
        let when = match (self.order, self.parameters.terminate_as_printed) {
            (Order::Majority, _) => Done::Never,
            (_, false) => Done::BeforeExit,
            (_, true) => Done::Hit,
        };
        // SAFETY: the processor was checked, lists are those of batch and mesh.
        let pivot = unsafe {
            (self.kernels.naive_indexed)(&self.rays, list, triangles, &cell.bounds, when)
        };
        let done = Range { to: pivot, ..list };
        self.watch_end(cell, part.triangles, done);
        self.counters.terminated_rays += (pivot - self.terminated) as u64;
        self.terminated = pivot;
    }
}
