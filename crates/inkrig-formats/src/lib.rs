//! Motions as files, one module per format. Bytes in, an [`Import`] out, and back.
//!
//! Readers take bytes, never a path, and follow nothing that stands outside of them. What cannot be read gives a
//! [`FormatError`] that says what, where and what to do; what was read but deserves a word gives a [`Finding`].
//! A [`Clip`](inkrig_motion::Clip) is always in metres and y up: units and axes are converted here and nowhere else.
//!
//! ```
//! use inkrig_formats::{ExportOptions, ImportOptions, read_bvh, write_bvh};
//!
//! let text = b"HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 1 Yrotation\nEnd Site\n{\nOFFSET 0 170 0\n}\n}\n\
//!     MOTION\nFrames: 2\nFrame Time: .0083333\n0\n90\n";
//! let import = read_bvh(text, &ImportOptions::default())?;
//! assert_eq!(import.source.metres_per_unit, 0.01);
//! assert_eq!(import.clip.frames(), 2);
//! // Written in the units and the channel order that the file had.
//! let written = write_bvh(&import.clip, &ExportOptions::like(&import.source))?;
//! assert!(written.bytes.ends_with(b"Frame Time: 0.0083333\n0\n90\n"));
//! # Ok::<(), inkrig_formats::FormatError>(())
//! ```

#![deny(clippy::indexing_slicing)]

mod asf_amc;
mod body;
mod bvh;
mod clip_choice;
mod companion;
mod deepmimic;
mod error;
mod euler;
mod export;
mod fbx;
mod figure;
mod finding;
mod folder;
mod format;
mod gltf;
mod import;
mod lexer;
mod limits;
mod numbers;
mod original;
mod timing;
mod unit;
mod usda;

pub use asf_amc::read_amc;
pub use bvh::{bvh_rows, read_bvh, write_bvh};
pub use companion::companion_beside;
pub use deepmimic::read_deepmimic;
pub use error::FormatError;
pub use export::{ExportOptions, KeptRow, Written};
pub use fbx::{read_fbx, write_fbx};
pub use finding::{Finding, Place, Severity};
pub use folder::{FileSource, no_files, read_in_folder};
pub use format::{Format, read_motion, read_motions, write_motion};
pub use gltf::{HUMAN_BONES, HumanBone, gltf_licence, read_gltf, write_glb, write_vrma};
pub use import::{Axis, Channel, ClipChoice, ClipInfo, Evidence, Import, ImportOptions, SourceInfo, UpAxis};
pub use limits::Limits;
pub use original::Original;
pub use unit::guess_metres_per_unit;
pub use usda::write_usda;
