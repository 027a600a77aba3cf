//! `cargo xtask setup`: pinned tools into the cache folder, and system packages when asked.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, bail};

use crate::tools::{self, Context, find_program};
use crate::{browser, process};

const CARGO_DENY: &str = "0.20.2";

/// Brings everything that `cargo xtask test` would fetch or miss. Quick when all is there.
pub(crate) fn run(context: &Context, system: bool) -> Result<()> {
    if system {
        system_packages()?;
    }
    process::run(&mut context.cargo(&["fetch"]))?;
    println!("cargo-deny: {}", cargo_deny(context)?.display());
    match browser::Tools::find(context)? {
        Ok(tools) => println!("preview check: {} with {}", tools.node.display(), tools.chromium.display()),
        Err(missing) => println!("preview check: {missing}"),
    }
    Ok(())
}

/// The pinned cargo-deny, installed into the cache folder if it is not there.
///
/// # Errors
/// When it has to be built and that fails.
pub(crate) fn cargo_deny(context: &Context) -> Result<PathBuf> {
    let tools = context.cache.join("tools");
    let program = tools.join("bin").join(format!("cargo-deny{}", std::env::consts::EXE_SUFFIX));
    if version(&program).as_deref() == Some(CARGO_DENY) {
        return Ok(program);
    }
    println!("building cargo-deny {CARGO_DENY} into {} (a few minutes, once)", tools.display());
    fs::create_dir_all(&tools).with_context(|| format!("cannot make {}", tools.display()))?;
    let build = tools.join("build");
    let mut command = Command::new(tools::cargo());
    command
        .args(["install", "--locked", "--force", "--version", CARGO_DENY, "cargo-deny", "--root"])
        .arg(&tools);
    // Out of the workspace, so that neither its settings nor its target folder take part.
    command.current_dir(&tools).env("CARGO_TARGET_DIR", &build);
    process::run(&mut command)?;
    fs::remove_dir_all(&build).with_context(|| format!("cannot remove {}", build.display()))?;
    Ok(program)
}

fn version(program: &Path) -> Option<String> {
    let output = Command::new(program).arg("--version").stderr(Stdio::null()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    text.split_whitespace().nth(1).map(str::to_owned)
}

/// The only place that changes the system.
fn system_packages() -> Result<()> {
    let mut missing = browser::missing_packages();
    // Tests of speech as control make their own.
    if find_program(&["espeak-ng"]).is_none() {
        missing.push("espeak-ng");
    }
    if missing.is_empty() {
        println!("system packages: nothing to install");
        return Ok(());
    }
    let list = missing.join(" ");
    let (Some(apt), true) = (find_program(&["apt-get"]), is_root()) else {
        bail!(
            "cannot install {list}: --system needs apt-get and root; install them yourself and run without --system"
        );
    };
    println!("system packages: {list}");
    let apt = |arguments: &[&str]| {
        process::run(Command::new(&apt).args(arguments).env("DEBIAN_FRONTEND", "noninteractive"))
    };
    apt(&["update", "--quiet"])?;
    let mut install = vec!["install", "--quiet", "--yes", "--no-install-recommends"];
    install.extend(missing);
    apt(&install)
}

fn is_root() -> bool {
    process::output(Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0")
}
