//! Triangles and rays of every nature, and a case to trace them in.
#![allow(dead_code)] // Each test binary uses some of it.

use dacrt::random::{hash, unit_f64};
use dacrt::*;
use glam::Vec3;

/// Random triangles: large, small, flat, degenerate and invalid ones, some of them twice.
pub fn soup(n: usize, seed: u64) -> Mesh {
    let mut triangles: Vec<Triangle> = (0..n as u64)
        .map(|i| {
            let r = |k| unit_f64(hash(seed, i, k)) as f32 * 2.0 - 1.0;
            let size = 10f32.powf(-2.0 * unit_f64(hash(seed, i, 20)) as f32);
            let center = Vec3::new(r(0), r(1), r(2));
            let corner = |k| center + size * Vec3::new(r(k), r(k + 1), r(k + 2));
            let (a, mut b, mut c) = (corner(3), corner(6), corner(9));
            match hash(seed, i, 21) % 16 {
                0 => c = b,
                1 => (b.z, c.z) = (a.z, a.z),
                2 => (b.x, c.x) = (a.x, a.x),
                3 => b.y = f32::NAN,
                _ => {}
            }
            Triangle::new(a, b, c)
        })
        .collect();
    for i in 0..n / 8 {
        triangles[n - 1 - i] = triangles[i];
    }
    Mesh::new(triangles)
}

pub fn direction(seed: u64, i: u64) -> Vec3 {
    let r = |k| unit_f64(hash(seed, i, k)) as f32 * 2.0 - 1.0;
    let mut d = Vec3::new(r(10), r(11), r(12));
    match hash(seed, i, 13) % 32 {
        0 => d.x = 0.0,
        1 => (d.x, d.y) = (-0.0, 0.0),
        2 => d.z = 1e-39,
        3 => d *= 1e5,
        _ => {}
    }
    d
}

pub fn random_rays(n: usize, seed: u64, shared: bool) -> Batch {
    (0..n as u64)
        .map(|i| {
            let r = |k| unit_f64(hash(seed, i, k)) as f32 * 2.4 - 1.2;
            let mut ray = Ray::new(Vec3::new(r(0), r(1), r(2)), direction(seed, i));
            if shared {
                ray.origin = Vec3::new(0.1, -0.2, 0.3);
            }
            match hash(seed, i, 14) % 16 {
                0 => ray.tmax = unit_f64(hash(seed, i, 15)) as f32,
                1 => ray.tmin = unit_f64(hash(seed, i, 15)) as f32,
                2 => ray.direction.y = f32::NAN,
                3 => ray.tmin = -1.0,
                _ => {}
            }
            ray
        })
        .collect()
}

/// Parameters of the methods that split space.
pub fn space_presets() -> [SpaceParameters; 3] {
    [
        SpaceParameters::MORA2011,
        SpaceParameters::MORA2011_CONES,
        SpaceParameters::MORA2011_RANDOM,
    ]
}

/// The same, down to single triangles, rays and cones, as wide as they can be.
pub fn finest_space() -> [SpaceParameters; 3] {
    space_presets().map(|preset| SpaceParameters {
        ray_limit: 1,
        triangle_limit: 1,
        cone_limit: 1,
        widest_cone: 60.0,
        ..preset
    })
}

/// The same for the methods that split lists of triangles.
pub fn finest_object() -> [ObjectParameters; 2] {
    [ObjectParameters::AFRA2012, ObjectParameters::NABATA2013].map(|preset| ObjectParameters {
        leaf_triangles: 1,
        leaf_rays: 0,
        min_rays: 0,
        ..preset
    })
}

/// `best` with the smallest blocks and clusters: with groups to the end, without any, and with rays in their
/// old order.
pub fn finest_best() -> [BestParameters; 3] {
    let fine = BestParameters {
        block: 64,
        sorted_block: 64,
        window: 64,
        sort: Sort::Always,
        flush: 0.0,
        cell_triangles: 1.0,
    };
    let never = BestParameters {
        sort: Sort::Never,
        flush: 0.5,
        ..fine
    };
    [fine, BestParameters { flush: 1.0, ..fine }, never]
}

/// All presets, and all down to the smallest.
pub fn presets_and_finest() -> Vec<Parameters> {
    let presets = Method::ALL.map(Method::parameters).into_iter();
    presets
        .chain(finest_object().map(Parameters::from))
        .chain(finest_space().map(Parameters::from))
        .chain(finest_best().map(Parameters::from))
        .collect()
}

/// One leaf: the naive step over everything.
pub fn brute_force() -> ObjectParameters {
    ObjectParameters {
        leaf_triangles: u32::MAX,
        ..ObjectParameters::AFRA2012
    }
}

