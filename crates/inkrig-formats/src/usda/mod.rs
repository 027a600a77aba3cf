//! USD as text: a skeleton and its animation (UsdSkel). Written only.

mod names;
mod text;

use crate::{ExportOptions, Finding, FormatError, Written, import::check_metres_per_unit};
use inkrig_motion::Clip;
use names::joint_paths;
use text::Text;

/// Writes a clip as a `.usda` file: a `SkelRoot` with a `Skeleton` in its rest pose and a `SkelAnimation` of one time
/// code a frame. Names are those of the skeleton with what USD does not allow replaced; they are kept as they were in
/// `jointNames`.
///
/// # Errors
/// [`FormatError::Options`] for a unit out of range, [`FormatError::Write`] for keys with curves, which are not written.
pub fn write_usda(clip: &Clip, options: &ExportOptions) -> Result<Written, FormatError> {
    check_metres_per_unit(options.metres_per_unit)?;
    options.check_no_curves("USD")?;
    let (paths, renamed) = joint_paths(clip.skeleton());
    let mut text = Text::new(clip, options);
    text.header();
    text.skeleton(&paths);
    text.animation(&paths);
    let mut findings = Vec::new();
    if renamed > 0 {
        let message = format!("{renamed} joint names hold what USD does not allow and were changed");
        findings.push(Finding::info("usda-names", message));
    }
    Ok(Written { bytes: text.finish(), findings })
}
