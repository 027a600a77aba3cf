//! The record beside a result: what it was made of, and how, enough to make it again byte for byte.

pub(crate) mod arguments;
pub(crate) mod licence;
mod sidecar;

pub(crate) use arguments::Arguments;
pub(crate) use sidecar::{OutputFile, Sidecar};

use crate::cli::SidecarArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::inputs;
use crate::output::Output;
use crate::printable::{self, json_path};
use inkrig_transport::Isa;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::cell::RefCell;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// How a command is run: what was said to it, and where its results go.
pub(crate) struct Run<'a> {
    pub(crate) arguments: &'a Arguments,
    pub(crate) sink: Sink<'a>,
}

/// Where results go.
#[derive(Clone, Copy)]
pub(crate) enum Sink<'a> {
    /// To files.
    Disk(Output),
    /// Nowhere: they are kept to be compared.
    Memory(&'a RefCell<Vec<(PathBuf, Vec<u8>)>>),
}

/// What is not known from the command line and the files that were read.
pub(crate) struct Facts<'a> {
    /// Files that stand without an option on the command line.
    pub(crate) files: &'a [PathBuf],
    /// Which of several solutions, from 1.
    pub(crate) solution: usize,
    pub(crate) seed: Option<u64>,
    /// How often the solver looked at its problem, where there is one.
    pub(crate) gradients: Option<usize>,
    /// What the engine made of the parameters.
    pub(crate) engine: Option<Value>,
}

impl<'a> Facts<'a> {
    /// Of a command that has no solver.
    pub(crate) fn of_files(files: &'a [PathBuf]) -> Self {
        Self { files, solution: 1, seed: None, gradients: None, engine: None }
    }
}

impl Run<'_> {
    /// Says early whether a motion and its record can be written.
    ///
    /// # Errors
    /// As [`Output::check`].
    pub(crate) fn check_motion(&self, out: &Path, args: &SidecarArgs) -> Result<(), CliError> {
        self.check(out)?;
        match self.sink {
            Sink::Disk(output) if !args.no_sidecar => {
                let place = Sidecar::place(out);
                Ok(Output { force: output.force || Sidecar::is_one(&place) }.check(&place)?)
            }
            _ => Ok(()),
        }
    }

    /// Says early whether a file can be written.
    ///
    /// # Errors
    /// As [`Output::check`].
    pub(crate) fn check(&self, path: &Path) -> Result<(), CliError> {
        match self.sink {
            Sink::Disk(output) => Ok(output.check(path)?),
            Sink::Memory(_) => Ok(()),
        }
    }

    /// Writes a file.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub(crate) fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), CliError> {
        match self.sink {
            Sink::Disk(output) => Ok(output.write(path, bytes)?),
            Sink::Memory(kept) => {
                kept.borrow_mut().push((path.to_path_buf(), bytes.to_vec()));
                Ok(())
            }
        }
    }

    /// Writes a motion and, where that is wanted, its record.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub(crate) fn write_motion(
        &self,
        out: &Path,
        bytes: &[u8],
        args: &SidecarArgs,
        facts: &Facts<'_>,
    ) -> Result<(), CliError> {
        self.write(out, bytes)?;
        let Sink::Disk(output) = self.sink else { return Ok(()) };
        if args.no_sidecar {
            return Ok(());
        }
        let sidecar = self.sidecar(out, bytes, args, facts);
        sidecar.write(&Sidecar::place(out), output.force)
    }

    /// Tells people of the record.
    ///
    /// # Errors
    /// When standard output cannot be written.
    pub(crate) fn say(&self, out: &Path, args: &SidecarArgs, console: &Console) -> Result<(), CliError> {
        if args.no_sidecar || matches!(self.sink, Sink::Memory(_)) {
            return Ok(());
        }
        let place = Sidecar::place(out);
        console.say(format!("wrote {}: how it was made (inkrig redo)", printable::path(&place)))
    }

    fn sidecar(&self, out: &Path, bytes: &[u8], args: &SidecarArgs, facts: &Facts<'_>) -> Sidecar {
        let mut inputs = inputs::read();
        for input in &mut inputs {
            licence::add_beside(input);
            if input.licences.is_empty() {
                input.licences.extend(args.licence_note.as_deref().map(licence::given));
            }
        }
        let mut parameters = json!({ "said": self.arguments.values });
        if let (Some(engine), Value::Object(parameters)) = (&facts.engine, &mut parameters) {
            parameters.insert("engine".into(), engine.clone());
        }
        Sidecar {
            inkrig_sidecar: Sidecar::VERSION,
            program: PROGRAM.into(),
            build: build(),
            system: system(),
            instruction_set: Isa::current().name().into(),
            threads: "any number gives the same bytes".into(),
            command: self.arguments.command.clone(),
            options: self.arguments.options.clone(),
            files: facts.files.iter().map(|path| json_path(path)).collect(),
            can_be_redone: !self.arguments.not_text && facts.files.iter().all(|path| path.to_str().is_some()),
            solution: facts.solution,
            output: OutputFile { path: json_path(out), bytes: bytes.len() as u64, sha256: sha256(bytes) },
            licences: licence::union(&inputs),
            inputs,
            seed: facts.seed,
            evaluations: facts.gradients.map(|gradients| json!({ "gradients": gradients })),
            parameters,
        }
    }
}

/// The program and its version.
pub(crate) const PROGRAM: &str = concat!("inkrig ", env!("CARGO_PKG_VERSION"));

/// System and processor family.
pub(crate) fn system() -> String {
    format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)
}

/// What tells this build from any other: the hash of the program's own file. Empty where it cannot be read.
pub(crate) fn build() -> String {
    static BUILD: OnceLock<String> = OnceLock::new();
    BUILD.get_or_init(|| own_hash().unwrap_or_default()).clone()
}

fn own_hash() -> Option<String> {
    let mut file = std::fs::File::open(std::env::current_exe().ok()?).ok()?;
    Some(sha256_of(&mut file).ok()?.1)
}

/// Length and hash of what is too large to be held.
pub(crate) fn sha256_of(file: &mut impl Read) -> std::io::Result<(u64, String)> {
    let (mut hash, mut bytes) = (Sha256::new(), 0);
    let mut piece = vec![0; 1 << 20];
    loop {
        let count = file.read(&mut piece)?;
        let Some(read) = piece.get(..count).filter(|read| !read.is_empty()) else { break };
        hash.update(read);
        bytes += count as u64;
    }
    Ok((bytes, hex(&hash.finalize())))
}

/// The hash of some bytes, 64 digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
