//! The unit of a file that does not say it.

use crate::Finding;

/// Metres of a metre, a centimetre, a millimetre, an inch, and the unit of the CMU motion library (an inch / 0.45).
const UNITS: [(f64, &str); 5] = [
    (1.0, "metres"),
    (0.01, "centimetres"),
    (0.001, "millimetres"),
    (0.0254, "inches"),
    (0.0564, "CMU units"),
];

/// Height of a person, metres.
const PERSON: f64 = 1.7;

/// The length of a unit, in metres, that makes a figure of `extent` units (the longest side of its rest pose) most
/// like a person of 1.7 m, by ratio: one of 1, 0.01, 0.001, 0.0254, 0.0564. `None` when the figure has no extent.
pub fn guess_metres_per_unit(extent: f64) -> Option<f64> {
    guess(extent).map(|(metres, _)| metres)
}

/// The guess and what to say about it.
pub(crate) fn guess_with_finding(extent: f64) -> (f64, Finding) {
    let Some((metres, name)) = guess(extent) else {
        let message = "the figure has no size, so its unit is taken as a centimetre; `--unit` sets another";
        return (0.01, Finding::warning("unit-unknown", message.into()));
    };
    let size = extent * metres;
    let message =
        format!("the unit is guessed as {name}: the figure is then {size:.3} m large; `--unit` sets another");
    // A cat and a giant are still plausible; a figure of 100 m is not.
    let plausible = (0.3..10.0).contains(&size);
    let finding = if plausible { Finding::info } else { Finding::warning };
    (metres, finding("unit-guessed", message))
}

fn guess(extent: f64) -> Option<(f64, &'static str)> {
    let misfit = |&(metres, _): &(f64, &str)| (extent * metres / PERSON).ln().abs();
    let usable = extent.is_finite() && extent > 0.0;
    UNITS.into_iter().filter(|_| usable).min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_in_each_unit() {
        for (extent, metres) in [(1.8, 1.0), (165.0, 0.01), (1650.0, 0.001), (66.0, 0.0254), (31.0, 0.0564)] {
            assert_eq!(guess_metres_per_unit(extent), Some(metres), "{extent}");
        }
        assert_eq!(guess_metres_per_unit(0.0), None);
        assert_eq!(guess_metres_per_unit(f64::NAN), None);
    }

    #[test]
    fn an_odd_size_is_a_warning() {
        let (metres, finding) = guess_with_finding(1e6);
        assert_eq!((metres, finding.severity), (0.001, crate::Severity::Warning));
        assert!(finding.message.contains("1000.000 m large"), "{}", finding.message);
    }
}
