//! Storyboards as files.

use crate::drawing;
use crate::error::CliError;
use crate::load;
use inkrig_sketch::storyboard::{Storyboard, read_storyboard, read_storyboard_svg};
use inkrig_storyboard::{Picture, storyboard_of_picture};
use std::path::Path;

/// Reads a storyboard.
///
/// # Errors
/// When it is not there, too large, of an unknown kind or not understood.
pub(super) fn board(path: &Path) -> Result<Storyboard, CliError> {
    let wrong = |cause| CliError::Curve { path: path.into(), cause: Box::new(cause) };
    match load::extension(path).as_deref() {
        Some("json") => read_storyboard(&load::drawing(path)?).map_err(wrong),
        Some("svg") => read_storyboard_svg(&load::drawing(path)?).map_err(wrong),
        Some("png" | "jpg" | "jpeg") => {
            let (width, height, pixels) = drawing::colours(path)?;
            let picture = Picture { width, height, pixels: &pixels };
            let board = storyboard_of_picture(&picture).ok_or_else(|| CliError::Picture {
                path: path.into(),
                what: "shows no line: draw a black figure and cyan trajectories on light paper".into(),
            })?;
            board.check().map_err(wrong)?;
            Ok(board)
        }
        _ => Err(CliError::Kind {
            path: path.to_path_buf(),
            known: "known storyboards: .json, .svg, .png, .jpg",
        }),
    }
}
