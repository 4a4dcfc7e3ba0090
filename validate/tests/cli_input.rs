//! What a user can get wrong: each has one message that says what and where, and exit code 2.

mod command;

use command::{Folder, SCENE, TRIANGLE, npy};

#[test]
fn usage_errors() {
    let folder = Folder::new();
    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    folder.dacrt("").exits(2);
    refuses("tracee", &["tracee", "trace"]);
    refuses(
        "run --scenes sibenick",
        &["no scene \"sibenick\"", "\"sibenik\""],
    );
    refuses("run --scenes zzz", &["no scene \"zzz\"", "sponza", "hall"]);
    refuses("run --scenes ./nowhere.json", &["./nowhere.json"]);
    refuses(
        "run --methods nabata",
        &["no method \"nabata\"", "\"nabata2013\""],
    );
    refuses(
        "run --rays primry",
        &["no ray type \"primry\"", "\"primary\""],
    );
    refuses(
        "run --rays diffuse-9",
        &["no ray type \"diffuse-9\"", "\"diffuse-"],
    );
    refuses("run --isa avx3", &["\"avx3\"", "\"avx2\""]);
    refuses("run --isa AVX512", &["\"AVX512\"", "\"avx512\""]);
    refuses(
        "run --precision fats",
        &["no precision \"fats\"", "\"fast\""],
    );
    refuses("run --precision fast,exakt", &["\"exakt\"", "\"exact\""]);
    refuses("paper mora2011 --precision exakt", &["\"exact\""]);
    refuses("render ./tiny.json --precision water", &["\"watertight\""]);
    refuses("run --threads 1025", &["--threads", "0 to 1024"]);
    refuses("run --threads two", &["--threads", "0 to 1024"]);
    refuses(
        "run --resolution 0",
        &["--resolution", "at least one pixel"],
    );
    refuses(
        "run --resolution 10x0",
        &["--resolution", "at least one pixel"],
    );
    refuses("run --resolution big", &["--resolution", "WxH"]);
    refuses(
        "run --scenes ./tiny.json --resolution 100000",
        &["resolution 100000x100000"],
    );
    refuses(
        "run --scenes ./tiny.json --resolution 40000",
        &["resolution 40000x40000", "GiB"],
    );
    refuses(
        "run --scenes ./tiny.json,tiny.json",
        &["--scenes", "same name"],
    );
    refuses("run --spp 5", &["--spp", "4 and 9"]);
    refuses("run --spp 0", &["--spp"]);
    refuses("run --spp -1", &["--spp", "square number"]);
    refuses("run --resolution -1", &["--resolution", "WxH"]);
    refuses("run --repeats 0", &["--repeats", "from 1 to 1000"]);
    refuses("run --repeats many", &["--repeats", "from 1 to 1000"]);
    refuses("run --seed -1", &["--seed", "whole number from 0"]);
    refuses("run --seed 1.5", &["--seed", "whole number from 0"]);
    refuses("run --threads -1", &["--threads", "whole number"]);
    refuses("run --bins 1", &["--bins", "2 to 256"]);
    refuses(
        "run --bins 2,x",
        &["'x'", "--bins", "expected a whole number"],
    );
    refuses(
        "run --bins -8",
        &["'-8'", "--bins", "expected a whole number"],
    );
    refuses("run --samples 0", &["--samples", "1 to 4096"]);
    refuses("run --skip 1.5", &["--skip", "0 to 1"]);
    refuses("run --skip -1", &["--skip", "0 to 1"]);
    refuses("run --threshold nan", &["--threshold", "expected a number"]);
    refuses("run --min-rays -1", &["--min-rays", "whole number"]);
    refuses(
        "run --leaf-triangles 0",
        &["--leaf-triangles", "at least 1"],
    );
    refuses(
        "run --sample-middle 1",
        &["--sample-middle", "true or false"],
    );
    refuses("run --axes both", &["--axes", "longest"]);
    refuses("run --ray-limit 0", &["--ray-limit", "at least 1"]);
    refuses("run --octants 2", &["--octants", "true or false"]);
    refuses("run --cone-limit x", &["--cone-limit", "whole number"]);
    refuses("run --variant random", &["--variant"]);
    refuses("run --methods mora2011-cone", &["\"mora2011-cones\""]);
    refuses(
        "render ./tiny.json --method mora2011 --bins 8",
        &["mora2011 has no such parameter", "--bins"],
    );
    refuses("run --scenes", &["--scenes"]);
    refuses("render sibenick", &["\"sibenik\""]);
    refuses("render ./tiny.json --bins 8,16", &["--bins", "one value"]);
    refuses(
        "render ./tiny.json --method afra2012 --skip 0.5",
        &["afra2012", "--skip"],
    );
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --out nowhere/out.json")
        .refuses(&["nowhere", "folder"]);
    folder
        .dacrt("run --scenes ./tiny.json --out .")
        .refuses(&["folder"]);
    folder
        .dacrt("run --scenes ./tiny.json --out /dev/null")
        .refuses(&["/dev/null", "plain file"]);
    folder
        .dacrt("run --scenes ./tiny.json --out tiny.json/out.json")
        .refuses(&["tiny.json/out.json", "no folder tiny.json"]);
    // Not even root may.
    #[cfg(target_os = "linux")]
    folder
        .dacrt("run --scenes ./tiny.json --out /sys/out.json")
        .refuses(&["cannot write /sys/out.json"]);
    folder
        .dacrt("render ./tiny.json --out nowhere/picture.png")
        .refuses(&["nowhere", "folder"]);
    folder
        .dacrt("render ./tiny.json --out tiny.json/pictures")
        .refuses(&["tiny.json/pictures"]);
    folder
        .dacrt("render ./tiny.json --what depth,prim --out one.png")
        .refuses(&["one.png", "2 pictures"]);
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    folder
        .dacrt("trace --mesh m.obj --rays r.npy --method afra2012 --out nowhere/h.npz")
        .refuses(&["nowhere", "folder"]);
}

