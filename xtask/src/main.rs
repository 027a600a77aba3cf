//! The developer's commands, run as `cargo xtask <command>`.
//!
//! Each command is a short list of other programs called with fixed arguments. No shell is involved, so the commands
//! mean the same everywhere.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command line program talks to its terminal")]

mod bench;
mod browser;
mod counts;
mod demo;
mod fuzz;
mod glb;
mod gpu;
mod interop;
mod lan;
mod process;
mod python;
mod readme;
mod samples;
mod setup;
mod step;
mod test;
mod tools;
mod torch;
mod web;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

use crate::tools::Context;

const EXAMPLES: &str = "\
Examples:
  cargo xtask test                    every check that the build server runs
  cargo xtask test --keep-going       the same, not stopping at the first failure
  cargo xtask check                   only formatting, clippy and licences
  cargo xtask samples                 make the files in samples/ again
  cargo xtask fuzz --seconds 60       each fuzz test for a minute
  cargo xtask interop                 Blender, usd-core and three.js read our files (fetches 400 MB, once)
  cargo xtask studio --open           build the studio's page and the program, and open it
  cargo xtask bench -- dense          the benchmarks with `dense` in their name

Environment:
  CI=true            a skipped check is a failure
  INKRIG_REFERENCE   folder of reference data for the tests (default: ../shared)
  INKRIG_CACHE       folder for pinned tools (default: $XDG_CACHE_HOME/inkrig or ~/.cache/inkrig)
  CHROMIUM           the browser to open the preview with";

#[derive(Parser)]
#[command(bin_name = "cargo xtask", about = "The developer's commands of inkrig", after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run every check that the build server runs
    Test {
        /// Run the remaining steps after one failed
        #[arg(long)]
        keep_going: bool,
    },
    /// Run the checks that need no build: formatting, clippy, licences
    Check {
        /// Run the remaining steps after one failed
        #[arg(long)]
        keep_going: bool,
    },
    /// Build the documentation; warnings are failures
    Doc {
        /// Open it in the browser
        #[arg(long)]
        open: bool,
    },
    /// Fetch the pinned tools into the cache folder
    Setup {
        /// Also install Node, npm and Chromium with apt (root on Debian only)
        #[arg(long)]
        system: bool,
    },
    /// Make the files in samples/ again
    Samples,
    /// Run each fuzz test for a given time
    Fuzz {
        /// Seconds for each fuzz test
        #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u64).range(1..))]
        seconds: u64,
        /// Only tests with this in their name
        filter: Option<String>,
    },
    /// Have Blender, usd-core and three.js read our files and compare where the joints are
    Interop {
        /// Only this one: blender, usd-core, three
        #[arg(long)]
        importer: Option<String>,
    },
    /// Build the studio's page into web/dist (npm); the program's next build embeds it
    Web,
    /// Drive the studio in Chromium as a user would; pictures go to target/studio
    WebTest,
    /// Drive the studio from another device, in network namespaces (root)
    LanTest,
    /// Let the studio be drawn on at random for half an hour, without growth or a word in the console
    Soak {
        /// How long
        #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
        minutes: u32,
    },
    /// Build the studio's page and the program, and run the studio
    Studio {
        /// Options and files for `inkrig studio`
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Check that training still builds for graphics processors, or say what is missing
    GpuCheck,
    /// Have PyTorch write checkpoints, import them and compare every bit (fetches 200 MB, once)
    TorchCheck,
    /// Run the benchmarks
    Bench {
        /// Filter and options for criterion
        #[arg(last = true)]
        arguments: Vec<String>,
    },
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<ExitCode> {
    let context = Context::find()?;
    match command {
        Command::Test { keep_going } => return Ok(test::all(&context, keep_going)),
        Command::Check { keep_going } => return Ok(test::quick(&context, keep_going)),
        Command::Doc { open } => test::doc(&context, open)?,
        Command::Setup { system } => setup::run(&context, system)?,
        Command::Samples => samples::make(&context)?,
        Command::Fuzz { seconds, filter } => fuzz::run(&context, seconds, filter.as_deref())?,
        Command::Interop { importer } => interop::run(&context, importer.as_deref())?,
        Command::Web => web::build(&context).map(drop)?,
        Command::WebTest => say(web::check(&context)?),
        Command::LanTest => say(lan::check(&context)?),
        Command::Soak { minutes } => say(web::soak(&context, minutes)?),
        Command::Studio { arguments } => web::studio(&context, &arguments)?,
        Command::GpuCheck => gpu::run(&context)?,
        Command::TorchCheck => torch::run(&context)?,
        Command::Bench { arguments } => bench::run(&context, &arguments)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn say(verdict: step::Verdict) {
    if let step::Verdict::Skipped(why) = verdict {
        println!("skipped: {why}");
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        super::Arguments::command().debug_assert();
    }
}
