//! What the plots have in common: text, colours, markers, labels that do not overlap.

use anyhow::anyhow;
use plotters::chart::MeshStyle;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::*;

/// How a point is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Circle,
    Triangle,
    Square,
    Ring,
    Cross,
}

/// Width and height of a panel.
pub const PANEL: (i32, i32) = (480, 380);
/// Room for a legend above the panels.
pub const TOP: i32 = 44;
/// Height of text in pixels, and what `plotters` calls it.
pub const TEXT: i32 = 12;
const FONT_SIZE: f64 = 1.24 * TEXT as f64;
/// Of text and axes.
pub const INK: RGBColor = RGBColor(40, 40, 40);
pub const GRID: RGBColor = RGBColor(225, 225, 225);

/// What is drawn on.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// A rectangle in pixels: left, top, right, bottom.
pub type Frame = [i32; 4];

/// A picture of this size on white.
pub fn drawing(size: (u32, u32), draw: impl FnOnce(&Area) -> Drawn) -> anyhow::Result<String> {
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

/// What drawing gives.
pub type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Text of a colour.
pub fn style(color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", FONT_SIZE).into_font().color(&color)
}

/// The panel with this upper left corner.
pub fn panel_at<'a>(root: &Area<'a>, at: (i32, i32)) -> Area<'a> {
    root.clone().shrink(at, (PANEL.0 as u32, PANEL.1 as u32))
}

/// A chart with a title, and room for the axes.
pub fn chart_on<'a, 'b>(area: &'a Area<'b>, title: &str) -> ChartBuilder<'a, 'b, SVGBackend<'b>> {
    let mut chart = ChartBuilder::on(area);
    chart
        .margin(10)
        .caption(title, style(INK))
        .x_label_area_size(36)
        .y_label_area_size(58);
    chart
}

/// How the grid and the axes of a chart look; titles and ticks are the caller's.
pub fn mesh<'a, 'b, 'c, X, Y>(
    chart: &'b mut ChartContext<'a, SVGBackend<'c>, Cartesian2d<X, Y>>,
) -> MeshStyle<'a, 'b, X, Y, SVGBackend<'c>>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(WHITE)
        .bold_line_style(GRID)
        .axis_style(INK)
        .label_style(style(INK));
    mesh
}

/// About how wide a text is: the real font is that of whoever looks at it.
pub fn width(text: &str) -> i32 {
    text.chars().count() as i32 * 7
}

/// A point.
pub fn marker(root: &Area, (x, y): (i32, i32), color: RGBColor, shape: Shape) -> Drawn {
    let (fill, line) = (color.filled(), color.stroke_width(2));
    match shape {
        Shape::Circle => root.draw(&Circle::new((x, y), 4, fill)),
        Shape::Triangle => root.draw(&TriangleMarker::new((x, y), 6, fill)),
        Shape::Square => root.draw(&Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], fill)),
        Shape::Ring => root.draw(&Circle::new((x, y), 4, line)),
        Shape::Cross => root.draw(&Cross::new((x, y), 4, line)),
    }
}

/// Where a label of this width stands near a point: the nearest place of some that lies in the frame
/// and on nothing, or if there is none the one that lies on the least.
pub fn place((x, y): (i32, i32), width: i32, frame: Frame, taken: &[Frame]) -> Frame {
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
pub fn common(a: &Frame, b: &Frame) -> i32 {
    let width = a[2].min(b[2]) - a[0].max(b[0]);
    let height = a[3].min(b[3]) - a[1].max(b[1]);
    width.max(0) * height.max(0)
}

/// A tick: `0.01`, `1`, `1000`, `1e6`; nothing but for 1, 2 and 5 of each power of ten, which would
/// stand too close.
pub fn tick(x: f64) -> String {
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
}
