//! Files of drawings, waves and labels as controls.

use crate::StudioError;
use crate::document::{Control, CurveTiming, LabelSegment, PenPoint};
use inkrig_sketch::{
    Drawing, Format, LabelLength, Origin, Table, read_drawing as read_any, read_labels, read_wave,
};
use serde::Deserialize;
use utoipa::ToSchema;

/// Frames a second of labels and waves that are said in frames.
pub(crate) const RATE: f64 = 30.0;

/// What a drawing file is read as.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub(crate) enum As {
    /// A curve.
    #[default]
    Curve,
    /// A value over time.
    Wave,
    /// Movements by name.
    Labels,
}

/// What a file of a drawing, a wave or labels says.
///
/// # Errors
/// When its name says no known kind, or it is not understood.
pub(crate) fn read(bytes: &[u8], name: &str, kind: As) -> Result<(Control, Option<String>), StudioError> {
    let known = "drawings are .svg, .csv and .json";
    let format = Format::from_path(std::path::Path::new(name));
    let format = format.ok_or_else(|| StudioError::Kind { name: name.chars().take(80).collect(), known })?;
    match kind {
        As::Labels => {
            let labels = read_labels(bytes, format)?;
            let segments = labels.segments().map(|(name, length)| LabelSegment {
                name: name.to_string(),
                seconds: match length {
                    LabelLength::Frames(frames) => frames as f64 / RATE,
                    LabelLength::Seconds(seconds) => seconds,
                },
                colour: None,
            });
            Ok((Control::Labels { segments: segments.collect() }, None))
        }
        As::Wave => Ok((drawn_wave(&read_wave(bytes, format)?), None)),
        As::Curve => match read_any(bytes, format)? {
            (Drawing::Plane(curve), note) => {
                let timing = if curve.seconds().is_some() { CurveTiming::Pen } else { CurveTiming::Even };
                // Rows without time are frames.
                let own = |index: usize| (curve.origin() == Origin::Sampled).then_some(index as f64 / RATE);
                let (seconds, pressure) = (curve.seconds(), curve.pressure());
                let timing = if curve.origin() == Origin::Sampled { CurveTiming::Pen } else { timing };
                let point = |index: usize| -> PenPoint {
                    let [x, y] = curve.points().get(index).copied().unwrap_or_default();
                    let t = seconds.and_then(|all| all.get(index).copied()).or_else(|| own(index));
                    (x, y, t, pressure.and_then(|all| all.get(index).copied()))
                };
                let strokes = curve.stroke_ranges().map(|range| range.map(point).collect()).collect();
                Ok((Control::Curve { strokes, timing, smooth: None }, note))
            }
            (Drawing::Table(table), note) if table.width() == 1 => Ok((drawn_wave(&table), note)),
            (Drawing::Table(table), _) => Err(StudioError::invalid(format!(
                "the file has {} columns, and a drawing two: use `inkrig align --curve` for more dimensions",
                table.width()
            ))),
        },
    }
}

fn drawn_wave(table: &Table) -> Control {
    let time =
        |row: usize| table.seconds().and_then(|all| all.get(row).copied()).unwrap_or(row as f64 / RATE);
    let values = table.values().iter().step_by(table.width().max(1));
    Control::DrawnWave { points: values.enumerate().map(|(row, &value)| [time(row), value]).collect() }
}
