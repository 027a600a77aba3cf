//! What the parameters do: cases run with one parameter at several values, the others as they are by default (MAMM
//! Sec. 5.1, Fig. 9 and 10).

use super::picture::{Picture, strip};
use super::{Case, Clock, Machine, Spent};
use crate::error::CliError;
use inkrig_align::{AlignError, Comparison, Observer, Options, Quality, align};
use serde::Serialize;
use std::str::FromStr;

/// A parameter that can be swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// Structure against nearness.
    Alpha,
    /// Use of the whole clip.
    Lambda,
    /// Poses that may be mixed.
    Epsilon,
    /// Levels from coarse to fine.
    Levels,
}

impl Parameter {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Alpha => "alpha",
            Self::Lambda => "lambda",
            Self::Epsilon => "epsilon",
            Self::Levels => "levels",
        }
    }

    /// The values that are tried: from where little of it is left to where there is too much.
    pub fn values(self) -> &'static [f64] {
        match self {
            Self::Alpha => &[0.5, 0.7, 0.8, 0.9, 0.97],
            Self::Lambda => &[0.005, 0.05, 0.15, 0.3, 1.0],
            Self::Epsilon => &[0.001, 0.002, 0.005, 0.01, 0.02],
            Self::Levels => &[1.0, 2.0, 3.0, 4.0, 6.0],
        }
    }

    /// What it is in some options.
    pub fn of(self, options: &Options) -> f64 {
        match self {
            Self::Alpha => options.alpha,
            Self::Lambda => options.lambda,
            Self::Epsilon => options.epsilon,
            Self::Levels => options.levels as f64,
        }
    }

    /// The options with it at a value. The number of gradients stays about the same: fewer levels get more rounds each.
    fn at(self, value: f64, options: &Options) -> Options {
        let mut options = options.clone();
        match self {
            Self::Alpha => options.alpha = value,
            Self::Lambda => options.lambda = value,
            Self::Epsilon => options.epsilon = value,
            Self::Levels => {
                let rounds = options.levels * options.rounds;
                options.levels = value as usize;
                options.rounds = rounds.div_ceil(options.levels);
            }
        }
        options
    }
}

impl FromStr for Parameter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let all = [Self::Alpha, Self::Lambda, Self::Epsilon, Self::Levels];
        let found = all.into_iter().find(|parameter| parameter.name() == text.trim());
        found.ok_or_else(|| "give alpha, lambda, epsilon or levels, with commas between them".to_string())
    }
}

/// Everything that a sweep gives.
#[derive(Debug, Clone, Serialize)]
pub struct Sweep {
    /// What it was measured on.
    pub machine: Machine,
    /// One after the other.
    pub parameters: Vec<Swept>,
}

/// One parameter on all cases.
#[derive(Debug, Clone, Serialize)]
pub struct Swept {
    /// The parameter.
    pub parameter: Parameter,
    /// A line of cells for each case.
    pub cases: Vec<SweptCase>,
}

/// One parameter on one case.
#[derive(Debug, Clone, Serialize)]
pub struct SweptCase {
    /// The case.
    pub case: String,
    /// The value that align takes by itself.
    pub default: f64,
    /// Distances within the control.
    #[serde(skip)]
    pub(super) control: Picture,
    /// One for each value.
    pub cells: Vec<SweptCell>,
}

/// One parameter at one value on one case.
#[derive(Debug, Clone, Serialize)]
pub struct SweptCell {
    /// The value.
    pub value: f64,
    /// What came out.
    #[serde(flatten)]
    pub quality: Quality,
    /// Solver gradients.
    pub gradients: usize,
    /// What it took.
    #[serde(flatten)]
    pub spent: Spent,
    /// Distances within the result.
    #[serde(skip)]
    pub(super) result: Picture,
    /// Poses of the result, a PNG.
    #[serde(skip)]
    pub(super) poses: Vec<u8>,
}

/// Sweeps one parameter on one case.
///
/// # Errors
/// As for [`align`], and when a picture cannot be drawn.
pub fn sweep(case: &Case, parameter: Parameter, observer: Observer<'_>) -> Result<SweptCase, CliError> {
    let comparison = Comparison::new(&case.source, &case.control, &case.options)?;
    let [control, _] = comparison.distances()?;
    let cells = parameter.values().iter().map(|&value| {
        let options = parameter.at(value, &case.options);
        let clock = Clock::start();
        let result = align(&case.source, &case.control, &options, observer)?;
        let spent = clock.spent();
        let within = comparison.distances_within(&result.clip)?;
        Ok(SweptCell {
            value,
            quality: result.report.quality(),
            gradients: result.report.gradients,
            spent,
            result: Picture::of(&within),
            poses: strip(&result.clip)?,
        })
    });
    Ok(SweptCase {
        case: case.name.clone(),
        default: parameter.of(&case.options),
        control: Picture::of(&control),
        cells: cells.collect::<Result<_, CliError>>()?,
    })
}

/// Whether an error is that the user wants to stop.
pub(crate) fn is_cancelled(error: &CliError) -> bool {
    matches!(error, CliError::Align(cause) if matches!(**cause, AlignError::Cancelled))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_one_that_align_takes() {
        let defaults = Options::default();
        for parameter in
            ["alpha", "lambda", "epsilon", "levels"].map(|name| name.parse::<Parameter>().unwrap())
        {
            assert!(
                parameter.values().contains(&parameter.of(&defaults)),
                "{parameter:?}: the default is among them"
            );
            for &value in parameter.values() {
                let options = parameter.at(value, &defaults);
                assert!(options.validate().is_ok() && parameter.of(&options) == value);
                assert!(options.gradients().abs_diff(defaults.gradients()) <= 8, "{}", options.gradients());
            }
        }
        assert!("beta".parse::<Parameter>().unwrap_err().contains("levels"));
    }
}
