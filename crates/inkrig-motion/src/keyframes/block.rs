//! Fewest keys for a part of a motion.

use super::body::{Allowed, Body, Scope};
use super::fit::{Knot, Numbers, Piece, SAMPLES};
use super::reference::{Reference, slope, unit};
use super::{RotationForm, angles};
use crate::Skeleton;
use glam::DQuat;

/// Keys of every channel for the frames from `first` to `last`, both included; none of a channel that is still. Keys stand
/// on the `given` frames (rising), exactly as the motion is there. `before`: keys of the frames before, which angles run on from.
pub(super) fn thin(
    skeleton: &Skeleton,
    references: &[Reference],
    (first, last): (usize, usize),
    (given, form): (&[usize], RotationForm),
    allowed: Allowed,
    before: &[Vec<Knot>],
) -> Vec<Vec<Knot>> {
    let body = Body::new(skeleton, references, first * SAMPLES..last * SAMPLES + 1);
    let given: Vec<bool> = (first..=last)
        .map(|frame| frame == first || frame == last || given.binary_search(&frame).is_ok())
        .collect();
    let heights = heights(skeleton, references);
    let highest = heights.iter().copied().max().unwrap_or(0).max(1) as f64;
    let mut thinner = Thinner { body, first, form, allowed, given, target: Vec::new(), weights: Vec::new() };
    let mut all: Vec<Vec<Knot>> = vec![Vec::new(); references.len()];
    for ((reference, knots), before) in references.iter().zip(&mut all).zip(before) {
        if reference.still {
            continue;
        }
        let height = heights[reference.joint] + usize::from(!reference.turns);
        let share = 1.0 - (1.0 - FIRST) * (height as f64 / highest).min(1.0);
        let before = before.last().map_or([0.0; 4], |knot| knot.value);
        *knots = thinner.fewest(reference, before, Scope::Near(share));
    }
    for (reference, knots) in references.iter().zip(&mut all).filter(|(reference, _)| !reference.still).rev()
    {
        thinner.centre(reference, knots.first().map_or([0.0; 4], |knot| knot.value));
        thinner.refine(reference, knots);
        thinner.smooth(reference, knots);
    }
    all
}

/// The numbers of a rotation of unit length; angles near to those before.
pub(super) fn numbers(form: RotationForm, value: &Numbers, before: Numbers) -> Numbers {
    match form {
        RotationForm::Quaternion => *value,
        RotationForm::Angles { axes } => {
            let axes = axes.as_dquat();
            angles::near((axes.inverse() * DQuat::from_array(*value) * axes).normalize(), before)
        }
    }
}

/// How many joints with curves of their own hang below each, one on the other.
fn heights(skeleton: &Skeleton, references: &[Reference]) -> Vec<usize> {
    let mut moves = vec![false; skeleton.len()];
    references.iter().filter(|reference| !reference.still).for_each(|r| moves[r.joint] = true);
    let mut heights = vec![0; skeleton.len()];
    for joint in (0..skeleton.len()).rev() {
        if let Some(parent) = skeleton.joints()[joint].parent {
            heights[parent] = heights[parent].max(heights[joint] + usize::from(moves[joint]));
        }
    }
    heights
}

pub(super) struct Thinner<'s> {
    body: Body<'s>,
    /// Frame that the body begins with.
    pub(super) first: usize,
    pub(super) form: RotationForm,
    allowed: Allowed,
    /// Frames that must be keys.
    pub(super) given: Vec<bool>,
    /// What the channel should do, from the body's first sample on.
    pub(super) target: Vec<Numbers>,
    pub(super) weights: Vec<f64>,
}

/// What part of the tolerance the joint on which all others hang may spend; those at the ends may spend it all.
const FIRST: f64 = 0.6;

/// Longest way between two keys, frames.
pub(super) const LONGEST: usize = 120;

/// Up to so many frames a piece is compared with others that take as many keys.
const SHORT: usize = 24;

/// So many lengths in a row that cannot be bridged end the search for a longer one.
const HOPELESS: usize = 5;

/// How often a piece is fitted anew, with more weight on what was farthest off (Lawson 1961).
const FITS: usize = 7;

