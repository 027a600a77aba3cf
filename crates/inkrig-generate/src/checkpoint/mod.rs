//! Weights as files: our own model files, and those of the published models.
//!
//! - [`ModelFile`]: safetensors, whose header also carries all that is needed to make motions with the weights.
//! - [`TorchFile`]: what `torch.save` wrote. A pickle is a program for a machine that could call any function of Python; ours knows
//!   nine names that describe data, calls nothing, and refuses every other name.
//! - [`Npz`] and [`read_table`]: NumPy's tables.
//! - [`Import`]: finds out which model a file of tensors is, and writes it as a model file, one tensor at a time.
//!
//! No reader holds more than one tensor, and none makes room for what is not there.

mod bytes;
mod error;
mod header;
mod import;
mod mapping;
mod model;
mod npy;
mod npz;
mod number;
mod pickle;
mod safetensors;
mod source;
mod torch;
mod zip;

pub use error::CheckpointError;
pub use header::{ModelHeader, ModelStatistics};
pub use import::{About, Import, NetworkRow, read_statistics};
pub use mapping::ModelKind;
pub use model::{ModelFile, write_model};
pub use npy::{MOST_NPY_BYTES, read_npy, read_table};
pub use npz::Npz;
pub use number::{NumberKind, to_half};
pub use safetensors::Safetensors;
pub use source::{Listed, TensorSource};
pub use torch::TorchFile;
