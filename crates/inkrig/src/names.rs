//! Every input and every result is a file of its own.

use crate::error::CliError;
use crate::output::folder_of;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Refuses two names of one file, whether it is there already or will be.
///
/// # Errors
/// [`CliError::SameFile`] with the second of the names.
pub fn all_differ<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<(), CliError> {
    let mut seen = BTreeSet::new();
    for path in paths {
        if !seen.insert(Identity::of(path)) {
            return Err(CliError::SameFile(path.to_path_buf()));
        }
    }
    Ok(())
}

/// Refuses results of one name, and results that are inputs. An input may be read for several things.
///
/// # Errors
/// [`CliError::SameFile`] with the name of the result.
pub fn results_differ<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    results: impl IntoIterator<Item = &'a Path>,
) -> Result<(), CliError> {
    let mut seen: BTreeSet<Identity> = inputs.into_iter().map(Identity::of).collect();
    for path in results {
        if !seen.insert(Identity::of(path)) {
            return Err(CliError::SameFile(path.to_path_buf()));
        }
    }
    Ok(())
}

/// What tells one file from another.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Identity {
    /// Device and number of a file that is there: the same for all of its hard links.
    #[cfg_attr(not(unix), allow(dead_code))]
    There(u64, u64),
    /// The place of a file that is not there, or where files have no numbers.
    Place(PathBuf),
}

impl Identity {
    fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(there) = path.metadata() {
            use std::os::unix::fs::MetadataExt;
            return Self::There(there.dev(), there.ino());
        }
        Self::Place(path.canonicalize().unwrap_or_else(|_| future_place(path)))
    }
}

/// Where a file will be: its folder is there even if the file is not.
fn future_place(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default();
    // These systems take names that differ in case only for one.
    let name =
        if cfg!(any(windows, target_os = "macos")) { name.to_ascii_lowercase() } else { name.to_owned() };
    folder_of(path).canonicalize().unwrap_or_else(|_| folder_of(path).to_path_buf()).join(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_has_many_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        std::fs::write(at("old"), "").unwrap();
        std::fs::hard_link(at("old"), at("hard")).unwrap();
        let differ = |names: [&str; 2]| {
            let [one, two] = names.map(at);
            all_differ([one.as_path(), two.as_path()]).is_ok()
        };
        let named = at("new");
        assert!(results_differ([named.as_path(), named.as_path()], [at("other").as_path()]).is_ok());
        assert!(results_differ([named.as_path()], [at("./new").as_path()]).is_err());
        assert!(differ(["new", "other"]) && differ(["new", "sub/new"]) && differ(["old", "new"]));
        assert!(
            !differ(["new", "./new"]) && !differ(["new", "sub/../new"]) && !differ(["old", "sub/../old"])
        );
        #[cfg(unix)]
        {
            assert!(!differ(["old", "hard"]));
            std::os::unix::fs::symlink("sub", at("way")).unwrap();
            assert!(!differ(["sub/new", "way/new"]));
        }
    }
}
