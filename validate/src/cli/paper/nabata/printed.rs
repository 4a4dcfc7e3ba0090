//! What Nabata 2013 prints in Figs. 4 to 7: milliseconds without and with ray sampling.

use crate::cli::source::generated;
use RayType::{AmbientOcclusion, Diffuse, Dof, Primary, Reflection, ShadowArea, ShadowPoint};
use dacrt::workloads::{GENERATED_CAMERAS, RayType};
use dacrt_validate::results::CellKey;

/// Samples a pixel of the printed sizes, 512² to 4096²: all are pictures of 512 × 512 pixels.
pub const SAMPLES: [u32; 4] = [1, 4, 16, 64];
/// Width and height in pixels.
pub const SIDE: u32 = 512;

/// A column of a table: one picture at all sizes.
pub struct Column {
    pub figure: u32,
    pub case: &'static str,
    /// As the paper calls it; none if it does not say.
    pub scene: Option<&'static str>,
    /// Our scene and camera. The camera is not the paper's, which prints none.
    pub ours: Option<(&'static str, &'static str)>,
    /// The batches that make the picture.
    pub rays: &'static [RayType],
    /// Milliseconds without and with ray sampling, for each of [`SAMPLES`].
    pub ms: [[f64; 2]; 4],
    /// The size whose numbers contradict each other in print.
    pub unsound: Option<usize>,
}

const LIT: &[RayType] = &[Primary, ShadowPoint];
const REFLECTED: &[RayType] = &[Primary, Reflection, ShadowPoint];
const REFLECTED_AREA: &[RayType] = &[Primary, Reflection, ShadowArea];
const OCCLUDED: &[RayType] = &[Primary, AmbientOcclusion];
/// Of depth of field.
const PATHS_3: &[RayType] = &[Dof, Diffuse(1), Diffuse(2), Diffuse(3)];
const PATHS_8: &[RayType] = &[
    Primary,
    Diffuse(1),
    Diffuse(2),
    Diffuse(3),
    Diffuse(4),
    Diffuse(5),
    Diffuse(6),
    Diffuse(7),
    Diffuse(8),
];

/// All columns in the order of print.
pub const COLUMNS: [Column; 12] = [
    Column {
        figure: 4,
        case: "(a) point light",
        scene: Some("Sibenik"),
        ours: Some(("sibenik", "nave")),
        rays: REFLECTED,
        ms: [
            [415.0, 295.0],
            [1520.0, 1003.0],
            [5992.0, 3759.0],
            [27300.0, 14700.0],
        ],
        unsound: None,
    },
    Column {
        figure: 4,
        case: "(b) point light",
        scene: Some("Sibenik"),
        ours: Some(("sibenik", "chancel")),
        rays: REFLECTED,
        ms: [
            [281.0, 183.0],
            [1130.0, 700.0],
            [4656.0, 2647.0],
            [19772.0, 11330.0],
        ],
        unsound: None,
    },
    Column {
        figure: 4,
        case: "(c) area light",
        scene: Some("Sibenik"),
        ours: Some(("sibenik", "aisle")),
        rays: REFLECTED_AREA,
        ms: [
            [374.0, 255.0],
            [1430.0, 860.0],
            [5730.0, 3164.0],
            [22269.0, 11491.0],
        ],
        unsound: None,
    },
    Column {
        figure: 5,
        case: "(a) point light",
        scene: None,
        ours: None,
        rays: LIT,
        ms: [
            [110.0, 110.0],
            [331.0, 334.0],
            [1236.0, 1130.0],
            [5075.0, 4219.0],
        ],
        unsound: None,
    },
    Column {
        figure: 5,
        case: "(b) AO",
        scene: None,
        ours: None,
        rays: OCCLUDED,
        ms: [
            [446.0, 365.0],
            [1716.0, 1217.0],
            [6948.0, 4359.0],
            [29439.0, 19300.0],
        ],
        unsound: None,
    },
    Column {
        figure: 5,
        case: "(c) PT and DOF",
        scene: Some("San Miguel"),
        ours: Some(("sanmiguel-tables", "patio-lens")),
        rays: PATHS_3,
        ms: [
            [17319.0, 16876.0],
            [27725.0, 26435.0],
            [67253.0, 59893.0],
            [215805.0, 173018.0],
        ],
        unsound: None,
    },
    Column {
        figure: 6,
        case: "(a) point light",
        scene: Some("Conference"),
        ours: Some(("conference", "room")),
        rays: LIT,
        ms: [
            [234.0, 189.0],
            [803.0, 602.0],
            [3113.0, 2182.0],
            [12784.0, 8930.0],
        ],
        unsound: None,
    },
    Column {
        figure: 6,
        case: "(b) point light",
        scene: Some("Conference"),
        ours: Some(("conference", "door")),
        rays: LIT,
        ms: [
            [273.0, 189.0],
            [1030.0, 671.0],
            [5992.0, 2636.0],
            [17987.0, 10618.0],
        ],
        unsound: Some(2),
    },
    Column {
        figure: 6,
        case: "(c) path tracing",
        scene: Some("Conference"),
        ours: Some(("conference", "table")),
        rays: PATHS_8,
        ms: [
            [1208.0, 1071.0],
            [3936.0, 3279.0],
            [15533.0, 12316.0],
            [65117.0, 47761.0],
        ],
        unsound: None,
    },
    Column {
        figure: 7,
        case: "(a) point light",
        scene: Some("Sponza"),
        ours: Some(("sponza", "atrium")),
        rays: LIT,
        ms: [
            [661.0, 478.0],
            [2298.0, 1428.0],
            [8801.0, 5056.0],
            [35397.0, 19657.0],
        ],
        unsound: None,
    },
    Column {
        figure: 7,
        case: "(b) point light",
        scene: Some("Sponza"),
        ours: Some(("sponza", "gallery")),
        rays: LIT,
        ms: [
            [599.0, 448.0],
            [2213.0, 1471.0],
            [8774.0, 5363.0],
            [35643.0, 20548.0],
        ],
        unsound: Some(0),
    },
    Column {
        figure: 7,
        case: "(c) path tracing",
        scene: Some("Sponza"),
        ours: Some(("sponza", "arcade")),
        rays: PATHS_8,
        ms: [
            [2853.0, 2331.0],
            [8288.0, 7066.0],
            [31960.0, 23779.0],
            [136327.0, 98228.0],
        ],
        unsound: None,
    },
];

