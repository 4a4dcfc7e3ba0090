//! Hashes of rays and hits: equal if and only if all bits are.

use crate::judge::Answers;
use crate::npy::ray_floats;
use dacrt::Batch;
use sha2::{Digest, Sha256};

/// SHA-256, in hexadecimal, of all t (little-endian float32), then all prim (uint32), in ray
/// order; or of one byte a ray, 1 for occluded.
pub fn hit_hash(answers: &Answers) -> String {
    let mut stream = Stream::default();
    match answers {
        Answers::Nearest(hits) => {
            hits.t.iter().for_each(|t| stream.word(t.to_le_bytes()));
            hits.prim.iter().for_each(|p| stream.word(p.to_le_bytes()));
        }
        Answers::Any(occluded) => occluded.iter().for_each(|&o| stream.word([(o != 0) as u8])),
    }
    stream.finish()
}

/// SHA-256, in hexadecimal, of ox oy oz tmin dx dy dz tmax of each ray (little-endian float32).
pub fn ray_hash(batch: &Batch) -> String {
    let mut stream = Stream::default();
    for ray in batch.iter() {
        ray_floats(&ray)
            .iter()
            .for_each(|x| stream.word(x.to_le_bytes()));
    }
    stream.finish()
}

/// Gathers small writes, which would each cost more than their hashing.
#[derive(Default)]
struct Stream {
    hash: Sha256,
    pending: Vec<u8>,
}

impl Stream {
    fn word<const N: usize>(&mut self, bytes: [u8; N]) {
        self.pending.extend_from_slice(&bytes);
        if self.pending.len() >= 1 << 16 {
            self.hash.update(&self.pending);
            self.pending.clear();
        }
    }

    fn finish(mut self) -> String {
        self.hash.update(&self.pending);
        let digest = self.hash.finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt::{Hits, Ray};
    use glam::Vec3;

    /// Expected values from `hashlib.sha256(struct.pack(…)).hexdigest()` of Python.
    #[test]
    fn hashes_are_of_the_documented_bytes() {
        let hits = Hits {
            t: vec![1.5, f32::INFINITY],
            prim: vec![7, u32::MAX],
        };
        let hash = hit_hash(&Answers::Nearest(&hits));
        assert_eq!(
            hash,
            "08f2658ec8b7fd48d967370821ada060324778d3d9efcd974f0378b12c9fc3a4"
        );
        assert_eq!(
            hit_hash(&Answers::Any(&[1, 0, 1])),
            "85f90dfea1d8027e1463e5ca971a250110a20df0119d204a74220bc63516d15b"
        );
        let ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0));
        assert_eq!(
            ray_hash(&std::iter::once(ray).collect()),
            "0c03ca81234dedac04c6bbba059e942d185d7e86c3c496cf0c5d02e838f306cc"
        );
    }

    #[test]
    fn long_batches_are_hashed_whole() {
        let mut hits = Hits::misses(100_000);
        let before = hit_hash(&Answers::Nearest(&hits));
        hits.prim[99_999] = 0;
        assert_ne!(hit_hash(&Answers::Nearest(&hits)), before);
    }
}
