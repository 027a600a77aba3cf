//! Frames are read, and made one animation.

use super::takes::{Order, Takes};
use crate::cli::{BlendArg, ExactArg, StepsArg, StoryboardArgs};
use crate::commands::generate::{Model, about, sampling};
use crate::console::Console;
use crate::error::CliError;
use crate::{printable, readers};
use inkrig_generate::blending::BlendOptions;
use inkrig_generate::guidance::SettleOptions;
use inkrig_generate::readers::sketch::SketchReader;
use inkrig_generate::readers::word::WordReader;
use inkrig_generate::sampling::{Sampler, SamplingOptions};
use inkrig_generate::text::TextEncoder;
use inkrig_motion::humanml::FRAME_RATE;
use inkrig_sketch::storyboard::{Frame, Storyboard};
use inkrig_storyboard::{
    Animation, Blender, Exact, Generated, Maker, MakerOptions, MeetOptions, Plan, Space, StoryboardError,
    Understood, animation, check_length, read_figure, understand,
};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// How many motions are made of a frame, and at every how many steps they are drawn to the lines, where nobody says.
pub(in crate::commands) const CANDIDATES: usize = 4;
pub(in crate::commands) const GUIDE_EVERY: usize = 5;

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
            candidates: args.candidates.map_or(CANDIDATES, usize::from),
            guide_every: args.guide_every.map_or(GUIDE_EVERY, usize::from),
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
    /// Which motions land on a character.
    Character,
}

/// Shows on the console what is made of that many frames.
pub(in crate::commands) fn shown(console: &Console, frames: usize) -> impl FnMut(Next) -> GoOn {
    let (mut stage, mut before) = (None, None);
    move |next| {
        if before.replace(next) != Some(next) {
            drop(stage.take());
            stage = Some(console.stage(match next {
                Next::Frame(number) => format!("frame {number} of {frames}"),
                Next::Whole => "joining, and meeting the lines".into(),
                Next::Character => "looking for motions that land on the character".into(),
            }));
        }
        ControlFlow::Continue(0)
    }
}

/// Whether to go on, and on how many threads until the next time; 0 for as many as there are.
pub(in crate::commands) type GoOn = ControlFlow<(), usize>;

/// What came of all frames.
pub(in crate::commands) struct Made {
    /// Of each frame, before they were joined.
    pub(in crate::commands) clips: Vec<Generated>,
    /// All that were sampled for each frame, the best first.
    pub(in crate::commands) ranked: Vec<Arc<[Generated]>>,
    /// The whole.
    pub(in crate::commands) animation: Animation,
}

pub(super) fn exactness(exact: ExactArg) -> Exact {
    match exact {
        ExactArg::Off => Exact::Off,
        ExactArg::Soft => Exact::Soft,
        ExactArg::Pin => Exact::Pin(MeetOptions::default()),
    }
}

pub(super) fn wrong(path: &Path) -> impl Fn(StoryboardError) -> CliError + '_ {
    |cause| CliError::Storyboard { path: path.into(), cause: Box::new(cause) }
}

/// Reads what is drawn.
pub(in crate::commands) fn frames(
    board: &Storyboard,
    model: &Model,
    path: &Path,
) -> Result<Vec<Understood>, CliError> {
    let reader = Reader::open(board, model, path)?;
    let read: Vec<Understood> = (1..)
        .zip(&board.frames)
        .map(|(number, frame)| reader.read(number, frame))
        .collect::<Result<_, _>>()?;
    lasting(read.iter(), path)?;
    Ok(read)
}

/// Whether frames that were read can become one animation.
pub(in crate::commands) fn lasting<'a>(
    read: impl Iterator<Item = &'a Understood>,
    path: &Path,
) -> Result<(), CliError> {
    check_length(read.map(|read| read.plan.frames as f64 / FRAME_RATE)).map_err(wrong(path))
}

/// Reads frames one by one.
pub(in crate::commands) struct Reader<'a> {
    figures: SketchReader,
    words: Option<WordReader>,
    model: &'a Model,
    path: &'a Path,
}

impl<'a> Reader<'a> {
    pub(in crate::commands) fn open(
        board: &Storyboard,
        model: &'a Model,
        path: &'a Path,
    ) -> Result<Self, CliError> {
        let lettered = |frame: &Frame| frame.word.trim().is_empty() && !frame.lettering.is_empty();
        let words = if board.frames.iter().any(lettered) { Some(readers::word(None)?) } else { None };
        Ok(Self { figures: readers::sketch(None)?, words, model, path })
    }

