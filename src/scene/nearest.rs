//! "Did you mean": the message for a name that does not exist.

/// Says that there is no `kind` of this name, and which one is near; if none is, which there are.
pub fn no_such(kind: &str, name: &str, known: &[impl AsRef<str>]) -> String {
    let nearest = known
        .iter()
        .map(AsRef::as_ref)
        .map(|k| (strsim::jaro_winkler(&name.to_lowercase(), k), k))
        // The first of equals: the reversed order, of which the last is taken.
        .rev()
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        None => format!("there is no {kind} {name:?}, and no other"),
        Some((score, k)) if score > 0.7 => {
            format!("there is no {kind} {name:?}: did you mean {k:?}?")
        }
        Some(_) => {
            let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
            format!(
                "there is no {kind} {name:?}: there are {}",
                known.join(", ")
            )
        }
    }
}

#[test]
fn the_first_of_equally_near_names_is_meant() {
    let names = ["diffuse-1", "diffuse-2", "diffuse-8"];
    assert!(no_such("ray type", "diffuse-0", &names).contains("\"diffuse-1\""));
}
