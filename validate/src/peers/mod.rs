//! Other ray tracing libraries in Rust, on the same triangles and rays: what their users would
//! have. They are built in by the feature `peers`.
//!
//! Only valid triangles and rays reach them. What they answer is their own affair: no hit of theirs
//! is a finding.

#[cfg(feature = "peers")]
mod bvh;
#[cfg(feature = "peers")]
mod obvhs;

use crate::judge::Answers;
use crate::measure::milliseconds;
use dacrt::rays::MISS;
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// All of them, the builders of one library in a row; none without the feature `peers`.
pub const ALL: &[Peer] = &[
    #[cfg(feature = "peers")]
    obvhs::BVH2_FASTEST,
    #[cfg(feature = "peers")]
    obvhs::BVH2_MEDIUM,
    #[cfg(feature = "peers")]
    obvhs::BVH2_VERY_SLOW,
    #[cfg(feature = "peers")]
    obvhs::CWBVH_FASTEST,
    #[cfg(feature = "peers")]
    obvhs::CWBVH_MEDIUM,
    #[cfg(feature = "peers")]
    obvhs::CWBVH_VERY_SLOW,
    #[cfg(feature = "peers")]
    bvh::BVH,
];

/// A builder of a library.
#[derive(Clone, Copy, Debug)]
pub struct Peer {
    /// Name of the crate.
    pub name: &'static str,
    /// Its version.
    pub version: &'static str,
    /// Layout of the tree and quality of the build, in the library's words.
    pub builder: &'static str,
    build: Build,
}

/// Makes the tree of at least one triangle, and says how long that took in milliseconds.
type Build = fn(&[Numbered]) -> (Box<dyn Tree>, f64);

impl Peer {
    /// The tree of a mesh and the milliseconds that it took; the conversion of the triangles to
    /// those of the library is not in them, as it is not in Embree's.
    ///
    /// `None` if no triangle is valid, or the library panics.
    pub fn build(&self, mesh: &Mesh) -> Option<(Box<dyn Tree>, f64)> {
        let triangles = numbered(mesh);
        if triangles.is_empty() {
            return None;
        }
        catch_unwind(|| (self.build)(&triangles)).ok()
    }
}

/// A valid triangle and its number in the mesh.
type Numbered = (u32, Triangle);

fn numbered(mesh: &Mesh) -> Vec<Numbered> {
    let all = (0..).zip(mesh.triangles().iter().copied());
    all.filter(|(_, triangle)| triangle.is_valid()).collect()
}

/// The tree of one mesh.
pub trait Tree {
    /// Distance and number of the triangle that a valid ray hits first.
    fn first(&self, ray: &Ray) -> Option<(f32, u32)>;

    /// Whether a valid ray hits anything.
    fn occluded(&self, ray: &Ray) -> bool;

    /// Memory of the tree and of the triangles as it tests them; `None` if the library does not
    /// tell.
    fn bytes(&self) -> Option<usize>;

    /// Nearest hits of all rays; turning our rays into those of the library is part of it, as every
    /// user of batches pays it.
    fn nearest(&self, batch: &Batch, hits: &mut Hits) {
        for (i, ray) in batch.iter().enumerate() {
            let hit = ray.is_valid().then(|| self.first(&ray)).flatten();
            (hits.t[i], hits.prim[i]) = hit.unwrap_or((f32::INFINITY, MISS));
        }
    }

    /// Whether each ray hits anything: 1 for yes, 0 for no.
    fn any(&self, batch: &Batch, occluded: &mut [u8]) {
        for (occluded, ray) in occluded.iter_mut().zip(batch.iter()) {
            *occluded = u8::from(ray.is_valid() && self.occluded(&ray));
        }
    }
}

/// Runs a library's code; `None` if it panics.
pub fn unless_it_panics<T>(work: impl FnOnce() -> T) -> Option<T> {
    // What it was at is not read again.
    catch_unwind(AssertUnwindSafe(work)).ok()
}

/// The widest instruction set that all Rust code of this program was compiled for: some of the
/// libraries use no other, while ours and Embree choose when they run.
pub fn compiled_for() -> &'static str {
    match () {
        _ if cfg!(target_feature = "avx512f") => "avx512",
        _ if cfg!(target_feature = "avx2") => "avx2",
        _ => "sse2",
    }
}

/// Number of rays on which the two differ: another triangle, or t apart by more than 10⁻⁴ of it.
///
/// # Panics
/// If they are not of one kind.
pub fn differing_rays(ours: Answers, theirs: Answers) -> usize {
    const RELATIVE: f32 = 1e-4;
    match (ours, theirs) {
        (Answers::Nearest(ours), Answers::Nearest(theirs)) => (0..ours.len())
            .filter(|&i| {
                let (a, b) = (ours.t[i], theirs.t[i]);
                let close = a == b || (a - b).abs() <= RELATIVE * a;
                ours.prim[i] != theirs.prim[i] || !close
            })
            .count(),
        (Answers::Any(ours), Answers::Any(theirs)) => {
            ours.iter().zip(theirs).filter(|(a, b)| a != b).count()
        }
        _ => unreachable!("answers to one batch are of one kind"),
    }
}

/// Times what makes a tree of triangles of the library.
#[cfg_attr(not(feature = "peers"), expect(dead_code))]
fn timed<T: Tree + 'static>(build: impl FnOnce() -> T) -> (Box<dyn Tree>, f64) {
    let (tree, ms) = milliseconds(build);
    (Box::new(tree), ms)
}

/// Bytes of the items of a vector.
#[cfg_attr(not(feature = "peers"), expect(dead_code))]
fn bytes_of<T>(items: &[T]) -> usize {
    size_of_val(items)
}
