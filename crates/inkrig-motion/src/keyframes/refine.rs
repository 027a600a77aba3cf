//! Fewer keys with values of their own: a key need not stand on the motion, only near it.

use super::block::{LONGEST, Thinner};
use super::body::Scope;
use super::fit::{Knot, Numbers, Piece, SAMPLES};
use super::reference::{Reference, slope, unit};
use super::{RotationForm, spline};

/// How often all keys of a channel are gone through.
const ROUNDS: usize = 2;

/// How often keys are fitted anew, with more weight on what was farthest off (Lawson 1961).
const FITS: usize = 10;

impl Thinner<'_> {
    /// Takes out keys, and puts one in place of two, wherever values and slopes of the keys around can be found that keep
    /// to what is allowed.
    pub(super) fn refine(&mut self, reference: &Reference, knots: &mut Vec<Knot>) {
        for _ in 0..ROUNDS {
            let before = knots.len();
            let mut index = 1;
            while index + 1 < knots.len() {
                let fewer = self.without(reference, knots, (index, index + 1), None)
                    || self.one_for_two(reference, knots, index);
                index += usize::from(!fewer);
            }
            if knots.len() == before {
                break;
            }
        }
    }

    /// One key in place of the one at `index` and the next, at the frame that serves first, from the middle outwards.
    fn one_for_two(&mut self, reference: &Reference, knots: &mut Vec<Knot>, index: usize) -> bool {
        let (Some(first), Some(second)) = (knots.get(index), knots.get(index + 1)) else { return false };
        let (first, second) = (first.frame, second.frame);
        let middle = first + (second - first) / 2;
        let step = (second - first).div_ceil(PLACES).max(1);
        let mut frames: Vec<usize> = (first..=second).step_by(step).collect();
        frames.sort_by_key(|frame| frame.abs_diff(middle));
        frames.into_iter().any(|frame| self.without(reference, knots, (index, index + 2), Some(frame)))
    }

    /// Takes out the keys of a range and puts one at a frame, where that can be done.
    fn without(
        &mut self,
        reference: &Reference,
        knots: &mut Vec<Knot>,
        (first, last): (usize, usize),
        new: Option<usize>,
    ) -> bool {
        let held = |knot: &Knot| self.given[knot.frame - self.first];
        if last >= knots.len() || knots[first..last].iter().any(held) {
            return false;
        }
        // The keys around may move, as far as there is none that is given.
        let (mut begin, mut end) = (first - 1, last);
        for _ in 0..AROUND {
            begin -= usize::from(begin > 0 && !held(&knots[begin]));
            end += usize::from(end + 1 < knots.len() && !held(&knots[end]));
        }
        let mut row: Vec<Knot> = knots[begin..first].to_vec();
        row.extend(new.map(|frame| self.key(frame)));
        row.extend(&knots[last..=end]);
        if row.windows(2).any(|pair| pair[1].frame - pair[0].frame > LONGEST)
            || !self.refit(reference, &mut row)
        {
            return false;
        }
        for pair in row.windows(2) {
            let [from, to] = pair else { continue };
            self.set(reference, &Piece::between(from, to), from.frame);
        }
        knots.splice(begin..=end, row);
        true
    }

    /// A key on what the channel should do.
    fn key(&self, frame: usize) -> Knot {
        let place = frame - self.first;
        let at = |place: usize| self.target.get(place * SAMPLES).copied();
        let around: Vec<Numbers> = (place.saturating_sub(1)..=place + 1).filter_map(at).collect();
        let slope = slope(&around, place.min(1));
        Knot { frame, value: at(place).unwrap_or_default(), slope_in: slope, slope_out: slope }
    }

    /// Fits a row of keys, the first and the last of which stay where they are; whether it keeps to what is allowed.
    fn refit(&mut self, reference: &Reference, row: &mut [Knot]) -> bool {
        let (Some(first), Some(last)) = (row.first(), row.last()) else { return false };
        let start = (first.frame - self.first) * SAMPLES;
        let count = (last.frame - first.frame) * SAMPLES;
        let mut weights = std::mem::take(&mut self.weights);
        weights.clear();
        weights.extend((0..=count).map(|sample| if sample % SAMPLES == 0 { 1.0 } else { 0.25 }));
        let mut fits = false;
        for fit in 0..FITS {
            if !spline::fit(row, &self.target[start..=start + count], &weights) {
                break;
            }
            for knot in row.iter_mut().filter(|_| reference.turns && self.form == RotationForm::Quaternion) {
                knot.value = unit(knot.value);
            }
            let (mut worst, mut squares, mut sum) = (0.0_f64, 0.0, 0.0);
            let mut sample = 0;
            for pair in row.windows(2) {
                let [from, to] = pair else { continue };
                let piece = Piece::between(from, to);
                for value in piece.samples().skip(1) {
                    sample += 1;
                    let error = self.error(reference, start + sample, value, Scope::All);
                    worst = worst.max(error);
                    squares += weights[sample] * error * error;
                    sum += weights[sample];
                    weights[sample] *= error + 0.05;
                }
            }
            fits = worst <= 1.0;
            // No other values have a smaller largest error than this mean, but for its not being quite linear.
            if fits || (fit == 0 && worst > HOPELESS) || squares > 1.03 * sum {
                break;
            }
            weights.iter_mut().for_each(|weight| *weight /= sum);
        }
        self.weights = weights;
        fits
    }
}

/// Places that are tried for a key in place of two.
const PLACES: usize = 3;
/// Keys on either side that may move when one is taken out.
const AROUND: usize = 1;
/// Times what is allowed, beyond which fitting anew does not help.
const HOPELESS: f64 = 3.0;
