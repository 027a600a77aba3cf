//! One module a command: arguments in, files and words out.

mod align;
mod bench;
mod certificate;
pub(crate) mod control;
mod convert;
mod data;
mod demo;
mod demo_board;
mod demo_files;
mod evaluate;
mod generate;
mod inspect;
mod joint_map;
mod keys;
mod model;
mod record;
mod redo;
mod retarget;
mod settings;
mod sketch;
mod storyboard;
mod studio;
mod studio_boards;
mod suggest;
mod train;

use crate::cli::{Cli, Command};
use crate::console::Console;
use crate::error::CliError;
use crate::output::Output;
use crate::provenance::{Arguments, Run, Sink};
use clap::{ArgMatches, CommandFactory};

/// Does what the command line says. `matches` are what `cli` was made of: records of results repeat them.
///
/// # Errors
/// Whatever stands in the way, with the file that it is about.
pub fn run(cli: Cli, matches: &ArgMatches) -> Result<(), CliError> {
    let arguments = &Arguments::of(matches);
    let run = |force| Run { arguments, sink: Sink::Disk(Output { force }) };
    let console = Console::new(cli.json, cli.quiet);
    match cli.command {
        Command::Align(args) => align::run(&args, &run(args.force), &console),
        Command::Bench(args) => bench::run(&args, &console),
        Command::Convert(args) => convert::run(&args, &run(args.force), &console),
        Command::Data(args) => data::run(&args, &console),
        Command::Evaluate(args) => evaluate::run(&args, &console),
        Command::Generate(args) => generate::run(&args, &run(args.force), &console),
        Command::Retarget(args) => retarget::run(&args, &run(args.force), &console),
        Command::Demo(args) => demo::run(&args, &console),
        Command::Redo(args) => redo::run(&args, &console),
        Command::Inspect(args) => inspect::run(&args, &console),
        Command::Model(args) => model::run(&args, &console),
        Command::Storyboard(args) => storyboard::run(&args, &run(args.force), &console),
        Command::Studio(args) => studio::run(&args, &console),
        Command::Suggest(args) => suggest::run(&args, &console),
        Command::Sketch(args) => sketch::run(&args, &console),
        Command::Train(args) => train::run(&args, &console),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "inkrig", &mut script);
            crate::console::print(String::from_utf8_lossy(&script).trim_end())
        }
    }
}
