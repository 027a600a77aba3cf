//! What is said while working: progress, results, and the way to stop.

use indicatif::{ProgressBar, ProgressStyle};
use inkrig_align::Progress;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// How the program talks.
#[derive(Debug, Clone)]
pub struct Console {
    /// One JSON object on standard output instead of text.
    pub json: bool,
    /// Nothing but errors.
    pub quiet: bool,
    stopped: Arc<AtomicBool>,
}

impl Console {
    /// A console that listens for Ctrl-C: the first asks the work to stop, a second ends the process.
    pub fn new(json: bool, quiet: bool) -> Self {
        let stopped = Arc::new(AtomicBool::new(false));
        let flag = stopped.clone();
        // Without a handler Ctrl-C still ends the process; files are written whole or not at all either way.
        let installed = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        });
        if let Err(error) = installed {
            tracing::debug!(%error, "Ctrl-C ends the process at once");
        }
        Self { json, quiet, stopped }
    }

    /// Prints a line for people on standard output, unless JSON was asked for.
    pub fn say(&self, line: impl AsRef<str>) {
        if !self.json && !self.quiet {
            print(line.as_ref());
        }
    }

    /// Prints the result for programs on standard output, if that was asked for.
    ///
    /// # Errors
    /// When the value cannot be turned into JSON.
    pub fn result(&self, value: &impl serde::Serialize) -> Result<(), serde_json::Error> {
        if self.json {
            print(&serde_json::to_string_pretty(value)?);
        }
        Ok(())
    }

    /// A progress bar on standard error; none when quiet, for JSON, or where no terminal is.
    pub fn bar(&self, what: &'static str) -> Bar {
        let bar = if self.quiet || self.json { ProgressBar::hidden() } else { ProgressBar::new(1) };
        if let Ok(style) = ProgressStyle::with_template("{msg} {bar:32} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        bar.set_message(what);
        Bar { bar, stopped: self.stopped.clone() }
    }
}

/// Progress of one piece of work.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    stopped: Arc<AtomicBool>,
}

impl Bar {
    /// Shows how far the work is, and says whether it shall go on.
    pub fn update(&self, progress: Progress) -> ControlFlow<()> {
        self.bar.set_length(progress.total as u64);
        self.bar.set_position(progress.done as u64);
        if self.stopped.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Standard output may be a pipe that was closed (`inkrig ... | head`): that is no error of ours.
pub(crate) fn print(line: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{line}");
}
