//! The table as people and programs read it.

use super::{Machine, Method, Row};
use serde::Serialize;
use std::fmt::Write;

/// A case that could not be run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Failure {
    /// Its name, or the file's.
    pub case: String,
    /// What stood in the way.
    pub reason: String,
}

/// Everything that a run of the benchmark gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// What it was measured on.
    pub machine: Machine,
    /// How often every row was run; its time is the least.
    pub repeats: usize,
    /// Case by case, the methods in their order.
    pub rows: Vec<Row>,
    /// What could not be run.
    pub failures: Vec<Failure>,
}

/// Takes a figure from a row.
type Figure = fn(&Row) -> f64;

/// What both tables show of a row, in their order.
const FIGURES: [(&str, Figure); 9] = [
    ("structure", |row| row.quality.structure_pearson),
    ("warp", |row| row.quality.structure_pearson_warp),
    ("gain", |row| row.structure_gain),
    ("nearest", |row| row.quality.nearest_patch),
    ("coverage", |row| row.quality.coverage),
    ("jump", |row| row.quality.jump_q999_ratio),
    ("speed", |row| row.quality.speed_mean_ratio),
    ("jerk", |row| row.quality.jerk_ratio),
    ("freeze", |row| row.quality.freeze),
];

impl Table {
    /// The machine, means of every method, and all rows, as Markdown tables; below them what failed.
    pub fn markdown(&self) -> String {
        let figures = FIGURES.map(|(name, _)| name).join(" | ");
        let marks = "---:|".repeat(FIGURES.len());
        let mut text = format!("{}; times are the least of {}.\n\n", self.machine, self.repeats);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| mean of | {figures} | CPU ms | wall ms | without a miss |\n|---|{marks}---:|---:|---:|"
        );
        for method in Method::ALL {
            let rows: Vec<&Row> = self.rows.iter().filter(|row| row.method == method).collect();
            let good = rows.iter().filter(|row| row.misses.is_empty()).count();
            let _ = writeln!(text, "| {} | {} | {good} of {} |", method.name(), cells(&rows), rows.len());
        }
        let _ = writeln!(
            text,
            "\n| case | method | {figures} | CPU ms | wall ms | misses |\n|---|---|{marks}---:|---:|---|"
        );
        for row in &self.rows {
            let (case, method) = (cell(&row.case), row.method.name());
            let _ = writeln!(text, "| {case} | {method} | {} | {} |", cells(&[row]), row.misses.join(", "));
        }
        for Failure { case, reason } in &self.failures {
            let _ = writeln!(text, "\nNot run: {}: {}", cell(case), cell(reason));
        }
        text
    }
}

/// Means of all figures and times.
fn cells(rows: &[&Row]) -> String {
    let mean =
        |of: &dyn Fn(&Row) -> f64| rows.iter().map(|row| of(row)).sum::<f64>() / rows.len().max(1) as f64;
    let mut cells: Vec<String> = FIGURES.iter().map(|(_, figure)| decimal(mean(figure))).collect();
    let timed = rows.iter().all(|row| row.spent.cpu_seconds.is_some());
    let cpu = mean(&|row| 1e3 * row.spent.cpu_seconds.unwrap_or_default());
    cells.push(if timed { format!("{cpu:.0}") } else { "-".to_string() });
    cells.push(format!("{:.0}", mean(&|row| 1e3 * row.spent.wall_seconds)));
    cells.join(" | ")
}

/// Two places, and no minus before a zero.
fn decimal(value: f64) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" { "0.00".to_string() } else { text }
}

/// Text that stays within its cell.
fn cell(text: &str) -> String {
    crate::printable::text(text).replace('|', "\\|").replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Spent;
    use inkrig_align::Quality;

    #[test]
    fn every_row_is_one_line_of_as_many_cells() {
        let row = Row {
            case: "a|b\nc".to_string(),
            method: Method::OneStage,
            source_frames: 1,
            control_frames: 2,
            quality: Quality { structure_pearson: -0.001, ..Quality::default() },
            structure_gain: 0.5,
            misses: vec!["jump", "speed"],
            gradients: 3,
            spent: Spent { cpu_seconds: None, wall_seconds: 0.0123 },
        };
        let failures = vec![Failure { case: "x".to_string(), reason: "why".to_string() }];
        let table = Table { machine: Machine::this(1), repeats: 3, rows: vec![row], failures };
        let text = table.markdown();
        let lines: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
        assert_eq!(lines.len(), 2 + 5 + 2 + 1);
        assert!(lines[..7].iter().all(|line| line.matches('|').count() == 14), "{lines:?}");
        assert!(
            lines[3].starts_with("| one stage | 0.00 | 0.00 | 0.50 ") && lines[3].ends_with("| 0 of 1 |")
        );
        assert!(lines[2].ends_with("| 0 of 0 |"), "{}", lines[2]);
        let row = lines[9];
        assert!(row.starts_with("| a\\|b") && row.matches(" | ").count() == 13, "{row}");
        assert!(row.ends_with("| one stage | 0.00 | 0.00 | 0.50 | 0.00 | 0.00 | 0.00 | 0.00 | 0.00 | 0.00 | - | 12 | jump, speed |"));
        assert!(text.contains("Not run: x: why"));
    }
}
