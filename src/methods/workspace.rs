//! All memory of a trace, made beforehand.

use super::{Parameters, best, object, space};

/// Memory for traces of up to a number of rays and triangles; reused from trace to trace. A trace
/// allocates nothing beyond it.
///
/// Methods of one family share a workspace. [`Workspace::bytes`] is 160 a ray + 64 a triangle + a
/// constant of about 0.72 MB where lists of triangles are split, and 55⅝ a ray + 44 a triangle +
/// about 0.75 kB where space is split (exactly: see [`Workspace::bytes_for`]). That of `best` is 271 a
/// triangle, 38 a ray for up to 1,048,576 rays, and for each thread 191 a ray for up to 262,144 rays, and
/// 0.75 MB; threads themselves, started with it, are not counted.
pub struct Workspace {
    memory: Memory,
    rays: usize,
    triangles: usize,
    threads: usize,
}

pub(super) enum Memory {
    Object(object::Memory),
    Space(space::Memory),
    Best(best::Memory),
}

impl Workspace {
    /// Memory for batches of up to `rays` rays and meshes of up to `triangles` triangles, for methods
    /// of the family of these parameters.
    ///
    /// # Panics
    /// If there are more than 10⁹ rays.
    pub fn new(parameters: &Parameters, rays: usize, triangles: usize) -> Workspace {
        Workspace::for_threads(parameters, rays, triangles, 1)
    }

    /// As [`Workspace::new`], for traces with up to so many threads; at least 1. Only `best` has use for
    /// more than one; they are started here.
    ///
    /// # Panics
    /// If there are more than 10⁹ rays, or, for `best`, more than 2²⁹ triangles or threads that cannot be
    /// started.
    pub fn for_threads(
        parameters: &Parameters,
        rays: usize,
        triangles: usize,
        threads: usize,
    ) -> Workspace {
        // Gathers take places of records, of which there are twice as many, as signed 32-bit numbers.
        assert!(rays <= 1_000_000_000, "a batch has at most 10^9 rays");
        let memory = match parameters {
            Parameters::Object(_) => Memory::Object(object::Memory::new(rays, triangles)),
            Parameters::Space(_) => Memory::Space(space::Memory::new(rays, triangles)),
            Parameters::Best(_) => Memory::Best(best::Memory::new(rays, triangles, threads.max(1))),
        };
        Workspace {
            memory,
            rays,
            triangles,
            threads: threads.max(1),
        }
    }

    /// Whether it can be used with these parameters, for so many rays and triangles, by so many threads;
    /// how many does not matter to methods that take one alone.
    pub fn suits(
        &self,
        parameters: &Parameters,
        rays: usize,
        triangles: usize,
        threads: usize,
    ) -> bool {
        let same_family = matches!(
            (parameters, &self.memory),
            (Parameters::Object(_), Memory::Object(_))
                | (Parameters::Space(_), Memory::Space(_))
                | (Parameters::Best(_), Memory::Best(_))
        );
        let enough_threads = threads <= self.threads || !parameters.takes_threads();
        same_family && enough_threads && rays <= self.rays && triangles <= self.triangles
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        match self.memory {
            Memory::Object(_) => object::Memory::bytes(self.rays, self.triangles),
            Memory::Space(_) => space::Memory::bytes(self.rays, self.triangles),
            Memory::Best(_) => best::Memory::bytes(self.rays, self.triangles, self.threads),
        }
    }

    /// Bytes that a workspace for these parameters, so many rays and triangles and so many threads, at
    /// least 1, takes.
    ///
    /// Where lists of triangles are split: 140 a ray, with the rays rounded up to a multiple of 16,
    /// + 20 a ray + 64 a triangle + what it is for none.
    ///
    /// Where space is split: 44 a triangle, as in Mora 2011, section 3.5 (36 of coordinates, 4 of
    /// bits and 4 of index); 52 a ray (4 of index, 48 of inverse direction, origin, direction, best
    /// t and best triangle; the paper has 4 and 32, which would take three divisions a ray/box test
    /// and t and triangle from elsewhere); 28 for each cone, of which there may be one in 8
    /// rays; 8 for 64 termination bits; and what it is for none.
    ///
    /// For `best`: 262 a triangle (64 of items, 80 of prepared triangles, 96 of nodes, 4 of cells and 18 of
    /// clusters) and 9 for each thread; a window of as many rays as there are, but at most 1,048,576: 38 a ray;
    /// and for each thread a block of as many as there are, but at most 262,144: 191 a ray.
    pub fn bytes_for(
        parameters: &Parameters,
        rays: usize,
        triangles: usize,
        threads: usize,
    ) -> usize {
        match parameters {
            Parameters::Object(_) => object::Memory::bytes(rays, triangles),
            Parameters::Space(_) => space::Memory::bytes(rays, triangles),
            Parameters::Best(_) => best::Memory::bytes(rays, triangles, threads.max(1)),
        }
    }

    /// The memory, if there is enough of it.
    pub(super) fn memory(&mut self, rays: usize, triangles: usize, threads: usize) -> &mut Memory {
        assert!(
            rays <= self.rays,
            "the workspace is too small for {rays} rays"
        );
        assert!(
            triangles <= self.triangles,
            "the workspace is too small for {triangles} triangles"
        );
        assert!(
            threads <= self.threads || !matches!(self.memory, Memory::Best(_)),
            "the workspace is too small for {threads} threads"
        );
        &mut self.memory
    }
}
