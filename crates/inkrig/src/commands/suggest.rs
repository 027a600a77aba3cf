//! `inkrig suggest`: poses of a clip worth a keyframe, and a map of it to draw on.

use super::align::{Sources, source};
use super::settings;
use crate::cli::SuggestArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::guide::{CandidateFacts, Origin, Suggestions, round};
use crate::map_picture::{self, Canvas};
use crate::output::Output;
use crate::printable::{self, fixed, json_path};
use crate::sheet::{SheetOptions, contact_sheet};
use crate::{clip_path, load, names, results};
use inkrig_align::MapFrame;
use serde::Serialize;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &SuggestArgs, console: &Console) -> Result<(), CliError> {
    let output = Output { force: args.force };
    let places = || [&args.map, &args.sheet].into_iter().flatten().map(PathBuf::as_path);
    let drawn = match &args.map {
        Some(path) => is_svg(path)?,
        None => false,
    };
    let files = clip_path::files(args.clips.iter().map(PathBuf::as_path));
    names::results_differ(files.iter().map(PathBuf::as_path), places())?;
    results::check_picture(args.sheet.as_ref())?;
    for path in places() {
        output.check(path)?;
    }
    let mut warnings = Vec::new();
    let Sources { takes: source, parts, .. } =
        source(&args.clips, args.range, 1, &args.import, console, &mut warnings)?;
    let stage = console.stage("looking for poses");
    let suggestions = Suggestions::of(&source, settings::threads(args.threads), args.count)?;
    let origin = Origin::of(&parts);
    let facts = Facts::of(args, &suggestions, &origin, warnings);
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    if let Some(path) = &args.map {
        let bytes = if drawn {
            map_picture::svg(&suggestions, &Canvas::of(&suggestions.map))?
        } else {
            serde_json::to_vec(&MapFile { facts: &facts, moments: moments(&suggestions, &origin) })?
        };
        files.push((path, bytes));
    }
    if let Some(path) = &args.sheet {
        let frames: Vec<usize> =
            suggestions.candidates.iter().map(|candidate| candidate.moment.frame).collect();
        let options = SheetOptions { frames: Some(&frames), columns: 4, ..SheetOptions::default() };
        files.push((path, contact_sheet(source.clip(), &options)?));
    }
    drop(stage);
    for (path, bytes) in &files {
        output.write(path, bytes)?;
    }
    console.say(facts.text())?;
    for (path, _) in &files {
        console.say(format!("wrote {}", printable::path(path)))?;
    }
    console.result(&facts)
}

/// What is said of a source; the names are stable.
#[derive(Serialize)]
struct Facts {
    inputs: Vec<String>,
    /// Poses worth a keyframe, the most telling first.
    candidates: Vec<CandidateFacts>,
    /// How much of the distances between moments the map does not show, 0 is all.
    map_stress: f64,
    warnings: Vec<String>,
}

/// The map as a file: the same, and every moment's place. One unit is the mean distance of two moments.
#[derive(Serialize)]
struct MapFile<'a> {
    #[serde(flatten)]
    facts: &'a Facts,
    /// Frame, x to the right, y up. Not called points: it is no drawing, and its first number is no place.
    moments: Vec<(usize, f64, f64)>,
}

impl Facts {
    fn of(args: &SuggestArgs, suggestions: &Suggestions, origin: &Origin, warnings: Vec<String>) -> Self {
        Self {
            inputs: args.clips.iter().map(|path| json_path(path)).collect(),
            candidates: suggestions.facts(origin),
            map_stress: round(suggestions.map.stress, 4),
            warnings,
        }
    }

    fn text(&self) -> String {
        let mut text = "poses worth a keyframe (put a time before ~):".to_string();
        for (number, candidate) in self.candidates.iter().enumerate() {
            let CandidateFacts { frame, clip, seconds, share, .. } = candidate;
            let clip = if self.inputs.len() > 1 { format!(", clip {}", clip + 1) } else { String::new() };
            text += &format!(
                "\n  {:>2}  {:>8} s{clip}  stands for {:>3} %   --key 0s~frame:{frame}",
                number + 1,
                fixed(*seconds, 2),
                fixed(100.0 * share, 0),
            );
        }
        text
    }
}

fn moments(suggestions: &Suggestions, origin: &Origin) -> Vec<(usize, f64, f64)> {
    let frames = suggestions.map.frames.iter();
    let place = |[x, y]: [f64; 2]| (round(x, 4), round(y, 4));
    let moment = |at: &MapFrame| (at.moment.frame + origin.first_frame, place(at.place).0, place(at.place).1);
    frames.map(moment).collect()
}

fn is_svg(path: &Path) -> Result<bool, CliError> {
    match load::extension(path).as_deref() {
        Some("svg") => Ok(true),
        Some("json") => Ok(false),
        _ => Err(CliError::Kind { path: path.to_path_buf(), known: "maps are written as .json or .svg" }),
    }
}
