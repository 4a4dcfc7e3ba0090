//! Small meshes by hand in every format that the loaders take, and what they say of bad ones.

use dacrt::Mesh;
use dacrt::scene::{load_mesh, mesh_from_bytes};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::Path;

fn load(bytes: impl AsRef<[u8]>) -> Mesh {
    mesh_from_bytes(Path::new("mesh"), bytes.as_ref()).unwrap_or_else(|e| panic!("{e}"))
}

/// The message, which is one line and begins with the file's name.
fn error(bytes: impl AsRef<[u8]>) -> String {
    let message = match mesh_from_bytes(Path::new("mesh"), bytes.as_ref()) {
        Ok(mesh) => panic!("loaded {} triangles", mesh.len()),
        Err(error) => error.to_string(),
    };
    assert!(!message.contains('\n'), "{message}");
    assert!(message.len() < 300, "{message}");
    message
        .strip_prefix("mesh")
        .unwrap_or_else(|| panic!("{message}"))
        .to_owned()
}

fn corners(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    mesh.triangles()
        .iter()
        .map(|t| [t.a, t.b, t.c].map(|p| p.to_array()))
        .collect()
}

fn gzip(bytes: impl AsRef<[u8]>) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes.as_ref()).unwrap();
    encoder.finish().unwrap()
}

const A: [f32; 3] = [0.0, 0.0, 0.0];
const B: [f32; 3] = [1.0, 0.0, 0.0];
const C: [f32; 3] = [1.0, 1.0, 0.0];
const D: [f32; 3] = [0.0, 1.0, 0.5];

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nf 1 2 3 4\n";

mod obj {
    use super::*;

    #[test]
    fn polygons_are_cut_into_fans_in_file_order() {
        let mesh = load(SQUARE.to_owned() + "f 2 3 4\nf 4 3 2 1 4\n");
        let expected = vec![
            [A, B, C],
            [A, C, D],
            [B, C, D],
            [D, C, B],
            [D, B, A],
            [D, A, D],
        ];
        assert_eq!(corners(&mesh), expected);
        assert_eq!(mesh.dropped(), 0);
    }

    #[test]
    fn groups_objects_and_materials_do_not_change_the_order() {
        let mesh = load(
            "mtllib absent.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\ng\nusemtl\nf 1 2 3\n\
             g b\nusemtl\tred\nf 2 3 4\no two\ns off\nusemtl blue\nf 3 4 1\ng b\nf 4 1 2\n",
        );
        let expected = vec![[A, B, C], [B, C, D], [C, D, A], [D, A, B]];
        assert_eq!(corners(&mesh), expected);
    }

