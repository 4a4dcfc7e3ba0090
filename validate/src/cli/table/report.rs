//! The table as it grows: heads, a section for each batch, means and legend.

use super::lines::{self, Means, Row};
use dacrt_validate::results::Cell;

/// What was printed so far.
pub struct Report {
    means: Means,
    size: Option<([u32; 2], u32)>,
    many_sizes: bool,
    threads: usize,
}

impl Report {
    /// Of batches of one size, or of several, of a run with so many threads.
    pub fn new(many_sizes: bool, threads: usize) -> Report {
        Report {
            means: Means::default(),
            size: None,
            many_sizes,
            threads,
        }
    }

    /// The lines of one batch; a label tells a cell from the others of its method.
    ///
    /// # Panics
    /// If there are no cells, or not as many labels.
    pub fn section(&mut self, cells: &[Cell], labels: &[String]) -> String {
        assert_eq!(cells.len(), labels.len());
        let mut text = String::new();
        if self.size.is_none() {
            text += &lines::heads();
        }
        let key = &cells[0].key;
        let size = (key.resolution, key.spp);
        if self.size != Some(size) && self.many_sizes {
            let ([width, height], spp) = size;
            let plural = if spp == 1 { "" } else { "s" };
            text += &format!("{width}x{height}, {spp} sample{plural} a pixel\n");
        }
        self.size = Some(size);
        let rows: Vec<Row> = (cells.iter().zip(labels))
            .map(|(cell, label)| Row::new(cell, label))
            .collect();
        for row in &rows {
            self.means.add(&key.rays, row);
        }
        text + &lines::section(&key.scene, &key.rays, &rows)
    }

    /// The means and what the columns mean.
    pub fn end(self) -> String {
        let peers = match self.means.has_peers() {
            true => lines::PEER_LEGEND,
            false => "",
        };
        let threads = match self.threads {
            1 => String::new(),
            n => format!("threads: {n} of best and of Embree, 1 of every other method\n"),
        };
        self.means.text() + lines::LEGEND + peers + &threads
    }
}
