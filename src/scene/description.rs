//! What a scene is made of: the files `scenes/NAME.json`.
//!
//! ```json
//! {
//!   "about": "Sibenik cathedral, interior",
//!   "meshes": [{ "file": "sibenik.obj.gz" }],
//!   "cameras": [
//!     { "name": "nave", "eye": [-15, -5, 0], "look_at": [0, -8, 0], "up": [0, 1, 0], "fov_degrees": 60 }
//!   ],
//!   "lights": [{ "type": "point", "position": [0, -2, 0] }],
//!   "mirrors": [{ "plane": { "point": [0, -15.3, 0], "normal": [0, 1, 0] } }],
//!   "rays": ["primary", "shadow-point", "diffuse-1"]
//! }
//! ```
//!
//! | key | meaning |
//! |---|---|
//! | `about` | one line for lists of scenes; may be left out |
//! | `meshes` | at least one; their triangles are numbered one mesh after the other. Either `{ "file": NAME }`, an OBJ or PLY file, plain or gzip, looked for beside the JSON and then in the mesh folders; or `{ "generator": NAME, "triangles": N, "seed": N }` |
//! | `cameras` | at least one, each with a name of its own; the first is the default. `fov_degrees` is the vertical field of view, more than 0 and less than 180; `up` need not be at right angles to the view, nor of length 1. A `lens` may be left out: `{ "radius": R, "focus": DISTANCE }` for `dof` rays, from which secondary rays then start |
//! | `lights` | may be left out. A light has a `type`: `point`, with a `position`, of which the first is that of `shadow-point` rays; or `area`, a parallelogram with a `corner` and two `edges` that start there, of which the first is that of `shadow-area` rays |
//! | `mirrors` | may be left out; what `reflection` rays come off: the triangles in a plane, `{ "plane": { "point": P, "normal": N } }`, or some by their numbers, `{ "triangles": [FIRST, END] }` without `END`; those of a mesh have numbers in a row |
//! | `rays` | the ray types that the scene is for, at least one: names of [`RAY_TYPES`] |
//! | `$schema` | for editors, which then complete and check the file: `"./scene.schema.json"`, the JSON Schema of this format; not read here, and may be left out |
//!
//! Coordinates are in the units of the meshes and smaller in size than 1.844e18. An unknown key is
//! an error.

use super::loaders::MOST_TRIANGLES;
use super::nearest::no_such;
use super::{SceneError, generators};
use crate::geometry::COORDINATE_LIMIT;
#[cfg(feature = "schema")]
use crate::workloads::FOV_LIMIT;
use crate::workloads::{self, AreaLight, WorkloadError};
use glam::DVec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The ray types that a scene can be for.
pub const RAY_TYPES: [&str; 15] = [
    "primary",
    "shadow-point",
    "shadow-area",
    "reflection",
    "ambient-occlusion",
    "dof",
    "diffuse-1",
    "diffuse-2",
    "diffuse-3",
    "diffuse-4",
    "diffuse-5",
    "diffuse-6",
    "diffuse-7",
    "diffuse-8",
    "random",
];

/// The content of a scene's JSON file; see the [module](self) for the format.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(
        with = "Keys",
        title = "Scene description",
        description = "A scene for divide-and-conquer ray tracing: meshes, cameras and lights."
    )
)]
pub struct Description {
    /// One line for lists of scenes; may be empty.
    pub about: String,
    /// At least one.
    pub meshes: Vec<MeshSource>,
    /// At least one; the first is the default.
    pub cameras: Vec<Camera>,
    /// May be empty.
    pub lights: Vec<Light>,
    /// May be empty.
    pub mirrors: Vec<Mirror>,
    /// Names out of [`RAY_TYPES`].
    pub rays: Vec<String>,
}

