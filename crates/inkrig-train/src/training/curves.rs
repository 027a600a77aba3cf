//! The course of a run as a page: one picture a figure.

use super::checkpoint::CHECKPOINT;
use super::log::{self, LOG, Row};
use crate::TrainError;
use std::fmt::Write as _;
use std::path::Path;

/// Size of a picture, pixels.
const SIZE: (f64, f64) = (420.0, 200.0);

/// A page with the log of the run in `folder`: one line a figure over the steps, no other file needed.
///
/// # Errors
/// When the log cannot be read, or has nothing in it.
pub fn curves(folder: &Path) -> Result<String, TrainError> {
    let path = folder.join(LOG);
    let content = |what: &str| TrainError::Content { path: folder.into(), what: what.into() };
    if !path.exists() && !folder.join(CHECKPOINT).exists() {
        return Err(content("holds no run of inkrig train"));
    }
    let rows = if path.exists() { log::read(&path)? } else { Vec::new() };
    let Some(last) = rows.last() else {
        let what = "nothing was measured yet: go on with the run until its first measurement (`measure_every` of its settings)";
        return Err(content(what));
    };
    let held_out = last.values.keys().filter(|name| name.starts_with("held_out"));
    let parts = last.values.keys().filter(|name| !name.starts_with("held_out"));
    let mut pictures = String::new();
    for name in held_out.chain(parts) {
        pictures += &picture(name, &rows, |row| row.value(name));
    }
    for (name, of) in [("loss", 0), ("gradient", 1), ("rate", 2)] {
        pictures += &picture(name, &rows, |row| [row.loss, row.gradient, row.rate].get(of).copied());
    }
    let title = escaped(&folder.file_name().unwrap_or_default().to_string_lossy());
    let (step, minutes) = (last.step, last.seconds / 60.0);
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\n<style>body{{font:14px sans-serif;margin:24px;\
         color:#222;background:#fff}}figure{{display:inline-block;margin:8px}}figcaption{{margin-bottom:4px}}</style>\n<h1>{title}</h1>\n\
         <p>{step} steps in {minutes:.0} minutes of training.</p>\n{pictures}</html>\n"
    ))
}

/// One figure over the steps; by its logarithm where it spans more than a factor of ten.
fn picture(name: &str, rows: &[Row], of: impl Fn(&Row) -> Option<f64>) -> String {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .filter_map(|row| Some((row.step as f64, of(row).filter(|value| value.is_finite())?)))
        .collect();
    let (Some(&(_, last)), Some(&(end, _))) = (points.last(), points.last()) else { return String::new() };
    let values = || points.iter().map(|point| point.1);
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let logarithmic = least > 0.0 && most > 10.0 * least;
    let scale = |value: f64| if logarithmic { value.ln() } else { value };
    let (low, high) = (scale(least), scale(most));
    let span = if high > low { high - low } else { 1.0 };
    let (width, height) = SIZE;
    let mut line = String::new();
    for &(step, value) in &points {
        let x = width * step / end.max(1.0);
        let y = height * (1.0 - (scale(value) - low) / span);
        let _ = write!(line, "{x:.1},{y:.1} ");
    }
    let kind = if logarithmic { ", logarithmic" } else { "" };
    format!(
        "<figure><figcaption><b>{}</b>: {last:.4} (from {least:.4} to {most:.4}{kind})</figcaption><svg width=\"{width}\" \
         height=\"{height}\" viewBox=\"-4 -4 {} {}\" role=\"img\"><rect width=\"{width}\" height=\"{height}\" fill=\"#f4f4f4\"/><polyline \
         points=\"{line}\" fill=\"none\" stroke=\"#0b6e99\" stroke-width=\"1.5\"/></svg></figure>\n",
        escaped(&name.replace('_', " ")),
        width + 8.0,
        height + 8.0
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_its_line_and_names_are_no_markup() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("<b>run");
        std::fs::create_dir_all(&path).unwrap();
        assert!(curves(&path).unwrap_err().to_string().contains("holds no run"));
        std::fs::write(path.join(CHECKPOINT), "").unwrap();
        assert!(curves(&path).unwrap_err().to_string().contains("nothing was measured yet"));
        let row = |step: u64| Row {
            step,
            loss: 100.0 / step as f64,
            gradient: 1.0,
            rate: 1e-3,
            seconds: 60.0,
            values: [("held_out_mm".to_string(), 50.0), ("noise".to_string(), step as f64)].into(),
        };
        for step in [1, 50, 100] {
            log::append(&path.join("log.jsonl"), &row(step)).unwrap();
        }
        let page = curves(&path).unwrap();
        assert_eq!(page.matches("<polyline").count(), 5);
        assert!(page.contains("<b>held out mm</b>: 50.0000") && page.contains("logarithmic"));
        assert!(page.contains("&lt;b&gt;run") && !page.contains("<b>run"));
        assert!(page.contains("0.0,") || page.contains("4.2,0.0"), "{page}");
    }
}
