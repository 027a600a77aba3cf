//! `inkrig retarget`: a motion on another character, with a certificate.

use super::align::{character, cut, motion};
use super::certificate::CertificateRecord;
use super::joint_map;
use crate::bake::{self, BakeRecord, Baked};
use crate::cli::{BakeMode, RetargetArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::{self, counted, fixed, json_path};
use crate::provenance::{Facts, Run};
use crate::read_back::ReadBack;
use crate::side_by_side::SideBySide;
use crate::span::seconds;
use crate::{clip_path, load, names, results};
use inkrig_formats::{ExportOptions, Format, Import, write_motion};
use inkrig_motion::retarget::{
    Certificate, CertificateLimits, RetargetError, RetargetOptions, Retargeted, retarget, standing_pose,
    suggest,
};
use inkrig_motion::{Clip, time};
use serde::Serialize;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &RetargetArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    bake::check(&args.bake)?;
    // A map is JSON; a result has the format that its name says.
    let format = if args.suggest_map { None } else { Some(results::format_of(&args.out)?) };
    format.map_or(Ok(()), |format| bake::check_format(&args.bake, format, &args.out))?;
    check_names(args, run)?;
    let mut warnings = Vec::new();
    let import = motion(&args.motion, &args.import, console, &mut warnings)?;
    if import.clip.frames() == 1 {
        let warning = format!(
            "{}: nothing moves in this file, which has one pose (without a clip that is its rest pose); the first file named is the motion, that after --onto the character",
            printable::path(&args.motion)
        );
        console.warn(&warning);
        warnings.push(warning);
    }
    let character = character(&args.onto, console, &mut warnings)?;
    let name = name(&import, &args.motion);
    let mut clip = cut(import.clip, &args.motion, args.range)?;
    if let Some(rate) = args.fps {
        // Before anything is carried over: what is measured is what is written.
        clip = time::resample(&clip, rate)?;
    }
    let job = Job { args, clip: &clip, character: &character, options: options(args, &clip, &character)? };
    let Some(format) = format else { return job.write_map(run, console) };
    let stage = console.stage("carrying the motion over");
    let (moved, baked, certificate) = job.carry_over(format)?;
    let broken = certificate.broken(&CertificateLimits::default());
    let certificate = CertificateRecord::of(&certificate, &broken);
    let refused = args.strict && !broken.is_empty();
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    let mut read_back = None;
    if !refused {
        let options = ExportOptions {
            name: Some(name.clone()),
            keys: baked.keys.clone(),
            ..ExportOptions::in_format(format, &character.source)
        };
        let written = write_motion(&baked.clip, format, &options)?;
        read_back = ReadBack::of(&written.bytes, format, &baked.clip, &options);
        // Few keys are near to the motion on purpose, and say themselves how near.
        let wrong = read_back.filter(|_| baked.keys.is_none()).and_then(|found| found.warning());
        let wrong = wrong.map(|wrong| format!("{}: {wrong}", printable::path(&args.out)));
        for warning in load::warnings(&written.findings, &args.out).into_iter().chain(wrong) {
            console.warn(&warning);
            warnings.push(warning);
        }
        files.push((&args.out, written.bytes));
    }
    let record = Record::of(args, &baked.clip, (certificate, baked.record), read_back, warnings);
    if !refused && (args.preview.is_some() || args.sheet.is_some()) {
        let pictures = SideBySide::of(&clip, &baked.clip, moved.scale)?;
        if let Some(path) = &args.preview {
            let page = pictures.page(&name, &record.certificate.figures(), &record.certificate.notes());
            files.push((path, page.into_bytes()));
        }
        if let Some(path) = &args.sheet {
            files.push((path, pictures.sheet()?));
        }
    }
    if let Some(path) = &args.report {
        // Also of a result that is refused: it says why.
        files.push((path, serde_json::to_vec_pretty(&record)?));
    }
    drop(stage);
    for (path, bytes) in &files {
        if *path == args.out {
            run.write_motion(
                path,
                bytes,
                &args.sidecar,
                &Facts::of_files(std::slice::from_ref(&args.motion)),
            )?;
        } else {
            run.write(path, bytes)?;
        }
    }
    console.say(record.text())?;
    if !refused {
        run.say(&args.out, &args.sidecar, console)?;
    }
    for (path, _) in files.iter().filter(|(path, _)| *path != args.out) {
        console.say(format!("wrote {}", printable::path(path)))?;
    }
    console.result(&record)?;
    if refused {
        return Err(CliError::Strict { path: args.out.clone(), broken: record.certificate.broken_text() });
    }
    Ok(())
}

fn options(args: &RetargetArgs, clip: &Clip, character: &Import) -> Result<RetargetOptions, CliError> {
    let map = args.map.as_deref();
    let read = |path| joint_map::read(path, clip.skeleton(), character.clip.skeleton());
    Ok(RetargetOptions {
        scale: args.scale.map(|scale| scale as f32),
        keep_feet: !args.no_keep_feet,
        stance: standing_pose(&character.clip),
        map: map.map(read).transpose()?,
    })
}

