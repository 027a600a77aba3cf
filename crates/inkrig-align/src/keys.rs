//! Keyframes: wishes that tie a place of the control to a moment of the clip (MAMM Sec. 3.3).

use crate::patches::{PatchScratch, patch_distances};
use crate::reconstruct::frames_per_sample;
use crate::{AlignError, Control, Layout};
use inkrig_motion::Takes;
use inkrig_transport::{Mask, Mat, MatRef, Problem};

/// One wish. Frames are those of the source as it was given, at its own rate, takes counted through.
#[derive(Debug, Clone, PartialEq)]
pub enum Key {
    /// Where the control is at (or near) `place`, the motion shall be at (or near) `frame`; what is far from the one
    /// shall be far from the other. `weight` is about 0.3 to 1 (Sec. 3.3.1).
    Soft {
        /// A place of the control's domain.
        place: Place,
        /// Frame of the source.
        frame: usize,
        /// How much it counts, 0..=100.
        weight: f64,
    },
    /// At that time of the control the pose is exactly that of `frame` (Sec. 3.3.2).
    Hard {
        /// Seconds since the beginning of the control.
        seconds: f64,
        /// Frame of the source.
        frame: usize,
    },
    /// Nothing like the moment around `frame` may appear.
    Never {
        /// Frame of the source.
        frame: usize,
        /// Moments nearer than this are left out too; in mean distances of the clip's moments, 0..=10.
        radius: f64,
    },
}

/// A place of the control's domain.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Where the control is at that time, seconds since its beginning.
    Time(f64),
    /// A point of the canvas, a value, a row of labels: as many numbers as the control has, in its own units. It need
    /// not lie on the control.
    Value(Vec<f64>),
}

/// Keys in frames of the matched source and control; the default asks for nothing.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    soft: Vec<(SoftPlace, usize, f64)>,
    hard: Vec<(usize, usize)>,
    never: Vec<(usize, f32)>,
    /// Output frame and source frame, both at the source's own rate and without lead-ins.
    pub(crate) exact: Vec<(usize, usize)>,
}

#[derive(Debug, Clone)]
enum SoftPlace {
    Frame(usize),
    Row(Vec<f32>),
}

/// What the keys ask of one level.
#[derive(Debug, Default)]
pub(crate) struct LevelKeys {
    pub(crate) mask: Mask,
    soft: Vec<(Vec<f32>, usize, f64)>,
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

impl Keys {
    /// Checks keys and brings them to frames of what is matched.
    pub(crate) fn new(
        keys: &[Key],
        control: &Control,
        timing: &Timing<'_>,
        rows: &Layout,
        matching_rate: f64,
    ) -> Result<Self, AlignError> {
        let step = frames_per_sample(timing.source.clip().frame_rate(), timing.matched.clip().frame_rate());
        let control_frame = |seconds: f64| {
            let last = rows.frames() as f64 / matching_rate;
            if !(0.0..=last).contains(&seconds) {
                return Err(AlignError::Key {
                    what: format!("{seconds} s is outside of the control's {last:.2} s"),
                });
            }
            Ok(((seconds * matching_rate).round() as usize).min(rows.frames() - 1))
        };
        let within = |name: &str, value: f64, most: f64| {
            if (0.0..=most).contains(&value) {
                Ok(())
            } else {
                Err(AlignError::Key { what: format!("a {name} of {value} is not between 0 and {most}") })
            }
        };
        let mut all = Self::default();
        for key in keys {
            match key {
                Key::Soft { place, frame, weight } => {
                    within("weight", *weight, 100.0)?;
                    let place = match place {
                        Place::Time(seconds) => SoftPlace::Frame(control_frame(*seconds)?),
                        Place::Value(value) => SoftPlace::Row(control.row_of(value)?),
                    };
                    all.soft.push((place, timing.matched_frame(*frame, step)?, *weight));
                }
                Key::Hard { seconds, frame } => {
                    let at = control_frame(*seconds)?;
                    all.hard.push((at, timing.matched_frame(*frame, step)?));
                    all.exact.push(((at as f64 * step).round() as usize, timing.own_frame(*frame)?));
                }
                Key::Never { frame, radius } => {
                    within("radius", *radius, 10.0)?;
                    all.never.push((timing.matched_frame(*frame, step)?, *radius as f32));
                }
            }
        }
        Ok(all)
    }

