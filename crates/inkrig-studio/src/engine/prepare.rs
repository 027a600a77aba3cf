//! What a document asks of the engine.

use super::SourceMap;
use super::keys::{Waiting, WishedKeys, wished_keys};
use super::media::Media;
use crate::StudioError;
use crate::document::{self, Control as Drawn, CurveTiming, Document};
use crate::project::Folder;
use inkrig_align::{Control, ControlKind, CurveOptions, Key, Options, Preset, SoundOptions};
use inkrig_formats::{Import, SourceInfo};
use inkrig_motion::{Takes, cycle, time};
use inkrig_sketch::{Curve, Format, LabelLength, Labels, Timing, Wave, read_wave};
use std::sync::Arc;

/// A source, ready to be arranged.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// What is arranged.
    pub takes: Arc<Takes>,
    /// How the first clip was written, and so how a result is.
    pub written_as: SourceInfo,
    /// Frames of the page and of the engine.
    pub map: SourceMap,
}

/// What a document asks of the engine.
#[derive(Debug)]
pub struct Wishes {
    /// What is followed.
    pub control: Control,
    /// How, keys included.
    pub options: Options,
    /// Ids of the keys of the options, in their order.
    pub counting: Vec<String>,
    /// Keys that cannot count as things are.
    pub waiting: Vec<Waiting>,
}

impl Wishes {
    /// Keys that were found to be impossible wait.
    pub(super) fn leave_out(&mut self, refused: &[Waiting]) {
        for key in refused {
            if let Some(index) = self.counting.iter().position(|id| *id == key.id) {
                self.counting.remove(index);
                self.options.keys.remove(index);
                self.waiting.push(key.clone());
            }
        }
    }

    /// The key that a message of the engine is about: the exact one whose frame and time it names, else, where something
    /// forbidden is in the way of a part that stays or of everything, the newest that forbids.
    pub(super) fn named(&self, message: &str) -> Option<Waiting> {
        let waiting = |id: &String, kind, seconds| {
            let why = message.to_string();
            Waiting { id: id.clone(), kind, seconds, why }
        };
        let keys = || self.counting.iter().zip(&self.options.keys);
        let exact = keys().find_map(|(id, key)| {
            let Key::Hard { seconds, frame } = *key else { return None };
            let named = message.contains(&format!("frame {frame} is asked for at {seconds} s"));
            named.then(|| waiting(id, "hard", seconds))
        });
        let mut forbids = keys().rev().filter(|(_, key)| matches!(key, Key::Never { .. }));
        exact.or_else(|| {
            let in_the_way = message.contains("must not appear");
            forbids.next().filter(|_| in_the_way).map(|(id, _)| waiting(id, "never", 0.0))
        })
    }
}

/// What a source is made of; equal ones need not be prepared twice.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceKey(document::Source, Vec<document::ClipEntry>);

impl SourceKey {
    /// Of a document.
    pub fn of(document: &Document) -> Self {
        let entries = document.source.clips.iter().filter_map(|id| document.clip(id)).cloned();
        let nameless = entries.map(|entry| document::ClipEntry { name: String::new(), ..entry });
        Self(document.source.clone(), nameless.collect())
    }
}

impl Prepared {
    /// Reads and joins the clips that are arranged.
    ///
    /// # Errors
    /// When there are none, a file is not understood, or the range holds nothing.
    pub fn source(document: &Document, folder: &Folder, media: &Media) -> Result<Self, StudioError> {
        let mut clips = Vec::new();
        let mut used = Vec::new();
        let mut written_as = None;
        for id in &document.source.clips {
            let import = clip(document, folder, media, id)?;
            let rate = import.clip.frame_rate();
            let frames = import.clip.frames();
            let range = match document.source.range {
                None => 0..frames,
                Some([from, to]) => {
                    let place = |seconds: f64| ((seconds * rate).round().max(0.0) as usize).min(frames);
                    place(from)..place(to)
                }
            };
            if range.is_empty() {
                let seconds = import.clip.duration();
                return Err(StudioError::invalid(format!(
                    "the range holds nothing of a clip of {seconds:.2} s"
                )));
            }
            let part = time::trim(&import.clip, range.clone())?;
            let lap = part.frames();
            let laps =
                if document.source.laps > 1 { cycle::laps(&part, document.source.laps)? } else { None };
            let lap = if laps.is_some() { lap.saturating_sub(1).max(1) } else { lap };
            used.push(laps.unwrap_or(part));
            clips.push((id.clone(), import.clip.clone(), range, lap));
            written_as.get_or_insert_with(|| import.source.clone());
        }
        let written_as = written_as.ok_or(StudioError::NoSource)?;
        let takes = Takes::join(&used)?;
        let map = SourceMap::new(&clips, &takes);
        Ok(Self { takes: Arc::new(takes), written_as, map })
    }

    /// The control and the options of a document, keys included.
    ///
    /// # Errors
    /// When there is nothing to follow, or it cannot be.
    pub fn wishes(&self, document: &Document, folder: &Folder, media: &Media) -> Result<Wishes, StudioError> {
        let settings = &document.settings;
        let preset = match settings.preset {
            document::Preset::Follow => Preset::Follow,
            document::Preset::Natural => Preset::Natural,
        };
        let drawn = document.control.as_ref().ok_or(StudioError::NoControl)?;
        let mut options = Options::for_control(kind(drawn), preset);
        let set = |slot: &mut f64, given: Option<f64>| *slot = given.unwrap_or(*slot);
        set(&mut options.alpha, settings.structure);
        set(&mut options.lambda, settings.evenness);
        set(&mut options.epsilon, settings.blend);
        options.seed = settings.seed;
        options.mirror = settings.mirror;
        options.validate()?;
        let control = control(document, drawn, &options, folder, media)?;
        let rate = options.matching_rate;
        let seconds = control.frames(rate) as f64 / rate;
        let WishedKeys { keys, counting, waiting } =
            wished_keys(document, drawn, seconds, self, (folder, media))?;
        options.keys = keys;
        options.validate()?;
        Ok(Wishes { control, options, counting, waiting })
    }
}

