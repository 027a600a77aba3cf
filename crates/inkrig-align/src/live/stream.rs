//! A control whose end is not known: a pen, a slider, a microphone, a performer.

use super::window::Window;
use crate::alignment::table;
use crate::coarse_to_fine::{Frames, Prepared};
use crate::prepared_clip::PreparedClip;
use crate::reconstruct::{PoseBlend, SparseRow};
use crate::{AlignError, Options, Solver, pca};
use inkrig_motion::channels::Journey;
use inkrig_motion::{Clip, Takes};
use inkrig_transport::with_threads;
use std::time::Instant;

/// How a stream is followed. Samples come at the [matching rate](Options::matching_rate).
#[derive(Debug, Clone, PartialEq)]
pub struct StreamOptions {
    /// Weights, norms and features; of its schedule the first solve takes all, every later one
    /// [`rounds`](Self::rounds) of [`iterations`](Options::iterations). Keys are not for streams.
    pub align: Options,
    /// Samples that are always waited for before a frame is given out, at least 1: the latency is this and
    /// [`hop`](Self::hop). Fewer than a patch make the motion less sure of itself.
    pub look_ahead: usize,
    /// Samples that are taken in at once, at least 1.
    pub hop: usize,
    /// Samples that are looked back on, with those ahead.
    pub window: usize,
    /// Samples before the first frame is given out: what the control's size is judged by.
    pub warm_up: usize,
    /// Match-and-blend rounds of every hop.
    pub rounds: usize,
}

impl Default for StreamOptions {
    /// Half a second ahead, 5 seconds back, a tenth of a second at once, 2 seconds to begin, at 30 samples a second.
    fn default() -> Self {
        let align = Options { iterations: 3, ..Options::default() };
        Self { align, look_ahead: 15, hop: 3, window: 150, warm_up: 60, rounds: 2 }
    }
}

/// Follows a control sample by sample. What was given out never changes, memory does not grow, and the motion goes on
/// from piece to piece without a jump: a new plan takes over frame by frame, from none of it where the last piece
/// ended to all of it where the control ends.
#[derive(Debug)]
pub struct StreamAlignment {
    options: StreamOptions,
    clip: PreparedClip,
    source: Prepared,
    poses: PoseBlend,
    journey: Journey,
    window: Window,
    /// Numbers of a sample; 0 before the first.
    width: usize,
    /// Samples that wait for the rest of their hop.
    waiting: Vec<f32>,
    /// Rows of weights from the last one that was given out on.
    rows: Vec<SparseRow>,
    /// Frames given out, at the clip's own rate.
    frames: usize,
}

/// What came of some samples.
#[derive(Debug, Clone)]
pub struct StreamPiece {
    /// The motion's next frames at the clip's own rate, beginning one frame after the last piece; `None` when there are
    /// none yet.
    pub clip: Option<Clip>,
    /// Frames at the clip's own rate that were given out before this piece.
    pub first_frame: usize,
    /// Samples whose motion was given out, with this piece.
    pub samples_given: usize,
    /// For each of this piece's samples, frames of the source at the matching rate and their weights, of sum 1.
    pub weights: Vec<Vec<(usize, f32)>>,
    /// Seconds that the call took.
    pub seconds: f64,
}

