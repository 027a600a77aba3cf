//! How good whole storyboards become: rough drawings of held-out clips, read, made motions, and compared with those clips.

mod drawing;
mod measured;

use crate::cli::EvaluateStoryboardArgs;
use crate::commands::generate::{Model, about, named_model, sampling};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::fixed;
use crate::readers;
use drawing::{Drawing, draw_window};
use inkrig_generate::guidance::SettleOptions;
use inkrig_generate::sampling::SamplingOptions;
use inkrig_storyboard::{
    Exact, Generated, Maker, MakerOptions, MeetOptions, StoryboardError, Understood, animation, read_figure,
    understand,
};
use inkrig_train::TrainError;
use inkrig_train::corpus::Manifest;
use inkrig_train::evaluation::{EvaluationWindow, windows};
use measured::{Measured, Row};
use serde::Serialize;

/// What was measured; the names are stable.
#[derive(Serialize)]
struct Record {
    /// Drawings that were made, and those of them that became a motion.
    drawings: usize,
    understood: usize,
    /// Why the others did not.
    refused: Vec<String>,
    /// Trajectories, and those of them that were taken for the way of the joint that they are of.
    trajectories: usize,
    attached: usize,
    rows: Vec<Row>,
}

pub(super) fn run(args: &EvaluateStoryboardArgs, console: &Console) -> Result<(), CliError> {
    let stage = console.stage("reading the model and the corpus");
    let mut model = Model::asked(named_model(args.model.as_ref()).as_deref(), args.steps)?;
    let body = model.body()?;
    let encoder = model.read(None)?;
    let reader = readers::sketch(None)?;
    let manifest = Manifest::read(&args.corpus)?;
    let frames = model.usual_frames();
    let windows = windows(&manifest, args.split.into(), frames, args.windows)?;
    drop(stage);
    let wrong = |cause| about(&model.path, cause);
    let usual = sampling(&model.header, args.steps, &model.path)?;
    let no_text = encoder.encode("").map_err(wrong)?;
    let maker = Maker {
        networks: model.networks()?,
        features: &model.features,
        places: &model.places,
        no_text: &no_text,
        body: &body,
        usual_frames: frames,
    };
    let options = |drawn: bool, guided: bool| MakerOptions {
        sampling: SamplingOptions {
            guide_every: usize::from(args.guide_every),
            settle: Some(SettleOptions::default()),
            guidance: usual.guidance.clone().filter(|_| guided),
            ..usual.clone()
        },
        drawn,
        candidates: usize::from(args.candidates),
        seed: args.seed,
    };
    let ways = [
        ("off", options(false, false), Exact::Off),
        ("soft, networks alone", options(true, false), Exact::Soft),
        ("soft", options(true, true), Exact::Soft),
        ("pin", options(true, true), Exact::Pin(MeetOptions::default())),
    ];
    let mut real = Row::named("real motion");
    let mut rows: Vec<Row> = ways.iter().map(|(name, ..)| Row::named(name)).collect();
    let (mut refused, mut trajectories, mut attached) = (Vec::new(), 0, 0);
    let bar = console.bar("storyboards");
    for (at, window) in windows.iter().enumerate() {
        let drawing = draw_window(window, args.seed.wrapping_add(at as u64));
        let read = read_figure(&drawing.frame, at + 1, &reader)
            .and_then(|figure| understand(&drawing.frame, at + 1, figure, &body, None));
        let read = match read {
            Ok(read) => read,
            Err(cause) => {
                refused.push(cause.to_string());
                continue;
            }
        };
        trajectories += drawing.joints.len();
        let right = |joint: &&usize| read.attached.iter().any(|way| way.joint == **joint);
        attached += drawing.joints.iter().filter(right).count();
        real.add(Measured::real(window));
        let text = encoder.encode(&model.description(&read.plan.word)).map_err(wrong)?;
        let failed = |cause: StoryboardError| CliError::Storyboard {
            path: args.corpus.clone(),
            cause: Box::new(cause),
        };
        let mut made: Option<(MakerOptions, Generated)> = None;
        for (row, (_, options, exact)) in rows.iter_mut().zip(&ways) {
            let clip = match made.take() {
                // Pins change what was sampled for soft.
                Some((before, clip)) if before == *options => clip,
                _ => maker.clip(at + 1, &read.plan, &text, options).map_err(failed)?,
            };
            let whole = animation(std::slice::from_ref(&clip), None, &body, exact).map_err(failed)?;
            row.add(Measured::of(window, &drawing, &read, &whole));
            made = Some((options.clone(), clip));
        }
        if bar.at(at + 1, windows.len()).is_break() {
            return Err(TrainError::Stopped.into());
        }
    }
    drop(bar);
    rows.insert(0, real);
    let understood = windows.len() - refused.len();
    console.say(table(&rows))?;
    console.say(format!(
        "{understood} of {} drawings became a motion; {attached} of {trajectories} trajectories were taken for the joint's that they are of",
        windows.len()
    ))?;
    for (why, _) in refused.iter().zip(0..5) {
        console.say(why)?;
    }
    console.result(&Record { drawings: windows.len(), understood, refused, trajectories, attached, rows })
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| | clips | MPJPE-2D, cm | Avg. Err-2D, cm | off the drawing, cm | at worst, cm | clips within 1 cm | poses moved, cm | ways moved | jerk P99, mm | of real | skating |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let real = rows.first().map_or(0.0, Row::jerk);
    for row in rows {
        let cm = |metres: f64| fixed(100.0 * metres, 2);
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
            row.name,
            row.clips(),
            cm(row.pose()),
            cm(row.way()),
            cm(row.off()),
            cm(row.worst()),
            row.within(),
            cm(row.moved().0),
            row.moved().1,
            fixed(1000.0 * row.jerk(), 1),
            fixed(row.jerk() / real, 2),
            fixed(row.skating(), 3),
        );
    }
    text.trim_end().to_owned()
}