    /// Reads the frame of that number, from 1.
    pub(in crate::commands) fn read(&self, number: usize, frame: &Frame) -> Result<Understood, CliError> {
        let wrong = wrong(self.path);
        let figure = read_figure(frame, number, &self.figures).map_err(&wrong)?;
        let read =
            understand(frame, number, figure, &self.model.body()?, self.words.as_ref()).map_err(&wrong)?;
        let most = self.model.header.sizes.most_frames();
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
        Ok(read)
    }
}

/// A frame to be made.
#[derive(Debug, Clone, Copy)]
pub(in crate::commands) struct Asked<'a> {
    /// Its place in the story, from 1.
    pub(in crate::commands) number: usize,
    pub(in crate::commands) frame: &'a Frame,
    pub(in crate::commands) read: &'a Understood,
    /// Whether it is a part of the animation. Others are made for the paths that later frames take over from them.
    pub(in crate::commands) joined: bool,
}

/// The frames of a storyboard that were read, in their order.
pub(in crate::commands) fn all<'a>(
    board: &'a Storyboard,
    read: impl Iterator<Item = Option<&'a Understood>>,
) -> Vec<Asked<'a>> {
    let frames = (1..).zip(board.frames.iter().zip(read));
    frames
        .filter_map(|(number, (frame, read))| Some(Asked { number, frame, read: read?, joined: true }))
        .collect()
}

/// What makes animations.
#[derive(Clone, Copy)]
pub(in crate::commands) struct Workshop<'a> {
    pub(in crate::commands) model: &'a Model,
    pub(in crate::commands) encoder: &'a dyn TextEncoder,
    pub(in crate::commands) settings: &'a Settings,
    /// What messages name.
    pub(in crate::commands) path: &'a Path,
}

