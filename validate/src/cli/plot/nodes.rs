//! `dacrt plot nodes`: how good estimates are, and what splits cost, of the nodes of one trace.

use super::drawing::{
    Area, Drawn, INK, PANEL, Shape, TOP, chart_on, drawing, marker, mesh, panel_at, style, tick,
    width,
};
use dacrt_validate::nodes::Row;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const BLUE: RGBColor = RGBColor(0, 114, 178);
const ORANGE: RGBColor = RGBColor(213, 94, 0);
const GUIDE: RGBColor = RGBColor(190, 190, 190);
/// Points that a scatter has at most.
const POINTS: usize = 4000;

/// A line of points.
struct Series {
    name: &'static str,
    color: RGBColor,
    shape: Shape,
    points: Vec<(f64, f64)>,
}

impl Series {
    fn new(name: &'static str, color: RGBColor, shape: Shape, points: Vec<(f64, f64)>) -> Series {
        Series {
            name,
            color,
            shape,
            points,
        }
    }
}

/// Four panels.
pub(super) fn draw(rows: &[Row]) -> anyhow::Result<String> {
    let size = ((2 * PANEL.0) as u32, (TOP / 2 + 2 * PANEL.1) as u32);
    drawing(size, |root| {
        let at = |i: i32| (i % 2 * PANEL.0, TOP / 2 + i / 2 * PANEL.1);
        scatter(root, rows, at(0))?;
        wrong_skips(root, rows, at(1))?;
        regret(root, rows, at(2))?;
        work(root, rows, at(3))
    })
}

/// Estimated against true intersection ratios, those of skipped children in another colour.
fn scatter(root: &Area, rows: &[Row], at: (i32, i32)) -> Drawn {
    let children: Vec<_> = rows.iter().filter_map(Row::children).flatten().collect();
    let area = panel_at(root, at);
    let mut chart = chart_on(&area, "intersection ratio").build_cartesian_2d(0.0..1.0, 0.0..1.0)?;
    mesh(&mut chart)
        .x_desc("of all rays")
        .y_desc("of the samples")
        .draw()?;
    let diagonal = PathElement::new(vec![(0.0, 0.0), (1.0, 1.0)], GUIDE);
    chart.draw_series([diagonal])?;
    let stride = children.len().div_ceil(POINTS).max(1);
    chart.draw_series(
        children
            .iter()
            .step_by(stride)
            .map(|&(estimated, ratio, skipped)| {
                let color = if skipped { ORANGE } else { BLUE };
                Circle::new((f64::from(ratio), f64::from(estimated)), 1, color.filled())
            }),
    )?;
    let names = [("filtered", BLUE), ("skipped", ORANGE)];
    legend(
        &area,
        &names.map(|(name, color)| (name, color, Shape::Circle)),
    )
}

/// The share of children whose ratio by all rays is on the other side of the limit than that by samples,
/// by the number of rays. The limit is known by what was skipped.
fn wrong_skips(root: &Area, rows: &[Row], at: (i32, i32)) -> Drawn {
    let mut least_skipped = 1.0_f32;
    let mut decades: Vec<[u32; 3]> = vec![[0; 3]; 40];
    for [a, b] in rows.iter().filter_map(Row::children) {
        for (estimated, _, skipped) in [a, b] {
            if skipped {
                least_skipped = least_skipped.min(estimated);
            }
        }
    }
    for row in rows {
        // Four bins a decade.
        let bin = (4.0 * f64::from(row.rays.max(1)).log10()) as usize;
        for (_, ratio, skipped) in row.children().into_iter().flatten() {
            let bin = &mut decades[bin.min(39)];
            bin[0] += 1;
            bin[1] += u32::from(skipped && ratio < least_skipped);
            bin[2] += u32::from(!skipped && ratio >= least_skipped);
        }
    }
    let share = |which: usize| {
        let bins = decades.iter().enumerate().filter(|(_, bin)| bin[0] > 0);
        let share = |bin: &[u32; 3]| 100.0 * f64::from(bin[which]) / f64::from(bin[0]);
        bins.map(|(i, bin)| (10f64.powf((i as f64 + 0.5) / 4.0), share(bin)))
            .collect()
    };
    let series = [
        Series::new(
            "skipped, ratio below the limit",
            ORANGE,
            Shape::Circle,
            share(1),
        ),
        Series::new("filtered, above it", BLUE, Shape::Ring, share(2)),
    ];
    let labels = [
        "wrong decisions to skip",
        "active rays of the node",
        "% of children",
    ];
    lines(root, at, labels, true, &series)
}

