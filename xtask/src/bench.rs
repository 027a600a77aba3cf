//! `cargo xtask bench`: the criterion benchmarks.

use anyhow::Result;

use crate::process;
use crate::tools::Context;

/// The crates whose speed is measured.
const PACKAGES: [&str; 2] = ["inkrig-transport", "inkrig-align"];

/// Runs the benchmarks; `arguments` go to criterion, a filter first of all.
pub(crate) fn run(context: &Context, arguments: &[String]) -> Result<()> {
    let mut command = context.cargo(&["bench"]);
    for package in PACKAGES {
        command.args(["--package", package]);
    }
    // Only bench targets: the library's own test harness does not understand criterion's arguments.
    command.args(["--bench", "*", "--"]).args(arguments);
    process::run(&mut command)
}
