//! float32 in JSON: numbers that read back as the same bits, and `"inf"`, `"-inf"`, `"nan"` for
//! those that JSON has no number for. For `#[serde(with = "crate::json_float")]`.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serializer, de};

/// Writes a number, or a word if it is not finite.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(x: &f32, serializer: S) -> Result<S::Ok, S::Error> {
    match *x {
        f32::INFINITY => serializer.serialize_str("inf"),
        f32::NEG_INFINITY => serializer.serialize_str("-inf"),
        x if x.is_nan() => serializer.serialize_str("nan"),
        x => serializer.serialize_f32(x),
    }
}

/// The JSON Schema of what [`serialize`] writes. For
/// `#[schemars(schema_with = "crate::json_float::json_schema")]`.
pub fn json_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [{ "type": "number" }, { "enum": ["inf", "-inf", "nan"] }] })
}

/// Reads what [`serialize`] writes.
///
/// # Errors
/// If it is neither a number nor one of the three words.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum NumberOrWord {
        Number(f32),
        Word(String),
    }
    match NumberOrWord::deserialize(deserializer)? {
        NumberOrWord::Number(x) => Ok(x),
        NumberOrWord::Word(word) => match word.as_str() {
            "inf" => Ok(f32::INFINITY),
            "-inf" => Ok(f32::NEG_INFINITY),
            "nan" => Ok(f32::NAN),
            _ => Err(de::Error::custom(format!(
                "expected a number, \"inf\", \"-inf\" or \"nan\", found \"{word}\""
            ))),
        },
    }
}
