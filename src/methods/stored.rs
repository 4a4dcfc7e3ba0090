//! The splits of a trace kept as a tree, through which its rays can be sent again: what is left of a method
//! without building.

use super::best;
use crate::geometry::Aabb;
use crate::kernels::Item;

/// The splits of one trace, as far as its rays have come. In a tree of lists, what they have not come to is in
/// leaves, too.
///
/// About 150 bytes a node, and 32 a triangle of a leaf (4 in a tree of cells, where a triangle may be in many
/// leaves); of `best` 48 a node and 80 a triangle.
pub struct Stored {
    /// Triangles of the mesh.
    pub(super) mesh: usize,
    pub(super) nodes: Vec<Node>,
    /// Nodes without a parent: of octants one for each that has rays; of packets that of rays in none, if
    /// there are such rays, then that of cones.
    pub(super) roots: Vec<usize>,
    /// Triangles of leaves, of lists.
    pub(super) items: Vec<Item>,
    /// Triangles of leaves, of cells.
    pub(super) prims: Vec<u32>,
    /// Whether rays are tested against the root's box, too.
    pub(super) filters_root: bool,
    /// Ray/box tests that no ray's way depends on: probes of long lists, and filters that only tell whether
    /// splitting goes on.
    pub(super) extra_box: u64,
    /// The splits of `best`, which has nodes of its own kind.
    pub(super) best: Option<best::Kept>,
    /// Nodes above the one that is next, and which child it will be.
    open: Vec<(usize, usize)>,
}

/// A node of a stored tree.
#[derive(Clone, Copy)]
pub(super) struct Node {
    pub bounds: Aabb,
    /// Range of its triangles; empty of one that is split.
    pub from: usize,
    pub to: usize,
    /// In the order in which they are traversed; none of a leaf.
    pub children: Option<[Child; 2]>,
    /// Whether conic packets were filtered here, not rays.
    pub of_cones: bool,
}

/// A child of a stored node.
#[derive(Clone, Copy)]
pub(super) struct Child {
    pub bounds: Aabb,
    /// Whether all rays go on to it unfiltered.
    pub skipped: bool,
    /// None of a cell that no ray has come to, or that has no triangles.
    pub node: Option<usize>,
}

/// How rays are sent through a stored tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// All together, as they were.
    Together,
    /// One after the other. Not where boxes are held against conic packets or groups, which are not of one ray.
    OneByOne,
    /// All together, rays of another batch, for which splitting goes on where the tree ends: the tree of one
    /// batch reused for the next. Only of trees of lists, in which every triangle is in one leaf.
    Onward,
}

impl Stored {
    pub(super) fn new() -> Stored {
        Stored {
            mesh: 0,
            nodes: Vec::new(),
            roots: Vec::new(),
            items: Vec::new(),
            prims: Vec::new(),
            filters_root: false,
            extra_box: 0,
            best: None,
            open: Vec::new(),
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes.len() + self.best.as_ref().map_or(0, best::Kept::nodes)
    }

    /// Number of triangles of all leaves.
    pub fn triangles(&self) -> usize {
        let of_best = self.best.as_ref().map_or(0, best::Kept::triangles);
        self.items.len() + self.prims.len() + of_best
    }

    /// Ray/box tests in the counters of the trace that no ray's way depended on.
    pub fn extra_box(&self) -> u64 {
        self.extra_box
    }

    /// Keeps a leaf whose triangles have been put at the end of their list.
    pub(super) fn leaf(&mut self, bounds: Aabb, from: usize, to: usize) {
        self.push(Node {
            bounds,
            from,
            to,
            children: None,
            of_cones: false,
        });
    }

    /// Keeps a split; its first child is next. Of each child the box, and whether it is skipped.
    pub(super) fn split(&mut self, bounds: Aabb, children: [(Aabb, bool); 2], of_cones: bool) {
        let at = self.nodes.len();
        self.push(Node {
            bounds,
            from: 0,
            to: 0,
            children: Some(children.map(|(bounds, skipped)| Child {
                bounds,
                skipped,
                node: None,
            })),
            of_cones,
        });
        self.open.push((at, 0));
    }

    /// The second child of the last split is next.
    pub(super) fn second(&mut self) {
        if let Some((_, child)) = self.open.last_mut() {
            *child = 1;
        }
    }

    /// The last split is done.
    pub(super) fn close(&mut self) {
        self.open.pop();
    }

    fn push(&mut self, node: Node) {
        let at = self.nodes.len();
        match self.open.last() {
            None => self.roots.push(at),
            Some(&(parent, child)) => {
                if let Some(children) = &mut self.nodes[parent].children {
                    children[child].node = Some(at);
                }
            }
        }
        self.nodes.push(node);
    }
}

impl Child {
    /// The node of a child in a tree of lists.
    pub fn of_list(&self) -> usize {
        self.node.expect("in a tree of lists every child is kept")
    }
}
