//! `inkrig redo`: a result made again from the record beside it, and compared.

use super::{align, convert, generate, retarget, storyboard};
use crate::cli::{Cli, Command, RedoArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::inputs::{self, InputFile};
use crate::output::Output;
use crate::printable::{self, json_path};
use crate::provenance::{self, Arguments, Run, Sidecar, Sink, sha256, sha256_of};
use crate::shipped::Shipped;
use crate::{load, names};
use clap::{CommandFactory, FromArgMatches};
use inkrig_transport::Isa;
use serde::Serialize;
use std::cell::RefCell;
use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &RedoArgs, console: &Console) -> Result<(), CliError> {
    let sidecar = Sidecar::read(&args.sidecar)?;
    let redo = Redo { args, sidecar: &sidecar, out: out(args, &sidecar)? };
    redo.say_plan(console)?;
    if args.list {
        return console.result(&redo.outcome("listed"));
    }
    let output = Output { force: args.force };
    if !args.check {
        let inputs = sidecar.inputs.iter().map(|input| Path::new(&input.path));
        names::all_differ(inputs.chain([args.sidecar.as_path(), redo.out.as_path()]))?;
        output.check(&redo.out)?;
    }
    redo.check_program()?;
    redo.check_inputs()?;
    let bytes = redo.make(console)?;
    let same = sha256(&bytes) == sidecar.output.sha256;
    if !same && !args.anyway {
        let help = if redo.is_same_program() {
            "this is a mistake in inkrig: please report it, with both files"
        } else {
            "the build or the processor is another; --anyway writes it all the same"
        };
        return Err(redo.refused("the result is not the same, byte for byte".into(), help));
    }
    if !args.check {
        output.write(&redo.out, &bytes)?;
        redo.write_sidecar(&bytes, same)?;
    }
    let same_words = if same { "the same, byte for byte" } else { "not the same" };
    let verb = if args.check { "made" } else { "wrote" };
    console.say(format!("{verb} {}: {same_words}", printable::path(&redo.out)))?;
    console.result(&redo.outcome(if same { "same" } else { "different" }))
}

struct Redo<'a> {
    args: &'a RedoArgs,
    sidecar: &'a Sidecar,
    out: PathBuf,
}

/// What is told to programs; the names are stable.
#[derive(Serialize)]
struct Outcome<'a> {
    outcome: &'static str,
    command: &'a str,
    options: &'a [String],
    inputs: Vec<&'a str>,
    output: String,
    sha256: &'a str,
    licences: &'a [String],
}

/// The file to write: never where a record says, only beside it or where the user says.
fn out(args: &RedoArgs, sidecar: &Sidecar) -> Result<PathBuf, CliError> {
    let out = match &args.out {
        Some(out) => Some(out.clone()),
        None => Sidecar::result_of(&args.sidecar),
    };
    let refused = |what: String, help| CliError::Redo { path: args.sidecar.clone(), what, help };
    let out = out.ok_or_else(|| {
        refused("its name does not say what it belongs to".into(), "name the file to write with -o")
    })?;
    let kind = |path: &Path| load::extension(path).unwrap_or_default();
    if kind(&out) == kind(Path::new(&sidecar.output.path)) {
        return Ok(out);
    }
    let what = format!("the result was a .{}", kind(Path::new(&sidecar.output.path)));
    Err(refused(what, "give -o a name with the same ending"))
}

