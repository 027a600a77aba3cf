//! `inkrig evaluate`: how good a model is, on clips that it never saw.

mod blending;
mod readers;
mod storyboard;

use super::generate::{Model, about, named_model, sampling};
use crate::cli::{EvaluateArgs, EvaluateCommand, EvaluateOnArgs, JointsArg, StepsArg};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::{self, fixed};
use inkrig_generate::guidance::SettleOptions;
use inkrig_generate::networks::{Domain, Vae};
use inkrig_generate::sampling::{Sampler, SamplingOptions};
use inkrig_train::corpus::Manifest;
use inkrig_train::evaluation::{
    ControlOptions, ControlTable, EvaluationWindow, Protocol, bounds, control, reconstruction, windows,
};

pub(super) fn run(args: &EvaluateArgs, console: &Console) -> Result<(), CliError> {
    match &args.command {
        EvaluateCommand::Sketch(args) => readers::sketch(args, console),
        EvaluateCommand::Word(args) => readers::word(args, console),
        EvaluateCommand::Blending(args) => blending::run(args, console),
        EvaluateCommand::Storyboard(args) => storyboard::run(args, console),
        EvaluateCommand::Reconstruction { on } => {
            let mut model = Model::asked(named_model(on.model.as_ref()).as_deref(), None)?;
            let weights = model.tensors()?;
            let vae = Vae::new(&model.header.sizes, &weights).map_err(|cause| about(&model.path, cause))?;
            let windows = held_out(on, &model, usize::MAX)?;
            let stage = console.stage(format!("{} clips", windows.len()));
            let rows = reconstruction(&vae, &model.features, &windows)?;
            drop(stage);
            let mut text =
                String::from("| | clips | in space, mm | pelvis at its place, mm |\n|---|---|---|---|\n");
            for row in &rows {
                text += &format!(
                    "| {} | {} | {} | {} |\n",
                    printable::text(&row.name),
                    row.windows,
                    fixed(row.global_mm, 1),
                    fixed(row.aligned_mm, 1)
                );
            }
            console.say(format!("{}\n\n{}", printable::path(&model.path), text.trim_end()))?;
            console.result(&rows)
        }
        EvaluateCommand::Control { on, joints, steps, guide_every, text_weight, seed } => {
            let usual = |options: SamplingOptions| SamplingOptions {
                guide_every: *guide_every,
                text_weight: text_weight.map_or(options.text_weight, |weight| weight as f32),
                ..options
            };
            of_control(on, *joints, *steps, *seed, &usual, console)
        }
    }
}

fn of_control(
    on: &EvaluateOnArgs,
    joints: JointsArg,
    steps: Option<StepsArg>,
    seed: u64,
    usual: &dyn Fn(SamplingOptions) -> SamplingOptions,
    console: &Console,
) -> Result<(), CliError> {
    let mut model = Model::asked(named_model(on.model.as_ref()).as_deref(), steps)?;
    let texts = model.read(None)?;
    let networks = model.networks()?;
    if !networks.follows(Domain::Space) {
        return Err(CliError::NoControl { path: model.path.clone() });
    }
    let windows = held_out(on, &model, 100)?;
    let no_text = texts.encode("").map_err(|cause| about(&model.path, cause))?;
    let sampler = Sampler { networks, features: &model.features, no_text: &no_text };
    let sampling = usual(sampling(&model.header, steps, &model.path)?);
    let protocols: &[Protocol] = match joints {
        JointsArg::One => &[Protocol::Average],
        JointsArg::Several => &[Protocol::Cross],
        JointsArg::Both => &[Protocol::Average, Protocol::Cross],
    };
    let mut table = ControlTable { rows: Vec::new() };
    for &protocol in protocols {
        let options = |plane, (guidance, settle): (_, Option<SettleOptions>), footing| ControlOptions {
            protocol,
            plane,
            footing,
            sampling: SamplingOptions { guidance, settle, ..sampling.clone() },
            seed,
        };
        let [real, back] =
            bounds(&networks.vae, &model.features, &windows, &options(false, (None, None), false))?;
        table.rows.push(("real motion".into(), protocol, real));
        table.rows.push(("through the autoencoder".into(), protocol, back));
        let guided = &sampling.guidance;
        let settled = Some(SettleOptions::default());
        let mut runs = Vec::new();
        for (domain, what) in
            [(Domain::Space, "conditions in space"), (Domain::Plane, "conditions of a picture")]
        {
            if networks.follows(domain) {
                let plane = domain == Domain::Plane;
                runs.push((what.to_string(), plane, (None, None), false));
                runs.push((format!("{what}, guided"), plane, (guided.clone(), None), false));
                let how = (guided.clone(), settled.clone());
                runs.push((format!("{what}, guided, feet settled"), plane, how.clone(), false));
                runs.push((format!("{what}, guided, feet settled and put on the floor"), plane, how, true));
            }
        }
        for (name, plane, guidance, footing) in runs {
            let bar = console.bar(name.clone());
            let row = control(
                &sampler,
                &model.places,
                texts.as_ref(),
                &windows,
                &options(plane, guidance, footing),
                &|done, all| bar.at(done, all).is_continue(),
            )?;
            table.rows.push((name, protocol, row));
        }
    }
    console.say(format!("{}\n\n{}", printable::path(&model.path), table.text().trim_end()))?;
    console.result(&table)
}

fn held_out(on: &EvaluateOnArgs, model: &Model, usual: usize) -> Result<Vec<EvaluationWindow>, CliError> {
    let most = model.header.sizes.most_frames();
    if !(2..=most).contains(&on.frames) {
        return Err(CliError::LengthOfModel {
            flag: "--frames",
            path: model.path.clone(),
            frames: on.frames,
            most,
        });
    }
    let manifest = Manifest::read(&on.corpus)?;
    Ok(windows(&manifest, on.split.into(), on.frames, on.windows.unwrap_or(usual))?)
}
