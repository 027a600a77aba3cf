//! A folder of HumanML3D: `new_joint_vecs` or `new_joints`, `texts`, and lists of the splits.

use super::captions::{self, Captioned};
use super::check::Rejected;
use super::config::{Source, Split, TextFrom, Up, read_text};
use super::files::{Form, MotionFile, split_of, wanted};
use super::index::Index;
use super::table::{Rows, Table};
use crate::TrainError;
use inkrig_motion::humanml::FRAME_RATE;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// The folders of tables; where both have a clip, that of the first is taken.
const TABLES: [(&str, Rows); 2] = [("new_joint_vecs", Rows::Features), ("new_joints", Rows::Joints)];

/// Its clips by name, one for each part that has captions of its own. Mirror images are left out where their originals are
/// there: the corpus makes its own.
pub(super) fn find(place: usize, source: &Source, index: &Index) -> Result<Vec<MotionFile>, TrainError> {
    let mut tables: BTreeMap<String, (PathBuf, &str, Rows)> = BTreeMap::new();
    for (folder, rows) in TABLES {
        for (stem, path) in tables_in(&source.folder.join(folder))? {
            tables.entry(stem).or_insert((path, folder, rows));
        }
    }
    if tables.is_empty() {
        let what = "has no .npy file in new_joint_vecs or new_joints, as a folder of HumanML3D does".into();
        return Err(TrainError::Content { path: source.folder.clone(), what });
    }
    let splits = splits(&source.folder)?;
    let content = |what| TrainError::Content { path: source.index.clone().unwrap_or_default(), what };
    let mut files = Vec::new();
    for (stem, (path, folder, rows)) in &tables {
        let name = format!("{folder}/{stem}.npy");
        let is_image = stem.strip_prefix('M').is_some_and(|original| tables.contains_key(original));
        if is_image || !wanted(source, &name) {
            continue;
        }
        let row = index.row(path, &[]).map_err(content)?.cloned().unwrap_or_default();
        let subject = row.subject.unwrap_or_else(|| source.name.clone());
        let listed = row.split.or_else(|| splits.get(stem).copied().map(Ok));
        let (split, mut set_aside) = split_of(source, &subject, listed);
        let captions = captions::read(&source.folder.join("texts").join(format!("{stem}.txt")));
        let captions = captions.unwrap_or_else(|why| {
            set_aside.get_or_insert(Rejected::Unreadable(why));
            None
        });
        let nothing = || vec![Captioned { span: None, text: source.words.clone().unwrap_or_default() }];
        for clip in captions.filter(|all| !all.is_empty()).unwrap_or_else(nothing) {
            let text = match source.text {
                TextFrom::Best => row.text.clone().unwrap_or(clip.text),
                TextFrom::FileName => stem.clone(),
                TextFrom::Folder => source.name.clone(),
                TextFrom::Nothing => String::new(),
            };
            let frame_rate = Some(FRAME_RATE);
            files.push(MotionFile {
                source: place,
                path: path.clone(),
                name: name.clone(),
                form: Form::Table(Table { rows: *rows, frame_rate, up: Up::Y, span: clip.span }),
                part: clip.span.map(|(start, end)| format!("{start}-{end} s")),
                subject: subject.clone(),
                set_aside: set_aside.clone(),
                split,
                placed: true,
                frame_rate,
                text: Some(text),
            });
        }
    }
    Ok(files)
}

/// The tables of a folder by name; none when there is no such folder.
fn tables_in(folder: &Path) -> Result<Vec<(String, PathBuf)>, TrainError> {
    let failed = |cause| TrainError::File { path: folder.to_path_buf(), cause };
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().and_then(|name| name.to_str());
        let stem = name.and_then(|name| name.strip_suffix(".npy")).map(String::from);
        if let Some(stem) = stem.filter(|_| path.is_file()) {
            found.push((stem, path));
        }
    }
    Ok(found)
}

/// Splits by the names of clips, where the lists are there.
fn splits(folder: &Path) -> Result<HashMap<String, Split>, TrainError> {
    let mut splits = HashMap::new();
    // What stands in two lists is not learned from: the last counts.
    for split in Split::ALL {
        let path = folder.join(split.name()).with_extension("txt");
        if path.is_file() {
            splits.extend(read_text(&path)?.lines().map(|line| (line.trim().to_string(), split)));
        }
    }
    Ok(splits)
}
