//! The motion files of a corpus, and what is known of each before it is read.

use super::check::Rejected;
use super::config::{Config, Source, SourceFormat, Split, TextFrom};
use super::humanml_folder;
use super::index::{Index, Row};
use super::table::{Rows, Table};
use super::walk::{Found, walk};
use crate::TrainError;
use inkrig_formats::Format;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

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
    /// Whether the index or `subjects` says the split.
    pub placed: bool,
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
/// When a folder cannot be read, no file of it fits, the index does not say which of two files it means, somebody is in two splits, or nobody is
/// called as a subject is.
pub(super) fn find(config: &Config) -> Result<Vec<MotionFile>, TrainError> {
    let mut all = Vec::new();
    for (place, source) in config.sources.iter().enumerate() {
        let index = source.index.as_deref().map(Index::read).transpose()?.unwrap_or_default();
        let first = all.len();
        if source.format == SourceFormat::HumanMl3d {
            all.extend(humanml_folder::find(place, source, &index)?);
        } else {
            all.extend(motion_files(place, source, &index)?);
            one_split_each(source, all.get_mut(first..).unwrap_or_default())?;
        }
        let wrong = |what: String| TrainError::Content { path: source.folder.clone(), what };
        check_subjects(source, all.get(first..).unwrap_or_default()).map_err(wrong)?;
    }
    Ok(all)
}

fn motion_files(place: usize, source: &Source, index: &Index) -> Result<Vec<MotionFile>, TrainError> {
    let walked = walk(&source.folder)?;
    let motions = walked.iter().filter(|found| looks_like_motion(source, found)).count();
    let taken: Vec<(Found, String)> = walked.into_iter().filter_map(|found| taken(source, found)).collect();
    if taken.is_empty() {
        let what = nothing_fits(source, motions);
        return Err(TrainError::Content { path: source.folder.clone(), what });
    }
    let mut alike: HashMap<&OsStr, Vec<&Path>> = HashMap::new();
    for (found, _) in &taken {
        alike.entry(found.path.file_name().unwrap_or_default()).or_default().push(&found.path);
    }
    let content = |what| TrainError::Content { path: source.index.clone().unwrap_or_default(), what };
    let mut files = Vec::new();
    for (found, name) in &taken {
        let path = &found.path;
        let others = alike.get(path.file_name().unwrap_or_default()).into_iter().flatten();
        let others: Vec<&Path> = others.copied().filter(|other| other != path).take(1).collect();
        let row = index.row(path, &others).map_err(content)?.cloned().unwrap_or_default();
        files.extend(motion_file(place, source, row, found, name));
    }
    Ok(files)
}

fn nothing_fits(source: &Source, motions: usize) -> String {
    let name = &source.name;
    if motions == 0 {
        return format!(
            "no motion file (BVH, FBX, GLB, AMC, ...) is in the folder of the source `{name}` or in those below it"
        );
    }
    format!(
        "none of {motions} motion files fits the source `{name}`: `include` takes files whose path within the folder holds one of its texts, letter for letter (no * or ?), and `exclude` leaves out those whose path holds one"
    )
}

/// A split that is said of nobody would be lost without a word.
fn check_subjects(source: &Source, files: &[MotionFile]) -> Result<(), String> {
    const SHOWN: usize = 8;
    let known: BTreeSet<&str> = files.iter().map(|file| file.subject.as_str()).collect();
    let Some(nobody) = source.subjects.keys().find(|subject| !known.contains(subject.as_str())) else {
        return Ok(());
    };
    let shown: Vec<String> = known.iter().take(SHOWN).map(|subject| format!("`{subject}`")).collect();
    let more = if known.len() > SHOWN { ", ..." } else { "" };
    Err(format!(
        "`subjects` of the source `{}` names `{nobody}`, and no file is of that subject; there are {}{more}",
        source.name,
        shown.join(", ")
    ))
}

/// Refuses a subject that is placed in two splits: what is measured on would have been learned from. Files of a subject that are not
/// placed go where its others are.
fn one_split_each(source: &Source, files: &mut [MotionFile]) -> Result<(), TrainError> {
    let mut splits: HashMap<&str, &MotionFile> = HashMap::new();
    for file in files.iter().filter(|file| file.placed) {
        let other = *splits.entry(&file.subject).or_insert(file);
        if other.split != file.split {
            let what = format!(
                "subject {} is in two splits: {} in {}, {} in {}; give all of a subject the same, here or in `subjects` of the source",
                file.subject,
                other.name,
                other.split.name(),
                file.name,
                file.split.name()
            );
            return Err(TrainError::Content { path: source.index.clone().unwrap_or_default(), what });
        }
    }
    let splits: HashMap<String, Split> =
        splits.into_iter().map(|(subject, file)| (subject.to_string(), file.split)).collect();
    for file in files.iter_mut().filter(|file| !file.placed) {
        file.split = splits.get(&file.subject).copied().unwrap_or(file.split);
    }
    Ok(())
}

/// How a file is read, by its ending.
fn form_of(source: &Source, path: &Path) -> Option<Form> {
    let extension = path.extension()?.to_string_lossy();
    let is_table = ["npy", "npz"].iter().any(|own| extension.eq_ignore_ascii_case(own));
    if is_table {
        let table = Table { rows: Rows::Joints, frame_rate: source.frame_rate, up: source.up, span: None };
        return Some(Form::Table(table));
    }
    Format::from_extension(&extension).map(Form::Motion)
}

