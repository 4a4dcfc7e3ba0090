//! Fig. 8 of Mora 2011: tests and times with and without conic packets, for primary rays and with
//! one light.

use crate::cli::paper::interval;
use crate::cli::text::columns;
use dacrt_validate::results::Cell;
use dacrt_validate::statistics::paired_ratio;

/// Pixels.
pub const SIZE: [u32; 2] = [1280, 800];

/// Least and greatest value over the four scenes of the printed figure: Erw6 (806 triangles),
/// Conference (282,000), Blade (1,760,000) and one without a name.
type Range = [f64; 2];

/// A group of columns as printed.
struct Printed {
    fps: Range,
    /// Ray/box, cone/box, triangle/box, ray/triangle, nodes.
    counts: [Range; 5],
}

const BASIC: Printed = Printed {
    fps: [1.13, 4.2],
    counts: [
        [27.5e6, 66.5e6],
        [0.0, 0.0],
        [32e3, 154e6],
        [10.2e6, 23e6],
        [888.0, 208e3],
    ],
};
const CONES: Printed = Printed {
    fps: [1.5, 16.1],
    counts: [
        [2e3, 6.73e6],
        [486e3, 1.7e6],
        [37e3, 167e6],
        [5.1e6, 14.7e6],
        [6e3, 212e3],
    ],
};
const CONES_AND_LIGHT: Printed = Printed {
    fps: [0.62, 6.2],
    counts: [
        [1.9e6, 17.3e6],
        [850e3, 3.2e6],
        [68e3, 419e6],
        [12e6, 23.8e6],
        [8.2e3, 371e3],
    ],
};
/// Quotients of the printed figures: ray/box + cone/box and time of basic over cones, and of
/// basic ray/box per pixel.
const CUT_IN_TESTS: Range = [3.81, 26.8];
const CUT_IN_TIME: Range = [1.33, 3.83];
const RAY_BOX_A_RAY: Range = [26.9, 64.9];
/// Of the three scenes with a name.
const TRIANGLES_A_PIXEL: Range = [0.000_787, 1.72];

/// The names of the counters in [`Printed::counts`].
const COUNTERS: [&str; 5] = [
    "ray_box",
    "cone_box",
    "triangle_box",
    "ray_triangle",
    "nodes",
];
const RAY_BOX: usize = 0;
const CONE_BOX: usize = 1;

/// The figure as measured.
#[derive(Default)]
pub struct Figure {
    size: [u32; 2],
    /// In the order that they are printed in.
    scenes: Vec<Scene>,
}

/// What was measured in one scene.
#[derive(Default)]
struct Scene {
    name: String,
    /// `mora2011` and `mora2011-cones`.
    primary: Vec<Cell>,
    /// `mora2011-cones`.
    light: Vec<Cell>,
}

/// What a picture took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Work {
    /// None if the hits are wrong.
    ms: Option<f64>,
    /// Likewise with flat shading; none, too, where that was not measured.
    shaded_ms: Option<f64>,
    /// As [`COUNTERS`].
    counts: [f64; 5],
}

impl Work {
    fn of(cell: &Cell) -> Work {
        // A batch without rays takes no time.
        let ms = (!cell.is_wrong()).then_some(cell.median_ms.unwrap_or(0.0));
        // Shadow rays are shaded with what they start from.
        let shading = if cell.any_hit {
            Some(0.0)
        } else {
            cell.shade_ms
        };
        Work {
            ms,
            shaded_ms: ms.zip(shading).map(|(ms, shading)| ms + shading),
            counts: COUNTERS.map(|name| cell.counters[name].as_f64().unwrap_or(f64::NAN)),
        }
    }

    fn and(self, other: Work) -> Work {
        let sum = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a + b);
        Work {
            ms: sum(self.ms, other.ms),
            shaded_ms: sum(self.shaded_ms, other.shaded_ms),
            counts: std::array::from_fn(|i| self.counts[i] + other.counts[i]),
        }
    }

    fn box_tests(&self) -> f64 {
        self.counts[RAY_BOX] + self.counts[CONE_BOX]
    }
}

