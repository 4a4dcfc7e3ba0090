//! How many rays a picture has: `--resolution` and `--spp` as typed.

use std::fmt;
use std::str::FromStr;

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    pub width: u32,
    pub height: u32,
}

impl FromStr for Resolution {
    type Err = String;

    fn from_str(text: &str) -> Result<Resolution, String> {
        let (w, h) = text.split_once(['x', 'X']).unwrap_or((text, text));
        let side = |s: &str| match s.parse::<u32>() {
            Ok(0) => Err("a picture needs at least one pixel each way".to_string()),
            Ok(n) => Ok(n),
            Err(_) => Err("expected N or WxH in pixels, such as 512 or 640x480".to_string()),
        };
        Ok(Resolution {
            width: side(w)?,
            height: side(h)?,
        })
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// Samples per pixel: a square number, for the samples of a pixel lie on a square grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spp(pub u32);

impl FromStr for Spp {
    type Err = String;

    fn from_str(text: &str) -> Result<Spp, String> {
        let n: u32 = text
            .parse()
            .map_err(|_| "expected a square number: 1, 4, 9, 16, ...".to_string())?;
        let side = u64::from(n.isqrt());
        match n {
            0 => Err("a pixel needs at least one sample".into()),
            _ if side * side == u64::from(n) => Ok(Spp(n)),
            _ => Err(format!(
                "{n} is not a square number; next to it are {} and {}",
                side * side,
                (side + 1) * (side + 1)
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolutions_are_one_side_or_two() {
        let parse = |s: &str| s.parse::<Resolution>();
        assert_eq!(parse("512").unwrap().to_string(), "512x512");
        assert_eq!(parse("640x480").unwrap().to_string(), "640x480");
        for bad in [
            "0",
            "0x5",
            "5x0",
            "",
            "x",
            "-1",
            "5x5x5",
            "1e3",
            "4294967296",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn samples_are_square_numbers() {
        assert_eq!("64".parse(), Ok(Spp(64)));
        for bad in ["0", "2", "-4", "4294967295", "4294967296", "four"] {
            assert!(bad.parse::<Spp>().is_err(), "{bad}");
        }
        assert!("60".parse::<Spp>().unwrap_err().contains("49 and 64"));
    }
}