impl Thinner<'_> {
    /// The fewest keys of a channel, every frame being looked at for one, and of those the ones that leave least to the
    /// joints below (shortest path), and makes it so.
    fn fewest(&mut self, reference: &Reference, before: Numbers, scope: Scope) -> Vec<Knot> {
        self.aim(reference, before);
        let values: Vec<Numbers> = self.target.iter().step_by(SAMPLES).copied().collect();
        let last = values.len() - 1;
        // For each frame how many keys lead to it, the squares of all errors until then, and the curve from the key before.
        let mut ways: Vec<Option<(usize, f64, Piece)>> = vec![None; last + 1];
        for from in 0..last {
            let (keys, spent) = ways[from].map_or((0, 0.0), |(keys, spent, _)| (keys, spent));
            let mut failed = 0;
            for to in from + 1..=last.min(from + LONGEST) {
                // Long pieces are taken as they are found: to compare them all takes too long.
                let choosy = to - from <= SHORT;
                let better = |spent: f64, way: Option<(usize, f64, Piece)>| {
                    way.is_none_or(|(least, lost, _)| {
                        keys + 1 < least || (choosy && keys + 1 == least && spent < lost)
                    })
                };
                if better(spent, ways[to]) {
                    let slopes = [slope(&values, from), slope(&values, to)];
                    let mut piece = Piece { length: to - from, from: values[from], to: values[to], slopes };
                    if self.fitted(reference, &mut piece, from, scope) {
                        let errors = piece.samples().zip(from * SAMPLES..);
                        let squares =
                            errors.map(|(value, at)| self.error(reference, at, value, scope).powi(2));
                        let spent = spent + squares.sum::<f64>();
                        if better(spent, ways[to]) {
                            ways[to] = Some((keys + 1, spent, piece));
                        }
                        failed = 0;
                    } else {
                        failed += 1;
                    }
                }
                if failed == HOPELESS || self.given[to] {
                    break;
                }
            }
        }
        let mut knots = Vec::new();
        let (mut frame, mut after) = (last, None);
        loop {
            let before = ways[frame].map(|(_, _, piece)| piece);
            let slopes = [before.map(|piece| piece.slopes[1]), after];
            knots.push(Knot {
                frame: self.first + frame,
                value: values[frame],
                slope_in: slopes[0].or(slopes[1]).unwrap_or_default(),
                slope_out: slopes[1].or(slopes[0]).unwrap_or_default(),
            });
            let Some(piece) = before else { break };
            after = Some(piece.slopes[0]);
            frame -= piece.length;
        }
        knots.reverse();
        for pair in knots.windows(2) {
            let [from, to] = pair else { continue };
            self.set(reference, &Piece::between(from, to), from.frame);
        }
        knots
    }

    /// Fits a piece that begins at a frame of the body; whether it keeps to what is allowed. A piece of one frame always
    /// does.
    fn fitted(&mut self, reference: &Reference, piece: &mut Piece, from: usize, scope: Scope) -> bool {
        if piece.length == 1 {
            return true;
        }
        let (start, count) = (from * SAMPLES, piece.length * SAMPLES);
        let mut weights = std::mem::take(&mut self.weights);
        weights.clear();
        weights.extend((0..=count).map(|sample| if sample % SAMPLES == 0 { 1.0 } else { 0.25 }));
        let mut fits = false;
        for fit in 0..FITS {
            if !piece.fit(&self.target[start..=start + count], &weights) {
                break;
            }
            let (mut worst, mut squares, mut sum) = (0.0_f64, 0.0, 0.0);
            for (sample, value) in piece.samples().enumerate().take(count).skip(1) {
                let error = self.error(reference, start + sample, value, scope);
                worst = worst.max(error);
                squares += weights[sample] * error * error;
                sum += weights[sample];
                weights[sample] *= error + 0.05;
            }
            fits = worst <= 1.0;
            // No other slopes have a smaller largest error than this mean, but for its not being quite linear.
            if fits || (fit == 0 && worst > 4.0) || squares > 1.03 * sum {
                break;
            }
            weights.iter_mut().for_each(|weight| *weight /= sum);
        }
        self.weights = weights;
        fits
    }

    /// Finds what the channel should do; angles run on from those before.
    fn aim(&mut self, reference: &Reference, before: Numbers) {
        self.target = self.body.target(reference, self.first * SAMPLES, self.allowed);
        self.number(reference, before);
    }

    /// Finds what the channel should do while all others stay what they are.
    fn centre(&mut self, reference: &Reference, before: Numbers) {
        self.target = self.body.centre(reference, self.first * SAMPLES, self.allowed);
        self.number(reference, before);
    }

    fn number(&mut self, reference: &Reference, mut before: Numbers) {
        for value in self.target.iter_mut().filter(|_| reference.turns) {
            *value = numbers(self.form, value, before);
            before = *value;
        }
    }

    /// What the numbers of a curve are: a rotation of unit length or a translation.
    fn pose(&self, reference: &Reference, value: Numbers) -> Numbers {
        match self.form {
            _ if !reference.turns => value,
            RotationForm::Quaternion => unit(value),
            RotationForm::Angles { axes } => {
                let axes = axes.as_dquat();
                (axes * angles::rotation(value) * axes.inverse()).normalize().to_array()
            }
        }
    }

    pub(super) fn error(&self, reference: &Reference, sample: usize, value: Numbers, scope: Scope) -> f64 {
        let value = self.pose(reference, value);
        self.body.error(reference, (sample, self.first * SAMPLES), &value, (self.allowed, scope))
    }

    pub(super) fn set(&mut self, reference: &Reference, piece: &Piece, frame: usize) {
        let start = (frame - self.first) * SAMPLES;
        let values: Vec<Numbers> = piece.samples().map(|value| self.pose(reference, value)).collect();
        self.body.set(reference, start, values.into_iter());
    }

    /// Takes the corners out of a curve where the body stays where it should be without them.
    fn smooth(&mut self, reference: &Reference, knots: &mut [Knot]) {
        for index in 1..knots.len().saturating_sub(1) {
            let (before, mut knot, after) = (knots[index - 1], knots[index], knots[index + 1]);
            let mean: Numbers = std::array::from_fn(|i| 0.5 * (knot.slope_in[i] + knot.slope_out[i]));
            (knot.slope_in, knot.slope_out) = (mean, mean);
            let pieces = [(Piece::between(&before, &knot), &before), (Piece::between(&knot, &after), &knot)];
            let holds = pieces.iter().all(|(piece, from)| {
                let start = (from.frame - self.first) * SAMPLES;
                let inner = piece.samples().enumerate().take(piece.length * SAMPLES).skip(1);
                inner
                    .into_iter()
                    .all(|(sample, value)| self.error(reference, start + sample, value, Scope::All) <= 1.0)
            });
            if holds {
                pieces.iter().for_each(|(piece, from)| self.set(reference, piece, from.frame));
                knots[index] = knot;
            }
        }
    }
}
