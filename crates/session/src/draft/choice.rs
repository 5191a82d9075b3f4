//! Values that are chosen in the form rather than typed, as scripts and links name them.

use std::collections::BTreeMap;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Value, json};
use tilescope_core::{Parameter, Parameters, WithinLevel};

use super::RadiusBy;

/// A value that is chosen from a list. In JSON it is a field with its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// A parameter, and the value of one of its options.
    Parameter(Parameter, Value),
    /// The number of nested levels; `None` for a run.
    Levels(Option<u32>),
    /// The order of the samples within a level.
    Within(WithinLevel),
    /// How the radius is given.
    RadiusBy(RadiusBy),
}

impl Serialize for Choice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (key, value) = match self {
            Self::Parameter(parameter, value) => (parameter.key(), value.clone()),
            Self::Levels(levels) => ("levels", json!(levels)),
            Self::Within(within) => ("within", json!(within)),
            Self::RadiusBy(by) => ("radius-by", json!(by)),
        };
        BTreeMap::from([(key, value)]).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut given = BTreeMap::<String, Value>::deserialize(deserializer)?;
        let (Some((key, value)), true) = (given.pop_first(), given.is_empty()) else {
            return Err(D::Error::custom("a choice is one field with its value"));
        };

        let read = match &*key {
            "levels" => serde_json::from_value(value).map(Self::Levels),
            "within" => serde_json::from_value(value).map(Self::Within),
            "radius-by" => serde_json::from_value(value).map(Self::RadiusBy),
            key => {
                let parameter = Parameter::all().find(|parameter| parameter.key() == key);
                let chosen = parameter.filter(|parameter| !parameter.options().is_empty());
                let unknown = || D::Error::custom(format!("unknown choice `{key}`"));
                let parameter = chosen.ok_or_else(unknown)?;
                // A value outside its options is refused here, not when it is applied.
                let set = parameter.set(&mut Parameters::default(), value.clone());
                set.map(|()| Self::Parameter(parameter, value))
            }
        };

        read.map_err(D::Error::custom)
    }
}
