//! `inkrig sketch`: what is drawn, as a figure and as a word.

use crate::cli::{SketchArgs, SketchCommand, SketchReadArgs, SketchWordArgs};
use crate::console::Console;
use crate::drawing::ink;
use crate::error::CliError;
use crate::joints_picture;
use crate::output::Output;
use crate::printable::{self, fixed, json_path};
use crate::{readers, results};
use inkrig_generate::readers::graph::{self, StrokeGraph};
use inkrig_generate::readers::ink::{Crop, Ink, crop};
use inkrig_generate::readers::network::Work;
use inkrig_generate::readers::sketch::{JOINT_OF_KEY_POINT, KEY_POINTS, MARGIN, Reading, SIDE, UNSURE};
use inkrig_generate::readers::word;
use inkrig_motion::humanml::NAMES;
use serde::Serialize;

/// A figure's lines and the network's joints that are farther apart than this share of the figure do not agree.
const APART: f32 = 0.12;

pub(super) fn run(args: &SketchArgs, console: &Console) -> Result<(), CliError> {
    match &args.command {
        SketchCommand::Read(args) => read(args, console),
        SketchCommand::Word(args) => read_word(args, console),
    }
}

/// What was read; the names are stable. Places are pixels of the picture, from the left and from the top.
#[derive(Serialize)]
struct Record {
    drawing: String,
    /// Pixels of the picture; of lines, those of the page that they were drawn on.
    width: usize,
    height: usize,
    /// `network`, or `lines` where there were no weights.
    read_by: &'static str,
    joints: Vec<Joint>,
    /// How much likelier these sides are than the other way round, as logarithms.
    #[serde(skip_serializing_if = "Option::is_none")]
    sides: Option<Sides>,
    /// How well the lines agree: mean distance of both readings, as a share of the figure's longer side.
    #[serde(skip_serializing_if = "Option::is_none")]
    lines_differ_by: Option<f32>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Joint {
    name: &'static str,
    /// Of the 22 joints.
    index: usize,
    x: f32,
    y: f32,
    confidence: f32,
    /// How likely it is that it is drawn.
    drawn: f32,
}

#[derive(Serialize)]
struct Sides {
    arms: f32,
    legs: f32,
}

fn read(args: &SketchReadArgs, console: &Console) -> Result<(), CliError> {
    let output = Output { force: args.force };
    results::check_picture(args.picture.as_ref())?;
    for path in [&args.out, &args.picture].into_iter().flatten() {
        output.check(path)?;
    }
    let page = ink(&args.drawing)?;
    let no_figure = |what: &str| CliError::Picture { path: args.drawing.clone(), what: what.into() };
    let crop =
        crop(&page, SIDE, MARGIN).ok_or_else(|| no_figure("shows no ink: draw dark lines on light paper"))?;
    let lines = graph::read(&crop.ink);
    let reader = if args.lines { None } else { Some(readers::sketch(args.weights.as_deref())?) };
    let (reading, by) = match (reader, &lines) {
        (Some(reader), _) => (reader.read(&crop.ink, &mut Work::default()), "network"),
        (None, Some(lines)) => (of_lines(lines), "lines"),
        (None, None) => {
            return Err(no_figure(
                "shows no figure that can be followed by its lines: a round closed head, a trunk, arms and legs that hang together",
            ));
        }
    };
    let differ = (by == "network").then_some(lines.as_ref()).flatten().map(|lines| apart(&reading, lines));
    let record = record(args, &page, &crop, &reading, by, differ);
    if let Some(path) = &args.picture {
        output.write(path, &joints_picture::png(&page, &on_page(&crop, &reading), &reading)?)?;
    }
    if let Some(path) = &args.out {
        output.write(path, format!("{}\n", serde_json::to_string_pretty(&record)?).as_bytes())?;
    }
    for warning in &record.warnings {
        console.warn(warning);
    }
    console.say(summary(&record))?;
    console.result(&record)
}

fn on_page(crop: &Crop, reading: &Reading) -> [[f32; 2]; KEY_POINTS] {
    reading.places.map(|place| crop.on_page(place))
}

/// Mean distance of both readings, left and right left open.
fn apart(reading: &Reading, lines: &StrokeGraph) -> f32 {
    let mirrored = reading.mirrored();
    let off = |reading: &Reading| {
        let pairs =
            reading.places.iter().zip(&lines.places).zip(&reading.drawn).filter(|(_, drawn)| **drawn > 0.5);
        let (sum, count) = pairs.fold((0.0, 0.0_f32), |(sum, count), ((a, b), _)| {
            (sum + (a[0] - b[0]).hypot(a[1] - b[1]), count + 1.0)
        });
        sum / count.max(1.0) / SIDE as f32
    };
    off(reading).min(off(&mirrored))
}

fn of_lines(lines: &StrokeGraph) -> Reading {
    Reading {
        places: lines.places,
        confidence: lines.confidence,
        drawn: [1.0; KEY_POINTS],
        arms: 0.0,
        legs: 0.0,
    }
}

fn record(
    args: &SketchReadArgs,
    page: &Ink,
    crop: &Crop,
    reading: &Reading,
    by: &'static str,
    differ: Option<f32>,
) -> Record {
    let places = on_page(crop, reading);
    let joints: Vec<Joint> = (0..KEY_POINTS)
        .map(|point| {
            let index = JOINT_OF_KEY_POINT[point];
            let [x, y] = places[point];
            let (confidence, drawn) = (reading.confidence[point], reading.drawn[point]);
            Joint { name: NAMES[index], index, x, y, confidence, drawn }
        })
        .collect();
    let mut warnings = Vec::new();
    let named = |some: &dyn Fn(&Joint) -> bool| {
        joints.iter().filter(|joint| some(joint)).map(|joint| joint.name).collect::<Vec<_>>().join(", ")
    };
    let unsure = named(&|joint| joint.drawn > 0.5 && joint.confidence < UNSURE);
    if !unsure.is_empty() {
        warnings.push(format!("not sure of: {unsure}"));
    }
    let missing = named(&|joint| joint.drawn <= 0.5);
    if !missing.is_empty() {
        warnings.push(format!("not drawn, it seems: {missing}"));
    }
    if by == "lines" {
        warnings.push(
            "read by following the lines; left and right are those of a figure that faces the viewer".into(),
        );
    }
    if let Some(differ) = differ.filter(|differ| *differ > APART) {
        let share = fixed(100.0 * f64::from(differ), 0);
        warnings
            .push(format!("the lines say otherwise, by {share} % of the figure's size: look at --picture"));
    }
    let sides = (by == "network").then_some(Sides { arms: reading.arms, legs: reading.legs });
    Record {
        drawing: json_path(&args.drawing),
        width: page.width,
        height: page.height,
        read_by: by,
        joints,
        sides,
        lines_differ_by: differ,
        warnings,
    }
}

fn summary(record: &Record) -> String {
    let mut text = String::new();
    for joint in &record.joints {
        let sure = if joint.drawn > 0.5 {
            format!("{} %", fixed(100.0 * f64::from(joint.confidence), 0))
        } else {
            "not drawn".into()
        };
        text += &format!(
            "{:<13} {:>7} {:>7}  {sure}\n",
            joint.name,
            fixed(joint.x.into(), 1),
            fixed(joint.y.into(), 1)
        );
    }
    text.trim_end().to_string()
}

/// A word that was read; the names are stable.
#[derive(Serialize)]
struct WordRecord {
    /// The verb, if it is one of the lexicon.
    verb: Option<&'static str>,
    /// The likeliest verbs.
    verbs: Vec<Verb>,
    /// The letters as they are.
    letters: String,
    /// How likely it is that the word is none of the lexicon.
    unknown: f64,
}

#[derive(Serialize)]
struct Verb {
    verb: &'static str,
    word: &'static str,
    confidence: f64,
}

fn read_word(args: &SketchWordArgs, console: &Console) -> Result<(), CliError> {
    let wrong = |what: &str| CliError::Picture { path: args.drawing.clone(), what: what.into() };
    let line = word::line(&ink(&args.drawing)?)
        .ok_or_else(|| wrong("shows no ink: write with dark lines on light paper"))?;
    let reader = readers::word(args.weights.as_deref())?;
    let reading = reader.read(&line, &mut Work::default());
    let verbs: Vec<Verb> = reading
        .verbs
        .iter()
        .take(5)
        .map(|&(verb, word, confidence)| Verb { verb, word, confidence })
        .collect();
    let known = verbs.first().filter(|verb| verb.confidence > reading.unknown).map(|verb| verb.verb);
    let record = WordRecord { verb: known, verbs, letters: reading.letters, unknown: reading.unknown };
    let near: Vec<String> = record
        .verbs
        .iter()
        .take(3)
        .map(|verb| format!("{} ({} %)", verb.verb, fixed(100.0 * verb.confidence, 0)))
        .collect();
    let letters = printable::text(&record.letters);
    console.say(match record.verb {
        Some(verb) => format!("{verb}  (read as `{letters}`; {})", near.join(", ")),
        None => {
            format!("no action that the model knows: read as `{letters}`; near ones are {}", near.join(", "))
        }
    })?;
    console.result(&record)
}
