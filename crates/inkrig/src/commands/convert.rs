//! `inkrig convert`: motion files in other formats, one or many.

use super::align::cut;
use crate::bake::{self, BakeRecord};
use crate::cli::ConvertArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::output::OutputError;
use crate::over_ground::{OverGround, OverGroundRecord};
use crate::printable::{self, counted, fixed, json_path};
use crate::provenance::{Facts, Run};
use crate::read_back::ReadBack;
use crate::span::seconds;
use crate::{clip_path, inputs, load, names, results, wildcard};
use inkrig_formats::{ExportOptions, Format, Import, write_motion};
use inkrig_motion::cycle::{LoopOptions, make_loop};
use inkrig_motion::{lead_in, time};
use serde::Serialize;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &ConvertArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    bake::check(&args.bake)?;
    let job = Job { args, over_ground: OverGround::of(&args.root)?, run, read: inputs::count() };
    let inputs = wildcard::expand(&args.inputs)?;
    match (inputs.as_slice(), args.to) {
        (_, Some(to)) => job.many(&inputs, to.format(), console),
        ([input], None) => job.one(input, console),
        (_, None) => Err(CliError::OneFolder(args.out.clone())),
    }
}

/// What is done to every file.
struct Job<'a> {
    args: &'a ConvertArgs,
    over_ground: OverGround,
    run: &'a Run<'a>,
    /// Files that were read for all.
    read: usize,
}

/// What became of a file; the names are stable.
#[derive(Serialize)]
struct Converted {
    input: String,
    output: String,
    format: &'static str,
    /// The clip of the file, where it names its clips.
    clip: Option<String>,
    joints: usize,
    frames: usize,
    frame_rate: f64,
    seconds: f64,
    metres_per_unit: f64,
    /// How many frames at the beginning are a T-pose, which is kept.
    rest_pose_frames: usize,
    root: OverGroundRecord,
    #[serde(rename = "loop")]
    looped: Option<LoopRecord>,
    bake: Option<BakeRecord>,
    /// The file read again and compared, for formats that are read.
    read_back: Option<ReadBack>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct LoopRecord {
    /// Where the round begins in the motion at the result's rate, and its frames there.
    start: usize,
    period: usize,
    /// Mean distance of the joints between its two ends before they were brought together, metres.
    apart_metres: f64,
    /// Step over the seam over the median step; about 1 where none is seen.
    seam_ratio: f64,
}

/// What became of many.
#[derive(Serialize)]
struct Batch {
    converted: Vec<Converted>,
    failed: Vec<Failure>,
}

/// A file that was not converted.
#[derive(Serialize)]
struct Failure {
    input: String,
    error: String,
}

impl Job<'_> {
    fn one(&self, input: &Path, console: &Console) -> Result<(), CliError> {
        let out = &self.args.out;
        let format = results::format_of(out)?;
        bake::check_format(&self.args.bake, format, out)?;
        let file = clip_path::split(input).0;
        names::all_differ(self.files().chain([file.as_path(), out.as_path()]))?;
        self.run.check_motion(out, &self.args.sidecar)?;
        let stage = console.stage(format!("converting {}", printable::path(input)));
        let import = load::motion(input, &self.args.import)?;
        let done = self.convert(import, input, out, format)?;
        drop(stage);
        for warning in &done.warnings {
            console.warn(warning);
        }
        console.say(done.text())?;
        self.run.say(out, &self.args.sidecar, console)?;
        console.result(&done)
    }

    fn many(&self, inputs: &[PathBuf], format: Format, console: &Console) -> Result<(), CliError> {
        let folder = &self.args.out;
        bake::check_format(&self.args.bake, format, folder)?;
        let out = |input: &PathBuf| {
            folder.join(input.file_name().unwrap_or_default()).with_extension(format.extension())
        };
        let outs: Vec<PathBuf> = inputs.iter().map(out).collect();
        names::all_differ(self.files().chain(inputs.iter().chain(&outs).map(PathBuf::as_path)))?;
        // The folder, and those above it that are made with it.
        let made: Vec<&Path> =
            folder.ancestors().take_while(|above| !above.as_os_str().is_empty() && !above.exists()).collect();
        std::fs::create_dir_all(folder).map_err(|cause| OutputError::Io { path: folder.clone(), cause })?;
        let mut batch = Batch { converted: Vec::new(), failed: Vec::new() };
        let bar = console.bar("converting");
        for (index, (input, out)) in inputs.iter().zip(&outs).enumerate() {
            if bar.at(index, inputs.len()).is_break() {
                break;
            }
            inputs::forget_after(self.read);
            let done = load::motion(input, &self.args.import).and_then(|import| {
                self.run.check_motion(out, &self.args.sidecar)?;
                self.convert(import, input, out, format)
            });
            match done {
                Ok(done) => batch.converted.push(done),
                Err(error) => {
                    batch.failed.push(Failure { input: json_path(input), error: error.to_string() });
                }
            }
        }
        if batch.converted.is_empty() {
            // What is not empty is not removed, and an empty folder that stays is no reason to stop.
            made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
        }
        bar.finish()?;
        for done in &batch.converted {
            for warning in &done.warnings {
                console.warn(warning);
            }
            console.say(done.text())?;
        }
        console.result(&batch)?;
        if batch.failed.is_empty() {
            return Ok(());
        }
        let list = batch.failed.iter().map(|failure| failure.error.as_str()).collect::<Vec<_>>().join("\n");
        Err(CliError::NotConverted { failed: batch.failed.len(), total: inputs.len(), list })
    }

