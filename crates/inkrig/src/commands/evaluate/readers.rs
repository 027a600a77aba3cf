//! How good the readers of drawings are.

use crate::cli::{EvaluateSketchArgs, EvaluateWordArgs};
use crate::console::Console;
use crate::drawing::ink;
use crate::error::CliError;
use crate::joints_picture::{self, Figure};
use crate::output::Output;
use crate::printable::fixed;
use crate::{load, readers};
use inkrig_generate::readers::graph;
use inkrig_generate::readers::ink::{Crop, Ink, crop};
use inkrig_generate::readers::network::Work;
use inkrig_generate::readers::sketch::{JOINT_OF_KEY_POINT, KEY_POINTS, MARGIN, SIDE, SketchReader};
use inkrig_motion::humanml::NAMES;
use inkrig_train::corpus::{Manifest, Split};
use inkrig_train::figures::Family;
use inkrig_train::lettering::read_fonts;
use inkrig_train::reading::{
    Found, MarkedDrawing, Pck, Poses, Subset, WordSettings, measure_by, measure_marked, measure_words,
    rendered, split_fonts, word_examples,
};
use serde::Serialize;
use std::path::Path;

/// The seed of drawings to measure on.
const SEED: u64 = 2024;

/// Drawings of each kind on a sheet.
const SHOWN: usize = 8;
/// Marked drawings on a sheet, in rows of as many.
const MARKED_SHOWN: usize = 6 * SHOWN;

/// What was measured; the names are stable.
#[derive(Serialize)]
struct Record {
    rendered: Vec<Row>,
    drawings: Vec<DrawingRow>,
}

#[derive(Serialize)]
struct Row {
    what: &'static str,
    #[serde(flatten)]
    pck: Pck,
}

#[derive(Serialize)]
struct DrawingRow {
    drawing: String,
    /// Marked joints, and those that were found within a tenth of the torso.
    joints: usize,
    found: usize,
    /// The same within a fifth.
    found_within_a_fifth: usize,
}

pub(super) fn sketch(args: &EvaluateSketchArgs, console: &Console) -> Result<(), CliError> {
    let output = Output { force: args.force };
    if let Some(path) = &args.sheet {
        output.check(path)?;
    }
    let reader = if args.lines { None } else { Some(readers::sketch(args.weights.as_deref())?) };
    let mut work = Work::default();
    let mut find = |ink: &Ink| find(reader.as_ref(), ink, &mut work);
    let (mut rows, mut drawings, mut seen) = (Vec::new(), Vec::new(), Vec::new());
    if let Some(corpus) = &args.corpus {
        let poses = Poses::read(&Manifest::read(corpus)?, Split::Test)?;
        let single = if args.by_style { &Family::LEARNED[..] } else { &[] };
        for subset in Subset::ALL.into_iter().chain(single.iter().copied().map(Subset::Only)) {
            let stage = console.stage(format!("drawing and reading: {}", subset.name()));
            let pictures = rendered(&poses, subset, args.count as usize, SEED);
            let pck = measure_by(&mut find, &pictures);
            if args.sheet.is_some() {
                let shown = pictures.into_iter().take(SHOWN).map(|picture| picture.ink);
                seen.push(shown.map(|ink| (find(&ink), ink)).collect::<Vec<_>>());
            }
            drop(stage);
            console.say(line(subset.name(), &pck))?;
            rows.push(Row { what: subset.name(), pck });
        }
        if let Some(row) = rows.first() {
            console.say(by_point(&row.pck))?;
        }
    }
    let mut pages = Vec::new();
    for (name, marked) in marked(args.drawings.as_deref())? {
        let (row, page) = read_marked(&name, &marked, &mut find)?;
        if args.sheet.is_some() && pages.len() < MARKED_SHOWN {
            pages.extend(page);
        }
        console.say(format!(
            "{name}: {} of {} marked joints within a tenth of the torso, {} within a fifth",
            row.found, row.joints, row.found_within_a_fifth
        ))?;
        drawings.push(row);
    }
    if let Some(path) = &args.sheet {
        seen.extend(pages.chunks(SHOWN).map(<[_]>::to_vec));
        if seen.is_empty() {
            console.warn("nothing was drawn or found marked: no sheet");
        } else {
            output.write(path, &sheet(&seen)?)?;
        }
    }
    console.result(&Record { rendered: rows, drawings })
}