impl Redo<'_> {
    fn refused(&self, what: String, help: &'static str) -> CliError {
        CliError::Redo { path: self.args.sidecar.clone(), what, help }
    }

    fn say_plan(&self, console: &Console) -> Result<(), CliError> {
        let sidecar = self.sidecar;
        let words: Vec<&str> = [sidecar.command.as_str()]
            .into_iter()
            .chain(sidecar.files.iter().chain(&sidecar.options).map(String::as_str))
            .collect();
        console.say(format!("inkrig {}", printable::text(words.join(" "))))?;
        for input in &sidecar.inputs {
            console.say(format!("reads  {} ({} bytes)", printable::text(&input.path), input.bytes))?;
        }
        let place = printable::path(&self.out);
        console.say(if self.args.check { "writes nothing".to_string() } else { format!("writes {place}") })
    }

    fn is_same_program(&self) -> bool {
        let sidecar = self.sidecar;
        !sidecar.build.is_empty()
            && sidecar.build == provenance::build()
            && sidecar.system == provenance::system()
            && sidecar.instruction_set == Isa::current().name()
    }

    /// Another program gives other bytes, perhaps.
    fn check_program(&self) -> Result<(), CliError> {
        let sidecar = self.sidecar;
        if !sidecar.can_be_redone {
            let help = "rename the inputs to names of letters";
            return Err(self.refused("a name in it was no text, so it cannot be made again".into(), help));
        }
        if self.is_same_program() || self.args.anyway {
            return Ok(());
        }
        let level = Isa::current().name();
        if sidecar.instruction_set != level {
            let what = format!(
                "it was made at the instruction level {}, and this is {level}",
                sidecar.instruction_set
            );
            return Err(self.refused(
                what,
                "INKRIG_ISA sets a level that the processor has; --anyway tries it as it is",
            ));
        }
        let what =
            format!("it was made by another build of inkrig ({}, {})", sidecar.program, sidecar.system);
        Err(self.refused(what, "take the build that made it; --anyway tries it with this one"))
    }

    /// Says of every input whether it is what it was, before any work.
    fn check_inputs(&self) -> Result<(), CliError> {
        let help = "paths are those of the first run: go to the folder it was started in, or get the file back; --anyway \
                    goes on with what is there";
        for input in &self.sidecar.inputs {
            let path = Path::new(&input.path);
            let wrong = |what: String| CliError::Redo { path: path.to_path_buf(), what, help };
            if let Some(own) = Shipped::named(path) {
                if !self.args.anyway && sha256(own.bytes) != input.sha256 {
                    return Err(wrong("the weights inside this program are not those".into()));
                }
                continue;
            }
            let there =
                path.metadata().map_err(|cause| wrong(format!("this input is not there ({cause})")))?;
            if self.args.anyway {
                continue;
            }
            if !there.is_file() {
                return Err(wrong("this input is no ordinary file".into()));
            }
            if there.len() != input.bytes {
                return Err(wrong(format!(
                    "this input has changed: {} bytes, {} then",
                    there.len(),
                    input.bytes
                )));
            }
            let file = File::open(path).and_then(|mut file| sha256_of(&mut file));
            if file.map_err(|cause| CliError::Read { path: path.into(), cause })?.1 != input.sha256 {
                return Err(wrong("this input has changed, though it is as long as it was".into()));
            }
        }
        Ok(())
    }

    /// Runs the command; its result is kept in memory.
    fn make(&self, console: &Console) -> Result<Vec<u8>, CliError> {
        let sidecar = self.sidecar;
        let mut words: Vec<OsString> = vec!["inkrig".into(), sidecar.command.clone().into()];
        words.extend(sidecar.options.iter().map(OsString::from));
        let threads = self.args.threads.filter(|_| sidecar.command == "align");
        words.extend(threads.map(|threads| OsString::from(format!("--threads={threads}"))));
        if sidecar.command == "convert" {
            words.push("--".into());
            words.extend(sidecar.files.iter().map(OsString::from));
            words.push(self.out.clone().into());
        } else {
            let mut out = OsString::from("--out=");
            out.push(&self.out);
            words.extend([out, "--".into()]);
            words.extend(sidecar.files.iter().map(OsString::from));
        }
        let not_understood = |error: clap::Error| {
            let what = error.render().to_string();
            self.refused(
                what.lines().next().unwrap_or_default().to_string(),
                "the record was changed by hand, or is of another version",
            )
        };
        let matches = Cli::command().try_get_matches_from(words).map_err(not_understood)?;
        let cli = Cli::from_arg_matches(&matches).map_err(not_understood)?;
        let only: Option<Vec<InputFile>> = (!self.args.anyway).then(|| sidecar.inputs.clone());
        inputs::begin(only);
        let made = RefCell::new(Vec::new());
        let arguments = Arguments::of(&matches);
        let run = Run { arguments: &arguments, sink: Sink::Memory(&made) };
        let quiet = console.quietly();
        match cli.command {
            Command::Align(args) => align::run(&args, &run, &quiet)?,
            Command::Convert(args) => convert::run(&args, &run, &quiet)?,
            Command::Generate(args) => generate::run(&args, &run, &quiet)?,
            Command::Retarget(args) => retarget::run(&args, &run, &quiet)?,
            Command::Storyboard(args) => storyboard::run(&args, &run, &quiet)?,
            _ => {}
        }
        let motion = made.into_inner().into_iter().nth(sidecar.solution - 1);
        motion.map(|(_, bytes)| bytes).ok_or_else(|| {
            let what = format!("solution {} was not found again", sidecar.solution);
            self.refused(what, "the record was changed by hand")
        })
    }

    /// The same record beside a file of another name.
    fn write_sidecar(&self, bytes: &[u8], same: bool) -> Result<(), CliError> {
        let place = Sidecar::place(&self.out);
        if !same || names::all_differ([place.as_path(), self.args.sidecar.as_path()]).is_err() {
            return Ok(());
        }
        let mut sidecar = self.sidecar.clone();
        sidecar.output.path = json_path(&self.out);
        sidecar.output.bytes = bytes.len() as u64;
        sidecar.write(&place, self.args.force)
    }

    fn outcome(&self, outcome: &'static str) -> Outcome<'_> {
        Outcome {
            outcome,
            command: &self.sidecar.command,
            options: &self.sidecar.options,
            inputs: self.sidecar.inputs.iter().map(|input| input.path.as_str()).collect(),
            output: json_path(&self.out),
            sha256: &self.sidecar.output.sha256,
            licences: &self.sidecar.licences,
        }
    }
}
