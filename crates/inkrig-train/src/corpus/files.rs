//! The motion files of a corpus, and what is known of each before it is read.

use super::check::Rejected;
use super::config::{Config, Source, SourceFormat, Split, TextFrom};
use super::humanml_folder;
use super::index::Index;
use super::table::{Rows, Table};
use super::walk::{Found, walk};
use crate::TrainError;
use inkrig_formats::Format;
use std::borrow::Cow;
use std::path::PathBuf;

/// A motion file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MotionFile {
    /// Place of its source in the configuration.
    pub source: usize,
    pub path: PathBuf,
    /// The path within the source's folder, parts set apart by `/`.
    pub name: String,
    pub form: Form,
    /// The part of it that is a clip of its own.
    pub part: Option<String>,
    pub subject: String,
    /// Why it is not used, where that is known before it is read.
    pub set_aside: Option<Rejected>,
    pub split: Split,
    /// Frames a second, for files that do not say.
    pub frame_rate: Option<f64>,
    /// What is done in it; `None` where the names of its clips say it.
    pub text: Option<String>,
}

/// How a file is read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    Motion(Format),
    Table(Table),
}

/// All files of all sources, in the order of the configuration and of their names.
///
/// # Errors
/// When a folder cannot be read, no file of it fits, or nobody in it is called as a subject is.
pub(super) fn find(config: &Config) -> Result<Vec<MotionFile>, TrainError> {
    let mut all = Vec::new();
    for (place, source) in config.sources.iter().enumerate() {
        let index = source.index.as_deref().map(Index::read).transpose()?.unwrap_or_default();
        if source.format == SourceFormat::HumanMl3d {
            all.extend(humanml_folder::find(place, source, &index)?);
            continue;
        }
        let found = walk(&source.folder)?;
        all.extend(found.into_iter().filter_map(|found| motion_file(place, source, &index, found)));
    }
    Ok(all)
}

fn motion_file(place: usize, source: &Source, index: &Index, found: Found) -> Option<MotionFile> {
    let Found { path, mut problem, is_folder } = found;
    let extension = path.extension().map(|extension| extension.to_string_lossy().into_owned());
    let extension = extension.unwrap_or_default();
    let format = Format::from_extension(&extension);
    let is_table = ["npy", "npz"].iter().any(|own| extension.eq_ignore_ascii_case(own));
    // Joints lie beside much that is none; elsewhere a table is something that was meant to be read.
    if !is_folder && !is_table && (format.is_none() || source.format == SourceFormat::Joints) {
        return None;
    }
    let within = path.strip_prefix(&source.folder).ok()?;
    if within.to_str().is_none() {
        problem = problem.or(Some("its name is not UTF-8: give it another"));
    }
    let parts: Vec<Cow<'_, str>> = within.iter().map(|part| part.to_string_lossy()).collect();
    let name = parts.join("/");
    // A character of DeepMimic ends as its motions do: its readers tell them apart, but it is no motion.
    if !wanted(source, &name) {
        return None;
    }
    let row = index.row(&path).cloned().unwrap_or_default();
    let folder = parts.iter().rev().nth(1);
    let first = if parts.len() > 1 { parts.first() } else { None };
    let subject =
        row.subject.or_else(|| first.map(ToString::to_string)).unwrap_or_else(|| source.name.clone());
    let stem = path.file_stem()?.to_string_lossy().into_owned();
    let many_clips = matches!(format, Some(Format::Glb | Format::Gltf | Format::Vrm | Format::Vrma));
    let text = match source.text {
        TextFrom::Best if row.text.is_some() => row.text,
        _ if source.words.is_some() => source.words.clone(),
        TextFrom::Best if many_clips => None,
        TextFrom::Best | TextFrom::FileName => Some(stem),
        TextFrom::Folder => Some(folder.map_or_else(|| source.name.clone(), ToString::to_string)),
        TextFrom::Nothing => Some(String::new()),
    };
    let (split, mut set_aside) = split_of(source, &subject, row.split);
    if is_table && source.format == SourceFormat::Motion {
        let what = "it is a table of NumPy: give its [[source]] format = \"joints\", or \"humanml3d\" for a folder of HumanML3D";
        set_aside.get_or_insert(Rejected::Unreadable(what.into()));
    }
    if let Some(problem) = problem {
        set_aside.get_or_insert(Rejected::Unreadable(problem.into()));
    }
    let frame_rate = row.frame_rate.or(source.frame_rate);
    let table = || Form::Table(Table { rows: Rows::Joints, frame_rate, up: source.up, span: None });
    Some(MotionFile {
        source: place,
        name,
        form: format.map_or_else(table, Form::Motion),
        part: None,
        subject,
        set_aside,
        split,
        frame_rate,
        text,
        path,
    })
}

