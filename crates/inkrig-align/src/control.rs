//! What the motion shall follow.

use crate::{AlignError, Heard, MOST_FRAMES};
use inkrig_motion::{Clip, FeatureOptions, Features, frame_features, time};
use inkrig_sketch::{Curve, Ends, Labels, Table, Timing, Wave, frame_count, resample, smooth};
use inkrig_sound::{LoudnessScale, MelSpectrogram, MfccOptions, Sound, WaveformKind, loudness, waveform};

/// A control as the solver sees it: a table of numbers over time, never a file. Only distances between its rows
/// count, so its scale and place do not matter.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// One row a sample.
    pub features: Features,
    /// Samples a second. Matching resamples the control when this is not the matching rate.
    pub rate: f64,
    /// Whether the last sample is followed by the first: the result is then a seamless loop.
    pub cyclic: bool,
    /// How a place of the control's own domain (a canvas point, a label) becomes a row. `None`: rows are the domain
    /// itself.
    pub domain: Option<Domain>,
    /// What it is of, which decides the presets: see [`Options::for_control`](crate::Options::for_control).
    pub kind: ControlKind,
    /// What is heard, when it is a sound: for measuring how the motion goes with it.
    pub heard: Option<Heard>,
}

/// What the rows of a control stand for.
#[derive(Debug, Clone, PartialEq)]
pub enum Domain {
    /// Points or values, from which `centre` was taken off before they were multiplied by `scale`.
    Scaled {
        /// As many numbers as a row has.
        centre: Vec<f64>,
        /// Above 0.
        scale: f64,
    },
    /// The name that every column stands for; a row has a 1 in the column of its label.
    Labels(Vec<String>),
}

/// Kinds of control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ControlKind {
    /// A drawn curve, of any number of dimensions.
    #[default]
    Curve,
    /// A single value over time.
    Wave,
    /// Names over time ("motion by numbers").
    Labels,
    /// Music or speech.
    Sound,
    /// Another motion.
    Motion,
}

/// How a drawn curve becomes a control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveOptions {
    /// Number of samples; `None`: the curve's own, or ten seconds for an outline that has no time of its own.
    pub samples: Option<usize>,
    /// Samples a second.
    pub rate: f64,
    /// Standard deviation of the Gaussian that takes out the hand's tremble, in samples (Sec. 4.1). 0 for none.
    pub smooth: f64,
    /// How the samples are spread along the curve; `None` chooses by what the curve has.
    pub timing: Option<Timing>,
    /// Whether its end goes over into its beginning: for a loop, or to be [repeated](Control::repeated). The samples of
    /// a closed curve then are evenly apart over its seam too, where else the first point would be there twice.
    pub goes_on: bool,
}

impl Default for CurveOptions {
    fn default() -> Self {
        Self { samples: None, rate: 30.0, smooth: 2.0, timing: None, goes_on: false }
    }
}

/// How a sound becomes a control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoundOptions {
    /// Samples a second, in which `smooth` counts.
    pub rate: f64,
    /// Standard deviation of the Gaussian that takes out what no body can follow, in samples. 0 for none.
    ///
    /// The default is 90 ms. Music that is dense with notes changes within a tenth of a second, and a clip has no
    /// movements as quick. Over three loops and 21 dances the structure was .86 with it and .57 without.
    pub smooth: f64,
    /// How often it is played, one time after the other; at least 1. A bar of two seconds has so few moments that share
    /// no frame that chance decides what becomes of it; played three times it is followed as well as longer music.
    pub times: usize,
}

impl Default for SoundOptions {
    fn default() -> Self {
        Self { rate: 30.0, smooth: 2.7, times: 1 }
    }
}

/// Length of a drawing or wave without time, seconds.
const TIMELESS: f64 = 10.0;

impl Control {
    /// Its length at another rate, in samples, at least 1.
    pub fn frames(&self, rate: f64) -> usize {
        (self.features.frames() as f64 * rate / self.rate).round().max(1.0) as usize
    }

