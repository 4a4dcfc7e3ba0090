//! Fig. 10 of Mora 2011: million rays a second of seven diffuse bounces.

use super::fig8::short;
use super::size_of;
use crate::cli::text::columns;
use dacrt_validate::results::Cell;
use std::ops::RangeInclusive;

/// Pixels.
pub const SIZE: [u32; 2] = [740, 480];
/// Without roulette.
pub const BOUNCES: RangeInclusive<u8> = 1..=7;
/// Million rays a second over Erw6, Sponza, Conference and Soda Hall, one thread.
const RANGE: [f64; 2] = [0.9, 3.0];
/// Of Conference, as Nabata 2013 quotes it.
const CONFERENCE: f64 = 1.3;

/// The figure for people; none if no scene has all bounces.
pub fn text(cells: &[Cell]) -> Option<String> {
    let is_bounce = |rays: &str| {
        BOUNCES
            .into_iter()
            .any(|bounce| rays == format!("diffuse-{bounce}"))
    };
    let of_paths = |cell: &&Cell| cell.key.method == "mora2011-random" && is_bounce(&cell.key.rays);
    let cells: Vec<&Cell> = cells.iter().filter(of_paths).collect();
    let size = size_of(&cells, SIZE);
    let cells = cells.into_iter().filter(|cell| cell.key.resolution == size);
    let cells: Vec<&Cell> = cells.collect();
    let mut rows = vec![["scene", "triangles", "rays", "Mrays/s", "Mora 2011"].map(str::to_owned)];
    for scene in cells.chunk_by(|a, b| a.key.scene == b.key.scene) {
        if scene.len() != BOUNCES.count() || scene.iter().any(|cell| cell.is_wrong()) {
            continue;
        }
        let rays: usize = scene.iter().map(|cell| cell.ray_count).sum();
        let ms: f64 = scene.iter().filter_map(|cell| cell.median_ms).sum();
        let [least, greatest] = RANGE;
        rows.push([
            scene[0].key.scene.clone(),
            scene[0].triangles.to_string(),
            rays.to_string(),
            short(rays as f64 / 1e3 / ms),
            match scene[0].key.scene.as_str() {
                "conference" => format!("{CONFERENCE} (by Nabata 2013)"),
                _ => format!("{least}-{greatest:.1}"),
            },
        ]);
    }
    let [[width, height], [w, h]] = [size, SIZE];
    let rows: Vec<Vec<String>> = rows.into_iter().map(Vec::from).collect();
    (rows.len() > 1).then(|| {
        format!(
            "Fig. 10: seven diffuse bounces without roulette; {width} x {height} pixels (Mora 2011: \
             {w} x {h})\n\n{}",
            columns(&rows, &[1, 2, 3])
        )
    })
}
