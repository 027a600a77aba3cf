//! An animation on a character of the user's own.

use crate::commands::align::character;
use crate::commands::certificate::CertificateRecord;
use crate::console::Console;
use crate::error::CliError;
use inkrig_formats::{ExportOptions, Format, Import};
use inkrig_motion::Clip;
use inkrig_motion::retarget::{Certificate, CertificateLimits, RetargetOptions, retarget, standing_pose};
use std::path::{Path, PathBuf};

/// Whom an animation is put on.
pub(super) struct Character {
    import: Import,
    path: PathBuf,
}

impl Character {
    /// # Errors
    /// When the file is not there, or is none of a motion or a character.
    pub(super) fn read(path: &Path, console: &Console, warnings: &mut Vec<String>) -> Result<Self, CliError> {
        let import = character(path, console, warnings)?;
        Ok(Self { import, path: path.into() })
    }

    /// Carries an animation over, and says how exact it is there.
    ///
    /// # Errors
    /// When the character is not one that such a motion goes onto.
    pub(super) fn carry(&self, clip: &Clip) -> Result<(Clip, CertificateRecord), CliError> {
        let (moved, certificate) = self.certified(clip)?;
        let broken = certificate.broken(&CertificateLimits::default());
        Ok((moved, CertificateRecord::of(&certificate, &broken)))
    }

    /// By how much an animation is beyond the limits there, each as a share of itself, in sum; 0 where it passes.
    ///
    /// # Errors
    /// As of [`carry`](Self::carry).
    pub(super) fn beyond(&self, clip: &Clip) -> Result<f64, CliError> {
        let broken = self.certified(clip)?.1.broken(&CertificateLimits::default());
        let shares = broken.iter().map(|broken| broken.value / broken.limit - 1.0);
        Ok(shares.map(|share| if share.is_finite() { share } else { f64::INFINITY }).sum())
    }

    fn certified(&self, clip: &Clip) -> Result<(Clip, Certificate), CliError> {
        let own = &self.import.clip;
        let options =
            RetargetOptions { keep_feet: true, stance: standing_pose(own), ..RetargetOptions::default() };
        let moved = retarget(clip, own.skeleton(), &options)
            .map_err(|cause| CliError::Retarget { path: self.path.clone(), cause: Box::new(cause) })?;
        let certificate = Certificate::of(clip, &moved);
        Ok((moved.clip, certificate))
    }

    pub(super) fn export(&self, format: Format, name: &str) -> ExportOptions {
        ExportOptions { name: Some(name.to_owned()), ..ExportOptions::in_format(format, &self.import.source) }
    }
}