    /// The same control `times` times over, for a short one that is meant to go on: a loop, a figure that is drawn
    /// once. A sound is better repeated before it is analysed: [`SoundOptions::times`].
    ///
    /// # Errors
    /// When it becomes too long, or `times` is 0.
    pub fn repeated(&self, times: usize) -> Result<Self, AlignError> {
        checked(self.features.frames().saturating_mul(times))?;
        let features = Features::new(self.features.as_slice().repeat(times), self.features.width())?;
        let heard = match &self.heard {
            Some(heard) => Some(heard.repeated(times)?),
            None => None,
        };
        Ok(Self { features, heard, ..self.clone() })
    }

    /// The row of a value of the control's own domain.
    pub(crate) fn row_of(&self, value: &[f64]) -> Result<Vec<f32>, AlignError> {
        let width = self.features.width();
        if value.len() != width || value.iter().any(|number| !number.is_finite()) {
            let what = format!("a place of this control is {width} numbers, not {}", value.len());
            return Err(AlignError::Key { what });
        }
        Ok(match self.scaling() {
            Some((centre, scale)) => {
                value.iter().zip(centre).map(|(v, c)| ((v - c) * scale) as f32).collect()
            }
            None => value.iter().map(|&v| v as f32).collect(),
        })
    }

    /// The centre and the factor of its points or values, when its rows are such.
    pub(crate) fn scaling(&self) -> Option<(&[f64], f64)> {
        match &self.domain {
            Some(Domain::Scaled { centre, scale }) => Some((centre, *scale)),
            Some(Domain::Labels(_)) | None => None,
        }
    }

    /// The row of a label.
    pub(crate) fn row_of_label(&self, label: &str) -> Result<Vec<f32>, AlignError> {
        let Some(Domain::Labels(names)) = &self.domain else {
            let what = format!("this control has no labels, and so no `{label}`: give a time or a place");
            return Err(AlignError::Key { what });
        };
        let Some(column) = names.iter().position(|name| name == label) else {
            let what = format!("there is no label `{label}`; there are {}", names.join(", "));
            return Err(AlignError::Key { what });
        };
        Ok((0..names.len()).map(|index| f32::from(u8::from(index == column))).collect())
    }

    pub(crate) fn validate(&self) -> Result<(), AlignError> {
        if self.rate.is_finite() && self.rate > 0.0 {
            Ok(())
        } else {
            Err(AlignError::Option { name: "the control's rate", value: self.rate, range: "above 0" })
        }
    }

    /// The control of another motion, of any skeleton: its frame features (MAMM Sec. 4.5). A rest-pose lead-in is
    /// left out.
    ///
    /// # Errors
    /// When the motion cannot be resampled.
    pub fn from_motion(motion: &Clip, rate: f64, features: &FeatureOptions) -> Result<Self, AlignError> {
        let lead_in = inkrig_motion::lead_in::rest_pose_frames(motion);
        let motion = time::trim(motion, lead_in..motion.frames())?;
        let frames = time::resampled_frames(&motion, rate);
        if frames > MOST_FRAMES {
            let what = "the motion to be like";
            return Err(AlignError::TooLong {
                what,
                frames,
                most: MOST_FRAMES,
                cut: "a motion editor first",
            });
        }
        let motion = time::decimate(&motion, rate)?;
        let rate = motion.frame_rate();
        let features = frame_features(&motion.into(), features);
        Ok(Self { features, rate, cyclic: false, domain: None, kind: ControlKind::Motion, heard: None })
    }

    /// The control of a drawn 2D curve: points at constant time intervals, smoothed (MAMM Sec. 4.1).
    ///
    /// # Errors
    /// When the curve does not move, or the number of samples is not usable.
    pub fn from_curve(curve: &Curve, options: &CurveOptions) -> Result<Self, AlignError> {
        let own = || frame_count(curve, options.rate).unwrap_or((TIMELESS * options.rate).round() as usize);
        let samples = checked(options.samples.unwrap_or_else(own))?;
        let timing = options.timing.unwrap_or_else(|| Timing::automatic(curve, samples));
        let points = if options.goes_on && curve.is_closed() {
            let mut points = resample(&curve.closed_up(), samples + 1, timing)?;
            points.truncate(samples);
            smooth(&points, options.smooth, Ends::Cyclic)?
        } else {
            smooth(&resample(curve, samples, timing)?, options.smooth, Ends::Open)?
        };
        let values: Vec<f64> = points.iter().flatten().copied().collect();
        Self::from_values(&values, 2, options.rate, ControlKind::Curve)
    }