impl Workshop<'_> {
    fn options(&self) -> Result<MakerOptions, CliError> {
        let settings = self.settings;
        let usual = sampling(&self.model.header, settings.steps, &self.model.path)?;
        Ok(MakerOptions {
            sampling: SamplingOptions {
                text_weight: settings.text_weight.unwrap_or(usual.text_weight),
                guide_every: settings.guide_every,
                settle: Some(SettleOptions::default()),
                ..usual
            },
            drawn: settings.exact != ExactArg::Off,
            candidates: settings.candidates,
            seed: settings.seed,
        })
    }

    /// What the clips of a frame depend on; `before` are those of frames before it, with their numbers.
    pub(in crate::commands) fn order(
        &self,
        asked: &Asked<'_>,
        before: &[(usize, Generated)],
    ) -> Result<Order, CliError> {
        let Asked { number, frame, read, .. } = asked;
        let word = &read.plan.word;
        let description = if word.is_empty() { String::new() } else { self.model.description(word) };
        let failed =
            |cause| wrong(self.path)(StoryboardError::Generate { frame: *number, cause: Box::new(cause) });
        let text = self.encoder.encode(&description).map_err(failed)?;
        let leads = read.plan.path_of(*number);
        let leads = leads.and_then(|leads| before.iter().find(|(other, _)| *other == leads));
        let plan = leads.map_or_else(|| read.plan.clone(), |(_, clip)| read.plan.along(&clip.motion));
        let number = frame.number.map_or(*number, |number| number as usize);
        // No sampling sees what is said of the motion in space: whoever moves a joint of it waits for no other motion. Nor is it of
        // consequence which frame a path is from.
        let plan = Plan { space: Space::default(), follows: None, ..plan };
        Ok(Order { plan, text, options: self.options()?, number })
    }

    /// Makes one animation of the frames that are joined; `watch` is told what is next, and may stop it. What is kept of earlier times is not made again.
    pub(in crate::commands) fn make(
        &self,
        frames: &[Asked<'_>],
        takes: &mut Takes,
        watch: &mut dyn FnMut(Next) -> GoOn,
    ) -> Result<Made, CliError> {
        self.make_near(frames, &[], takes, watch)
    }

    /// The clip of a frame, where it is kept.
    pub(in crate::commands) fn kept(
        &self,
        asked: &Asked<'_>,
        before: &[(usize, Generated)],
        takes: &mut Takes,
    ) -> Result<Option<Generated>, CliError> {
        let known = takes.of(&self.order(asked, before)?);
        Ok(known.and_then(|all| self.taken(asked, &all).ok()))
    }

    /// The same, where denoising of each frame begins with a motion, as far as there are some.
    pub(super) fn make_near(
        &self,
        frames: &[Asked<'_>],
        near: &[Generated],
        takes: &mut Takes,
        watch: &mut dyn FnMut(Next) -> GoOn,
    ) -> Result<Made, CliError> {
        let Self { model, encoder, settings, path } = *self;
        let wrong = wrong(path);
        let no_text = encoder.encode("").map_err(|cause| about(&model.path, cause))?;
        let (networks, body) = (model.networks()?, model.body()?);
        let maker = Maker {
            networks,
            features: &model.features,
            places: &model.places,
            no_text: &no_text,
            body: &body,
            usual_frames: model.usual_frames(),
        };
        let (mut made, mut ranked, mut texts) = (Vec::new(), Vec::new(), Vec::new());
        for (at, asked) in frames.iter().enumerate() {
            let number = asked.number;
            let threads = self.goes_on(watch, Next::Frame(number))?;
            let order = self.order(asked, &made)?;
            let text = order.text.clone();
            let known = takes.of(&order);
            let all = match known {
                Some(known) => known,
                None => {
                    let Order { number: of, plan, text, options } = &order;
                    let made = on(threads, || match near.get(at) {
                        Some(near) => maker.takes_near(*of, plan, text, &near.motion, options),
                        None => maker.takes(*of, plan, text, options),
                    });
                    let made = made.map_err(|cause| wrong(of_frame(cause, number)))?;
                    takes.keep(order, made)
                }
            };
            made.push((number, self.taken(asked, &all)?));
            if asked.joined {
                texts.push(text);
                ranked.push(all);
            }
        }
        let frames: Vec<Asked<'_>> = frames.iter().filter(|asked| asked.joined).copied().collect();
        let is_joined = |number: usize| frames.iter().any(|asked| asked.number == number);
        let clips: Vec<Generated> =
            made.into_iter().filter(|(number, _)| is_joined(*number)).map(|(_, clip)| clip).collect();
        let threads = self.goes_on(watch, Next::Whole)?;
        let sampler = Sampler { networks, features: &model.features, no_text: &no_text };
        let both: Vec<Vec<f32>> = texts
            .windows(2)
            .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| 0.5 * (a + b)).collect())
            .collect();
        let blending = BlendOptions {
            text_weight: self.options()?.sampling.text_weight,
            guide_every: 10,
            ..BlendOptions::default()
        };
        let blender = Blender { sampler: &sampler, texts: &both, options: &blending };
        let blender = Some(blender).filter(|_| settings.blend == BlendArg::Model);
        let exact = exactness(settings.exact);
        let animation = on(threads, || animation(&clips, blender, &body, &exact))
            .map_err(|cause| wrong(of_row(cause, &frames)))?;
        Ok(Made { clips, ranked, animation })
    }

    /// Tells what is next; gives the number of threads for it.
    fn goes_on(&self, watch: &mut dyn FnMut(Next) -> GoOn, next: Next) -> Result<usize, CliError> {
        match watch(next) {
            ControlFlow::Break(()) => Err(wrong(self.path)(StoryboardError::Stopped)),
            ControlFlow::Continue(threads) => Ok(threads),
        }
    }

    /// The one of a frame's clips that it says, with what it says of that in space.
    fn taken(&self, asked: &Asked<'_>, all: &[Generated]) -> Result<Generated, CliError> {
        let take = asked.frame.take as usize;
        let mut clip = all.get(take).cloned().ok_or_else(|| {
            wrong(self.path)(StoryboardError::Frame {
                frame: asked.number,
                problem: format!("take {take} is wanted, but {} are made, from 0", all.len()),
                todo: "Leave `take` out for the best, or give more --candidates".into(),
            })
        })?;
        clip.plan.space = asked.read.plan.space.clone();
        clip.plan.follows = asked.read.plan.follows;
        Ok(clip)
    }
}

/// The number that samples are made with need not be the frame's place, which messages name.
fn of_frame(cause: StoryboardError, frame: usize) -> StoryboardError {
    match cause {
        StoryboardError::Generate { cause, .. } => StoryboardError::Generate { frame, cause },
        other => other,
    }
}

/// Clips are counted among those that are joined; messages name frames of the storyboard.
fn of_row(cause: StoryboardError, asked: &[Asked<'_>]) -> StoryboardError {
    let number =
        |row: usize| row.checked_sub(1).and_then(|at| asked.get(at)).map_or(row, |asked| asked.number);
    match cause {
        StoryboardError::Frame { frame, problem, todo } => {
            StoryboardError::Frame { frame: number(frame), problem, todo }
        }
        StoryboardError::Generate { frame, cause } => {
            StoryboardError::Generate { frame: number(frame), cause }
        }
        other => other,
    }
}

/// Works on that many threads; 0 for as many as there are.
fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = (threads > 0).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    match pool {
        Some(Ok(pool)) => pool.install(work),
        // Without threads of their own, on those that all share.
        _ => work(),
    }
}
