//! A result for people: words, a page, a contact sheet.

use crate::main_axes::main_axes;
use crate::preview::{self, ControlView, Figure, Guide, HeatMap, Preview};
use crate::printable::{self, counted, fixed};
use crate::sheet::{SheetError, SheetOptions, contact_sheet};
use crate::span::seconds;
use inkrig_align::{AMBIGUOUS, Alignment, Control, ControlKind};
use std::fmt::Write;
use std::path::Path;

/// A few lines on what was made and how good it is.
pub(crate) fn summary(alignment: &Alignment, out: &Path) -> String {
    let (clip, report) = (&alignment.clip, &alignment.report);
    let mut text = format!(
        "wrote {}: {:.1} s, {} at {} a second\n",
        printable::path(out),
        seconds(clip),
        counted(clip.frames(), "frame"),
        (clip.frame_rate() * 1e3).round() / 1e3
    );
    for figure in figures(alignment) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<24} {:<8} {}", figure.name, figure.value, figure.note);
    }
    for note in &report.notes {
        let _ = writeln!(text, "note: {}", printable::text(note));
    }
    text.trim_end().to_string()
}

/// The preview page.
pub(crate) fn page(title: &str, alignment: &Alignment, control: &Control, guide: Option<&Guide>) -> String {
    let points = points(control);
    let (width, height) = (alignment.plan.cols().min(400), alignment.plan.rows().min(400));
    preview::render(&Preview {
        title,
        result: &alignment.clip,
        source: alignment.source.clip(),
        control: ControlView::Curve(&points),
        control_rate: control.rate,
        heat_map: HeatMap { width, height, values: alignment.plan.heat_map(width, height) },
        best_source: &alignment.best_source,
        confidence: &alignment.confidence,
        guide,
        board: &[],
        figures: &figures(alignment),
        notes: &alignment.report.notes,
    })
}

/// The contact sheet as PNG.
pub(crate) fn sheet(alignment: &Alignment, control: &Control) -> Result<Vec<u8>, SheetError> {
    let points = points(control);
    contact_sheet(&alignment.clip, &SheetOptions { markers: Some(&points), ..SheetOptions::default() })
}

/// The control as a line to look at: a curve as it is (its first two numbers), a single value over time, a label's
/// number over time, of a sound its level over time, of a motion its poses along their two main axes.
fn points(control: &Control) -> Vec<[f64; 2]> {
    /// Width of a line over time, in heights.
    const WIDTH: f64 = 2.5;
    let features = &control.features;
    if control.kind == ControlKind::Motion {
        return main_axes(features);
    }
    let along = |frame: usize| WIDTH * frame as f64 / features.frames().max(2) as f64;
    let largest =
        |row: &[f32]| row.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index);
    let levels = || (0..features.frames()).map(|frame| features.row(frame)[0]);
    let (least, most) = (levels().fold(f32::INFINITY, f32::min), levels().fold(f32::NEG_INFINITY, f32::max));
    (0..features.frames())
        .map(|frame| match (control.kind, features.row(frame)) {
            (ControlKind::Sound, row) => {
                [along(frame), f64::from((row[0] - least) / (most - least).max(f32::MIN_POSITIVE))]
            }
            (ControlKind::Labels, row) => {
                [along(frame), -(largest(row) as f64) / (row.len().max(2) - 1) as f64]
            }
            (_, [value]) => [along(frame), f64::from(*value) * 0.5],
            (_, row) => [f64::from(row[0]), f64::from(row[1])],
        })
        .collect()
}

fn figures(alignment: &Alignment) -> Vec<Figure> {
    let report = &alignment.report;
    let figure = |name: &str, value: String, note: String| Figure { name: name.to_string(), value, note };
    let number = |value: f64| fixed(value, 2);
    let percent = |share: f64| format!("{} %", fixed(100.0 * share, 0));
    let mut figures = vec![
        figure(
            "follows the drawing",
            number(report.structure_pearson),
            format!(
                "1 is perfect; the clip merely stretched to this length has {}",
                number(report.structure_pearson_warp)
            ),
        ),
        figure(
            "away from the clip",
            number(report.nearest_patch),
            "0 is a copy; 1 is as far as two ordinary moments of the clip".to_string(),
        ),
        figure(
            "clip used",
            percent(report.coverage),
            "share of the clip that the result comes near to".to_string(),
        ),
        figure(
            "speed",
            number(report.speed_mean_ratio),
            "mean speed of the body; 1 is the clip's own".to_string(),
        ),
        figure(
            "jumps",
            number(report.jump_q999_ratio),
            "fastest movements; above 2 something jumps".to_string(),
        ),
        figure(
            "jerk",
            number(report.jerk_ratio),
            "roughness of the movement; 1 is the clip's own".to_string(),
        ),
        figure(
            "standing still",
            percent(report.freeze),
            format!("share of the time; {} in the clip", percent(report.freeze_source)),
        ),
        figure(
            "mirror image",
            percent(report.mirror_symmetry),
            if report.mirror_symmetry >= AMBIGUOUS {
                "how much the control is its own: ambiguous, --mirror and --solutions show others".to_string()
            } else {
                "how much the control is its own; little is ambiguous".to_string()
            },
        ),
        figure(
            "solved in",
            format!("{:.3} s", report.solve_seconds),
            format!("{} gradients, {}", report.gradients, report.instruction_set),
        ),
    ];
    if let Some(sound) = &report.sound {
        let with = |stretched: f64| {
            format!("correlation with speed, either sign; the stretched clip has {}", number(stretched))
        };
        figures.push(figure(
            "quick where loud",
            number(sound.loudness_correlation),
            with(sound.loudness_correlation_warp),
        ));
        figures.push(figure(
            "stops on the beat",
            number(sound.beat_alignment),
            format!("1 if all onsets have one; the stretched clip has {}", number(sound.beat_alignment_warp)),
        ));
    }
    figures
}
