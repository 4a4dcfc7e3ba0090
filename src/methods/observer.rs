//! Who looks on while a batch is traced, or what takes the place of splitting.

use super::object::Log;
use super::stored::{Sent, Stored};
use super::watch::Watch;

pub(super) enum Observer<'a> {
    None,
    /// Somebody watches one ray.
    Ray(&'a mut Watch),
    /// Nodes are written down.
    Nodes(&'a mut Log),
    /// Splits are kept.
    Store(&'a mut Stored),
    /// Rays are sent through splits that are there.
    Send(&'a Stored, Sent),
}
