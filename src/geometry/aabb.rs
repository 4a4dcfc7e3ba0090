//! Axis-aligned bounding boxes.

use glam::Vec3;

/// An axis-aligned box, closed on all sides; empty where `min > max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box: the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The least box around two boxes.
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The least box around this one and a point.
    pub fn with_point(self, p: Vec3) -> Aabb {
        Aabb {
            min: self.min.min(p),
            max: self.max.max(p),
        }
    }

    /// Edge lengths; negative infinity for the empty box.
    pub fn extent(self) -> Vec3 {
        self.max - self.min
    }

    /// Middle of the box.
    pub fn center(self) -> Vec3 {
        self.min + 0.5 * self.extent()
    }

    /// Length of the diagonal, in the units of the scene.
    pub fn diagonal(self) -> f32 {
        self.extent().length()
    }

    /// Half the surface area (the factor 2 cancels in every use).
    pub fn half_area(self) -> f32 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}
