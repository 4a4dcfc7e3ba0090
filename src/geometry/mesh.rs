//! Triangle soups as the tracers take them.

use super::Aabb;
use glam::Vec3;

/// Three positions; both sides count.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Triangle {
    /// First corner.
    pub a: Vec3,
    /// Second corner.
    pub b: Vec3,
    /// Third corner.
    pub c: Vec3,
}

/// Coordinates of this size or more make a triangle invalid; Embree drops the same ones.
pub const COORDINATE_LIMIT: f32 = 1.844e18;

impl Triangle {
    /// A triangle of three corners.
    pub const fn new(a: Vec3, b: Vec3, c: Vec3) -> Triangle {
        Triangle { a, b, c }
    }

    /// Whether all coordinates are numbers smaller in size than [`COORDINATE_LIMIT`].
    pub fn is_valid(&self) -> bool {
        // NaN fails the comparison, as it should.
        [self.a, self.b, self.c]
            .iter()
            .all(|p| p.abs().cmplt(Vec3::splat(COORDINATE_LIMIT)).all())
    }

    /// The bounding box; meaningful for valid triangles only.
    pub fn bounds(&self) -> Aabb {
        Aabb {
            min: self.a.min(self.b).min(self.c),
            max: self.a.max(self.b).max(self.c),
        }
    }
}

/// A triangle soup. The index of a triangle is its `prim` in hit records: file order, all meshes
/// of a scene one after the other, invalid and degenerate triangles included.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    triangles: Vec<Triangle>,
    dropped: usize,
}

impl Mesh {
    /// Takes the triangles as they are; invalid ones keep their number and are never hit.
    ///
    /// # Panics
    /// If there are more than `u32::MAX - 1` triangles.
    pub fn new(triangles: Vec<Triangle>) -> Mesh {
        assert!(
            triangles.len() < u32::MAX as usize,
            "too many triangles for 32-bit numbers"
        );
        let dropped = triangles.iter().filter(|t| !t.is_valid()).count();
        Mesh { triangles, dropped }
    }

    /// All triangles, by `prim`.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// All triangles, by `prim`.
    pub fn into_triangles(self) -> Vec<Triangle> {
        self.triangles
    }

    /// Number of triangles, dropped ones included.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is no triangle at all.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Number of invalid triangles (see [`Triangle::is_valid`]).
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// The box around all valid triangles; [`Aabb::EMPTY`] if there are none.
    pub fn bounds(&self) -> Aabb {
        self.triangles
            .iter()
            .filter(|t| t.is_valid())
            .fold(Aabb::EMPTY, |b, t| b.union(t.bounds()))
    }
}
