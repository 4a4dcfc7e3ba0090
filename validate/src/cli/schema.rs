//! `dacrt schema`: the JSON Schema of a kind of file.

use super::Verdict;
use super::args::SchemaArgs;
use super::text::print;
use dacrt_validate::schema::KINDS;

/// Prints it.
pub fn schema(args: &SchemaArgs) -> anyhow::Result<Verdict> {
    let kind = KINDS.iter().find(|kind| kind.name == args.kind);
    let kind = kind.expect("a name that the command line has let through");
    let text = serde_json::to_string_pretty(&(kind.schema)())?;
    print(&format!("{text}\n"))?;
    Ok(Verdict::Good)
}
