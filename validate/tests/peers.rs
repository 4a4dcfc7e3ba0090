//! Other libraries against brute force, and in `dacrt run`.

mod command;
mod common;

use command::Folder;

#[cfg(feature = "peers")]
mod built_in {
    use super::common::{Form, any, nearest, rays, soup};
    use super::*;
    use dacrt::{Hits, Mesh, Triangle};
    use dacrt_validate::judge::Answers;
    use dacrt_validate::peers::{self, differing_rays};
    use fastrand::Rng;
    use glam::Vec3;

    /// Triangles, with some among them that have no area or are not valid.
    fn mesh(random: &mut Rng) -> Mesh {
        let mut triangles = soup(random, 400, 0.3, 1.0, Vec3::ZERO).into_triangles();
        for i in (0..400).step_by(7) {
            let Triangle { a, b, .. } = triangles[i];
            triangles[i] = match i % 4 {
                0 => Triangle::new(a, a, a),
                1 => Triangle::new(a, b, a),
                2 => Triangle::new(a, b, (a + b) / 2.0),
                _ => Triangle::new(a, b, Vec3::NAN),
            };
        }
        Mesh::new(triangles)
    }

    #[test]
    fn each_agrees_with_brute_force_on_nearly_all_rays() {
        let random = &mut Rng::with_seed(1);
        let mesh = mesh(random);
        let mut batch = rays(random, 5_000, 1.0, Vec3::ZERO, Form::Plain);
        // Intervals, and rays that are not valid.
        for i in (0..batch.len()).step_by(3) {
            batch.tmin[i] = 0.2 * random.f32();
            batch.tmax[i] = 0.3 + random.f32();
        }
        batch.tmax[3] = -1.0;
        batch.direction[1][4] = f32::NAN;
        let hits = nearest(&mesh, &batch, Form::Plain);
        let occluded = any(&mesh, &batch, Form::Plain);
        assert!(hits.hit_count() > 1_000 && hits.hit_count() < 4_500);
        for peer in peers::ALL {
            let name = format!("{} {}", peer.name, peer.builder);
            let (tree, ms) = peer.build(&mesh).expect(&name);
            assert!(ms > 0.0 && tree.bytes().is_none_or(|bytes| bytes > 0));
            let mut theirs = Hits::misses(batch.len());
            tree.nearest(&batch, &mut theirs);
            let differing = differing_rays(Answers::Nearest(&hits), Answers::Nearest(&theirs));
            assert!(differing <= 10, "{name}: {differing} rays");
            let mut theirs = vec![2; batch.len()];
            tree.any(&batch, &mut theirs);
            let differing = differing_rays(Answers::Any(&occluded), Answers::Any(&theirs));
            assert!(differing <= 10, "{name}: {differing} rays, any hit");
        }
    }

    #[test]
    fn meshes_of_few_triangles_break_nothing() {
        let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let point = Triangle::new(Vec3::ONE, Vec3::ONE, Vec3::ONE);
        let invalid = Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y);
        let random = &mut Rng::with_seed(2);
        let batch = rays(random, 100, 1.0, Vec3::ZERO, Form::Plain);
        for triangles in [
            vec![triangle],
            vec![point; 100],
            vec![triangle; 100],
            vec![invalid, triangle],
        ] {
            let mesh = Mesh::new(triangles);
            let expected = any(&mesh, &batch, Form::Plain);
            for peer in peers::ALL {
                let name = format!("{} {}, {} triangles", peer.name, peer.builder, mesh.len());
                // Where debug assertions are on, obvhs refuses trees that are deeper than its stack.
                let Some((tree, _)) = peer.build(&mesh) else {
                    assert!(cfg!(debug_assertions) && peer.name == "obvhs", "{name}");
                    continue;
                };
                let mut theirs = vec![2; batch.len()];
                tree.any(&batch, &mut theirs);
                assert_eq!(theirs, expected, "{name}");
            }
        }
        for none in [vec![], vec![invalid]] {
            let mesh = Mesh::new(none);
            assert!(peers::ALL.iter().all(|peer| peer.build(&mesh).is_none()));
        }
    }

    #[test]
    fn versions_are_those_of_the_lock_file() {
        let lock = include_str!("../../Cargo.lock");
        for peer in peers::ALL {
            let entry = format!("name = \"{}\"\nversion = \"{}\"\n", peer.name, peer.version);
            assert!(lock.contains(&entry), "{entry}");
        }
    }

    #[test]
    fn a_run_has_them_in_its_cells_and_tables() {
        let folder = Folder::new();
        let run = folder.dacrt(
            "run --scenes tiny.json --rays primary,shadow-point --methods afra2012 \
             --resolution 32 --repeats 2 --peers --out out.json",
        );
        run.exits(0);
        let table = run.stdout();
        assert!(table.contains("  vs obvhs "), "{table}");
        assert!(table.contains("vs another library"), "{table}");
        for cell in folder.json("out.json")["cells"].as_array().unwrap() {
            let entries = cell["peers"].as_array().unwrap();
            assert_eq!(entries.len(), peers::ALL.len());
            for entry in entries {
                assert_eq!(entry["trace_samples_ms"].as_array().unwrap().len(), 2);
                assert!(entry["build_ms"].as_f64().unwrap() > 0.0);
                assert!(entry["differing_rays"].as_u64().unwrap() <= 2, "{entry}");
            }
        }
        let memory = folder.dacrt("table out.json --memory");
        let memory = memory.exits(0).stdout();
        let heads = memory.lines().next().unwrap();
        let heads: Vec<&str> = heads.split_whitespace().collect();
        let expected = [
            "scene", "rays", "size", "method", "ours", "Embree", "obvhs", "bvh",
        ];
        assert_eq!(heads, expected);
    }
}

#[test]
#[cfg(not(feature = "peers"))]
fn without_them_the_option_says_how_to_build_them_in() {
    let run = Folder::new().dacrt("run --scenes tiny.json --peers");
    run.refuses(&[
        "--peers",
        "cargo build --release -p dacrt-validate --features peers",
    ]);
}