    #[test]
    fn corners_may_name_texture_coordinates_and_normals_of_any_index() {
        for face in ["1/1/1 2/2/2 3/3/3", "1//9 2//-9 3//0", "1/7 2/ 3//"] {
            let mesh = load(format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0\nvn x\nf {face}\n"));
            assert_eq!(corners(&mesh), vec![[A, B, C]], "{face}");
        }
        // tobj by itself overflows on indices of this size, and panics in a debug build.
        let face = "1/-9223372036854775808/9223372036854775807";
        let text = format!("v 0 0 0\nvt 0 0\nvn 0 0 1\nf {face} {face} {face}\n");
        assert_eq!(corners(&load(text)), vec![[A, A, A]]);
    }

    #[test]
    fn negative_indices_count_back_from_the_face() {
        let mesh = load("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 .5\nf -3 -2 -1\n");
        assert_eq!(corners(&mesh), vec![[A, B, C], [B, C, D]]);
    }

    #[test]
    fn a_face_may_come_before_its_vertices() {
        assert_eq!(
            corners(&load("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0")),
            vec![[A, B, C]]
        );
    }

    #[test]
    fn weights_and_colours_are_passed_over() {
        // tobj divides by the fourth number, and refuses a file with colours on some vertices only.
        let mesh = load("v 0 0 0 2\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 1 1 1 1\nf 1 2 3\n");
        assert_eq!(corners(&mesh), vec![[A, B, C]]);
    }

    #[test]
    fn polylines_and_points_are_no_faces() {
        // tobj makes a triangle of a polyline.
        assert_eq!(load(SQUARE.to_owned() + "l 1 2 3\np 1\n").len(), 2);
    }

    #[test]
    fn line_ends_comments_and_continued_lines() {
        let text = "\u{feff}# caf\u{e9}\n  v 0 0 0 # first\n\tv 1 0\\\n 0\nv 1 1 0#\n\nf 1 \\\n2\\\n3 # x\\\n";
        let latin1: Vec<u8> = text
            .replace('\u{e9}', "~")
            .bytes()
            .map(|b| if b == b'~' { 0xe9 } else { b })
            .collect();
        for ends in ["\n", "\r\n", "\r"] {
            for bytes in [text.as_bytes(), &latin1] {
                let bytes: Vec<u8> = bytes
                    .iter()
                    .flat_map(|b| match b {
                        b'\n' => ends.as_bytes().to_vec(),
                        b => vec![*b],
                    })
                    .collect();
                assert_eq!(corners(&load(bytes)), vec![[A, B, C]], "{ends:?}");
            }
        }
    }

    #[test]
    fn positions_are_rounded_once() {
        // Halfway between two floats and a bit: rounding to double first would lose the bit.
        let mesh = load("v 1.00000005960464477540 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
        assert_eq!(mesh.triangles()[0].a.x, 1.0 + f32::EPSILON);
    }

    #[test]
    fn nan_infinite_and_huge_vertices_are_dropped_and_counted() {
        for bad in [
            "nan",
            "NaN",
            "-nan",
            "inf",
            "-Infinity",
            "1e39",
            "2e18",
            "-1.844e18",
        ] {
            let mesh = load(format!("{SQUARE}v 0 {bad} 0\nf 1 2 5\nf 1 2 3\n"));
            assert_eq!((mesh.len(), mesh.dropped()), (4, 1), "{bad}");
            assert!(!mesh.triangles()[2].is_valid());
        }
    }

    #[test]
    fn bad_lines_are_named() {
        for (line, expected) in [
            (
                "v 1 2",
                "line 7: expected three numbers after \"v\", found \"v 1 2\"",
            ),
            (
                "v",
                "line 7: expected three numbers after \"v\", found \"v\"",
            ),
            (
                "v 1 x 2",
                "line 7: expected three numbers after \"v\", found \"v 1 x 2\"",
            ),
            ("v 1 2 3 v 4 5 6", "line 7: expected a number, found \"v\""),
            (
                "v 1\u{a0}2 3 4",
                "line 7: expected plain text, found \"1\\u{a0}2\"",
            ),
            (
                "f",
                "line 7: expected a face of three corners or more, found 0 in \"f\"",
            ),
            (
                "f 1",
                "line 7: expected a face of three corners or more, found 1 in \"f 1\"",
            ),
            (
                "f 1 2",
                "line 7: expected a face of three corners or more, found 2 in \"f 1 2\"",
            ),
            (
                "f 1 2 # 3",
                "line 7: expected a face of three corners or more, found 2 in \"f 1 2 # 3\"",
            ),
            (
                "f 1 2 x",
                "line 7: expected whole numbers as vertex indices, found \"f 1 2 x\"",
            ),
            (
                "f 1 2 3.0",
                "line 7: expected whole numbers as vertex indices, found \"f 1 2 3.0\"",
            ),
            (
                "f 1 2 99999999999999999999",
                "line 7: expected whole numbers as vertex indices, found \"f 1 2 99999999999999999999\"",
            ),
            (
                "f 1 2 /3",
                "line 7: expected a vertex index in front of the slash, found \"/3\"",
            ),
            (
                "f 1 2 5",
                "line 7: expected a vertex index from 1 to 4, the number of vertices, found 5",
            ),
            (
                "f 1 2 9223372036854775807",
                "line 7: expected a vertex index from 1 to 4, the number of vertices, found 9223372036854775807",
            ),
            (
                "f 0 1 2",
                "line 7: expected a vertex index from 1 to 4, the number of vertices, found 0",
            ),
            (
                "f 1 2 -5",
                "line 7: expected a vertex index from -4 to -1, for so many vertices stand before, found -5",
            ),
            (
                "f 1 2 -9223372036854775808",
                "line 7: expected a vertex index from -4 to -1, for so many vertices stand before, found -9223372036854775808",
            ),
            (
                "f 1 2 \\\n9",
                "line 7: expected a vertex index from 1 to 4, the number of vertices, found 9",
            ),
        ] {
            let text = format!("{SQUARE}# a comment\n{line}\nf 1 2 3\n");
            assert_eq!(error(text), format!(", {expected}"));
        }
    }

    #[test]
    fn a_file_without_faces_is_an_error() {
        for text in [
            "",
            "\n",
            "v 0 0 0\n",
            "PK\u{3}\u{4}",
            "plywood\nv 1 2 3\n",
            "ply",
        ] {
            let expected = ": expected a PLY file (first line \"ply\") or an OBJ file with faces, found no face";
            assert_eq!(error(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_long_bad_line_is_cut_in_the_message() {
        let message = error(format!("v 1 2 {}\nf 1 1 1\n", "9x".repeat(1 << 20)));
        assert!(message.starts_with(", line 1: expected three numbers"));
    }
}

mod ply {
    use super::*;

    const HEAD: &str = "ply\nformat ascii 1.0\ncomment by hand\n\
        element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    const ROWS: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 .5\n4 0 1 2 3\n3 1 2 3\n";

    fn ascii() -> String {
        HEAD.to_owned() + ROWS
    }

    fn square() -> Vec<[[f32; 3]; 3]> {
        vec![[A, B, C], [A, C, D], [B, C, D]]
    }

    /// The same mesh in binary, with properties and elements that no triangle needs.
    fn binary(big: bool, index: &str) -> Vec<u8> {
        fn put<const N: usize>(out: &mut Vec<u8>, big: bool, mut little: [u8; N]) {
            if big {
                little.reverse();
            }
            out.extend(little);
        }
        let order = if big { "big" } else { "little" };
        let mut out = format!(
            "ply\r\nformat binary_{order}_endian 1.0\r\nobj_info x\r\nelement nothing 4000000000\r\n\
             element camera 1\r\nproperty double f\r\nproperty list short float coefficients\r\n\
             element vertex 4\r\nproperty uchar red\r\nproperty double z\r\nproperty float32 x\r\nproperty int8 y\r\n\
             element face 2\r\nproperty ushort flags\r\nproperty list uint {index} vertex_index\r\nproperty list uchar float uv\r\n\
             element edge 1\r\nproperty int a\r\nend_header\r\n"
        )
        .into_bytes();
        put(&mut out, big, 1.5f64.to_le_bytes());
        put(&mut out, big, 2i16.to_le_bytes());
        put(&mut out, big, 0f32.to_le_bytes());
        put(&mut out, big, 0f32.to_le_bytes());
        for [x, y, z] in [A, B, C, D] {
            put(&mut out, big, [255u8]);
            put(&mut out, big, f64::from(z).to_le_bytes());
            put(&mut out, big, x.to_le_bytes());
            put(&mut out, big, (y as i8).to_le_bytes());
        }
        for face in [&[0u8, 1, 2, 3][..], &[1, 2, 3]] {
            put(&mut out, big, 7u16.to_le_bytes());
            put(&mut out, big, (face.len() as u32).to_le_bytes());
            for &i in face {
                match index {
                    "char" | "uint8" => put(&mut out, big, [i]),
                    "short" | "uint16" => put(&mut out, big, u16::from(i).to_le_bytes()),
                    _ => put(&mut out, big, u32::from(i).to_le_bytes()),
                }
            }
            put(&mut out, big, [1u8]);
            put(&mut out, big, 0.5f32.to_le_bytes());
        }
        put(&mut out, big, 9i32.to_le_bytes());
        out
    }

    #[test]
    fn ascii_with_any_line_end_blank_lines_and_latin1() {
        assert_eq!(corners(&load(ascii())), square());
        assert_eq!(corners(&load(ascii().replace('\n', "\r\n"))), square());
        assert_eq!(
            corners(&load(HEAD.to_owned() + &ROWS.replace('\n', " \n\n"))),
            square()
        );
        let mut raw = ascii().into_bytes();
        let at = ascii().find("hand").unwrap();
        raw[at] = 0xe9;
        assert_eq!(corners(&load(raw)), square());
    }

    #[test]
    fn a_binary_face_of_one_or_two_corners_is_named() {
        for corners in [1u8, 2] {
            let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\n\
                property float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n"
                .to_vec();
            bytes.extend([0f32; 9].iter().flat_map(|x| x.to_le_bytes()));
            bytes.push(corners);
            (0..corners as i32).for_each(|i| bytes.extend(i.to_le_bytes()));
            let message = error(bytes);
            assert!(
                message.contains("face 0") || message.contains("face 1"),
                "{message}"
            );
            assert!(message.contains("three corners"), "{message}");
        }
    }

    #[test]
    fn binary_of_both_orders_and_any_index_type() {
        for big in [false, true] {
            for index in ["char", "uint8", "short", "uint16", "int", "uint32"] {
                assert_eq!(
                    corners(&load(binary(big, index))),
                    square(),
                    "{big} {index}"
                );
            }
        }
    }

    #[test]
    fn faces_may_stand_before_vertices() {
        let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list int uint vertex_index\n\
            element vertex 3\nproperty double x\nproperty int y\nproperty double z\nend_header\n\
            3 0 1 2\n0 0 0\n1 0 0\n1 1 0";
        assert_eq!(corners(&load(text)), vec![[A, B, C]]);
    }

    #[test]
    fn ascii_rows_with_extra_elements_and_properties() {
        let text = "ply\nformat ascii 1.0\nelement nothing 3\nelement note 2\nproperty list int float n\n\
            element vertex 3\nproperty float nx\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list int float uv\nproperty list int int vertex_index\nend_header\n\
            0\n2 nan 1.\n9 0 0 0\n9 1 0 0\n9 1 1 0\n1 .5 3 0 1 2\n";
        assert_eq!(corners(&load(text)), vec![[A, B, C]]);
    }

    #[test]
    fn nan_infinite_and_huge_vertices_are_dropped_and_counted() {
        for bad in ["nan", "-NaN", "inf", "-Infinity", "1e39", "2e18"] {
            let mesh = load(ascii().replace("0 1 .5", &format!("0 {bad} .5")));
            assert_eq!((mesh.len(), mesh.dropped()), (3, 2), "{bad}");
        }
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.844e18] {
            let mut bytes = binary(false, "int");
            // z, x, y of the last vertex stand before the two faces and the edge.
            let end = bytes.len() - 4 - (2 + 4 + 16 + 5) - (2 + 4 + 12 + 5);
            bytes[end - 5..end - 1].copy_from_slice(&bad.to_le_bytes());
            let mesh = load(bytes);
            assert_eq!((mesh.len(), mesh.dropped()), (3, 2), "{bad}");
        }
    }

    #[test]
    fn bad_rows_are_named_by_line() {
        for (good, bad, expected) in [
            (
                "1 1 0",
                "1 1",
                "line 13: vertex 2 of 4: expected more numbers, found \"1 1\"",
            ),
            (
                "1 1 0",
                "1 1 0 0",
                "line 13: vertex 2 of 4: expected fewer numbers by the header, found \"1 1 0 0\"",
            ),
            (
                "1 1 0",
                "1 one 0",
                "line 13: vertex 2 of 4: expected a number, found \"one\"",
            ),
            (
                "1 1 0",
                "1 1 \u{e9}",
                "line 13: vertex 2 of 4: expected a number, found \"\u{e9}\"",
            ),
            (
                "3 1 2 3",
                "3 1 2 4",
                "line 16: face 1 of 2: expected a vertex index from 0 to 3, found 4",
            ),
            (
                "3 1 2 3",
                "3 1 2 -1",
                "line 16: face 1 of 2: expected a vertex index from 0 to 3, found -1",
            ),
            (
                "3 1 2 3",
                "3 1 2 1.0",
                "line 16: face 1 of 2: expected a number, found \"1.0\"",
            ),
            (
                "3 1 2 3",
                "2 1 2    ",
                "line 16: face 1 of 2: expected a face of three corners or more, found 2",
            ),
            (
                "3 1 2 3",
                "1 1      ",
                "line 16: face 1 of 2: expected a face of three corners or more, found 1",
            ),
            (
                "3 1 2 3",
                "0        ",
                "line 16: face 1 of 2: expected a face of three corners or more, found 0",
            ),
            (
                "3 1 2 3",
                "4 1 2 3",
                "line 16: face 1 of 2: expected more numbers, found \"4 1 2 3\"",
            ),
            (
                "3 1 2 3",
                "18446744073709551615 1 2 3",
                "line 16: face 1 of 2: expected more numbers, found \"18446744073709551615 1 2 3\"",
            ),
            (
                "3 1 2 3",
                "-1 1 2 3",
                "line 16: face 1 of 2: expected a number, found \"-1\"",
            ),
            (
                "3 1 2 3",
                "       ",
                "line 16: face 1 of 2: expected a line, found the end of the file",
            ),
        ] {
            assert_eq!(error(ascii().replace(good, bad)), format!(", {expected}"));
        }
    }

    #[test]
    fn bad_rows_are_named_by_byte() {
        let good = binary(false, "int");
        let second = good.len() - 4 - (2 + 4 + 12 + 5);
        let with = |at: usize, value: u32| {
            let mut bytes = good.clone();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            error(bytes)
        };
        let expect = |message: String, text: &str| {
            assert_eq!(message, format!(", byte {second}: face 1 of 2: {text}"));
        };
        expect(
            with(second + 6, 4),
            "expected a vertex index from 0 to 3, found 4",
        );
        expect(
            with(second + 6, u32::MAX),
            "expected a vertex index from 0 to 3, found -1",
        );
        for few in 0..3u32 {
            let text = format!("expected a face of three corners or more, found {few}");
            let mut bytes = good[..second + 2].to_vec();
            bytes.extend(few.to_le_bytes());
            bytes.resize(good.len() + 100, 0);
            expect(error(bytes), &text);
        }
        // Lengths that no file could hold.
        for length in [70_000, 1 << 31, u32::MAX] {
            expect(
                with(second + 2, length),
                "expected more bytes, found the end of the file",
            );
        }
    }

    #[test]
    fn bad_headers_are_named_by_line() {
        for (good, bad, expected) in [
            (
                "format ascii 1.0",
                "format asci 1.0",
                "line 2: expected a line of a PLY header, found \"format asci 1.0\"",
            ),
            (
                "format ascii 1.0",
                "comment",
                "line 1: No format line found.",
            ),
            (
                "comment by hand",
                "by hand",
                "line 3: expected a line of a PLY header, found \"by hand\"",
            ),
            (
                "element vertex 4",
                "element vertex -4",
                "line 4: expected a line of a PLY header, found \"element vertex -4\"",
            ),
            (
                "element vertex 4",
                "element vertex 99999999999999999999",
                "line 4: expected a line of a PLY header, found \"element vertex 99999999999999999999\"",
            ),
            (
                "element vertex 4",
                "element point 4",
                "line 10: expected an element \"vertex\" in the header, found none",
            ),
            (
                "element face 2",
                "element faces 2",
                "line 10: expected an element \"face\" in the header, found none",
            ),
            (
                "element face 2",
                "element vertex 2",
                "line 8: the element \"vertex\" is declared a second time",
            ),
            (
                "property float y",
                "property float x",
                "line 6: the property \"x\" is declared a second time",
            ),
            (
                "property float z",
                "property float w",
                "line 4: expected a property \"z\" of element \"vertex\", found none",
            ),
            (
                "property float z",
                "property list uchar float z",
                "line 7: expected \"z\" to be a number, found another type",
            ),
            (
                "property float z",
                "property string z",
                "line 7: expected a line of a PLY header, found \"property string z\"",
            ),
            (
                "vertex_indices",
                "corners",
                "line 8: expected a property \"vertex_indices\" of element \"face\", found none",
            ),
            (
                "list uchar int",
                "list uchar float",
                "line 9: expected \"vertex_indices\" to be a list of whole numbers, found another type",
            ),
            (
                "list uchar int",
                "int",
                "line 9: expected \"vertex_indices\" to be a list of whole numbers, found another type",
            ),
            (
                "list uchar int",
                "list float int",
                "line 9: expected a list length of a whole-number type, found a float",
            ),
            (
                "end_header",
                "end",
                "line 16: expected a line \"end_header\", found the end of the file",
            ),
        ] {
            assert_eq!(
                error(ascii().replacen(good, bad, 1)),
                format!(", {expected}")
            );
        }
    }

    #[test]
    fn promises_that_the_file_cannot_keep_are_refused_at_once() {
        let big = [
            (
                "vertex 4",
                "vertex 4000000000",
                4,
                "4000000000 of element \"vertex\", for which the file needs at least 24000000000 bytes",
            ),
            (
                "face 2",
                "face 4000000000",
                8,
                "4000000000 of element \"face\", for which the file needs at least 16000000024 bytes",
            ),
            (
                "face 2",
                "face 18446744073709551615",
                8,
                "18446744073709551615 of element \"face\", for which the file needs at least 73786976294838206484 bytes",
            ),
        ];
        for (good, bad, line, text) in big {
            let found = ROWS.len();
            let expected = format!(
                ", line {line}: the header promises {text} after the header, found {found}"
            );
            assert_eq!(error(ascii().replacen(good, bad, 1)), expected);
            assert_eq!(error(gzip(ascii().replacen(good, bad, 1))), expected);
        }
        let text =
            String::from_utf8_lossy(&binary(true, "int")).replacen("face 2", "face 4000000000", 1);
        assert!(error(text).contains("promises 4000000000 of element \"face\""));
    }

    #[test]
    fn an_empty_mesh_is_an_error() {
        let head = HEAD
            .replace("vertex 4", "vertex 0")
            .replace("face 2", "face 0");
        assert_eq!(error(&head), ": expected at least one triangle, found none");
        let head = HEAD.replace("face 2", "face 0");
        assert_eq!(
            error(head + ROWS),
            ": expected at least one triangle, found none"
        );
        let head = HEAD.replace("vertex 4", "vertex 0");
        let message = error(head + "3 0 0 0\n3 0 0 0\n");
        assert_eq!(
            message,
            ", line 11: face 0 of 2: expected a vertex index, but there are no vertices, found 0"
        );
    }

    #[test]
    fn every_cut_of_a_file_is_an_error() {
        for whole in [
            ascii().into_bytes(),
            binary(false, "int"),
            binary(true, "uint8"),
        ] {
            // The edge at the end of the binary file belongs to it; the last line end does not.
            for length in 0..whole.len() - 1 {
                error(&whole[..length]);
            }
        }
    }
}

mod gzipped {
    use super::*;

    #[test]
    fn gzip_is_recognised_by_content_and_may_have_members() {
        assert_eq!(load(gzip(SQUARE)).len(), 2);
        let (head, tail) = SQUARE.split_at(20);
        assert_eq!(load([gzip(head), gzip(tail)].concat()).len(), 2);
    }

    #[test]
    fn damaged_gzip_is_an_error_with_the_byte() {
        let whole = gzip(SQUARE);
        for length in 2..whole.len() {
            let message = error(&whole[..length]);
            assert!(
                message.contains("the gzip data is damaged or cut off"),
                "{message}"
            );
            assert!(message.starts_with(", byte "), "{message}");
        }
        let mut wrong_sum = whole.clone();
        let at = whole.len() - 8;
        wrong_sum[at] ^= 1;
        assert!(error(wrong_sum).starts_with(&format!(", byte {}: ", SQUARE.len())));
    }

    #[test]
    fn a_gzip_bomb_is_refused() {
        let bomb = gzip(vec![b' '; 80 << 20]);
        assert!(bomb.len() < 1 << 20);
        let message = error(bomb);
        assert!(message.contains("unpacks to more than"), "{message}");
    }
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let absent = folder.path().join("absent.obj");
    let message = load_mesh(&absent).unwrap_err().to_string();
    assert!(
        message.starts_with(&format!("{}: cannot be read: ", absent.display())),
        "{message}"
    );
    let message = load_mesh(folder.path()).unwrap_err().to_string();
    assert!(
        message.ends_with(": cannot be read: not a regular file"),
        "{message}"
    );
}

#[test]
fn the_name_of_a_file_does_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.ply");
    std::fs::write(&path, gzip(SQUARE)).unwrap();
    assert_eq!(load_mesh(&path).unwrap().len(), 2);
}
