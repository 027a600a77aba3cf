//! Running other programs: shown, captured, or both at once.

use std::io::{self, BufRead, BufReader, IsTerminal, Read, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;

use anyhow::{Context, Result, bail};

/// Runs a command with its output shown.
///
/// # Errors
/// When it cannot start or does not succeed.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    announce(command);
    let status =
        command.stdin(Stdio::null()).status().with_context(|| format!("cannot start {}", name(command)))?;
    check(command, status)
}

/// Runs a command and returns what it wrote to its standard output.
///
/// # Errors
/// When it cannot start, does not succeed, or writes text that is not UTF-8.
pub(crate) fn output(command: &mut Command) -> Result<String> {
    command.stdin(Stdio::null()).stderr(Stdio::inherit());
    let output = command.output().with_context(|| format!("cannot start {}", name(command)))?;
    check(command, output.status)?;
    String::from_utf8(output.stdout)
        .with_context(|| format!("{} wrote text that is not UTF-8", name(command)))
}

/// Runs a command with its output shown, and returns that output and how the command ended.
///
/// # Errors
/// When it cannot start or be read from.
pub(crate) fn tee(command: &mut Command) -> Result<(ExitStatus, String)> {
    announce(command);
    if io::stderr().is_terminal() {
        // Programs drop their colours when written to a pipe; ours ends on a terminal.
        command.env("CARGO_TERM_COLOR", "always");
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().with_context(|| format!("cannot start {}", name(command)))?;
    let errors = child.stderr.take().map(|pipe| thread::spawn(move || copy(pipe, &mut io::stderr())));
    let mut text = match child.stdout.take() {
        Some(pipe) => copy(pipe, &mut io::stdout())?,
        None => String::new(),
    };
    if let Some(errors) = errors {
        let Ok(errors) = errors.join() else { bail!("lost the output of {}", name(command)) };
        text.push_str(&errors?);
    }
    Ok((child.wait()?, text))
}

fn copy(pipe: impl Read, to: &mut impl Write) -> io::Result<String> {
    let mut reader = BufReader::new(pipe);
    let mut text = String::new();
    let mut line = Vec::new();
    while reader.read_until(b'\n', &mut line)? > 0 {
        to.write_all(&line)?;
        to.flush()?;
        text.push_str(&String::from_utf8_lossy(&line));
        line.clear();
    }
    Ok(text)
}

fn announce(command: &Command) {
    let arguments: Vec<_> = command.get_args().map(|argument| argument.to_string_lossy()).collect();
    println!("$ {} {}", name(command), arguments.join(" "));
}

fn check(command: &Command, status: ExitStatus) -> Result<()> {
    if !status.success() {
        bail!("{} failed ({status})", name(command));
    }
    Ok(())
}

fn name(command: &Command) -> String {
    let program = std::path::Path::new(command.get_program());
    program.file_stem().unwrap_or(command.get_program()).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copy_passes_on_and_keeps_every_line() {
        let mut shown = Vec::new();
        let text = copy("one\ntwo".as_bytes(), &mut shown).unwrap();
        assert_eq!((text.as_str(), shown.as_slice()), ("one\ntwo", "one\ntwo".as_bytes()));
    }

    #[test]
    fn a_missing_program_is_named() {
        let error = run(&mut Command::new("no-such-program-here")).unwrap_err();
        assert!(error.to_string().contains("no-such-program-here"), "{error}");
    }
}
