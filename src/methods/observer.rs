//! Who looks on while a batch is traced, or what takes the place of splitting.

use super::object::Log;
use super::stored::{Sent, Stored};
use super::watch::Watch;

/// Nobody, or one of these.
#[derive(Default)]
pub(super) struct Observer<'a> {
    /// Somebody watches one ray.
    pub watch: Option<&'a mut Watch>,
    /// Nodes are written down, of lists of triangles.
    pub log: Option<&'a mut Log>,
    /// Splits are kept.
    pub stored: Option<&'a mut Stored>,
    /// Rays are sent through splits that are there.
    pub sent: Option<(&'a Stored, Sent)>,
}
