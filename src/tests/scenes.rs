//! The scene descriptions of the repository, and what is said of bad ones.

use dacrt::scene::{
    self, Description, Lens, Light, MeshSource, Mirror, Scene, SceneError, description,
};
use dacrt::workloads::{self, RayType};
use glam::{DVec3, Vec3};
use std::fs;
use std::path::{Path, PathBuf};

const REAL: [&str; 16] = [
    "armadillo",
    "bunny",
    "buddha",
    "conference",
    "cornell",
    "dragon",
    "hand",
    "kitchen",
    "lucy",
    "sanmiguel",
    "sanmiguel-tables",
    "sibenik",
    "sponza",
    "sponza-crytek",
    "sponza-dabrovic",
    "toasters",
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

#[test]
fn every_real_scene_is_described() {
    let names = scene::names(&folder()).unwrap();
    for name in REAL {
        assert!(names.iter().any(|n| n == name), "{name}");
    }
}

#[test]
fn every_description_is_valid_and_has_a_point_light() {
    for name in scene::names(&folder()).unwrap() {
        let path = scene::find(&name, &folder()).unwrap();
        let description = Description::load(&path).unwrap_or_else(|e| panic!("{e}"));
        assert!(!description.about.is_empty(), "{name}");
        let is_point = |light: &Light| matches!(light, Light::Point { .. });
        assert!(description.lights.iter().any(is_point), "{name}");
    }
}

#[test]
fn scenes_at_hand_load() {
    let folders: Vec<PathBuf> = std::env::var_os("DACRT_MESHES")
        .map(|list| std::env::split_paths(&list).collect())
        .unwrap_or_default();
    for name in [
        "sibenik",
        "cornell",
        "toasters",
        "sponza",
        "sanmiguel-tables",
    ] {
        match Scene::load(&scene::find(name, &folder()).unwrap(), &folders) {
            Ok(scene) => {
                assert_eq!(scene.name, name);
                let expected = match name {
                    "sibenik" => 75_284,
                    "cornell" => 36,
                    "toasters" => 11_141,
                    "sponza" => 262_267,
                    _ => 1_012_685 + 3_782_866,
                };
                assert_eq!(scene.mesh.len(), expected);
            }
            Err(SceneError::MissingMesh { file, .. }) => {
                println!("notice: mesh {} not at hand", file.display());
            }
            Err(error) => panic!("{error}"),
        }
    }
}

/// The message for a description that is `GOOD` with one piece replaced.
fn error(good: &str, bad: &str) -> String {
    assert!(GOOD.contains(good), "{good}");
    let message = Description::parse(Path::new("s.json"), GOOD.replacen(good, bad, 1).as_bytes())
        .expect_err(bad)
        .to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

const GOOD: &str = r#"{
  "meshes": [
    { "file": "a.obj" },
    { "generator": "hall", "triangles": 100, "seed": 1 }
  ],
  "cameras": [
    { "name": "front", "eye": [0, 1, 2], "look_at": [0, 1, 0], "up": [0, 1, 0], "fov_degrees": 60 },
    { "name": "side", "eye": [9, 1, 2], "look_at": [0, 1, 0], "up": [0, 5, 0], "fov_degrees": 0.5, "lens": { "radius": 0.25, "focus": 3 } }
  ],
  "lights": [{ "type": "point", "position": [0, 0, 1.5] }, { "type": "area", "corner": [1, 2, 3], "edges": [[4, 0, 0], [0, 0, 5]] }], "mirrors": [{ "plane": { "point": [0, -1, 0], "normal": [0, 2, 0] } }, { "triangles": [3, 7] }],
  "rays": ["primary", "diffuse-8"]
}"#;

#[test]
fn a_good_description_says_what_stands_in_it() {
    let description = Description::parse(Path::new("s.json"), GOOD.as_bytes()).unwrap();
    let made = MeshSource::Generator {
        name: "hall".into(),
        triangles: 100,
        seed: 1,
    };
    assert_eq!(description.meshes, [MeshSource::File("a.obj".into()), made]);
    assert_eq!(description.cameras[1].name, "side");
    assert_eq!(description.cameras[1].eye, [9.0, 1.0, 2.0]);
    assert_eq!(description.cameras[1].fov_degrees, 0.5);
    let lens = Lens {
        radius: 0.25,
        focus: 3.0,
    };
    assert_eq!(description.cameras[0].lens, None);
    assert_eq!(description.cameras[1].lens, Some(lens));
    let point = Light::Point {
        position: [0.0, 0.0, 1.5],
    };
    let area = Light::Area {
        corner: [1.0, 2.0, 3.0],
        edges: [[4.0, 0.0, 0.0], [0.0, 0.0, 5.0]],
    };
    assert_eq!(description.lights, [point, area]);
    let plane = Mirror::Plane {
        point: [0.0, -1.0, 0.0],
        normal: [0.0, 2.0, 0.0],
    };
    assert_eq!(description.mirrors, [plane, Mirror::Triangles([3, 7])]);

    let camera = description.cameras[1].camera().unwrap();
    let view = description.view(camera);
    assert_eq!(view.camera.lens().map(|lens| lens.focus), Some(3.0));
    assert_eq!(view.point_light, Some(Vec3::new(0.0, 0.0, 1.5)));
    let edges = view.area_light.map(|light| light.edges);
    assert_eq!(edges, Some([4.0 * DVec3::X, 5.0 * DVec3::Z]));
    assert_eq!(view.mirrors[1], workloads::Mirror::Triangles(3..7));
    assert!(
        RayType::ALL
            .into_iter()
            .all(|rays| view.allows(rays).is_ok())
    );
    assert_eq!(description.rays, ["primary", "diffuse-8"]);
}

#[test]
fn every_ray_type_may_be_named() {
    for rays in RayType::ALL {
        let name = rays.to_string();
        assert!(description::RAY_TYPES.contains(&name.as_str()), "{name}");
    }
    for rays in description::RAY_TYPES {
        let text = GOOD.replace("diffuse-8", rays);
        Description::parse(Path::new("s.json"), text.as_bytes()).unwrap();
    }
}

#[test]
#[rustfmt::skip]
fn what_is_no_description_is_named_by_line() {
    for (good, bad, expected) in [
        ("\"rays\"", "\"ray\"", "line 11: unknown field `ray`, expected one of `about`, `meshes`, `cameras`, `lights`, `mirrors`, `rays`, `$schema`"),
        ("\"rays\"", "\"r\\ny\"", "line 11: unknown field `r y`, expected one of `about`, `meshes`, `cameras`, `lights`, `mirrors`, `rays`, `$schema`"),
        ("\"eye\"", "\"eyes\"", "line 7: unknown field `eyes`, expected one of `name`, `eye`, `look_at`, `up`, `fov_degrees`, `lens`"),
        ("\"position\"", "\"at\": 3, \"position\"", "line 10: unknown field `at`, expected `position`"),
        ("\"file\"", "\"fil\"", "line 3: unknown field `fil`, expected one of `file`, `generator`, `triangles`, `seed`"),
        ("\"triangles\": 100", "\"triangles\": -1", "line 4: invalid value: integer `-1`, expected usize"),
        ("\"triangles\": 100", "\"triangles\": 1e3", "line 4: invalid type: floating point `1000.0`, expected usize"),
        ("[0, 1, 2]", "[0, 1]", "line 7: invalid length 2, expected an array of length 3"),
        ("[0, 1, 2]", "[0, 1, 2, 3]", "line 7: trailing characters"),
        ("[0, 1, 2]", "[0, 1, NaN]", "line 7: expected value"),
        ("[0, 1, 2]", "[0, 1, 1e999]", "line 7: number out of range"),
        ("[0, 1, 2]", "[0, 1, null]", "line 7: invalid type: null, expected f64"),
        ("\"type\": \"point\"", "\"type\": \"sun\"", "line 10: unknown variant `sun`, expected `point` or `area`"),
        (", \"fov_degrees\": 60", "", "line 7: missing field `fov_degrees`"),
        ("\"fov_degrees\": 60", "\"fov_degrees\": 60, \"fov_degrees\": 60", "line 7: duplicate field `fov_degrees`"),
        ("\"diffuse-8\"]", "\"diffuse-8\"", "line 12: expected `,` or `]`"),
        ("\"diffuse-8\"]\n}", "\"diffuse-8\"]", "line 11: EOF while parsing an object"),
    ] {
        let message = error(good, bad);
        // The column is that of the parser: near enough, but not ours to promise.
        let (place, problem) = message.split_once(", column ").unwrap();
        let (_, problem) = problem.split_once(": ").unwrap();
        assert_eq!(format!("{place}: {problem}"), format!("s.json, {expected}"), "{bad}");
    }
}

#[test]
#[rustfmt::skip]
fn a_value_that_makes_no_sense_is_named_by_its_key() {
    for (good, bad, expected) in [
        ("[0, 1, 2]", "[0, 1, 0]", "cameras[0]: the camera's eye and look-at are the same point, [0, 1, 0]"),
        ("[0, 1, 2]", "[0, 9, 0]", "cameras[0]: the camera\'s up, [0, 1, 0], is zero or parallel to its view direction, [0, -8, 0]"),
        ("[0, 1, 2]", "[0, 9, 9.5367431640625e-7]", "cameras[0]: the camera\'s up, [0, 1, 0], is zero or parallel to its view direction, [0, -8, -0.00000095367431640625]"),
        ("[0, 5, 0]", "[0, 0, 0]", "cameras[1]: the camera's up, [0, 0, 0], is zero or parallel to its view direction, [-9, 0, -2]"),
        ("[9, 1, 2]", "[9, 1, -2e18]", "cameras[1].eye: expected numbers smaller in size than 1.844e18, found [9.0, 1.0, -2e18]"),
        ("0.5", "0", "cameras[1]: the camera's field of view is 0 degrees, expected more than 0 and less than 180"),
        ("0.5", "180", "cameras[1]: the camera's field of view is 180 degrees, expected more than 0 and less than 180"),
        ("0.5", "-60", "cameras[1]: the camera's field of view is -60 degrees, expected more than 0 and less than 180"),
        ("side", "front", "cameras[1].name: expected a name of its own, found \"front\" again"),
        ("side", "", "cameras[1].name: expected a name, found \"\""),
        ("\"focus\": 3", "\"focus\": 0", "cameras[1]: the camera's lens has radius 0.25 and focus 0, expected numbers greater than 0"),
        ("[1, 2, 3]", "[1, 2, 3e18]", "lights[1].corner: expected numbers smaller in size than 1.844e18, found [1.0, 2.0, 3e18]"),
        ("[4, 0, 0]", "[4, 0, 3e18]", "lights[1].edges: expected numbers smaller in size than 1.844e18, found [4.0, 0.0, 3e18]"),
        ("[0, 2, 0]", "[0, 0, 0]", "mirrors[0].plane.normal: expected a vector that has a direction, found [0.0, 0.0, 0.0]"),
        ("[3, 7]", "[7, 7]", "mirrors[1].triangles: expected a first number below the second, found 7 and 7"),
        ("1.5]", "3e18]", "lights[0].position: expected numbers smaller in size than 1.844e18, found [0.0, 0.0, 3e18]"),
        ("diffuse-8", "difuse-8", "rays[1]: there is no ray type \"difuse-8\": did you mean \"diffuse-8\"?"),
        ("[\"primary\", \"diffuse-8\"]", "[]", "rays: expected at least one, found none"),
        ("hall", "hal", "meshes[1].generator: there is no generator \"hal\": did you mean \"hall\"?"),
        ("hall", "x", "meshes[1].generator: there is no generator \"x\": there are hall, relief, soup"),
        ("\"triangles\": 100", "\"triangles\": 0", "meshes[1].triangles: expected a number from 1 to 4294967294, found 0"),
        ("\"triangles\": 100", "\"triangles\": 4294967295", "meshes[1].triangles: expected a number from 1 to 4294967294, found 4294967295"),
        ("\"a.obj\"", "\"a.obj\", \"seed\": 1", "meshes[0]: expected the key `file`, or the keys `generator`, `triangles` and `seed`, found others or too few"),
        (", \"seed\": 1", "", "meshes[1]: expected the key `file`, or the keys `generator`, `triangles` and `seed`, found others or too few"),
        ("\"file\": \"a.obj\"", "", "meshes[0]: expected the key `file`, or the keys `generator`, `triangles` and `seed`, found others or too few"),
        ("a.obj", "", "meshes[0].file: expected the name of a file, found \"\""),
    ] {
        assert_eq!(error(good, bad), format!("s.json, {expected}"), "{bad}");
    }
    let cut = |key: &str, next: &str| {
        let (from, to) = (GOOD.find(key).unwrap(), GOOD.find(next).unwrap());
        error(&GOOD[from..to], &format!("{key}: [],\n"))
    };
    assert_eq!(cut("\"meshes\"", "\"cameras\""), "s.json, meshes: expected at least one, found none");
    assert_eq!(cut("\"cameras\"", "\"lights\""), "s.json, cameras: expected at least one, found none");
}

#[test]
fn a_scene_that_does_not_exist_brings_the_nearest_name() {
    let message = scene::find("sibenick", &folder()).unwrap_err().to_string();
    assert!(
        message.ends_with(r#"scenes: there is no scene "sibenick": did you mean "sibenik"?"#),
        "{message}"
    );
    let empty = tempfile::tempdir().unwrap();
    let message = scene::find("x", empty.path()).unwrap_err().to_string();
    let expected = format!(
        r#"{}: there is no scene "x", and no other"#,
        empty.path().display()
    );
    assert_eq!(message, expected);
    let absent = empty.path().join("absent");
    let message = scene::find("x", &absent).unwrap_err().to_string();
    let expected = format!("{}: cannot be read: ", absent.display());
    assert!(message.starts_with(&expected), "{message}");
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";

fn describe(meshes: &str) -> String {
    let (from, to) = (
        GOOD.find("\"meshes\"").unwrap(),
        GOOD.find("\"cameras\"").unwrap(),
    );
    format!("{}\"meshes\": [{meshes}],\n{}", &GOOD[..from], &GOOD[to..])
}

#[test]
fn meshes_are_found_beside_the_description_first_and_joined_in_order() {
    let root = tempfile::tempdir().unwrap();
    let [scenes, first, second] = ["scenes", "first", "second"].map(|name| {
        let folder = root.path().join(name);
        fs::create_dir(&folder).unwrap();
        folder
    });
    let json = scenes.join("two.json");
    fs::write(
        &json,
        describe(r#"{ "file": "a.obj" }, { "file": "b.obj" }"#),
    )
    .unwrap();
    let load = || Scene::load(&json, &[first.clone(), second.clone()]);
    let sizes = || {
        load()
            .unwrap()
            .mesh
            .triangles()
            .iter()
            .map(|t| t.b.x)
            .collect::<Vec<_>>()
    };
    let scaled = |x: &str| TRIANGLE.replace("v 1 0 0", &format!("v {x} 0 0"));

    let Err(SceneError::MissingMesh { file, searched }) = load() else {
        panic!("there is no mesh");
    };
    assert_eq!(file, Path::new("a.obj"));
    assert_eq!(searched, [scenes.clone(), first.clone(), second.clone()]);
    assert_eq!(
        load().unwrap_err().to_string(),
        format!(
            "mesh a.obj not found, looked in {}, {}, {}",
            scenes.display(),
            first.display(),
            second.display()
        )
    );

    fs::write(second.join("a.obj"), scaled("1")).unwrap();
    fs::write(second.join("b.obj"), scaled("2") + "f 3 2 1\n").unwrap();
    assert_eq!(sizes(), [1.0, 2.0, 2.0]);
    fs::write(first.join("a.obj"), scaled("3")).unwrap();
    assert_eq!(sizes(), [3.0, 2.0, 2.0]);
    fs::write(scenes.join("a.obj"), scaled("nan")).unwrap();
    let scene = load().unwrap();
    assert_eq!((scene.mesh.len(), scene.mesh.dropped()), (3, 1));
    assert_eq!(scene.name, "two");

    fs::write(scenes.join("a.obj"), "f 1 2\n").unwrap();
    let message = load().unwrap_err().to_string();
    let expected = format!(
        "{}, line 1: expected a face",
        scenes.join("a.obj").display()
    );
    assert!(message.starts_with(&expected), "{message}");
}

#[test]
fn a_path_is_as_good_as_a_name() {
    let root = tempfile::tempdir().unwrap();
    let json = root.path().join("own.json");
    fs::write(&json, describe(r#"{ "file": "sub/t.obj" }"#)).unwrap();
    fs::create_dir(root.path().join("sub")).unwrap();
    fs::write(root.path().join("sub/t.obj"), TRIANGLE).unwrap();
    let found = scene::find(json.to_str().unwrap(), &folder()).unwrap();
    assert_eq!(Scene::load(&found, &[]).unwrap().mesh.len(), 1);
    assert_eq!(scene::find("own", root.path()).unwrap(), json);

    let absent = scene::find("absent.json", &folder()).unwrap();
    let message = Scene::load(&absent, &[]).unwrap_err().to_string();
    assert!(
        message.starts_with("absent.json: cannot be read: "),
        "{message}"
    );
}
