//! A case of the benchmark: a clip, and what it shall follow.

use super::pad_beat_melody;
use inkrig_align::{AlignError, Control, ControlKind, CurveOptions, Options, Preset, SoundOptions};
use inkrig_motion::{Clip, Takes};
use inkrig_sketch::{Curve, Labels, Wave};

/// A clip, a control, and the options that align's presets give them.
#[derive(Debug, Clone)]
pub struct Case {
    /// What follows what: `circles to person`.
    pub name: String,
    /// The clip or clips to arrange.
    pub source: Takes,
    /// What to follow.
    pub control: Control,
    /// How.
    pub options: Options,
}

/// What a case follows, before it is brought to frames.
#[derive(Debug, Clone)]
pub enum ControlSpec<'a> {
    /// A drawn curve of 30 points a second.
    Curve(Curve),
    /// A wave as on the command line, with its length in it.
    Wave(&'a str),
    /// Labels as on the command line.
    Labels(&'a str),
    /// [`pad_beat_melody`].
    Sound,
    /// Another motion.
    Like(&'a Clip),
}

impl Case {
    /// Puts a case together, with the default options of its kind of control.
    ///
    /// # Errors
    /// When the control cannot be used.
    pub fn new(name: String, source: Takes, follow: &ControlSpec<'_>) -> Result<Self, AlignError> {
        let rate = Options::default().matching_rate;
        let control = match follow {
            ControlSpec::Curve(curve) => Control::from_curve(curve, &CurveOptions::default())?,
            ControlSpec::Wave(text) => {
                let wave: Wave = text.parse()?;
                Control::from_wave(&wave, None, rate)?
            }
            ControlSpec::Labels(text) => {
                let labels: Labels = text.parse()?;
                Control::from_labels(&labels, None, rate)?
            }
            ControlSpec::Sound => Control::from_sound(&pad_beat_melody()?, &SoundOptions::default())?,
            ControlSpec::Like(clip) => Control::from_motion(clip, rate, &Options::default().features)?,
        };
        let options = Options::for_control(control.kind, Preset::Follow);
        Ok(Self { name, source, control, options })
    }

    /// The largest distance to the clip that still passes: sounds are given more.
    pub fn most_nearest_patch(&self) -> f64 {
        if self.control.kind == ControlKind::Sound { 0.35 } else { 0.30 }
    }
}