fn find(reader: Option<&SketchReader>, ink: &Ink, work: &mut Work) -> Found {
    match reader {
        Some(reader) => {
            let reading = reader.read(ink, work);
            Found { places: reading.places, drawn: reading.drawn.map(|drawn| drawn > 0.5) }
        }
        None => graph::read(ink)
            .map_or_else(Found::nothing, |lines| Found { places: lines.places, drawn: [true; 18] }),
    }
}

fn line(name: &str, pck: &Pck) -> String {
    let share = |share: f64| fixed(100.0 * share, 1);
    format!(
        "{name}: PCK@0.1 {} % ({} % with left and right left open; {} % by the pose that was drawn), PCK@0.2 {} %, mean distance {} % of the torso, drawn or not told {} % ({} drawings)",
        share(pck.pck),
        share(pck.pck_either_side),
        share(pck.pck_of_the_pose),
        share(pck.pck_within_a_fifth),
        share(pck.mean_distance),
        share(pck.presence),
        pck.pictures
    )
}

fn by_point(pck: &Pck) -> String {
    let of = |(point, share): (usize, &f64)| {
        format!("{} {}", NAMES[JOINT_OF_KEY_POINT[point]], fixed(100.0 * share, 0))
    };
    let all: Vec<String> = pck.by_point.iter().enumerate().map(of).collect();
    format!("by joint, learned styles, %: {}", all.join(", "))
}

/// Drawings in folders of their own, by name.
fn marked(folder: Option<&Path>) -> Result<Vec<(String, MarkedDrawing)>, CliError> {
    let Some(folder) = folder else { return Ok(Vec::new()) };
    let read = |cause| CliError::Read { path: folder.to_path_buf(), cause };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(read)? {
        let path = entry.map_err(read)?.path();
        let joints = path.join("char_cfg.yaml");
        if joints.is_file() {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let bytes = load::drawing(&joints)?;
            let drawing =
                MarkedDrawing::read(&path.join("texture.png"), &joints, &String::from_utf8_lossy(&bytes))?;
            found.push((name, drawing));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(found)
}

fn read_marked(
    name: &str,
    drawing: &MarkedDrawing,
    find: &mut dyn FnMut(&Ink) -> Found,
) -> Result<(DrawingRow, Option<(Found, Ink)>), CliError> {
    let page = ink(&drawing.picture)?;
    let seen = crop(&page, SIDE, MARGIN).map(|crop| (find(&crop.ink), crop));
    let score = |within: f32| {
        let score = |(found, crop): &(Found, Crop)| {
            measure_marked(drawing, &found.places.map(|place| crop.on_page(place)), within)
        };
        seen.as_ref().map_or(0, score)
    };
    let row = DrawingRow {
        drawing: name.to_string(),
        joints: drawing.joints.len(),
        found: score(0.1),
        found_within_a_fifth: score(0.2),
    };
    Ok((row, seen.map(|(found, crop)| (found, crop.ink))))
}

fn sheet(rows: &[Vec<(Found, Ink)>]) -> Result<Vec<u8>, CliError> {
    let figures: Vec<Vec<Figure<'_>>> = rows.iter().map(|row| row.iter().map(shown).collect()).collect();
    Ok(joints_picture::sheet(&figures)?)
}

fn shown((found, page): &(Found, Ink)) -> Figure<'_> {
    let drawn = found.drawn.map(|drawn| if drawn { 1.0 } else { 0.0 });
    Figure { page, places: found.places, drawn, sure: [1.0; KEY_POINTS] }
}

pub(super) fn word(args: &EvaluateWordArgs, console: &Console) -> Result<(), CliError> {
    let settings = args.config.as_deref().map(WordSettings::read).transpose()?.unwrap_or_default();
    let (learned, held_out) = split_fonts(read_fonts(&args.fonts)?, &settings.held_out)?;
    let reader = readers::word(args.weights.as_deref())?;
    let score = measure_words(&reader, &word_examples(&held_out, args.rounds as usize, SEED));
    let share = |share: f64| fixed(100.0 * share, 1);
    console.say(format!(
        "{} words in {} held-out fonts ({} were learned from): first {} %, among three {} %; words outside the lexicon told {} %, verbs taken for such {} %",
        score.words,
        held_out.len(),
        learned.len(),
        share(score.top_1),
        share(score.top_3),
        share(score.unknown_told),
        share(score.known_refused)
    ))?;
    console.result(&score)
}
