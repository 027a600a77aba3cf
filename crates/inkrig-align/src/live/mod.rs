//! Following a control that changes while one looks: strokes redrawn, and samples that come as they are made.

mod control_side;
mod finer;
mod stream;
mod warm;
mod window;

pub use stream::{StreamAlignment, StreamOptions, StreamPiece};

use crate::alignment::{at_rate, check_control, table};
use crate::blend::{Window, frame_weights};
use crate::coarse_to_fine::{Buffers, Frames, Prepared};
use crate::keys::Keys;
use crate::level::Level;
use crate::pca::{Reduced, Subspace};
use crate::polish::polish;
use crate::prepared_clip::PreparedClip;
use crate::pyramid::resample_frames;
use crate::reconstruct::{Ends, PoseBlend, Rules, SparseRow, kept};
use crate::suggest::{Moment, places};
use crate::{AlignError, Control, Options, Progress, Solver, pca};
use control_side::ControlSide;
use finer::at_full_length;
use inkrig_motion::{Clip, Takes};
use inkrig_transport::{Mat, Start, with_threads};
use std::ops::ControlFlow;
use std::time::Instant;
use warm::FirstPlan;

/// A clip that follows a control which is still being changed. Everything that depends on the clip alone is prepared
/// once; an update begins with the plans of the one before and computes only the distances that changed.
#[derive(Debug)]
pub struct LiveAlignment {
    clip: PreparedClip,
    reduced: Reduced,
    poses: PoseBlend,
    schedule: Schedule,
    settled: Schedule,
    buffers: Buffers,
    control: Option<Control>,
}

/// What an update says while it runs.
#[derive(Debug)]
pub enum LiveEvent {
    /// It got on, and can be stopped here. A warm update takes some gradients more than the schedule counts.
    Step(Progress),
    /// A motion, coarse ones first.
    Answer(Box<LiveAnswer>),
}

/// Called for every event of an update. [`ControlFlow::Break`] ends it with [`AlignError::Cancelled`]: a newer stroke is
/// there.
pub type LiveObserver<'a> = &'a mut (dyn FnMut(LiveEvent) -> ControlFlow<()> + Send);

/// One motion for the control as it was given.
#[derive(Debug, Clone)]
pub struct LiveAnswer {
    /// The motion, at the clip's own frame rate and of the control's full length, whatever the level.
    pub clip: Clip,
    /// Which frames it is made of: control samples at the matching rate x source frames at the matching rate, rows sum
    /// to 1.
    pub weights: Mat<f32>,
    /// The level it was found at; 1 is the coarsest.
    pub level: usize,
    /// Number of levels.
    pub levels: usize,
    /// Whether no better one will come of this update.
    pub is_final: bool,
    /// Whether it went on from the first plan of the last update; the first one cannot, and one that found a better place
    /// to begin at does not.
    pub warm: bool,
    /// Patches of the control whose distances were computed anew.
    pub changed_patches: usize,
    /// Seconds since the update began.
    pub seconds: f64,
}

type MakeAnswer<'a> =
    dyn FnMut(Mat<f32>, &[usize], (usize, usize), bool) -> Result<LiveAnswer, AlignError> + 'a;

/// A schedule of levels, and what is kept of its last run.
#[derive(Debug)]
struct Schedule {
    options: Options,
    source: Option<Prepared>,
    control: Option<ControlSide>,
    first: Option<FirstPlan>,
}

