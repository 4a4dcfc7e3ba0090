//! Cameras of a scene that nobody chose: in an interior where random walks end and much is seen,
//! around an object on a sphere.

use super::{Camera, WorkloadError};
use crate::geometry::{Aabb, Mesh};
use crate::random::{hash, unit_f64};
use crate::rays::{Batch, Hits, Ray};
use glam::DVec3;

/// How many cameras are made of a scene.
pub const GENERATED_CAMERAS: usize = 16;

/// Walks that end where a camera of an interior may stand, and the steps of each.
const WALKS: u64 = 512;
const STEPS: u64 = 3;
/// Rays from a place to all sides; and of a picture that tells what is in view.
const PROBES: u64 = 64;
/// Pictures from a place, turned evenly about the up direction.
const TURNS: u64 = 8;
/// How much of what is around a place has to be there, as a share of what is around the first.
const INSIDE: f64 = 0.75;
/// Share of a picture's probes that hit something.
const FILLED: f64 = 0.75;
/// The least distance to anything, as a share of the scene's diagonal.
const CLEARANCE: f64 = 0.01;
/// The median distance of what is in view, as a share of the scene's diagonal.
const OUTLOOK: f64 = 0.1;
/// The same, as a share of that of the best picture from the place.
const BEST_OUTLOOK: f64 = 0.5;
/// The most that a walk or an interior's camera goes up or down, in radians.
const TILT: f64 = 0.35;

/// Keys of the random numbers.
const KEY_WALK: u64 = 6 << 8;
const KEY_TURN: u64 = 7 << 8;

/// Up to [`GENERATED_CAMERAS`] cameras with the up direction and the vertical field of view (degrees)
/// of a camera that somebody chose. `nearest` finds nearest hits, of about 300,000 rays.
///
/// If its `eye` is within the mesh's box, they stand where random walks of three steps from there
/// end: each goes part of the way to what is in a random direction, not far up or down. Of what is
/// around a place at least three quarters as much has to be the scene as around the `eye`, nothing
/// nearer than a hundredth of the scene's diagonal. From there a camera looks into a random
/// direction where three quarters of its picture are filled and the median distance of what it sees
/// is a tenth of the diagonal or more, and at least half of what the best direction has; where there
/// are fewer such places than are asked for, half of these lengths will do, and so on.
///
/// If the `eye` is not in the box, they are around its middle, as far from it as the `eye`, evenly
/// on a sphere.
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
    let mut probes = Probes { frame, nearest };
    let places = probes.places(eye);
    let mut views = Vec::new();
    for (i, place) in places.iter().enumerate() {
        for turn in 0..TURNS {
            let index = 2 * (i as u64 * TURNS + turn);
            let [a, b] = [index, index + 1].map(|k| unit_f64(hash(0, KEY_TURN, k)));
            let angle = std::f64::consts::TAU * (turn as f64 + a) / TURNS as f64;
            let forward = probes.frame.direction(angle, TILT * (2.0 * b - 1.0));
            views.push(camera(place.eye, place.eye + forward)?);
        }
    }
    let outlooks = probes.outlooks(&views);
    let diagonal = min.distance(max);
    let of_place = || {
        let turns = TURNS as usize;
        places
            .iter()
            .zip(views.chunks(turns).zip(outlooks.chunks(turns)))
    };
    let mut patience = 1.0;
    loop {
        let clearance = patience * CLEARANCE * diagonal;
        let outlook = patience * OUTLOOK * diagonal;
        let chosen: Vec<Camera> = of_place()
            .filter(|(place, _)| place.clearance >= clearance)
            .filter_map(|(_, (views, outlooks))| {
                let best = outlooks.iter().copied().fold(0.0, f64::max);
                let enough = outlook.max(BEST_OUTLOOK * best);
                let turn = outlooks.iter().position(|&o| o >= enough)?;
                Some(views[turn])
            })
            .take(GENERATED_CAMERAS)
            .collect();
        if chosen.len() == GENERATED_CAMERAS || patience < 1e-3 {
            return Ok(chosen);
        }
        patience *= 0.5;
    }
}

/// Where a camera may stand.
struct Place {
    eye: DVec3,
    /// Distance to the nearest thing around it.
    clearance: f64,
}

/// Rays that look around.
struct Probes<'a> {
    frame: Frame,
    nearest: &'a mut dyn FnMut(&Batch) -> Hits,
}

impl Probes<'_> {
    /// Where walks from the first place end, if that is as much inside as it is.
    fn places(&mut self, first: DVec3) -> Vec<Place> {
        let mut eyes = vec![first; 1 + WALKS as usize];
        for step in 0..STEPS {
            self.walk(&mut eyes[1..], step);
        }
        let distances = self.distances(&eyes, PROBES, |frame, _, k| frame.on_sphere(k, PROBES));
        let mut around = eyes.iter().zip(distances.chunks(PROBES as usize));
        let enough = around
            .next()
            .map_or(0.0, |(_, d)| INSIDE * share_of_hits(d));
        around
            .filter(|(_, distances)| share_of_hits(distances) >= enough)
            .map(|(&eye, distances)| Place {
                eye,
                clearance: distances.iter().copied().fold(f64::INFINITY, f64::min),
            })
            .collect()
    }

    /// Moves each place part of the way to what is in a random direction; those that have nothing
    /// there stay.
    fn walk(&mut self, places: &mut [DVec3], step: u64) {
        let draw = |place: usize, which| {
            let index = 3 * (step * WALKS + place as u64) + which;
            unit_f64(hash(0, KEY_WALK, index))
        };
        let way = |frame: &Frame, place: usize| {
            let [angle, elevation] = [draw(place, 0), draw(place, 1)];
            frame.direction(
                std::f64::consts::TAU * angle,
                TILT * (2.0 * elevation - 1.0),
            )
        };
        let distances = self.distances(places, 1, |frame, place, _| way(frame, place));
        for (i, (place, t)) in places.iter_mut().zip(distances).enumerate() {
            if t.is_finite() {
                let share = 0.2 + 0.6 * draw(i, 2);
                // As rays start there.
                *place = (*place + share * t * way(&self.frame, i))
                    .as_vec3()
                    .as_dvec3();
            }
        }
    }

    /// The median distance of what each camera sees, 0 if little of its picture is filled.
    fn outlooks(&mut self, views: &[Camera]) -> Vec<f64> {
        let eyes: Vec<DVec3> = views.iter().map(|view| view.eye().as_dvec3()).collect();
        let edge = PROBES.isqrt();
        let distances = self.distances(&eyes, PROBES, |_, view, k| {
            let [x, y] = [k % edge, k / edge].map(|step| (step as f64 + 0.5) / edge as f64);
            views[view].direction(x, y, 1.0).as_dvec3()
        });
        (distances.chunks(PROBES as usize))
            .map(|distances| match share_of_hits(distances) >= FILLED {
                true => median(distances),
                false => 0.0,
            })
            .collect()
    }

    /// Distances to what `count` rays from each place hit; infinite for those that miss.
    fn distances(
        &mut self,
        places: &[DVec3],
        count: u64,
        direction: impl Fn(&Frame, usize, u64) -> DVec3,
    ) -> Vec<f64> {
        let ray = |place: usize, k| {
            let direction = direction(&self.frame, place, k);
            Ray::new(places[place].as_vec3(), direction.as_vec3())
        };
        let batch: Batch = (0..places.len())
            .flat_map(|place| (0..count).map(move |k| (place, k)))
            .map(|(place, k)| ray(place, k))
            .collect();
        let hits = (self.nearest)(&batch);
        hits.t.into_iter().map(f64::from).collect()
    }
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
