//! From folders of motion to a corpus.

use super::check::Rejected;
use super::clip::{Prepared, body, prepare, prepare_joints};
use super::config::{Config, Split};
use super::files::{self, Form, MotionFile};
use super::manifest::{Entry, Manifest, RejectedEntry};
use super::part::{Part, VERSION};
use super::place;
use super::report;
use super::statistics::CorpusStatistics;
use super::table;
use crate::TrainError;
use inkrig_formats::{
    ClipChoice, Format, Import, ImportOptions, companion_beside, read_in_folder, read_motion,
};
use inkrig_generate::text::{VERBS, actions_in, mirrored};
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{self, Moments, Offsets, Statistics};
use rayon::prelude::*;
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::io::{Read as _, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A share of the work, for several machines: the files whose place in the list, divided by `count`, leaves `index` - 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1.
    pub index: usize,
    /// Of how many.
    pub count: usize,
}

impl Shard {
    /// All of it.
    pub const ALL: Self = Self { index: 1, count: 1 };
}

/// How far a build is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'a> {
    /// Files that are done, this one among them.
    pub done: usize,
    /// Files in all.
    pub total: usize,
    /// The file that was done last.
    pub file: &'a str,
    /// Whether its part was there already.
    pub kept: bool,
}

/// A corpus that is complete.
#[derive(Debug, Clone, PartialEq)]
pub struct Built {
    /// Its clips.
    pub manifest: Manifest,
    /// What was left out.
    pub rejected: Vec<RejectedEntry>,
    /// Means and deviations of the training split.
    pub statistics: CorpusStatistics,
}

/// Makes the parts of a shard in `folder`; of the whole, the lists and the page as well. Works with `threads` threads (0: one a
/// core), from which `progress` is called; the result does not depend on them.
///
/// # Errors
/// When the configuration's folders cannot be read, `folder` holds something else or a corpus of other sources, or no clip is usable. What is wrong with a
/// motion file stands in the corpus and is no error.
pub fn build(
    config: &Config,
    folder: &Path,
    shard: Shard,
    threads: usize,
    progress: &(dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync),
) -> Result<Option<Built>, TrainError> {
    if shard.index == 0 || shard.index > shard.count {
        return Err(TrainError::Shard { index: shard.index, count: shard.count });
    }
    let files = files::find(config)?;
    place::check_sources(config, &files, folder)?;
    let target = target(config, &files)?;
    place::open(folder, shard)?;
    let own: Vec<&MotionFile> = files
        .iter()
        .enumerate()
        .filter(|(place, _)| place % shard.count + 1 == shard.index)
        .map(|(_, file)| file)
        .collect();
    let done = AtomicUsize::new(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| TrainError::Threads(error.to_string()))?;
    let each = |file: &&MotionFile| {
        let kept = make(config, file, &target, folder)?;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        let flow = progress(Progress { done, total: own.len(), file: &file.name, kept });
        if flow.is_break() { Err(TrainError::Stopped) } else { Ok(()) }
    };
    pool.install(|| own.par_iter().try_for_each(each))?;
    if shard.count > 1 { Ok(None) } else { finish(config, folder).map(Some) }
}

/// Writes the lists, the statistics and the page of a corpus whose parts are all there.
///
/// # Errors
/// When a part is missing or not readable, or no clip is usable.
pub fn finish(config: &Config, folder: &Path) -> Result<Built, TrainError> {
    let files = files::find(config)?;
    place::check_sources(config, &files, folder)?;
    place::check_parts(config, &files, folder)?;
    let target = target(config, &files)?;
    let (mut entries, mut rejected) = (Vec::new(), Vec::new());
    for file in &files {
        list(config, file, folder, &mut entries, &mut rejected)?;
    }
    write_lines(&folder.join("manifest.jsonl"), &entries)?;
    write_lines(&folder.join("rejected.jsonl"), &rejected)?;
    let page = folder.join("report.html");
    write(&page, report::page(config, &entries, &rejected).as_bytes())?;
    if !entries.iter().any(|entry| entry.split == Split::Train) {
        return Err(TrainError::Nothing { report: page });
    }
    let manifest = Manifest::read(folder)?;
    let statistics = statistics(&manifest, &target)?;
    let json = serde_json::to_vec(&statistics).unwrap_or_default();
    write(&folder.join(super::statistics::FILE), &json)?;
    place::forget_shares(folder)?;
    Ok(Built { manifest, rejected, statistics })
}