/// Whether a file is to be taken, by its path within the source's folder.
pub(super) fn wanted(source: &Source, name: &str) -> bool {
    let holds = |patterns: &[String]| patterns.iter().any(|pattern| name.contains(pattern.as_str()));
    (source.include.is_empty() || holds(&source.include)) && !holds(&source.exclude)
}

/// The split of a clip, where a list may name one or say why it is none.
pub(super) fn split_of(
    source: &Source,
    subject: &str,
    listed: Option<Result<Split, String>>,
) -> (Split, Option<Rejected>) {
    let by_subject = source.subjects.get(subject).copied();
    match listed {
        Some(Ok(split)) => (by_subject.unwrap_or(split), None),
        Some(Err(word)) => (Split::Train, Some(Rejected::SetAside(word))),
        None => (by_subject.unwrap_or(source.split), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_folder_index_and_subject() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        put("data/07/07_01.bvh", "");
        put("data/07/notes.md", "");
        put("data/35/35_02.amc", "");
        put("data/WaveHand.bvh", "");
        put("data/raw/x.bvh", "");
        put("index.csv", "file,split,fps,description\n35_02.amc,duplicate,60,run\n");
        put(
            "corpus.toml",
            "[[source]]\nname='d'\nfolder='data'\nlicence='free'\nindex='index.csv'\nexclude=['raw/']\nsplit='val'\n\
             [source.subjects]\n07='test'\n",
        );
        let config = Config::read(&folder.path().join("corpus.toml")).unwrap();
        let files = find(&config).unwrap();
        let seen: Vec<_> = files
            .iter()
            .map(|file| (file.name.as_str(), file.subject.as_str(), file.split, file.text.as_deref()))
            .collect();
        assert_eq!(
            seen,
            [
                ("07/07_01.bvh", "07", Split::Test, Some("07_01")),
                ("35/35_02.amc", "35", Split::Train, Some("run")),
                ("WaveHand.bvh", "d", Split::Val, Some("WaveHand")),
            ]
        );
        assert_eq!(files[1].set_aside, Some(Rejected::SetAside("duplicate".into())));
        assert_eq!(files[1].frame_rate, Some(60.0));

        let fails = |change: &dyn Fn(&mut Source)| {
            let mut config = config.clone();
            change(&mut config.sources[0]);
            find(&config).unwrap_err().to_string()
        };
        let said = fails(&|source| _ = source.subjects.insert("cmu07".into(), Split::Test));
        assert!(said.contains("names `cmu07`") && said.contains("there are `07`, `35`, `d`"), "{said}");
        let said = fails(&|source| source.include = vec!["*.bvh".into()]);
        assert!(said.contains("none of 4 motion files fits the source `d`"), "{said}");
        put("empty/notes.md", "");
        let said = fails(&|source| source.folder = folder.path().join("empty"));
        assert!(said.contains("no motion file (BVH"), "{said}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_once_and_what_is_no_file_is_said() {
        use std::os::unix::ffi::OsStrExt as _;
        use std::os::unix::fs::symlink;
        let desk = tempfile::tempdir().unwrap();
        let at = |name: &str| desk.path().join(name);
        std::fs::create_dir_all(at("data/ann")).unwrap();
        std::fs::create_dir_all(at("far")).unwrap();
        std::fs::write(at("data/ann/walk.bvh"), "").unwrap();
        std::fs::write(at("far/run.bvh"), "").unwrap();
        std::fs::write(at("data").join(std::ffi::OsStr::from_bytes(b"jump\xff.bvh")), "").unwrap();
        symlink(at("far"), at("data/linked")).unwrap();
        symlink(at("data"), at("data/ann/circle")).unwrap();
        symlink(at("far/run.bvh"), at("data/run.bvh")).unwrap();
        symlink(at("nowhere"), at("data/lost.bvh")).unwrap();
        let _socket = std::os::unix::net::UnixListener::bind(at("data/socket.bvh")).unwrap();
        std::fs::write(at("corpus.toml"), "[[source]]\nname='d'\nfolder='data'\nlicence='free'\n").unwrap();
        let files = find(&Config::read(&at("corpus.toml")).unwrap()).unwrap();
        let seen: Vec<_> = files
            .iter()
            .map(|file| {
                let why = file.set_aside.as_ref().map(ToString::to_string).unwrap_or_default();
                (file.name.as_str(), why.trim_start_matches("cannot be read: ").to_string())
            })
            .collect();
        let expected = [
            ("ann/circle", "it is a link to a folder that is read already"),
            ("ann/walk.bvh", ""),
            ("jump\u{fffd}.bvh", "its name is not UTF-8: give it another"),
            ("linked/run.bvh", ""),
            ("lost.bvh", "it is a link that leads nowhere"),
            ("run.bvh", ""),
            ("socket.bvh", "it is no file"),
        ];
        assert_eq!(seen, expected.map(|(name, why)| (name, why.to_string())));
    }
}