/// Joints lie beside much that is none; elsewhere a table is something that was meant to be read.
fn looks_like_motion(source: &Source, found: &Found) -> bool {
    match form_of(source, &found.path) {
        Some(Form::Table(_)) => true,
        Some(Form::Motion(_)) => source.format != SourceFormat::Joints,
        None => false,
    }
}

/// What the source does not leave out, with its path within the source's folder.
fn taken(source: &Source, found: Found) -> Option<(Found, String)> {
    if !found.is_folder && !looks_like_motion(source, &found) {
        return None;
    }
    let within = found.path.strip_prefix(&source.folder).ok()?;
    let problem = within.to_str().is_none().then_some("its name is not UTF-8: give it another");
    let parts: Vec<Cow<'_, str>> = within.iter().map(|part| part.to_string_lossy()).collect();
    let name = parts.join("/");
    // A character of DeepMimic ends as its motions do: its readers tell them apart, but it is no motion.
    let found = Found { problem: found.problem.or(problem), ..found };
    wanted(source, &name).then_some((found, name))
}

fn motion_file(place: usize, source: &Source, row: Row, found: &Found, name: &str) -> Option<MotionFile> {
    let path = &found.path;
    let form = form_of(source, path);
    let parts: Vec<&str> = name.split('/').collect();
    let folder = parts.iter().rev().nth(1);
    let first = if parts.len() > 1 { parts.first() } else { None };
    let subject =
        row.subject.or_else(|| first.map(ToString::to_string)).unwrap_or_else(|| source.name.clone());
    let stem = path.file_stem()?.to_string_lossy().into_owned();
    let many_clips =
        matches!(form, Some(Form::Motion(Format::Glb | Format::Gltf | Format::Vrm | Format::Vrma)));
    let text = match source.text {
        TextFrom::Best if row.text.is_some() => row.text,
        _ if source.words.is_some() => source.words.clone(),
        TextFrom::Best if many_clips => None,
        TextFrom::Best | TextFrom::FileName => Some(stem),
        TextFrom::Folder => Some(folder.map_or_else(|| source.name.clone(), ToString::to_string)),
        TextFrom::Nothing => Some(String::new()),
    };
    let by_subject = source.subjects.contains_key(&subject);
    let placed = match &row.split {
        Some(said) => said.is_ok(),
        None => by_subject,
    };
    let (split, mut set_aside) = split_of(source, &subject, row.split);
    if matches!(form, Some(Form::Table(_))) && source.format == SourceFormat::Motion {
        let what = "it is a table of NumPy: give its [[source]] format = \"joints\", or \"humanml3d\" for a folder of HumanML3D";
        set_aside.get_or_insert(Rejected::Unreadable(what.into()));
    }
    if let Some(problem) = found.problem {
        set_aside.get_or_insert(Rejected::Unreadable(problem.into()));
    }
    let frame_rate = row.frame_rate.or(source.frame_rate);
    let form = match form {
        Some(Form::Table(table)) => Form::Table(Table { frame_rate, ..table }),
        Some(form) => form,
        // A folder, which is listed only with what is wrong with it.
        None => Form::Table(Table { rows: Rows::Joints, frame_rate, up: source.up, span: None }),
    };
    Some(MotionFile {
        source: place,
        name: name.to_string(),
        form,
        part: None,
        subject,
        set_aside,
        split,
        placed,
        frame_rate,
        text,
        path: path.clone(),
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
        std::fs::write(at("data").join(OsStr::from_bytes(b"jump\xff.bvh")), "").unwrap();
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

    #[test]
    fn files_named_alike_keep_their_own_rows_and_a_subject_its_split() {
        let folder = tempfile::tempdir().unwrap();
        for part in ["a", "b"] {
            std::fs::create_dir_all(folder.path().join("data").join(part)).unwrap();
            std::fs::write(folder.path().join("data").join(part).join("clip.bvh"), "").unwrap();
        }
        let source = "[[source]]\nname='d'\nfolder='data'\nlicence='free'\nindex='index.csv'\n";
        std::fs::write(folder.path().join("corpus.toml"), source).unwrap();
        let found = |rows: &str| {
            let text = format!("file,split,subject,description\n{rows}");
            std::fs::write(folder.path().join("index.csv"), text).unwrap();
            find(&Config::read(&folder.path().join("corpus.toml")).unwrap())
        };
        let files = found("a/clip.bvh,train,ann,walks\nb/clip.bvh,test,bob,jumps\n").unwrap();
        let said: Vec<_> = files
            .iter()
            .map(|file| (file.subject.as_str(), file.split, file.text.as_deref().unwrap_or_default()))
            .collect();
        assert_eq!(said, [("ann", Split::Train, "walks"), ("bob", Split::Test, "jumps")]);
        let error = found("clip.bvh,test,bob,jumps\n").unwrap_err().to_string();
        assert!(error.contains("index.csv") && error.contains("which file is meant"), "{error}");
        let error = found("a/clip.bvh,train,ann,walks\nb/clip.bvh,test,ann,jumps\n").unwrap_err().to_string();
        assert!(
            error.contains("subject ann is in two splits: a/clip.bvh in train, b/clip.bvh in test"),
            "{error}"
        );
        assert!(found("a/clip.bvh,train,ann,walks\nb/clip.bvh,duplicate,ann,walks\n").is_ok());
        // A file that the index does not place goes where its subject is.
        let files = found("a/clip.bvh,test,ann,walks\nb/clip.bvh,,ann,walks\n").unwrap();
        assert!(files.iter().all(|file| file.split == Split::Test));
    }
}