    /// What they ask at a level: `source_distances` are its normalised distances, `control` its frames with the factor
    /// by which its distances were normalised.
    pub(crate) fn at_level(
        &self,
        (full_rows, full_columns): (&Layout, &Layout),
        (rows, columns): (&Layout, &Layout),
        source_distances: MatRef<'_, f32>,
        control: (MatRef<'_, f32>, f32),
        control_distances: MatRef<'_, f32>,
    ) -> Result<LevelKeys, AlignError> {
        let row = |frame: usize| rows.patch_around(full_rows.frame_in(rows, frame)).unwrap_or(0);
        let column = |frame: usize| columns.patch_around(full_columns.frame_in(columns, frame)).unwrap_or(0);
        let mut level = LevelKeys::default();
        for &(frame, radius) in &self.never {
            let centre = column(frame);
            let near =
                source_distances.row(centre).iter().enumerate().filter(|(_, distance)| **distance < radius);
            level.mask.columns.extend(near.map(|(patch, _)| patch));
            let covering = columns.covering(full_columns.frame_in(columns, frame));
            level.mask.columns.extend(covering.into_iter().map(|(patch, _)| patch));
        }
        level.mask.columns.sort_unstable();
        level.mask.columns.dedup();
        if level.mask.columns.len() == columns.patches() {
            let what =
                "the moments that must not appear are the whole clip: give a smaller radius".to_string();
            return Err(AlignError::Key { what });
        }
        for &(at, frame) in &self.hard {
            let (row, column) = (row(at), column(frame));
            if level.mask.columns.binary_search(&column).is_ok() {
                let what =
                    "a pose is asked for at one time and forbidden at all: drop one of the two".to_string();
                return Err(AlignError::Key { what });
            }
            // At coarse levels two keys may fall on one patch: the first holds it, both hold at the finest.
            if level.mask.rows.iter().all(|&(taken, _)| taken != row) {
                level.mask.rows.push((row, column));
            }
        }
        for (place, frame, weight) in &self.soft {
            let to_key = match place {
                SoftPlace::Frame(at) => control_distances.row(row(*at)).to_vec(),
                SoftPlace::Row(value) => still_distances(value, control, rows)?,
            };
            level.soft.push((to_key, column(*frame), *weight));
        }
        Ok(level)
    }
}

impl LevelKeys {
    /// The problem with what is asked.
    pub(crate) fn bind<'a>(
        &'a self,
        problem: Problem<'a, f32>,
        cost: Option<&'a Mat<f32>>,
    ) -> Result<Problem<'a, f32>, AlignError> {
        let problem = match cost {
            Some(cost) => problem.with_linear(cost.view())?,
            None => problem,
        };
        let masked = !(self.mask.rows.is_empty() && self.mask.columns.is_empty());
        Ok(if masked { problem.with_mask(&self.mask)? } else { problem })
    }

    /// The linear cost of the soft keys at weight alpha, N x M: alpha (2 w / K) (d_Y(y_i, y_k) - d_X(x_j, x_k))^2, summed over
    /// keys; what the paper's block-diagonal substitution amounts to. `None` without soft keys.
    pub(crate) fn cost(
        &self,
        source_distances: MatRef<'_, f32>,
        rows: usize,
        alpha: f64,
    ) -> Option<Mat<f32>> {
        if self.soft.is_empty() {
            return None;
        }
        let share = 2.0 * alpha / self.soft.len() as f64;
        let mut cost = Mat::zeros(rows, source_distances.cols());
        for (to_key, column, weight) in &self.soft {
            let factor = (share * weight) as f32;
            for (i, &control) in to_key.iter().enumerate() {
                for (value, &source) in cost.row_mut(i).iter_mut().zip(source_distances.row(*column)) {
                    *value += factor * (control - source) * (control - source);
                }
            }
        }
        Some(cost)
    }

    /// Makes a plan of any weights obey the mask; rows that lose all their mass get the nearest open column.
    pub(crate) fn impose(&self, plan: &mut Mat<f32>, cost: MatRef<'_, f32>) {
        let mass = 1.0 / plan.rows() as f32;
        let untouched = if self.mask.columns.is_empty() { plan.rows() } else { 0 };
        for i in untouched..plan.rows() {
            let row = plan.row_mut(i);
            self.mask.columns.iter().for_each(|&column| row[column] = 0.0);
            let total: f32 = row.iter().sum();
            if total > 0.0 {
                row.iter_mut().for_each(|value| *value *= mass / total);
            } else {
                let open = |column: &usize| self.mask.columns.binary_search(column).is_err();
                let nearest =
                    (0..row.len()).filter(open).min_by(|&a, &b| cost.row(i)[a].total_cmp(&cost.row(i)[b]));
                if let Some(column) = nearest {
                    row[column] = mass;
                }
            }
        }
        for &(row, column) in &self.mask.rows {
            plan.row_mut(row).fill(0.0);
            plan.row_mut(row)[column] = mass;
        }
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

/// Normalised distances of the control's patches to a patch that stays at one row of values.
fn still_distances(
    row: &[f32],
    (control, scale): (MatRef<'_, f32>, f32),
    rows: &Layout,
) -> Result<Vec<f32>, AlignError> {
    let patch = rows.patch();
    let still = Mat::from_fn(patch, row.len(), |_, column| row[column]);
    let layout = Layout::open(patch, patch);
    let (mut out, mut scratch) = (Mat::default(), PatchScratch::new());
    patch_distances((control, rows), (still.view(), &layout), scale, &mut scratch, &mut out, 1)?;
    Ok(out.into_vec())
}
