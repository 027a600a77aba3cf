//! How smooth transitions are, and what they cost: held-out clips put end to end as a storyboard's are, by cubics and by the model with
//! more and less guidance.

use crate::cli::EvaluateBlendingArgs;
use crate::commands::generate::{Model, about, named_model, sampling};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::fixed;
use inkrig_generate::blending::BlendOptions;
use inkrig_generate::measures::{area_under_jerk, jerk, mean_jerk, peak_jerk};
use inkrig_generate::sampling::Sampler;
use inkrig_motion::humanml::{Camera, Joints};
use inkrig_storyboard::{Blender, Generated, Plan, StoryboardError, sequence};
use inkrig_train::TrainError;
use inkrig_train::corpus::Manifest;
use inkrig_train::evaluation::{EvaluationWindow, windows};
use serde::Serialize;

/// Guidance at every so many of fifty steps; none, what `--blend model` takes, what the paper takes, and at every step.
const BUDGETS: [(&str, Option<usize>); 4] = [
    ("model, no guidance", None),
    ("model, every tenth step (--blend model)", Some(10)),
    ("model, every fifth step", Some(5)),
    ("model, every step", Some(1)),
];
/// Frames of a clip.
const FRAMES: usize = 40;

/// One way to make transitions; the names are stable.
#[derive(Serialize)]
struct Row {
    name: &'static str,
    /// Area between the mean jerk over transitions and that of real motion, metres a frame^3, added up over moments.
    area_under_jerk: f64,
    /// The largest of the mean jerk.
    peak_jerk: f64,
    /// Decodings with their gradient, for each transition.
    evaluations: f64,
}

pub(super) fn run(args: &EvaluateBlendingArgs, console: &Console) -> Result<(), CliError> {
    let stage = console.stage("reading the model and the corpus");
    let mut model = Model::asked(named_model(args.model.as_ref()).as_deref(), None)?;
    let encoder = model.read(None)?;
    let manifest = Manifest::read(&args.corpus)?;
    let windows = windows(&manifest, args.split.into(), FRAMES, 2 * usize::from(args.pairs))?;
    drop(stage);
    let wrong = |cause| about(&model.path, cause);
    let usual = sampling(&model.header, None, &model.path)?;
    let no_text = encoder.encode("").map_err(wrong)?;
    let sampler = Sampler { networks: model.networks()?, features: &model.features, no_text: &no_text };
    let half = windows.len() / 2;
    // Clips that are far apart in the list are of other people and actions.
    let pairs: Vec<[&EvaluationWindow; 2]> =
        windows.iter().zip(&windows[half..]).take(half).map(|(a, b)| [a, b]).collect();
    let bar = console.bar("transitions");
    let mut done = 0;
    let mut rows = Vec::new();
    for (name, every) in std::iter::once(("cubics (--blend smooth)", None)).chain(BUDGETS) {
        let usual_blend = BlendOptions { text_weight: usual.text_weight, ..BlendOptions::default() };
        let options = BlendOptions {
            guidance: usual_blend.guidance.clone().filter(|_| every.is_some()),
            guide_every: every.unwrap_or(usual_blend.guide_every),
            ..usual_blend
        };
        let by_model = !rows.is_empty();
        let (mut curves, mut evaluations) = (Vec::new(), 0);
        for pair in &pairs {
            let text = encoder.encode(&description(&model, pair)).map_err(wrong)?;
            let texts = [text];
            let blender = Blender { sampler: &sampler, texts: &texts, options: &options };
            let failed = |cause: StoryboardError| CliError::Storyboard {
                path: args.corpus.clone(),
                cause: Box::new(cause),
            };
            let joined =
                sequence(&pair.map(|window| free(&window.joints)), Some(blender).filter(|_| by_model))
                    .map_err(failed)?;
            for transition in &joined.transitions {
                evaluations += transition.evaluations;
                // Moments whose four frames have one of the transition among them.
                let first = transition.frames.start.saturating_sub(3);
                let end = (transition.frames.end + 3).min(joined.motion.len());
                curves.extend(joined.motion.get(first..end).map(jerk));
            }
            done += 1;
            if bar.at(done, pairs.len() * (1 + BUDGETS.len())).is_break() {
                return Err(TrainError::Stopped.into());
            }
        }
        let mean = mean_jerk(&curves);
        rows.push(Row {
            name,
            area_under_jerk: area_under_jerk(&mean),
            peak_jerk: peak_jerk(&mean),
            evaluations: evaluations as f64 / curves.len().max(1) as f64,
        });
    }
    drop(bar);
    let mut text = String::from("| transitions | AUJ | PJ | evaluations each |\n|---|---|---|---|\n");
    for Row { name, area_under_jerk, peak_jerk, evaluations } in &rows {
        text += &format!(
            "| {name} | {} | {} | {} |\n",
            fixed(*area_under_jerk, 2),
            fixed(*peak_jerk, 3),
            fixed(*evaluations, 0)
        );
    }
    console.say(text.trim_end())?;
    console.result(&rows)
}

/// What both clips do.
fn description(model: &Model, pair: &[&EvaluationWindow; 2]) -> String {
    let words: Vec<&str> =
        pair.iter().filter_map(|window| window.actions.first()).map(String::as_str).collect();
    if words.is_empty() { String::new() } else { model.description(&words.join(" and ")) }
}

/// A clip that nothing is asked of.
fn free(motion: &[Joints]) -> Generated {
    let plan = Plan::of_word(String::new(), motion.len(), Camera::default());
    Generated {
        motion: motion.to_vec(),
        contacts: Vec::new(),
        plan,
        error: 0.0,
        worst: 0.0,
        candidate: 0,
        evaluations: 0,
    }
}
