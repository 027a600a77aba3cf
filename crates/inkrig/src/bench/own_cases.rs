//! The cases that need nothing: this project's own samples.

use super::{Case, ControlSpec};
use crate::error::CliError;
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{Clip, Takes, time};
use inkrig_sketch::{Curve, Format, read_curve, shapes};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// From 2 to 8 waves in ten of its seconds: low to high.
pub(super) const CHIRP: &str = "sine(0.2Hz..0.8Hz) for 10s";
/// One kind of movement, another, the first again, a third.
pub(super) const FOUR_LABELS: &str = "A:3s B:3s A:3s C:3s";

/// All of them: every kind of control on three characters, across characters, and with several clusters.
///
/// # Errors
/// Never, as long as the embedded samples are what they are.
pub fn own_cases() -> Result<Vec<Case>, CliError> {
    let [person, quadruped, snake] = [motion("person")?, motion("quadruped")?, motion("snake")?];
    let wave = ControlSpec::Wave;
    let step = "sine(0.3Hz) for 5s; sine(1Hz) for 5s";
    let sharp = "triangle(0.3Hz) for 10s";
    let sides = "alternate(sine(0.8Hz), centres=-2|2, every=2.5s) for 10s";
    let many = "A:2s B:2s C:2s A:2s D:2s B:2s E:2s";
    let one = |clip: &Clip| Takes::from(clip.clone());
    let table = [
        ("circles to person", one(&person), ControlSpec::Curve(circles()?)),
        ("spiral to quadruped", one(&quadruped), ControlSpec::Curve(drawing("spiral")?)),
        ("eight to snake", one(&snake), ControlSpec::Curve(drawing("eight")?)),
        ("chirp to quadruped", one(&quadruped), wave(CHIRP)),
        ("low then high to person", one(&person), wave(step)),
        ("triangle to quadruped", one(&quadruped), wave(sharp)),
        ("alternating sine to snake", one(&snake), wave(sides)),
        ("labels to person", one(&person), ControlSpec::Labels(FOUR_LABELS)),
        ("sound to person", one(&person), ControlSpec::Sound),
        ("person to quadruped", one(&quadruped), ControlSpec::Like(&person)),
        ("quadruped to person", one(&person), ControlSpec::Like(&quadruped)),
        ("person to snake", one(&snake), ControlSpec::Like(&person)),
        ("clusters: five labels to person", one(&person), ControlSpec::Labels(many)),
        ("clusters: islands to three clips", three_clips(&person)?, ControlSpec::Curve(islands()?)),
    ];
    table
        .iter()
        .map(|(name, source, follow)| Ok(Case::new((*name).to_string(), source.clone(), follow)?))
        .collect()
}

/// Five circles that grow, ten seconds.
pub(super) fn circles() -> Result<Curve, CliError> {
    shapes::growing_circles(5, 300).map_err(|cause| drawn("circles", cause))
}

/// Small circles at one place of the canvas, at a second, at the first, at a third: three clusters, far apart.
fn islands() -> Result<Curve, CliError> {
    const PLACES: [[f64; 2]; 4] = [[0.0, 0.0], [6.0, 0.0], [0.0, 0.0], [3.0, 5.0]];
    let points = PLACES.iter().flat_map(|[x, y]| {
        (0..75).map(move |index| {
            let (up, along) = (TAU * f64::from(index) / 37.5).sin_cos();
            [x + along, y + up]
        })
    });
    Curve::new(points.collect()).map_err(|cause| drawn("islands", cause))
}

/// The person walking, waving and stepping aside, as three clips: nothing goes over from one to the next.
fn three_clips(person: &Clip) -> Result<Takes, CliError> {
    let rate = person.frame_rate();
    let part = |from: f64, to: f64| {
        let end = ((to * rate) as usize).min(person.frames());
        time::trim(person, (from * rate) as usize..end)
    };
    Ok(Takes::join(&[part(0.0, 6.0)?, part(9.0, 14.0)?, part(18.0, 24.0)?])?)
}

fn motion(name: &str) -> Result<Clip, CliError> {
    let bytes = inkrig_samples::find(name).map_or(&[][..], |sample| sample.bytes);
    let import = read_bvh(bytes, &ImportOptions::default())
        .map_err(|error| CliError::Format { path: PathBuf::from(name), cause: Box::new(error) })?;
    Ok(import.clip)
}

fn drawing(name: &str) -> Result<Curve, CliError> {
    let sample = inkrig_samples::find(name);
    let format =
        sample.and_then(|sample| Format::from_path(sample.file_name.as_ref())).unwrap_or(Format::Json);
    read_curve(sample.map_or(&[][..], |sample| sample.bytes), format).map_err(|cause| drawn(name, cause))
}

fn drawn(name: &str, cause: inkrig_sketch::SketchError) -> CliError {
    CliError::Curve { path: PathBuf::from(name), cause: Box::new(cause) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_control_has_a_case_of_its_own_name() {
        let cases = own_cases().unwrap();
        let names: std::collections::BTreeSet<&str> = cases.iter().map(|case| case.name.as_str()).collect();
        assert_eq!(names.len(), cases.len());
        use inkrig_align::ControlKind::{Curve, Labels, Motion, Sound, Wave};
        for kind in [Curve, Wave, Labels, Sound, Motion] {
            assert!(cases.iter().any(|case| case.control.kind == kind), "{kind:?}");
        }
        assert!(cases.iter().any(|case| case.source.count() == 3));
    }
}
