//! The parameters of the methods as command-line options, and the grid that lists of values span.

use anyhow::{Context, anyhow, bail, ensure};
use clap::{Arg, ArgMatches, Command};
use dacrt::scene::no_such;
use dacrt::{BestParameters, Method, ObjectParameters, Parameters, SpaceParameters};
use dacrt_validate::parameters::fields;
use serde_json::Value;
use std::collections::BTreeMap;

/// A field of [`Parameters`], `-` for `_`, and what it means.
type Knob = (&'static str, &'static str);

/// All fields but `variant`, which the method decides; for each kind of methods those
/// with a name of their own in the papers first.
const KNOBS: [Knob; 36] = [
    ("bins", "Bins that a node's triangles are sorted into"),
    ("samples", "Sample rays of a node"),
    (
        "threshold",
        "Rays per triangle above which a node is split by the sampled cost",
    ),
    (
        "skip",
        "Intersection ratio above which a child gets all rays unfiltered; 1 never skips",
    ),
    ("min-rays", "Rays above which a node is sampled"),
    ("leaf-triangles", "Triangles up to which a node is a leaf"),
    ("leaf-rays", "Rays up to which a node is a leaf"),
    (
        "sah-ratio",
        "Rays per triangle above which a node is split by surface area",
    ),
    ("axes", "Axes that are binned: longest, centers or all"),
    (
        "one-ray",
        "How one ray decides the order of children: axis-sign or entry",
    ),
    (
        "lists",
        "Where the active rays of a child are kept: auto, copied or in-place",
    ),
    (
        "cost",
        "Cost function where rays are sampled: sah or sampled",
    ),
    (
        "order",
        "Who decides the order of children: one-ray or sampled",
    ),
    ("draws", "How sample rays are drawn: strata or replacement"),
    (
        "sample-middle",
        "Sample nodes that are split in the middle, too: true or false",
    ),
    (
        "leaf-criterion",
        "Skip by the costs of a leaf where the child is one: true or false",
    ),
    (
        "box-cost",
        "Cost of a ray/box over that of a ray/triangle test",
    ),
    (
        "order-unbiased",
        "Leave rays that decide nothing out of the order: true or false",
    ),
    (
        "alpha-refresh",
        "Estimate the second child's ratio after the first is done: true or false",
    ),
    (
        "second-sample",
        "Estimate the ratios by a second sample: true or false",
    ),
    (
        "ray-limit",
        "rLimit: rays below which a cell is solved by the naive step",
    ),
    (
        "triangle-limit",
        "pLimit: triangles below which a cell is solved by the naive step",
    ),
    (
        "cone-limit",
        "cLimit: cones below which a cell goes on with their rays",
    ),
    (
        "widest-cone",
        "Half-angle in degrees above which a packet is traced as rays, 0 to 60",
    ),
    (
        "estimate-from",
        "Triangles from which on a cell is split at an estimate, not in the middle",
    ),
    (
        "estimate-stride",
        "The estimate looks at one triangle in so many",
    ),
    (
        "nine-axes-below",
        "Triangles below which they are tested on nine more axes; 0 never does",
    ),
    (
        "plane-test",
        "Test the planes of triangles against cells, too: true or false",
    ),
    (
        "terminate-as-printed",
        "End a ray at any hit in a cell, which is wrong, to count how often: true or false",
    ),
    (
        "octants",
        "Rays of many origins: once for each octant, front to back: true or false",
    ),
    ("block", "Rays that go through the splits together"),
    (
        "sorted-block",
        "Rays that go through the splits together where they were put in order",
    ),
    ("window", "Rays that are put in order together"),
    (
        "sort",
        "Which batches are put in order: auto, never or always",
    ),
    (
        "flush",
        "Share of the rays of groups that must meet a box; 0 never leaves groups, 1 has none",
    ),
    (
        "cell-triangles",
        "Triangles for each cell of the grid that makes clusters",
    ),
];

/// The field that an option stands for.
fn field(knob: &str) -> String {
    knob.replace('-', "_")
}

/// The parameters with another value, as typed, for one of them.
fn with(parameters: &Parameters, knob: &str, text: &str) -> anyhow::Result<Parameters> {
    let mut all = fields(parameters);
    // What is no number and no truth value is a word.
    let value = serde_json::from_str(text).unwrap_or_else(|_| Value::from(text));
    let before = all.insert(field(knob), value);
    let all = Value::Object(all);
    // Each kind of parameters by itself: an error of an untagged enum says nothing.
    let changed = match parameters {
        Parameters::Object(_) => serde_json::from_value::<ObjectParameters>(all).map(Into::into),
        Parameters::Space(_) => serde_json::from_value::<SpaceParameters>(all).map(Into::into),
        Parameters::Best(_) => serde_json::from_value::<BestParameters>(all).map(Into::into),
    };
    let changed: Parameters = changed.map_err(|error| match before {
        Some(Value::Number(n)) if n.is_u64() => anyhow!("expected a whole number"),
        Some(Value::Number(_)) => anyhow!("expected a number"),
        Some(Value::Bool(_)) => anyhow!("expected true or false"),
        _ => error.into(),
    })?;
    changed.check()?;
    // Beyond the largest float32.
    ensure!(
        !fields(&changed)[&field(knob)].is_null(),
        "expected a finite number"
    );
    Ok(changed)
}