impl StreamAlignment {
    /// Prepares a clip.
    ///
    /// # Errors
    /// As [`align`](crate::align), for what concerns the clip and the options.
    pub fn new(source: &Takes, options: &StreamOptions) -> Result<Self, AlignError> {
        // Windows go on from tables of all distances.
        let align = Options { solver: Solver::Dense, ..options.align.clone() };
        let options = &StreamOptions { align, ..options.clone() };
        let align = &options.align;
        align.validate()?;
        let check = |name, value: usize, low: usize, range| {
            let good = (low..=10_000).contains(&value);
            if good { Ok(()) } else { Err(AlignError::Option { name, value: value as f64, range }) }
        };
        let least = 2 * align.patch();
        check("look-ahead", options.look_ahead, 1, "from 1 to 10000 samples")?;
        check("hop", options.hop, 1, "from 1 to 10000 samples")?;
        check("rounds", options.rounds, 1, "from 1 to 10000")?;
        check("warm-up", options.warm_up, least, "from two patches to 10000 samples")?;
        let least = options.look_ahead + options.hop + least;
        check(
            "window",
            options.window,
            least,
            "from the look-ahead, the hop and two patches to 10000 samples",
        )?;
        if !align.keys.is_empty() {
            let what = "a control without an end has no place for keyframes: leave them out".to_string();
            return Err(AlignError::Key { what });
        }
        let clip = PreparedClip::new(source, align)?;
        let reduced = pca::reduce(table(&clip.features)?, pca::FEATURE_ENERGY, align.threads)?.frames;
        let source = Prepared::source(Frames { table: reduced.view(), layout: &clip.columns }, align)?;
        Ok(Self {
            poses: PoseBlend::new(&clip.source, &clip.matched, align),
            window: Window::new(options),
            options: options.clone(),
            clip,
            source,
            journey: Journey::default(),
            width: 0,
            waiting: Vec::new(),
            rows: Vec::new(),
            frames: 0,
        })
    }

    /// Takes some samples in, row after row of `width` numbers, and gives out what they settle.
    ///
    /// # Errors
    /// When a sample is not finite or has another width than those before it.
    pub fn append(&mut self, samples: &[f32], width: usize) -> Result<StreamPiece, AlignError> {
        let begin = Instant::now();
        let known = if self.width == 0 { width } else { self.width };
        if width == 0 || width != known || !samples.len().is_multiple_of(width) {
            return Err(AlignError::Samples { what: "samples must all have the same number of values" });
        }
        if samples.iter().any(|value| !value.is_finite() || value.abs() > 1e9) {
            return Err(AlignError::Samples { what: "a sample is not a number, or larger than 1e9" });
        }
        self.width = width;
        self.waiting.extend_from_slice(samples);
        let given = self.window.given();
        let hop = self.options.hop * width;
        while self.waiting.len() >= hop {
            let next: Vec<f32> = self.waiting.drain(..hop).collect();
            self.take_in(&next, false)?;
        }
        self.piece(given, false, begin)
    }

    /// Ends the control and gives out what is left.
    ///
    /// # Errors
    /// [`AlignError::ControlTooShort`] when there were fewer samples than two patches, [`AlignError::StillControl`] when
    /// they never changed.
    pub fn finish(mut self) -> Result<StreamPiece, AlignError> {
        let begin = Instant::now();
        let given = self.window.given();
        let last = std::mem::take(&mut self.waiting);
        self.take_in(&last, true)?;
        self.piece(given, true, begin)
    }

    /// Samples between a sample and the motion that it settles, at most.
    pub fn latency(&self) -> usize {
        self.options.look_ahead + self.options.hop
    }

    /// Samples that are held: no more than the window and a hop, once it has begun.
    pub fn window_samples(&self) -> usize {
        self.window.samples(self.width)
    }

    /// The part of the source that is used: without rest-pose lead-ins.
    pub fn source(&self) -> &Takes {
        &self.clip.source
    }

    fn take_in(&mut self, samples: &[f32], end: bool) -> Result<(), AlignError> {
        let Self { window, source, options, rows, width, .. } = self;
        with_threads(options.align.threads, || {
            rows.extend(window.take_in(samples, *width, source, options, end)?);
            Ok(())
        })
    }

    /// The frames of all rows since the last piece.
    fn piece(&mut self, given: usize, end: bool, begin: Instant) -> Result<StreamPiece, AlignError> {
        let samples_given = self.window.given();
        let first_frame = self.frames;
        let mut clip = None;
        if !self.rows.is_empty() {
            let first = samples_given - self.rows.len();
            clip = self.poses.piece(&self.rows, first, self.frames, end, &mut self.journey)?;
        }
        self.frames += clip.as_ref().map_or(0, Clip::frames);
        let weights = self.rows[self.rows.len() - (samples_given - given)..].to_vec();
        // Frames between this piece's last sample and the next piece's first need both.
        self.rows.drain(..self.rows.len().saturating_sub(1));
        Ok(StreamPiece { clip, first_frame, samples_given, weights, seconds: begin.elapsed().as_secs_f64() })
    }
}
