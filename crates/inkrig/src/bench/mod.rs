//! The benchmark of align: cases that anybody can run, align beside simpler ways to make a motion, quality and time in
//! one table.

mod axes;
mod baselines;
mod case;
mod clock;
mod folder;
mod machine;
mod made_sound;
mod own_cases;
mod row;
mod table;

pub use case::{Case, ControlSpec};
pub use clock::{Clock, Spent};
pub use folder::{SECONDS_OF_A_CLIP, folder_cases};
pub use machine::Machine;
pub use made_sound::pad_beat_melody;
pub use own_cases::own_cases;
pub use row::{Method, Row, rows};
pub use table::{Failure, Table};
