//! `cargo xtask samples`: makes the sample files again.

use anyhow::Result;

use crate::process;
use crate::tools::Context;

/// Runs the maker as an example of xtask, not a part: so xtask needs no crate of ours and is quick to build.
pub(crate) fn make(context: &Context) -> Result<()> {
    let mut command = context.cargo(&["run"]);
    command.args(["--release", "--package", "xtask", "--example", "make_samples", "--"]);
    command.arg(context.root.join("samples"));
    process::run(&mut command)
}