fn value_of(parameters: &Parameters, knob: &str) -> String {
    plain(&fields(parameters)[&field(knob)])
}

/// A word without quotes, a number or truth value as in JSON.
pub fn plain(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        other => other.to_string(),
    }
}

/// Those methods that have the parameter.
fn methods_with(knob: &str) -> impl Iterator<Item = Method> {
    let field = field(knob);
    Method::ALL.into_iter().filter(move |m| m.has(&field))
}

/// `a`, `a and b`, `a, b and c`.
fn listed(methods: &[Method]) -> String {
    let names: Vec<&str> = methods.iter().map(|m| m.name()).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// The values typed for each parameter; a parameter that was not typed has none.
#[derive(Clone, Debug, Default)]
pub struct KnobLists(Vec<(&'static str, Vec<String>)>);

impl clap::Args for KnobLists {
    fn augment_args(command: Command) -> Command {
        KNOBS.into_iter().fold(command, |command, (name, help)| {
            let owners: Vec<Method> = methods_with(name).collect();
            let preset = owners[0].parameters();
            let default = value_of(&preset, name);
            let (heading, all): (_, &[Method]) = match preset {
                Parameters::Object(_) => (
                    "Parameters of afra2012 and nabata2013",
                    &[Method::Afra2012, Method::Nabata2013],
                ),
                Parameters::Space(_) => (
                    "Parameters of mora2011, mora2011-cones and mora2011-random",
                    &[
                        Method::Mora2011,
                        Method::Mora2011Cones,
                        Method::Mora2011Random,
                    ],
                ),
                Parameters::Best(_) => ("Parameters of best", &[Method::Best]),
            };
            let only = match owners == all {
                true => String::new(),
                false => format!("; {} only", listed(&owners)),
            };
            command.arg(
                Arg::new(name)
                    .help_heading(heading)
                    .long(name)
                    .value_name("VALUES")
                    .value_delimiter(',')
                    .allow_negative_numbers(true)
                    .value_parser(move |text: &str| {
                        with(&preset, name, text).map(|_| text.to_owned())
                    })
                    .help(format!("{help} [default: {default}{only}]")),
            )
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for KnobLists {
    fn from_arg_matches(matches: &ArgMatches) -> Result<KnobLists, clap::Error> {
        let typed = KNOBS.iter().filter_map(|(name, _)| {
            let values = matches.get_many::<String>(name)?;
            Some((*name, values.cloned().collect()))
        });
        Ok(KnobLists(typed.collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl KnobLists {
    /// The lists of a sweep file, where parameters have the names of their fields; a parameter that
    /// none of the methods has is an error, for it would make no cells.
    pub fn of_sweep(
        parameters: &BTreeMap<String, Vec<Value>>,
        methods: &[Method],
    ) -> anyhow::Result<KnobLists> {
        let known = KNOBS.map(|(name, _)| field(name));
        let mut lists = Vec::new();
        for (name, values) in parameters {
            let place = || format!("parameters.{name}");
            let knob = known.iter().position(|field| field == name);
            let knob = knob.with_context(|| no_such("parameter", name, &known));
            let (knob, _) = KNOBS[knob.with_context(place)?];
            let owner = methods.iter().find(|m| m.has(name));
            let owner = owner.with_context(|| {
                let methods = listed(methods);
                format!("{}: no cells, for {methods} lack it", place())
            })?;
            let texts: Vec<String> = values.iter().map(plain).collect();
            for text in &texts {
                with(&owner.parameters(), knob, text)
                    .with_context(|| format!("{}: {text}", place()))?;
            }
            lists.push((knob, texts));
        }
        Ok(KnobLists(lists))
    }

    /// The typed values of those parameters that `method` has.
    fn of(&self, method: Method) -> impl Iterator<Item = &(&'static str, Vec<String>)> {
        self.0
            .iter()
            .filter(move |(name, _)| method.has(&field(name)))
    }

    /// Whether no parameter was typed.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All combinations of the values that `method` has parameters for, the first parameter
    /// changing slowest; its defaults for the rest.
    pub fn grid(&self, method: Method) -> anyhow::Result<Vec<Parameters>> {
        let mut grid = vec![method.parameters()];
        for (name, values) in self.of(method) {
            let mut wider: Vec<Parameters> = Vec::new();
            for base in &grid {
                for value in values {
                    let parameters =
                        with(base, name, value).with_context(|| format!("--{name}"))?;
                    if !wider.contains(&parameters) {
                        wider.push(parameters);
                    }
                }
            }
            grid = wider;
        }
        Ok(grid)
    }

    /// The one combination for `method`; lists and parameters that it lacks are errors.
    pub fn single(&self, method: Method) -> anyhow::Result<Parameters> {
        for (name, values) in &self.0 {
            ensure!(
                method.has(&field(name)),
                "--{name}: {method} has no such parameter"
            );
            if values.len() > 1 {
                bail!("--{name}: expected one value; lists are for `dacrt run`");
            }
        }
        Ok(self.grid(method)?[0])
    }

    /// What tells `parameters` from the others of the same run: `name=value` of each parameter of
    /// `method` that has more than one value.
    pub fn label(&self, method: Method, parameters: &Parameters) -> String {
        let varied = self.of(method).filter(|(_, values)| values.len() > 1);
        let parts: Vec<String> = varied
            .map(|(name, _)| format!("{name}={}", value_of(parameters, name)))
            .collect();
        parts.join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Map;

    fn lists(typed: &[(&'static str, &[&str])]) -> KnobLists {
        let own = |v: &[&str]| v.iter().map(|s| s.to_string()).collect();
        KnobLists(typed.iter().map(|(n, v)| (*n, own(v))).collect())
    }

    #[test]
    fn a_parameter_that_a_method_lacks_makes_no_cells_of_it() {
        let typed = lists(&[("bins", &["16", "32"]), ("samples", &["50", "100", "200"])]);
        assert_eq!(typed.grid(Method::Afra2012).unwrap().len(), 2);
        let grid = typed.grid(Method::Nabata2013).unwrap();
        assert_eq!(grid.len(), 6);
        let expected = ObjectParameters {
            bins: 16,
            samples: 100,
            ..ObjectParameters::NABATA2013
        };
        assert_eq!(grid[1], expected.into());
        assert_eq!(
            typed.label(Method::Nabata2013, &grid[5]),
            "bins=32 samples=200"
        );
        assert_eq!(typed.label(Method::Afra2012, &grid[5]), "bins=32");
        let of_mora = typed.grid(Method::Mora2011).unwrap();
        assert_eq!(of_mora, [Method::Mora2011.parameters()]);
        assert_eq!(typed.label(Method::Mora2011, &of_mora[0]), "");
    }

    #[test]
    fn equal_values_make_one_cell() {
        assert_eq!(
            lists(&[("skip", &["0.5", "0.50"])])
                .grid(Method::Nabata2013)
                .unwrap()
                .len(),
            1
        );
    }

    #[test]
    fn one_trace_takes_one_value_of_what_its_method_has() {
        let error = |typed: KnobLists, m| typed.single(m).unwrap_err().to_string();
        assert!(error(lists(&[("bins", &["1", "2"])]), Method::Afra2012).contains("one value"));
        assert!(
            error(lists(&[("skip", &["1"])]), Method::Afra2012).contains("afra2012 has no such")
        );
        assert!(
            error(lists(&[("cone-limit", &["9"])]), Method::Mora2011)
                .contains("mora2011 has no such")
        );
    }

    #[test]
    fn every_field_is_an_option_but_the_variant() {
        let mut known: Vec<String> = KNOBS.iter().map(|(name, _)| field(name)).collect();
        known.push("variant".to_owned());
        known.sort();
        let kinds =
            [Method::Afra2012, Method::Mora2011, Method::Best].map(|m| fields(&m.parameters()));
        let mut all: Vec<String> = kinds.iter().flat_map(Map::keys).cloned().collect();
        all.sort();
        assert_eq!(known, all);
    }

    #[test]
    fn values_out_of_range_are_refused() {
        for (knob, value) in [
            ("bins", "1"),
            ("bins", "-3"),
            ("bins", "2.5"),
            ("samples", "0"),
            ("skip", "-1"),
            ("skip", "nan"),
            ("threshold", "inf"),
            ("threshold", "1e39"),
            ("leaf-triangles", "0"),
            ("leaf-rays", "x"),
            ("leaf-rays", "null"),
            ("axes", "some"),
            ("sample-middle", "1"),
            ("ray-limit", "0"),
            ("triangle-limit", "-1"),
            ("cone-limit", "4294967296"),
            ("estimate-stride", "0"),
            ("nine-axes-below", "few"),
            ("octants", "yes"),
        ] {
            let method = methods_with(knob).last().unwrap();
            let error = with(&method.parameters(), knob, value).unwrap_err();
            let error = error.to_string();
            assert!(
                error.contains("expected") || knob == "axes",
                "{knob} {value}: {error}"
            );
        }
    }
}
