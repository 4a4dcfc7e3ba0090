//! The rows of a PLY file after its header, one element after the other.

use super::super::{Place, Problem, quote};
use super::header::{Header, is_corner_list_name};
use glam::Vec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{
    ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::ErrorKind;

/// A row of element `vertex`.
pub(super) struct Vertex {
    pub position: Vec3,
}

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex {
            position: Vec3::ZERO,
        }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        // Lists have no such value; the header is checked for x, y and z to be numbers.
        value
            .to_f32_lossy()
            .map_or(PropertyAccessResult::Ignored, |v| self.set_float(name, v))
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// A row of element `face`.
pub(super) struct Face {
    /// A list of vertex indices of any whole-number type.
    pub corners: Property,
}

impl PropertyAccess for Face {
    fn new() -> Face {
        Face {
            corners: Property::Char(0),
        }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !is_corner_list_name(name) {
            return PropertyAccessResult::Ignored;
        }
        self.corners = value;
        PropertyAccessResult::Set
    }
}

/// A row of any other element.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Skipped {
        Skipped
    }
}

/// Takes row after row.
pub(super) struct Rows<'a> {
    encoding: Encoding,
    file_bytes: usize,
    rest: &'a [u8],
    /// Lines taken, those of the header included; text only.
    lines: usize,
}

impl<'a> Rows<'a> {
    pub fn new(file: &'a [u8], header: &Header) -> Rows<'a> {
        Rows {
            encoding: header.encoding,
            file_bytes: file.len(),
            rest: &file[header.bytes..],
            lines: header.lines,
        }
    }

    /// Hands on all rows of the element that comes next in the file.
    pub fn for_each<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(E) -> Result<(), String>,
    ) -> Result<(), Problem> {
        if element.properties.is_empty() {
            // Rows of nothing take no room, however many there are.
            return Ok(());
        }
        let parser = Parser::<E>::new();
        for number in 0..element.count {
            let start = self.file_bytes - self.rest.len();
            let row = match self.encoding {
                Encoding::Ascii => self.text_row(element),
                Encoding::BinaryLittleEndian => parser
                    .read_little_endian_element(&mut self.rest, element)
                    .map_err(|e| reason(&e)),
                Encoding::BinaryBigEndian => parser
                    .read_big_endian_element(&mut self.rest, element)
                    .map_err(|e| reason(&e)),
            };
            row.and_then(&mut take).map_err(|text| {
                let place = match self.encoding {
                    Encoding::Ascii => Place::Line(self.lines),
                    _ => Place::Byte(start),
                };
                let (name, count) = (&element.name, element.count);
                Problem::new(place, format!("{name} {number} of {count}: {text}"))
            })?;
        }
        Ok(())
    }

    /// A row of a text file: the next line that is not blank.
    fn text_row<E: PropertyAccess>(&mut self, element: &ElementDef) -> Result<E, String> {
        let line = loop {
            if self.rest.is_empty() {
                return Err("expected a line, found the end of the file".to_owned());
            }
            let mut parts = self.rest.splitn(2, |&b| b == b'\n');
            let line = parts.next().unwrap_or_default().trim_ascii();
            self.rest = parts.next().unwrap_or_default();
            self.lines += 1;
            if !line.is_empty() {
                break line;
            }
        };
        let text = std::str::from_utf8(line)
            .map_err(|_| format!("expected numbers, found {}", quote(line)))?;
        let mut words = text.split_ascii_whitespace();
        let mut row = E::new();
        for (name, property) in &element.properties {
            let mut word = || {
                words
                    .next()
                    .ok_or_else(|| format!("expected more numbers, found {}", quote(line)))
            };
            let value = match &property.data_type {
                PropertyType::Scalar(ScalarType::Float) => Property::Float(number(word()?)?),
                PropertyType::Scalar(_) => Property::Double(number(word()?)?),
                PropertyType::List(_, item) => {
                    let length: usize = number(word()?)?;
                    // No allocation for a promise: the words must be there.
                    let items = (0..length).map(|_| word());
                    match item {
                        ScalarType::Float | ScalarType::Double => items
                            .map(|w| number(w?))
                            .collect::<Result<_, _>>()
                            .map(Property::ListDouble),
                        ScalarType::UInt => items
                            .map(|w| number(w?))
                            .collect::<Result<_, _>>()
                            .map(Property::ListUInt),
                        _ => items
                            .map(|w| number(w?))
                            .collect::<Result<_, _>>()
                            .map(Property::ListInt),
                    }?
                }
            };
            row.set_property(name, value);
        }
        match words.next() {
            None => Ok(row),
            Some(_) => Err(format!(
                "expected fewer numbers by the header, found {}",
                quote(line)
            )),
        }
    }
}

fn number<T: std::str::FromStr>(word: &str) -> Result<T, String> {
    word.parse()
        .map_err(|_| format!("expected a number, found {}", quote(word.as_bytes())))
}

/// The crate's message without the place, which it knows in lines only.
fn reason(error: &ply_rs_bw::parser::ParseError) -> String {
    if error.kind() == ErrorKind::UnexpectedEof {
        return "expected more bytes, found the end of the file".to_owned();
    }
    error
        .to_string()
        .lines()
        .next()
        .unwrap_or_default()
        .to_owned()
}
