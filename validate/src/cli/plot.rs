//! `dacrt plot`: time against errors as a scatter, a panel a ray type; growth ([`growth`]); nodes
//! ([`nodes`]).

mod growth;
mod nodes;

use super::Verdict;
use super::args::{Plot, PlotArgs};
use super::plan::check_writable;
use super::text::{complain, counted, print};
use anyhow::{Context, anyhow, bail, ensure};
use dacrt::Precision;
use dacrt_validate::accuracy::{Batch, Who, batches};
use dacrt_validate::atomic;
use dacrt_validate::embree::Mode;
use dacrt_validate::growth as measured;
use dacrt_validate::results::Document;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::io::Write;

/// Draws and writes.
pub fn plot(args: &PlotArgs) -> anyhow::Result<Verdict> {
    check_writable(&args.out).context("--out")?;
    let (svg, what) = match args.what {
        Plot::Errors => errors(args)?,
        Plot::Growth => growth_of(args)?,
        Plot::Nodes => nodes_of(args)?,
    };
    let path = args.out.display();
    atomic::write(&args.out, |file| file.write_all(svg.as_bytes()))
        .with_context(|| format!("{path}: cannot be written"))?;
    print(&format!("{path}: {what}\n"))?;
    Ok(Verdict::Good)
}

/// Estimates and splits of the nodes of one trace, and how many these are.
fn nodes_of(args: &PlotArgs) -> anyhow::Result<(String, String)> {
    let [file] = &args.files[..] else {
        bail!("`plot nodes` draws one file");
    };
    let rows = dacrt_validate::nodes::read(file)?;
    ensure!(!rows.is_empty(), "{}: has no nodes", file.display());
    Ok((nodes::draw(&rows)?, counted(rows.len() as u64, "node")))
}

/// Time against numbers, and how much that was.
fn growth_of(args: &PlotArgs) -> anyhow::Result<(String, String)> {
    let [file] = &args.files[..] else {
        bail!("`plot growth` draws one file");
    };
    let document = measured::Document::read(file)?;
    let points = document.curves.iter().flat_map(|curve| &curve.points);
    let timed = points.filter(|point| point.ms.is_some()).count() as u64;
    ensure!(timed > 0, "none of the points has times");
    for left_out in &document.left_out {
        complain(&format!(
            "left out: {} triangles, {} rays: {}",
            left_out.triangles, left_out.rays, left_out.why
        ));
    }
    let what = format!(
        "{}, {}",
        counted(document.curves.len() as u64, "curve"),
        counted(timed, "point")
    );
    Ok((growth::draw(&document.curves)?, what))
}

/// Time against errors, and how much that was.
fn errors(args: &PlotArgs) -> anyhow::Result<(String, String)> {
    let documents: Vec<Document> = (args.files.iter())
        .map(|file| Document::read(file))
        .collect::<Result<_, _>>()?;
    let (mut panels, mut drawn) = (Vec::new(), 0);
    for (document, path) in documents.iter().zip(&args.files) {
        let all = batches(document);
        ensure!(
            !all.is_empty(),
            "{}: its errors were not counted; `dacrt run` counts them",
            path.display()
        );
        for batch in &all {
            let left_out = add(&mut panels, batch);
            drawn += 1;
            for who in left_out {
                let (scene, rays) = (&batch.key.scene, &batch.key.rays);
                complain(&format!(
                    "left out, for it has no times: {scene} {rays} {who}"
                ));
            }
        }
    }
    ensure!(
        panels.iter().any(|panel| !panel.chains.is_empty()),
        "none of the cells has times"
    );
    let svg = draw(&panels)?;
    let batches = match drawn {
        1 => "1 batch".to_owned(),
        n => format!("{n} batches"),
    };
    let points = panels.iter().flat_map(|panel| &panel.chains);
    let points = points.map(|chain| chain.points.len() as u64).sum();
    Ok((svg, format!("{batches}, {}", counted(points, "point"))))
}

/// One ray type.
struct Panel {
    rays: String,
    chains: Vec<Chain>,
}

/// Points of one batch that are joined by a line: ours, or Embree's.
struct Chain {
    label: String,
    /// Place in [`SERIES`], nanoseconds a ray, errors per million.
    points: Vec<(usize, f64, f64)>,
}

/// Adds a batch; returns who has no times.
fn add<'a>(panels: &mut Vec<Panel>, batch: &'a Batch) -> Vec<Who<'a>> {
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
const SERIES: [(&str, RGBColor, Shape); 5] = [
    ("ours, fast", RGBColor(0, 114, 178), Shape::Circle),
    ("ours, watertight", RGBColor(0, 158, 115), Shape::Triangle),
    ("ours, exact", RGBColor(213, 94, 0), Shape::Square),
    ("Embree, default", RGBColor(110, 110, 110), Shape::Ring),
    ("Embree, robust", RGBColor(20, 20, 20), Shape::Cross),
];

#[derive(Clone, Copy)]
enum Shape {
    Circle,
    Triangle,
    Square,
    Ring,
    Cross,
}

