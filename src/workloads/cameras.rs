//! Cameras of a scene that nobody chose: in an interior at random places from which much is seen,
//! around an object on a sphere.

use super::{Camera, WorkloadError};
use crate::geometry::{Aabb, Mesh};
use crate::random::{hash, unit_f64};
use crate::rays::{Batch, Hits, Ray};
use glam::DVec3;

/// How many cameras are made of a scene.
pub const GENERATED_CAMERAS: usize = 16;

/// Places that are looked at for an interior.
const PLACES: u64 = 2048;
/// Rays from a place to all sides; and of a picture that tells what is in view.
const PROBES: u64 = 64;
/// Pictures from a place, turned evenly about the up direction.
const TURNS: u64 = 8;
/// Share of the probes that hit something, where a place is inside.
const INSIDE: f64 = 0.75;
/// Share of a picture's probes that hit something.
const FILLED: f64 = 0.75;
/// The least distance to anything, as a share of the scene's diagonal.
const CLEARANCE: f64 = 0.01;
/// The median distance of what is in view, as a share of the scene's diagonal.
const OUTLOOK: f64 = 0.1;
/// The most that an interior's camera looks up or down, in radians.
const TILT: f64 = 0.35;

/// Keys of the random numbers.
const KEY_PLACE: u64 = 6 << 8;
const KEY_TURN: u64 = 7 << 8;

