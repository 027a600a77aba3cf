//! Teaching the readers of drawings, and measuring them. Their networks have gradients of their own, so nothing here needs the
//! feature `train`.

mod marked;
mod pck;
mod poses;
mod run;
mod settings;
mod sketch_loss;
mod train_sketch;
mod train_word;
mod words;

pub use marked::{MarkedDrawing, measure_marked};
pub use pck::{Found, Pck, Subset, measure, measure_by, rendered};
pub use poses::{Poses, Shares};
pub use run::OnStep;
pub use settings::{Pace, SketchSettings, WordSettings};
pub use train_sketch::{SketchRow, train_sketch};
pub use train_word::{WordRow, split_fonts, train_word};
pub use words::{WordScore, measure_words, word_examples};
