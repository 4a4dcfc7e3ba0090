//! JSON Schemas of the files that people write and read, generated from the types that serde reads
//! and writes.

use crate::results::Document;
use crate::sweep::Sweep;
use dacrt::scene::Description;
use dacrt::{BestParameters, Counters, ObjectParameters, SpaceParameters};
use schemars::generate::{Contract, SchemaSettings};
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value};

/// A kind of file that has a schema.
pub struct Kind {
    /// Its name for `dacrt schema`.
    pub name: &'static str,
    /// Where its schema is committed, from the root of the repository.
    pub file: &'static str,
    /// Makes the schema.
    pub schema: fn() -> Schema,
}

/// All kinds. Each schema stands beside the files that it is for.
pub const KINDS: [Kind; 4] = [
    Kind {
        name: "results",
        file: "results/results.schema.json",
        schema: of_written::<Document>,
    },
    Kind {
        name: "scene",
        file: "scenes/scene.schema.json",
        schema: of_read::<Description>,
    },
    Kind {
        name: "sweep",
        file: "results/sweep.schema.json",
        schema: of_read::<Sweep>,
    },
    Kind {
        name: "hard",
        file: "results/hard.schema.json",
        schema: of_written::<crate::hard::Document>,
    },
];

/// The schema of what this program writes: keys that it always writes are required.
pub fn of_written<T: JsonSchema>() -> Schema {
    generate::<T>(Contract::Serialize)
}

/// The schema of what this program reads: keys with a default may be left out.
pub fn of_read<T: JsonSchema>() -> Schema {
    generate::<T>(Contract::Deserialize)
}

fn generate<T: JsonSchema>(contract: Contract) -> Schema {
    let settings = SchemaSettings::draft2020_12()
        .with(|settings| settings.contract = contract)
        .with_transform(RecursiveTransform(describe_json));
    settings.into_generator().into_root_schema_for::<T>()
}

/// Makes a description for readers of JSON out of a doc comment for readers of Rust: paragraphs on
/// one line, links as their text, `null` for `None`.
fn describe_json(schema: &mut Schema) {
    let Some(Value::String(description)) = schema.get_mut("description") else {
        return;
    };
    let mut text = String::new();
    let mut rest = &*description.replace("`None`", "`null`");
    while let Some((before, link)) = rest.split_once("[`") {
        let (name, after) = link.split_once("`]").unwrap_or((link, ""));
        text += &format!("{before}`{name}`");
        rest = match after.strip_prefix('(').and_then(|t| t.split_once(')')) {
            Some((_target, after)) => after,
            None => after,
        };
    }
    text += rest;
    let paragraphs = text.split("\n\n").map(|p| p.replace('\n', " "));
    *description = paragraphs.collect::<Vec<_>>().join("\n\n");
}

/// The schema of a cell's counters: integers, those of this version with their meaning. None is
/// required, so that results keep to the schema when a counter is added.
pub(crate) fn counters(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "object",
        "properties": properties::<Counters>(generator),
        "additionalProperties": { "type": "integer", "minimum": 0 },
    })
}

/// The schema of a cell's parameters: those of all methods, none required, for each method has its
/// own.
pub(crate) fn parameters(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object", "properties": parameter_kinds(generator) })
}

/// The schema of each parameter of any method, by its name.
pub fn parameter_kinds(generator: &mut SchemaGenerator) -> Map<String, Value> {
    let mut all = properties::<ObjectParameters>(generator);
    all.append(&mut properties::<SpaceParameters>(generator));
    all.append(&mut properties::<BestParameters>(generator));
    all
}

/// The schemas of the fields of a struct.
fn properties<T: JsonSchema>(generator: &mut SchemaGenerator) -> Map<String, Value> {
    match T::json_schema(generator).remove("properties") {
        Some(Value::Object(properties)) => properties,
        _ => unreachable!("a struct has fields"),
    }
}
