//! `inkrig retarget`: a motion on another character, with a certificate.

use super::align::{cut, motion};
use super::certificate::CertificateRecord;
use crate::bake::{self, BakeRecord, Baked};
use crate::cli::{BakeMode, ImportArgs, RetargetArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::{self, counted, fixed, json_path};
use crate::provenance::{Facts, Run};
use crate::sheet::{SheetOptions, contact_sheet};
use crate::span::seconds;
use crate::{clip_path, load, names, results};
use inkrig_formats::{ExportOptions, Format, Import, write_motion};
use inkrig_motion::retarget::{
    Certificate, CertificateLimits, RetargetError, RetargetOptions, retarget, standing_pose,
};
use inkrig_motion::{Clip, time};
use serde::Serialize;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &RetargetArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    bake::check(&args.bake)?;
    let format = results::format_of(&args.out)?;
    check_names(args, run)?;
    let mut warnings = Vec::new();
    let import = motion(&args.motion, &args.import, console, &mut warnings)?;
    let character = motion(&args.onto, &ImportArgs::default(), console, &mut warnings)?;
    let name = name(&import, &args.motion);
    let mut clip = cut(import.clip, &args.motion, args.range)?;
    if let Some(rate) = args.fps {
        // Before anything is carried over: what is measured is what is written.
        clip = time::resample(&clip, rate)?;
    }
    let stage = console.stage("carrying the motion over");
    let (baked, certificate) = carry_over(args, &clip, &character, format)?;
    let broken = certificate.broken(&CertificateLimits::default());
    let certificate = CertificateRecord::of(&certificate, &broken);
    let refused = args.strict && !broken.is_empty();
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    if !refused {
        let options = ExportOptions {
            name: Some(name),
            keys: baked.keys.clone(),
            ..ExportOptions::in_format(format, &character.source)
        };
        let written = write_motion(&baked.clip, format, &options)?;
        for warning in load::warnings(&written.findings, &args.out) {
            console.warn(&warning);
            warnings.push(warning);
        }
        files.push((&args.out, written.bytes));
        if let Some(path) = &args.sheet {
            files.push((path, contact_sheet(&baked.clip, &SheetOptions::default())?));
        }
    }
    let record = Record::of(args, &baked.clip, (certificate, baked.record), !refused, warnings);
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

fn carry_over(
    args: &RetargetArgs,
    clip: &Clip,
    character: &Import,
    format: Format,
) -> Result<(Baked, Certificate), CliError> {
    let options = RetargetOptions {
        scale: args.scale.map(|scale| scale as f32),
        keep_feet: !args.no_keep_feet,
        stance: standing_pose(&character.clip),
    };
    let about = |cause: RetargetError| {
        let path = match cause {
            RetargetError::Target(_) | RetargetError::NoLegs("character") => &args.onto,
            _ => &args.motion,
        };
        CliError::Retarget { path: path.clone(), cause: Box::new(cause) }
    };
    let mut moved = retarget(clip, character.clip.skeleton(), &options).map_err(about)?;
    let baked = bake::bake(moved.clip.clone(), &args.bake, &[], (format, &character.source))?;
    // Poses that are held are meant to stay behind, and are not measured.
    if args.bake.bake != BakeMode::Stepped {
        moved.clip = baked.clip.clone();
    }
    let certificate = Certificate::of(clip, &moved).map_err(about)?;
    Ok((baked, certificate))
}

/// What the clip is called in a file that names its clips.
fn name(import: &Import, path: &Path) -> String {
    let own = import.clip_index.and_then(|index| import.clips.get(index)).map(|clip| clip.name.clone());
    own.or_else(|| Some(path.file_stem()?.to_string_lossy().into_owned())).unwrap_or_default()
}

/// Says before any work whether the results can be written, each to a file of its own.
fn check_names(args: &RetargetArgs, run: &Run<'_>) -> Result<(), CliError> {
    let places = || {
        let more = [&args.report, &args.sheet].into_iter().flatten().map(PathBuf::as_path);
        std::iter::once(args.out.as_path()).chain(more)
    };
    let inputs = [&args.motion, &args.onto].map(|path| clip_path::split(path).0);
    // One file may be both motion and character.
    for input in &inputs {
        names::all_differ(std::iter::once(input.as_path()).chain(places()))?;
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
    certificate: CertificateRecord,
    warnings: Vec<String>,
}

impl Record {
    fn of(
        args: &RetargetArgs,
        clip: &Clip,
        (certificate, bake): (CertificateRecord, Option<BakeRecord>),
        written: bool,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            motion: json_path(&args.motion),
            character: json_path(&args.onto),
            output: json_path(&args.out),
            written,
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: seconds(clip),
            keep_feet: !args.no_keep_feet,
            bake,
            certificate,
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
