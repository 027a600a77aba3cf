//! The skeleton file that lies beside a motion which holds none.

use crate::Format;
use std::path::{Path, PathBuf};

/// The skeleton of `35_01.amc` is `35.asf` or `35_01.asf`, else the only `.asf` in its folder; that of
/// `humanoid3d_walk.txt` is `humanoid3d.txt` in its folder or the one above, as the projects keep them.
pub fn companion_beside(motion: &Path, format: Format) -> Option<PathBuf> {
    let stem = motion.file_stem()?.to_str()?;
    let first = stem.split('_').next().unwrap_or(stem);
    let folder = motion.parent()?;
    match format {
        Format::Amc => {
            let named = [stem, first].map(|name| folder.join(format!("{name}.asf")));
            named.into_iter().find(|path| path.is_file()).or_else(|| only(folder, "asf"))
        }
        Format::DeepMimic => {
            let name = format!("{first}.{}", motion.extension()?.to_str()?);
            let above = folder.join("..").join(&name);
            [folder.join(name), above].into_iter().find(|path| path.is_file() && path != motion)
        }
        _ => None,
    }
}

/// The only file of a folder with an extension.
fn only(folder: &Path, extension: &str) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    let mut found =
        entries.filter(|path| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension)));
    let first = found.next()?;
    found.next().is_none().then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skeleton_beside_a_motion_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str| std::fs::write(folder.path().join(name), "").unwrap();
        let find = |name: &str, format| {
            let found = companion_beside(&folder.path().join(name), format)?;
            Some(found.file_name().unwrap().to_str().unwrap().to_string())
        };
        assert_eq!(find("35_01.amc", Format::Amc), None);
        put("walker.ASF");
        assert_eq!(find("35_01.amc", Format::Amc).as_deref(), Some("walker.ASF"));
        put("other.asf");
        assert_eq!(find("35_01.amc", Format::Amc), None, "two could be meant");
        put("35.asf");
        assert_eq!(find("35_01.amc", Format::Amc).as_deref(), Some("35.asf"));
        put("dog3d.txt");
        assert_eq!(find("dog3d_trot.txt", Format::DeepMimic).as_deref(), Some("dog3d.txt"));
        assert_eq!(find("dog3d.txt", Format::DeepMimic), None, "a file is not its own skeleton");
    }
}