    /// Files that are read beside the inputs.
    fn files(&self) -> impl Iterator<Item = &Path> {
        self.args.import.skeleton.as_deref().into_iter()
    }

    /// Makes the result and writes it.
    fn convert(
        &self,
        import: Import,
        input: &Path,
        out: &Path,
        format: Format,
    ) -> Result<Converted, CliError> {
        let args = self.args;
        // What is wrong with a motion is said of its file.
        let about = |error: CliError| match error {
            CliError::Motion(cause) => CliError::Clip { path: input.to_path_buf(), cause },
            other => other,
        };
        let mut warnings = load::warnings(&import.findings, input);
        let mut source = import.source;
        let clip_name =
            import.clip_index.and_then(|index| import.clips.get(index)).map(|clip| clip.name.clone());
        let mut clip = cut(import.clip, input, args.range)?;
        let mut rest_pose_frames = lead_in::rest_pose_frames(&clip);
        if args.cyclic.is_some() && rest_pose_frames > 0 {
            // A pose that no round comes by.
            clip = time::trim(&clip, rest_pose_frames..clip.frames()).map_err(|error| about(error.into()))?;
            rest_pose_frames = 0;
        }
        if let Some(rate) = args.fps {
            clip = time::resample(&clip, rate).map_err(|error| about(error.into()))?;
            rest_pose_frames = lead_in::rest_pose_frames(&clip).min(rest_pose_frames);
        }
        let mut looped = None;
        if let Some(length) = args.cyclic {
            let made = make_loop(&clip, length.frames(clip.frame_rate()), &LoopOptions::default())
                .map_err(|error| about(error.into()))?;
            looped = Some(LoopRecord {
                start: made.start,
                period: made.period,
                apart_metres: made.apart,
                seam_ratio: made.seam_ratio,
            });
            clip = made.clip;
        }
        let (clip, root) = self.over_ground.apply(clip, &mut source, looped.is_some()).map_err(about)?;
        let name = clip_name.clone().or_else(|| Some(input.file_stem()?.to_string_lossy().into_owned()));
        // In a copy of the file that it came from, the clip takes its own place.
        let baked = bake::bake(clip, &args.bake, &[], (format, &source))?;
        let clip = baked.clip;
        let like = ExportOptions::in_format(format, &source);
        let options = ExportOptions { name, replace: true, keys: baked.keys, ..like };
        let written = write_motion(&clip, format, &options)
            .map_err(|cause| CliError::Format { path: out.to_path_buf(), cause: Box::new(cause) })?;
        warnings.extend(load::warnings(&written.findings, out));
        let read_back = ReadBack::of(&written.bytes, format, &clip, &options);
        let wrong = read_back.and_then(|found| found.warning());
        warnings.extend(wrong.map(|wrong| format!("{}: {wrong}", printable::path(out))));
        let file = [input.to_path_buf()];
        self.run.write_motion(out, &written.bytes, &args.sidecar, &Facts::of_files(&file))?;
        Ok(Converted {
            input: json_path(input),
            output: json_path(out),
            format: format.name(),
            clip: clip_name,
            joints: clip.skeleton().len(),
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: seconds(&clip),
            metres_per_unit: source.metres_per_unit,
            rest_pose_frames,
            root,
            looped,
            bake: baked.record,
            read_back,
            warnings,
        })
    }
}

impl Converted {
    fn text(&self) -> String {
        let mut text = format!(
            "wrote {}: {} s, {} at {} a second",
            printable::text(&self.output),
            fixed(self.seconds, 1),
            counted(self.frames, "frame"),
            (self.frame_rate * 1e3).round() / 1e3
        );
        match self.rest_pose_frames {
            0 => {}
            1 => text.push_str("\nnote: the first frame is a T-pose, and is kept (--range 1.. leaves it out)"),
            count => text.push_str(&format!(
                "\nnote: the first {count} frames are a T-pose, and are kept (--range {count}.. leaves them out)"
            )),
        }
        if let Some(looped) = &self.looped {
            text.push_str(&format!(
                "\nnote: a loop from frame {} on; its ends were {} m apart, and its seam is {} ordinary steps wide",
                looped.start,
                fixed(looped.apart_metres, 3),
                fixed(looped.seam_ratio, 2)
            ));
        }
        if let Some(bake) = &self.bake {
            text.push_str(&format!("\n{}", bake.note()));
        }
        for note in self.root.notes() {
            text.push_str(&format!("\nnote: {}", printable::text(note)));
        }
        text
    }
}
