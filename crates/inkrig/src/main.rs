//! The program `inkrig`. Everything of substance is in the library beside it.

use clap::Parser;
use inkrig::cli::Cli;
use std::process::ExitCode;

// Aligning makes and drops large tables; mimalloc keeps their pages.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_env_filter(tracing_subscriber::EnvFilter::from_env("INKRIG_LOG"))
        .with_writer(std::io::stderr)
        .init();
    match inkrig::commands::run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let code = error.exit_code();
            use std::io::Write;
            let _ = writeln!(std::io::stderr(), "{:?}", miette::Report::new(error));
            ExitCode::from(code)
        }
    }
}