/// A clip of the document.
pub(crate) fn clip(
    document: &Document,
    folder: &Folder,
    media: &Media,
    id: &str,
) -> Result<Arc<Import>, StudioError> {
    media.clip(folder, document.clip(id).ok_or_else(|| StudioError::unknown("clip", id))?)
}

fn kind(control: &Drawn) -> ControlKind {
    match control {
        Drawn::Curve { .. } => ControlKind::Curve,
        Drawn::Wave { .. } | Drawn::DrawnWave { .. } => ControlKind::Wave,
        Drawn::Labels { .. } => ControlKind::Labels,
        Drawn::Sound { .. } => ControlKind::Sound,
        Drawn::Motion { .. } => ControlKind::Motion,
    }
}

fn control(
    document: &Document,
    drawn: &Drawn,
    options: &Options,
    folder: &Folder,
    media: &Media,
) -> Result<Control, StudioError> {
    let settings = &document.settings;
    let rate = options.matching_rate;
    let samples = settings.length.map(|seconds| (seconds * rate).round().clamp(0.0, 1e9) as usize);
    let mut control = match drawn {
        Drawn::Curve { strokes, timing, smooth } => {
            let options = CurveOptions {
                samples,
                rate,
                smooth: smooth.unwrap_or(CurveOptions::default().smooth),
                timing: (*timing == CurveTiming::Even).then_some(Timing::ArcLength),
                goes_on: settings.cyclic || settings.repeat > 1,
            };
            Control::from_curve(&curve(strokes)?, &options)?
        }
        Drawn::Wave { expression } => Control::from_wave(&expression.parse::<Wave>()?, samples, rate)?,
        Drawn::DrawnWave { points } => {
            let rows: String = points.iter().map(|[t, value]| format!("{t},{value}\n")).collect();
            let table = read_wave(format!("t,value\n{rows}").as_bytes(), Format::Csv)?;
            Control::from_table(&table, samples, rate)?
        }
        Drawn::Labels { segments } => {
            let segments =
                segments.iter().map(|segment| (segment.name.as_str(), LabelLength::Seconds(segment.seconds)));
            Control::from_labels(&Labels::new(segments)?, samples, rate)?
        }
        Drawn::Sound { sound, smooth, outline } => {
            let entry = document.sound(sound).ok_or_else(|| StudioError::unknown("sound", sound))?;
            let sound = media.sound(folder, entry)?;
            if *outline {
                Control::from_waveform(&sound, samples, rate)?
            } else {
                let smooth = smooth.unwrap_or(SoundOptions::default().smooth);
                let heard =
                    Control::from_sound(&sound, &SoundOptions { rate, smooth, times: settings.repeat })?;
                stretched(heard, samples.map(|samples| samples.saturating_mul(settings.repeat)), rate)
            }
        }
        Drawn::Motion { clip: id } => {
            let like = clip(document, folder, media, id)?;
            stretched(Control::from_motion(&like.clip, rate, &options.features)?, samples, rate)
        }
    };
    // A sound was repeated before it was analysed.
    if settings.repeat > 1 && !matches!(drawn, Drawn::Sound { outline: false, .. }) {
        control = control.repeated(settings.repeat)?;
    }
    control.cyclic = settings.cyclic;
    Ok(control)
}

/// The curve of pen points; times and pressures count where all points have them.
pub(super) fn curve(strokes: &[Vec<document::PenPoint>]) -> Result<Curve, StudioError> {
    let curve = Curve::from_strokes(
        strokes.iter().map(|stroke| stroke.iter().map(|point| [point.0, point.1]).collect()),
    )?;
    let all = || strokes.iter().flatten();
    let times: Option<Vec<Vec<f64>>> =
        strokes.iter().map(|stroke| stroke.iter().map(|point| point.2).collect()).collect();
    let curve = match times {
        Some(times) => curve.with_seconds(one_clock(times))?,
        None => curve,
    };
    let pressures: Option<Vec<f64>> = all().map(|point| point.3).collect();
    Ok(match pressures {
        Some(pressures) => curve.with_pressure(pressures)?,
        None => curve,
    })
}

/// Strokes follow each other without the time while the pen is up. Clocks of pens go back at times.
fn one_clock(strokes: Vec<Vec<f64>>) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    for stroke in strokes {
        let shift = out.last().copied().unwrap_or(0.0) - stroke.first().copied().unwrap_or(0.0);
        for time in stroke {
            let last = out.last().copied().unwrap_or(f64::NEG_INFINITY);
            out.push((time + shift).max(last));
        }
    }
    out
}

/// A control said to play at another speed, so that it has a length.
fn stretched(mut control: Control, samples: Option<usize>, rate: f64) -> Control {
    if let Some(samples) = samples {
        control.rate = control.features.frames() as f64 * rate / samples.max(1) as f64;
    }
    control
}