#[test]
fn a_missing_mesh_that_was_asked_for() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes sibenik --meshes some:other")
        .refuses(&["sibenik.obj.gz", "some", "other", "DACRT_MESHES"]);
    folder
        .dacrt_with("render sibenik", &[("DACRT_MESHES", "here")])
        .refuses(&["sibenik.obj.gz", "here", "DACRT_MESHES"]);
}

#[test]
fn scene_descriptions_that_make_no_sense() {
    let folder = Folder::new();
    let refuses = |from: &str, to: &str, words: &[&str]| {
        let text = SCENE.replace(from, to);
        assert_ne!(text, SCENE);
        folder.write("bad.json", text);
        let run = folder.dacrt("run --scenes ./bad.json --resolution 4");
        run.refuses(words).refuses(&["bad.json"]);
    };
    refuses("\"lights\"", "\"lihgts\"", &["lihgts", "line"]);
    refuses(
        "[0.5, 0.5, 0.5]",
        "[0.5, 0.5, 4]",
        &["cameras[0]", "eye", "look-at"],
    );
    refuses(
        "\"up\": [0, 1, 0]",
        "\"up\": [0, 0, 2]",
        &["up", "parallel"],
    );
    refuses("40", "180", &["cameras[0]", "field of view", "180"]);
    refuses("40", "-1", &["cameras[0]", "field of view", "-1"]);
    refuses("40", "0", &["cameras[0]", "field of view", "0 degrees"]);
    refuses("[0, 1, 0]", "[0, 0, 0]", &["cameras[0]", "up", "zero"]);
    refuses("[0, 1, 0]", "[0, 1]", &["line 3", "array of length 3"]);
    refuses("500", "0", &["meshes[0].triangles", "from 1", "found 0"]);
    refuses("\"primary\"", "\"primry\"", &["rays[0]", "\"primary\""]);
    refuses("]\n}", "", &["line"]);
    refuses(
        "\"soup\"",
        "\"soop\"",
        &["meshes[0].generator", "did you mean \"soup\""],
    );
}

#[test]
fn trace_needs_one_mesh_and_one_method() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    let refuses = |line: &str, words: &[&str]| {
        folder
            .dacrt(&format!("trace --out h.npz --rays r.npy {line}"))
            .refuses(words);
        assert!(!folder.path("h.npz").exists(), "{line}");
    };
    refuses("--mesh m.obj", &["--method"]);
    refuses("--method afra2012", &["--mesh", "--scene"]);
    refuses(
        "--mesh m.obj --scene hall --method afra2012",
        &["--mesh", "--scene"],
    );
    refuses("--mesh m.obj --method afra", &["\"afra2012\""]);
    refuses(
        "--mesh m.obj --method afra2012 --bins 8,9",
        &["--bins", "one value"],
    );
    refuses(
        "--scene hal --method afra2012",
        &["no scene \"hal\"", "\"hall\""],
    );
    refuses(
        "--scene sibenik --meshes some --method afra2012",
        &["sibenik.obj.gz", "some"],
    );
}

