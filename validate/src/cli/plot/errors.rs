//! `dacrt plot errors`: time against errors as a scatter, a panel a ray type.

use super::drawing::{
    Area, Drawn, Frame, INK, PANEL, Shape, TOP, chart_on, drawing, marker, mesh, panel_at, place,
    style, tick, width,
};
use dacrt::Precision;
use dacrt_validate::accuracy::{Batch, Who};
use dacrt_validate::embree::Mode;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// One ray type.
pub struct Panel {
    pub rays: String,
    pub chains: Vec<Chain>,
}

/// Points of one batch that are joined by a line: ours, or Embree's.
pub struct Chain {
    label: String,
    /// Place in [`SERIES`], nanoseconds a ray, errors per million.
    pub points: Vec<(usize, f64, f64)>,
}

/// Adds a batch; returns who has no times.
pub fn add<'a>(panels: &mut Vec<Panel>, batch: &'a Batch) -> Vec<Who<'a>> {
    let method = batch.fastest_method();
    let mut left_out = Vec::new();
    let mut chains = [Vec::new(), Vec::new()];
    for tracer in &batch.tracers {
        let (chain, series) = match tracer.who {
            Who::Ours { method: m, .. } if method.is_some_and(|method| method != m) => continue,
            Who::Ours { precision, .. } => (0, Precision::ALL.iter().position(|&p| p == precision)),
            Who::Embree(mode) => (1, Mode::ALL.iter().position(|&m| m == mode)),
        };
        let series = series.unwrap_or(0) + chain * Precision::ALL.len();
        match tracer.ms {
            Some(ms) => chains[chain].push((
                series,
                ms * 1e6 / batch.rays as f64,
                batch.per_million(tracer.errors.all()),
            )),
            None => left_out.push(tracer.who),
        }
    }
    let key = batch.key;
    let place = panels.iter().position(|panel| panel.rays == key.rays);
    let place = place.unwrap_or_else(|| {
        panels.push(Panel {
            rays: key.rays.clone(),
            chains: Vec::new(),
        });
        panels.len() - 1
    });
    for points in chains.into_iter().filter(|points| !points.is_empty()) {
        panels[place].chains.push(Chain {
            label: key.scene.clone(),
            points,
        });
    }
    left_out
}

/// Colours that colour-blind people can tell apart (Okabe and Ito), and a shape each.
pub const SERIES: [(&str, RGBColor, Shape); 5] = [
    ("ours, fast", RGBColor(0, 114, 178), Shape::Circle),
    ("ours, watertight", RGBColor(0, 158, 115), Shape::Triangle),
    ("ours, exact", RGBColor(213, 94, 0), Shape::Square),
    ("Embree, default", RGBColor(110, 110, 110), Shape::Ring),
    ("Embree, robust", RGBColor(20, 20, 20), Shape::Cross),
];

/// All panels beside and below each other, with the legend.
pub fn draw(panels: &[Panel]) -> anyhow::Result<String> {
    let across = panels.len().min(2) as i32;
    let down = (panels.len() as i32 + across - 1) / across;
    let size = (
        (across * PANEL.0).max(700) as u32,
        (TOP + down * PANEL.1) as u32,
    );
    drawing(size, |root| {
        legend(root)?;
        let scales = Scales::of(panels);
        for (panel, i) in panels.iter().zip(0..) {
            let at = (i % across * PANEL.0, TOP + i / across * PANEL.1);
            draw_panel(root, panel, at, &scales)?;
        }
        Ok(())
    })
}

/// Each panel as a picture of its own, with the ranges of all of them, without a legend. Many chains have
/// no names, which would cover them.
pub fn separate(panels: Vec<Panel>) -> anyhow::Result<Vec<String>> {
    const NAMED: usize = 12;
    let scales = Scales::of(&panels);
    let size = (PANEL.0 as u32, PANEL.1 as u32);
    let one = |mut panel: Panel| {
        if panel.chains.len() > NAMED {
            panel
                .chains
                .iter_mut()
                .for_each(|chain| chain.label.clear());
        }
        drawing(size, |root| draw_panel(root, &panel, (0, 0), &scales))
    };
    panels.into_iter().map(one).collect()
}

