//! Drawn figures, made of poses: what the reader of sketches learns from, and rough storyboards.
//!
//! A pose as a camera sees it ([`seen`]) gets the proportions of a [`Style`] and becomes marks of a pen ([`draw`]), with the places of
//! the 18 key points and whether each is drawn. [`picture`] puts the marks on paper as a scan would show them.

mod body;
mod character;
mod choices;
mod clutter;
mod figure;
mod head;
mod limbs;
mod page;
mod pen;
mod style;
mod trunk;

pub use body::{Proportions, Seen, seen};
pub use character::{Clothes, Dress, Hair};
pub use choices::{Face, Family, Feet, Hands, Limbs, Torso};
pub use figure::{Drawn, draw};
pub use page::{Conditions, Picture, picture};
pub(crate) use page::{bounds, wear};
pub use style::Style;

use inkrig_generate::schedule::Noise;

/// Random choices.
pub(crate) trait Chance {
    /// From `low` to `high`.
    fn between(&mut self, low: f32, high: f32) -> f32;
    /// Whether something with this share comes.
    fn happens(&mut self, share: f64) -> bool;
    /// A place in a list of so many.
    fn below(&mut self, count: usize) -> usize;
    /// One of some, each with its weight.
    fn pick<T: Copy>(&mut self, of: &[(T, f32)]) -> Option<T>;
}

impl Chance for Noise {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform() as f32
    }

    fn happens(&mut self, share: f64) -> bool {
        self.uniform() < share
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count.saturating_sub(1))
    }

    fn pick<T: Copy>(&mut self, of: &[(T, f32)]) -> Option<T> {
        let mut place = self.between(0.0, of.iter().map(|(_, weight)| weight).sum());
        for (one, weight) in of {
            place -= weight;
            if place < 0.0 {
                return Some(*one);
            }
        }
        of.last().map(|(one, _)| *one)
    }
}

#[cfg(test)]
mod tests;
