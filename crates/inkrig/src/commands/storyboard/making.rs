//! Frames are read, and made one animation.

use crate::cli::{BlendArg, ExactArg, StepsArg, StoryboardArgs};
use crate::commands::generate::{Model, about, sampling};
use crate::console::Console;
use crate::error::CliError;
use crate::{printable, readers};
use inkrig_generate::blending::BlendOptions;
use inkrig_generate::guidance::SettleOptions;
use inkrig_generate::sampling::{Sampler, SamplingOptions};
use inkrig_generate::text::TextEncoder;
use inkrig_motion::humanml::FRAME_RATE;
use inkrig_sketch::storyboard::Storyboard;
use inkrig_storyboard::{
    Animation, Blender, Exact, Generated, Maker, MakerOptions, MeetOptions, StoryboardError, Understood,
    animation, read_figure, understand,
};
use std::ops::ControlFlow;
use std::path::Path;

/// How frames are made.
#[derive(Debug, Clone)]
pub(in crate::commands) struct Settings {
    pub(in crate::commands) exact: ExactArg,
    pub(in crate::commands) blend: BlendArg,
    pub(in crate::commands) steps: Option<StepsArg>,
    pub(in crate::commands) text_weight: Option<f32>,
    pub(in crate::commands) candidates: usize,
    pub(in crate::commands) guide_every: usize,
    pub(in crate::commands) seed: u64,
}

impl Settings {
    pub(super) fn of(args: &StoryboardArgs) -> Self {
        Self {
            exact: args.exact,
            blend: args.blend,
            steps: args.steps,
            text_weight: args.text_weight.map(|weight| weight as f32),
            candidates: usize::from(args.candidates),
            guide_every: usize::from(args.guide_every),
            seed: args.seed,
        }
    }
}

/// What is made next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::commands) enum Next {
    /// The frame of this number, from 1.
    Frame(usize),
    /// One animation of all.
    Whole,
}

/// Shows on the console what is made of that many frames.
pub(in crate::commands) fn shown(console: &Console, frames: usize) -> impl FnMut(Next) -> ControlFlow<()> {
    let mut stage = None;
    move |next| {
        drop(stage.take());
        stage = Some(console.stage(match next {
            Next::Frame(number) => format!("frame {number} of {frames}"),
            Next::Whole => "joining, and meeting the lines".into(),
        }));
        ControlFlow::Continue(())
    }
}

/// What came of all frames.
pub(in crate::commands) struct Made {
    /// Of each frame, before they were joined.
    pub(in crate::commands) clips: Vec<Generated>,
    /// The whole.
    pub(in crate::commands) animation: Animation,
}

fn wrong(path: &Path) -> impl Fn(StoryboardError) -> CliError + '_ {
    |cause| CliError::Storyboard { path: path.into(), cause: Box::new(cause) }
}

/// Reads what is drawn.
pub(in crate::commands) fn frames(
    board: &Storyboard,
    model: &Model,
    path: &Path,
) -> Result<Vec<Understood>, CliError> {
    let wrong = wrong(path);
    let reader = readers::sketch(None)?;
    let lettered = |board: &Storyboard| {
        board.frames.iter().any(|frame| frame.word.trim().is_empty() && !frame.lettering.is_empty())
    };
    let words = if lettered(board) { Some(readers::word(None)?) } else { None };
    let mut understood = Vec::new();
    for (at, frame) in board.frames.iter().enumerate() {
        let number = at + 1;
        let figure = read_figure(frame, number, &reader).map_err(&wrong)?;
        let read = understand(frame, number, figure, &model.body, words.as_ref()).map_err(&wrong)?;
        let most = model.header.sizes.most_frames();
        if read.plan.frames > most {
            return Err(wrong(StoryboardError::Frame {
                frame: number,
                problem: format!(
                    "it lasts {} s, but the model makes at most {} s",
                    printable::fixed(read.plan.frames as f64 / FRAME_RATE, 1),
                    printable::fixed(most as f64 / FRAME_RATE, 1)
                ),
                todo: "Make it shorter, or two frames of it".into(),
            }));
        }
        understood.push(read);
    }
    Ok(understood)
}

/// Makes one animation; `watch` is told what is next, and may stop it.
pub(in crate::commands) fn make(
    understood: &[Understood],
    model: &Model,
    encoder: &dyn TextEncoder,
    settings: &Settings,
    path: &Path,
    watch: &mut dyn FnMut(Next) -> ControlFlow<()>,
) -> Result<Made, CliError> {
    let wrong = wrong(path);
    let mut goes_on =
        |next| if watch(next).is_break() { Err(wrong(StoryboardError::Stopped)) } else { Ok(()) };
    let usual = sampling(&model.header, settings.steps, &model.path)?;
    let options = MakerOptions {
        sampling: SamplingOptions {
            text_weight: settings.text_weight.unwrap_or(usual.text_weight),
            guide_every: settings.guide_every,
            settle: Some(SettleOptions::default()),
            ..usual
        },
        drawn: settings.exact != ExactArg::Off,
        candidates: settings.candidates,
        seed: settings.seed,
    };
    let no_text = encoder.encode("").map_err(|cause| about(&model.path, cause))?;
    let text = |number: usize, word: &str| {
        let description = if word.is_empty() { String::new() } else { model.description(word) };
        let failed = |cause| wrong(StoryboardError::Generate { frame: number, cause: Box::new(cause) });
        encoder.encode(&description).map_err(failed)
    };
    let texts: Vec<Vec<f32>> = understood
        .iter()
        .enumerate()
        .map(|(at, frame)| text(at + 1, &frame.plan.word))
        .collect::<Result<_, _>>()?;
    let networks = model.networks()?;
    let maker = Maker {
        networks,
        features: &model.features,
        places: &model.places,
        no_text: &no_text,
        usual_frames: model.usual_frames(),
    };
    let mut clips = Vec::new();
    for (at, (frame, text)) in understood.iter().zip(&texts).enumerate() {
        goes_on(Next::Frame(at + 1))?;
        clips.push(maker.clip(at + 1, &frame.plan, text, &options).map_err(&wrong)?);
    }
    goes_on(Next::Whole)?;
    let sampler = Sampler { networks, features: &model.features, no_text: &no_text };
    let both: Vec<Vec<f32>> = texts
        .windows(2)
        .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| 0.5 * (a + b)).collect())
        .collect();
    let blending = BlendOptions {
        text_weight: options.sampling.text_weight,
        guide_every: 10,
        ..BlendOptions::default()
    };
    let blender = Blender { sampler: &sampler, texts: &both, options: &blending };
    let blender = Some(blender).filter(|_| settings.blend == BlendArg::Model);
    let exact = match settings.exact {
        ExactArg::Off => Exact::Off,
        ExactArg::Soft => Exact::Soft,
        ExactArg::Pin => Exact::Pin(MeetOptions::default()),
    };
    let animation = animation(&clips, blender, &model.body, &exact).map_err(&wrong)?;
    Ok(Made { clips, animation })
}
