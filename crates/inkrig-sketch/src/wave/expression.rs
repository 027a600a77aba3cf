//! What a wave's text means: a tree of numbers, oscillators, sums and products, and its value at a time.

use super::generator::Oscillator;

/// Nested no deeper than [`super::MAX_WAVE_DEPTH`], with at most [`super::MAX_WAVE_PARTS`] leaves.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    Number(f64),
    /// Seconds since the segment began.
    Time,
    Ramp(Sweep),
    Oscillator(Oscillator),
    Alternate {
        inner: Box<Expression>,
        /// At least two.
        centres: Vec<f64>,
        /// Seconds for which a centre holds, above 0.
        every: f64,
    },
    /// Never a number or another of its kind.
    Negated(Box<Expression>),
    /// At least two terms.
    Sum(Vec<(Sign, Expression)>),
    /// At least two factors.
    Product(Vec<Expression>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Plus,
    Minus,
}

/// A number that goes evenly from one value to another over a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sweep {
    pub(super) from: f64,
    pub(super) to: f64,
}

/// A time in a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// Seconds since the segment began.
    pub(super) time: f64,
    /// Part of the segment that has passed, 0 to 1.
    pub(super) part: f64,
}

impl Moment {
    pub(super) fn new(time: f64, length: f64) -> Self {
        let time = time.max(0.0);
        Self { time, part: if length > 0.0 { (time / length).min(1.0) } else { 0.0 } }
    }
}

impl Sweep {
    pub(super) const fn constant(value: f64) -> Self {
        Self { from: value, to: value }
    }

    pub(super) fn at(self, part: f64) -> f64 {
        // A value that does not change stays exact.
        if self.from == self.to { self.from } else { self.from * (1.0 - part) + self.to * part }
    }

    /// The mean over the first part of the segment.
    pub(super) fn mean_until(self, part: f64) -> f64 {
        self.at(part / 2.0)
    }
}

impl Expression {
    pub(super) fn negated(self) -> Self {
        match self {
            Self::Number(value) => Self::Number(-value),
            Self::Negated(inner) => *inner,
            other => Self::Negated(Box::new(other)),
        }
    }

    pub(super) fn value(&self, moment: Moment) -> f64 {
        match self {
            Self::Number(value) => *value,
            Self::Time => moment.time,
            Self::Ramp(sweep) => sweep.at(moment.part),
            Self::Oscillator(oscillator) => oscillator.value(moment),
            Self::Alternate { inner, centres, every } => {
                // A border that rounding puts just before a frame is at the frame.
                let turn = (moment.time / every + 1e-9).floor() % centres.len() as f64;
                inner.value(moment) + centres.get(turn as usize).copied().unwrap_or(0.0)
            }
            Self::Negated(inner) => -inner.value(moment),
            Self::Sum(terms) => terms
                .iter()
                .map(|(sign, term)| match sign {
                    Sign::Plus => term.value(moment),
                    Sign::Minus => -term.value(moment),
                })
                .sum(),
            Self::Product(factors) => factors.iter().map(|factor| factor.value(moment)).product(),
        }
    }

    /// The highest frequency of all oscillators, in hertz; 0 where there is none.
    pub(super) fn highest_hertz(&self) -> f64 {
        let highest = |hertz: &mut dyn Iterator<Item = f64>| hertz.fold(0.0, f64::max);
        match self {
            Self::Number(_) | Self::Time | Self::Ramp(_) => 0.0,
            Self::Oscillator(oscillator) => oscillator.hertz.from.max(oscillator.hertz.to),
            Self::Alternate { inner, .. } | Self::Negated(inner) => inner.highest_hertz(),
            Self::Sum(terms) => highest(&mut terms.iter().map(|(_, term)| term.highest_hertz())),
            Self::Product(factors) => highest(&mut factors.iter().map(Self::highest_hertz)),
        }
    }
}
