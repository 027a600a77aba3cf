//! An animation on a character of the user's own.

use crate::cli::ImportArgs;
use crate::commands::align::motion;
use crate::commands::certificate::CertificateRecord;
use crate::console::Console;
use crate::error::CliError;
use inkrig_formats::{ExportOptions, Format, Import};
use inkrig_motion::Clip;
use inkrig_motion::retarget::{Certificate, CertificateLimits, RetargetOptions, retarget, standing_pose};
use std::path::Path;

/// What came of it.
pub(super) struct Moved {
    pub(super) clip: Clip,
    character: Import,
}

/// Carries an animation over, and says how exact it is there.
///
/// # Errors
/// When the character is not there, or is not one that a person's motion goes onto.
pub(super) fn onto(
    clip: &Clip,
    path: &Path,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<(Moved, CertificateRecord), CliError> {
    let character = motion(path, &ImportArgs::default(), console, warnings)?;
    let options = RetargetOptions {
        keep_feet: true,
        stance: standing_pose(&character.clip),
        ..RetargetOptions::default()
    };
    let moved = retarget(clip, character.clip.skeleton(), &options)
        .map_err(|cause| CliError::Retarget { path: path.into(), cause: Box::new(cause) })?;
    let certificate = Certificate::of(clip, &moved);
    let broken = certificate.broken(&CertificateLimits::default());
    let certificate = CertificateRecord::of(&certificate, &broken);
    Ok((Moved { clip: moved.clip, character }, certificate))
}

impl Moved {
    pub(super) fn export(&self, format: Format, name: &str) -> ExportOptions {
        ExportOptions {
            name: Some(name.to_owned()),
            ..ExportOptions::in_format(format, &self.character.source)
        }
    }
}
