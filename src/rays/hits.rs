//! Hit records.

/// `prim` of a ray that hits nothing.
pub const MISS: u32 = u32::MAX;

/// The nearest hit of every ray of a batch, in the order of the batch: the least `(t, prim)`.
/// A miss is `t = +inf`, `prim = MISS`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits {
    /// Distances in units of the ray direction's length.
    pub t: Vec<f32>,
    /// Numbers of the triangles.
    pub prim: Vec<u32>,
}

impl Hits {
    /// `n` misses.
    pub fn misses(n: usize) -> Hits {
        Hits {
            t: vec![f32::INFINITY; n],
            prim: vec![MISS; n],
        }
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Number of rays that hit something.
    pub fn hit_count(&self) -> usize {
        self.prim.iter().filter(|&&p| p != MISS).count()
    }
}
