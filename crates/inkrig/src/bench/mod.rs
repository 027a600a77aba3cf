//! The benchmark of align: cases that anybody can run, align beside simpler ways to make a motion, quality and time in
//! one table.

mod baselines;
mod case;
mod clock;
mod folder;
mod machine;
mod made_sound;
mod own_cases;
mod page;
mod picture;
mod row;
pub(crate) mod sweep;
mod table;

pub use case::{Case, ControlSpec};
pub use clock::{Clock, Spent};
pub use folder::{SECONDS_OF_A_CLIP, folder_cases};
pub use machine::Machine;
pub use made_sound::pad_beat_melody;
pub use own_cases::own_cases;
pub use page::{page, sweep_markdown};
pub use row::{Method, Row, rows};
pub use sweep::{Parameter, Sweep, Swept, SweptCase, SweptCell, sweep};
pub use table::{Failure, Table};

impl Swept {
    /// One picture of all cells, as PNG: a row for each case, the control first, then a cell for each value.
    /// Beside each: structure, nearest patch, jump, speed.
    ///
    /// # Errors
    /// When it cannot be written as PNG.
    pub fn png(&self) -> Result<Vec<u8>, crate::sheet::SheetError> {
        picture::grid(self)
    }
}
