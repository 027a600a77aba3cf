//! Virtual environments in the cache folder, each for one purpose.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::tools::{Context, find_program};
use crate::{demo, process};

/// The Python of an environment that holds what a file pins; made when it is not there, which may take minutes. `names` are the
/// programs that may be its base.
pub(crate) fn environment(
    context: &Context,
    purpose: &str,
    requirements: &str,
    names: &[&str],
) -> Result<PathBuf> {
    let wanted = context.root.join(requirements);
    let pinned = fs::read(&wanted).with_context(|| format!("cannot read {requirements}"))?;
    let folder = context.cache.join(format!("{purpose}-python"));
    let programs = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = programs.join(format!("python{}", std::env::consts::EXE_SUFFIX));
    // Written last, so a broken install is not taken for a whole one.
    let done = folder.join("installed.txt");
    if fs::read(&done).is_ok_and(|installed| installed == pinned) {
        return Ok(python);
    }
    let base = find_program(names).with_context(|| format!("not installed: {}", names.join(" or ")))?;
    demo::empty(&folder)?;
    process::run(Command::new(base).args(["-m", "venv"]).arg(&folder))?;
    pip(&python, &["install", "--quiet", "--disable-pip-version-check", "--requirement"], &wanted)?;
    fs::write(&done, pinned)?;
    Ok(python)
}

fn pip(python: &Path, arguments: &[&str], file: &Path) -> Result<()> {
    process::run(Command::new(python).args(["-m", "pip"]).args(arguments).arg(file))
}