/// By how much the cost by all rays is above the least, by depth.
fn regret(root: &Area, rows: &[Row], at: (i32, i32)) -> Drawn {
    let of = |cost: &dyn Fn(&Row) -> Option<u64>| {
        let over = by_depth(rows, &|row| {
            Some((cost(row)? as f64, row.least_cost? as f64))
        });
        over.into_iter()
            .map(|(depth, over)| (depth, 100.0 * (over - 1.0)))
            .collect()
    };
    let series = [
        Series::new("split taken", ORANGE, Shape::Circle, of(&|row| row.cost)),
        Series::new(
            "by surface area",
            BLUE,
            Shape::Ring,
            of(&|row| row.cost_by_area),
        ),
    ];
    let labels = ["regret", "depth", "% above the least cost"];
    lines(root, at, labels, false, &series)
}

/// The share of all box tests, by depth.
fn work(root: &Area, rows: &[Row], at: (i32, i32)) -> Drawn {
    let all = rows.iter().map(Row::box_tests).sum::<u64>() as f64 / 100.0;
    let of = |tests: &dyn Fn(&Row) -> Option<u64>| {
        let sums = by_depth(rows, &|row| Some((tests(row)? as f64, 0.0)));
        sums.into_iter()
            .map(|(depth, sum)| (depth, sum / all))
            .collect()
    };
    let series = [
        Series::new("filters", BLUE, Shape::Circle, of(&|row| row.ray_box)),
        Series::new("samples", ORANGE, Shape::Ring, of(&|row| row.sample_box)),
    ];
    let labels = ["ray/box tests", "depth", "% of all"];
    lines(root, at, labels, false, &series)
}

/// For each depth the sum of the first numbers over that of the second, or the first alone if that is 0.
fn by_depth(rows: &[Row], of: &dyn Fn(&Row) -> Option<(f64, f64)>) -> Vec<(f64, f64)> {
    let deepest = rows.iter().map(|row| row.depth).max().unwrap_or(0);
    let mut sums = vec![None; deepest as usize + 1];
    for row in rows {
        if let Some((a, b)) = of(row) {
            let (x, y) = sums[row.depth as usize].unwrap_or((0.0, 0.0));
            sums[row.depth as usize] = Some((x + a, y + b));
        }
    }
    let sums = sums.into_iter().enumerate();
    sums.filter_map(|(depth, sum)| {
        let (a, b) = sum?;
        Some((depth as f64, if b > 0.0 { a / b } else { a }))
    })
    .collect()
}

fn lines(
    root: &Area,
    at: (i32, i32),
    [title, x, y]: [&str; 3],
    logarithmic: bool,
    series: &[Series],
) -> Drawn {
    let points = || series.iter().flat_map(|series| &series.points);
    let (mut low, mut high, mut most) = (f64::INFINITY, 1.0_f64, 0.0_f64);
    for &(x, y) in points() {
        (low, high, most) = (low.min(x), high.max(x), most.max(y));
    }
    let low = low.min(high);
    let place = |x: f64| if logarithmic { x.max(1e-3).log10() } else { x };
    let area = panel_at(root, at);
    let room = (place(high) - place(low)).max(0.1) * 0.03;
    let mut chart = chart_on(&area, title).build_cartesian_2d(
        place(low) - room..place(high) + room,
        // Room for the legend.
        0.0..(1.25 * most).max(1e-9),
    )?;
    let whole = |x: &f64| (x - x.round()).abs() < 1e-9;
    mesh(&mut chart)
        .x_desc(x)
        .y_desc(y)
        .x_label_formatter(&|x| match (logarithmic, whole(x)) {
            (true, true) => tick(10f64.powf(*x)),
            (false, true) => format!("{x:.0}"),
            _ => String::new(),
        })
        .draw()?;
    for Series {
        color,
        shape,
        points,
        ..
    } in series
    {
        let of = |&(x, y): &(f64, f64)| chart.backend_coord(&(place(x), y));
        let points: Vec<(i32, i32)> = points.iter().map(of).collect();
        root.draw(&PathElement::new(points.clone(), color.stroke_width(1)))?;
        for point in points {
            marker(root, point, *color, *shape)?;
        }
    }
    let names = series
        .iter()
        .map(|series| (series.name, series.color, series.shape));
    legend(&area, &names.collect::<Vec<_>>())
}

/// Below the title of a panel.
fn legend(area: &Area, names: &[(&str, RGBColor, Shape)]) -> Drawn {
    let mut x = 90;
    for &(name, color, shape) in names {
        marker(area, (x, 44), color, shape)?;
        let left = style(INK).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw_text(name, &left, (x + 10, 44))?;
        x += 30 + width(name);
    }
    Ok(())
}
