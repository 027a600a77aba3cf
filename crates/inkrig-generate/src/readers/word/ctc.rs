//! Connectionist temporal classification: letters without places.

use super::ALPHABET;

/// Logarithms of the letters' shares at every place; `scores` are places x [`ALPHABET`].
pub(crate) fn logarithms(scores: &[f32]) -> Vec<f64> {
    let mut out = Vec::with_capacity(scores.len());
    for row in scores.chunks_exact(ALPHABET) {
        let most = row.iter().fold(f32::NEG_INFINITY, |most, &score| most.max(score));
        let sum: f64 = row.iter().map(|&score| f64::from(score - most).exp()).sum();
        let all = f64::from(most) + sum.ln();
        out.extend(row.iter().map(|&score| f64::from(score) - all));
    }
    out
}

/// The likeliest letter at every place, with repeats and places without a letter taken out.
pub fn best_path(logarithms: &[f64]) -> Vec<usize> {
    let mut letters = Vec::new();
    let mut before = 0;
    for row in logarithms.chunks_exact(ALPHABET) {
        let best = row.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at);
        if best != 0 && best != before {
            letters.push(best);
        }
        before = best;
    }
    letters
}

/// The logarithm of how likely these letters are, over all ways in which they can lie.
pub fn likelihood(logarithms: &[f64], letters: &[usize]) -> f64 {
    let states = 2 * letters.len() + 1;
    let letter = |state: usize| if state % 2 == 1 { letters[state / 2] } else { 0 };
    let mut row = vec![f64::NEG_INFINITY; states];
    let mut next = row.clone();
    for (at, own) in logarithms.chunks_exact(ALPHABET).enumerate() {
        for state in 0..states {
            let before = if at == 0 {
                if state < 2 { 0.0 } else { f64::NEG_INFINITY }
            } else {
                into(&row, state, &letter)
            };
            next[state] = before + own[letter(state)];
        }
        std::mem::swap(&mut row, &mut next);
    }
    row.iter().rev().take(2).fold(f64::NEG_INFINITY, |sum, &part| add(sum, part))
}

/// What can lead into a state.
fn into(row: &[f64], state: usize, letter: &dyn Fn(usize) -> usize) -> f64 {
    let mut sum = row[state];
    if state >= 1 {
        sum = add(sum, row[state - 1]);
    }
    // Two different letters need nothing between them.
    if state >= 2 && state % 2 == 1 && letter(state) != letter(state - 2) {
        sum = add(sum, row[state - 2]);
    }
    sum
}

/// Of sums whose logarithms these are.
fn add(a: f64, b: f64) -> f64 {
    let (most, least) = (a.max(b), a.min(b));
    if least == f64::NEG_INFINITY { most } else { most + (least - most).exp().ln_1p() }
}

/// The loss, and its gradient with respect to the scores.
#[derive(Debug, Clone, Default)]
pub struct CtcLoss {
    /// The negative logarithm of the letters' likelihood; infinite where they cannot lie in so few places.
    pub loss: f64,
    /// Places x [`ALPHABET`].
    pub gradient: Vec<f32>,
}

impl CtcLoss {
    /// Of scores (places x [`ALPHABET`]) and the true letters.
    pub fn of(&mut self, scores: &[f32], letters: &[usize]) {
        let logarithms = logarithms(scores);
        let (steps, states) = (scores.len() / ALPHABET, 2 * letters.len() + 1);
        let letter = |state: usize| if state % 2 == 1 { letters[state / 2] } else { 0 };
        let mut ahead = vec![f64::NEG_INFINITY; steps * states];
        for at in 0..steps {
            let (done, open) = ahead.split_at_mut(at * states);
            for state in 0..states {
                let before = match at {
                    0 if state < 2 => 0.0,
                    0 => f64::NEG_INFINITY,
                    _ => into(&done[(at - 1) * states..], state, &letter),
                };
                open[state] = before + logarithms[at * ALPHABET + letter(state)];
            }
        }
        // What is still to come from each state, without its own place.
        let mut behind = vec![f64::NEG_INFINITY; steps * states];
        for at in (0..steps).rev() {
            for state in 0..states {
                if at + 1 == steps {
                    let ends = state + 2 >= states;
                    behind[at * states + state] = if ends { 0.0 } else { f64::NEG_INFINITY };
                    continue;
                }
                let next =
                    |to: usize| behind[(at + 1) * states + to] + logarithms[(at + 1) * ALPHABET + letter(to)];
                let mut sum = next(state);
                if state + 1 < states {
                    sum = add(sum, next(state + 1));
                }
                if state + 2 < states && state % 2 == 1 && letter(state) != letter(state + 2) {
                    sum = add(sum, next(state + 2));
                }
                behind[at * states + state] = sum;
            }
        }
        let whole = (states.saturating_sub(2)..states)
            .map(|state| ahead[(steps - 1) * states + state])
            .fold(f64::NEG_INFINITY, add);
        self.loss = -whole;
        self.gradient.clear();
        self.gradient.extend(logarithms.iter().map(|part| part.exp() as f32));
        if !whole.is_finite() {
            self.gradient.fill(0.0);
            return;
        }
        for at in 0..steps {
            for state in 0..states {
                let share = (ahead[at * states + state] + behind[at * states + state] - whole).exp();
                self.gradient[at * ALPHABET + letter(state)] -= share as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{letters, text};
    use super::*;
    use crate::schedule::Noise;

    #[test]
    fn likelihoods_are_those_of_all_ways_together() {
        // Over three places all strings of at most three letters have likelihoods that add up to 1.
        let scores = Noise::new(1).normals(3 * ALPHABET);
        let logarithms = logarithms(&scores);
        let mut sum = likelihood(&logarithms, &[]).exp();
        for a in 1..ALPHABET {
            sum += likelihood(&logarithms, &[a]).exp();
            for b in 1..ALPHABET {
                sum += likelihood(&logarithms, &[a, b]).exp();
                for c in 1..ALPHABET {
                    sum += likelihood(&logarithms, &[a, b, c]).exp();
                }
            }
        }
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn gradients_are_differences_and_teach_a_word() {
        let word = letters("Kick off");
        assert_eq!(text(&word), "kick off");
        let mut scores = Noise::new(2).normals(20 * ALPHABET);
        let mut loss = CtcLoss::default();
        loss.of(&scores, &word);
        let gradient = loss.gradient.clone();
        assert!((loss.loss + likelihood(&logarithms(&scores), &word)).abs() < 1e-6);
        for at in (0..scores.len()).step_by(13) {
            let mut value = |by: f32| {
                let mut scores = scores.clone();
                scores[at] += by;
                loss.of(&scores, &word);
                loss.loss
            };
            let slope = (value(0.01) - value(-0.01)) / 0.02;
            assert!((slope - f64::from(gradient[at])).abs() < 2e-3, "{at}");
        }
        for _ in 0..200 {
            loss.of(&scores, &word);
            scores.iter_mut().zip(&loss.gradient).for_each(|(score, part)| *score -= part);
        }
        assert_eq!(best_path(&logarithms(&scores)), word);
        // Eight letters of which two are the same do not fit into eight places.
        loss.of(&scores[..8 * ALPHABET], &word);
        assert!(loss.loss.is_infinite() && loss.gradient.iter().all(|part| *part == 0.0));
    }
}
