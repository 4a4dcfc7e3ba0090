//! Scenes made by the program, for machines without any mesh at hand: each is a function of the
//! number of triangles and a seed, and the same bits everywhere, as only correctly rounded
//! operations and the pure-Rust `libm` are used.
//!
//! | name | what |
//! |---|---|
//! | `hall` | the nave of a church with columns, vaults, pews and lamps: a closed interior of high depth complexity, like the models that architects make (not watertight). Metres, y up, 54 long from x = 0, 22 wide about z = 0, 16 high |
//! | `relief` | a bumpy ball of radius 1 or so, like a scanned object: closed, every edge in exactly two triangles, all of them small and of nearly the same size |
//! | `soup` | random triangles of mixed sizes about the cube from −1 to 1 |
//!
//! Size and place do not depend on the number of triangles, so one camera serves all.

mod hall;
mod relief;
mod soup;
mod zip;

use crate::geometry::Mesh;

/// Names of the generators.
pub const NAMES: [&str; 3] = ["hall", "relief", "soup"];

/// Makes the mesh of a generator; `None` if there is no generator of this name.
///
/// It has as many triangles as asked for, but 10 at least; `relief` has one less if that number is
/// odd (a closed surface has an even one). Made for 10 to 30 million triangles; takes a fraction
/// of a microsecond and 36 bytes a triangle.
///
/// # Panics
/// If `triangles` is 2³² − 1 or more.
pub fn generate(name: &str, triangles: usize, seed: u64) -> Option<Mesh> {
    let make = match name {
        "hall" => hall::hall,
        "relief" => relief::relief,
        "soup" => soup::soup,
        _ => return None,
    };
    assert!(
        triangles < u32::MAX as usize,
        "too many triangles for 32-bit numbers"
    );
    Some(Mesh::new(make(triangles.max(10), seed)))
}
