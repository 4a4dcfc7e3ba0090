//! The kernels of a trace one at a time, over working sets of any size, for `dacrt bench kernels`.
//!
//! Nothing here is a kernel: a [`Bench`] holds made-up data in the layout of a trace and calls the
//! very functions that a trace calls. It reads no clock; time [`Bench::run`] from outside. What a
//! pass reorders or changes, [`Bench::reset`] puts back, outside of the time: so every pass does the
//! same work in the same order.

mod best;
pub mod ingredients;
mod peak;
mod rays;
mod triangles;

use crate::kernels::Kernels;
use crate::random;
use crate::simd::Isa;
use glam::Vec3;

pub use peak::multiply_adds;

/// A kernel that can be timed.
pub struct Kernel {
    /// What it does, in a few words.
    pub name: &'static str,
    /// What it does it to; [`Bench::run`] counts these: triangles, or pairs such as `ray/box`.
    pub test: &'static str,
    make: fn(usize) -> Bench,
}

/// All kernels that can be timed: those that take most of the time of a trace.
///
/// Filters keep about half. Lists are in the order of memory unless it says otherwise. Triangles meet
/// the nine axes in lists of 96, cones a box in lists of 256, rays triangles in lists of 512 and 16:
/// what it takes to begin a list is in the time.
///
/// Of method `best`: one pass over groups, in lists of 256, or over rays makes both children, and each
/// group or ray counts once for each box; rays are put in order in windows of 131,072 or of all that
/// there are, and the 32,768 buckets of a window are in the time; clusters have 8 triangles on average,
/// and emptying the cells of the grid is in the time; leaves have 16 triangles, prepared beforehand where
/// rays, in lists of 512, meet them.
pub const KERNELS: &[Kernel] = &[
    Kernel {
        name: "triangle/plane, in order",
        test: "triangle",
        make: triangles::split_plane,
    },
    Kernel {
        name: "triangle/plane, random order",
        test: "triangle",
        make: triangles::split_plane_in_random_order,
    },
    Kernel {
        name: "triangle/cell, nine axes",
        test: "triangle/box",
        make: triangles::nine_axes,
    },
    Kernel {
        name: "triangle binned",
        test: "triangle",
        make: triangles::binning,
    },
    Kernel {
        name: "triangle partitioned",
        test: "triangle",
        make: triangles::partition,
    },
    Kernel {
        name: "cone/box",
        test: "cone/box",
        make: rays::cones,
    },
    Kernel {
        name: "ray/box indexed, one origin",
        test: "ray/box",
        make: rays::indexed_box::<true>,
    },
    Kernel {
        name: "ray/box indexed, own origins",
        test: "ray/box",
        make: rays::indexed_box::<false>,
    },
    Kernel {
        name: "ray/box copied, one origin",
        test: "ray/box",
        make: rays::copied_box::<true, false>,
    },
    Kernel {
        name: "ray/box copied, own origins",
        test: "ray/box",
        make: rays::copied_box::<false, false>,
    },
    Kernel {
        name: "ray/box in place, one origin",
        test: "ray/box",
        make: rays::copied_box::<true, true>,
    },
    Kernel {
        name: "ray/box in place, own origins",
        test: "ray/box",
        make: rays::copied_box::<false, true>,
    },
    Kernel {
        name: "ray/triangle indexed, one origin",
        test: "ray/triangle",
        make: rays::indexed_triangles::<true>,
    },
    Kernel {
        name: "ray/triangle indexed, own origins",
        test: "ray/triangle",
        make: rays::indexed_triangles::<false>,
    },
    Kernel {
        name: "ray/triangle copied, one origin",
        test: "ray/triangle",
        make: rays::copied_triangles::<true>,
    },
    Kernel {
        name: "ray/triangle copied, own origins",
        test: "ray/triangle",
        make: rays::copied_triangles::<false>,
    },
    Kernel {
        name: "group/box, one origin",
        test: "group/box",
        make: best::group_box::<true>,
    },
    Kernel {
        name: "group/box, own origins",
        test: "group/box",
        make: best::group_box::<false>,
    },
    Kernel {
        name: "ray/box two boxes, one origin",
        test: "ray/box",
        make: best::both_boxes::<true>,
    },
    Kernel {
        name: "ray/box two boxes, own origins",
        test: "ray/box",
        make: best::both_boxes::<false>,
    },
    Kernel {
        name: "ray put in order",
        test: "ray",
        make: best::put_in_order,
    },
    Kernel {
        name: "triangle to cluster, in order",
        test: "triangle",
        make: best::clusters,
    },
    Kernel {
        name: "triangle to cluster, random order",
        test: "triangle",
        make: best::clusters_in_random_order,
    },
    Kernel {
        name: "triangle prepared, one origin",
        test: "triangle",
        make: best::prepare::<true>,
    },
    Kernel {
        name: "triangle prepared, own origins",
        test: "triangle",
        make: best::prepare::<false>,
    },
    Kernel {
        name: "ray/triangle groups, one origin",
        test: "ray/triangle",
        make: best::group_leaves::<true>,
    },
    Kernel {
        name: "ray/triangle groups, own origins",
        test: "ray/triangle",
        make: best::group_leaves::<false>,
    },
    Kernel {
        name: "ray/triangle kept, one origin",
        test: "ray/triangle",
        make: best::copied_leaves::<true>,
    },
    Kernel {
        name: "ray/triangle kept, own origins",
        test: "ray/triangle",
        make: best::copied_leaves::<false>,
    },
];