impl Column {
    /// `Fig. 4 Sibenik (a) point light`.
    pub fn name(&self) -> String {
        let scene = self.scene.unwrap_or("(scene not named)");
        format!("Fig. {} {scene} {}", self.figure, self.case)
    }

    /// `Fig. 4 (a) Sibenik`.
    pub fn short_name(&self) -> String {
        let case = self.case.split(' ').next().unwrap_or_default();
        let scene = self.scene.unwrap_or("(scene not named)");
        format!("Fig. {} {case} {scene}", self.figure)
    }

    /// Why there is nothing beside the paper's numbers.
    pub fn why_not(&self) -> String {
        match self.ours {
            None => "the paper does not say which scene this is".to_owned(),
            Some((scene, _)) => format!("no mesh of {scene}, or not a whole picture"),
        }
    }

    /// Whether a camera is one of those that the program makes for this picture.
    pub fn has_generated(&self, camera: &str) -> bool {
        let with_lens = self.rays.contains(&Dof);
        (1..=GENERATED_CAMERAS as u32).any(|n| generated(n, with_lens) == camera)
    }

    /// Whether a batch is one of the picture's.
    pub fn has(&self, key: &CellKey) -> bool {
        self.ours.is_some_and(|(scene, own)| {
            key.scene == scene
                && (key.camera == own || self.has_generated(&key.camera))
                && self.rays.iter().any(|rays| rays.to_string() == key.rays)
        })
    }

    /// Time without ray sampling over time with it, for each of [`SAMPLES`].
    pub fn ratios(&self) -> [f64; 4] {
        self.ms.map(|[without, with]| without / with)
    }

    /// Whether the picture is one of paths of many bounces.
    pub fn is_of_paths(&self) -> bool {
        self.rays.contains(&Diffuse(1))
    }
}

/// The picture of the ablation of section 5: Fig. 4 (a), at 64 samples a pixel.
pub const ABLATION: usize = 0;
/// Seconds without ray sampling there.
pub const ABLATION_WITHOUT: f64 = 27.3;

/// Million rays a second of the path tracing of Fig. 6 (c): without ray sampling (Áfra 2012, on a
/// faster processor) and with it.
pub const RATES: [f64; 2] = [2.0, 2.4];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::source::SceneSource;

    #[test]
    fn printed_ratios() {
        let ratio = |column: usize, size: usize| COLUMNS[column].ratios()[size];
        approx::assert_relative_eq!(ratio(0, 0), 1.41, max_relative = 0.005);
        approx::assert_relative_eq!(ratio(2, 3), 1.94, max_relative = 0.005);
        approx::assert_relative_eq!(ratio(11, 3), 1.39, max_relative = 0.005);
        // The two that contradict the ratios printed beside them.
        let unsound = COLUMNS.iter().filter_map(|c| Some((c.name(), c.unsound?)));
        let unsound: Vec<_> = unsound.collect();
        let expected = [
            ("Fig. 6 Conference (b) point light".to_owned(), 2),
            ("Fig. 7 Sponza (b) point light".to_owned(), 0),
        ];
        assert_eq!(unsound, expected);
    }

    #[test]
    fn our_cameras_are_there_and_the_scenes_have_what_the_rays_need() {
        for column in &COLUMNS {
            let Some((scene, camera)) = column.ours else {
                continue;
            };
            let source = SceneSource::find(scene).unwrap();
            source.cameras(&[camera.to_owned()]).unwrap();
            for &rays in column.rays {
                source.allows(Some(camera), rays).unwrap();
            }
        }
    }
}