impl Figure {
    /// The figure of cells of which some are others'; those of the size and precision of the first of
    /// `mora2011` count, which no other figure has. None without one.
    pub fn of(cells: &[Cell]) -> Figure {
        let mut figure = Figure::default();
        let is_basic = |cell: &&Cell| cell.key.method == "mora2011" && cell.key.rays == "primary";
        let Some(first) = cells.iter().find(is_basic).map(|cell| &cell.key) else {
            return figure;
        };
        figure.size = first.resolution;
        for cell in cells {
            let key = &cell.key;
            if (key.resolution, &key.precision) != (first.resolution, &first.precision) {
                continue;
            }
            let place = match figure.scenes.iter().position(|s| s.name == key.scene) {
                Some(place) => place,
                None => {
                    figure.scenes.push(Scene {
                        name: key.scene.clone(),
                        ..Scene::default()
                    });
                    figure.scenes.len() - 1
                }
            };
            let scene = &mut figure.scenes[place];
            match (key.rays.as_str(), key.method.as_str()) {
                ("primary", "mora2011" | "mora2011-cones") => scene.primary.push(cell.clone()),
                ("shadow-point", "mora2011-cones") => scene.light.push(cell.clone()),
                _ => {}
            }
        }
        figure
    }

    /// Whether no scene has all of its cells.
    pub fn is_empty(&self) -> bool {
        let whole = |s: &Scene| s.primary.len() == 2 && s.light.len() == 1;
        !self.scenes.iter().any(whole)
    }

    /// For each scene what cones save in box tests and in time, ray/box tests a ray without them, and
    /// triangles a pixel.
    pub fn cuts(&self) -> Vec<Vec<String>> {
        let [width, height] = self.size.map(f64::from);
        let row = |scene: &Scene| {
            let ([basic, cones], [_]) = (&scene.primary[..], &scene.light[..]) else {
                return vec![scene.name.clone(), "not measured".to_owned()];
            };
            let time = (basic.samples_ms.as_ref().zip(cones.samples_ms.as_ref()))
                .and_then(|(basic, cones)| paired_ratio(basic, cones));
            let triangles = basic.triangles as f64 / (width * height);
            let rays = basic.ray_count as f64;
            let (basic, cones) = (Work::of(basic), Work::of(cones));
            vec![
                scene.name.clone(),
                short(basic.box_tests() / cones.box_tests()),
                time.map_or("-".to_owned(), |time| interval(&time)),
                short(basic.counts[RAY_BOX] / rays),
                short(triangles),
            ]
        };
        self.scenes.iter().map(row).collect()
    }

    /// The same in print, from the least to the greatest.
    pub fn printed_cuts() -> Vec<String> {
        let printed = [CUT_IN_TESTS, CUT_IN_TIME, RAY_BOX_A_RAY, TRIANGLES_A_PIXEL];
        let ranges = printed.into_iter().map(range);
        std::iter::once("Mora 2011".to_owned())
            .chain(ranges)
            .collect()
    }

