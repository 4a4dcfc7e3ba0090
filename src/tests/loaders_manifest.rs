//! Loads the benchmark meshes that are at hand (in the folders of `DACRT_MESHES`) and compares
//! triangle count, bounding box and number of zero-area triangles with the published ones.

use dacrt::scene::load_mesh;
use dacrt::{Mesh, Triangle};
use std::path::PathBuf;
use std::time::Instant;

struct Published {
    file: &'static str,
    triangles: usize,
    min: [f32; 3],
    max: [f32; 3],
    zero_area: usize,
}

const fn mesh(
    file: &'static str,
    triangles: usize,
    min: [f32; 3],
    max: [f32; 3],
    zero_area: usize,
) -> Published {
    Published {
        file,
        triangles,
        min,
        max,
        zero_area,
    }
}

#[rustfmt::skip]
const MESHES: [Published; 16] = [
    mesh("sibenik.obj.gz", 75_284, [-20.1411, -15.3123, -8.4968], [20.1411, 15.3, 8.4968], 9),
    mesh("conference.ply", 331_179, [-1020.13, -2.7924, -1055.66], [1685.81, 650.293, 668.489], 53_627),
    mesh("sponza_crytek_262k.ply", 262_267, [-1920.946, -126.4425, -1182.807], [1799.908, 1429.433, 1105.426], 1),
    mesh("sponza_crytek.ply", 279_163, [-1920.946, -126.4425, -1182.807], [1799.908, 1429.433, 1105.426], 1),
    mesh("sponza_dabrovic.obj.gz", 66_450, [-17.40276, -0.906689, -7.798512], [17.41724, 15.65331, 7.801488], 6),
    mesh("sanmiguel_building.ply", 1_012_685, [-37.9736, -36.9363, -0.381559], [46.7744, 36.9507, 53.5196], 239),
    mesh("sanmiguel_tables.ply.gz", 3_782_866, [-20.60079, -12.94879, -0.168698], [26.54819, 3.23894, 6.566195], 0),
    mesh("kitchen.obj.gz", 56_939, [-1.930758, -0.034231, -2.479913], [3.614574, 2.523191, 2.593479], 25),
    mesh("cornell_box.obj", 36, [-1.02, 0.0, -1.04], [1.0, 1.99, 0.99], 0),
    mesh("bunny.obj.gz", 69_451, [-0.0946899, 0.0329874, -0.0618736], [0.0610091, 0.187321, 0.0587997], 0),
    mesh("armadillo_86k.obj.gz", 86_482, [-0.435275, -0.573402, -0.379481], [0.403342, 0.426549, 0.38333], 0),
    mesh("buddha_100k.obj.gz", 100_000, [-0.460955, -1.002223, -0.323877], [0.35222, 0.9775, 0.490175], 0),
    mesh("dragon.ply", 871_414, [-0.108324, 0.0527295, -0.0504143], [0.0965662, 0.197173, 0.0412075], 108),
    mesh("lucy_100k.ply", 99_970, [225.906, -388.421, -605.89], [1156.03, 145.348, 991.332], 0),
    mesh("toasters_frame004.obj.gz", 11_141, [-400.0, -14.0, -400.0], [400.0, 165.8058, 400.0], 0),
    mesh("hand_frame00.obj.gz", 17_135, [-0.371823, -0.0119195, -0.416061], [0.443318, 0.630693, 0.0123101], 0),
];

fn find(file: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("DACRT_MESHES")?;
    std::env::split_paths(&folders)
        .map(|folder| folder.join(file))
        .find(|path| path.exists())
}

fn has_zero_area(t: &Triangle) -> bool {
    let [a, b, c] = [t.a, t.b, t.c].map(|p| p.as_dvec3());
    (b - a).cross(c - a) == glam::DVec3::ZERO
}

#[test]
fn meshes_are_those_of_the_manifest() {
    for published in &MESHES {
        let Some(path) = find(published.file) else {
            println!("notice: mesh {} not at hand", published.file);
            continue;
        };
        let start = Instant::now();
        let mesh: Mesh = load_mesh(&path).unwrap_or_else(|e| panic!("{e}"));
        let seconds = start.elapsed().as_secs_f64();
        println!("{}: loaded in {seconds:.3} s", published.file);

        assert_eq!(mesh.len(), published.triangles, "{}", published.file);
        assert_eq!(mesh.dropped(), 0, "{}", published.file);
        let bounds = mesh.bounds();
        for (found, expected) in [(bounds.min, published.min), (bounds.max, published.max)] {
            for (found, expected) in found.to_array().into_iter().zip(expected) {
                // Printed with six or seven digits.
                let error = (found - expected).abs();
                assert!(
                    error <= 5e-6 * expected.abs(),
                    "{}: bounds {bounds:?}",
                    published.file
                );
            }
        }
        let zero_area = mesh.triangles().iter().filter(|t| has_zero_area(t)).count();
        assert_eq!(zero_area, published.zero_area, "{}", published.file);
    }
}
