//! Training, in stages that can be stopped and gone on with at any moment.
//!
//! A stage reads a corpus ([`crate::corpus`]), takes one step after the other and keeps, in its own folder, `checkpoint.safetensors`
//! (weights, optimiser, place), `log.jsonl` (one line a measurement) and the best weights so far. What is drawn at random belongs to the
//! seed and the step alone, so that a run that was stopped goes on as if it had not been.

pub(crate) mod adamw;
mod align;
pub(crate) mod checkpoint;
mod conditions;
mod control;
mod control_measure;
mod course;
mod curves;
mod denoiser;
mod distill;
mod estimate;
mod examples;
mod latents;
mod linear_path;
pub(crate) mod log;
mod motions;
pub(crate) mod muon;
mod picture;
pub(crate) mod rate;
mod reconstruction;
mod retime;
pub(crate) mod run;
mod settings;
mod stage;
mod vae;
mod weights_file;
mod windows;

pub use align::{AlignSettings, train_align};
pub use control::{ControlSettings, train_control};
pub use course::{Course, Optimiser};
pub use curves::curves;
pub use denoiser::{DenoiserSettings, train_denoiser};
pub use distill::{DistillSettings, train_distill};
pub use estimate::EstimateSettings;
pub use examples::examples;
pub use log::Row;
pub use motions::Selection;
pub use picture::Drawing;
pub use reconstruction::{Reconstruction, reconstruction};
pub use run::{OnStep, Place, Report, check_folder};
pub use settings::VaeSettings;
pub use vae::train_vae;
pub use windows::{Batch, Windows};
