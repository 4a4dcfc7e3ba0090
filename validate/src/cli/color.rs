//! From numbers to the colours of a picture.

use dacrt_validate::diff::Class;

/// sRGB byte of a linear value; values outside 0 to 1 are clamped, NaN is black.
pub fn srgb(linear: f32) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    // `as` makes NaN 0.
    (encoded * 255.0).round() as u8
}

/// A well spread colour for a number: neighbours look different.
pub fn hash(n: u32) -> [u8; 3] {
    // The finaliser of MurmurHash3 by Austin Appleby.
    let mut h = n.wrapping_add(0x9e37_79b9);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^= h >> 16;
    let [a, b, c, _] = h.to_le_bytes();
    // Away from black, which is for misses.
    [a, b, c].map(|x| 64 + (u16::from(x) * 191 / 255) as u8)
}

/// False colour of a share from 0 to 1: black, blue, cyan, green, yellow, red.
pub fn heat(share: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 255.0],
        [0.0, 220.0, 255.0],
        [0.0, 200.0, 0.0],
        [255.0, 230.0, 0.0],
        [255.0, 0.0, 0.0],
    ];
    let x = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let i = (x as usize).min(STOPS.len() - 2);
    let f = x - i as f32;
    std::array::from_fn(|c| (STOPS[i][c] * (1.0 - f) + STOPS[i + 1][c] * f).round() as u8)
}

/// The colour of a class of differences (Okabe and Ito), or black.
pub fn class(class: Class) -> [u8; 3] {
    match class {
        Class::Same => [0, 0, 0],
        Class::Tie => [86, 180, 233],
        Class::Edge => [0, 200, 130],
        Class::ReferenceWrong => [240, 228, 66],
        Class::OursWrong | Class::TDrift => [255, 40, 0],
        Class::BothWrong => [204, 121, 167],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_ends_and_middle() {
        let bytes = [-1.0, 0.0, 0.214, 1.0, 2.0, f32::NAN].map(srgb);
        assert_eq!(bytes, [0, 0, 127, 255, 255, 0]);
    }

    #[test]
    fn heat_runs_from_black_to_red() {
        assert_eq!(heat(0.0), [0, 0, 0]);
        assert_eq!(heat(1.0), [255, 0, 0]);
        assert_eq!(heat(f32::INFINITY), [255, 0, 0]);
        assert_eq!(heat(0.2), [0, 0, 255]);
    }

    #[test]
    fn neighbours_have_different_hash_colours() {
        for n in 0..1000 {
            assert_ne!(hash(n), hash(n + 1));
        }
    }
}
