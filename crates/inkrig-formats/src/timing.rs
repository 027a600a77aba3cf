//! From keys at any time to frames at a steady rate.

use crate::Finding;

/// Rates that are tried when the keys alone do not tell one, frames a second.
const COMMON_RATES: [f64; 11] = [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0, 200.0, 240.0];

/// Keys closer than the slowest of motions are on a coarse grid, between which the file's own curves are sampled.
const SLOWEST: f64 = 20.0;

/// Faster than any recording: such keys are not frames.
const FASTEST: f64 = 480.0;

/// When the frames of a clip are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Timing {
    /// Time of the first frame, seconds.
    pub(crate) start: f64,
    /// Frames a second.
    pub(crate) rate: f64,
    /// How many frames; may be beyond any limit.
    pub(crate) frames: f64,
    /// How far keys may lie behind the frames that they belong to, seconds.
    pub(crate) slack: f64,
}

impl Timing {
    /// Frames at the rate of the keys when they stand on one, else at a rate that is said. `times` are seconds, rising;
    /// a `rate` that is given wins.
    pub(crate) fn of(times: &[f64], rate: Option<f64>) -> (Self, Option<Finding>) {
        let (start, end) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        let (rate, finding) = match rate {
            Some(rate) => (rate, None),
            None => choose(times),
        };
        let grid = Grid::of(times);
        let slack = if grid.fits(rate) { grid.tolerance(rate) / rate } else { grid.rounding };
        let frames = ((end - start + slack) * rate).floor() + 1.0;
        (Self { start, rate, frames, slack }, finding)
    }
}

fn choose(times: &[f64]) -> (f64, Option<Finding>) {
    if times.len() < 2 {
        return (30.0, None);
    }
    let grid = Grid::of(times);
    let own = grid.own_rate();
    if let Some(rate) = own.filter(|rate| *rate >= SLOWEST) {
        return (rate, None);
    }
    if let Some(rate) = COMMON_RATES.into_iter().find(|&rate| grid.fits(rate)) {
        return (rate, None);
    }
    if let Some(keys) = own {
        let rate = keys * (30.0 / keys).round();
        let message =
            format!("keys stand {keys:.3} a second; the clip is sampled at {rate:.3} frames a second");
        return (rate, Some(Finding::info("keys-sampled", message)));
    }
    let often = times.len() as f64 > 45.0 * grid.span;
    let rate = if often { 60.0 } else { 30.0 };
    let message = format!("the keys stand at no steady rate; the clip is sampled at {rate} frames a second");
    (rate, Some(Finding::warning("keys-uneven", message)))
}

struct Grid<'a> {
    times: &'a [f64],
    start: f64,
    span: f64,
    /// What rounding to f32 may do to a time, seconds.
    rounding: f64,
}

impl<'a> Grid<'a> {
    fn of(times: &'a [f64]) -> Self {
        let (start, end) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        Self { times, start, span: end - start, rounding: 1.2e-7 * start.abs().max(end.abs()) }
    }

    fn fits(&self, rate: f64) -> bool {
        self.times.iter().all(|time| {
            let place = (time - self.start) * rate;
            (place - place.round()).abs() <= self.tolerance(rate)
        })
    }

    /// How far a key may lie from its frame, frames.
    fn tolerance(&self, rate: f64) -> f64 {
        (0.01 + self.rounding * rate).min(0.05)
    }

    /// The rate whose steps are the smallest gaps between keys, when all keys stand on it.
    fn own_rate(&self) -> Option<f64> {
        let gaps = || self.times.windows(2).filter_map(|pair| Some(pair.get(1)? - pair.first()?));
        // Nearer than rounding can tell apart is the same key.
        let smallest = gaps().filter(|gap| *gap > 1e-5 + 4.0 * self.rounding).min_by(f64::total_cmp)?;
        // The mean over single steps is far more exact than one of them.
        let steps = || gaps().filter(|gap| *gap >= smallest && *gap < 1.5 * smallest);
        let step = steps().sum::<f64>() / steps().count() as f64;
        let rate = snapped((self.span / step).round() / self.span, 2.0 * self.rounding / self.span);
        (rate <= FASTEST && self.fits(rate)).then_some(rate)
    }
}

/// The round rate that a rate cannot be told apart from, `error` being what rounding may do to it, by ratio.
fn snapped(rate: f64, error: f64) -> f64 {
    let ntsc = (rate * 1.001).round() / 1.001;
    let near = |round: &f64| (rate / round - 1.0).abs() < error;
    [rate.round(), ntsc].into_iter().find(near).unwrap_or(rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(rate: f64, frames: impl IntoIterator<Item = u32>, start: f64) -> Vec<f64> {
        frames.into_iter().map(|frame| f64::from((start + f64::from(frame) / rate) as f32)).collect()
    }

    #[test]
    fn dense_keys_tell_their_rate() {
        for (rate, start) in
            [(30.0, 0.0), (24.0, 1.0 / 24.0), (120.0, 0.0), (30.0 / 1.001, 0.0), (120.00048, 0.0)]
        {
            let (timing, finding) = Timing::of(&keys(rate, 0..4000, start), None);
            assert!((timing.rate / rate - 1.0).abs() < 1e-6, "{rate}: {}", timing.rate);
            assert_eq!((timing.frames, finding), (4000.0, None), "{rate}");
        }
        assert_eq!(Timing::of(&keys(30.0, 0..400, 0.0), None).0.rate, 30.0);
    }

    #[test]
    fn sparse_keys_on_frames_tell_it_too() {
        let (timing, finding) = Timing::of(&keys(30.0, [0, 2, 5, 60], 0.0), None);
        assert_eq!((timing.rate, timing.frames, finding), (30.0, 61.0, None));
        let (timing, _) = Timing::of(&keys(30.0, [0, 60, 61, 99], 0.0), None);
        assert_eq!((timing.rate, timing.frames), (30.0, 100.0));
    }

    #[test]
    fn a_coarse_or_uneven_grid_is_sampled_and_said() {
        let (timing, finding) = Timing::of(&keys(7.0, [0, 1, 2, 9], 0.0), None);
        assert_eq!((timing.rate, timing.frames), (28.0, 37.0));
        assert_eq!(finding.unwrap().code, "keys-sampled");
        let (timing, finding) = Timing::of(&[0.0, 0.1, 0.237_19, 1.0], None);
        assert_eq!((timing.rate, timing.frames), (30.0, 31.0));
        assert_eq!(finding.unwrap().code, "keys-uneven");
    }

    #[test]
    fn one_key_is_one_frame() {
        let (timing, finding) = Timing::of(&[3.0], None);
        assert_eq!((timing.start, timing.rate, timing.frames, finding), (3.0, 30.0, 1.0, None));
        assert_eq!(Timing::of(&[0.0, 1.0], Some(10.0)).0.frames, 11.0);
    }
}
