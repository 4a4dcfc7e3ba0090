//! Stored splits: a line a cell, a trace beside its rays sent through the tree of its splits, and Embree.

use crate::cli::text::columns;
use dacrt_validate::results::Cell;

const LEGEND: &str = "
ms: median milliseconds of the trace; of which splitting: what is saved where the splits are there
[95 %]; Embree trace, total: how many times as fast the stored splits are as its trace alone, and
the trace as its build and trace. boxes a ray: ray/box tests of a ray sent alone, = if they and the
ray/triangle tests of all rays are as many as in the trace, to the last one, and the hits the same;
- = where boxes are held against cones or groups of rays, which cannot be sent one by one.
";

/// The table; none without a twin.
pub fn text(cells: &[Cell]) -> Option<String> {
    let head = [
        "scene",
        "rays",
        "method",
        "nodes",
        "ms",
        "of which splitting",
        "trace",
        "total",
        "boxes a ray",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for cell in cells {
        let (Some(twin), Some(ms)) = (&cell.twin, cell.median_ms) else {
            continue;
        };
        let share = |over: f64| 100.0 * (1.0 - 1.0 / over);
        let [low, high] = twin.trace_over_twin_interval.map(share);
        let embree = cell.embree.as_ref();
        let trace = embree.map(|embree| embree.best_trace_ms / twin.median_ms);
        let ratio = |ratio: Option<f64>| ratio.map_or("-".to_owned(), |r| format!("{r:.2}"));
        let sign = if twin.is_equal() { "=" } else { "OTHER" };
        let boxes = twin.one_by_one_ray_box.map_or("-".to_owned(), |boxes| {
            format!("{:.1}", boxes as f64 / cell.ray_count as f64)
        });
        rows.push(vec![
            cell.key.scene.clone(),
            cell.key.rays.clone(),
            cell.key.method.clone(),
            twin.nodes.to_string(),
            format!("{ms:.1}"),
            format!("{:.0} % [{low:.0}, {high:.0}]", share(twin.trace_over_twin)),
            ratio(trace),
            ratio(cell.ratio_embree_total),
            format!("{boxes} {sign}"),
        ]);
    }
    (rows.len() > 1).then(|| columns(&rows, &[3, 4, 5, 6, 7, 8]) + LEGEND)
}