const PANEL: (i32, i32) = (480, 380);
const TOP: i32 = 44;
/// Height of text in pixels, and what `plotters` calls it.
const TEXT: i32 = 12;
const FONT_SIZE: f64 = 1.24 * TEXT as f64;
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// A rectangle in pixels: left, top, right, bottom.
type Frame = [i32; 4];

fn draw(panels: &[Panel]) -> anyhow::Result<String> {
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

/// A picture of this size on white.
fn drawing(size: (u32, u32), draw: impl FnOnce(&Area) -> Drawn) -> anyhow::Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let drawn = (root.fill(&WHITE))
            .and_then(|()| draw(&root))
            .and_then(|()| root.present());
        drawn.map_err(|error| anyhow!("cannot be drawn: {error}"))?;
    }
    Ok(svg)
}

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn style(color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", FONT_SIZE).into_font().color(&color)
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

/// About how wide a text is: the real font is that of whoever looks at it.
fn width(text: &str) -> i32 {
    text.chars().count() as i32 * 7
}

fn marker(root: &Area, (x, y): (i32, i32), color: RGBColor, shape: Shape) -> Drawn {
    let (fill, line) = (color.filled(), color.stroke_width(2));
    match shape {
        Shape::Circle => root.draw(&Circle::new((x, y), 4, fill)),
        Shape::Triangle => root.draw(&TriangleMarker::new((x, y), 6, fill)),
        Shape::Square => root.draw(&Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], fill)),
        Shape::Ring => root.draw(&Circle::new((x, y), 4, line)),
        Shape::Cross => root.draw(&Cross::new((x, y), 4, line)),
    }
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
    let area = (root.clone()).shrink(at, (PANEL.0 as u32, PANEL.1 as u32));
    let zero = scales.errors.0;
    let mut chart = ChartBuilder::on(&area)
        .margin(10)
        .caption(&panel.rays, style(INK))
        .x_label_area_size(36)
        .y_label_area_size(58)
        .build_cartesian_2d(
            (scales.ns.0..scales.ns.1).log_scale(),
            // The line of no error stands clear of the axis.
            (0.7 * scales.errors.0..scales.errors.1).log_scale(),
        )?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .axis_style(INK)
        .label_style(style(INK))
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
    for chain in &panel.chains {
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

/// Where a label of this width stands near a point: the nearest place of some that lies in the frame
/// and on nothing, or if there is none the one that lies on the least.
fn place((x, y): (i32, i32), width: i32, frame: Frame, taken: &[Frame]) -> Frame {
    const HALF: i32 = TEXT / 2 + 1;
    let mut best = None;
    for distance in [0, 14, 28, 42, 56, 70] {
        let sides = [
            (x + 8, y - distance),
            (x - 8 - width, y - distance),
            (x - width / 2, y - 14 - distance),
            (x - width / 2, y + 14 + distance),
            (x + 8, y + distance),
            (x - 8 - width, y + distance),
        ];
        for (left, middle) in sides {
            let here = [left, middle - HALF, left + width, middle + HALF];
            let outside = here[0] < frame[0]
                || here[1] < frame[1]
                || here[2] > frame[2]
                || here[3] > frame[3];
            if outside {
                continue;
            }
            let covered: i32 = taken.iter().map(|other| common(&here, other)).sum();
            if covered == 0 {
                return here;
            }
            if best.is_none_or(|(least, _)| covered < least) {
                best = Some((covered, here));
            }
        }
    }
    best.map_or([x + 8, y - HALF, x + 8 + width, y + HALF], |(_, here)| here)
}

/// The area that two frames have in common.
fn common(a: &Frame, b: &Frame) -> i32 {
    let width = a[2].min(b[2]) - a[0].max(b[0]);
    let height = a[3].min(b[3]) - a[1].max(b[1]);
    width.max(0) * height.max(0)
}

/// A tick: `0.01`, `1`, `1000`, `1e6`; nothing but for 1, 2 and 5 of each power of ten, which would
/// stand too close.
fn tick(x: f64) -> String {
    let digit = (x / 10.0_f64.powf(x.log10().floor())).round() as u32;
    match x {
        _ if ![1, 2, 5, 10].contains(&digit) => String::new(),
        _ if !(0.00099..99_999.5).contains(&x) => format!("{x:.0e}"),
        _ if x >= 0.995 => format!("{x:.0}"),
        _ => {
            let digits = (-x.log10()).ceil() as usize;
            format!("{x:.digits$}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_beside_each_other() {
        let frame = [0, 0, 400, 300];
        let mut taken = vec![[94, 94, 106, 106]];
        for _ in 0..8 {
            let here = place((100, 100), 60, frame, &taken);
            assert!(taken.iter().all(|other| common(&here, other) == 0));
            taken.push(here);
        }
        // In a corner, too, it stays inside.
        let here = place((398, 2), 60, frame, &[]);
        assert!(here[0] >= 0 && here[1] >= 0 && here[2] <= 400 && here[3] <= 300);
    }

    #[test]
    fn ticks_are_short() {
        let ticks = [0.0001, 0.01, 0.1, 1.0, 20.0, 30.0, 10_000.0, 1e6].map(tick);
        assert_eq!(
            ticks,
            ["1e-4", "0.01", "0.1", "1", "20", "", "10000", "1e6"]
        );
    }

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