impl Kernel {
    /// Data of which a pass touches about `working_set` bytes, at least those of one list. It holds up
    /// to four times as many, and takes a second or so to make for 256 MiB.
    pub fn prepare(&self, working_set: usize) -> Bench {
        let mut bench = (self.make)(working_set);
        bench.reset();
        bench
    }
}

/// A kernel with data.
pub struct Bench {
    work: Box<dyn Work>,
    bytes_per_test: f64,
}

/// What a kernel does in a pass.
trait Work {
    /// Puts back what the passes changed.
    fn reset(&mut self);

    /// One pass; returns the number of tests.
    ///
    /// # Safety
    /// The processor has the instruction set of the kernels.
    unsafe fn run(&mut self, kernels: &Kernels) -> usize;

    /// What the last pass left, in order.
    fn left(&self) -> Vec<u32>;
}

impl Bench {
    /// Bytes that one test reads and writes at least, on average: each number once. Where lists are
    /// short, or in random order, caches move more.
    pub fn bytes_per_test(&self) -> f64 {
        self.bytes_per_test
    }

    /// Puts everything back to where it was before the first pass.
    pub fn reset(&mut self) {
        self.work.reset();
    }

    /// One pass over all data; returns the number of tests, which is the same for each pass and
    /// instruction set.
    ///
    /// # Panics
    /// If this processor does not have the instruction set.
    pub fn run(&mut self, isa: Isa) -> u64 {
        // SAFETY: `Kernels::of` checks the processor.
        unsafe { self.work.run(Kernels::of(isa)) as u64 }
    }

    /// A hash of what a pass since the last [`Bench::reset`] left: the same for each instruction set.
    pub fn digest(&self) -> u64 {
        let left = self.work.left().into_iter();
        left.fold(0, |hash, x| random::hash(hash, x as u64, 0))
    }
}

/// The kernels that make the data.
fn best() -> &'static Kernels {
    Kernels::of(Isa::best())
}

/// The `index`-th number of a kind, in `[0, 1)`.
fn number(kind: u64, index: usize) -> f32 {
    random::unit_f64(random::hash(1, kind, index as u64)) as f32
}

/// The `index`-th point of a kind, in the unit cube.
fn point(kind: u64, index: usize) -> Vec3 {
    let at = |axis| number(kind, 3 * index + axis);
    Vec3::new(at(0), at(1), at(2))
}