impl LiveAlignment {
    /// Prepares a clip. `options` are those of a finished result, see [`settle`](Self::settle); updates take their
    /// [`preview_schedule`](Options::preview_schedule).
    ///
    /// # Errors
    /// As [`align`](crate::align), for what concerns the clip and the options.
    pub fn new(source: &Takes, options: &Options) -> Result<Self, AlignError> {
        options.validate()?;
        // Only what changed of the tables is made anew, so they have to be there.
        let options = &Options { solver: Solver::Dense, ..options.clone() };
        let clip = PreparedClip::new(source, options)?;
        let reduced = pca::reduce(table(&clip.features)?, pca::FEATURE_ENERGY, options.threads)?;
        let poses = PoseBlend::new(&clip.source, &clip.matched, options);
        let schedule = |options| Schedule { options, source: None, control: None, first: None };
        let mut live = Self {
            poses,
            schedule: schedule(options.clone().preview_schedule()),
            settled: schedule(options.clone()),
            buffers: Buffers::new(options.threads),
            control: None,
            clip,
            reduced,
        };
        live.schedule.prepare(&live.reduced.frames, &live.clip)?;
        Ok(live)
    }

    /// The control as it is now: another number of samples than before is fine. Gives an answer for every level, the
    /// coarsest first.
    ///
    /// # Errors
    /// As [`align`](crate::align), for what concerns the control; [`AlignError::Cancelled`].
    pub fn update(&mut self, control: &Control, observer: LiveObserver<'_>) -> Result<(), AlignError> {
        self.control = Some(control.clone());
        self.schedule.run(
            control,
            (&self.clip, &self.reduced.subspace, &mut self.poses),
            &mut self.buffers,
            observer,
        )
    }

    /// The motion of the last control with all levels and rounds, as [`align`](crate::align) finds it: for when the pen
    /// is lifted. Does nothing before the first update.
    ///
    /// # Errors
    /// As for [`update`](Self::update).
    pub fn settle(&mut self, observer: LiveObserver<'_>) -> Result<(), AlignError> {
        let Some(control) = &self.control else { return Ok(()) };
        self.settled.prepare(&self.reduced.frames, &self.clip)?;
        self.settled.forget();
        self.settled.run(
            control,
            (&self.clip, &self.reduced.subspace, &mut self.poses),
            &mut self.buffers,
            observer,
        )
    }

    /// Other options, where what was prepared stays good for them: weights, keys, mirror, seed and schedule may differ.
    /// Says whether it did; a clip has to be prepared anew for others.
    pub fn set_options(&mut self, options: &Options) -> bool {
        let options = &Options { solver: Solver::Dense, ..options.clone() };
        let same = |schedule: &Schedule, options: &Options| {
            let prepared = Options {
                levels: options.levels,
                ratio: options.ratio,
                patch_seconds: options.patch_seconds,
                source_norm: options.source_norm,
                control_norm: options.control_norm,
                matching_rate: options.matching_rate,
                features: options.features,
                travel: options.travel,
                threads: options.threads,
                ..schedule.options.clone()
            };
            prepared == schedule.options
        };
        let preview = options.clone().preview_schedule();
        let good =
            options.validate().is_ok() && same(&self.settled, options) && same(&self.schedule, &preview);
        if good {
            self.schedule.options = preview;
            self.settled.options = options.clone();
        }
        good
    }

    /// For every column of an answer's weights the frame of the source, as it was given.
    pub fn moments(&self) -> Vec<Moment> {
        places(&self.clip.given, &self.clip.lead_ins, &self.clip.matched)
    }

    /// Lets the next update begin as the first one did.
    pub fn forget(&mut self) {
        self.schedule.forget();
    }

    /// The part of the source that is used: without rest-pose lead-ins.
    pub fn source(&self) -> &Takes {
        &self.clip.source
    }
}

impl Schedule {
    fn prepare(&mut self, reduced: &Mat<f32>, clip: &PreparedClip) -> Result<(), AlignError> {
        if self.source.is_none() {
            let frames = Frames { table: reduced.view(), layout: &clip.columns };
            self.source = Some(Prepared::source(frames, &self.options)?);
        }
        Ok(())
    }

    fn forget(&mut self) {
        self.control = None;
        self.first = None;
    }

