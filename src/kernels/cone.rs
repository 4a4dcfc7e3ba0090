//! Conic packets (Mora 2011, section 3.3): cones around rays of one origin, and whether a cone meets
//! a box.
//!
//! A box, seen from the origin, is a convex figure on the unit sphere with four or six great arcs for
//! edges, and a cone is a disc there. They meet if the disc's centre is in the figure, or the disc
//! meets an edge. The paper solves a quadratic equation for each edge and cone (its appendix). Here
//! the arc's plane and ends are computed once for a box; each cone then takes a few dot products:
//! the same test without a root.
//!
//! It errs on one side only: a cone that a hit inside the box lies in is kept. The box is grown by as
//! much as a hit may lie outside (the slab padding and four roundings), box constants are computed in
//! float64, the radius of a cone is 2⁻²⁰ larger than its widest ray, and so are all comparisons
//! tolerant, which is more than the roundings of the dot products of unit vectors.

use super::partition::{Test, partition};
use super::prepare;
use super::records::{Range, RayRecords, least_of};
use super::slab::PADDING;
use super::triangle::{cross3, dot};
use crate::geometry::Aabb;
use crate::rays::Batch;
use crate::simd::{Lanes, lanes_of_bits, splat3};
use glam::{DVec3, Vec3};

/// Rays of a packet at most: 8 × 8.
pub(crate) const PACKET: usize = 64;
/// Rays of a packet at least, but for the last.
pub(crate) const LEAST_PACKET: usize = 8;
/// A packet ends before a ray that is so many times as far from its first as any of its rays: at the
/// end of a row of tiles, or where an object ends.
const JUMP: f32 = 4.0;
/// Directions whose squared length is below this are in no cone: denormals have few digits.
const LEAST_SQUARE: f32 = 1e-30;
/// Added to the sine of the half-angle, and the tolerance of comparisons.
const TOLERANCE: f32 = 1.0 / (1 << 20) as f32;

/// The cones of a trace.
#[derive(Clone, Copy)]
pub(crate) struct Cones {
    /// Unit axis, and the sine of the half-angle. (It keeps its precision for narrow cones, which the
    /// cosine does not.)
    pub cones: *mut [f32; 4],
    /// Number of the first ray, and how many there are.
    pub rays: *mut [u32; 2],
    /// Indices of active cones, with whole vectors of valid indices behind their end.
    pub ids: *mut u32,
    /// A bit a ray, set when it is done, with a word behind the last.
    pub done: *mut u64,
}

impl Cones {
    /// The termination bits of a cone: those of its rays, the first ray's lowest, ones behind the
    /// last's.
    ///
    /// # Safety
    /// It is the number of a cone.
    pub unsafe fn bits(&self, cone: u32) -> u64 {
        // SAFETY: a word stands behind the last.
        unsafe {
            let [first, len] = *self.rays.add(cone as usize);
            let (word, bit) = (first as usize / 64, first % 64);
            let low = *self.done.add(word) >> bit;
            let high = *self.done.add(word + 1);
            let high = if bit == 0 { 0 } else { high << (64 - bit) };
            let behind = if len == 64 { 0 } else { !0 << len };
            low | high | behind
        }
    }

    /// Sets the termination bit of a ray.
    ///
    /// # Safety
    /// It is the number of a ray of the batch.
    pub unsafe fn end(&self, ray: u32) {
        // SAFETY: as promised.
        unsafe { *self.done.add(ray as usize / 64) |= 1 << (ray % 64) }
    }
}

/// What became of the rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedCones {
    pub cones: usize,
    /// Rays in the index list: those of packets that are no cones.
    pub loose: usize,
}

/// Makes cones of up to [`PACKET`] consecutive rays, and an index list of the rays of those packets
/// that would be too wide.
///
/// # Safety
/// The processor has `L`'s instruction set; `rays` and `cones` have room for the batch, of
/// which `rays` has been prepared; the batch shares its origin.
#[inline(always)]
pub(crate) unsafe fn prepare_cones<L: Lanes>(
    batch: &Batch,
    rays: &RayRecords,
    cones: &Cones,
    least_cosine: f32,
) -> PreparedCones {
    let (mut n, mut loose) = (0, 0);
    let mut first = 0;
    // SAFETY: as promised.
    unsafe {
        std::ptr::write_bytes(cones.done, 0, batch.len() / 64 + 2);
        while first < batch.len() {
            let packet = Packet::new::<L>(batch, first);
            for i in 0..packet.len {
                if packet.valid >> i & 1 == 0 {
                    cones.end((first + i) as u32);
                }
            }
            match packet.cone::<L>(least_cosine) {
                Some(cone) => {
                    *cones.cones.add(n) = cone;
                    *cones.rays.add(n) = [first as u32, packet.len as u32];
                    *cones.ids.add(n) = n as u32;
                    n += 1;
                }
                None => {
                    for i in 0..packet.len {
                        if packet.valid >> i & 1 == 1 {
                            *rays.ids.add(loose) = (first + i) as u32;
                            loose += 1;
                        }
                    }
                }
            }
            first += packet.len;
        }
    }
    PreparedCones { cones: n, loose }
}

