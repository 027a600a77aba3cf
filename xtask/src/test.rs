//! `cargo xtask test`, `check` and `doc`: the checks, in order.

use std::path::Path;
use std::process::{Command, ExitCode};

use anyhow::{Context as _, Result};

use crate::counts::Counts;
use crate::step::{Steps, Verdict};
use crate::tools::{self, Context};
use crate::{browser, demo, glb, process, readme, setup, web};

/// Every check that the build server runs. The cheap ones come first.
pub(crate) fn all(context: &Context, keep_going: bool) -> ExitCode {
    let mut steps = Steps::new(context.ci, keep_going);
    without_build(context, &mut steps);
    steps
        .run("the studio's page and its types", || web::types(context))
        .run("documentation", || passed(doc(context, false)))
        .run("release build", || passed(build(context)))
        .run("reference data", || Ok(reference(context)))
        .run("tests", || tests(context))
        .run("documentation tests", || doc_tests(context))
        .run("demo", || passed(demo::check(context)))
        .run("GLB files in glTF-Validator", || glb::check(context))
        .run("README commands", || passed(readme::check(context)))
        .run("preview in the browser", || browser::check(context));
    steps.finish()
}

/// Formatting, clippy and licences.
pub(crate) fn quick(context: &Context, keep_going: bool) -> ExitCode {
    let mut steps = Steps::new(context.ci, keep_going);
    without_build(context, &mut steps);
    steps.finish()
}

/// Builds the documentation of every crate; a warning is an error.
pub(crate) fn doc(context: &Context, open: bool) -> Result<()> {
    let mut command = context.cargo(&["doc"]);
    command.args(["--release", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings");
    if open {
        command.arg("--open");
    }
    process::run(&mut command)
}

fn without_build(context: &Context, steps: &mut Steps) {
    steps
        .run("formatting", || passed(process::run(context.cargo(&["fmt"]).args(["--all", "--check"]))))
        .run("licences, bans, sources", || passed(deny(context)))
        .run("clippy", || passed(clippy(context)));
}

fn passed(result: Result<()>) -> Result<Verdict> {
    result.map(|()| Verdict::Passed)
}

/// In the release profile, as everything here: one set of compiled macros and build scripts serves all steps.
fn clippy(context: &Context) -> Result<()> {
    let mut command = context.cargo(&["clippy"]);
    process::run(command.args(["--release", "--workspace", "--all-targets", "--", "-D", "warnings"]))
}

/// The advisories are left out: they need the network and change without us.
fn deny(context: &Context) -> Result<()> {
    let mut command = Command::new(setup::cargo_deny(context)?);
    command.current_dir(&context.root).env("CARGO", tools::cargo());
    if context.ci {
        command.arg("--locked");
    }
    process::run(command.args(["--log-level", "error", "check", "licenses", "bans", "sources"]))
}

/// Builds programs and tests in one command, so that both share one choice of features and nothing is built twice.
fn build(context: &Context) -> Result<()> {
    let mut command = context.cargo(&["build"]);
    process::run(command.args(["--release", "--workspace", "--lib", "--bins", "--tests", "--examples"]))
}

fn reference(context: &Context) -> Verdict {
    let folder = context.reference();
    if folder.is_dir() {
        println!("{}", folder.display());
        return Verdict::Passed;
    }
    let folder = folder.display();
    Verdict::Skipped(format!("no folder {folder} for the tests on real motion (INKRIG_REFERENCE)"))
}

fn tests(context: &Context) -> Result<Verdict> {
    let command = if tools::find_program(&["cargo-nextest"]).is_some() {
        let mut command = context.cargo(&["nextest", "run"]);
        command.args(["--release", "--workspace", "--no-fail-fast", "--status-level", "slow"]);
        command.arg("--config-file").arg(context.root.join("xtask/nextest.toml"));
        command
    } else {
        let mut command = context.cargo(&["test"]);
        command.args([
            "--release",
            "--workspace",
            "--no-fail-fast",
            "--lib",
            "--bins",
            "--tests",
            "--examples",
        ]);
        command
    };
    tested(context, command)
}

fn doc_tests(context: &Context) -> Result<Verdict> {
    let mut command = context.cargo(&["test"]);
    command.args(["--release", "--workspace", "--no-fail-fast", "--doc"]);
    tested(context, command)
}

fn tested(context: &Context, mut command: Command) -> Result<Verdict> {
    // Tests run in their crates' folders, where a relative place would be another place.
    let reference = std::path::absolute(context.reference())?;
    let (status, output) = process::tee(command.env("INKRIG_REFERENCE", reference))?;
    let counts = Counts::read(&output);
    if !status.success() && counts.failed == 0 {
        anyhow::bail!("the tests did not run ({status})");
    }
    Ok(Verdict::Tested(counts))
}

/// The program as the release build left it.
pub(crate) fn built_program(target: &Path) -> Result<std::path::PathBuf> {
    let program = target.join("release").join(format!("inkrig{}", std::env::consts::EXE_SUFFIX));
    program.is_file().then_some(()).with_context(|| format!("the build left no {}", program.display()))?;
    Ok(program)
}
