//! The parameters of a method as result files have them, and whose baseline is whose.

use dacrt::{Method, Parameters};
use serde_json::{Map, Value};

/// All parameters by the names of their fields, floats in the fewest digits that tell them apart.
pub fn fields(parameters: &Parameters) -> Map<String, Value> {
    let text = serde_json::to_string(parameters).expect("numbers, words and truth values");
    serde_json::from_str(&text).expect("JSON that was just made")
}

/// The parameters that the method has, by the names of their fields.
pub fn own_fields(method: Method, parameters: &Parameters) -> Map<String, Value> {
    let mut all = fields(parameters);
    all.retain(|name, _| method.has(name));
    all
}

/// Whether `baseline`, the parameters of a cell of `afra2012`, are what a cell with `parameters`
/// is set against: the same values of the parameters that the baseline and ray sampling both have,
/// the baseline's defaults for the rest. So a cell of the baseline is itself set against the one
/// with its own defaults, and a cell of Mora's methods, which have none of its parameters, against
/// the one with all defaults.
pub fn is_baseline(baseline: &Map<String, Value>, parameters: &Map<String, Value>) -> bool {
    let defaults = own_fields(Method::Afra2012, &Method::Afra2012.parameters());
    baseline.iter().all(|(name, value)| {
        let shared = parameters
            .get(name)
            .filter(|_| Method::Nabata2013.has(name));
        shared
            .or(defaults.get(name))
            .is_none_or(|wanted| wanted == value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt::{ObjectParameters, SpaceParameters};

    fn of(method: Method, parameters: impl Into<Parameters>) -> Map<String, Value> {
        own_fields(method, &parameters.into())
    }

    #[test]
    fn a_result_has_the_variant() {
        let of = |m: Method| own_fields(m, &m.parameters());
        assert_eq!(of(Method::Mora2011Cones)["variant"], "cones");
        assert!(!of(Method::Mora2011).contains_key("cone_limit"));
        assert!(!of(Method::Nabata2013).contains_key("variant"));
    }

    #[test]
    fn the_baseline_shares_what_both_have_and_nothing_else() {
        let afra = |bins, sah_ratio| {
            let parameters = ObjectParameters {
                bins,
                sah_ratio,
                ..ObjectParameters::AFRA2012
            };
            of(Method::Afra2012, parameters)
        };
        let nabata = ObjectParameters {
            bins: 16,
            samples: 50,
            ..ObjectParameters::NABATA2013
        };
        let nabata = of(Method::Nabata2013, nabata);
        let default = ObjectParameters::AFRA2012.sah_ratio;
        assert!(is_baseline(&afra(16, default), &nabata));
        assert!(!is_baseline(&afra(32, default), &nabata));
        assert!(!is_baseline(&afra(16, 3.0), &nabata));
        assert!(is_baseline(&afra(16, default), &afra(16, 3.0)));
        assert!(!is_baseline(&afra(16, 3.0), &afra(16, 3.0)));
    }

    #[test]
    fn a_method_of_another_kind_is_set_against_the_baseline_with_its_defaults() {
        let mora = SpaceParameters {
            ray_limit: 5,
            ..SpaceParameters::MORA2011
        };
        let mora = of(Method::Mora2011, mora);
        let afra = |bins| {
            let parameters = ObjectParameters {
                bins,
                ..ObjectParameters::AFRA2012
            };
            of(Method::Afra2012, parameters)
        };
        assert!(is_baseline(&afra(ObjectParameters::AFRA2012.bins), &mora));
        assert!(!is_baseline(&afra(16), &mora));
    }
}
