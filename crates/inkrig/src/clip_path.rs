//! `wolf.glb#Gallop`: one clip of a file that holds several.

use crate::cli::ImportArgs;
use crate::error::CliError;
use crate::{load, wildcard};
use std::path::{Path, PathBuf};

/// The file, and the clip that is named behind a `#`. A file whose own name has that sign is taken as it is.
pub(crate) fn split(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    let parted = || {
        text.match_indices('#').find_map(|(place, _)| {
            let (file, clip) = (Path::new(&text[..place]), &text[place + 1..]);
            (file.is_file() && !clip.is_empty()).then(|| (file.to_path_buf(), Some(clip.to_string())))
        })
    };
    let whole = || (path.to_path_buf(), None);
    if path.exists() { whole() } else { parted().unwrap_or_else(whole) }
}

/// The files of some paths. One of which several clips are named is there once.
pub(crate) fn files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Vec<PathBuf> {
    let mut files: Vec<(PathBuf, bool)> = Vec::new();
    for path in paths {
        let (file, clip) = split(path);
        if clip.is_none() || !files.iter().any(|(own, named)| *named && *own == file) {
            files.push((file, clip.is_some()));
        }
    }
    files.into_iter().map(|(file, _)| file).collect()
}

/// The same paths, with `file#*` and the like replaced by all clips whose names fit.
///
/// # Errors
/// When the file cannot be read or no clip fits.
pub(crate) fn expand(paths: &[PathBuf], args: &ImportArgs) -> Result<Vec<PathBuf>, CliError> {
    let mut all = Vec::with_capacity(paths.len());
    for path in paths {
        let (file, clip) = split(path);
        let Some(pattern) = clip.filter(|clip| clip.contains(['*', '?'])) else {
            all.push(path.clone());
            continue;
        };
        let before = all.len();
        for clip in load::motion(&file, args)?.clips {
            // Some programs put the figure's name before the clip's.
            let plain = clip.name.rsplit('|').next().unwrap_or(&clip.name);
            if wildcard::is_like(&pattern, plain) || wildcard::is_like(&pattern, &clip.name) {
                all.push(PathBuf::from(format!("{}#{}", file.display(), clip.name)));
            }
        }
        if all.len() == before {
            return Err(CliError::NothingFits(path.clone()));
        }
    }
    Ok(all)
}

/// What people call it: the name of the file, and of the clip.
pub(crate) fn name(path: &Path) -> String {
    let (file, clip) = split(path);
    let stem = file.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    clip.map_or(stem.clone(), |clip| format!("{stem} {}", clip.rsplit('|').next().unwrap_or(&clip)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clip_is_named_behind_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for file in ["wolf.glb", "a#b.glb"] {
            std::fs::write(at(file), "").unwrap();
        }
        let named = |name: &str| split(&at(name));
        assert_eq!(named("wolf.glb#Run#2"), (at("wolf.glb"), Some("Run#2".to_string())));
        assert_eq!(named("a#b.glb#Run"), (at("a#b.glb"), Some("Run".to_string())));
        for whole in ["wolf.glb", "wolf.glb#", "a#b.glb", "fox.glb#Run"] {
            assert_eq!(named(whole), (at(whole), None));
        }
        let paths = ["wolf.glb#Run", "wolf.glb#Walk", "a#b.glb"].map(at);
        assert_eq!(files(paths.iter().map(PathBuf::as_path)), [at("wolf.glb"), at("a#b.glb")]);
        let twice = [at("wolf.glb"), at("wolf.glb")];
        assert_eq!(files(twice.iter().map(PathBuf::as_path)).len(), 2, "named twice, and said so later");
        assert_eq!(name(&at("wolf.glb#Armature|Run")), "wolf Run");
    }
}
