//! Throws random and damaged files at the loaders: no panic, no run-away time or memory, and an
//! error is one line. Each loop runs for a second, or for `DACRT_FUZZ_SECONDS`.

use dacrt::scene::{Description, mesh_from_bytes};
use flate2::Compression;
use flate2::write::GzEncoder;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, TestCaseResult, TestError, TestRunner};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// Counts what each thread has allocated.
struct Counting;

thread_local! {
    static LIVE: Cell<isize> = const { Cell::new(0) };
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

fn count(change: isize) {
    // A thread that ends may free after its counters are gone.
    let _ = LIVE.try_with(|live| {
        live.set(live.get() + change);
        let _ = PEAK.try_with(|peak| peak.set(peak.get().max(live.get())));
    });
}

// SAFETY: hands everything on to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Runs `test` on values of `strategy` until the time is over.
fn for_a_while<S: Strategy>(strategy: S, test: impl Fn(S::Value) -> TestCaseResult)
where
    S::Value: std::fmt::Debug,
{
    let seconds = std::env::var("DACRT_FUZZ_SECONDS").map_or(1.0, |s| s.parse().unwrap());
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let mut runs = 0;
    while Instant::now() < end {
        let cases = 256;
        let mut runner = TestRunner::new(Config {
            cases,
            failure_persistence: None,
            // Else a file that is slow to load is made smaller for hours.
            max_shrink_time: 10_000,
            ..Config::default()
        });
        match runner.run(&strategy, &test) {
            Ok(()) => runs += cases,
            Err(TestError::Fail(why, input)) => panic!("{why}: {input:?}"),
            Err(TestError::Abort(why)) => panic!("{why}"),
        }
    }
    println!("{runs} files");
}

/// Loads a file of any content; `allowance` is what it may allocate apart from a multiple of its
/// own size.
fn check_mesh(bytes: &[u8], allowance: usize) -> TestCaseResult {
    let live = LIVE.get();
    PEAK.set(live);
    let load = || {
        let start = Instant::now();
        let result = mesh_from_bytes(Path::new("mesh"), bytes);
        (result, start.elapsed())
    };
    let (result, mut elapsed) = load();
    let peak = PEAK.get() - live;
    // A busy machine may stall any one run, but a file that is slow to load is slow every time.
    for _ in 0..2 {
        if elapsed > SLOW {
            elapsed = elapsed.min(load().1);
        }
    }
    prop_assert!(elapsed <= SLOW, "took {elapsed:?}, the least of three");
    let most = allowance + 200 * bytes.len();
    prop_assert!(peak <= most as isize, "allocated {peak} bytes");
    match result {
        Ok(mesh) => {
            prop_assert!(!mesh.is_empty());
            prop_assert_eq!(mesh.triangles().len(), mesh.len());
        }
        Err(error) => {
            let message = error.to_string();
            prop_assert!(!message.contains('\n'), "{}", message);
            prop_assert!(message.len() < 1000, "{}", message);
        }
    }
    Ok(())
}

/// No file of these sizes takes longer, with room for a slow machine.
const SLOW: Duration = Duration::from_secs(2);
/// `ply-rs-bw` sets up to 65,536 list items aside for a list that is not there.
const PLAIN: usize = 4 << 20;
/// Files that unpack to 64 MiB or less are unpacked before anything is looked at.
const PACKED: usize = 400 << 20;

/// Words that matter in one of the formats.
const WORDS: [&str; 46] = [
    "0",
    "1",
    "-1",
    "3",
    "4",
    "255",
    "65536",
    "4000000000",
    "4294967295",
    "18446744073709551615",
    "-9223372036854775808",
    "1e39",
    "nan",
    "-inf",
    "1.",
    ".5",
    "\n",
    "\r",
    "\r\n",
    " ",
    "\\\n",
    "#",
    "/",
    "//",
    "v ",
    "\nf ",
    "\nf 1 2",
    "\nl 1 2 3\n",
    "\nusemtl\n",
    "ply\n",
    "format ascii 1.0\n",
    "format binary_big_endian 1.0\n",
    "element ",
    "element vertex 4294967295\n",
    "element face 4000000000\n",
    "property ",
    "property list uint uchar ",
    "property list char double ",
    "vertex_index",
    "x\n",
    "uchar ",
    "float ",
    "double ",
    "end_header\n",
    "\u{feff}",
    "\u{e9}",
];

/// One piece of damage: the place, how many bytes go, what comes instead.
type Damage = (Index, usize, Vec<u8>);

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    let instead = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..8),
        select(&WORDS[..]).prop_map(|w| w.as_bytes().to_vec()),
    ];
    let gone = prop_oneof![0..9usize, 0..200usize];
    prop::collection::vec((any::<Index>(), gone, instead), 0..6)
}