/// The body that everybody gets.
fn target(config: &Config, files: &[MotionFile]) -> Result<Offsets, TrainError> {
    let of = |path: &Path, form: &Form, file: Option<&MotionFile>| {
        let input = Input::read(config, path, form, file)?;
        match form {
            Form::Motion(format) => body(&input.import(*format, None)?.clip),
            Form::Table(table) => table.body(&input.bytes, config.least_frames),
        }
    };
    let Some(path) = &config.body else {
        let usable = files.iter().filter(|file| file.set_aside.is_none() && file.split == Split::Train);
        let found = usable.into_iter().find_map(|file| of(&file.path, &file.form, Some(file)).ok());
        return found.ok_or_else(|| TrainError::Content {
            path: PathBuf::from("corpus"),
            what: "no motion file of the training split has a human body that could be everybody's".into(),
        });
    };
    let content = |what: String| TrainError::Content { path: path.clone(), what };
    let file = files.iter().find(|file| file.path == *path);
    let by_name = || Format::from_extension(path.extension()?.to_str()?).map(Form::Motion);
    let form = file.map(|file| file.form.clone()).or_else(by_name);
    let form = form.ok_or_else(|| content("is no motion file by its name".into()))?;
    of(path, &form, file).map_err(|why| content(why.to_string()))
}

/// The bytes that a part is made of.
struct Input {
    bytes: Vec<u8>,
    form: Form,
    folder: PathBuf,
    options: ImportOptions,
}

impl Input {
    fn read(config: &Config, path: &Path, form: &Form, file: Option<&MotionFile>) -> Result<Self, Rejected> {
        let mut options = ImportOptions { frame_rate: None, ..ImportOptions::default() };
        let unreadable = |error: std::io::Error| Rejected::Unreadable(error.to_string());
        let folder = path.parent().unwrap_or(Path::new(".")).to_path_buf();
        let Form::Motion(format) = *form else {
            let bytes = bytes(path, table::MOST_BYTES).map_err(unreadable)?;
            return Ok(Self { bytes, form: form.clone(), folder, options });
        };
        if matches!(format, Format::Amc | Format::DeepMimic) {
            let given = file.and_then(|file| config.sources.get(file.source)?.skeleton.clone());
            let skeleton = companion_beside(path, format).or(given);
            options.skeleton =
                skeleton.map(|path| bytes(&path, options.limits.bytes)).transpose().map_err(unreadable)?;
        }
        if format == Format::Amc {
            options.frame_rate = file.and_then(|file| file.frame_rate);
        }
        let bytes = bytes(path, options.limits.bytes).map_err(unreadable)?;
        Ok(Self { bytes, form: form.clone(), folder, options })
    }

    fn import(&self, format: Format, clip: Option<usize>) -> Result<Import, Rejected> {
        let clip = clip.map(|index| ClipChoice::Number(index + 1));
        let options = ImportOptions { clip, ..self.options.clone() };
        let files = |name: &str, most: usize| read_in_folder(&self.folder, name, most);
        read_motion(&self.bytes, format, &options, &files)
            .map_err(|error| Rejected::Unreadable(error.to_string()))
    }

    fn key(&self, config: &Config, target: &Offsets) -> String {
        let mut hash = Sha256::new();
        let mut add = |bytes: &[u8]| {
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        add(&VERSION.to_le_bytes());
        add(env!("CARGO_PKG_VERSION").as_bytes());
        add(&(config.least_frames as u64).to_le_bytes());
        add(&target.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes).collect::<Vec<u8>>());
        add(&self.options.frame_rate.unwrap_or(0.0).to_le_bytes());
        add(self.options.skeleton.as_deref().unwrap_or_default());
        if let Form::Table(table) = &self.form {
            add(&table.key());
        }
        add(&self.bytes);
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Makes the part of a file, unless it is there already; says whether it was.
fn make(config: &Config, file: &MotionFile, target: &Offsets, folder: &Path) -> Result<bool, TrainError> {
    if file.set_aside.is_some() {
        return Ok(true);
    }
    let path = folder.join(part_name(config, file));
    let input = Input::read(config, &file.path, &file.form, Some(file));
    let key = input.as_ref().map_or_else(ToString::to_string, |input| input.key(config, target));
    if Part::key_of(&path).as_deref() == Some(&key) {
        return Ok(true);
    }
    let part = Part::new(key, clips(input, file, target, config.least_frames));
    let content = |what| TrainError::Content { path: path.clone(), what };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|cause| TrainError::File { path: folder.to_path_buf(), cause })?;
    }
    write(&path, &part.to_bytes().map_err(content)?)?;
    Ok(false)
}

type NamedClip = (Option<String>, Result<Prepared, Rejected>);

/// All clips of a file.
fn clips(
    input: Result<Input, Rejected>,
    file: &MotionFile,
    target: &Offsets,
    least_frames: usize,
) -> Vec<NamedClip> {
    let format = match &file.form {
        Form::Motion(format) => *format,
        Form::Table(table) => {
            let joints = input.and_then(|input| table.joints(&input.bytes));
            let clip = joints.and_then(|joints| prepare_joints(&joints, target, least_frames));
            return vec![(file.part.clone(), clip)];
        }
    };
    let first = input.and_then(|input| input.import(format, None).map(|import| (input, import)));
    let (input, first) = match first {
        Ok(read) => read,
        Err(why) => return vec![(None, Err(why))],
    };
    if first.clips.is_empty() {
        return vec![(None, prepare(&first.clip, target, least_frames))];
    }
    let one = |index: usize| {
        let import = input.import(format, Some(index))?;
        prepare(&import.clip, target, least_frames)
    };
    first.clips.iter().enumerate().map(|(index, clip)| (Some(clip.name.clone()), one(index))).collect()
}