/// Consecutive rays.
struct Packet {
    len: usize,
    /// Bits of the valid rays.
    valid: u64,
    /// Unit directions, by axis.
    unit: [[f32; PACKET]; 3],
}

impl Packet {
    /// The packet that begins with ray `first`.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; the batch has that ray.
    #[inline(always)]
    unsafe fn new<L: Lanes>(batch: &Batch, first: usize) -> Packet {
        let mut packet = Packet {
            len: PACKET.min(batch.len() - first),
            valid: 0,
            unit: [[0.0; PACKET]; 3],
        };
        let mut apart = [0f32; PACKET];
        // SAFETY: as promised.
        unsafe {
            let mut start = [L::splat(0.0); 3];
            for i in (0..packet.len).step_by(L::N) {
                let at = first + i;
                let origin = prepare::load3::<L>(&batch.origin, at);
                let direction = prepare::load3::<L>(&batch.direction, at);
                let tmin = prepare::load::<L>(&batch.tmin, at);
                let tmax = prepare::load::<L>(&batch.tmax, at);
                let valid = prepare::valid::<L>(&origin, &direction, tmin, tmax);
                let valid = L::and(valid, L::first(packet.len - i));
                packet.valid |= (L::bits(valid) as u64) << i;
                // Where squares lose digits the packet will be no cone.
                let squared = dot::<L>(&direction, &direction);
                let ordinary = L::and(
                    L::le(L::splat(LEAST_SQUARE), squared),
                    L::lt(squared, L::splat(f32::INFINITY)),
                );
                let length = L::select(ordinary, L::sqrt(squared), L::splat(f32::NAN));
                for (unit, &d) in packet.unit.iter_mut().zip(&direction) {
                    L::store(unit.as_mut_ptr().add(i), L::div(d, length));
                }
                let unit = packet.load::<L>(i);
                if i == 0 {
                    let [x, y, z] = [0, 1, 2].map(|axis| packet.unit[axis][0]);
                    start = splat3::<L>(&[x, y, z]);
                }
                let mut squared = L::splat(0.0);
                for axis in 0..3 {
                    let x = L::sub(unit[axis], start[axis]);
                    squared = L::mul_add(x, x, squared);
                }
                // An invalid ray is nowhere.
                let squared = L::select(valid, squared, L::splat(0.0));
                L::store(apart.as_mut_ptr().add(i), squared);
            }
        }
        // Most packets are not cut: see whether any ray is far enough from the first at all.
        let greatest = |of: &[f32]| of.iter().fold(0f32, |a, &b| if b > a { b } else { a });
        let furthest = greatest(&apart[..LEAST_PACKET]);
        if greatest(&apart) <= JUMP * JUMP * furthest {
            return packet;
        }
        let mut furthest = 0f32;
        for (i, &apart) in apart.iter().enumerate() {
            if i >= LEAST_PACKET && apart > JUMP * JUMP * furthest {
                packet.len = packet.len.min(i);
                packet.valid &= (1 << i) - 1;
                break;
            }
            furthest = if apart > furthest { apart } else { furthest };
        }
        packet
    }

    /// # Safety
    /// The processor has `L`'s instruction set; `i` is a multiple of `L::N` below [`PACKET`].
    #[inline(always)]
    unsafe fn load<L: Lanes>(&self, i: usize) -> [L::F; 3] {
        // SAFETY: as promised.
        unsafe {
            [
                L::load(self.unit[0].as_ptr().add(i)),
                L::load(self.unit[1].as_ptr().add(i)),
                L::load(self.unit[2].as_ptr().add(i)),
            ]
        }
    }

