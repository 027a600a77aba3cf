//! A storyboard for whoever the examples are of, when that is no person.

use super::examples::Examples;
use super::making::{exactness, wrong};
use super::onto::Character;
use super::record::{ExampleRecord, exact_name};
use super::scene::Scene;
use super::{Results, finish, sheet, video};
use crate::cli::{EngineArg, StoryboardArgs};
use crate::commands::certificate::CertificateRecord;
use crate::console::Console;
use crate::error::CliError;
use crate::printable::{self, counted, fixed, json_path};
use crate::provenance::{Facts, PROGRAM, Run};
use crate::span::seconds;
use crate::{load, results};
use inkrig_formats::{ExportOptions, write_motion};
use inkrig_motion::ground::Contacts;
use inkrig_sketch::storyboard::Storyboard;
use inkrig_storyboard::{Creature, CreatureFrame, creature, read_creature};
use serde::Serialize;
use std::path::Path;

/// What `--report` and `--json` hold; lengths are metres.
#[derive(Serialize)]
struct Record {
    program: &'static str,
    storyboard: String,
    engine: &'static str,
    exact: &'static str,
    output: String,
    seconds: f64,
    frame_rate: f64,
    frames: usize,
    parts: Vec<Part>,
    /// Mean step of a standing foot from frame to frame, millimetres; `null` where none stands.
    slide_mm: Option<f64>,
    certificate: Option<CertificateRecord>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Part {
    word: String,
    begins: usize,
    frames: usize,
    /// Joints that have a way.
    trajectories: Vec<String>,
    /// Mean and largest distance on the picture before ways were met.
    sampled: [f32; 2],
    /// The same in the animation.
    result: [f32; 2],
    /// How large the drawing was taken to be.
    metres_per_unit: Option<f32>,
    example: ExampleRecord,
}

/// Makes it, and writes all that was asked for.
///
/// # Errors
/// When options ask for what only people have, a frame cannot be understood, or nothing can be written.
pub(super) fn run(
    args: &StoryboardArgs,
    run: &Run<'_>,
    console: &Console,
    (board, examples): (&Storyboard, &Examples),
    mut warnings: Vec<String>,
) -> Result<(), CliError> {
    let others = "examples that are no person's";
    if args.engine == EngineArg::Both {
        return Err(CliError::NoEffect { flag: "--engine both", with: others });
    }
    let given =
        [(args.preview.is_some(), "--preview"), (args.clips, "--clips"), (args.lock_ends, "--lock-ends")];
    for (given, flag) in given {
        if given {
            return Err(CliError::NoEffect { flag, with: others });
        }
    }
    let format = results::format_of(&args.out)?;
    let wrong = wrong(&args.board);
    let read: Vec<CreatureFrame> = board
        .frames
        .iter()
        .enumerate()
        .map(|(at, frame)| read_creature(frame, at + 1, &examples.library))
        .collect::<Result<_, _>>()
        .map_err(&wrong)?;
    let stage = console.stage("looking through the examples, and meeting the lines");
    let made = creature(&examples.library, &read, &exactness(args.exact)).map_err(&wrong)?;
    drop(stage);
    warnings.extend(
        read.iter()
            .enumerate()
            .flat_map(|(at, frame)| frame.notes.iter().map(move |note| format!("frame {}: {note}", at + 1))),
    );
    let name = if board.title.is_empty() { "storyboard" } else { &board.title };
    let (written, certificate) = match &args.onto {
        Some(character) => {
            let character = Character::read(character, console, &mut warnings)?;
            let (moved, certificate) = character.carry(&made.clip)?;
            (write_motion(&moved, format, &character.export(format, name))?, Some(certificate))
        }
        None => {
            let export = ExportOptions {
                name: Some(name.to_owned()),
                ..ExportOptions::in_format(format, &examples.first.source)
            };
            (write_motion(&made.clip, format, &export)?, None)
        }
    };
    warnings.extend(load::warnings(&written.findings, &args.out));
    let scene = Scene::of_creature(board, &read, &made);
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    if let Some(path) = &args.sheet {
        files.push((path, sheet::of_scene(&scene)?));
    }
    if let Some(path) = &args.video {
        files.push((path, video::video(path, &scene, console, &mut warnings)?));
    }
    let record = Record::of(args, &read, &made, certificate, warnings);
    if let Some(path) = &args.report {
        files.push((path, serde_json::to_vec_pretty(&record)?));
    }
    record.warnings.iter().for_each(|warning| console.warn(warning));
    let inputs = [args.board.clone()];
    let facts = Facts::of_files(&inputs);
    let results = Results { motion: &written.bytes, facts: &facts, beside: &files };
    finish(args, run, &results, (record.text(), &record), console)
}

impl Record {
    fn of(
        args: &StoryboardArgs,
        read: &[CreatureFrame],
        made: &Creature,
        certificate: Option<CertificateRecord>,
        mut warnings: Vec<String>,
    ) -> Self {
        let skeleton = made.clip.skeleton();
        let name =
            |joint: usize| skeleton.joints().get(joint).map(|joint| joint.name.clone()).unwrap_or_default();
        let parts: Vec<Part> = read
            .iter()
            .zip(&made.parts)
            .map(|(frame, part)| Part {
                word: frame.word.clone(),
                begins: part.begins,
                frames: part.frames,
                trajectories: frame.ways.iter().map(|way| name(way.joint)).collect(),
                sampled: part.before,
                result: part.after,
                metres_per_unit: part.metres_per_unit,
                example: ExampleRecord::of(&part.retrieved),
            })
            .collect();
        for (at, (frame, part)) in read.iter().zip(&made.parts).enumerate() {
            if part.retrieved.word >= 1.0 && !frame.word.is_empty() {
                warnings.push(format!(
                    "frame {}: no example is of {:?}; the nearest, {}, was taken. Names of files and clips, and words.csv, say what clips are of",
                    at + 1,
                    frame.word,
                    part.retrieved.example
                ));
            }
            if args.exact == crate::cli::ExactArg::Pin && part.after[1] > 0.01 * skeleton.extent() {
                warnings.push(format!(
                    "frame {}: lines are missed by up to {} cm: a limb does not reach so far",
                    at + 1,
                    fixed(100.0 * f64::from(part.after[1]), 1)
                ));
            }
        }
        Self {
            program: PROGRAM,
            storyboard: json_path(&args.board),
            engine: "example",
            exact: exact_name(args.exact),
            output: json_path(&args.out),
            seconds: seconds(&made.clip),
            frame_rate: made.clip.frame_rate(),
            frames: made.clip.frames(),
            parts,
            slide_mm: Contacts::of(&made.clip).slide(&made.clip).map(|slide| slide.mean_step_mm),
            certificate,
            warnings,
        }
    }

    fn text(&self) -> String {
        let mut text = format!(
            "wrote {}: {} s, {}; from examples",
            printable::text(&self.output),
            fixed(self.seconds, 1),
            counted(self.frames, "frame")
        );
        for (at, part) in self.parts.iter().enumerate() {
            let word = if part.word.is_empty() { "(no word)" } else { &part.word };
            text += &format!("\n  {} {}: {}", at + 1, printable::text(word), counted(part.frames, "frame"));
            if !part.trajectories.is_empty() {
                let [mean, most] = part.result.map(|miss| fixed(100.0 * f64::from(miss), 1));
                let joints = printable::text(part.trajectories.join(", ")).to_string();
                text += &format!(", way of {joints}; {mean} cm off the drawing, {most} at most");
            }
            text += &format!("; from {}", part.example.text());
        }
        if let Some(slide) = self.slide_mm {
            text += &format!("\n  standing feet slide {} mm a frame", fixed(slide, 1));
        }
        if let Some(certificate) = &self.certificate {
            text += "\n";
            text += &certificate.text();
        }
        text
    }
}
