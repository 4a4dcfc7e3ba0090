//! Figs. 6 and 14 of Mora 2011: frames a second of primary rays in conic packets, beside tracers that build
//! a tree or have one.

use super::fig8::short;
use super::size_of;
use crate::cli::paper::interval;
use crate::cli::text::columns;
use dacrt_validate::results::Cell;
use dacrt_validate::statistics::Ratio;

/// A figure as printed.
pub struct Figure {
    name: &'static str,
    /// Pixels.
    pub size: [u32; 2],
    /// Whose frames a second stand beside Mora's.
    other: &'static str,
    rows: &'static [Row],
}

/// A row of a figure.
struct Row {
    scene: &'static str,
    /// None if it is not printed.
    triangles: Option<f64>,
    /// Of Mora's method.
    fps: f64,
    /// Frames a second of the other over those of Mora's method, from the two printed numbers.
    other: f64,
    /// The scene of ours that is nearest to it.
    ours: Option<&'static str>,
}

const fn row(
    scene: &'static str,
    triangles: Option<f64>,
    fps: f64,
    other: f64,
    ours: Option<&'static str>,
) -> Row {
    Row {
        scene,
        triangles,
        fps,
        other,
        ours,
    }
}

pub const FIGURES: [Figure; 2] = [
    Figure {
        name: "Fig. 6",
        size: [640, 480],
        other: "build + trace",
        rows: &[
            row("Erw6", Some(806.0), 47.0, 43.0 / 47.0, None),
            row("Bunny", Some(69e3), 19.6, 9.6 / 19.6, Some("bunny")),
            row("Dragon", Some(863e3), 5.4, 1.3 / 5.4, Some("dragon")),
            row("Conference", None, 12.0, 1.6 / 12.0, Some("conference")),
            row("Buddha", None, 9.6, 1.4 / 9.6, Some("buddha")),
        ],
    },
    Figure {
        name: "Fig. 14",
        size: [1024, 1024],
        other: "trace alone",
        rows: &[
            row("Erw6", Some(804.0), 15.3, 5.1 / 15.3, None),
            row("Bunny", Some(69e3), 9.5, 3.38 / 9.5, Some("bunny")),
            row("Fairy", Some(174e3), 6.8, 3.7 / 6.8, None),
            row("Cabin", Some(217e3), 11.5, 4.2 / 11.5, None),
            row(
                "Conference",
                Some(282e3),
                10.1,
                3.6 / 10.1,
                Some("conference"),
            ),
            row("Armadillo", Some(345e3), 5.2, 4.7 / 5.2, Some("armadillo")),
            row("Conference", Some(1.02e6), 8.6, 2.7 / 8.6, None),
            row("Buddha", Some(1.08e6), 4.2, 1.0, Some("buddha")),
            row("Soda Hall", Some(2.2e6), 8.7, 6.9 / 8.7, None),
            row("Dragon", Some(7.2e6), 1.56, 2.24 / 1.56, Some("dragon")),
            row("Thai Statue", Some(10e6), 1.28, 1.46 / 1.28, None),
            row("Lucy", Some(28e6), 0.45, 0.73 / 0.45, Some("lucy")),
        ],
    },
];

impl Figure {
    /// The figure for people, 100 columns at most; none if nothing of it is measured.
    pub fn text(&self, cells: &[Cell]) -> Option<String> {
        let is_of_frames = |cell: &&Cell| {
            let key = &cell.key;
            (&*key.rays, &*key.method) == ("primary", "mora2011-cones")
        };
        let cells: Vec<&Cell> = cells.iter().filter(is_of_frames).collect();
        let size = size_of(&cells, self.size);
        let of_size = |cell: &&&Cell| cell.key.resolution == size;
        let cells: Vec<&Cell> = cells.iter().filter(of_size).copied().collect();
        if cells.is_empty() {
            return None;
        }
        let head = [
            "Mora 2011",
            "tris",
            "fps",
            "other",
            "here",
            "tris",
            "fps",
            "shaded",
            "trace [95 %]",
            "total",
        ];
        let mut rows: Vec<Vec<String>> = vec![head.map(str::to_owned).to_vec()];
        for row in self.rows {
            let printed = vec![
                row.scene.to_owned(),
                row.triangles.map_or("-".to_owned(), short),
                short(row.fps),
                format!("{:.2}", row.other),
            ];
            let cell = cells.iter().find(|cell| row.ours == Some(&cell.key.scene));
            rows.push([printed, here(row.ours, cell.copied())].concat());
        }
        let is_printed = |cell: &&&Cell| self.rows.iter().any(|r| r.ours == Some(&cell.key.scene));
        for cell in cells.iter().filter(|cell| !is_printed(cell)) {
            let nothing = ["-", "-", "-", "-"].map(str::to_owned).to_vec();
            rows.push([nothing, here(Some(&cell.key.scene), Some(cell))].concat());
        }
        let ([width, height], [w, h]) = (size, self.size);
        Some(format!(
            "{}: primary rays in conic packets; {width} x {height} pixels (Mora 2011: {w} x {h})\n\n{}\n\
             other: frames a second of a kd-tree tracer ({}) over Mora's; trace, total: of Embree's\n\
             trace alone, and of its build and trace, over ours. shaded: with flat shading.\n",
            self.name,
            columns(&rows, &[1, 2, 3, 5, 6, 7, 8, 9]),
            self.other,
        ))
    }
}

/// What we have of a row.
fn here(scene: Option<&str>, cell: Option<&Cell>) -> Vec<String> {
    let Some(scene) = scene else {
        return vec!["no mesh".to_owned()];
    };
    let Some(cell) = cell else {
        return vec!["not measured".to_owned()];
    };
    let Some(ms) = cell.median_ms.filter(|_| !cell.is_wrong()) else {
        return vec![scene.to_owned(), "WRONG".to_owned()];
    };
    let shaded = cell
        .shade_ms
        .map_or("-".to_owned(), |shading| short(1e3 / (ms + shading)));
    // Their time over ours is our frames a second over theirs.
    let over = |ratio: f64, [low, high]: [f64; 2]| Ratio {
        ratio: 1.0 / ratio,
        interval: [1.0 / high, 1.0 / low],
    };
    let trace = cell
        .ratio_embree_trace
        .zip(cell.ratio_embree_trace_interval);
    let total = cell.ratio_embree_total;
    vec![
        scene.to_owned(),
        short(cell.triangles as f64),
        short(1e3 / ms),
        shaded,
        trace.map_or("-".to_owned(), |(r, i)| interval(&over(r, i))),
        total.map_or("-".to_owned(), |r| format!("{:.2}", 1.0 / r)),
    ]
}
