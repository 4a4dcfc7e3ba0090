//! Divide-and-conquer ray tracing (DACRT): finds the nearest hit, or any hit, of a whole batch of
//! rays against a triangle soup by splitting rays and triangles together. The methods of the papers
//! build and store no acceleration structure; [`Method::Best`] keeps the splits that it makes for the
//! length of a trace.
//!
//! ```
//! use dacrt::{Batch, Hits, Mesh, Method, Ray, Tracer, Triangle};
//! use glam::Vec3;
//!
//! let mesh = Mesh::new(vec![Triangle::new(Vec3::X, Vec3::Y, Vec3::Z)]);
//! let batch: Batch = [Ray::new(Vec3::ZERO, Vec3::ONE), Ray::new(Vec3::ZERO, -Vec3::ONE)]
//!     .into_iter()
//!     .collect();
//! let tracer = Tracer::new(Method::Nabata2013.parameters());
//! let mut workspace = tracer.workspace(batch.len(), mesh.len());
//! let mut hits = Hits::misses(batch.len());
//! tracer.nearest(&mesh, &batch, &mut workspace, &mut hits);
//! assert_eq!(hits.prim, [0, dacrt::MISS]);
//! assert_eq!(hits.t[0], 1.0 / 3.0);
//! ```
//!
//! # What a hit is
//!
//! * A [`Ray`] is `o + t d` for `tmin < t <= tmax`; `d` has any length but zero, and `t` is in units
//!   of that length. A ray that is not [valid](Ray::is_valid) is a miss, and is counted.
//! * A [`Triangle`] has two sides, both of which count. Its number, `prim`, is its place in the
//!   [`Mesh`]. One that is not [valid](Triangle::is_valid), or has no area, is never hit; nor is one
//!   by a ray in its plane.
//! * The hit is the least `(t, prim)`: of equal `t` the lowest `prim`. A miss is `t = +inf`,
//!   `prim = `[`MISS`].
//! * Whether and where a ray hits a triangle is one function of these two, of the [`Precision`], and in
//!   `fast` and `watertight` of whether all valid rays of the batch have the same origin. So the hits
//!   have the same bits for every method, parameter, seed and instruction set.
//! * In [`Precision::Fast`] `t` and the test are computed in float32. Near an edge, or near `tmin` and
//!   `tmax`, rounding may decide; two triangles that share an edge are not promised to leave no gap
//!   there. Hits are right up to rounding where coordinates, edge lengths and the largest component of
//!   `d` are zero or between 1e-9 and 1e9 in size; beyond, a trace only ends.
//! * In [`Precision::Watertight`] what is hit is decided as in exact arithmetic, for every valid input:
//!   no ray passes between two triangles that share an edge. `t`, and which of two near hits is the
//!   nearer one, is right up to rounding.
//! * [`Precision::Exact`] gives the least `(t, prim)` of exact arithmetic, for every valid input, with
//!   `t` rounded once. A hit needs a `t` that rounds to a finite float32.
//!
//! # Where to look next
//!
//! * [`Tracer`] finds the hits: [`Tracer::nearest`], and [`Tracer::any`] for shadow rays. What it
//!   did is in the [`Counters`] of the [`Trace`] that it returns.
//! * [`Method`] names the presets, [`Parameters`] has every technique as a switch, with the section
//!   of the paper that it comes from and what we take where the paper is silent.
//! * [`Workspace`] is all memory of a trace, linear in rays and triangles. A trace allocates nothing.
//! * [`scene`] loads OBJ and PLY meshes and makes scenes, [`workloads`] makes the rays of an
//!   experiment.
//!
//! [`Method::Best`] takes as many threads as [`Tracer::with_threads`] says, the others one. A trace costs a
//! pass over all triangles, however few the rays; the README says
//! when another method is the better choice, and how fast this one is beside Embree.

pub mod bench;
mod exact;
pub mod geometry;
mod kernels;
mod methods;
pub mod random;
pub mod rays;
mod room;
pub mod scene;
mod simd;
pub mod workloads;

pub use geometry::{Aabb, Mesh, Triangle};
pub use kernels::{PADDING, Sure, TriangleTest};
pub use methods::*;
pub use rays::{Batch, Hits, MISS, Ray};
pub use room::room;
pub use simd::{Isa, UnknownIsa};

/// Compiles and runs the Rust of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
