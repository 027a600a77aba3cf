//! The table as people and programs read it.

use super::{Machine, Row};
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

const COLUMNS: [&str; 14] = [
    "case",
    "method",
    "structure",
    "warp",
    "gain",
    "nearest",
    "coverage",
    "jump",
    "speed",
    "jerk",
    "freeze",
    "CPU ms",
    "wall ms",
    "misses",
];

impl Table {
    /// A Markdown table, one line a row, with the machine above and what failed below.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}; times are the least of {}.\n", self.machine, self.repeats);
        let _ = writeln!(text, "| {} |", COLUMNS.join(" | "));
        let marks = COLUMNS.map(|name| if LEFT.contains(&name) { "---" } else { "---:" });
        let _ = writeln!(text, "|{}|", marks.join("|"));
        for row in &self.rows {
            let _ = writeln!(text, "{}", line(row));
        }
        for Failure { case, reason } in &self.failures {
            let _ = writeln!(text, "\nNot run: {}: {}", cell(case), cell(reason));
        }
        text
    }
}

/// Columns of words.
const LEFT: [&str; 3] = ["case", "method", "misses"];

fn line(row: &Row) -> String {
    let quality = &row.quality;
    let milliseconds = |seconds: f64| format!("{:.0}", 1e3 * seconds);
    let figures = [
        quality.structure_pearson,
        quality.structure_pearson_warp,
        row.structure_gain,
        quality.nearest_patch,
        quality.coverage,
        quality.jump_q999_ratio,
        quality.speed_mean_ratio,
        quality.jerk_ratio,
        quality.freeze,
    ];
    let mut cells = vec![cell(&row.case), row.method.name().to_string()];
    cells.extend(figures.iter().map(|&figure| decimal(figure)));
    cells.push(row.spent.cpu_seconds.map_or("-".to_string(), milliseconds));
    cells.push(milliseconds(row.spent.wall_seconds));
    cells.push(row.misses.join(", "));
    format!("| {} |", cells.join(" | "))
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
    use crate::bench::{Method, Spent};
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
        assert_eq!(lines.len(), 3);
        assert!(lines[0].matches('|').count() == 15 && lines[1].matches('|').count() == 15);
        assert!(lines[2].starts_with("| a\\|b"), "{}", lines[2]);
        assert!(lines[2].ends_with("| one stage | 0.00 | 0.00 | 0.50 | 0.00 | 0.00 | 0.00 | 0.00 | 0.00 | 0.00 | - | 12 | jump, speed |"));
        assert!(text.contains("Not run: x: why"));
    }
}
