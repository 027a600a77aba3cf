//! What a motion shall follow, from the command line.

use crate::cli::AlignArgs;
use crate::error::CliError;
use crate::load;
use inkrig_align::{AlignError, Control, CurveOptions, Options, SoundOptions};
use inkrig_motion::Clip;
use inkrig_sketch::{Format, Labels, SketchError, Timing, Wave};
use std::path::{Path, PathBuf};

/// The control that was asked for; `motion` reads a motion file.
pub(super) fn control(
    args: &AlignArgs,
    options: &Options,
    motion: impl FnOnce(&Path) -> Result<Clip, CliError>,
) -> Result<Control, CliError> {
    let rate = options.matching_rate;
    let samples = args.length.map(|length| length.frames(rate));
    let asked = &args.control;
    let mut control = if let Some(path) = &asked.curve {
        curve(path, args, samples, rate)?
    } else if let Some(text) = &asked.wave {
        wave(text, samples, rate)?
    } else if let Some(text) = &asked.labels {
        labels(text, samples, rate)?
    } else if let Some(path) = &asked.sound {
        return sound(path, args, rate, samples);
    } else if let Some(path) = &asked.like {
        stretched(Control::from_motion(&motion(path)?, rate, &options.features)?, samples, rate)
    } else {
        // Clap asks for one of them.
        return Err(AlignError::StillControl.into());
    };
    if args.repeat > 1 {
        control = control.repeated(args.repeat)?;
    }
    control.cyclic = args.cyclic;
    Ok(control)
}

/// A control said to play at another speed, so that it has a length.
fn stretched(mut control: Control, samples: Option<usize>, rate: f64) -> Control {
    if let Some(samples) = samples {
        control.rate = control.features.frames() as f64 * rate / samples.max(1) as f64;
    }
    control
}

/// A sound is repeated before it is analysed, so that nothing is heard where one time ends and the next begins.
fn sound(path: &Path, args: &AlignArgs, rate: f64, samples: Option<usize>) -> Result<Control, CliError> {
    let smooth = args.smooth.unwrap_or(SoundOptions::default().smooth);
    let options = SoundOptions { rate, smooth, times: args.repeat };
    let played = Control::from_sound(&load::sound(path)?, &options)?;
    let samples = samples.map(|samples| samples.saturating_mul(args.repeat));
    Ok(Control { cyclic: args.cyclic, ..stretched(played, samples, rate) })
}

/// A drawing; a CSV of other columns than x and y is a curve of as many dimensions.
fn curve(path: &Path, args: &AlignArgs, samples: Option<usize>, rate: f64) -> Result<Control, CliError> {
    let timing = args.uniform.then_some(Timing::ArcLength);
    let smooth = args.smooth.unwrap_or(CurveOptions::default().smooth);
    let options = CurveOptions { samples, rate, smooth, timing };
    let drawn = load::curve(path);
    if drawn.is_err() && Format::from_path(path) == Some(Format::Csv) {
        let table = load::drawing(path)
            .and_then(|bytes| inkrig_sketch::read_table(&bytes).map_err(|error| about(path, error)));
        if let Ok(table) = table
            && table.width() > 2
        {
            return Control::from_table(&table, samples, rate).map_err(|error| with_path(path, error));
        }
    }
    Control::from_curve(&drawn?, &options).map_err(|error| with_path(path, error))
}

fn wave(text: &str, samples: Option<usize>, rate: f64) -> Result<Control, CliError> {
    let Some(path) = file_in(text) else {
        let wave: Wave = text.parse().map_err(|error| said("--wave", error))?;
        return Control::from_wave(&wave, samples, rate).map_err(|error| with_text("--wave", error));
    };
    if ending(&path) == "wav" {
        return Ok(Control::from_waveform(&load::sound(&path)?, samples, rate)?);
    }
    let bytes = load::drawing(&path)?;
    let format = Format::from_path(&path).unwrap_or(Format::Csv);
    let table = inkrig_sketch::read_wave(&bytes, format).map_err(|error| about(&path, error))?;
    Control::from_table(&table, samples, rate).map_err(|error| with_path(&path, error))
}

fn labels(text: &str, samples: Option<usize>, rate: f64) -> Result<Control, CliError> {
    let Some(path) = file_in(text) else {
        let labels: Labels = text.parse().map_err(|error| said("--labels", error))?;
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
