//! Rays in and hits out: NumPy's own bytes, and a message for each thing that can be wrong.

use dacrt::{Batch, Hits, Ray};
use dacrt_validate::npy::{read_rays, read_rays_from, write_hits, write_occluded, write_rays};
use glam::Vec3;
use proptest::prelude::*;
use std::fs;
use std::io::Read;
use std::path::Path;

/// What `numpy.save` (2.4.6) writes for `numpy.arange(16, dtype='<f4').reshape(2, 8)`.
fn numpy_file() -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00v\x00".to_vec();
    bytes.extend(
        format!(
            "{:117}\n",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), }"
        )
        .bytes(),
    );
    bytes.extend((0..16).flat_map(|i| (i as f32).to_le_bytes()));
    bytes
}

fn read(bytes: &[u8]) -> Result<Batch, String> {
    read_rays_from(bytes, bytes.len() as u64).map_err(|e| e.to_string())
}

/// A file with this header and the data of 16 floats.
fn with_header(text: &str) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.bytes());
    bytes.extend([0; 64]);
    bytes
}

#[test]
fn reads_what_numpy_writes() {
    let batch = read(&numpy_file()).unwrap();
    assert_eq!(batch.len(), 2);
    let ray = Ray {
        origin: Vec3::new(8.0, 9.0, 10.0),
        tmin: 11.0,
        direction: Vec3::new(12.0, 13.0, 14.0),
        tmax: 15.0,
    };
    assert_eq!(batch.ray(1), ray);
}

#[test]
fn reads_other_spellings_of_the_header() {
    for text in [
        "{'shape':(2,8),'fortran_order':False,'descr':'<f4'}\n",
        "{\"descr\": \"<f4\", \"fortran_order\": False, \"shape\": (2, 8,)}",
    ] {
        assert_eq!(read(&with_header(text)).map(|b| b.len()), Ok(2), "{text}");
    }
    // Versions 2 and 3 have a longer length.
    for version in [2, 3] {
        let mut bytes = numpy_file();
        bytes[6] = version;
        bytes.splice(10..10, [0, 0]);
        assert_eq!(read(&bytes).map(|b| b.len()), Ok(2));
    }
}

#[test]
fn rays_survive_writing_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rays.npy");
    let odd = Ray {
        tmin: f32::NAN,
        ..Ray::new(Vec3::splat(-0.0), Vec3::splat(1e-45))
    };
    let batch: Batch = [odd, Ray::new(Vec3::ONE, Vec3::X)].into_iter().collect();
    write_rays(&path, &batch).unwrap();
    let back = read_rays(&path).unwrap();
    let bits = |b: &Batch| format!("{b:?}");
    assert_eq!(bits(&back), bits(&batch));
    assert_eq!(back.origin[0][0].to_bits(), (-0.0_f32).to_bits());
    // NumPy aligns data to 64 bytes.
    assert_eq!(fs::read(&path).unwrap().len(), 128 + 64);
}

#[test]
fn every_wrong_thing_has_its_own_message() {
    let header = |descr: &str, order: &str, shape: &str| {
        with_header(&format!(
            "{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}"
        ))
    };
    let good = ("'<f4'", "False", "(2, 8)");
    let cases: Vec<(Vec<u8>, &[&str])> = vec![
        (
            header("'<f8'", good.1, good.2),
            &["<f8", "expected float32 ('<f4')"],
        ),
        (header("'|O'", good.1, good.2), &["|O", "expected float32"]),
        (
            header("[('x', '<f4')]", good.1, good.2),
            &["[('x', '<f4')]", "expected float32"],
        ),
        (
            header("'>f4'", good.1, good.2),
            &["big-endian", "little-endian"],
        ),
        (
            header(good.0, "True", good.2),
            &["Fortran order", "C order"],
        ),
        (
            header(good.0, good.1, "(2, 7)"),
            &["(2, 7)", "expected (N, 8)"],
        ),
        (
            header(good.0, good.1, "(16,)"),
            &["(16,)", "expected (N, 8)"],
        ),
        (header(good.0, good.1, "()"), &["()", "expected (N, 8)"]),
        (header(good.0, good.1, "(2, 8, 1)"), &["(2, 8, 1)"]),
        (
            header(good.0, good.1, "(-2, 8)"),
            &["bytes 10 to", "(-2, 8)", "invalid digit"],
        ),
        (
            header(good.0, good.1, "(99999999999999999999, 8)"),
            &["too large"],
        ),
        (
            header(good.0, "no", good.2),
            &["expected True or False, found `no"],
        ),
        (header("4", good.1, good.2), &["expected a type"]),
        (
            with_header("{'descr': '<f4', 'shape': (2, 8)}"),
            &["'fortran_order' is missing"],
        ),
        (with_header("{'colour': 3}"), &["unknown key 'colour'"]),
        (with_header("rays"), &["dictionary"]),
        (with_header("{'descr'"), &["dictionary"]),
        (
            with_header("{é}"),
            &["expected a quoted key and a colon at `é`"],
        ),
        (
            numpy_file()[..100].to_vec(),
            &["ends at byte 100 within the header", "byte 128"],
        ),
        (
            numpy_file()[..9].to_vec(),
            &["ends at byte 9 within the header"],
        ),
        (
            numpy_file()[..150].to_vec(),
            &["192 bytes", "2 rays", "but is 150"],
        ),
        (
            [numpy_file(), vec![0]].concat(),
            &["192 bytes", "but is 193"],
        ),
        (b"\x93NUMPY\x09\x00".to_vec(), &["version 9.0"]),
        (
            b"ply\nformat ascii".to_vec(),
            &["not an .npy file", "ply\\nform"],
        ),
        (
            b"PK\x03\x04abcdef".to_vec(),
            &["not an .npy file", "numpy.save"],
        ),
        (vec![], &["not an .npy file"]),
    ];
    for (bytes, expected) in cases {
        let message = read(&bytes).expect_err(&bytes.escape_ascii().to_string());
        for part in expected {
            assert!(message.contains(part), "`{message}` lacks `{part}`");
        }
    }
}

