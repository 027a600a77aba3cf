//! inkrig turns drawings and examples into 3D character animation, offline, on a CPU.
//!
//! This crate is the program `inkrig` and, as a library, the front door: every room of the house under one name.
//!
//! ```
//! use inkrig::align::{Control, CurveOptions, Options, align};
//! use inkrig::{formats, samples, sketch};
//!
//! let clip = formats::read_bvh(samples::find("person").unwrap().bytes, &formats::ImportOptions::default())?.clip;
//! let curve = sketch::read_curve(samples::find("spiral").unwrap().bytes, sketch::Format::Json)?;
//! let control = Control::from_curve(&curve, &CurveOptions { samples: Some(120), ..CurveOptions::default() })?;
//! let options = Options { levels: 3, ..Options::default() };
//! let result = align(&clip.into(), &control, &options, &mut |_| std::ops::ControlFlow::Continue(()))?;
//! assert_eq!(result.clip.frames(), 120);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use inkrig_align as align;
pub use inkrig_formats as formats;
pub use inkrig_generate as generate;
pub use inkrig_motion as motion;
pub use inkrig_samples as samples;
pub use inkrig_sketch as sketch;
pub use inkrig_sound as sound;
pub use inkrig_storyboard as storyboard;
pub use inkrig_transport as transport;

mod bake;
pub mod bench;
pub mod cli;
mod clip_path;
pub mod commands;
pub mod console;
mod drawing;
pub mod error;
mod guide;
mod inputs;
mod joints_picture;
mod jpeg;
pub mod load;
mod main_axes;
mod map_picture;
pub mod names;
mod numbers;
pub mod output;
mod over_ground;
pub mod preview;
pub mod printable;
mod provenance;
mod read_back;
mod readers;
mod results;
pub mod sheet;
mod shipped;
mod show;
mod side_by_side;
pub mod span;
mod temporary;
mod wildcard;
