//! Named steps that run one after the other, each timed, with one verdict and one line of counts at the end.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::counts::Counts;

/// How a step ended without an error.
pub(crate) enum Verdict {
    /// The check holds.
    Passed,
    /// Tests ran; the step holds if none failed.
    Tested(Counts),
    /// The check could not be made here; the text says which package or folder is missing.
    Skipped(String),
}

/// Runs steps and remembers how they ended.
pub(crate) struct Steps {
    ci: bool,
    keep_going: bool,
    stopped: bool,
    total: Counts,
    lines: Vec<String>,
}

impl Steps {
    /// `ci` makes a skip a failure; `keep_going` runs the steps after a failed one too.
    pub(crate) fn new(ci: bool, keep_going: bool) -> Self {
        Self { ci, keep_going, stopped: false, total: Counts::default(), lines: Vec::new() }
    }

    /// Runs one step, unless an earlier one failed.
    pub(crate) fn run(&mut self, name: &str, step: impl FnOnce() -> Result<Verdict>) -> &mut Self {
        if self.stopped {
            self.lines.push(format!("  not run  {name}"));
            return self;
        }
        println!("\n== {name}");
        let start = Instant::now();
        let result = step();
        self.record(name, result, start.elapsed());
        self
    }

    /// Prints the list of steps and, as the last line, the counts.
    pub(crate) fn finish(&self) -> ExitCode {
        println!();
        for line in &self.lines {
            println!("{line}");
        }
        println!("\n{}", self.total);
        if self.total.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }

    fn record(&mut self, name: &str, result: Result<Verdict>, time: Duration) {
        let (word, counts, note) = self.judge(result);
        let note = if note.is_empty() { note } else { format!(": {note}") };
        if word != "ok" {
            println!("{word}: {name}{note}");
        }
        self.lines.push(format!("{word:>9}  {name} ({:.1} s){note}", time.as_secs_f64()));
        self.total += counts;
        self.stopped |= counts.failed > 0 && !self.keep_going;
    }

    /// A check counts as one test; a test run counts as its tests.
    fn judge(&self, result: Result<Verdict>) -> (&'static str, Counts, String) {
        let one = Counts::default();
        match result {
            Ok(Verdict::Passed) => ("ok", Counts { passed: 1, ..one }, String::new()),
            Ok(Verdict::Tested(counts)) if counts.failed > 0 => ("failed", counts, counts.to_string()),
            Ok(Verdict::Tested(counts)) if counts.skipped > 0 && self.ci => {
                let failed = Counts { failed: counts.skipped, skipped: 0, ..counts };
                ("failed", failed, format!("{counts}, and CI skips nothing"))
            }
            Ok(Verdict::Tested(counts)) => ("ok", counts, counts.to_string()),
            Ok(Verdict::Skipped(why)) if self.ci => ("failed", Counts { failed: 1, ..one }, why),
            Ok(Verdict::Skipped(why)) => ("skipped", Counts { skipped: 1, ..one }, why),
            Err(error) => ("failed", Counts { failed: 1, ..one }, format!("{error:#}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tested(passed: u64, failed: u64, skipped: u64) -> Result<Verdict> {
        Ok(Verdict::Tested(Counts { passed, failed, skipped }))
    }

    #[test]
    fn a_failure_stops_the_steps_after_it() {
        let mut steps = Steps::new(false, false);
        let mut ran = false;
        steps.run("a", || Ok(Verdict::Passed)).run("b", || anyhow::bail!("no")).run("c", || {
            ran = true;
            Ok(Verdict::Passed)
        });
        assert!(!ran);
        assert_eq!(steps.total.to_string(), "1 passed, 1 failed, 0 skipped");
        assert_eq!(steps.finish(), ExitCode::FAILURE);
    }

    #[test]
    fn keep_going_runs_them_all() {
        let mut steps = Steps::new(false, true);
        steps.run("a", || tested(3, 1, 0)).run("b", || Ok(Verdict::Passed));
        assert_eq!(steps.total.to_string(), "4 passed, 1 failed, 0 skipped");
    }

    #[test]
    fn a_skip_is_a_failure_only_on_the_build_server() {
        for (ci, expected) in
            [(false, "5 passed, 0 failed, 2 skipped"), (true, "5 passed, 2 failed, 0 skipped")]
        {
            let mut steps = Steps::new(ci, true);
            steps.run("a", || tested(5, 0, 1)).run("b", || Ok(Verdict::Skipped("nodejs".into())));
            assert_eq!(steps.total.to_string(), expected);
            assert_eq!(steps.finish() == ExitCode::SUCCESS, !ci);
        }
    }
}