    /// The cone around the rays; none if there are none, or it would be too wide.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    unsafe fn cone<L: Lanes>(&self, least_cosine: f32) -> Option<[f32; 4]> {
        if self.valid == 0 {
            return None;
        }
        // SAFETY: as promised.
        unsafe {
            let mut least = [L::splat(2.0); 3];
            let mut greatest = [L::splat(-2.0); 3];
            for i in (0..self.len).step_by(L::N) {
                let (unit, valid) = (
                    self.load::<L>(i),
                    lanes_of_bits::<L>((self.valid >> i) as u32),
                );
                for axis in 0..3 {
                    let x = unit[axis];
                    least[axis] = L::select(valid, L::min(x, least[axis]), least[axis]);
                    greatest[axis] = L::select(valid, L::max(x, greatest[axis]), greatest[axis]);
                }
            }
            let mut middle = [0f32; 3];
            for axis in 0..3 {
                let greatest = L::sub(L::splat(0.0), greatest[axis]);
                middle[axis] = least_of::<L>(least[axis]) - least_of::<L>(greatest);
            }
            let [x, y, z] = middle;
            let length = (x * x + y * y + z * z).sqrt();
            let axis = [x / length, y / length, z / length];
            let lanes = splat3::<L>(&axis);
            // Least cosine, and the negative of the greatest squared sine.
            let mut cosine = L::splat(1.0);
            let mut squared = L::splat(0.0);
            for i in (0..self.len).step_by(L::N) {
                let (unit, valid) = (
                    self.load::<L>(i),
                    lanes_of_bits::<L>((self.valid >> i) as u32),
                );
                let across = cross3::<L>(&lanes, &unit);
                let c = dot::<L>(&lanes, &unit);
                let s = L::sub(L::splat(0.0), dot::<L>(&across, &across));
                // NaN is no cosine to be found here: it must not be passed over.
                let c = L::select(L::is_nan(c), L::splat(-1.0), c);
                cosine = L::select(valid, L::min(c, cosine), cosine);
                squared = L::select(valid, L::min(s, squared), squared);
            }
            if least_of::<L>(cosine) < least_cosine {
                return None;
            }
            let sine = (-least_of::<L>(squared)).sqrt() + TOLERANCE;
            Some([axis[0], axis[1], axis[2], sine])
        }
    }
}

/// The edges that bound what an origin sees of a box, for each of the 64 answers to the six questions
/// whether it is below the lower and above the upper plane of each axis (bits `2 axis` and
/// `2 axis + 1`), 27 of which can be. An edge goes from corner to corner such that the cross product
/// of these points away from the box; corner bits say on which axes it is the upper one.
const OUTLINES: [Outline; 64] = {
    let mut outlines = [Outline::NONE; 64];
    let mut position = 0;
    while position < 64 {
        outlines[position] = Outline::seen_from(position);
        position += 1;
    }
    outlines
};

#[derive(Clone, Copy)]
struct Outline {
    edges: [(u8, u8); 6],
    len: usize,
}

impl Outline {
    const NONE: Outline = Outline {
        edges: [(0, 0); 6],
        len: 0,
    };

    const fn seen_from(position: usize) -> Outline {
        let mut outline = Outline::NONE;
        let mut axis = 0;
        while axis < 3 {
            if position >> (2 * axis) & 3 == 3 {
                return Outline::NONE;
            }
            axis += 1;
        }
        let mut axis = 0;
        while axis < 3 {
            // The edges along the axis; `b` and `c` follow it cyclically.
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut side = 0;
            while side < 4 {
                let (upper_b, upper_c) = (side & 1, side >> 1);
                let sees_b = position >> (2 * b + upper_b) & 1 == 1;
                let sees_c = position >> (2 * c + upper_c) & 1 == 1;
                if sees_b != sees_c {
                    let from = (upper_b << b | upper_c << c) as u8;
                    let to = from | 1 << axis;
                    // Outwards if the sides have the same sign and `b`'s face is the one seen.
                    let outwards = (upper_b == upper_c) == sees_b;
                    outline.edges[outline.len] = if outwards { (from, to) } else { (to, from) };
                    outline.len += 1;
                }
                side += 1;
            }
            axis += 1;
        }
        outline
    }
}

/// An edge of a box as a great arc, all unit vectors.
#[derive(Clone, Copy)]
struct Edge {
    /// Where it begins.
    corner: [f32; 3],
    /// Normal of its plane, away from the box.
    out: [f32; 3],
    /// Normals in that plane at both ends, along the arc.
    along: [[f32; 3]; 2],
}

/// A box as cones of one origin see it.
struct Seen {
    edges: [Edge; 6],
    len: usize,
    /// Whether the origin is in the box.
    inside: bool,
    cones: *const [f32; 4],
}

#[inline(always)]
fn unit(v: DVec3) -> DVec3 {
    let squared = v.dot(v);
    // An edge without length has no plane.
    if squared > 0.0 {
        v * (1.0 / squared.sqrt())
    } else {
        DVec3::ZERO
    }
}