    /// The figure for people, 100 columns at most; `missing` are scenes without a mesh.
    pub fn text(&self, missing: &[String]) -> String {
        let [width, height] = self.size;
        let row = |cells: &[&str]| cells.iter().map(|s| s.to_string()).collect::<Vec<_>>();
        let mut work = vec![row(&[
            "scene", "rays", "fps", "shaded", "ray/box", "cone/box", "tri./box", "ray/tri.",
            "nodes",
        ])];
        let mut cuts = vec![
            row(&["scene", "box tests", "time", "ray/box", "triangles"]),
            row(&[
                "",
                "basic/cones",
                "basic/cones [95 %]",
                "a ray, basic",
                "a pixel",
            ]),
        ];
        cuts.extend(self.cuts());
        for scene in &self.scenes {
            let ([basic, cones], [light]) = (&scene.primary[..], &scene.light[..]) else {
                work.push(row(&[&scene.name, "not measured"]));
                continue;
            };
            let (basic, cones, light) = (Work::of(basic), Work::of(cones), Work::of(light));
            let lines = [
                ("basic", basic),
                ("cones", cones),
                ("cones, 1 light", cones.and(light)),
            ];
            for (i, (name, done)) in lines.into_iter().enumerate() {
                let scene = if i == 0 { scene.name.as_str() } else { "" };
                let fps = done.ms.map_or("WRONG".to_owned(), |ms| short(1e3 / ms));
                let shaded = done.shaded_ms.map_or("-".to_owned(), |ms| short(1e3 / ms));
                let counts = done.counts.map(short);
                work.push([row(&[scene, name, &fps, &shaded]), counts.to_vec()].concat());
            }
        }
        for scene in missing {
            work.push(row(&[scene, "no mesh"]));
            cuts.push(row(&[scene, "no mesh"]));
        }
        let mut print = vec![row(&[
            "", "rays", "shaded", "ray/box", "cone/box", "tri./box", "ray/tri.", "nodes",
        ])];
        let printed = [
            ("Mora 2011", "basic", BASIC),
            ("", "cones", CONES),
            ("", "cones, 1 light", CONES_AND_LIGHT),
        ];
        for (scene, name, printed) in printed {
            let counts = printed.counts.map(range);
            let fps = range(printed.fps);
            print.push([row(&[scene, name, &fps]), counts.to_vec()].concat());
        }
        cuts.push(Figure::printed_cuts());
        format!(
            "Fig. 8: rays in conic packets; {} x {} pixels (Mora 2011: 1280 x 800)\n\n{}\n{}\n{}{NOTES}",
            width,
            height,
            columns(&work, &[2, 3, 4, 5, 6, 7, 8]),
            columns(&print, &[2, 3, 4, 5, 6, 7]),
            columns(&cuts, &[1, 2, 3, 4]),
        )
    }
}

/// What has to be known of the figures.
const NOTES: &str = "
fps: 1000 over the milliseconds of our traces, one thread; shaded: with flat shading, as Mora's,
which are of one thread of a 3 GHz Core 2. `1 light` adds shadow rays from a point light. Mora's
figures are ranges over four scenes (triangles a pixel: over the three with a name), not targets:
the cameras are unpublished, Conference is another version (282,000 triangles), the other scenes are
not at hand.
";

/// Least and greatest, or one of them if they are the same: `888-208k`.
fn range([least, greatest]: Range) -> String {
    match least == greatest {
        true => short(least),
        false => format!("{}-{}", short(least), short(greatest)),
    }
}

/// Three digits that count, six columns at most: `0`, `0.275`, `27.5`, `888`, `208k`, `66.5M`.
pub fn short(x: f64) -> String {
    let (x, unit) = match x {
        _ if x < 999.5 => (x, ""),
        _ if x < 999.5e3 => (x / 1e3, "k"),
        _ if x < 999.5e6 => (x / 1e6, "M"),
        _ => (x / 1e9, "G"),
    };
    match x {
        0.0 => "0".to_owned(),
        _ if x < 0.000_999_5 => format!("{x:.5}"),
        _ if x < 0.099_95 => format!("{x:.4}"),
        _ if x < 0.9995 => format!("{x:.3}"),
        _ if x < 9.995 => format!("{x:.2}{unit}"),
        _ if x < 99.95 => format!("{x:.1}{unit}"),
        _ => format!("{x:.0}{unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let numbers = [
            0.0, 0.000_787, 0.275, 0.9996, 9.996, 99.96, 888.0, 999.6, 999_600.0,
        ];
        let expected = [
            "0", "0.00079", "0.275", "1.00", "10.0", "100", "888", "1.00k", "1.00M",
        ];
        assert_eq!(numbers.map(short), expected);
        assert_eq!(
            [27.5e6, 419e6, 1.5e9].map(short),
            ["27.5M", "419M", "1.50G"]
        );
        assert_eq!([range([0.0; 2]), range([888.0, 208e3])], ["0", "888-208k"]);
    }

    #[test]
    fn times_of_two_batches_are_added_if_both_are_right() {
        let work = |ms, n| Work {
            ms,
            shaded_ms: ms,
            counts: [n; 5],
        };
        let both = work(Some(1.0), 3.0).and(work(Some(0.5), 4.0));
        assert_eq!(both, work(Some(1.5), 7.0));
        assert_eq!(both.box_tests(), 14.0);
        assert_eq!(work(Some(1.0), 3.0).and(work(None, 4.0)).ms, None);
    }
}
