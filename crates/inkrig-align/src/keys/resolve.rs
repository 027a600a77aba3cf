//! Keys as they are given, checked and brought to frames of what is matched.

use super::fixed::Fixed;
use super::hard::{Hard, check_times};
use super::moment::{Moment, Passage, Seen};
use super::{Key, Place, Pose};
use crate::pca::Subspace;
use crate::reconstruct::{Anchor, frames_per_sample};
use crate::{AlignError, Control, Layout, Options};
use inkrig_motion::{FeatureLayout, Takes};

/// Keys in frames of the matched source and control; the default asks for nothing.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    /// In the order in which they were given.
    pub(super) list: Vec<Resolved>,
}

/// One key, ready for the solver.
#[derive(Debug, Clone)]
pub(super) enum Resolved {
    Soft { pose: String, place: SoftPlace, moment: Moment, weight: f64 },
    Avoid { pose: String, moment: Moment, distance: f64, weight: f64 },
    Hard(Hard),
    Never { pose: String, moment: Moment, radius: f64 },
    Fixed(Fixed),
}

/// Where in the control.
#[derive(Debug, Clone)]
pub(super) enum SoftPlace {
    /// Frame at the matching rate.
    Frame(usize),
    /// Values that stay for a whole patch.
    Row(Vec<f32>),
}

/// How the frames of the source as it was given lie in what is matched.
pub(crate) struct Timing<'a> {
    /// The source as it was given.
    pub(crate) given: &'a Takes,
    /// Frames left out at the beginning of every take.
    pub(crate) lead_ins: &'a [usize],
    /// The source without them.
    pub(crate) source: &'a Takes,
    /// The same at the matching rate.
    pub(crate) matched: &'a Takes,
}

/// What keys are held against.
pub(crate) struct Context<'a> {
    pub(crate) timing: Timing<'a>,
    /// Features of the matched source.
    pub(crate) layout: &'a FeatureLayout,
    /// The subspace in which it is matched.
    pub(crate) subspace: &'a Subspace,
    pub(crate) control: &'a Control,
    /// Of the control at the matching rate.
    pub(crate) rows: &'a Layout,
    pub(crate) options: &'a Options,
}

impl Keys {
    /// Checks the keys of the options and brings them to frames of what is matched.
    pub(crate) fn new(context: &Context<'_>) -> Result<Self, AlignError> {
        let mut list = Vec::with_capacity(context.options.keys.len());
        for key in &context.options.keys {
            list.push(match key {
                Key::Soft { place, pose, weight } => {
                    within("weight", *weight, 100.0)?;
                    let place = context.place(place)?;
                    Resolved::Soft {
                        pose: pose.to_string(),
                        place,
                        moment: context.moment(pose)?,
                        weight: *weight,
                    }
                }
                Key::Avoid { pose, distance, weight } => {
                    within("weight", *weight, 100.0)?;
                    within("distance", *distance, 10.0)?;
                    let (name, moment) = (pose.to_string(), context.moment(pose)?);
                    Resolved::Avoid { pose: name, moment, distance: *distance, weight: *weight }
                }
                Key::Hard { seconds, frame } => {
                    let row = context.row_at(*seconds)?;
                    let step = context.step();
                    let frames = (context.rows.frames() as f64 * step).round().max(1.0) as usize;
                    let at = (seconds * context.options.matching_rate * step).round() as usize;
                    // The end of a loop is its beginning.
                    let out = if context.rows.is_cyclic() { at % frames } else { at.min(frames - 1) };
                    Resolved::Hard(Hard {
                        seconds: *seconds,
                        row,
                        out,
                        matched: context.matched_frame(*frame)?,
                        own: context.timing.own_frame(*frame)?,
                        given: *frame,
                    })
                }
                Key::Never { pose, radius } => {
                    within("radius", *radius, 10.0)?;
                    Resolved::Never { pose: pose.to_string(), moment: context.moment(pose)?, radius: *radius }
                }
                Key::Fixed { earlier, frames } => {
                    Resolved::Fixed(Fixed::new(earlier, frames.clone(), context)?)
                }
            });
        }
        let keys = Self { list };
        check_times(&keys, context)?;
        Ok(keys)
    }

    /// What the finished motion shall be exactly, at the source's own rate, in order of time.
    pub(crate) fn anchors(&self) -> Vec<Anchor<'_>> {
        let mut anchors: Vec<Anchor<'_>> = (self.list.iter())
            .filter_map(|key| match key {
                Resolved::Hard(hard) => Some(Anchor::Frame { at: hard.out, source: hard.own }),
                Resolved::Fixed(fixed) => Some(fixed.anchor()),
                _ => None,
            })
            .collect();
        anchors.sort_by_key(Anchor::first);
        anchors.dedup();
        anchors
    }

    /// Whether anything is forbidden.
    pub(crate) fn forbid(&self) -> bool {
        self.list.iter().any(|key| matches!(key, Resolved::Never { .. }))
    }

    pub(super) fn hards(&self) -> impl Iterator<Item = &Hard> {
        self.list.iter().filter_map(|key| if let Resolved::Hard(hard) = key { Some(hard) } else { None })
    }

    pub(super) fn fixeds(&self) -> impl Iterator<Item = &Fixed> {
        self.list.iter().filter_map(|key| if let Resolved::Fixed(fixed) = key { Some(fixed) } else { None })
    }
}