/// Traces with new memory each time.
pub struct Case {
    pub mesh: Mesh,
    pub batch: Batch,
}

impl Case {
    pub fn new(mesh: Mesh, batch: Batch) -> Case {
        Case { mesh, batch }
    }

    fn workspace(&self, tracer: Tracer) -> Workspace {
        tracer.workspace(self.batch.len(), self.mesh.len())
    }

    pub fn nearest(&self, tracer: Tracer) -> (Hits, Trace) {
        self.nearest_in(tracer, &mut self.workspace(tracer))
    }

    pub fn nearest_in(&self, tracer: Tracer, workspace: &mut Workspace) -> (Hits, Trace) {
        let mut hits = Hits::misses(self.batch.len());
        let trace = tracer.nearest(&self.mesh, &self.batch, workspace, &mut hits);
        (hits, trace)
    }

    pub fn any(&self, tracer: Tracer) -> (Vec<u8>, Trace) {
        let mut occluded = vec![7; self.batch.len()];
        let mut workspace = self.workspace(tracer);
        let trace = tracer.any(&self.mesh, &self.batch, &mut workspace, &mut occluded);
        (occluded, trace)
    }
}

pub fn bits(hits: &Hits) -> (Vec<u32>, &[u32]) {
    (hits.t.iter().map(|t| t.to_bits()).collect(), &hits.prim)
}

/// What is traced with each of some parameters, on all instruction sets.
#[derive(Clone)]
pub struct Check {
    pub mesh: Mesh,
    pub batch: Batch,
    pub parameters: Vec<Parameters>,
    /// Whether the origins are taken for ones of their own.
    pub own_origins: bool,
    /// Whether there are rays nearly in the planes of triangles. Their hits may be lost where
    /// triangles are held against cells by more than their boxes.
    pub grazing: bool,
}

impl Check {
    /// Traces on a thread with a small stack. The hits, nearest and any, are those of the naive step
    /// over everything, the traces the same on all instruction sets. Returns the trace of the nearest
    /// hits for each of the parameters.
    pub fn run(self) -> Vec<Trace> {
        std::thread::Builder::new()
            .stack_size(256 << 10)
            .spawn(move || self.traces())
            .unwrap()
            .join()
            .unwrap()
    }

    fn traces(&self) -> Vec<Trace> {
        let (rays, triangles) = (self.batch.len(), self.mesh.len());
        let mut hits = Hits::misses(rays);
        let mut any = vec![7; rays];
        let naive = Tracer::new(brute_force()).with_own_origins(self.own_origins);
        let mut workspace = naive.workspace(rays, triangles);
        naive.nearest(&self.mesh, &self.batch, &mut workspace, &mut hits);
        let expected = hits.clone();

        let mut traces = Vec::new();
        for &parameters in &self.parameters {
            let mut workspace = Workspace::new(&parameters, rays, triangles);
            let mut first = None;
            for isa in Isa::available() {
                let tracer = Tracer::new(parameters)
                    .with_isa(isa)
                    .with_own_origins(self.own_origins);
                let found = (
                    tracer.nearest(&self.mesh, &self.batch, &mut workspace, &mut hits),
                    tracer.any(&self.mesh, &self.batch, &mut workspace, &mut any),
                );
                self.assert_right(&hits, &any, &expected, &tracer);
                assert_eq!(&found, first.get_or_insert(found), "{tracer:?}");
            }
            traces.extend(first.map(|(nearest, _)| nearest));
        }
        traces
    }

    fn assert_right(&self, hits: &Hits, any: &[u8], expected: &Hits, tracer: &Tracer) {
        for (i, ray) in self.batch.iter().enumerate() {
            let hit = |hits: &Hits| (hits.t[i].to_bits(), hits.prim[i]);
            let (found, right) = (hit(hits), hit(expected));
            let occluded = (right.1 != MISS) as u8;
            if found == right && any[i] == occluded {
                continue;
            }
            let lost = self.grazing && found >= right && any[i] <= occluded;
            if lost && is_grazing(&ray, &self.mesh.triangles()[right.1 as usize]) {
                continue;
            }
            panic!(
                "ray {i}, {ray:?}, hits {} at {:e}, expected {} at {:e}; any hit: {}\n{tracer:?}",
                found.1, hits.t[i], right.1, expected.t[i], any[i]
            );
        }
    }
}

/// Whether a ray is so near to the plane of a triangle (|cos| < 2⁻¹⁰ to its normal) that no margin of
/// the tests of triangles against cells covers the error of t.
fn is_grazing(ray: &Ray, triangle: &Triangle) -> bool {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
    let (normal, d) = ((b - a).cross(c - a), ray.direction.as_dvec3());
    normal.dot(d).abs() < normal.length() * d.length() / 1024.0
}