/// Where the triangles of a mesh come from.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename_all = "kebab-case", deny_unknown_fields)
)]
pub enum MeshSource {
    /// A mesh file, found by [`locate`](super::locate).
    File(#[cfg_attr(feature = "schema", schemars(length(min = 1)))] PathBuf),
    /// A generator of this program.
    #[cfg_attr(feature = "schema", schemars(untagged))]
    Generator {
        /// One of [`generators::NAMES`].
        #[cfg_attr(feature = "schema", schemars(rename = "generator", extend("enum" = generators::NAMES)))]
        name: String,
        /// About how many triangles to make; more than 0.
        #[cfg_attr(feature = "schema", schemars(range(min = 1, max = MOST_TRIANGLES)))]
        triangles: usize,
        /// Of the random choices.
        seed: u64,
    },
}

/// A pinhole camera, or one with a thin lens.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Unique in its scene.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub name: String,
    /// Where the rays start.
    #[cfg_attr(feature = "schema", schemars(extend("items" = coordinate())))]
    pub eye: [f64; 3],
    /// A point in the middle of the picture; not the eye.
    #[cfg_attr(feature = "schema", schemars(extend("items" = coordinate())))]
    pub look_at: [f64; 3],
    /// Points to the upper edge of the picture; of any length but 0, not parallel to the view.
    #[cfg_attr(feature = "schema", schemars(extend("items" = coordinate())))]
    pub up: [f64; 3],
    /// Vertical field of view, in degrees: more than 0 and less than 180.
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = FOV_LIMIT)))]
    pub fov_degrees: f64,
    /// For depth of field.
    pub lens: Option<Lens>,
}

/// A thin lens around the eye.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Lens {
    /// In the units of the meshes; more than 0.
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub radius: f64,
    /// Distance of what is sharp from the eye, along the view; more than 0.
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub focus: f64,
}

/// A light.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Light {
    /// Shines from a point to all sides.
    Point {
        /// The point.
        #[cfg_attr(feature = "schema", schemars(extend("items" = coordinate())))]
        position: [f64; 3],
    },
    /// Shines from a parallelogram.
    Area {
        /// One of its corners.
        #[cfg_attr(feature = "schema", schemars(extend("items" = coordinate())))]
        corner: [f64; 3],
        /// From there to the two corners beside it.
        edges: [[f64; 3]; 2],
    },
}

/// Triangles that reflect.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Mirror {
    /// All triangles in a plane.
    Plane {
        /// A point of the plane.
        #[cfg_attr(feature = "schema", schemars(extend("items" = coordinate())))]
        point: [f64; 3],
        /// Of any length but 0.
        normal: [f64; 3],
    },
    /// The triangles from the first number to that before the second.
    Triangles([u32; 2]),
}

/// The keys of the file as they stand in it.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Keys {
    /// One line for lists of scenes.
    #[serde(default)]
    about: String,
    /// Triangles are numbered one mesh after the other.
    #[cfg_attr(
        feature = "schema",
        schemars(with = "Vec<MeshSource>", length(min = 1))
    )]
    meshes: Vec<MeshKeys>,
    /// The first is the default.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    cameras: Vec<Camera>,
    /// What shines; `shadow-point` rays need a point light, `shadow-area` rays an area light.
    #[serde(default)]
    lights: Vec<Light>,
    /// What `reflection` rays come off.
    #[serde(default)]
    mirrors: Vec<Mirror>,
    /// The ray types that the scene is for.
    #[cfg_attr(
        feature = "schema",
        schemars(length(min = 1), extend("items" = { "type": "string", "enum": RAY_TYPES }))
    )]
    rays: Vec<String>,
    /// The JSON Schema of this file, for editors.
    #[serde(rename = "$schema", default)]
    _schema: String,
}

/// The keys of a mesh: those of one kind or those of the other.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshKeys {
    file: Option<PathBuf>,
    generator: Option<String>,
    triangles: Option<usize>,
    seed: Option<u64>,
}

impl MeshKeys {
    fn source(self) -> Option<MeshSource> {
        match (self.file, self.generator, self.triangles, self.seed) {
            (Some(file), None, None, None) => Some(MeshSource::File(file)),
            (None, Some(name), Some(triangles), Some(seed)) => Some(MeshSource::Generator {
                name,
                triangles,
                seed,
            }),
            _ => None,
        }
    }
}