/// Adds the entries of a file's part.
fn list(
    config: &Config,
    file: &MotionFile,
    folder: &Path,
    entries: &mut Vec<Entry>,
    rejected: &mut Vec<RejectedEntry>,
) -> Result<(), TrainError> {
    let Some(source) = config.sources.get(file.source) else { return Ok(()) };
    let left_out = |clip: Option<String>, kind: String, why: String| RejectedEntry {
        source: source.name.clone(),
        file: file.name.clone(),
        clip,
        kind,
        why,
    };
    if let Some(why) = &file.set_aside {
        rejected.push(left_out(file.part.clone(), why.kind().into(), why.to_string()));
        return Ok(());
    }
    let part = part_name(config, file);
    let (clips, bad) = Part::list(&folder.join(&part))?;
    for (index, clip) in clips.into_iter().enumerate() {
        let text = file.text.clone().or_else(|| clip.name.clone()).unwrap_or_default();
        let actions =
            actions_in(&text).into_iter().filter_map(|verb| Some(VERBS.get(verb)?.name.to_string()));
        entries.push(Entry {
            part: part.clone(),
            index,
            source: source.name.clone(),
            file: file.name.clone(),
            clip: clip.name,
            subject: file.subject.clone(),
            split: file.split,
            licence: source.licence.clone(),
            frames: clip.frames,
            actions: actions.collect(),
            mirrored_text: mirrored(&text),
            text,
            key_poses: clip.key_poses,
        });
    }
    rejected.extend(bad.into_iter().map(|(clip, kind, why)| left_out(clip, kind, why)));
    Ok(())
}

/// Means and deviations over the training split, one part in memory at a time.
fn statistics(manifest: &Manifest, target: &Offsets) -> Result<CorpusStatistics, TrainError> {
    let (mut features, mut joints) = (Moments::default(), Moments::default());
    for (path, entries) in manifest.parts(Split::Train) {
        let content = |error: inkrig_motion::MotionError| TrainError::Content {
            path: path.clone(),
            what: error.to_string(),
        };
        for clip in Manifest::read_part(&path, entries)?.clips {
            for table in [&clip.prepared.features, &clip.prepared.mirrored] {
                features.add(table).map_err(content)?;
                let places = humanml::recover_positions(table).map_err(content)?;
                let places = places.iter().flatten().flat_map(Vec3::to_array).collect();
                joints.add(&Features::new(places, 3 * humanml::JOINTS).map_err(content)?).map_err(content)?;
            }
        }
    }
    let content = |error: inkrig_motion::MotionError| TrainError::Content {
        path: PathBuf::from("statistics"),
        what: error.to_string(),
    };
    let (features, joints) = (features.statistics().map_err(content)?, joints.statistics().map_err(content)?);
    let numbers = |of: &Statistics| (of.mean().to_vec(), of.deviation().to_vec());
    let ((mean, deviation), (joint_mean, joint_deviation)) = (numbers(&features), numbers(&joints));
    let body = target.iter().map(Vec3::to_array).collect();
    Ok(CorpusStatistics { mean, deviation, joint_mean, joint_deviation, body })
}

/// Where a file's part lies: names of files are no names of ours, so that `..` or a colon in them does nothing.
pub(super) fn part_name(config: &Config, file: &MotionFile) -> String {
    let source = config.sources.get(file.source).map_or("", |source| source.name.as_str());
    let plain: String = file
        .name
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() || letter == '-' { letter } else { '_' })
        .collect();
    // A name has no NUL: parts of a file and files are never taken for each other.
    let part = file.part.as_ref().map(|part| format!("\0{part}")).unwrap_or_default();
    let hash = Sha256::digest(format!("{}{part}", file.name).as_bytes());
    let short: String = hash.iter().take(4).map(|byte| format!("{byte:02x}")).collect();
    let shown: String = plain.chars().take(80).collect();
    format!("parts/{source}/{shown}-{short}.safetensors")
}

fn bytes(path: &Path, most: usize) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(most as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > most {
        return Err(std::io::Error::new(
            std::io::ErrorKind::InvalidData,
            format!("is larger than {most} bytes"),
        ));
    }
    Ok(bytes)
}

/// Writes a file beside its place and moves it there.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // Temporary files are private; results are ordinary files, within the user's umask.
    #[cfg(unix)]
    builder.permissions(<std::fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

fn write_lines<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), TrainError> {
    let mut text = Vec::new();
    for row in rows {
        let content = |error: serde_json::Error| TrainError::Content {
            path: path.to_path_buf(),
            what: error.to_string(),
        };
        serde_json::to_writer(&mut text, row).map_err(content)?;
        text.push(b'\n');
    }
    write(path, &text)
}