const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A PLY file with three vertices and one face.
fn ply(format: &str, faces: u64, rows: &[u8]) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\n\
         end_header\n"
    );
    let floats = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].into_iter();
    let vertices: Vec<u8> = match format {
        "ascii" => b"0 0 0\n1 0 0\n0 1 0\n".to_vec(),
        "binary_little_endian" => floats.flat_map(f32::to_le_bytes).collect(),
        _ => floats.flat_map(f32::to_be_bytes).collect(),
    };
    [header.as_bytes(), &vertices, rows].concat()
}

#[test]
fn meshes_that_make_no_sense() {
    let folder = Folder::new();
    folder.write_rays("r.npy");
    let refuses = |name: &str, bytes: &[u8], words: &[&str]| {
        folder.write(name, bytes);
        let run = format!("trace --mesh {name} --rays r.npy --method afra2012 --out h.npz");
        folder.dacrt(&run).refuses(&[name]).refuses(words);
        assert!(!folder.path("h.npz").exists(), "{name}");
        // As part of a scene, too.
        let source = format!("\"file\": \"{name}\"");
        let generator = "\"generator\": \"soup\", \"triangles\": 500, \"seed\": 1";
        folder.write("scene.json", SCENE.replace(generator, &source));
        let run = folder.dacrt("run --scenes ./scene.json --resolution 4 --out out.json");
        run.refuses(&[name]).refuses(words);
    };
    let obj = |name: &str, face: &str, words: &[&str]| {
        refuses(name, format!("{VERTICES}{face}").as_bytes(), words);
    };
    obj("one.obj", "f 1\n", &["line 4", "three corners", "found 1"]);
    obj(
        "two.obj",
        "f 1 2\n",
        &["line 4", "three corners", "found 2"],
    );
    obj(
        "above.obj",
        "f 1 2 4\n",
        &["line 4", "from 1 to 3", "found 4"],
    );
    obj("zero.obj", "f 0 1 2\n", &["line 4", "found 0"]);
    obj("before.obj", "f -1 -2 -4\n", &["line 4", "found -4"]);
    obj("none.obj", "", &["no face"]);
    refuses("empty.obj", b"", &["no face"]);
    refuses("cut.obj", b"v 0 0 0\nv 1 0", &["line 2", "\"v 1 0\""]);
    refuses("word.obj", b"v 0 0 zero\n", &["line 1", "zero"]);

    let mut random = fastrand::Rng::with_seed(1);
    let noise: Vec<u8> = std::iter::repeat_with(|| random.u8(..)).take(500).collect();
    refuses("noise.obj", &noise, &["expected a PLY file", "OBJ"]);
    refuses(
        "noise.ply",
        &[b"ply\n", &noise[..]].concat(),
        &["end_header"],
    );

    let text = |name: &str, row: &str, words: &[&str]| {
        // Room enough for a face of three corners, which the header promises.
        refuses(
            name,
            &ply("ascii", 1, format!("{row}        \n").as_bytes()),
            words,
        );
    };
    text("one.ply", "1 0", &["line 13", "face 0"]);
    text("two.ply", "2 0 1", &["line 13", "face 0"]);
    text(
        "above.ply",
        "3 0 1 3",
        &["line 13", "from 0 to 2", "found 3"],
    );
    text("below.ply", "3 0 1 -1", &["line 13", "found -1"]);
    let face = |corner: i32| {
        [
            &[3][..],
            [0, 1, corner].map(i32::to_le_bytes).as_flattened(),
        ]
        .concat()
    };
    let (binary, good) = ("binary_little_endian", face(2));
    refuses(
        "above-b.ply",
        &ply(binary, 1, &face(9)),
        &["byte 205", "from 0 to 2", "found 9"],
    );
    refuses(
        "short-b.ply",
        &ply(binary, 1, &good[..9]),
        &["byte 205", "face 0 of 1", "end of the file"],
    );
    refuses(
        "no-face.ply",
        &ply(binary, 0, &[]),
        &["no-face.ply", "triangle"],
    );
    for format in ["ascii", binary, "binary_big_endian"] {
        let huge = ply(format, 4_000_000_000, &good);
        refuses("huge.ply", &huge, &["line 7", "4000000000", "found"]);
    }
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    std::io::Write::write_all(&mut gzip, &ply(binary, 1, &good)).unwrap();
    let gzip = gzip.finish().unwrap();
    refuses("cut.gz", &gzip[..gzip.len() - 12], &["byte", "gzip"]);
}

