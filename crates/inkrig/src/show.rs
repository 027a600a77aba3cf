//! A result for people: words, a page, a contact sheet.

use crate::preview::{self, ControlView, Figure, HeatMap, Preview};
use crate::sheet::{SheetError, SheetOptions, contact_sheet};
use inkrig_align::{Alignment, Control};
use std::fmt::Write;
use std::path::Path;

/// A few lines on what was made and how good it is.
pub(crate) fn summary(alignment: &Alignment, out: &Path) -> String {
    let (clip, report) = (&alignment.clip, &alignment.report);
    let mut text = format!(
        "wrote {}: {:.1} s, {} frames at {} a second\n",
        out.display(),
        clip.frames() as f64 / clip.frame_rate(),
        clip.frames(),
        (clip.frame_rate() * 1e3).round() / 1e3
    );
    for figure in figures(alignment) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<24} {:<8} {}", figure.name, figure.value, figure.note);
    }
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text.trim_end().to_string()
}

/// The preview page.
pub(crate) fn page(title: &str, alignment: &Alignment, control: &Control) -> String {
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
        figures: &figures(alignment),
        notes: &alignment.report.notes,
    })
}

/// The contact sheet as PNG.
pub(crate) fn sheet(alignment: &Alignment, control: &Control) -> Result<Vec<u8>, SheetError> {
    let points = points(control);
    contact_sheet(&alignment.clip, &SheetOptions { markers: Some(&points), ..SheetOptions::default() })
}

/// The first two numbers of every control sample.
fn points(control: &Control) -> Vec<[f64; 2]> {
    let features = &control.features;
    (0..features.frames())
        .map(|frame| {
            let at = |column: usize| features.row(frame).get(column).copied().map_or(0.0, f64::from);
            [at(0), at(1)]
        })
        .collect()
}

fn figures(alignment: &Alignment) -> Vec<Figure> {
    let report = &alignment.report;
    let figure = |name: &str, value: String, note: String| Figure { name: name.to_string(), value, note };
    let number = |value: f64| format!("{value:.2}");
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    vec![
        figure(
            "follows the drawing",
            number(report.structure_pearson),
            format!(
                "1 is perfect; the clip merely stretched to this length has {:.2}",
                report.structure_pearson_warp
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
            "solved in",
            format!("{:.3} s", report.solve_seconds),
            format!("{} gradients, {}", report.gradients, report.instruction_set),
        ),
    ]
}
