//! todo
use crate::geometry::Triangle;
pub(super) fn hall(_t: usize, _s: u64) -> Vec<Triangle> {
    vec![]
}