/// A motion, who shall move so, and how.
struct Job<'a> {
    args: &'a RetargetArgs,
    clip: &'a Clip,
    character: &'a Import,
    options: RetargetOptions,
}

impl Job<'_> {
    fn carry_over(&self, format: Format) -> Result<(Retargeted, Baked, Certificate), CliError> {
        let moved = retarget(self.clip, self.character.clip.skeleton(), &self.options);
        let mut moved = moved.map_err(|cause| self.about(cause))?;
        let source = &self.character.source;
        let baked = bake::bake(moved.clip.clone(), &self.args.bake, &[], (format, source))?;
        // Poses that are held are meant to stay behind, and are not measured.
        if self.args.bake.bake != BakeMode::Stepped {
            moved.clip = baked.clip.clone();
        }
        let certificate = Certificate::of(self.clip, &moved);
        Ok((moved, baked, certificate))
    }

    fn write_map(&self, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
        let character = self.character.clip.skeleton();
        let pairs = suggest(self.clip, character, &self.options).map_err(|cause| self.about(cause))?;
        run.write(&self.args.out, &joint_map::write(&pairs, self.clip.skeleton(), character)?)?;
        let record = MapRecord { output: json_path(&self.args.out), pairs: pairs.len() };
        console.say(format!(
            "wrote {}: {}; change it and give it with --map",
            printable::path(&self.args.out),
            counted(record.pairs, "pair")
        ))?;
        console.result(&record)
    }

    /// An error with the file that it is about.
    fn about(&self, cause: RetargetError) -> CliError {
        let path = match (&self.args.map, &cause) {
            (_, RetargetError::Target(_) | RetargetError::NoLegs("character")) => &self.args.onto,
            (
                Some(map),
                RetargetError::EmptyMap | RetargetError::MapJoint { .. } | RetargetError::MapTwice(_),
            ) => map,
            _ => &self.args.motion,
        };
        CliError::Retarget { path: path.clone(), cause: Box::new(cause) }
    }
}

/// What is said of a map that was written; the names are stable.
#[derive(Serialize)]
struct MapRecord {
    output: String,
    pairs: usize,
}

/// What the clip is called in a file that names its clips.
fn name(import: &Import, path: &Path) -> String {
    let own = import.clip_index.and_then(|index| import.clips.get(index)).map(|clip| clip.name.clone());
    own.or_else(|| Some(path.file_stem()?.to_string_lossy().into_owned())).unwrap_or_default()
}

/// Says before any work whether the results can be written, each to a file of its own.
fn check_names(args: &RetargetArgs, run: &Run<'_>) -> Result<(), CliError> {
    let places = || {
        let more = [&args.report, &args.preview, &args.sheet].into_iter().flatten().map(PathBuf::as_path);
        std::iter::once(args.out.as_path()).chain(more)
    };
    let inputs = [&args.motion, &args.onto].map(|path| clip_path::split(path).0);
    // One file may be both motion and character.
    for input in inputs.iter().map(PathBuf::as_path).chain(args.map.as_deref()) {
        names::all_differ(std::iter::once(input).chain(places()))?;
    }
    results::check_picture(args.sheet.as_ref())?;
    if args.suggest_map {
        results::check_ending(&args.out, "json", "a map")?;
    }
    for path in places().skip(1) {
        run.check(path)?;
    }
    run.check_motion(&args.out, &args.sidecar)
}

/// What is said of a result; the names are stable.
#[derive(Serialize)]
struct Record {
    motion: String,
    character: String,
    output: String,
    /// Whether it was written: not when it was refused.
    written: bool,
    frames: usize,
    frame_rate: f64,
    seconds: f64,
    keep_feet: bool,
    bake: Option<BakeRecord>,
    /// The map that was obeyed, where one was given.
    map: Option<String>,
    certificate: CertificateRecord,
    /// The file read again and compared, for formats that are read.
    read_back: Option<ReadBack>,
    warnings: Vec<String>,
}

impl Record {
    fn of(
        args: &RetargetArgs,
        clip: &Clip,
        (certificate, bake): (CertificateRecord, Option<BakeRecord>),
        read_back: Option<ReadBack>,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            motion: json_path(&args.motion),
            character: json_path(&args.onto),
            output: json_path(&args.out),
            written: !(args.strict && certificate.is_broken()),
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: seconds(clip),
            keep_feet: !args.no_keep_feet,
            bake,
            map: args.map.as_deref().map(json_path),
            certificate,
            read_back,
            warnings,
        }
    }

    fn text(&self) -> String {
        let first = format!(
            "{} {}: {} s, {} at {} a second\n",
            if self.written { "wrote" } else { "refused" },
            printable::text(&self.output),
            fixed(self.seconds, 1),
            counted(self.frames, "frame"),
            (self.frame_rate * 1e3).round() / 1e3
        );
        let bake = self.bake.as_ref().map(|bake| bake.note() + "\n").unwrap_or_default();
        first + &bake + &self.certificate.text()
    }
}