    /// The control of a wave given by an expression (MAMM Sec. 4.2). Its length is `samples`, else its own, else ten
    /// seconds.
    ///
    /// # Errors
    /// When it does not change, is too fast for the rate, or shorter than asked.
    pub fn from_wave(wave: &Wave, samples: Option<usize>, rate: f64) -> Result<Self, AlignError> {
        let own = || wave.frame_count(rate).unwrap_or((TIMELESS * rate).round() as usize);
        let samples = checked(samples.unwrap_or_else(own))?;
        Self::from_values(&wave.sample(rate, samples)?, 1, rate, ControlKind::Wave)
    }

    /// The control of a table: a wave (width 1) or a curve of any number of dimensions.
    ///
    /// # Errors
    /// When it is too long or does not change.
    pub fn from_table(table: &Table, samples: Option<usize>, rate: f64) -> Result<Self, AlignError> {
        Self::from_table_as(table, &CurveOptions { samples, rate, smooth: 0.0, ..CurveOptions::default() })
    }

    /// As [`Self::from_table`], smoothed, spread evenly along its way with [`Timing::ArcLength`], and going on from its end to
    /// its beginning, as the options say.
    ///
    /// # Errors
    /// As for [`Self::from_table`], and when the smoothing is out of range.
    pub fn from_table_as(table: &Table, options: &CurveOptions) -> Result<Self, AlignError> {
        let (width, rate) = (table.width(), options.rate);
        let samples = checked(options.samples.unwrap_or_else(|| table.frame_count(rate)))?;
        let closes = options.goes_on && table.repeats_its_first();
        let frames = samples + usize::from(closes);
        let mut values = if options.timing == Some(Timing::ArcLength) {
            table.resample_evenly(frames)?
        } else {
            table.resample(frames)?
        };
        values.truncate(samples * width);
        if options.smooth != 0.0 {
            let ends = if closes { Ends::Cyclic } else { Ends::Open };
            for column in 0..width {
                let own: Vec<[f64; 1]> = values.chunks_exact(width).map(|row| [row[column]]).collect();
                let smoothed = smooth(&own, options.smooth, ends)?;
                values.chunks_exact_mut(width).zip(smoothed).for_each(|(row, [value])| row[column] = value);
            }
        }
        let kind = if width == 1 { ControlKind::Wave } else { ControlKind::Curve };
        Self::from_values(&values, width, rate, kind)
    }

    /// The control of a sound's plain wave (MAMM Sec. 4.2): the mean of the samples around each frame, where the file holds
    /// a slow curve. Of something to hear that is nothing, and its outline (the peaks) is taken: where means span less than a
    /// tenth of what peaks do.
    ///
    /// # Errors
    /// When it is silent throughout or too long.
    pub fn from_waveform(sound: &Sound, samples: Option<usize>, rate: f64) -> Result<Self, AlignError> {
        if sound.is_silent() {
            return Err(AlignError::Silence);
        }
        checked_sound(sound, 1, rate)?;
        let curve = |kind| Ok::<_, AlignError>(waveform(sound, rate, kind)?.values);
        let most = |values: &[f32]| values.iter().fold(0.0_f32, |most, value| most.max(value.abs()));
        let (means, peaks) = (curve(WaveformKind::Mean)?, curve(WaveformKind::Peak)?);
        let values = if most(&means) < 0.1 * most(&peaks) { peaks } else { means };
        let values: Vec<f64> = values.into_iter().map(f64::from).collect();
        let played = checked(samples.unwrap_or(values.len()))?;
        let rate = values.len() as f64 * rate / played.max(1) as f64;
        Self::from_values(&values, 1, rate, ControlKind::Wave)
    }

    /// The control of labels over time: one-hot rows (MAMM Sec. 4.3). Which label becomes which movement is found by
    /// itself, or said by keys.
    ///
    /// # Errors
    /// When there is a single label, or the length loses one.
    pub fn from_labels(labels: &Labels, samples: Option<usize>, rate: f64) -> Result<Self, AlignError> {
        let samples = checked(samples.unwrap_or_else(|| labels.frame_count(rate)))?;
        let rows = labels.to_one_hot(rate, Some(samples))?;
        let features = Features::new(rows.values, rows.names.len())?;
        let domain = Some(Domain::Labels(rows.names));
        Ok(Self { features, rate, cyclic: false, domain, kind: ControlKind::Labels, heard: None })
    }

