//! `cargo xtask web`, `web-test` and `studio`: the studio's page, built by npm, embedded by the program's next build.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::step::Verdict;
use crate::tools::Context;
use crate::{browser, demo, process, test};

/// Builds `web/` into `web/dist`: exact packages, types checked.
///
/// # Errors
/// When npm is missing, or the build fails.
pub(crate) fn build(context: &Context) -> Result<PathBuf> {
    let npm = browser::npm().context("the studio's page is built by npm, which is not installed")?;
    let web = context.root.join("web");
    let lock = fs::read(web.join("package-lock.json")).context("cannot read web/package-lock.json")?;
    // Written last, so a broken install is not taken for a whole one.
    let done = web.join("node_modules/.installed.json");
    if fs::read(&done).ok().is_none_or(|installed| installed != lock) {
        let mut install = Command::new(&npm);
        process::run(install.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(&web))?;
        fs::write(&done, lock)?;
    }
    process::run(Command::new(&npm).args(["run", "build"]).current_dir(&web))?;
    // A program that was built without the page looks for it again when its build script has changed.
    let script = context.root.join("crates/inkrig-studio/build.rs");
    fs::File::options().append(true).open(script)?.set_modified(std::time::SystemTime::now())?;
    Ok(web)
}

/// Drives the program's page in Chromium as a user would. Pictures of every panel go to `target/studio`.
///
/// # Errors
/// When a build or the test fails.
pub(crate) fn check(context: &Context) -> Result<Verdict> {
    let missing = browser::missing_packages();
    let (Some(node), Some(chromium)) = (browser::node(), browser::chromium()) else {
        return Ok(Verdict::Skipped(format!("not installed: {}", missing.join(", "))));
    };
    let web = build(context)?;
    process::run(context.cargo(&["build"]).args(["--release", "-p", "inkrig", "--bin", "inkrig"]))?;
    let target = context.target()?;
    let pictures = target.join("studio");
    demo::empty(&pictures)?;
    let mut command = Command::new(node);
    command.arg(web.join("tests/studio.mjs")).arg(chromium).arg(test::built_program(&target)?);
    command.arg(&pictures).env("INKRIG_REFERENCE", context.reference());
    process::run(&mut command)?;
    Ok(Verdict::Passed)
}

/// Builds page and program and opens the studio.
///
/// # Errors
/// When a build or the studio fails.
pub(crate) fn studio(context: &Context, arguments: &[String]) -> Result<()> {
    build(context)?;
    let mut command = context.cargo(&["run"]);
    process::run(command.args(["--release", "-p", "inkrig", "--", "studio"]).args(arguments))
}