impl Seen {
    #[inline(always)]
    fn new(b: &Aabb, origin: Vec3, cones: *const [f32; 4]) -> Seen {
        const GROWTH: f64 = PADDING as f64 + 1.0 / (1 << 21) as f64;
        let wide = |v: Vec3| DVec3::new(v.x as f64, v.y as f64, v.z as f64);
        let (lo, hi) = (wide(b.min) - wide(origin), wide(b.max) - wide(origin));
        let (lo, hi) = (lo - GROWTH * lo.abs(), hi + GROWTH * hi.abs());
        let mut position = 0;
        for axis in 0..3 {
            position |= ((0.0 < lo[axis]) as usize) << (2 * axis);
            position |= ((hi[axis] < 0.0) as usize) << (2 * axis + 1);
        }
        let outline = &OUTLINES[position];
        let mut seen = Seen {
            edges: [Edge {
                corner: [0.0; 3],
                out: [0.0; 3],
                along: [[0.0; 3]; 2],
            }; 6],
            len: outline.len,
            inside: position == 0,
            cones,
        };
        if seen.inside {
            return seen;
        }
        let mut corners = [DVec3::ZERO; 8];
        for (bits, corner) in corners.iter_mut().enumerate() {
            let at = |axis: usize| match bits >> axis & 1 {
                0 => lo[axis],
                _ => hi[axis],
            };
            *corner = unit(DVec3::new(at(0), at(1), at(2)));
        }
        let narrow = |v: DVec3| [v.x as f32, v.y as f32, v.z as f32];
        for (edge, &(from, to)) in seen.edges.iter_mut().zip(&outline.edges[..outline.len]) {
            let (p, q) = (corners[from as usize], corners[to as usize]);
            let out = unit(p.cross(q));
            *edge = Edge {
                corner: narrow(p),
                out: narrow(out),
                along: [narrow(out.cross(p)), narrow(q.cross(out))],
            };
        }
        seen
    }
}

impl<L: Lanes> Test<L> for Seen {
    #[inline(always)]
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M {
        if self.inside {
            return active;
        }
        // SAFETY: as promised.
        unsafe {
            let [x, y, z, sine] = L::gather4::<1>(self.cones, ids);
            let axis = [x, y, z];
            let zero = L::splat(0.0);
            let tolerance = L::splat(-TOLERANCE);
            let mut candidates = active;
            // Whether the axis meets the box: it is on the inner side of all edges.
            let mut meets = active;
            let mut out = [zero; 6];
            for (out, edge) in out.iter_mut().zip(&self.edges[..self.len]) {
                *out = dot::<L>(&splat3::<L>(&edge.out), &axis);
                candidates = L::and(candidates, L::le(*out, sine));
                meets = L::and(meets, L::le(*out, zero));
            }
            if L::bits(candidates) == L::bits(meets) {
                return meets;
            }
            for (&out, edge) in out.iter().zip(&self.edges[..self.len]) {
                let on_arc = L::and(
                    L::le(tolerance, dot::<L>(&splat3::<L>(&edge.along[0]), &axis)),
                    L::le(tolerance, dot::<L>(&splat3::<L>(&edge.along[1]), &axis)),
                );
                let near_arc = L::and(L::lt(zero, out), on_arc);
                let corner = splat3::<L>(&edge.corner);
                let across = cross3::<L>(&corner, &axis);
                let near_corner = L::and(
                    L::le(dot::<L>(&across, &across), L::mul(sine, sine)),
                    L::lt(zero, dot::<L>(&corner, &axis)),
                );
                meets = L::or(meets, L::or(near_arc, near_corner));
            }
            L::and(meets, candidates)
        }
    }
}

/// Writes the rays of cones that are not done into the rays' index list, from place `to` on; returns
/// the place behind them.
///
/// # Safety
/// The processor has `L`'s instruction set; the cones are those of the batch, and the list has room
/// for their rays and a vector.
#[inline(always)]
pub(crate) unsafe fn flush<L: Lanes>(
    cones: &Cones,
    list: Range,
    rays: &RayRecords,
    mut to: usize,
) -> usize {
    // SAFETY: as promised.
    unsafe {
        for i in list.from..list.to {
            let cone = *cones.ids.add(i);
            let [first, _] = *cones.rays.add(cone as usize);
            let active = !cones.bits(cone);
            for at in (0..PACKET).step_by(L::N) {
                let lanes = lanes_of_bits::<L>((active >> at) as u32);
                // Compressing may leave any lane behind the list, where all must name a ray.
                let id = L::select_u(lanes, L::count_from(first + at as u32), L::splat_u(first));
                L::store_u(rays.ids.add(to), L::compress_u(lanes, id));
                to += L::bits(lanes).count_ones() as usize;
            }
        }
    }
    to
}

/// Moves the cones of a part of the index list that meet a box to its front; returns how many do.
///
/// # Safety
/// The processor has `L`'s instruction set; the cones have been prepared, with `origin`.
#[inline(always)]
pub(crate) unsafe fn keep_cones<L: Lanes>(
    cones: &Cones,
    list: Range,
    bounds: &Aabb,
    origin: Vec3,
) -> usize {
    // SAFETY: as promised.
    unsafe {
        let mut test = Seen::new(bounds, origin, cones.cones);
        partition::<L, _>(cones.ids.add(list.from), list.len(), &mut test)
    }
}

#[cfg(test)]
mod tests;