    /// The control of a sound: 40 mel-frequency cepstral coefficients, 43 times a second (MAMM Sec. 4.4), smoothed.
    ///
    /// # Errors
    /// When it is silent throughout or too long, or the smoothing is out of range.
    pub fn from_sound(sound: &Sound, options: &SoundOptions) -> Result<Self, AlignError> {
        const COEFFICIENTS: usize = 40;
        if sound.is_silent() {
            return Err(AlignError::Silence);
        }
        checked_sound(sound, options.times, options.rate)?;
        let played;
        let sound = if options.times == 1 {
            sound
        } else {
            played = Sound::new(sound.samples().repeat(options.times), sound.rate())?;
            &played
        };
        let spectrogram = MelSpectrogram::new(sound)?;
        let mfcc = spectrogram.mfcc(&MfccOptions { coefficients: COEFFICIENTS, ..MfccOptions::default() })?;
        let heard = Heard {
            loudness: loudness(sound, LoudnessScale::Decibels)?.values,
            onsets: spectrogram.onset_strength().values,
            plain: Features::new(mfcc.values, COEFFICIENTS)?,
        };
        let (rows, _) = heard.plain.as_slice().as_chunks::<COEFFICIENTS>();
        let rows: Vec<[f64; COEFFICIENTS]> = rows.iter().map(|row| row.map(f64::from)).collect();
        let rows = smooth(&rows, options.smooth * mfcc.rate_hz / options.rate, Ends::Open)?;
        let values = rows.into_iter().flatten().map(|value| value as f32).collect();
        let (features, kind) = (Features::new(values, COEFFICIENTS)?, ControlKind::Sound);
        Ok(Self { features, rate: mfcc.rate_hz, cyclic: false, domain: None, kind, heard: Some(heard) })
    }

    /// A control of any rows of numbers (frames x width). They are centred and scaled in double precision: small changes
    /// far from the origin would lose their digits otherwise.
    fn from_values(values: &[f64], width: usize, rate: f64, kind: ControlKind) -> Result<Self, AlignError> {
        let frames = (values.len() / width).max(1) as f64;
        let mut centre = vec![0.0; width];
        for row in values.chunks_exact(width) {
            centre.iter_mut().zip(row).for_each(|(sum, value)| *sum += value / frames);
        }
        let offsets = values.chunks_exact(width).flat_map(|row| row.iter().zip(&centre).map(|(v, c)| v - c));
        let size = offsets.clone().map(f64::abs).fold(0.0, f64::max);
        let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
        let features = Features::new(offsets.map(|offset| (offset * scale) as f32).collect(), width)?;
        Ok(Self {
            features,
            rate,
            cyclic: false,
            domain: Some(Domain::Scaled { centre, scale }),
            kind,
            heard: None,
        })
    }
}

/// Says what is too long before anything of that length is made.
fn checked(samples: usize) -> Result<usize, AlignError> {
    if samples > MOST_FRAMES {
        let cut = "--length";
        return Err(AlignError::TooLong { what: "the control", frames: samples, most: MOST_FRAMES, cut });
    }
    Ok(samples)
}

