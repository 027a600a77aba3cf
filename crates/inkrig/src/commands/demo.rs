//! `inkrig demo`: the main job on our own samples, with nothing else needed.

use super::demo_board::{RESULTS, make_board, sample};
use super::demo_files::DemoFiles;
use crate::cli::DemoArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::guide::{CANDIDATES, Suggestions, guide};
use crate::printable::{self, json_path};
use crate::results::{self, Made, Places};
use inkrig_align::{Control, CurveOptions, Options, align};
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_samples::Sample;
use inkrig_sketch::read_curve;
use serde::Serialize;
use std::path::Path;

/// What is shown: a clip, a drawing.
const SCENES: [(&str, &str); 3] = [("person", "spiral"), ("quadruped", "eight"), ("snake", "wave")];

pub(super) fn run(args: &DemoArgs, console: &Console) -> Result<(), CliError> {
    let mut files = DemoFiles::open(&args.folder, args.force)?;
    let samples = || inkrig_samples::motions().iter().chain(inkrig_samples::curves()).chain(sample());
    let scenes: Vec<Scene> = SCENES.iter().filter_map(|(motion, curve)| Scene::of(motion, curve)).collect();
    // All of them before the first is written.
    for sample in samples() {
        files.check(sample.file_name, Some(sample.bytes))?;
    }
    for name in scenes.iter().flat_map(Scene::results).chain(RESULTS.map(String::from)) {
        files.check(&name, None)?;
    }
    for sample in samples() {
        files.write(sample.file_name, sample.bytes)?;
    }
    let mut facts = Vec::new();
    for scene in &scenes {
        facts.push(scene.make(&mut files, console)?);
    }
    if let Some(board) = sample() {
        make_board(board, &mut files, console)?;
    }
    files.save()?;
    if let Some(first) = scenes.first() {
        let [_, page, _] = first.results().map(|name| printable::path(&files.path(&name)));
        let clip = printable::path(&files.path(first.motion.file_name));
        console.say(format!("\nOpen {page} in a browser. Then try your own:"))?;
        console
            .say(format!("  inkrig align {clip} --curve YOUR-DRAWING.svg -o new.bvh --preview new.html"))?;
    }
    console.result(&facts)
}

/// A clip that follows a drawing.
struct Scene {
    motion: &'static Sample,
    curve: &'static Sample,
}

/// What is said of a scene; the names are stable.
#[derive(Serialize)]
struct Facts {
    source: String,
    curve: String,
    motion: String,
    preview: String,
    sheet: String,
    structure_pearson: f64,
}

impl Scene {
    fn of(motion: &str, curve: &str) -> Option<Self> {
        Some(Self { motion: inkrig_samples::find(motion)?, curve: inkrig_samples::find(curve)? })
    }

    /// The names of the motion, the page and the sheet.
    fn results(&self) -> [String; 3] {
        ["bvh", "html", "png"]
            .map(|ending| format!("{}-follows-{}.{ending}", self.motion.name, self.curve.name))
    }

    fn make(&self, files: &mut DemoFiles<'_>, console: &Console) -> Result<Facts, CliError> {
        let (source, drawing) = (files.path(self.motion.file_name), files.path(self.curve.file_name));
        let import = read_bvh(self.motion.bytes, &ImportOptions::default())
            .map_err(|error| CliError::Format { path: source.clone(), cause: Box::new(error) })?;
        let control = self.control(&drawing)?;
        let bar = console.bar(format!("aligning {}", self.motion.name));
        let (takes, options) = (import.clip.into(), Options::default());
        let alignment = align(&takes, &control, &options, &mut |progress| bar.update(progress))?;
        bar.finish()?;
        let title = format!("{} follows {}", self.motion.name, self.curve.name);
        let suggestions = Suggestions::of(&takes, options.threads, CANDIDATES)?;
        let names = [self.motion.name.to_string()];
        let guide = guide(&alignment, &suggestions, &options, &names, 0);
        let made = Made {
            title: &title,
            alignment: &alignment,
            control: &control,
            source: &import.source,
            guide: Some(&guide),
            kept: Vec::new(),
            keys: None,
        };
        let [motion, preview, sheet] = self.results().map(|name| files.path(&name));
        let places = Places { motion: &motion, report: None, preview: Some(&preview), sheet: Some(&sheet) };
        results::write(&made, places, console, |_| (), &mut |path, bytes| {
            files.write(&file_name(path), bytes)
        })?;
        Ok(Facts {
            source: json_path(&source),
            curve: json_path(&drawing),
            motion: json_path(&motion),
            preview: json_path(&preview),
            sheet: json_path(&sheet),
            structure_pearson: alignment.report.structure_pearson,
        })
    }

    fn control(&self, drawing: &Path) -> Result<Control, CliError> {
        let known = "known drawings: .json, .csv, .svg";
        let format = inkrig_sketch::Format::from_path(drawing)
            .ok_or_else(|| CliError::Kind { path: drawing.to_path_buf(), known })?;
        let curve = read_curve(self.curve.bytes, format)
            .map_err(|error| CliError::Curve { path: drawing.to_path_buf(), cause: Box::new(error) })?;
        Ok(Control::from_curve(&curve, &CurveOptions::default())?)
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
