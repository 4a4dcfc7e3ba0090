//! `dacrt replay` as typed.

use crate::cli::args::MeshArgs;
use crate::cli::knobs::KnobLists;
use crate::cli::size::{Resolution, Spp};
use clap::Args;
use std::path::PathBuf;
use std::str::FromStr;

#[derive(Args)]
#[command(
    override_usage = "\
dacrt replay <RESULT> [--cell <CELL>] --ray <N>
       dacrt replay --scene <NAME> --rays <TYPE> [--resolution <N|WxH>] --ray <N> [OPTIONS]
       dacrt replay --scene <NAME>|--mesh <FILE> --rays <FILE.npy> --ray <N> [OPTIONS]
       dacrt replay --scene <NAME>|--mesh <FILE> --ray <EIGHT NUMBERS> [OPTIONS]",
    after_help = "\
The whole batch is traced again, for how triangles are split depends on all of its rays, and one ray
is watched: the boxes that it comes to, with the interval in which it is inside and what becomes of
it; the triangles of each leaf that it is in, with the numbers that decide. Then stand the answers
of each precision, of Embree and of exact arithmetic on all triangles, with a verdict on each.

Of a result file, the rays are made anew from scene and seed, and their hash is compared: with
another mesh, camera or light than then, the exit code is 2.

A ray by its numbers: ox oy oz tmin dx dy dz tmax in one word, with commas or spaces between them,
each a decimal or the hexadecimal bits of a float32, as `ray_bits` in a result file. It is a batch
of its own, with a shared origin, unless --own-origins says that it is from a batch of many.

Exit code: 0, or 1 if an answer of ours is wrong.

Examples:
  dacrt replay dacrt-run.json --cell hall/diffuse-1/512x512/1/nabata2013 --ray 4711
  dacrt replay --scene hall --rays primary --resolution 256 --method mora2011 --ray 4711
  dacrt replay --mesh bunny.ply --rays rays.npy --precision exact --ray 0
  dacrt replay --mesh bunny.ply --ray 0,0.1,5,0,0,0,-1,inf
  dacrt replay --mesh bunny.ply --ray 0,0x3dcccccd,5,0,0,0,0xbf800000,inf --json"
)]
pub struct ReplayArgs {
    /// Result file, plain or gzip
    #[arg(conflicts_with_all = ["mesh", "camera", "rays", "resolution", "spp", "method", "precision", "seed",
                               "any_hit", "own_origins"])]
    pub result: Option<PathBuf>,
    /// A cell of the result file, such as hall/primary/512x512/1/afra2012 [default: its only one]
    #[arg(long, requires = "result")]
    pub cell: Option<String>,
    /// Number of the ray in its batch, from 0, or its eight numbers
    #[arg(long, value_name = "N|NUMBERS", allow_hyphen_values = true)]
    pub ray: RayChoice,
    /// Scene (see `dacrt scenes`); with a result file, where the description is
    #[arg(long, value_name = "NAME", conflicts_with = "mesh")]
    pub scene: Option<String>,
    /// Camera of the scene by name, or generated-1 ... generated-16 [default: the first]
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub camera: Option<String>,
    /// Mesh: OBJ or PLY, plain or gzip
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Ray type, or a file of rays: .npy, float32 [N, 8]
    #[arg(long, value_name = "TYPE|FILE")]
    pub rays: Option<String>,
    /// Picture size in pixels [default: 512]
    #[arg(long, value_name = "N|WxH", allow_negative_numbers = true)]
    pub resolution: Option<Resolution>,
    /// Samples per pixel, a square number [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub spp: Option<Spp>,
    /// Method: afra2012, nabata2013, mora2011, mora2011-cones or mora2011-random
    /// [default: afra2012]
    #[arg(long, value_name = "NAME")]
    pub method: Option<String>,
    /// Precision: fast, watertight or exact [default: fast]
    #[arg(long, value_name = "NAME")]
    pub precision: Option<String>,
    /// Instruction set: avx512, avx2 or portable [default: the best that the processor has]
    #[arg(long)]
    pub isa: Option<String>,
    /// Seed of every random choice [default: 1]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Ask only whether the ray hits anything (ray types know that themselves)
    #[arg(long)]
    pub any_hit: bool,
    /// Trace rays of one origin by the kernel for different origins, as where they are a part of a
    /// batch whose cell says `"shared_origin": false`
    #[arg(long)]
    pub own_origins: bool,
    /// Write JSON instead
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub meshes: MeshArgs,
    #[command(flatten)]
    pub knobs: KnobLists,
}

/// Which ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RayChoice {
    /// Its number in a batch.
    Number(usize),
    /// ox oy oz tmin dx dy dz tmax
    Floats([f32; 8]),
}

impl FromStr for RayChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<RayChoice, String> {
        let separator = |c: char| c == ',' || c.is_whitespace();
        let words: Vec<&str> = text.split(separator).filter(|w| !w.is_empty()).collect();
        match words[..] {
            [word] => (word.parse().map(RayChoice::Number))
                .map_err(|_| "expected the number of a ray, from 0, or its eight numbers".into()),
            _ if words.len() == 8 => {
                let mut floats = [0.0; 8];
                for (float, word) in floats.iter_mut().zip(words) {
                    *float = number(word)?;
                }
                Ok(RayChoice::Floats(floats))
            }
            _ => Err(format!(
                "expected eight numbers, ox oy oz tmin dx dy dz tmax, found {}",
                words.len()
            )),
        }
    }
}

/// A float32 as a decimal or as hexadecimal bits.
fn number(word: &str) -> Result<f32, String> {
    let number = match word.strip_prefix("0x") {
        Some(bits) if bits.len() == 8 => u32::from_str_radix(bits, 16).ok().map(f32::from_bits),
        Some(_) => None,
        None => word.parse().ok(),
    };
    number.ok_or_else(|| {
        format!("{word:?}: expected a decimal, or 0x and the eight hexadecimal digits of a float32")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_numbers_or_eight_numbers() {
        let parse = |s: &str| s.parse::<RayChoice>();
        assert_eq!(parse("17"), Ok(RayChoice::Number(17)));
        let ray = [0.0, 0.1, -5.0, 0.0, 1e-3, -0.0, -1.0, f32::INFINITY];
        for text in [
            "0,0.1,-5,0,1e-3,-0,-1,inf",
            "0 0x3dcccccd 0xc0a00000 0 0x3a83126f 0x80000000 0xbf800000 0x7f800000",
            "0, 0.1, -5, 0, 1e-3, -0, -1, inf",
        ] {
            let Ok(RayChoice::Floats(floats)) = parse(text) else {
                panic!("{text}")
            };
            assert_eq!(floats.map(f32::to_bits), ray.map(f32::to_bits), "{text}");
        }
        for bad in [
            "",
            "-1",
            "1.5",
            "1,2",
            "1,2,3,4,5,6,7,8,9",
            "1,2,3,4,5,6,7,x",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
        // The digits of a float64, or too few.
        assert!(parse("0x3f80000,0,0,0,0,0,1,1").is_err());
    }
}
