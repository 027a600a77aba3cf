//! `inkrig bench`: quality and time of align, beside simpler methods and at other parameters.

use crate::bench::sweep::is_cancelled;
use crate::bench::{
    Case, Failure, Machine, Sweep, Swept, Table, folder_cases, own_cases, page, rows, sweep, sweep_markdown,
};
use crate::cli::{BenchAlignArgs, BenchArgs, BenchCommand};
use crate::console::Console;
use crate::error::CliError;
use crate::output::{Output, OutputError};
use crate::printable;
use inkrig_align::{AlignError, Options};
use std::path::{Path, PathBuf};

/// The cases of a sweep where none are named: one of every kind of control that differs.
const SWEPT: [&str; 4] =
    ["circles to person", "chirp to quadruped", "labels to person", "quadruped to person"];

pub(super) fn run(args: &BenchArgs, console: &Console) -> Result<(), CliError> {
    match &args.what {
        BenchCommand::Align(args) if args.sweep.is_empty() => align(args, console),
        BenchCommand::Align(args) => swept(args, console),
    }
}

fn align(args: &BenchAlignArgs, console: &Console) -> Result<(), CliError> {
    let places = places(args, &["table.md", "table.json"])?;
    let (cases, mut failures) = cases(args, console, |_| true)?;
    let mut all = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let bar = console.bar(format!("{} of {}: {}", number + 1, cases.len(), printable::text(&case.name)));
        let done = rows(case, args.repeat, &mut |progress| bar.update(progress), |row| all.push(row));
        bar.finish()?;
        match done {
            Ok(()) => {}
            Err(AlignError::Cancelled) => return Err(AlignError::Cancelled.into()),
            Err(error) => failures.push(Failure { case: case.name.clone(), reason: error.to_string() }),
        }
    }
    let table = Table { machine: Machine::this(threads(&cases)), repeats: args.repeat, rows: all, failures };
    let text = table.markdown();
    if places.is_empty() {
        console.say(text.trim_end())?;
    }
    for path in &places {
        let is_json = path.extension().is_some_and(|ending| ending == "json");
        let bytes = if is_json { serde_json::to_vec_pretty(&table)? } else { text.clone().into_bytes() };
        write(args, path, &bytes, console)?;
    }
    console.result(&table)
}

fn swept(args: &BenchAlignArgs, console: &Console) -> Result<(), CliError> {
    let pictures: Vec<String> =
        args.sweep.iter().map(|parameter| format!("sweep-{}.png", parameter.name())).collect();
    let mut names = vec!["sweep.html", "sweep.json", "sweep.md"];
    names.extend(pictures.iter().map(String::as_str));
    let places = places(args, &names)?;
    let (cases, failures) = cases(args, console, |name| !args.cases.is_empty() || SWEPT.contains(&name))?;
    for Failure { reason, .. } in failures {
        console.warn(printable::text(reason));
    }
    let mut parameters = Vec::new();
    for &parameter in &args.sweep {
        let mut done = Vec::new();
        for case in &cases {
            let bar = console.bar(format!("{}: {}", parameter.name(), printable::text(&case.name)));
            match sweep(case, parameter, &mut |progress| bar.update(progress)) {
                Ok(case) => done.push(case),
                Err(error) if is_cancelled(&error) => return Err(error),
                Err(error) => console.warn(format!("{}: {error}", printable::text(&case.name))),
            }
            bar.finish()?;
        }
        parameters.push(Swept { parameter, cases: done });
    }
    let sweep = Sweep { machine: Machine::this(threads(&cases)), parameters };
    let mut files = vec![
        page(&sweep)?.into_bytes(),
        serde_json::to_vec_pretty(&sweep)?,
        sweep_markdown(&sweep).into_bytes(),
    ];
    for swept in &sweep.parameters {
        files.push(swept.png()?);
    }
    if args.markdown.is_some() {
        files.push(sweep_markdown(&sweep).into_bytes());
    }
    for (path, bytes) in places.iter().zip(&files) {
        write(args, path, bytes, console)?;
    }
    console.result(&sweep)
}

/// The files to write: those in the folder of `--out`, then that of `--markdown`. Says before any work whether they can be
/// written.
fn places(args: &BenchAlignArgs, names: &[&str]) -> Result<Vec<PathBuf>, CliError> {
    let mut places = Vec::new();
    if let Some(folder) = &args.out {
        std::fs::create_dir_all(folder).map_err(|cause| OutputError::Io { path: folder.clone(), cause })?;
        places.extend(names.iter().map(|name| folder.join(name)));
    }
    places.extend(args.markdown.clone());
    for path in &places {
        Output { force: args.force }.check(path)?;
    }
    Ok(places)
}

fn write(args: &BenchAlignArgs, path: &Path, bytes: &[u8], console: &Console) -> Result<(), CliError> {
    Output { force: args.force }.write(path, bytes)?;
    console.say(format!("wrote {}", printable::path(path)))
}

fn threads(cases: &[Case]) -> usize {
    cases.first().map_or(1, |case| case.options.threads)
}

/// The cases that were asked for, ours only where `own` says so, and what of the folder cannot be one.
fn cases(
    args: &BenchAlignArgs,
    console: &Console,
    own: impl Fn(&str) -> bool,
) -> Result<(Vec<Case>, Vec<Failure>), CliError> {
    let mut cases = own_cases()?;
    cases.retain(|case| own(&case.name));
    let mut failures = Vec::new();
    if let Some(folder) = &args.folder {
        let _stage = console.stage(format!("reading {}", printable::path(folder)));
        let (more, refused) = folder_cases(folder, &args.import)?;
        cases.extend(more);
        let case = printable::path(folder);
        failures
            .extend(refused.iter().map(|error| Failure { case: case.clone(), reason: error.to_string() }));
    }
    let asked = |case: &Case| args.cases.is_empty() || args.cases.iter().any(|word| case.name.contains(word));
    let names: Vec<String> = cases.iter().map(|case| case.name.clone()).collect();
    cases.retain(asked);
    if cases.is_empty() {
        return Err(CliError::NoCase { asked: args.cases.join(", "), known: names.join(", ") });
    }
    for case in &mut cases {
        case.options.seed = args.seed;
        case.options.threads = args.threads.unwrap_or(Options::default().threads);
    }
    Ok((cases, failures))
}
