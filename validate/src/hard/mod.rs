//! Hard cases: meshes and rays that float32 is likely to get wrong, made by generators, and what
//! our precisions and both modes of Embree make of them, all judged by exact arithmetic.
//!
//! A [`Family`] makes cases of one kind, a [`Case`] is a mesh with a batch. Where the construction
//! alone says what must come out, the case says so ([`Expected`]), so that the arbiter is checked
//! as well. [`trial`] traces a family and counts.
//!
//! Of the problems that users of ray tracers report, those whose numbers are public are in
//! `issues.rs`; that file also says which are not.

mod closed;
mod copies;
mod directions;
mod extremes;
mod grazing;
mod grid;
mod interval;
mod invalid;
mod issues;
mod leaving;
mod meshes;
mod random;
mod results;
mod scales;
mod slivers;
pub mod trial;

pub use results::{Counts, Document, FamilyResult, Finding, Found, KIND, What};

use crate::judge::Answer;
use dacrt::{Batch, Mesh, Ray};
use random::Random;

/// Cases of one kind.
#[derive(Clone, Copy)]
pub struct Family {
    /// Its name on the command line and in results.
    pub name: &'static str,
    /// What is hard, in a line.
    pub what: &'static str,
    /// Who found or described it.
    pub source: &'static str,
    make: fn(&mut Random, usize) -> Vec<Case>,
}

impl Family {
    /// Makes cases with about so many rays together; fewer where a family has no more to show.
    pub fn cases(&self, rays: usize, seed: u64) -> Vec<Case> {
        (self.make)(&mut Random::new(seed, self.name), rays)
    }
}

/// A mesh and rays.
pub struct Case {
    /// Its name within the family.
    pub name: &'static str,
    /// The mesh.
    pub mesh: Mesh,
    /// The rays, of one origin or several, as it falls.
    pub batch: Batch,
    /// What must come out, by construction, for each ray.
    pub expected: Vec<Expected>,
    /// Whether the mesh is closed: each edge in exactly two triangles, all of which have an area.
    pub closed: bool,
    /// Whether float32 computes these rays and triangles without any rounding but that of the final
    /// division, so that all of our precisions must give the exact answer, bit for bit.
    pub without_rounding: bool,
}

impl Case {
    fn new(name: &'static str, mesh: Mesh) -> Case {
        Case {
            name,
            mesh,
            batch: Batch::default(),
            expected: Vec::new(),
            closed: false,
            without_rounding: false,
        }
    }

    fn closed(self) -> Case {
        Case {
            closed: true,
            ..self
        }
    }

    fn without_rounding(self) -> Case {
        Case {
            without_rounding: true,
            ..self
        }
    }

    fn push(&mut self, ray: Ray, expected: Expected) {
        self.batch.push(ray);
        self.expected.push(expected);
    }

    fn with(mut self, rays: impl IntoIterator<Item = (Ray, Expected)>) -> Case {
        for (ray, expected) in rays {
            self.push(ray, expected);
        }
        self
    }
}

/// What must come out, as far as the construction alone says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// It says nothing.
    Unknown,
    /// No hit.
    Miss,
    /// Some hit.
    Hit,
    /// A hit at this t, to the bit.
    At(f32),
    /// A hit on this triangle.
    Prim(u32),
    /// This hit, to the bit.
    Is(f32, u32),
}

impl Expected {
    /// Whether the answer is as it must be.
    pub fn met_by(self, answer: Answer) -> bool {
        let hit = match answer {
            Answer::Hit { t, prim } => Some((t.to_bits(), prim)),
            _ => None,
        };
        match self {
            Expected::Unknown => true,
            Expected::Miss => hit.is_none(),
            Expected::Hit => hit.is_some(),
            Expected::At(t) => hit.is_some_and(|hit| hit.0 == t.to_bits()),
            Expected::Prim(prim) => hit.is_some_and(|hit| hit.1 == prim),
            Expected::Is(t, prim) => hit == Some((t.to_bits(), prim)),
        }
    }
}

