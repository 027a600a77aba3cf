//! The folder of a corpus: what may be built into it, and whether all of it is there.

use super::build::{Shard, part_name, write};
use super::config::Config;
use super::files::{self, MotionFile};
use super::part::VERSION;
use crate::TrainError;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::ffi::OsString;
use std::io::{Error, ErrorKind};
use std::path::Path;

/// The file by which a folder is known as a corpus.
const MARK: &str = "corpus.json";
/// Says how many shares a corpus is built in, as long as they are not merged.
const SHARES: &str = "shares.json";
/// The most shares that are named.
const MOST: usize = 8;

#[derive(Serialize, Deserialize)]
struct Shares {
    count: usize,
}

/// Takes a folder that is empty or a corpus already.
pub(super) fn open(folder: &Path, shard: Shard) -> Result<(), TrainError> {
    let failed = |cause| TrainError::File { path: folder.to_path_buf(), cause };
    std::fs::create_dir_all(folder).map_err(failed)?;
    if !folder.join(MARK).exists() {
        if std::fs::read_dir(folder).map_err(failed)?.next().is_some() {
            let what = "holds other files: give an empty or a new folder for the corpus".to_string();
            return Err(TrainError::Content { path: folder.to_path_buf(), what });
        }
        write(&folder.join(MARK), format!("{{\"inkrig_corpus\": {VERSION}}}\n").as_bytes())?;
    }
    if shard.count > 1 {
        let shares = serde_json::to_vec(&Shares { count: shard.count }).unwrap_or_default();
        write(&folder.join(SHARES), &shares)?;
    }
    Ok(())
}

/// Whether what lies in a folder is of the sources that are to be built, so that no other corpus is lost.
pub(super) fn check_sources(config: &Config, files: &[MotionFile], folder: &Path) -> Result<(), TrainError> {
    let other = |what: String| Err(TrainError::Content { path: folder.to_path_buf(), what });
    for found in names(&folder.join("parts"))? {
        let own = config.sources.iter().position(|source| *source.name == *found);
        let parts = folder.join("parts").join(&found);
        let Some(place) = own else {
            return other(format!(
                "holds a corpus with the source `{}`, which the configuration has not: give a new folder, or remove {} if it is of no use any more",
                found.to_string_lossy(),
                parts.display()
            ));
        };
        let there: HashSet<OsString> = names(&parts)?.into_iter().collect();
        let is_there = |file: &MotionFile| {
            let part = part_name(config, file);
            file.source == place && Path::new(&part).file_name().is_some_and(|name| there.contains(name))
        };
        if there.is_empty() || files.iter().any(is_there) {
            continue;
        }
        // Other files of the same folder may be asked for now.
        let mut all = config.clone();
        for source in &mut all.sources {
            source.include.clear();
            source.exclude.clear();
            source.subjects.clear();
        }
        if !files::find(&all)?.iter().any(is_there) {
            return other(format!(
                "holds a corpus whose source `{}` has other files, none of {}: give a new folder",
                found.to_string_lossy(),
                config.sources.get(place).map_or(Path::new(""), |source| &source.folder).display()
            ));
        }
    }
    Ok(())
}

/// Whether every file has its part.
pub(super) fn check_parts(config: &Config, files: &[MotionFile], folder: &Path) -> Result<(), TrainError> {
    let wrong = |what: String| Err(TrainError::Content { path: folder.to_path_buf(), what });
    if !folder.join(MARK).exists() {
        return wrong("holds no corpus: build its shares first, by inkrig data build --shard".into());
    }
    let lacks =
        |file: &MotionFile| file.set_aside.is_none() && !folder.join(part_name(config, file)).exists();
    let missing: Vec<usize> =
        files.iter().enumerate().filter(|(_, file)| lacks(file)).map(|(place, _)| place).collect();
    let Some(first) = missing.first().and_then(|place| files.get(*place)) else { return Ok(()) };
    let count = std::fs::read(folder.join(SHARES)).ok();
    let count =
        count.and_then(|bytes| serde_json::from_slice::<Shares>(&bytes).ok()).map(|shares| shares.count);
    let Some(count) = count.filter(|count| *count > 1) else {
        return wrong(format!(
            "{} of {} files are not built yet, {} the first: run inkrig data build once more",
            missing.len(),
            files.len(),
            first.name
        ));
    };
    let mut shares: Vec<usize> = missing.iter().map(|place| place % count + 1).collect();
    shares.sort_unstable();
    shares.dedup();
    let named: Vec<String> = shares.iter().take(MOST).map(|share| format!("{share}/{count}")).collect();
    let more = shares.len().saturating_sub(MOST);
    wrong(format!(
        "{} {}{} not built yet ({} of {} files): run inkrig data build with --shard {}, or copy its parts here",
        if shares.len() == 1 { "share" } else { "shares" },
        named.join(", "),
        match (more, shares.len()) {
            (0, 1) => " is".to_string(),
            (0, _) => " are".to_string(),
            (more, _) => format!(" and {more} more are"),
        },
        missing.len(),
        files.len(),
        named.first().map_or("", String::as_str)
    ))
}

/// Forgets in how many shares a corpus was built, once it is whole.
pub(super) fn forget_shares(folder: &Path) -> Result<(), TrainError> {
    let path = folder.join(SHARES);
    match std::fs::remove_file(&path) {
        Err(cause) if cause.kind() != ErrorKind::NotFound => Err(TrainError::File { path, cause }),
        _ => Ok(()),
    }
}

/// What a folder holds, in order; nothing where there is none.
fn names(folder: &Path) -> Result<Vec<OsString>, TrainError> {
    let failed = |cause: Error| TrainError::File { path: folder.to_path_buf(), cause };
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed)?,
    };
    let names = entries.map(|entry| entry.map(|entry| entry.file_name()).map_err(failed));
    let mut names = names.collect::<Result<Vec<_>, _>>()?;
    names.sort();
    Ok(names)
}