fn apply(mut bytes: Vec<u8>, damage: &[Damage]) -> Vec<u8> {
    for (place, gone, instead) in damage {
        let at = place.index(bytes.len() + 1);
        let end = (at + gone).min(bytes.len());
        bytes.splice(at..end, instead.iter().copied());
    }
    bytes
}

/// Positions, and faces of three to six corners.
type Polygons = (Vec<[f32; 3]>, Vec<Vec<u32>>);

fn polygons() -> impl Strategy<Value = Polygons> {
    let coordinate = prop_oneof![
        -10f32..10.0,
        any::<u32>().prop_map(f32::from_bits),
        select(
            &[
                0.0,
                -0.0,
                f32::NAN,
                f32::INFINITY,
                f32::MIN_POSITIVE,
                1e-45,
                f32::MAX
            ][..]
        ),
    ];
    let positions =
        prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], 1..20);
    positions.prop_flat_map(|positions| {
        let face = prop::collection::vec(0..positions.len() as u32, 3..7);
        (Just(positions), prop::collection::vec(face, 1..20))
    })
}

fn obj((positions, faces): &Polygons) -> Vec<u8> {
    let mut out = String::new();
    for [x, y, z] in positions {
        out += &format!("v {x} {y:e} {z}\n");
    }
    for (i, face) in faces.iter().enumerate() {
        out += "f";
        for corner in face {
            let back = i64::from(*corner) - positions.len() as i64;
            out += &match i % 4 {
                0 => format!(" {}", corner + 1),
                1 => format!(" {back}"),
                2 => format!(" {}/7/-8", corner + 1),
                _ => format!(" {back}//0"),
            };
        }
        out += ["\n", " # end\n", "\r\n", "\ng group\n"][i % 4];
    }
    out.into_bytes()
}

#[derive(Clone, Copy, Debug)]
enum Order {
    Ascii,
    Little,
    Big,
}

fn ply((positions, faces): &Polygons, order: Order) -> Vec<u8> {
    let format = match order {
        Order::Ascii => "ascii",
        Order::Little => "binary_little_endian",
        Order::Big => "binary_big_endian",
    };
    let mut out = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        positions.len(),
        faces.len()
    )
    .into_bytes();
    for [x, y, z] in positions {
        match order {
            Order::Ascii => out.extend(format!("{x} {y:e} {z}\n").into_bytes()),
            Order::Little => out.extend([x, y, z].into_iter().flat_map(|x| x.to_le_bytes())),
            Order::Big => out.extend([x, y, z].into_iter().flat_map(|x| x.to_be_bytes())),
        }
    }
    for face in faces {
        match order {
            Order::Ascii => {
                let words: Vec<String> = face.iter().map(u32::to_string).collect();
                out.extend(format!("{} {}\n", face.len(), words.join(" ")).into_bytes());
            }
            _ => {
                out.push(face.len() as u8);
                out.extend(face.iter().flat_map(|i| match order {
                    Order::Big => i.to_be_bytes(),
                    _ => i.to_le_bytes(),
                }));
            }
        }
    }
    out
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn check_polygons(polygons: &Polygons, bytes: &[u8]) -> TestCaseResult {
    let (positions, faces) = polygons;
    let fans = faces
        .iter()
        .flat_map(|f| f[1..].windows(2).map(|edge| [f[0], edge[0], edge[1]]));
    let expected: Vec<f32> = fans.flatten().flat_map(|i| positions[i as usize]).collect();
    let mesh = mesh_from_bytes(Path::new("mesh"), bytes)
        .map_err(|e| TestCaseError::fail(e.to_string()))?;
    let found: Vec<f32> = mesh
        .triangles()
        .iter()
        .flat_map(|t| [t.a, t.b, t.c])
        .flat_map(|p| p.to_array())
        .collect();
    // Text has one NaN only.
    let bits = |list: &[f32]| -> Vec<u32> {
        let one_nan = |x: &f32| if x.is_nan() { f32::NAN } else { *x };
        list.iter().map(|x| one_nan(x).to_bits()).collect()
    };
    prop_assert_eq!(bits(&found), bits(&expected));
    Ok(())
}

