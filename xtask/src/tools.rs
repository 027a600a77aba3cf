//! Where things are: the repository, the cache folder, the target folder, programs on the search path.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::process;

/// The places and settings that every command needs.
pub(crate) struct Context {
    /// The workspace root.
    pub(crate) root: PathBuf,
    /// Pinned tools live here, never in the repository.
    pub(crate) cache: PathBuf,
    /// Whether `CI` is set: skips are failures and the lock file is final.
    pub(crate) ci: bool,
}

impl Context {
    /// Finds the workspace and the cache folder.
    ///
    /// # Errors
    /// When neither a cache nor a home folder is known.
    pub(crate) fn find() -> Result<Self> {
        // Asked for at run time: a target folder that serves several clones may hold a build of another clone.
        let manifest = env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        let root = Path::new(&manifest).parent().context("xtask has no parent folder")?.to_path_buf();
        let ci = env::var("CI").is_ok_and(|value| !matches!(value.as_str(), "" | "0" | "false"));
        Ok(Self { root, cache: cache_folder(|name| env::var_os(name))?, ci })
    }

    /// A `cargo` command in the workspace root, with the lock file held fixed on the build server.
    pub(crate) fn cargo(&self, subcommand: &[&str]) -> Command {
        let mut command = Command::new(cargo());
        command.args(subcommand).current_dir(&self.root);
        if self.ci && subcommand != ["fmt"] {
            command.arg("--locked");
        }
        command
    }

    /// The folder for the tests' reference data, absolute: `INKRIG_REFERENCE`, or `../shared`.
    pub(crate) fn reference(&self) -> PathBuf {
        self.root.join(env::var_os("INKRIG_REFERENCE").unwrap_or_else(|| "../shared".into()))
    }

    /// What `cargo metadata` says of the workspace's own packages.
    ///
    /// # Errors
    /// When it fails.
    pub(crate) fn metadata(&self) -> Result<serde_json::Value> {
        let mut command = self.cargo(&["metadata"]);
        command.args(["--no-deps", "--format-version", "1"]);
        Ok(serde_json::from_str(&process::output(&mut command)?)?)
    }

    /// Cargo's target folder, wherever it was set.
    ///
    /// # Errors
    /// When `cargo metadata` fails.
    pub(crate) fn target(&self) -> Result<PathBuf> {
        let metadata = self.metadata()?;
        let target =
            metadata["target_directory"].as_str().context("cargo metadata names no target folder")?;
        Ok(target.into())
    }
}

/// The `cargo` that runs us, or the one on the search path.
pub(crate) fn cargo() -> OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Looks for the first of some program names on the search path.
pub(crate) fn find_program(names: &[&str]) -> Option<PathBuf> {
    find_in(&env::var_os("PATH")?, names)
}

fn find_in(path: &OsString, names: &[&str]) -> Option<PathBuf> {
    let endings: &[&str] = if cfg!(windows) { &[".exe", ".cmd"] } else { &[""] };
    let folders: Vec<PathBuf> = env::split_paths(path).collect();
    names.iter().find_map(|name| {
        let files = endings.iter().map(|ending| format!("{name}{ending}"));
        files
            .flat_map(|file| folders.iter().map(move |folder| folder.join(&file)))
            .find(|file| file.is_file())
    })
}

fn cache_folder(variable: impl Fn(&str) -> Option<OsString>) -> Result<PathBuf> {
    let set = |name| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let folder = set("INKRIG_CACHE")
        .or_else(|| set("XDG_CACHE_HOME").map(|folder| folder.join("inkrig")))
        .or_else(|| set("HOME").or_else(|| set("USERPROFILE")).map(|home| home.join(".cache/inkrig")));
    match folder {
        // Tools run in other folders than ours, so a relative place would be several places.
        Some(folder) => Ok(std::path::absolute(folder)?),
        None => bail!("no home folder: set INKRIG_CACHE to a folder for pinned tools"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cache_with(variables: &[(&str, &str)]) -> Result<PathBuf> {
        cache_folder(|name| variables.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).into()))
    }

    #[test]
    fn the_cache_folder_follows_the_nearest_setting() {
        let all = [("INKRIG_CACHE", "/a"), ("XDG_CACHE_HOME", "/b"), ("HOME", "/c")];
        assert_eq!(cache_with(&all).unwrap(), Path::new("/a"));
        assert_eq!(cache_with(&all[1..]).unwrap(), Path::new("/b/inkrig"));
        assert_eq!(cache_with(&all[2..]).unwrap(), Path::new("/c/.cache/inkrig"));
        assert!(cache_with(&[("INKRIG_CACHE", "")]).is_err());
    }

    #[test]
    #[cfg(unix)]
    fn a_program_is_found_by_the_first_name_that_exists() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("second"), "").unwrap();
        let path = env::join_paths([Path::new("/nonexistent"), folder.path()]).unwrap();
        assert_eq!(find_in(&path, &["first", "second"]), Some(folder.path().join("second")));
        assert_eq!(find_in(&path, &["first"]), None);
    }
}