/// All families.
pub const FAMILIES: [Family; 20] = [
    Family {
        name: "edges",
        what: "rays at corners, midpoints and points at k/2^n of edges of a closed mesh",
        source: "pbrt-v4 Triangle.Watertight; embree#109, #174, #181; tinybvh#168",
        make: closed::edges,
    },
    Family {
        name: "inside",
        what: "closed meshes, origin inside, random and axis-parallel directions",
        source: "pbrt-v4 Triangle.Watertight",
        make: closed::inside,
    },
    Family {
        name: "reverse",
        what: "the same segment from both ends, through a corner of a closed mesh",
        source: "Woop, Benthin, Wald 2013",
        make: closed::reverse,
    },
    Family {
        name: "far",
        what: "a sphere from the inside and a plane at (148376, 1234, -223423)",
        source: "Embree verify, watertight_triangles; three-mesh-bvh#112",
        make: closed::far,
    },
    Family {
        name: "scaled",
        what: "the family edges, far away too, times 2^20 and 2^-20",
        source: "Embree verify; invariance under scaling by powers of two",
        make: closed::scaled,
    },
    Family {
        name: "scales",
        what: "closed meshes of sizes from 1e-6 to 1e6 in one scene",
        source: "Ize 2013",
        make: scales::scales,
    },
    Family {
        name: "box-planes",
        what: "axis-parallel rays whose origin lies on planes of boxes",
        source: "embree#589; svenstaro/bvh#140, #149; libigl#2232",
        make: directions::box_planes,
    },
    Family {
        name: "directions",
        what: "components of d that are ±0, denormal, 1e-38 or 1e38, in all mixtures",
        source: "Williams et al. 2005; Ize 2013",
        make: directions::directions,
    },
    Family {
        name: "needles",
        what: "triangles of ratio 1e6, slivers, flat boxes",
        source: "embree#387; svenstaro/bvh#107",
        make: slivers::needles,
    },
    Family {
        name: "no-area",
        what: "collinear triangles and points, hit by nothing",
        source: "pbrt-v4 Triangle.BadCases",
        make: slivers::no_area,
    },
    Family {
        name: "copies",
        what: "identical triangles, overlapping ones in a plane, all centres in one place",
        source: "Embree verify, overlapping_primitives and triangle_split_epsilon",
        make: copies::copies,
    },
    Family {
        name: "grazing",
        what: "rays at less than 1 degree to skinny triangles",
        source: "embree#387, #423",
        make: grazing::grazing,
    },
    Family {
        name: "in-plane",
        what: "rays in the plane of triangles, which they miss",
        source: "embree#298",
        make: grazing::in_plane,
    },
    Family {
        name: "interval",
        what: "t exactly at tmin and tmax and one ulp beside, empty and infinite intervals",
        source: "Embree's tnear is exclusive in fast and inclusive in robust mode",
        make: interval::interval,
    },
    Family {
        name: "invalid",
        what: "NaN and infinite rays and corners: a miss",
        source: "Embree verify, nan_test and inf_test; devil_ray#62",
        make: invalid::invalid,
    },
    Family {
        name: "grid",
        what: "small whole numbers, which float32 computes exactly",
        source: "svenstaro/bvh, fuzz.rs",
        make: grid::grid,
    },
    Family {
        name: "leaving",
        what: "rays that start on a surface, triangles of all sizes",
        source: "pbrt-v4 Triangle.Reintersect; embree#133",
        make: leaving::leaving,
    },
    Family {
        name: "tiny",
        what: "coordinates of about 1e-38, denormal ones included",
        source: "float32 underflows",
        make: extremes::tiny,
    },
    Family {
        name: "huge",
        what: "coordinates up to 1.8e18, origins and directions up to 1e38",
        source: "float32 overflows",
        make: extremes::huge,
    },
    Family {
        name: "issues",
        what: "single rays from bug reports",
        source: "see the source, issues.rs",
        make: issues::issues,
    },
];
