//! The studio's server: projects that are always on the disk, live strokes, results, and the page. Thin: what computes is in
//! the rooms below.

mod api;
pub mod document;
pub mod engine;
mod error;
pub mod events;
mod guard;
mod page;
pub mod project;
mod server;
pub mod storyboard;
pub mod strokes;
mod studio;

pub use api::openapi;
pub use error::StudioError;
pub use server::{Invitation, ServeOptions, Server};
pub use studio::{Applied, ProjectState, Studio, UploadOptions};
