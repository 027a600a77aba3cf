//! `inkrig bench`: quality and time of align, beside simpler methods.

use crate::bench::{Case, Failure, Machine, Table, folder_cases, own_cases, rows};
use crate::cli::{BenchAlignArgs, BenchArgs, BenchCommand};
use crate::console::Console;
use crate::error::CliError;
use crate::output::Output;
use crate::printable;
use inkrig_align::{AlignError, Options};

pub(super) fn run(args: &BenchArgs, console: &Console) -> Result<(), CliError> {
    match &args.what {
        BenchCommand::Align(args) => align(args, console),
    }
}

fn align(args: &BenchAlignArgs, console: &Console) -> Result<(), CliError> {
    let output = Output { force: args.force };
    if let Some(path) = &args.markdown {
        output.check(path)?;
    }
    let (cases, mut failures) = cases(args, console)?;
    let threads = cases.first().map_or(1, |case| case.options.threads);
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
    let table = Table { machine: Machine::this(threads), repeats: args.repeat, rows: all, failures };
    let text = table.markdown();
    match &args.markdown {
        Some(path) => {
            output.write(path, text.as_bytes())?;
            console.say(format!("wrote {}", printable::path(path)))?;
        }
        None => console.say(text.trim_end())?,
    }
    console.result(&table)
}

/// The cases that were asked for, and what of the folder cannot be one.
fn cases(args: &BenchAlignArgs, console: &Console) -> Result<(Vec<Case>, Vec<Failure>), CliError> {
    let mut cases = own_cases()?;
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
