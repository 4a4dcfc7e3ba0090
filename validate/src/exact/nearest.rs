//! The nearest hit of a ray over a mesh.

use super::distance::Distance;
use super::pair::{has_area, meet};
use super::search::Tree;
use crate::bounds::Pair;
use crate::watertight::{Sheared, Surfaces};
use dacrt::{Mesh, Ray};

/// Finds exact hits on one mesh.
pub struct Arbiter<'m> {
    mesh: &'m Mesh,
    tree: Tree,
}

/// The nearest hit in exact arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    /// Of equally near triangles the lowest.
    pub prim: u32,
    /// Where.
    pub t: Distance,
}

/// All that there is to say of one ray.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// The nearest hit in exact arithmetic.
    pub nearest: Option<Nearest>,
    /// Of the hits that the kernel of record must find ([`Pair::clear`]) the one for which it gives
    /// the least t, however it rounds; with the triangle's number.
    pub clear: Option<(u32, Pair)>,
    /// Whether there is a hit that the kernel of record may find ([`Pair::within_bounds`]).
    pub possible: bool,
}

/// What the watertight kernel may make of a ray.
#[derive(Clone, Debug, Default)]
pub struct Reach {
    /// Of the hits that it must find ([`Sheared::clear`]) the one for which it gives the least t,
    /// however it rounds; with the triangle's number.
    pub clear: Option<(u32, Sheared)>,
    /// Whether there is a hit that it may find ([`Sheared::within_bounds`]).
    pub possible: bool,
    /// All triangles that corners may be moved to be hit, up to where it finds the clear one.
    candidates: Vec<u32>,
}

impl<'m> Arbiter<'m> {
    /// Builds boxes over the triangles that can be hit, about half a second a million.
    pub fn new(mesh: &'m Mesh) -> Arbiter<'m> {
        let triangles = mesh.triangles();
        let solid = (0..triangles.len() as u32).filter(|&i| can_be_hit(mesh, i));
        Arbiter {
            mesh,
            tree: Tree::new(triangles, solid.collect()),
        }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'m Mesh {
        self.mesh
    }

    /// The nearest hit, exactly; about 10 µs. None for an invalid ray.
    pub fn nearest(&self, ray: &Ray) -> Option<Nearest> {
        self.find(ray).nearest
    }

    /// The nearest hit, and what the kernel of record may make of the ray. Nothing is found for an
    /// invalid ray.
    ///
    /// The triangles to look at are all that the ray may hit up to `latest`, where the kernel of
    /// record finds a clear hit at the latest: a clear hit is one in exact arithmetic too, no
    /// further away than that. Of these only those stay that are [`Pair::possible`], which every
    /// exact hit is: its bounds hold for float32, and float64 errs 2²⁹ times less.
    pub fn find(&self, ray: &Ray) -> Found {
        let mut found = Found::default();
        if !ray.is_valid() {
            return found;
        }
        let mut latest = f64::INFINITY;
        let mut candidates: Vec<(u32, Pair)> = Vec::new();
        self.tree.visit(ray, |prim| {
            let pair = Pair::new(ray, &self.mesh.triangles()[prim as usize]);
            if pair.possible {
                candidates.push((prim, pair));
                found.possible |= pair.within_bounds();
                if pair.clear() && pair.latest() < latest {
                    latest = pair.latest();
                    found.clear = Some((prim, pair));
                }
            }
            latest
        });
        found.nearest = candidates
            .iter()
            .filter(|(_, pair)| pair.earliest() <= latest)
            .filter_map(|&(prim, _)| {
                let t = meet(ray, &self.mesh.triangles()[prim as usize])?;
                Some(Nearest { prim, t })
            })
            .min_by(|x, y| (&x.t, x.prim).cmp(&(&y.t, y.prim)));
        found
    }

    /// What the watertight kernel may make of a valid ray; about 5 µs.
    pub fn reach(&self, ray: &Ray) -> Reach {
        let mut reach = Reach::default();
        let mut latest = f64::INFINITY;
        self.tree.visit(ray, |prim| {
            let sheared = Sheared::new(ray, &self.mesh.triangles()[prim as usize]);
            if sheared.possible {
                reach.candidates.push(prim);
                reach.possible |= sheared.within_bounds();
                if sheared.clear() && sheared.latest() < latest {
                    latest = sheared.latest();
                    reach.clear = Some((prim, sheared));
                }
            }
            latest
        });
        reach
    }

    /// The distance at which, at the latest, the watertight kernel finds a hit on a surface that no
    /// rounding lets the ray pass, if there is one; see [`crate::watertight`].
    pub fn surface(&self, ray: &Ray, reach: &Reach) -> Option<f64> {
        let with_bounds = |&prim: &u32| {
            let triangle = self.mesh.triangles()[prim as usize];
            (triangle, Sheared::new(ray, &triangle))
        };
        Surfaces::new(ray, reach.candidates.iter().map(with_bounds).collect()).latest()
    }
}

/// Whether there is such a triangle, it is valid and has an area.
pub(crate) fn can_be_hit(mesh: &Mesh, prim: u32) -> bool {
    let triangle = mesh.triangles().get(prim as usize);
    triangle.is_some_and(|t| t.is_valid() && has_area(t))
}