fn legend(root: &Area) -> Drawn {
    let mut x = 24;
    for (name, color, shape) in SERIES {
        marker(root, (x, TOP / 2), color, shape)?;
        let left = style(INK).pos(Pos::new(HPos::Left, VPos::Center));
        root.draw_text(name, &left, (x + 10, TOP / 2))?;
        x += 34 + width(name);
    }
    Ok(())
}

/// The ranges of all panels, so that these can be compared.
struct Scales {
    ns: (f64, f64),
    /// The least is where no error stands.
    errors: (f64, f64),
}

impl Scales {
    fn of(panels: &[Panel]) -> Scales {
        let chains = panels.iter().flat_map(|panel| &panel.chains);
        let points: Vec<(usize, f64, f64)> = chains.flat_map(|c| c.points.clone()).collect();
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)))
        };
        let ns = range(&mut points.iter().map(|p| p.1));
        let (least, most) = range(&mut points.iter().map(|p| p.2).filter(|&y| y > 0.0));
        let (least, most) = if most > 0.0 {
            (least, most)
        } else {
            (1.0, 1.0)
        };
        Scales {
            ns: (ns.0 / 1.5, ns.1 * 1.5),
            // A power of ten, well below the least.
            errors: (10.0_f64.powf((least / 2.0).log10().floor()), most * 3.0),
        }
    }

    fn height(&self, errors: f64) -> f64 {
        errors.max(self.errors.0)
    }
}

fn draw_panel(root: &Area, panel: &Panel, at: (i32, i32), scales: &Scales) -> Drawn {
    let area = panel_at(root, at);
    let zero = scales.errors.0;
    let mut chart = chart_on(&area, &panel.rays).build_cartesian_2d(
        (scales.ns.0..scales.ns.1).log_scale(),
        // The line of no error stands clear of the axis.
        (0.7 * scales.errors.0..scales.errors.1).log_scale(),
    )?;
    mesh(&mut chart)
        .x_desc("nanoseconds a ray")
        .y_desc("errors per million rays")
        .x_label_formatter(&|x| tick(*x))
        .y_label_formatter(&|y| match *y <= zero * 1.01 {
            true => "0".to_owned(),
            false => tick(*y),
        })
        .draw()?;
    let pixel = |&(_, x, y): &(usize, f64, f64)| chart.backend_coord(&(x, scales.height(y)));
    let (xs, ys) = chart.plotting_area().get_pixel_range();
    let frame = [xs.start, ys.start, xs.end, ys.end];
    let mut taken: Vec<Frame> = Vec::new();
    for chain in &panel.chains {
        let line: Vec<(i32, i32)> = chain.points.iter().map(pixel).collect();
        taken.extend(line.iter().map(|&(x, y)| [x - 6, y - 6, x + 6, y + 6]));
        root.draw(&PathElement::new(line, RGBColor(190, 190, 190)))?;
    }
    for chain in &panel.chains {
        for point in &chain.points {
            let (_, color, shape) = SERIES[point.0];
            marker(root, pixel(point), color, shape)?;
        }
    }
    for chain in panel.chains.iter().filter(|c| !c.label.is_empty()) {
        let Some(first) = chain.points.first() else {
            continue;
        };
        let place = place(pixel(first), width(&chain.label), frame, &taken);
        taken.push(place);
        let (_, color, _) = SERIES[first.0];
        let middle = style(color).pos(Pos::new(HPos::Left, VPos::Center));
        let at = (place[0] + 1, (place[1] + place[3]) / 2);
        root.draw_text(&chain.label, &middle, at)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_error_at_all_can_be_drawn() {
        let panels = [Panel {
            rays: "primary".into(),
            chains: vec![Chain {
                label: "hall".into(),
                points: vec![(0, 20.0, 0.0), (2, 25.0, 0.0)],
            }],
        }];
        let svg = draw(&panels).unwrap();
        assert!(
            svg.contains("hall") && svg.contains("Embree, robust"),
            "{svg}"
        );
    }
}