#[test]
fn a_promise_of_many_rays_takes_no_memory() {
    for shape in ["(4000000000, 8)", "(18446744073709551615, 8)"] {
        let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}");
        let message = read(&with_header(&text)).unwrap_err();
        assert!(message.contains("rays after a header of"), "{message}");
    }
    // A header of 4 GB.
    let mut bytes = b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec();
    bytes.extend([b' '; 100]);
    assert!(read(&bytes).unwrap_err().contains("within the header"));
}

#[test]
fn messages_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none.npy");
    let message = read_rays(&missing).unwrap_err().to_string();
    assert!(
        message.contains("none.npy: cannot be read: No such file"),
        "{message}"
    );
    let short = folder.path().join("short.npy");
    fs::write(&short, b"\x93NUMPY").unwrap();
    let message = read_rays(&short).unwrap_err().to_string();
    assert!(
        message.contains("short.npy: is not an .npy file"),
        "{message}"
    );
    let message = read_rays(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains("cannot be read: Is a directory"),
        "{message}"
    );
}

#[test]
fn unwritable_outputs_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let no_folder = folder.path().join("none").join("hits.npz");
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let cases: [(&Path, &str); 3] = [
        (&no_folder, "none/hits.npz: cannot be written: No such file"),
        (folder.path(), "cannot be written: is a directory"),
        (&file.join("hits.npz"), "cannot be written: Not a directory"),
    ];
    for (path, expected) in cases {
        let message = write_hits(path, &Hits::misses(1)).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
        assert!(!message.contains(".dacrt-"), "{message}");
    }
}

/// A rename must not take the place of a device or of a link.
#[cfg(unix)]
#[test]
fn devices_and_links_stay() {
    use std::os::unix::fs::FileTypeExt;
    write_hits(Path::new("/dev/null"), &Hits::misses(1)).unwrap();
    assert!(
        fs::metadata("/dev/null")
            .unwrap()
            .file_type()
            .is_char_device()
    );
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, "").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_hits(&link, &Hits::misses(1)).unwrap();
    assert!(link.is_symlink() && fs::metadata(&file).unwrap().len() > 0);
}

/// The members of an archive.
fn members(path: &Path) -> Vec<(String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    (0..archive.len())
        .map(|i| {
            let mut member = archive.by_index(i).unwrap();
            let mut bytes = Vec::new();
            member.read_to_end(&mut bytes).unwrap();
            (member.name().unwrap().into_owned(), bytes)
        })
        .collect()
}

fn member(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00v\x00".to_vec();
    bytes.extend(format!("{text:117}\n").bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn hits_are_written_as_numpy_writes_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hits.npz");
    let hits = Hits {
        t: vec![1.5, f32::INFINITY],
        prim: vec![7, u32::MAX],
    };
    write_hits(&path, &hits).unwrap();
    let t = [1.5_f32, f32::INFINITY].map(f32::to_le_bytes).concat();
    let prim = [7_u32, u32::MAX].map(u32::to_le_bytes).concat();
    assert_eq!(
        members(&path),
        [
            ("t.npy".to_owned(), member("<f4", "(2,)", &t)),
            ("prim.npy".to_owned(), member("<u4", "(2,)", &prim)),
        ]
    );
    write_occluded(&path, &[0, 1, 1]).unwrap();
    let occluded = member("|u1", "(3,)", &[0, 1, 1]);
    assert_eq!(members(&path), [("occluded.npy".to_owned(), occluded)]);
    // No temporary file is left.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

proptest! {
    // PROPTEST_CASES is the number of files.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&bytes);
    }

    #[test]
    fn random_headers_do_no_harm(text in "[{}()\\[\\]'\": ,a-z0-9<>|é-]{0,80}", version in 0_u8..5) {
        let mut bytes = with_header(&text);
        bytes[6] = version;
        let _ = read(&bytes);
        let _ = read(&with_header(&format!("{{'descr': {text}")));
        let _ = read(&with_header(&format!("{{'descr': '<f4', 'shape': {text}}}")));
    }

    #[test]
    fn a_damaged_file_does_no_harm(at in 0_usize..192, to in any::<u8>(), end in 0_usize..=192) {
        let mut bytes = numpy_file();
        bytes[at] = to;
        let _ = read(&bytes[..end]);
        // The length may be a lie, as of a file that shrinks while it is read.
        let _ = read_rays_from(&bytes[..end], 192);
    }
}
