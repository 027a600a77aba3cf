//! What was said on the command line, as data that can be said again.

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command, CommandFactory};
use serde_json::{Map, Value};
use std::path::Path;

/// Arguments that take no part in what a motion is: where results go, what else is written, how fast.
const OTHERS: [&str; 14] = [
    "out",
    "force",
    "report",
    "preview",
    "sheet",
    "clips",
    "no-sidecar",
    "licence-note",
    "threads",
    "to",
    "strict",
    "json",
    "quiet",
    "help",
];

/// A command with its options.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arguments {
    pub(crate) command: String,
    /// As `--name` or `--name=value`, those that were given.
    pub(crate) options: Vec<String>,
    /// All of them by name, those that were not given with their defaults.
    pub(crate) values: Map<String, Value>,
    /// One of them is no text, so they cannot be repeated from a record.
    pub(crate) not_text: bool,
}

impl Arguments {
    /// Of a command line that was understood.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let Some((name, matches)) = matches.subcommand() else { return Self::default() };
        let mut all = Self { command: name.to_string(), ..Self::default() };
        for (long, arg) in options(&crate::cli::Cli::command(), name) {
            all.add(&long, &arg, matches);
        }
        all
    }

    /// The same with one option more, where `given` says so: one that was not said on the command line.
    pub(crate) fn with_option(&self, long: &str, path: &Path, given: bool) -> Self {
        let mut all = self.clone();
        if given && !all.options.iter().any(|option| option.starts_with(&format!("--{long}="))) {
            let value = path.to_string_lossy();
            all.not_text |= path.to_str().is_none();
            all.options.push(format!("--{long}={value}"));
            all.values.insert(long.into(), value.into());
        }
        all
    }

    fn add(&mut self, long: &str, arg: &Arg, matches: &ArgMatches) {
        let id = arg.get_id().as_str();
        let given = matches.value_source(id) == Some(ValueSource::CommandLine);
        if is_flag(arg) {
            let set = matches.get_flag(id);
            self.values.insert(long.into(), set.into());
            self.options.extend((set && given).then(|| format!("--{long}")));
            return;
        }
        let mut values = Vec::new();
        for value in matches.get_raw(id).into_iter().flatten() {
            self.not_text |= value.to_str().is_none();
            let value = value.to_string_lossy();
            self.options.extend(given.then(|| format!("--{long}={value}")));
            values.push(Value::from(value));
        }
        let value = match values.len() {
            0 => Value::Null,
            1 => values.remove(0),
            _ => Value::Array(values),
        };
        self.values.insert(long.into(), value);
    }
}

/// Whether an option is one that a record of the command may hold.
pub(crate) fn is_option(command: &str, option: &str) -> bool {
    let Some(option) = option.strip_prefix("--") else { return false };
    let (name, value) = option.split_once('=').map_or((option, None), |(name, value)| (name, Some(value)));
    let known = options(&crate::cli::Cli::command(), command);
    known.iter().any(|(long, arg)| long == name && is_flag(arg) == value.is_none())
}

/// The options of a command that make its motion what it is.
fn options(program: &Command, command: &str) -> Vec<(String, Arg)> {
    let arguments = program.find_subcommand(command).into_iter().flat_map(Command::get_arguments);
    let named = arguments.filter_map(|arg| Some((arg.get_long()?.to_string(), arg.clone())));
    named.filter(|(long, _)| !OTHERS.contains(&long.as_str())).collect()
}

fn is_flag(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::SetTrue)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_said_can_be_said_again() {
        let said = [
            "inkrig",
            "align",
            "a.bvh",
            "--wave=-1*sine(1Hz)",
            "--key",
            "-x",
            "--key",
            "1s=frame:2",
            "-o",
            "b.bvh",
            "--loop",
            "--force",
            "--report",
            "r.json",
            "--threads",
            "2",
        ];
        let matches = crate::cli::Cli::command().try_get_matches_from(said).unwrap();
        let arguments = Arguments::of(&matches);
        assert_eq!(arguments.command, "align");
        let expected = ["--key=-x", "--key=1s=frame:2", "--loop", "--wave=-1*sine(1Hz)"];
        let mut options = arguments.options.clone();
        options.sort();
        assert_eq!(options, expected);
        assert!(options.iter().all(|option| is_option("align", option)));
        assert_eq!(arguments.values["preset"], "follow");
        assert_eq!(arguments.values["mirror"], false);
    }

    #[test]
    fn options_that_write_or_run_anything_else_are_none() {
        let bad = [
            "--force",
            "--out=x",
            "-o",
            "-ox",
            "--report=/etc/x",
            "--",
            "",
            "x.bvh",
            "--help",
            "--no-such=1",
            "--loop=1",
            "--fps",
            "--json",
            "--sheet=s.png",
            "-h",
            "--version",
        ];
        for option in bad {
            assert!(!is_option("align", option), "{option}");
        }
        assert!(!is_option("demo", "--force") && !is_option("completions", "--shell=bash"));
        assert!(is_option("convert", "--loop=24") && is_option("convert", "--fps=24"));
    }
}
