//! The header of a PLY file, and whether the file can hold what its header promises.

use super::super::{Place, Problem, quote};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Encoding, PropertyType, ScalarType};
use std::collections::HashMap;

pub(super) struct Header {
    pub encoding: Encoding,
    /// Where the rows begin.
    pub bytes: usize,
    pub lines: usize,
    elements: Vec<ElementDef>,
    /// The line on which an element (property "") or a property is declared.
    declared: HashMap<(String, String), usize>,
}

impl Header {
    /// Reads the header, and makes sure that vertices have positions and faces vertex indices.
    pub fn parse(bytes: &[u8]) -> Result<Header, Problem> {
        // The crate reads text alone, so it gets the header alone, comments in Latin-1 mended.
        let length = header_length(bytes)?;
        let text = String::from_utf8_lossy(&bytes[..length]);
        let read = Parser::<DefaultElement>::new().read_header(&mut Reader::new(text.as_bytes()));
        let parsed = read.map_err(|e| match e.line() {
            Some(line) => Problem::new(
                Place::Line(line),
                format!(
                    "expected a line of a PLY header, found {}",
                    quote(text.lines().nth(line - 1).unwrap_or_default().as_bytes())
                ),
            ),
            None => Problem::new(Place::Line(1), e.to_string()),
        })?;
        let header = Header {
            encoding: parsed.encoding,
            bytes: length,
            lines: text.lines().count(),
            declared: declarations(&text)?,
            elements: parsed.elements.into_values().collect(),
        };
        header.check_elements()?;
        Ok(header)
    }

    /// The elements in the order of their rows.
    pub fn elements(&self) -> &[ElementDef] {
        &self.elements
    }

    pub fn vertices(&self) -> usize {
        let vertex = self.elements.iter().find(|e| e.name == "vertex");
        vertex.map_or(0, |e| e.count)
    }

    fn line(&self, element: &str, property: &str) -> Place {
        let key = (element.to_owned(), property.to_owned());
        self.declared
            .get(&key)
            .map_or(Place::Line(1), |&line| Place::Line(line))
    }

    fn check_elements(&self) -> Result<(), Problem> {
        for name in ["vertex", "face"] {
            if !self.elements.iter().any(|e| e.name == name) {
                return Err(Problem::new(
                    Place::Line(self.lines),
                    format!("expected an element \"{name}\" in the header, found none"),
                ));
            }
        }
        for element in &self.elements {
            let wants: &[&str] = match element.name.as_str() {
                "vertex" => &["x", "y", "z"],
                "face" if element.properties.contains_key("vertex_index") => &["vertex_index"],
                "face" => &["vertex_indices"],
                _ => &[],
            };
            for name in wants {
                let Some(property) = element.properties.get(*name) else {
                    return Err(Problem::new(
                        self.line(&element.name, ""),
                        format!(
                            "expected a property \"{name}\" of element \"{}\", found none",
                            element.name
                        ),
                    ));
                };
                let expected = match (&property.data_type, element.name == "face") {
                    (PropertyType::Scalar(_), false) => continue,
                    (PropertyType::List(_, item), true) if is_whole(item) => continue,
                    (_, false) => "a number",
                    (_, true) => "a list of whole numbers",
                };
                return Err(Problem::new(
                    self.line(&element.name, name),
                    format!("expected \"{name}\" to be {expected}, found another type"),
                ));
            }
            for (name, property) in &element.properties {
                if let PropertyType::List(length, _) = &property.data_type
                    && !is_whole(length)
                {
                    return Err(Problem::new(
                        self.line(&element.name, name),
                        "expected a list length of a whole-number type, found a float",
                    ));
                }
            }
        }
        Ok(())
    }

    /// Refuses promises that a file of so many bytes cannot keep, before anything is allocated
    /// for them.
    pub fn check_size(&self, file_bytes: usize) -> Result<(), Problem> {
        let at_hand = (file_bytes - self.bytes) as u128;
        let mut needed = 0;
        for element in &self.elements {
            needed += element.count as u128 * self.least_row(element);
            // The last line of a text file may lack its end.
            let lenience = u128::from(self.encoding == Encoding::Ascii);
            if needed > at_hand + lenience {
                return Err(Problem::new(
                    self.line(&element.name, ""),
                    format!(
                        "the header promises {} of element \"{}\", for which the file needs at \
                         least {needed} bytes after the header, found {at_hand}",
                        element.count, element.name
                    ),
                ));
            }
        }
        Ok(())
    }

    /// The least number of bytes that a row of this element takes.
    fn least_row(&self, element: &ElementDef) -> u128 {
        let size = |scalar: &ScalarType| match (self.encoding, scalar) {
            // A digit and a space or line end.
            (Encoding::Ascii, _) => 2,
            (_, ScalarType::Char | ScalarType::UChar) => 1,
            (_, ScalarType::Short | ScalarType::UShort) => 2,
            (_, ScalarType::Int | ScalarType::UInt | ScalarType::Float) => 4,
            (_, ScalarType::Double) => 8,
        };
        element
            .properties
            .iter()
            .map(|(name, property)| match &property.data_type {
                PropertyType::Scalar(scalar) => size(scalar),
                // Faces of fewer than three corners are errors, which name the face.
                PropertyType::List(length, item) if is_corner_list(element, name) => {
                    size(length) + size(item)
                }
                PropertyType::List(length, _) => size(length),
            })
            .sum()
    }
}

/// Whether this property holds the vertex indices of a face.
pub(super) fn is_corner_list(element: &ElementDef, property: &str) -> bool {
    element.name == "face" && is_corner_list_name(property)
}

/// Both names are in use.
pub(super) fn is_corner_list_name(property: &str) -> bool {
    property == "vertex_indices" || property == "vertex_index"
}

fn is_whole(scalar: &ScalarType) -> bool {
    !matches!(scalar, ScalarType::Float | ScalarType::Double)
}

/// Bytes up to the end of the line `end_header`.
fn header_length(bytes: &[u8]) -> Result<usize, Problem> {
    let mut length = 0;
    let mut lines = 0;
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        length += line.len();
        lines += 1;
        if line.trim_ascii() == b"end_header" {
            return Ok(length);
        }
    }
    Err(Problem::new(
        Place::Line(lines),
        "expected a line \"end_header\", found the end of the file",
    ))
}

/// Where everything is declared; the crate would mix up what is declared twice.
fn declarations(text: &str) -> Result<HashMap<(String, String), usize>, Problem> {
    let mut declared = HashMap::new();
    let mut element = String::new();
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split_ascii_whitespace();
        let (kind, name) = match words.next() {
            Some("element") => {
                element = words.next().unwrap_or_default().to_owned();
                ("element", "")
            }
            Some("property") => ("property", words.next_back().unwrap_or_default()),
            _ => continue,
        };
        let key = (element.clone(), name.to_owned());
        if declared.insert(key, number).is_some() {
            let found = if name.is_empty() { &element } else { name };
            return Err(Problem::new(
                Place::Line(number),
                format!("the {kind} \"{found}\" is declared a second time"),
            ));
        }
    }
    Ok(declared)
}
