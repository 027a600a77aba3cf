//! Opens the demo's preview pages in a headless Chromium, driven from Node by a pinned playwright-core.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::step::Verdict;
use crate::tools::{Context, find_program};
use crate::{demo, process};

/// Debian's packages for this check that are not here.
pub(crate) fn missing_packages() -> Vec<&'static str> {
    let found = [("nodejs", node()), ("npm", npm()), ("chromium", chromium())];
    found.into_iter().filter(|(_, program)| program.is_none()).map(|(package, _)| package).collect()
}

/// What the check is made with.
pub(crate) struct Tools {
    pub(crate) node: PathBuf,
    pub(crate) chromium: PathBuf,
    /// The folder that holds `node_modules`.
    pub(crate) modules: PathBuf,
}

impl Tools {
    /// Finds the programs and installs playwright-core into the cache folder, or names the missing packages.
    ///
    /// # Errors
    /// When `npm ci` fails.
    pub(crate) fn find(context: &Context) -> Result<Result<Self, String>> {
        let (Some(node), Some(npm), Some(chromium)) = (node(), npm(), chromium()) else {
            return Ok(Err(format!("not installed: {}", missing_packages().join(", "))));
        };
        let modules = install_modules(context, &npm, "browser")?;
        Ok(Ok(Self { node, chromium, modules }))
    }
}

/// Fails on a console error or warning, a blank or still canvas, or a request that leaves the page.
pub(crate) fn check(context: &Context) -> Result<Verdict> {
    let tools = match Tools::find(context)? {
        Ok(tools) => tools,
        Err(missing) => return Ok(Verdict::Skipped(missing)),
    };
    let target = context.target()?;
    let screenshots = target.join("screenshots");
    demo::empty(&screenshots)?;
    let mut command = Command::new(&tools.node);
    command.arg(context.root.join("xtask/browser/preview.mjs"));
    command.arg(&tools.modules).arg(&tools.chromium).arg(&screenshots).args(demo::previews(&target)?);
    process::run(&mut command)?;
    Ok(Verdict::Passed)
}

pub(crate) fn node() -> Option<PathBuf> {
    find_program(&["node", "nodejs"])
}

pub(crate) fn npm() -> Option<PathBuf> {
    find_program(&["npm"])
}

pub(crate) fn chromium() -> Option<PathBuf> {
    if let Some(named) = env::var_os("CHROMIUM").filter(|named| !named.is_empty()) {
        return Some(named.into());
    }
    let on_path = ["chromium", "chromium-browser", "google-chrome-stable", "google-chrome", "chrome"];
    let mac = PathBuf::from("/Applications/Google Chrome.app/Contents/MacOS/Google Chrome");
    find_program(&on_path).or_else(|| mac.is_file().then_some(mac))
}

/// Installs what the lock file of a folder of `xtask` pins, unless the cache folder holds that already.
///
/// # Errors
/// When `npm ci` fails.
pub(crate) fn install_modules(context: &Context, npm: &Path, folder: &str) -> Result<PathBuf> {
    let source = context.root.join("xtask").join(folder);
    let modules = context.cache.join(folder);
    let lock = fs::read(source.join("package-lock.json"))
        .with_context(|| format!("cannot read xtask/{folder}/package-lock.json"))?;
    // Written last, so a broken install is not taken for a whole one.
    let done = modules.join("installed.json");
    if fs::read(&done).is_ok_and(|installed| installed == lock) {
        return Ok(modules);
    }
    fs::create_dir_all(&modules).with_context(|| format!("cannot make {}", modules.display()))?;
    for file in ["package.json", "package-lock.json"] {
        fs::copy(source.join(file), modules.join(file)).with_context(|| format!("cannot copy {file}"))?;
    }
    let mut command = Command::new(npm);
    command.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(&modules);
    process::run(&mut command)?;
    fs::write(&done, lock)?;
    Ok(modules)
}
