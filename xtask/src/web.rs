//! `cargo xtask web`, `web-test`, `soak` and `studio`: the studio's page, built by npm, embedded by the program's next build.

use std::fs;
use std::path::{Path, PathBuf};
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
    let web = run(context, &npm, "build")?;
    // A program that was built without the page looks for it again when its build script has changed.
    let script = context.root.join("crates/inkrig-studio/build.rs");
    fs::File::options().append(true).open(script)?.set_modified(std::time::SystemTime::now())?;
    Ok(web)
}

/// The page's types are those of the interface's description, and hold.
///
/// # Errors
/// When they are not, or npm fails.
pub(crate) fn types(context: &Context) -> Result<Verdict> {
    let Some(npm) = browser::npm() else { return Ok(Verdict::Skipped("not installed: npm".into())) };
    run(context, &npm, "check").map(|_| Verdict::Passed)
}

/// Runs a script of the page's package; returns its folder.
fn run(context: &Context, npm: &Path, script: &str) -> Result<PathBuf> {
    let web = context.root.join("web");
    let lock = fs::read(web.join("package-lock.json")).context("cannot read web/package-lock.json")?;
    // Written last, so a broken install is not taken for a whole one.
    let done = web.join("node_modules/.installed.json");
    if fs::read(&done).ok().is_none_or(|installed| installed != lock) {
        let mut install = Command::new(npm);
        process::run(install.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(&web))?;
        fs::write(&done, lock)?;
    }
    process::run(Command::new(npm).args(["run", script]).current_dir(&web))?;
    Ok(web)
}

/// Drives the program's page in Chromium as a user would. Pictures of every panel go to `target/studio`.
///
/// # Errors
/// When a build or the test fails.
pub(crate) fn check(context: &Context) -> Result<Verdict> {
    let pictures = context.target()?.join("studio");
    demo::empty(&pictures)?;
    let pictures = pictures.to_string_lossy();
    for script in ["studio.mjs", "watching.mjs", "storyboard.mjs"] {
        match driven(context, script, &[&pictures])? {
            Verdict::Passed => {}
            other => return Ok(other),
        }
    }
    Ok(Verdict::Passed)
}

/// Draws at random for some minutes.
///
/// # Errors
/// When a build fails, page, browser or program grow, or the console says a word.
pub(crate) fn soak(context: &Context, minutes: u32) -> Result<Verdict> {
    driven(context, "soak.mjs", &[&minutes.to_string()])
}

/// Builds page and program and runs a script of `web/tests` on them.
fn driven(context: &Context, script: &str, more: &[&str]) -> Result<Verdict> {
    let (Some(node), Some(chromium)) = (browser::node(), browser::chromium()) else {
        return Ok(Verdict::Skipped(format!("not installed: {}", browser::missing_packages().join(", "))));
    };
    let web = build(context)?;
    process::run(context.cargo(&["build"]).args(["--release", "-p", "inkrig", "--bin", "inkrig"]))?;
    let program = test::built_program(&context.target()?)?;
    let mut command = Command::new(node);
    command.arg(web.join("tests").join(script)).arg(chromium).arg(program).args(more);
    process::run(command.env("INKRIG_REFERENCE", context.reference()))?;
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
