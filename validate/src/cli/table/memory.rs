//! Memory: a line a cell, our workspace beside the trees of Embree and of other libraries.

use crate::cli::text::columns;
use dacrt_validate::results::{Cell, Document, PeerTimes};

const LEGEND: &str = "
MB (10^6 bytes). ours: the workspace, known before the trace. Embree: all that it holds for the
build that is best in build + trace, its copy of the triangles (48 bytes each) included. Others: the
tree and triangles of the builder that is best in build + trace. Rays, hits and the mesh are in none.
";

/// The table.
pub fn text(document: &Document) -> String {
    let mut names: Vec<&str> = Vec::new();
    for peer in document.cells.iter().flat_map(|cell| &cell.peers) {
        if !names.contains(&&*peer.name) {
            names.push(&peer.name);
        }
    }
    let heads = ["scene", "rays", "size", "method", "ours", "Embree"];
    let mut rows: Vec<Vec<String>> = vec![heads.map(str::to_owned).to_vec()];
    rows[0].extend(names.iter().map(|name| name.to_string()));
    for cell in &document.cells {
        let key = &cell.key;
        let [width, height] = key.resolution;
        let spp = match key.spp {
            1 => String::new(),
            spp => format!(" x{spp}"),
        };
        let mut row = vec![
            key.scene.clone(),
            key.rays.clone(),
            format!("{width}x{height}{spp}"),
            key.method.clone(),
            megabytes(Some(cell.workspace_bytes)),
            megabytes(cell.embree.as_ref().map(|embree| embree.bytes)),
        ];
        row.extend(names.iter().map(|name| megabytes(peer_bytes(cell, name))));
        rows.push(row);
    }
    let right: Vec<usize> = (4..rows[0].len()).collect();
    columns(&rows, &right) + LEGEND
}

/// Memory of the builder of a library that is best in build + trace.
fn peer_bytes(cell: &Cell, name: &str) -> Option<usize> {
    let total = |peer: &PeerTimes| peer.build_ms + peer.trace_ms;
    let builders = cell.peers.iter().filter(|peer| peer.name == name);
    builders.min_by(|a, b| total(a).total_cmp(&total(b)))?.bytes
}

fn megabytes(bytes: Option<usize>) -> String {
    bytes.map_or("-".to_owned(), |bytes| format!("{:.1}", bytes as f64 / 1e6))
}

#[cfg(test)]
mod tests {
    use super::megabytes;

    #[test]
    fn a_megabyte_is_a_million_bytes() {
        assert_eq!(megabytes(Some(1_250_000)), "1.2");
        assert_eq!(megabytes(None), "-");
    }
}
