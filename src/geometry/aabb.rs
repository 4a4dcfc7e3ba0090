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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn half_area_is_half_the_sum_of_the_faces(
            min in [-1e3f32..1e3, -1e3f32..1e3, -1e3f32..1e3],
            extent in [0f32..1e3, 0f32..1e3, 0f32..1e3],
        ) {
            let min = Vec3::from(min);
            let max = min + Vec3::from(extent);
            let b = Aabb { min, max };
            let corner = |bits: usize| {
                Vec3::from([0, 1, 2].map(|axis| if bits >> axis & 1 == 1 { max[axis] } else { min[axis] }))
                    .as_dvec3()
            };
            // Each face by a corner and its two neighbours.
            let faces = [[0, 1, 2], [0, 1, 4], [0, 2, 4], [7, 6, 5], [7, 6, 3], [7, 5, 3]];
            let sum: f64 = faces
                .map(|[a, b, c]| {
                    let (a, b, c) = (corner(a), corner(b), corner(c));
                    (b - a).cross(c - a).length()
                })
                .iter()
                .sum();
            approx::assert_relative_eq!(
                b.half_area() as f64,
                sum / 2.0,
                max_relative = 1e-6,
                epsilon = 1e-9
            );
        }
    }

    #[test]
    fn the_empty_box_is_neutral() {
        let b = Aabb {
            min: Vec3::new(-1.0, 2.0, 3.0),
            max: Vec3::new(1.0, 2.0, 5.0),
        };
        assert_eq!(Aabb::EMPTY.union(b), b);
        assert_eq!(b.union(Aabb::EMPTY), b);
        let around = Aabb::EMPTY.with_point(b.min).with_point(b.max);
        assert_eq!(around, b);
        assert_eq!(b.center(), Vec3::new(0.0, 2.0, 4.0));
        assert_eq!(b.diagonal(), 8f32.sqrt());
    }
}
