//! PLY files: ascii, binary little and big endian. `ply-rs-bw` reads the header and the binary
//! rows, into types of ours that hold no map. Text rows are read here, because its grammar for
//! them refuses `nan`, `inf`, `1.` and `.5`, which other programs write.

mod header;
mod rows;

use super::{MOST_TRIANGLES, Problem, too_many_triangles};
use crate::Triangle;
use glam::Vec3;
use header::Header;
use ply_rs_bw::ply::Property;
use rows::{Face, Rows, Skipped, Vertex};

pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Triangle>, Problem> {
    let header = Header::parse(bytes)?;
    header.check_size(bytes.len())?;

    let mut rows = Rows::new(bytes, &header);
    let mut positions: Vec<Vec3> = Vec::new();
    let mut corners: Vec<[u32; 3]> = Vec::new();
    for element in header.elements() {
        match element.name.as_str() {
            "vertex" => {
                positions.reserve_exact(element.count);
                rows.for_each(element, |v: Vertex| {
                    positions.push(v.position);
                    Ok(())
                })?;
            }
            "face" => {
                corners.reserve_exact(element.count);
                rows.for_each(element, |f: Face| fan(&f, header.vertices(), &mut corners))?;
            }
            _ => rows.for_each(element, |_: Skipped| Ok(()))?,
        }
    }
    let position = |i: u32| positions[i as usize];
    Ok(corners
        .iter()
        .map(|&[a, b, c]| Triangle::new(position(a), position(b), position(c)))
        .collect())
}

/// Cuts a polygon into triangles around its first corner.
fn fan(face: &Face, vertices: usize, out: &mut Vec<[u32; 3]>) -> Result<(), String> {
    fn cut<T: Copy + Into<i64>>(
        list: &[T],
        vertices: usize,
        out: &mut Vec<[u32; 3]>,
    ) -> Result<(), String> {
        let index = |i: usize| {
            let index: i64 = list[i].into();
            match u32::try_from(index) {
                Ok(n) if (n as usize) < vertices => Ok(n),
                _ if vertices == 0 => Err(format!(
                    "expected a vertex index, but there are no vertices, found {index}"
                )),
                _ => Err(format!(
                    "expected a vertex index from 0 to {}, found {index}",
                    vertices - 1
                )),
            }
        };
        if list.len() < 3 {
            return Err(format!(
                "expected a face of three corners or more, found {}",
                list.len()
            ));
        }
        if out.len() + (list.len() - 2) > MOST_TRIANGLES {
            return Err(too_many_triangles());
        }
        let (first, mut before) = (index(0)?, index(1)?);
        for i in 2..list.len() {
            let next = index(i)?;
            out.push([first, before, next]);
            before = next;
        }
        Ok(())
    }
    match &face.corners {
        Property::ListChar(l) => cut(l, vertices, out),
        Property::ListUChar(l) => cut(l, vertices, out),
        Property::ListShort(l) => cut(l, vertices, out),
        Property::ListUShort(l) => cut(l, vertices, out),
        Property::ListInt(l) => cut(l, vertices, out),
        Property::ListUInt(l) => cut(l, vertices, out),
        // The header is checked for a list of whole numbers.
        _ => Err("expected a list of vertex indices, found none".to_owned()),
    }
}
