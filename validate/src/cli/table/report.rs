//! The table as it grows: heads, a section for each batch, means and legend.

use super::lines::{self, Means, Row};
use dacrt_validate::results::{Cell, CellKey};

/// What was printed so far.
pub struct Report {
    means: Means,
    /// What was said of the last picture; none before the first.
    picture: Option<String>,
    many: Many,
    threads: usize,
}

/// Whether a scene is seen in several pictures, so that the table has to say which.
#[derive(Clone, Copy, Debug, Default)]
pub struct Many {
    /// Sizes, or samples a pixel.
    pub sizes: bool,
    pub cameras: bool,
}

impl Report {
    /// Of a run with so many threads.
    pub fn new(many: Many, threads: usize) -> Report {
        Report {
            means: Means::default(),
            picture: None,
            many,
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
        if self.picture.is_none() {
            text += &lines::heads();
        }
        let key = &cells[0].key;
        let picture = self.many.name(key);
        if !picture.is_empty() && self.picture.as_ref() != Some(&picture) {
            text += &format!("{picture}\n");
        }
        self.picture = Some(picture);
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

impl Many {
    /// `sibenik, camera aisle, 512x512, 4 samples a pixel`; empty if there is only one picture.
    fn name(self, key: &CellKey) -> String {
        let mut parts = Vec::new();
        if self.cameras {
            parts.push(format!("{}, camera {}", key.scene, key.camera));
        }
        if self.sizes {
            let ([width, height], spp) = (key.resolution, key.spp);
            let plural = if spp == 1 { "" } else { "s" };
            parts.push(format!("{width}x{height}, {spp} sample{plural} a pixel"));
        }
        parts.join(", ")
    }
}
