//! Names with `*` and `?` in them, for shells that leave them as they are.

use crate::error::CliError;
use crate::output::folder_of;
use std::path::{Path, PathBuf};

/// Every path as it is, or, where no such file is there and its name holds `*` or `?`, the files whose names fit, in
/// the order of their names. Folders are taken by the letter.
///
/// # Errors
/// When a folder cannot be read, or nothing fits.
pub(crate) fn expand(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
    let mut all = Vec::with_capacity(paths.len());
    for path in paths {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if !name.contains(['*', '?']) || path.exists() {
            all.push(path.clone());
            continue;
        }
        let read = |cause| CliError::Read { path: folder_of(path).to_path_buf(), cause };
        let pattern: Vec<char> = name.chars().collect();
        let mut fitting = Vec::new();
        for entry in std::fs::read_dir(folder_of(path)).map_err(read)? {
            let entry = entry.map_err(read)?;
            let own: Vec<char> = entry.file_name().to_string_lossy().chars().collect();
            if fits(&pattern, &own) && entry.path().is_file() {
                // `./a` would read worse than `a`.
                let folder = path.parent().unwrap_or(Path::new(""));
                fitting.push(folder.join(entry.file_name()));
            }
        }
        if fitting.is_empty() {
            return Err(CliError::NothingFits(path.clone()));
        }
        fitting.sort();
        all.append(&mut fitting);
    }
    Ok(all)
}

/// Whether a name is as a pattern says: `*` for any letters, `?` for one.
pub(crate) fn is_like(pattern: &str, name: &str) -> bool {
    let letters = |text: &str| text.chars().collect::<Vec<_>>();
    fits(&letters(pattern), &letters(name))
}

/// Whether a name is as a pattern says: `*` for any letters, `?` for one. Files that begin with a dot are hidden.
fn fits(pattern: &[char], name: &[char]) -> bool {
    if name.first() == Some(&'.') && pattern.first() != Some(&'.') {
        return false;
    }
    // Where to go on when it does not fit: behind the last star, one letter further.
    let (mut star, mut p, mut n) = (None, 0, 0);
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(&letter) if letter == '?' || Some(&letter) == name.get(n) => {
                p += 1;
                n += 1;
            }
            _ => match star {
                Some((place, from)) => {
                    star = Some((place, from + 1));
                    p = place + 1;
                    n = from + 1;
                }
                None => return false,
            },
        }
    }
    pattern.get(p..).is_none_or(|rest| rest.iter().all(|&letter| letter == '*'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks() {
        let fits = |pattern: &str, name: &str| {
            let letters = |text: &str| text.chars().collect::<Vec<_>>();
            fits(&letters(pattern), &letters(name))
        };
        for (pattern, name) in [
            ("*.bvh", "a.bvh"),
            ("*", "a"),
            ("a*b*c", "aXbbYc"),
            ("0?_*.amc", "07_12.amc"),
            ("a", "a"),
            ("**", ""),
        ] {
            assert!(fits(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("*.bvh", "a.bvh2"), ("*.bvh", ".bvh"), ("?", ""), ("a*b", "acbd"), ("0?_*", "0_1"), ("", "a")]
        {
            assert!(!fits(pattern, name), "{pattern} {name}");
        }
    }

    #[test]
    fn files_come_in_order_and_nothing_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["b.bvh", "a.bvh", "c.glb"] {
            std::fs::write(at(name), "").unwrap();
        }
        std::fs::create_dir(at("d.bvh")).unwrap();
        let found = expand(&[at("c.glb"), at("*.bvh"), at("missing.bvh")]).unwrap();
        assert_eq!(found, [at("c.glb"), at("a.bvh"), at("b.bvh"), at("missing.bvh")]);
        assert!(matches!(expand(&[at("*.amc")]), Err(CliError::NothingFits(_))));
    }
}