impl Description {
    /// Reads a scene's JSON file.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`]; [`SceneError::Json`] for what is no JSON of this format, with
    /// the line; [`SceneError::Invalid`] for a value that makes no sense, with its key.
    pub fn load(file: &Path) -> Result<Description, SceneError> {
        let text = std::fs::read(file).map_err(|source| SceneError::Unreadable {
            file: file.to_owned(),
            source,
        })?;
        Description::parse(file, &text)
    }

    /// As [`Description::load`], from the bytes of a file; `file` stands in messages only.
    ///
    /// # Errors
    /// As [`Description::load`].
    pub fn parse(file: &Path, text: &[u8]) -> Result<Description, SceneError> {
        let invalid = |(key, problem)| SceneError::Invalid {
            file: file.to_owned(),
            key,
            problem,
        };
        let keys: Keys =
            serde_json::from_slice(text).map_err(|error| SceneError::json(file, &error))?;
        let mut meshes = Vec::new();
        for (i, mesh) in keys.meshes.into_iter().enumerate() {
            meshes.push(mesh.source().ok_or_else(|| {
                invalid((
                    format!("meshes[{i}]"),
                    "expected the key `file`, or the keys `generator`, `triangles` and `seed`, \
                     found others or too few"
                        .to_owned(),
                ))
            })?);
        }
        let description = Description {
            about: keys.about,
            meshes,
            cameras: keys.cameras,
            lights: keys.lights,
            mirrors: keys.mirrors,
            rays: keys.rays,
        };
        description.check().map_err(invalid)?;
        Ok(description)
    }

    /// What rays need of the scene besides its meshes, seen by one of its cameras: the first light of
    /// each kind, and all mirrors.
    pub fn view(&self, camera: workloads::Camera) -> workloads::View {
        let vector = |v: [f64; 3]| DVec3::from(v);
        let point_light = self.lights.iter().find_map(|light| match light {
            Light::Point { position } => Some(vector(*position).as_vec3()),
            Light::Area { .. } => None,
        });
        let area_light = self.lights.iter().find_map(|light| match light {
            Light::Area { corner, edges } => Some(AreaLight {
                corner: vector(*corner),
                edges: edges.map(vector),
            }),
            Light::Point { .. } => None,
        });
        let mirrors = self.mirrors.iter().map(|mirror| match mirror {
            Mirror::Plane { point, normal } => workloads::Mirror::Plane {
                point: vector(*point),
                normal: vector(*normal),
            },
            Mirror::Triangles([first, end]) => workloads::Mirror::Triangles(*first..*end),
        });
        workloads::View {
            camera,
            point_light,
            area_light,
            mirrors: mirrors.collect(),
        }
    }

    /// Looks for values that make no sense; returns the key and what is wrong with it.
    fn check(&self) -> Result<(), (String, String)> {
        let at_least_one = |key: &str, count: usize| match count {
            0 => Err((
                key.to_owned(),
                "expected at least one, found none".to_owned(),
            )),
            _ => Ok(()),
        };
        at_least_one("meshes", self.meshes.len())?;
        at_least_one("cameras", self.cameras.len())?;
        at_least_one("rays", self.rays.len())?;

        for (i, mesh) in self.meshes.iter().enumerate() {
            mesh.check()
                .map_err(|(key, problem)| (format!("meshes[{i}].{key}"), problem))?;
        }
        for (i, camera) in self.cameras.iter().enumerate() {
            camera
                .check()
                .map_err(|(key, problem)| (format!("cameras[{i}]{key}"), problem))?;
            if self.cameras[..i].iter().any(|c| c.name == camera.name) {
                return Err((
                    format!("cameras[{i}].name"),
                    format!("expected a name of its own, found {:?} again", camera.name),
                ));
            }
        }
        for (i, light) in self.lights.iter().enumerate() {
            light
                .check()
                .map_err(|(key, problem)| (format!("lights[{i}].{key}"), problem))?;
        }
        for (i, mirror) in self.mirrors.iter().enumerate() {
            mirror
                .check()
                .map_err(|(key, problem)| (format!("mirrors[{i}].{key}"), problem))?;
        }
        for (i, rays) in self.rays.iter().enumerate() {
            if !RAY_TYPES.contains(&rays.as_str()) {
                return Err((format!("rays[{i}]"), no_such("ray type", rays, &RAY_TYPES)));
            }
        }
        Ok(())
    }
}