#[test]
fn mesh_files_that_are_none() {
    let folder = Folder::new();
    folder.write_rays("r.npy");
    for (name, words) in [
        ("no.obj", ["no.obj", "No such file"]),
        (".", [".", "not a regular file"]),
        ("/dev/null", ["/dev/null", "not a regular file"]),
    ] {
        let run = format!("trace --mesh {name} --rays r.npy --method afra2012 --out h.npz");
        folder.dacrt(&run).refuses(&words);
    }
}

#[test]
fn vertices_that_are_no_numbers_are_dropped_and_counted() {
    let folder = Folder::new();
    folder.write_rays("r.npy");
    let bad = "v nan 0 0\nv 0 inf 0\nf 1 2 4\nf 1 2 3\nf 1 3 5\n";
    folder.write("m.obj", format!("{VERTICES}{bad}"));
    let run = folder.dacrt("trace --mesh m.obj --rays r.npy --method afra2012 --out h.npz");
    let text = run.exits(0).stdout();
    assert!(text.starts_with("2 rays, 1 hit, "), "{text}");
    assert!(
        text.contains("\n2 invalid triangles, never hit\n"),
        "{text}"
    );
    folder.write("all.obj", format!("{VERTICES}v nan 0 0\nf 1 2 4\n"));
    let run = folder.dacrt("trace --mesh all.obj --rays r.npy --method afra2012 --out h.npz");
    assert!(
        run.exits(0)
            .stdout()
            .contains("\n1 invalid triangle, never hit\n")
    );
}

#[test]
fn rays_that_make_no_sense() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    let trace = |name: &str| {
        let line = format!("trace --mesh m.obj --rays {name} --method afra2012 --out h.npz");
        folder.dacrt(&line)
    };
    let refuses = |name: &str, bytes: &[u8], words: &[&str]| {
        folder.write(name, bytes);
        trace(name).refuses(&[name]).refuses(words);
        assert!(!folder.path("h.npz").exists(), "{name}");
    };
    let ray = [0; 32];
    refuses(
        "f8.npy",
        &npy("<f8", "False", "(1, 8)", &[0; 64]),
        &["<f8", "float32"],
    );
    refuses(
        "i4.npy",
        &npy("<i4", "False", "(1, 8)", &ray),
        &["<i4", "float32"],
    );
    refuses(
        "flat.npy",
        &npy("<f4", "False", "(8,)", &ray),
        &["(8,)", "(N, 8)"],
    );
    refuses(
        "seven.npy",
        &npy("<f4", "False", "(1, 7)", &ray[..28]),
        &["(1, 7)", "(N, 8)"],
    );
    refuses(
        "order.npy",
        &npy("<f4", "True", "(1, 8)", &ray),
        &["Fortran", "C order"],
    );
    refuses(
        "big.npy",
        &npy(">f4", "False", "(1, 8)", &ray),
        &["big-endian", "little-endian"],
    );
    let short = npy("<f4", "False", "(1, 8)", &ray[..31]);
    refuses("short.npy", &short, &["1 rays", "bytes", "is 100"]);
    let huge = npy("<f4", "False", "(576460752303423488, 8)", &ray);
    refuses("huge.npy", &huge, &["576460752303423488 rays"]);
    refuses("header.npy", &short[..30], &["byte 30", "header"]);
    refuses("empty.npy", b"", &["byte 0", "empty file"]);
    refuses("mesh.npy", TRIANGLE.as_bytes(), &["byte 0", "NUMPY"]);
    trace("no.npy").refuses(&["no.npy", "No such file"]);

    folder.write("none.npy", npy("<f4", "False", "(0, 8)", &[]));
    assert!(
        trace("none.npy")
            .exits(0)
            .stdout()
            .starts_with("0 rays, 0 hits, ")
    );
    folder.write("invalid.npy", npy("<f4", "False", "(1, 8)", &ray));
    let text = trace("invalid.npy").exits(0).stdout();
    assert!(
        text.contains("\n1 invalid ray, taken for a miss\n"),
        "{text}"
    );
}
