//! Runs the built program's demo into an empty folder and looks at what it wrote.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::tools::Context;
use crate::{process, test};

/// Kinds of file that the demo promises: a motion, a preview page, a sheet.
const PROMISED: [&str; 3] = ["bvh", "html", "png"];

/// Runs `inkrig demo DIR`; fails if a promised kind of file is missing or any file is empty.
pub(crate) fn check(context: &Context) -> Result<()> {
    let target = context.target()?;
    let folder = folder(&target);
    empty(&folder)?;
    process::run(
        Command::new(test::built_program(&target)?).arg("demo").arg(&folder).current_dir(&context.root),
    )?;
    let files = files_below(&folder)?;
    for file in &files {
        let bytes = fs::metadata(file)?.len();
        println!("{bytes:>10} bytes  {}", file.display());
        if bytes == 0 {
            bail!("the demo left an empty file: {}", file.display());
        }
    }
    match PROMISED.iter().find(|ending| !files.iter().any(|file| has_ending(file, ending))) {
        Some(ending) => bail!("the demo wrote no .{ending} file into {}", folder.display()),
        None => Ok(()),
    }
}

/// The preview pages of the demo that [`check`] ran.
///
/// # Errors
/// When the demo has not run or left none.
pub(crate) fn previews(target: &Path) -> Result<Vec<PathBuf>> {
    let mut files = files_below(&folder(target))?;
    files.retain(|file| has_ending(file, "html"));
    if files.is_empty() {
        bail!("the demo wrote no preview page");
    }
    Ok(files)
}

/// Makes a folder anew.
pub(crate) fn empty(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))
}

fn folder(target: &Path) -> PathBuf {
    target.join("demo")
}

fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|found| found == ending)
}

/// All files in a folder and the folders in it, in order of name.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            files.extend(files_below(&entry.path())?);
        } else {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preview_is_found_also_in_a_folder_below() {
        let target = tempfile::tempdir().unwrap();
        assert!(previews(target.path()).is_err());
        let (outer, inner) = (target.path().join("demo"), target.path().join("demo/walk"));
        empty(&inner).unwrap();
        for file in [outer.join("b.html"), inner.join("a.html"), inner.join("a.bvh")] {
            fs::write(file, "x").unwrap();
        }
        assert_eq!(previews(target.path()).unwrap(), [outer.join("b.html"), inner.join("a.html")]);
        empty(&outer).unwrap();
        assert!(previews(target.path()).is_err());
    }
}