impl MeshSource {
    fn check(&self) -> Result<(), (&'static str, String)> {
        match self {
            MeshSource::File(file) if file.file_name().is_none() => Err((
                "file",
                format!("expected the name of a file, found \"{}\"", file.display()),
            )),
            MeshSource::File(_) => Ok(()),
            MeshSource::Generator { name, .. } if !generators::NAMES.contains(&name.as_str()) => {
                Err(("generator", no_such("generator", name, &generators::NAMES)))
            }
            MeshSource::Generator { triangles, .. } => {
                let most = MOST_TRIANGLES;
                if (1..=most).contains(triangles) {
                    Ok(())
                } else {
                    let problem = format!("expected a number from 1 to {most}, found {triangles}");
                    Err(("triangles", problem))
                }
            }
        }
    }
}

impl Camera {
    /// Looks for values that make no camera; returns the key and what is wrong with it.
    fn check(&self) -> Result<(), (&'static str, String)> {
        if self.name.is_empty() {
            return Err((".name", "expected a name, found \"\"".to_owned()));
        }
        check_point(&self.eye).map_err(|problem| (".eye", problem))?;
        check_point(&self.look_at).map_err(|problem| (".look_at", problem))?;
        check_point(&self.up).map_err(|problem| (".up", problem))?;
        (self.camera().map(|_| ())).map_err(|error| ("", error.to_string()))
    }

    /// The camera that makes rays.
    ///
    /// # Errors
    /// None for the camera of a description that was loaded.
    pub fn camera(&self) -> Result<workloads::Camera, WorkloadError> {
        let [eye, look_at, up] = [self.eye, self.look_at, self.up].map(DVec3::from);
        let camera = workloads::Camera::new(eye, look_at, up, self.fov_degrees)?;
        match self.lens {
            Some(Lens { radius, focus }) => camera.with_lens(workloads::Lens { radius, focus }),
            None => Ok(camera),
        }
    }
}

impl Light {
    /// Looks for values that make no light; returns the key and what is wrong with it.
    fn check(&self) -> Result<(), (&'static str, String)> {
        match self {
            Light::Point { position } => check_point(position).map_err(|p| ("position", p)),
            Light::Area { corner, edges } => {
                check_point(corner).map_err(|problem| ("corner", problem))?;
                (edges.iter().try_for_each(check_point)).map_err(|problem| ("edges", problem))
            }
        }
    }
}

impl Mirror {
    /// Looks for values that make no mirror; returns the key and what is wrong with it.
    fn check(&self) -> Result<(), (&'static str, String)> {
        match self {
            Mirror::Plane { point, normal } => {
                check_point(point).map_err(|problem| ("plane.point", problem))?;
                check_point(normal).map_err(|problem| ("plane.normal", problem))?;
                match DVec3::from(*normal).try_normalize() {
                    Some(_) => Ok(()),
                    None => Err((
                        "plane.normal",
                        format!("expected a vector that has a direction, found {normal:?}"),
                    )),
                }
            }
            Mirror::Triangles([first, end]) if first >= end => Err((
                "triangles",
                format!("expected a first number below the second, found {first} and {end}"),
            )),
            Mirror::Triangles(_) => Ok(()),
        }
    }
}

/// The JSON Schema of what [`check_point`] accepts.
#[cfg(feature = "schema")]
fn coordinate() -> serde_json::Value {
    let limit = f64::from(COORDINATE_LIMIT);
    serde_json::json!({ "type": "number", "exclusiveMinimum": -limit, "exclusiveMaximum": limit })
}

fn check_point(point: &[f64; 3]) -> Result<(), String> {
    if point.iter().all(|x| x.abs() < f64::from(COORDINATE_LIMIT)) {
        Ok(())
    } else {
        Err(format!(
            "expected numbers smaller in size than {COORDINATE_LIMIT:e}, found {point:?}"
        ))
    }
}