#[test]
fn a_mesh_is_the_same_in_every_format() {
    for_a_while(polygons(), |polygons| {
        check_polygons(&polygons, &obj(&polygons))?;
        check_polygons(&polygons, &gzip(&obj(&polygons)))?;
        for order in [Order::Ascii, Order::Little, Order::Big] {
            check_polygons(&polygons, &ply(&polygons, order))?;
            check_polygons(&polygons, &gzip(&ply(&polygons, order)))?;
        }
        Ok(())
    });
}

#[test]
fn random_bytes() {
    let start = select(vec![
        "",
        "ply\n",
        "ply\nformat ascii 1.0\n",
        "v ",
        "\u{1f}",
        "{",
    ]);
    let word = prop_oneof![
        3 => select(&WORDS[..]).prop_map(|w| w.as_bytes().to_vec()),
        1 => prop::collection::vec(any::<u8>(), 0..16),
    ];
    let words = prop::collection::vec(word, 0..100).prop_map(|w| w.concat());
    let noise = prop::collection::vec(any::<u8>(), 0..1000);
    for_a_while((start, prop_oneof![words, noise]), |(start, rest)| {
        check_mesh(&[start.as_bytes(), &rest].concat(), PLAIN)
    });
}

#[test]
fn damaged_obj() {
    for_a_while((polygons(), damage()), |(polygons, damage)| {
        check_mesh(&apply(obj(&polygons), &damage), PLAIN)
    });
}

#[test]
fn damaged_ascii_ply() {
    for_a_while((polygons(), damage()), |(polygons, damage)| {
        check_mesh(&apply(ply(&polygons, Order::Ascii), &damage), PLAIN)
    });
}

#[test]
fn damaged_binary_ply() {
    let order = select(vec![Order::Little, Order::Big]);
    for_a_while(
        (polygons(), order, damage()),
        |(polygons, order, damage)| check_mesh(&apply(ply(&polygons, order), &damage), PLAIN),
    );
}

#[test]
fn binary_ply_of_random_rows() {
    let scalar = select(vec![
        "char", "uchar", "short", "ushort", "int", "uint", "float", "double",
    ]);
    let list = (scalar.clone(), scalar.clone()).prop_map(|(a, b)| format!("list {a} {b}"));
    let kind = prop_oneof![scalar.prop_map(str::to_owned), list];
    let name = select(vec!["x", "y", "z", "w", "vertex_index", "vertex_indices"]);
    let property = (kind, name).prop_map(|(kind, name)| format!("property {kind} {name}\n"));
    let element = (
        select(vec!["vertex", "face", "other"]),
        prop_oneof![0..20u64, any::<u64>()],
        prop::collection::vec(property, 0..5),
    )
        .prop_map(|(name, count, properties)| {
            format!("element {name} {count}\n{}", properties.concat())
        });
    let count = || prop_oneof![4 => 0..5u64, 1 => select(vec![4_000_000_000, u64::MAX / 16])];
    let header = (
        select(vec!["ascii", "binary_little_endian", "binary_big_endian"]),
        prop::collection::vec(element, 0..4),
        any::<bool>(),
        (count(), count()),
    )
        .prop_map(|(format, elements, complete, (vertices, faces))| {
            let complete = if complete {
                format!(
                    "element vertex {vertices}\nproperty char x\nproperty char y\nproperty char z\n\
                     element face {faces}\nproperty list uchar uchar vertex_index\n"
                )
            } else {
                String::new()
            };
            format!(
                "ply\nformat {format} 1.0\n{complete}{}end_header\n",
                elements.concat()
            )
        });
    let rows = prop::collection::vec(prop_oneof![0..4u8, any::<u8>()], 0..300);
    for_a_while((header, rows), |(header, rows)| {
        check_mesh(&[header.as_bytes(), &rows].concat(), PLAIN)
    });
}

#[test]
fn damaged_gzip() {
    for_a_while(
        (polygons(), damage(), damage()),
        |(polygons, inner, outer)| {
            let packed = gzip(&apply(obj(&polygons), &inner));
            check_mesh(&apply(packed, &outer), PACKED)
        },
    );
}

#[test]
fn damaged_description() {
    let good = include_str!("../../scenes/sanmiguel-tables.json");
    for_a_while(damage(), |damage| {
        let text = apply(good.as_bytes().to_vec(), &damage);
        if let Err(error) = Description::parse(Path::new("scene"), &text) {
            prop_assert!(!error.to_string().contains('\n'), "{}", error);
        }
        Ok(())
    });
}
