//! What is said while working: progress, results, and the way to stop.

use crate::error::CliError;
use crate::temporary;
use indicatif::{ProgressBar, ProgressStyle};
use inkrig_align::{AlignError, Progress};
use std::io::{ErrorKind, Write};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};
use std::time::Duration;

/// The exit code of a process that Ctrl-C ended, as shells expect it.
const INTERRUPTED: i32 = 130;

/// How the program talks.
#[derive(Debug, Clone)]
pub struct Console {
    /// One JSON object on standard output instead of text.
    pub json: bool,
    /// Nothing but errors.
    pub quiet: bool,
    interrupt: Arc<Interrupt>,
}

/// What is known of Ctrl-C.
#[derive(Debug, Default)]
struct Interrupt {
    /// It was pressed.
    pressed: AtomicBool,
    /// How many pieces of work look at it often. Where none does, the handler ends the process itself.
    listeners: AtomicUsize,
    /// Ctrl-C is the usual end of what goes on.
    endless: AtomicBool,
}

impl Console {
    /// A console that listens for Ctrl-C: it asks work that listens to stop; anything else, and a second press, ends
    /// the process at once. Results are written whole or not at all, and temporary files are removed, either way.
    pub fn new(json: bool, quiet: bool) -> Self {
        let interrupt = Arc::new(Interrupt::default());
        let shared = interrupt.clone();
        let installed = ctrlc::set_handler(move || {
            let again = shared.pressed.swap(true, SeqCst);
            if again || shared.listeners.load(SeqCst) == 0 {
                if !shared.endless.load(SeqCst) {
                    // As work that listens says it.
                    let said = miette::Report::new(CliError::from(AlignError::Cancelled));
                    let _ = writeln!(std::io::stderr(), "{said:?}");
                }
                temporary::exit(INTERRUPTED);
            }
        });
        if let Err(error) = installed {
            tracing::debug!(%error, "Ctrl-C ends the process at once");
        }
        Self { json, quiet, interrupt }
    }

    /// From here on the program goes on until Ctrl-C ends it: that cancels nothing, and is not said.
    pub fn goes_on_until_stopped(&self) {
        self.interrupt.endless.store(true, SeqCst);
    }

    /// The same, but for saying nothing.
    pub fn quietly(&self) -> Self {
        Self { json: false, quiet: true, interrupt: self.interrupt.clone() }
    }

    /// Prints a line for people on standard output, unless JSON was asked for.
    ///
    /// # Errors
    /// When it cannot be written. A pipe that was closed is none.
    pub fn say(&self, line: impl AsRef<str>) -> Result<(), CliError> {
        if self.json || self.quiet { Ok(()) } else { print(line.as_ref()) }
    }

    /// Prints a warning on standard error. With JSON warnings stand in the record, and quiet means none.
    pub fn warn(&self, line: impl AsRef<str>) {
        if !self.json && !self.quiet {
            // There is no better place to complain about standard error.
            let _ = writeln!(std::io::stderr(), "{}", line.as_ref());
        }
    }

    /// Prints the result for programs on standard output, if that was asked for.
    ///
    /// # Errors
    /// When the value cannot be turned into JSON, or not be written.
    pub fn result(&self, value: &impl serde::Serialize) -> Result<(), CliError> {
        if self.json { print(&serde_json::to_string_pretty(value)?) } else { Ok(()) }
    }

    /// Shows on standard error, until it is dropped, what is being done; nothing when quiet, for JSON, or where no
    /// terminal is. Ctrl-C ends such work at once.
    pub fn stage(&self, what: impl Into<String>) -> Stage {
        let bar = if self.quiet || self.json { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
            bar.set_style(style);
        }
        bar.set_message(what.into());
        bar.enable_steady_tick(Duration::from_millis(120));
        Stage { bar }
    }

    /// A progress bar in place of a [`Stage`], for work that tells how far it is and can be asked to stop.
    pub fn bar(&self, what: impl Into<String>) -> Bar {
        let bar = if self.quiet || self.json { ProgressBar::hidden() } else { ProgressBar::new(1) };
        if let Ok(style) = ProgressStyle::with_template("{msg} {bar:32} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        bar.set_message(what.into());
        self.interrupt.listeners.fetch_add(1, SeqCst);
        Bar { bar, silent: self.quiet || self.json, interrupt: self.interrupt.clone() }
    }
}

/// Work that is shown as going on.
#[derive(Debug)]
pub struct Stage {
    bar: ProgressBar,
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Progress of one piece of work.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    silent: bool,
    interrupt: Arc<Interrupt>,
}

impl Bar {
    /// Shows how far the work is, and says whether it shall go on.
    pub fn update(&self, progress: Progress) -> ControlFlow<()> {
        self.at(progress.done, progress.total)
    }

    /// The same for work that is counted in another way.
    pub fn at(&self, done: usize, total: usize) -> ControlFlow<()> {
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
        if self.interrupt.pressed.load(SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Says a line on standard error above the bar, also where no terminal shows one.
    pub fn note(&self, line: &str) {
        if !self.silent {
            self.bar.suspend(|| {
                let _ = writeln!(std::io::stderr(), "{line}");
            });
        }
    }

    /// Ends the bar.
    ///
    /// # Errors
    /// [`AlignError::Cancelled`] when Ctrl-C was pressed after the last update.
    pub fn finish(self) -> Result<(), AlignError> {
        let interrupt = self.interrupt.clone();
        // From here on the handler ends the process itself; a press before that is seen below.
        drop(self);
        if interrupt.pressed.load(SeqCst) { Err(AlignError::Cancelled) } else { Ok(()) }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.interrupt.listeners.fetch_sub(1, SeqCst);
        self.bar.finish_and_clear();
    }
}

/// Prints a line on standard output. It may be a pipe that was closed (`inkrig ... | head`): that is no error of ours;
/// a full disk is.
pub(crate) fn print(line: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Print { cause: error }),
        _ => Ok(()),
    }
}
