//! One module a command: arguments in, files and words out.

mod align;
mod at_rate;
mod bench;
mod certificate;
pub(crate) mod control;
mod convert;
mod data;
mod demo;
mod demo_files;
mod inspect;
mod keys;
mod model;
mod record;
mod retarget;
mod settings;
mod suggest;

use crate::cli::{Cli, Command};
use crate::console::Console;
use crate::error::CliError;
use clap::CommandFactory;

/// Does what the command line says.
///
/// # Errors
/// Whatever stands in the way, with the file that it is about.
pub fn run(cli: Cli) -> Result<(), CliError> {
    let console = Console::new(cli.json, cli.quiet);
    match cli.command {
        Command::Align(args) => align::run(&args, &console),
        Command::Bench(args) => bench::run(&args, &console),
        Command::Convert(args) => convert::run(&args, &console),
        Command::Data(args) => data::run(&args, &console),
        Command::Retarget(args) => retarget::run(&args, &console),
        Command::Demo(args) => demo::run(&args, &console),
        Command::Inspect(args) => inspect::run(&args, &console),
        Command::Model(args) => model::run(&args, &console),
        Command::Suggest(args) => suggest::run(&args, &console),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "inkrig", &mut script);
            crate::console::print(String::from_utf8_lossy(&script).trim_end())
        }
    }
}