fn within(name: &str, value: f64, most: f64) -> Result<(), AlignError> {
    if (0.0..=most).contains(&value) {
        Ok(())
    } else {
        Err(AlignError::Key { what: format!("a {name} of {value} is not between 0 and {most}") })
    }
}

impl Context<'_> {
    /// Frames of the source per matched frame.
    pub(super) fn step(&self) -> f64 {
        let timing = &self.timing;
        frames_per_sample(timing.source.clip().frame_rate(), timing.matched.clip().frame_rate())
    }

    pub(super) fn seen(&self) -> Seen<'_> {
        Seen {
            matched: self.timing.matched,
            layout: self.layout,
            subspace: self.subspace,
            options: self.options,
        }
    }

    /// The control's frame at a time.
    fn row_at(&self, seconds: f64) -> Result<usize, AlignError> {
        let rate = self.options.matching_rate;
        let length = self.rows.frames() as f64 / rate;
        if !(0.0..=length).contains(&seconds) {
            let what =
                format!("{seconds} s is outside of the control's {length:.2} s: give a time within it");
            return Err(AlignError::Key { what });
        }
        let (row, rows) = ((seconds * rate).round() as usize, self.rows.frames());
        Ok(if self.rows.is_cyclic() { row % rows } else { row.min(rows - 1) })
    }

    fn place(&self, place: &Place) -> Result<SoftPlace, AlignError> {
        Ok(match place {
            Place::Time(seconds) => SoftPlace::Frame(self.row_at(*seconds)?),
            Place::Row(row) => {
                let rows = self.control.features.frames();
                if *row >= rows {
                    let what = format!("there is no frame {row} in a control of {rows} (they count from 0)");
                    return Err(AlignError::Key { what });
                }
                SoftPlace::Frame(self.row_at(*row as f64 / self.control.rate)?)
            }
            Place::Value(value) => SoftPlace::Row(self.control.row_of(value)?),
            Place::Label(label) => SoftPlace::Row(self.control.row_of_label(label)?),
        })
    }

    /// The matched frame of a frame of the source as it was given; one whose clip has a patch.
    fn matched_frame(&self, frame: usize) -> Result<usize, AlignError> {
        let matched = self.timing.matched_frame(frame, self.step())?;
        let takes = self.timing.matched;
        let patch = self.options.patch();
        match takes.ranges().enumerate().find(|(_, range)| range.contains(&matched)) {
            Some((clip, range)) if range.len() < patch => {
                let what = format!(
                    "frame {frame} is of clip {}, which is not used: with {} frames at {} a second it is shorter than a \
                     piece of {patch}; give a longer clip, or a smaller --patch",
                    clip + 1,
                    range.len(),
                    takes.clip().frame_rate()
                );
                Err(AlignError::Key { what })
            }
            _ => Ok(matched),
        }
    }

    fn moment(&self, pose: &Pose) -> Result<Moment, AlignError> {
        Ok(match pose {
            Pose::Frame(frame) => Moment::Own(self.matched_frame(*frame)?),
            Pose::Of { name, clip, frame } => Moment::Other(Passage::new(name, clip, *frame, self.seen())?),
        })
    }
}

impl Timing<'_> {
    /// The frame of the source without lead-ins.
    fn own_frame(&self, frame: usize) -> Result<usize, AlignError> {
        let total = self.given.clip().frames();
        for ((given, own), &lead_in) in self.given.ranges().zip(self.source.ranges()).zip(self.lead_ins) {
            if given.contains(&frame) {
                let place = frame - given.start;
                return if place >= lead_in {
                    Ok(own.start + place - lead_in)
                } else {
                    Err(AlignError::Key {
                        what: format!("frame {frame} belongs to the rest pose that is left out"),
                    })
                };
            }
        }
        Err(AlignError::Key {
            what: format!("there is no frame {frame} in a clip of {total} (they count from 0)"),
        })
    }

    /// The matched frame that is nearest to a frame of the source as it was given.
    fn matched_frame(&self, frame: usize, step: f64) -> Result<usize, AlignError> {
        let own = self.own_frame(frame)?;
        let takes = self.source.ranges().zip(self.matched.ranges());
        let found = takes.into_iter().find(|(range, _)| range.contains(&own)).map(|(range, matched)| {
            let place = ((own - range.start) as f64 / step).round() as usize;
            (matched.start + place).min(matched.end - 1)
        });
        found.ok_or_else(|| AlignError::Key { what: format!("there is no frame {frame} in the clip") })
    }
}