    fn run(
        &mut self,
        control: &Control,
        (clip, subspace, poses): (&PreparedClip, &Subspace, &mut PoseBlend),
        b: &mut Buffers,
        observer: LiveObserver<'_>,
    ) -> Result<(), AlignError> {
        let begin = Instant::now();
        control.validate()?;
        check_control(&clip.source, control, &self.options)?;
        let (drawn, rows) = at_rate(control, &self.options);
        let keys = clip.keys(subspace, control, &rows, &self.options)?;
        let given = (&drawn, &rows);
        with_threads(self.options.threads, || {
            let changed_patches = match &mut self.control {
                Some(side) => side.update(control, given, &self.options)?,
                side => {
                    *side = Some(ControlSide::new(control, given, &self.options)?);
                    rows.patches()
                }
            };
            let ends = if control.cyclic { Ends::Loop } else { Ends::Open };
            let anchors = keys.anchors();
            self.solve(&keys, b, observer, &mut |weights, forbidden, (level, levels), warm| {
                let rules = Rules { ends, anchors: &anchors, forbidden };
                Ok(LiveAnswer {
                    clip: poses.clip(&rows_of(&weights), rules)?,
                    weights,
                    level,
                    levels,
                    is_final: level == levels,
                    warm,
                    changed_patches,
                    seconds: begin.elapsed().as_secs_f64(),
                })
            })
        })
    }

    /// Goes through the levels; `answer` makes an answer of weights, source frames that may not appear (at the finest
    /// level), a level of how many, and whether it began warm.
    fn solve(
        &mut self,
        keys: &Keys,
        b: &mut Buffers,
        observer: LiveObserver<'_>,
        answer: &mut MakeAnswer<'_>,
    ) -> Result<(), AlignError> {
        let Self { options, source: Some(source), control: Some(side), first } = self else { return Ok(()) };
        let control = &side.prepared;
        let (count, total, threads) = (source.levels().len(), options.gradients(), options.threads);
        let first = first.get_or_insert_with(|| FirstPlan::new(threads));
        let (mut done, mut warm) = (0, false);
        for index in 0..count {
            let level = Level::new(source, control, index, keys)?;
            let mut tell = |done| {
                let progress = Progress { level: index + 1, levels: count, done, total };
                go_on(observer, LiveEvent::Step(progress))
            };
            let start = if index == 0 {
                let begun = first.find(&level, (&side.drawn, options), b, &mut tell)?;
                (warm, done) = (begun.warm, begun.gradients);
                level.blend(b.transport.plan().dense(), &mut b.weights, &mut b.blended, threads)?;
                Start::Continue
            } else {
                std::mem::swap(&mut b.blended, &mut b.coarser);
                let coarser = &control.levels()[index - 1].layout;
                resample_frames(b.coarser.view(), coarser, &level.control.layout, &mut b.blended);
                Start::Perturbed(options.seed)
            };
            let before = done;
            done += level.rounds(start, options, b, |done| tell(before + done))?;
            let mut forbidden = Vec::new();
            let weights = if index + 1 == count {
                forbidden = level.asked.forbidden_frames(level.layouts().1);
                let plan = polish(&level, options, b, || Ok(()))?;
                frame_weights(plan.dense(), level.layouts(), Window::Hann, &mut b.weights, threads);
                std::mem::take(&mut b.weights)
            } else {
                at_full_length(&b.weights, level.layouts(), (control.layout(), source.layout()))
            };
            let answer = answer(weights, &forbidden, (index + 1, count), warm)?;
            go_on(observer, LiveEvent::Answer(Box::new(answer)))?;
        }
        Ok(())
    }
}

/// What is more than rounding in weights.
fn rows_of(weights: &Mat<f32>) -> Vec<SparseRow> {
    (0..weights.rows()).map(|row| kept(weights.row(row))).collect()
}

fn go_on(observer: LiveObserver<'_>, event: LiveEvent) -> Result<(), AlignError> {
    match observer(event) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(AlignError::Cancelled),
    }
}
