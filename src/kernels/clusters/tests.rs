//! The grid and its cells.

use super::*;
use crate::geometry::Triangle;
use crate::kernels::Kernels;
use crate::random::{hash, unit_f64};
use crate::simd::Isa;
use glam::Vec3;

fn items(n: u64, scale: Vec3) -> Vec<Item> {
    let corner = |i: u64, j: u64| {
        let value = |axis: u64| unit_f64(hash(i, j, axis)) as f32;
        scale * Vec3::new(value(0), value(1), value(2))
    };
    (0..n)
        .map(|i| {
            Item::new(
                &Triangle::new(corner(i, 0), corner(i, 1), corner(i, 2)),
                i as u32,
            )
        })
        .collect()
}

#[test]
fn a_grid_has_no_more_cells_than_it_may() {
    for scale in [
        Vec3::ONE,
        Vec3::new(1.0, 1e-3, 1e6),
        Vec3::new(0.0, 1.0, 1.0),
        Vec3::ZERO,
    ] {
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: scale,
        };
        for cells in [1, 2, 7, 100, 12_345, 3_000_000] {
            let grid = Grid::new(&bounds, cells);
            assert!((1..=cells).contains(&grid.cells()), "{grid:?}");
            if scale == Vec3::ONE {
                assert!(grid.cells() * 3 >= cells, "{grid:?}");
            }
        }
    }
}

#[test]
fn items_of_a_cell_stand_together_within_its_box() {
    for isa in Isa::available() {
        let kernels = Kernels::of(isa);
        for scale in [Vec3::ONE, Vec3::new(1.0, 0.0, 5.0), Vec3::ZERO] {
            let items = items(500, scale);
            let grid = Grid::new(
                &Aabb {
                    min: Vec3::ZERO,
                    max: scale,
                },
                60,
            );
            let mut cells = vec![0; 500];
            let mut counts = vec![0; grid.cells()];
            let mut boxes = vec![BinBox::EMPTY; grid.cells()];
            let mut sorted = vec![Item::ZERO; 500];
            // SAFETY: the processor was checked; all places are within `sorted`.
            unsafe { (kernels.count_cells)(&items, &grid, &mut cells, &mut counts) };
            assert_eq!(counts.iter().sum::<u32>(), 500);
            let mut from = 0;
            let mut places: Vec<u32> = counts
                .iter()
                .map(|&count| {
                    from += count;
                    from - count
                })
                .collect();
            // SAFETY: as above.
            unsafe {
                let to = sorted.as_mut_ptr();
                (kernels.scatter)(&items, &cells, &mut places, &mut boxes, to);
            }
            let mut from = 0;
            for (cell, &count) in counts.iter().enumerate() {
                for item in &sorted[from..from + count as usize] {
                    assert_eq!(cells[item.prim() as usize], cell as u32);
                    let union = boxes[cell].bounds().union(item.bounds());
                    assert_eq!(union, boxes[cell].bounds(), "{isa}");
                }
                from += count as usize;
                assert_eq!(boxes[cell].is_empty(), count == 0);
            }
        }
    }
}
