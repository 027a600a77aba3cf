//! What a motion shall follow, from the command line.

use super::align::motion;
use crate::cli::{AlignArgs, ImportArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::load;
use inkrig_align::{AlignError, Control, CurveOptions, Options, SoundOptions};
use inkrig_sketch::{Drawing, Format, Labels, SketchError, Timing, Wave};
use std::path::{Path, PathBuf};

/// The control that was asked for. What is odd in its file is said, and added to `warnings`.
pub(super) fn control(
    args: &AlignArgs,
    options: &Options,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Control, CliError> {
    check_options(args)?;
    let rate = options.matching_rate;
    let samples = args.length.map(|length| length.frames(rate));
    let asked = &args.control;
    let mut odd = Vec::new();
    let mut control = if let Some(path) = &asked.curve {
        curve(path, args, samples, rate, &mut odd)?
    } else if let Some(text) = &asked.wave {
        wave(text, samples, rate, &mut odd)?
    } else if let Some(text) = &asked.labels {
        labels(text, samples, rate)?
    } else if let Some(path) = &asked.sound {
        sound(path, args, rate, samples, &mut odd)?
    } else if let Some(path) = &asked.like {
        // Another character, in a file of its own: what was said of reading the clip is not of it.
        let like = motion(path, &ImportArgs::default(), console, warnings)?.clip;
        stretched(Control::from_motion(&like, rate, &options.features)?, samples, rate)
    } else {
        // Clap asks for one of them.
        return Err(AlignError::StillControl.into());
    };
    for warning in odd {
        console.warn(&warning);
        warnings.push(warning);
    }
    // A sound was repeated before it was analysed.
    if args.repeat > 1 && asked.sound.is_none() {
        control = control.repeated(args.repeat)?;
    }
    control.cyclic = args.cyclic;
    Ok(control)
}

/// Refuses options that nothing would come of.
fn check_options(args: &AlignArgs) -> Result<(), CliError> {
    let asked = &args.control;
    let with = match asked {
        _ if asked.wave.is_some() => "--wave",
        _ if asked.labels.is_some() => "--labels",
        _ if asked.like.is_some() => "--like",
        _ if asked.sound.is_some() => "--sound",
        _ => return Ok(()),
    };
    match (args.smooth, args.uniform) {
        (_, true) => Err(CliError::NoEffect { flag: "--uniform", with }),
        (Some(_), _) if asked.sound.is_none() => Err(CliError::NoEffect { flag: "--smooth", with }),
        _ => Ok(()),
    }
}

/// A control said to play at another speed, so that it has a length.
fn stretched(mut control: Control, samples: Option<usize>, rate: f64) -> Control {
    if let Some(samples) = samples {
        control.rate = control.features.frames() as f64 * rate / samples.max(1) as f64;
    }
    control
}

/// A sound is repeated before it is analysed, so that nothing is heard where one time ends and the next begins.
fn sound(
    path: &Path,
    args: &AlignArgs,
    rate: f64,
    samples: Option<usize>,
    odd: &mut Vec<String>,
) -> Result<Control, CliError> {
    let smooth = args.smooth.unwrap_or(SoundOptions::default().smooth);
    let options = SoundOptions { rate, smooth, times: args.repeat };
    let (sound, findings) = load::sound(path)?;
    odd.extend(findings);
    let samples = samples.map(|samples| samples.saturating_mul(args.repeat));
    Ok(stretched(Control::from_sound(&sound, &options)?, samples, rate))
}

/// A drawing; a CSV of other columns than x and y is a curve of as many dimensions.
fn curve(
    path: &Path,
    args: &AlignArgs,
    samples: Option<usize>,
    rate: f64,
    odd: &mut Vec<String>,
) -> Result<Control, CliError> {
    let timing = args.uniform.then_some(Timing::ArcLength);
    let (drawing, guess) = load::drawn(path)?;
    odd.extend(guess);
    // What is followed several times goes on from its end to its beginning, as in a loop.
    let plain = CurveOptions { samples, rate, timing, goes_on: args.cyclic || args.repeat > 1, smooth: 0.0 };
    let control = match drawing {
        Drawing::Plane(curve) => {
            let smooth = args.smooth.unwrap_or(CurveOptions::default().smooth);
            Control::from_curve(&curve, &CurveOptions { smooth, ..plain })
        }
        Drawing::Table(table) => {
            let smooth = args.smooth.unwrap_or(0.0);
            Control::from_table_as(&table, &CurveOptions { smooth, ..plain })
        }
    };
    control.map_err(|error| with_path(path, error))
}

fn wave(text: &str, samples: Option<usize>, rate: f64, odd: &mut Vec<String>) -> Result<Control, CliError> {
    let Some(path) = file_in(text) else {
        let wave: Wave = text.parse().map_err(|error| no_text("--wave", text, error))?;
        return Control::from_wave(&wave, samples, rate).map_err(|error| with_text("--wave", error));
    };
    if ending(&path) == "wav" {
        let (sound, findings) = load::sound(&path)?;
        odd.extend(findings);
        return Ok(Control::from_waveform(&sound, samples, rate)?);
    }
    let bytes = load::drawing(&path)?;
    let format = Format::from_path(&path).unwrap_or(Format::Csv);
    let table = inkrig_sketch::read_wave(&bytes, format).map_err(|error| about(&path, error))?;
    Control::from_table(&table, samples, rate).map_err(|error| with_path(&path, error))
}

fn labels(text: &str, samples: Option<usize>, rate: f64) -> Result<Control, CliError> {
    let Some(path) = file_in(text) else {
        let labels: Labels = text.parse().map_err(|error| no_text("--labels", text, error))?;
        return Control::from_labels(&labels, samples, rate).map_err(|error| with_text("--labels", error));
    };
    let bytes = load::drawing(&path)?;
    let format = Format::from_path(&path).unwrap_or(Format::Csv);
    let labels = inkrig_sketch::read_labels(&bytes, format).map_err(|error| about(&path, error))?;
    Control::from_labels(&labels, samples, rate).map_err(|error| with_path(&path, error))
}

/// The file that a text names: one with the ending of a table or of a sound. Anything else is the wave or the labels
/// themselves.
pub(crate) fn file_in(text: &str) -> Option<PathBuf> {
    let path = Path::new(text);
    ["csv", "json", "wav"].contains(&ending(path).as_str()).then(|| path.to_path_buf())
}

/// What is wrong with a wave or labels: perhaps they are meant as a file.
fn no_text(flag: &'static str, text: &str, cause: SketchError) -> CliError {
    let path = Path::new(text.trim());
    let ending = ending(path);
    let has_ending = (1..=5).contains(&ending.len())
        && ending.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && ending.chars().all(|letter| letter.is_ascii_alphanumeric());
    let bare = !text.contains(['(', '=', '*']);
    if path.is_file() || (has_ending && bare) {
        let known = if flag == "--wave" {
            "a wave is text such as \"sine(1Hz) for 10s\", or a .csv, .json or .wav file; for a sound of any other kind use --sound FILE"
        } else {
            "labels are text such as \"A 2s, B 2s\", or a .csv or .json file; for a sound use --sound FILE"
        };
        return CliError::LooksLikeFile { flag, text: text.into(), known };
    }
    said(flag, cause)
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase()
}

fn about(path: &Path, cause: SketchError) -> CliError {
    CliError::Curve { path: path.to_path_buf(), cause: Box::new(cause) }
}

fn said(flag: &'static str, cause: SketchError) -> CliError {
    CliError::Text { flag, cause: Box::new(cause) }
}

fn with_path(path: &Path, error: AlignError) -> CliError {
    match error {
        AlignError::Sketch(cause) => about(path, cause),
        other => other.into(),
    }
}

fn with_text(flag: &'static str, error: AlignError) -> CliError {
    match error {
        AlignError::Sketch(cause) => said(flag, cause),
        other => other.into(),
    }
}
