//! Writes the sample files into the folder given as argument. Called by `cargo xtask samples`.
#![allow(clippy::print_stdout, reason = "a command line program talks to its terminal")]

use anyhow::{Context, Result};

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).context("usage: make_samples FOLDER")?;
    for file in inkrig_samples::make::write_all(folder.as_ref())? {
        println!("{}", file.display());
    }
    Ok(())
}
