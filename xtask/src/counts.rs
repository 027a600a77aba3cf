//! Test counts, read from the closing lines of `cargo test` and `cargo nextest`.

use std::fmt;
use std::ops::AddAssign;

/// How many tests passed, failed and were skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    pub(crate) skipped: u64,
}

impl Counts {
    /// Reads the closing lines in the output of a test run: nextest's summary or, without one, each result of
    /// `cargo test`. Not both: nextest also shows what a failed test wrote, and that has a result line of its own.
    pub(crate) fn read(output: &str) -> Self {
        let mut results = Self::default();
        let mut summary = None;
        for line in output.lines() {
            let line = without_colour(line);
            if let Some((_, rest)) = line.split_once("test result:") {
                // "ok. 3 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out; finished in 0.00s"
                results += Self::of_parts(rest.split_once(". ").map_or("", |(_, rest)| rest), ';');
            } else if line.trim_start().starts_with("Summary [") {
                // "Summary [ 1.2s] 5/7 tests run: 3 passed (1 slow), 1 failed, 1 timed out, 2 skipped"
                summary = line.split_once(" run: ").map(|(_, rest)| Self::of_parts(rest, ',')).or(summary);
            }
        }
        summary.unwrap_or(results)
    }

    fn of_parts(parts: &str, separator: char) -> Self {
        let mut counts = Self::default();
        for part in without_brackets(parts).split(separator) {
            let Some((number, kind)) = part.trim().split_once(' ') else { continue };
            let Ok(number) = number.parse::<u64>() else { continue };
            match kind.trim() {
                "passed" => counts.passed += number,
                "failed" | "timed out" | "exec failed" => counts.failed += number,
                "skipped" | "ignored" => counts.skipped += number,
                _ => {}
            }
        }
        counts
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

/// Removes the terminal's colour codes: ESC [ ... m.
fn without_colour(line: &str) -> String {
    let mut pieces = line.split("\u{1b}[");
    let mut plain = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        plain.push_str(piece.split_once('m').map_or(piece, |(_, rest)| rest));
    }
    plain
}

fn without_brackets(text: &str) -> String {
    let mut depth = 0_u32;
    let outside = |c: &char| {
        match c {
            '(' => depth += 1,
            ')' => {
                depth = depth.saturating_sub(1);
                return false;
            }
            _ => {}
        }
        depth == 0
    };
    text.chars().filter(outside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(passed: u64, failed: u64, skipped: u64) -> Counts {
        Counts { passed, failed, skipped }
    }

    #[test]
    fn reads_every_result_of_cargo_test() {
        let output = "\
running 4 tests
test a ... ok
test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out; finished in 0.00s
   Doc-tests inkrig_motion
test result: FAILED. 1 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.50s; merged doctests compilation took 0.3s
";
        assert_eq!(Counts::read(output), counts(4, 2, 1));
    }

    #[test]
    fn reads_the_summary_of_nextest() {
        let ok = "     Summary [   0.005s] 12 tests run: 12 passed (1 slow, 1 leaky), 3 skipped";
        assert_eq!(Counts::read(ok), counts(12, 0, 3));
        let bad = "     Summary [   1.2s] 5/7 tests run: 2 passed (1 flaky), 1 failed, 1 timed out, 1 exec failed, 0 skipped";
        assert_eq!(Counts::read(bad), counts(2, 3, 0));
        assert_eq!(Counts::read("Summary [ 0.1s] 1 test run: 1 passed, 0 skipped"), counts(1, 0, 0));
    }

    #[test]
    fn a_failed_test_shown_by_nextest_counts_once() {
        let output = "\
    test result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured; 12 filtered out; finished in 0.00s
     Summary [   1.0s] 13 tests run: 12 passed, 1 failed, 1 skipped
";
        assert_eq!(Counts::read(output), counts(12, 1, 1));
    }

    #[test]
    fn reads_through_colours() {
        let line = "\u{1b}[32;1m     Summary\u{1b}[0m [   0.1s] \u{1b}[1m2\u{1b}[0m tests run: \u{1b}[1m2\u{1b}[0m \u{1b}[32;1mpassed\u{1b}[0m, \u{1b}[1m0\u{1b}[0m \u{1b}[33;1mskipped\u{1b}[0m";
        assert_eq!(Counts::read(line), counts(2, 0, 0));
    }

    #[test]
    fn other_lines_count_nothing() {
        assert_eq!(Counts::read("9 passed, 9 failed\nSummary [\ntest result:\n"), Counts::default());
    }

    #[test]
    fn the_closing_line_is_plain() {
        let mut total = counts(1, 2, 3);
        total += counts(10, 20, 30);
        assert_eq!(total.to_string(), "11 passed, 22 failed, 33 skipped");
    }
}
