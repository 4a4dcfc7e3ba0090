//! What a trace is given, and what it gives back.

use super::{Counters, Precision, Variant};
use crate::geometry::Mesh;
use crate::kernels::Kernels;
use crate::rays::{Batch, Hits};
use glam::Vec3;

/// What a trace was like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Numbers of tests and decisions.
    pub counters: Counters,
    /// Whether all valid rays have the same origin, to the bit.
    pub shared_origin: bool,
    /// Rays that take no part; see [`crate::Ray::is_valid`].
    pub invalid_rays: u64,
    /// Which variant of Mora's method was taken, if it was that method.
    pub variant: Option<Variant>,
}

/// What is to be traced.
pub(super) struct Job<'a> {
    pub kernels: &'static Kernels,
    pub mesh: &'a Mesh,
    pub batch: &'a Batch,
    /// The origin of all valid rays, if the batch is traced as one with a shared origin.
    pub shared_origin: Option<Vec3>,
    pub precision: Precision,
    pub seed: u64,
    pub audit: bool,
}

impl Job<'_> {
    /// In precision `exact`, gives the hits of rays `from` and up the t of exact arithmetic, rounded once.
    pub fn round(&self, from: usize, prim: &[u32], t: &mut [f32]) {
        if self.precision == Precision::Exact {
            let triangles = self.mesh.triangles();
            // SAFETY: the processor was checked.
            unsafe { (self.kernels.round_hits)(self.batch, from, triangles, prim, t) }
        }
    }
}

/// Where the answers go.
pub(super) enum Answer<'a> {
    Nearest(&'a mut Hits),
    Any(&'a mut [u8]),
}

/// The best t of an any-hit ray that has hit: below every tmin, so that no test passes any more.
pub(super) const OCCLUDED: f32 = -1.0;