fn checked_sound(sound: &Sound, times: usize, rate: f64) -> Result<(), AlignError> {
    if times == 0 {
        return Err(AlignError::Option {
            name: "how often the sound is played",
            value: 0.0,
            range: "1 or more",
        });
    }
    let (seconds, most) = (sound.seconds() * times as f64, MOST_FRAMES as f64 / rate);
    if seconds > most { Err(AlignError::LongSound { seconds, most }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_control_goes_on_as_often_as_asked() {
        let wave = Control::from_wave(&"sine(1Hz)".parse().unwrap(), Some(30), 30.0).unwrap();
        let thrice = wave.repeated(3).unwrap();
        assert_eq!(thrice.features.frames(), 90);
        assert_eq!(thrice.features.row(65), wave.features.row(5));
        assert!(wave.repeated(0).is_err(), "nothing to follow");
        assert!(matches!(wave.repeated(usize::MAX), Err(AlignError::TooLong { .. })));

        let sound = Sound::new((0..8000).map(|i| (i as f32 * 0.2).sin()).collect(), 8000).unwrap();
        let played = |times| Control::from_sound(&sound, &SoundOptions { times, ..Default::default() });
        let (once, twice) = (played(1).unwrap(), played(2).unwrap());
        assert_eq!(twice.features.frames(), 2 * once.features.frames() - 1, "frames at both ends");
        let heard = twice.repeated(2).unwrap().heard.unwrap();
        assert_eq!(heard.loudness.len(), 2 * twice.heard.unwrap().loudness.len());
        assert!(matches!(played(0), Err(AlignError::Option { .. })));
        assert!(matches!(played(1 << 20), Err(AlignError::LongSound { .. })), "refused before it is made");
    }

    #[test]
    fn a_closed_curve_that_goes_on_has_no_point_twice() {
        let turn = |i: usize, of: usize| (i as f64 / of as f64 * std::f64::consts::TAU).sin_cos();
        // The first point again at the end, or left out there.
        for points in [0..=120, 0..=119] {
            let points: Vec<[f64; 2]> = points.map(|i| turn(i, 120).into()).collect();
            let curve = Curve::new(points).unwrap();
            for (smooth, timing) in [(2.0, None), (0.0, None), (2.0, Some(Timing::ArcLength))] {
                let options =
                    CurveOptions { samples: Some(90), smooth, timing, goes_on: true, ..Default::default() };
                even(&Control::from_curve(&curve, &options).unwrap(), 0.02);
                // Without a seam the first point stands there twice.
                let open = Control::from_curve(&curve, &CurveOptions { goes_on: false, ..options }).unwrap();
                assert!(steps(&open)[89] < 0.3 * steps(&open)[40] || curve.point_count() == 120);
            }
        }
        let rows = |last: usize| {
            let row = |i: usize| format!("{},{},{}\n", turn(i, 60).0, turn(i, 60).1, turn(i + 9, 60).0);
            inkrig_sketch::read_table((0..=last).map(row).collect::<String>().as_bytes()).unwrap()
        };
        for (timing, smooth) in [(None, 0.0), (Some(Timing::ArcLength), 2.0)] {
            let options =
                CurveOptions { samples: Some(60), smooth, timing, goes_on: true, ..Default::default() };
            even(&Control::from_table_as(&rows(60), &options).unwrap(), 0.5);
        }
        let wobble: String = (0..60).map(|i| format!("{i},{},{}\n", i % 2, 3 * (i % 2))).collect();
        let wobble = inkrig_sketch::read_table(wobble.as_bytes()).unwrap();
        let straight = CurveOptions { smooth: 4.0, ..CurveOptions::default() };
        let [rough, smooth] = [CurveOptions { smooth: 0.0, ..straight }, straight]
            .map(|options| steps(&Control::from_table_as(&wobble, &options).unwrap())[30]);
        assert!(smooth < 0.5 * rough, "{smooth} {rough}");
    }

    /// Lengths of the steps around a control.
    fn steps(control: &Control) -> Vec<f32> {
        let count = control.features.frames();
        let step = |i: usize| {
            let pairs = control.features.row(i).iter().zip(control.features.row((i + 1) % count));
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
        };
        (0..count).map(step).collect()
    }

    /// Steps of a circle, that over the seam too, differ by no more than a share of their mean.
    fn even(control: &Control, within: f32) {
        let steps = steps(control);
        let mean = steps.iter().sum::<f32>() / steps.len() as f32;
        assert!(steps.iter().all(|step| (step / mean - 1.0).abs() < within), "{steps:?}");
    }

    #[test]
    fn place_and_scale_do_not_matter() {
        let circle = |x: f64, size: f64| {
            let at = |i: usize| (i as f64 * 0.1).sin_cos();
            let points = (0..90).map(|i| [x + size * at(i).0, -x + size * at(i).1]).collect();
            Control::from_curve(&Curve::new(points).unwrap(), &CurveOptions::default()).unwrap()
        };
        let (near, far) = (circle(0.0, 1.0), circle(1e6, 1e-3));
        assert_eq!(near.features.frames(), 90);
        for (a, b) in near.features.as_slice().iter().zip(far.features.as_slice()) {
            assert!((a - b).abs() < 1e-5);
        }
    }
}
