//! A frame with two axes, for plots whose ticks are numbers on a logarithmic scale or names.

use super::drawing::{Area, Drawn, Frame, GRID, INK, TEXT, style, tick, width};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// From numbers to shares of the frame.
pub struct Axis {
    pub title: String,
    /// Numbers with a tick, and what stands there.
    ticks: Vec<(f64, String)>,
    low: f64,
    high: f64,
    is_logarithmic: bool,
}

impl Axis {
    /// A logarithmic axis with round ticks that has room for all of these numbers, which are above 0.
    pub fn logarithmic(title: &str, numbers: impl IntoIterator<Item = f64>) -> Axis {
        let [least, most] = range(numbers);
        let (low, high) = ((least / 1.08).log10(), (most * 1.08).log10());
        Axis {
            title: title.to_owned(),
            ticks: round_ticks(low, high),
            low,
            high,
            is_logarithmic: true,
        }
    }

    /// A logarithmic axis with ticks at these numbers only.
    pub fn logarithmic_at(title: &str, ticks: Vec<(f64, String)>) -> Axis {
        let [least, most] = range(ticks.iter().map(|tick| tick.0));
        Axis {
            title: title.to_owned(),
            low: (least / 1.25).log10(),
            high: (most * 1.25).log10(),
            ticks,
            is_logarithmic: true,
        }
    }

    /// Names side by side; the number of each is its place.
    pub fn names(title: &str, names: &[String]) -> Axis {
        let numbered = (0..).map(f64::from).zip(names.iter().cloned());
        Axis {
            title: title.to_owned(),
            ticks: numbered.collect(),
            low: -0.5,
            high: names.len() as f64 - 0.5,
            is_logarithmic: false,
        }
    }

    /// From 0 at the low end to 1 at the high one.
    fn share(&self, number: f64) -> f64 {
        let at = if self.is_logarithmic {
            number.log10()
        } else {
            number
        };
        (at - self.low) / (self.high - self.low)
    }
}

/// The least and the greatest number; 1 and 1 of none.
fn range(numbers: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let all = numbers.into_iter().filter(|x| x.is_finite() && *x > 0.0);
    let ends = all.fold(None, |ends: Option<[f64; 2]>, x| {
        Some(ends.map_or([x; 2], |[low, high]| [low.min(x), high.max(x)]))
    });
    ends.unwrap_or([1.0; 2])
}

/// Round numbers between two powers of ten: the fewer of each decade, the more decades there are.
fn round_ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    const FINE: [f64; 16] = [
        1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0,
    ];
    let of_decade: &[f64] = match high - low {
        span if span > 3.0 => &[1.0],
        span if span > 0.9 => &[1.0, 2.0, 5.0],
        span if span > 0.3 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
        _ => &FINE,
    };
    let decades = low.floor() as i32..=high.floor() as i32;
    let numbers = decades.flat_map(|decade| of_decade.iter().map(move |x| x * 10f64.powi(decade)));
    let inside = numbers.filter(|x| (low..=high).contains(&x.log10()));
    inside.map(|x| (x, number(x))).collect()
}

/// `0.25`, `1.5`, `100`.
fn number(x: f64) -> String {
    match tick(x) {
        short if !short.is_empty() && x >= 9.5 => short,
        _ => {
            let text = format!("{x:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

/// A frame whose axes are drawn.
pub struct Plane {
    pub frame: Frame,
    x: Axis,
    y: Axis,
}

impl Plane {
    /// Draws title, grid and ticks. The frame is in pixels; names on the left stand outside of it.
    pub fn draw(
        root: &Area,
        title: &str,
        frame: Frame,
        x: Axis,
        y: Axis,
    ) -> Result<Plane, Failure> {
        let plane = Plane { frame, x, y };
        let [left, top, right, bottom] = frame;
        let middle = (left + right) / 2;
        let centred = style(INK).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw_text(title, &centred, (middle, top - 14))?;
        root.draw_text(&plane.x.title, &centred, (middle, bottom + 32))?;
        let upright = style(INK)
            .transform(FontTransform::Rotate270)
            .pos(Pos::new(HPos::Center, VPos::Center));
        root.draw_text(&plane.y.title, &upright, (12, (top + bottom) / 2))?;
        plane.ticks_below(root)?;
        plane.ticks_beside(root)?;
        let corners = [(left, top), (right, bottom)];
        root.draw(&Rectangle::new(corners, INK.stroke_width(1)))?;
        Ok(plane)
    }

    fn ticks_below(&self, root: &Area) -> Drawn {
        let [_, top, _, bottom] = self.frame;
        let centred = style(INK).pos(Pos::new(HPos::Center, VPos::Center));
        let mut free_from = i32::MIN;
        for (number, text) in &self.x.ticks {
            let x = self.x_of(*number);
            root.draw(&PathElement::new(vec![(x, top), (x, bottom)], GRID))?;
            if x - width(text) / 2 >= free_from {
                root.draw_text(text, &centred, (x, bottom + 12))?;
                free_from = x + width(text) / 2 + 6;
            }
        }
        Ok(())
    }

    fn ticks_beside(&self, root: &Area) -> Drawn {
        let [left, _, right, _] = self.frame;
        let beside = style(INK).pos(Pos::new(HPos::Right, VPos::Center));
        let mut free_until = i32::MAX;
        for (number, text) in &self.y.ticks {
            let y = self.y_of(*number);
            root.draw(&PathElement::new(vec![(left, y), (right, y)], GRID))?;
            if y + TEXT / 2 <= free_until {
                root.draw_text(text, &beside, (left - 6, y))?;
                free_until = y - TEXT / 2 - 2;
            }
        }
        Ok(())
    }

    /// Where a point is.
    pub fn pixel(&self, x: f64, y: f64) -> (i32, i32) {
        (self.x_of(x), self.y_of(y))
    }

    fn x_of(&self, number: f64) -> i32 {
        let [left, _, right, _] = self.frame;
        left + (self.x.share(number) * f64::from(right - left)).round() as i32
    }

    fn y_of(&self, number: f64) -> i32 {
        let [_, top, _, bottom] = self.frame;
        bottom - (self.y.share(number) * f64::from(bottom - top)).round() as i32
    }
}

/// Why something is not drawn.
pub type Failure = DrawingAreaErrorKind<std::io::Error>;

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(numbers: [f64; 2]) -> Vec<String> {
        let axis = Axis::logarithmic("", numbers);
        axis.ticks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn every_range_has_ticks() {
        assert_eq!(
            ticks([0.9, 1.1]),
            ["0.9", "1", "1.1"].map(str::to_owned)[1..]
        );
        assert_eq!(ticks([1.0, 2.0]), ["1", "1.5", "2"]);
        assert_eq!(ticks([0.3, 12.0]), ["0.5", "1", "2", "5", "10"]);
        assert_eq!(ticks([0.001, 1000.0]).len(), 7);
    }

    #[test]
    fn no_number_at_all_is_a_range() {
        assert_eq!(range([]), [1.0; 2]);
        assert_eq!(range([f64::NAN, 0.0, 3.0]), [3.0; 2]);
    }
}