/// Up to [`GENERATED_CAMERAS`] cameras with the up direction and the vertical field of view (degrees)
/// of a camera that somebody chose. If its `eye` is within the mesh's box, these are in there, too:
/// three quarters of what is around them is the scene, nothing is nearer than a hundredth of its
/// diagonal, and the median distance of what they see is a tenth of it or more; where that is true
/// of fewer places than are asked for, half of these distances will do, and so on. If it is not,
/// they are around the middle of the box, as far from it as the `eye`, evenly on a sphere. `nearest`
/// finds nearest hits, of about two million rays at most.
///
/// The same mesh and camera give the same cameras on every machine.
///
/// # Errors
/// What [`Camera::new`] says of `up` and `fov_degrees`.
pub fn generated_cameras(
    mesh: &Mesh,
    eye: DVec3,
    up: DVec3,
    fov_degrees: f64,
    nearest: &mut dyn FnMut(&Batch) -> Hits,
) -> Result<Vec<Camera>, WorkloadError> {
    let bounds = mesh.bounds();
    if bounds == Aabb::EMPTY {
        return Ok(Vec::new());
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let frame = Frame::new(up)?;
    let camera = |eye, look_at| Camera::new(eye, look_at, up, fov_degrees);
    if !(eye.cmpge(min) & eye.cmple(max)).all() {
        let middle = 0.5 * (min + max);
        let distance = eye.distance(middle);
        let count = GENERATED_CAMERAS as u64;
        return (0..count)
            .map(|i| camera(middle + distance * frame.on_sphere(i, count), middle))
            .collect();
    }

    let diagonal = min.distance(max);
    let places: Vec<DVec3> = (0..PLACES)
        .map(|i| {
            let [x, y, z] = [0, 1, 2].map(|axis| unit_f64(hash(0, KEY_PLACE, 3 * i + axis)));
            // As rays start there.
            (min + DVec3::new(x, y, z) * (max - min))
                .as_vec3()
                .as_dvec3()
        })
        .collect();
    let around = probe(&places, PROBES, nearest, |_, k| frame.on_sphere(k, PROBES));
    let inside: Vec<(DVec3, f64)> = (places.iter().zip(around.chunks(PROBES as usize)))
        .filter(|(_, distances)| share_of_hits(distances) >= INSIDE)
        .map(|(&place, distances)| {
            (
                place,
                distances.iter().copied().fold(f64::INFINITY, f64::min),
            )
        })
        .collect();

    let mut views = Vec::new();
    for (i, &(place, clearance)) in inside.iter().enumerate() {
        for turn in 0..TURNS {
            let index = 2 * (i as u64 * TURNS + turn);
            let [a, b] = [index, index + 1].map(|k| unit_f64(hash(0, KEY_TURN, k)));
            let angle = std::f64::consts::TAU * (turn as f64 + a) / TURNS as f64;
            let forward = frame.direction(angle, TILT * (2.0 * b - 1.0));
            views.push((place, clearance, camera(place, place + forward)?));
        }
    }
    let eyes: Vec<DVec3> = views.iter().map(|(place, ..)| *place).collect();
    let in_view = probe(&eyes, PROBES, nearest, |eye, k| {
        let edge = PROBES.isqrt();
        let [x, y] = [k % edge, k / edge].map(|step| (step as f64 + 0.5) / edge as f64);
        views[eye].2.direction(x, y, 1.0).as_dvec3()
    });
    let outlooks: Vec<f64> = (in_view.chunks(PROBES as usize))
        .map(|distances| match share_of_hits(distances) >= FILLED {
            true => median(distances),
            false => 0.0,
        })
        .collect();

    let mut patience = 1.0;
    loop {
        let mut chosen: Vec<(DVec3, Camera)> = Vec::new();
        for ((place, clearance, camera), outlook) in views.iter().zip(&outlooks) {
            let is_new = chosen.last().is_none_or(|(last, _)| last != place);
            let is_clear = *clearance >= patience * CLEARANCE * diagonal;
            if is_new && is_clear && *outlook >= patience * OUTLOOK * diagonal {
                chosen.push((*place, *camera));
            }
        }
        if chosen.len() >= GENERATED_CAMERAS || patience < 1e-3 {
            let cameras = chosen.into_iter().map(|(_, camera)| camera);
            return Ok(cameras.take(GENERATED_CAMERAS).collect());
        }
        patience *= 0.5;
    }
}

/// Distances to what `count` rays from each place hit; infinite for those that miss.
fn probe(
    places: &[DVec3],
    count: u64,
    nearest: &mut dyn FnMut(&Batch) -> Hits,
    direction: impl Fn(usize, u64) -> DVec3,
) -> Vec<f64> {
    let ray = |place: usize, k| Ray::new(places[place].as_vec3(), direction(place, k).as_vec3());
    let batch: Batch = (0..places.len())
        .flat_map(|place| (0..count).map(move |k| (place, k)))
        .map(|(place, k)| ray(place, k))
        .collect();
    nearest(&batch).t.into_iter().map(f64::from).collect()
}

fn share_of_hits(distances: &[f64]) -> f64 {
    let hits = distances.iter().filter(|t| t.is_finite()).count();
    hits as f64 / distances.len() as f64
}

fn median(distances: &[f64]) -> f64 {
    let mut sorted = distances.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// A basis with the up direction.
struct Frame {
    up: DVec3,
    ahead: DVec3,
    aside: DVec3,
}

impl Frame {
    fn new(up: DVec3) -> Result<Frame, WorkloadError> {
        let Some(up) = up.try_normalize() else {
            return Err(WorkloadError::NoUp {
                up,
                view: DVec3::ZERO,
            });
        };
        let (ahead, aside) = up.any_orthonormal_pair();
        Ok(Frame { up, ahead, aside })
    }

    /// A unit vector by its angle about the up direction and over the horizon.
    fn direction(&self, angle: f64, elevation: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(angle);
        let (height, radius) = libm::sincos(elevation);
        radius * (cos * self.ahead + sin * self.aside) + height * self.up
    }

    /// The `i`-th of `count` unit vectors that lie evenly on the sphere (a Fibonacci spiral).
    fn on_sphere(&self, i: u64, count: u64) -> DVec3 {
        let height = 1.0 - (2 * i + 1) as f64 / count as f64;
        let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let (sin, cos) = libm::sincos(golden_angle * i as f64);
        let radius = (1.0 - height * height).sqrt();
        radius * (cos * self.ahead + sin * self.aside) + height * self.up
    }
}
