//! How well each key was met, measured on the finished motion.

use super::Keys;
use super::hard::Hard;
use super::moment::{KeyPatch, Moment};
use super::resolve::Resolved;
use crate::measures::{Dynamics, pearson};
use crate::quality::{centred, column_means, result_frames};
use crate::{AlignError, Layout, Options, sampled};
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::ground::continued;
use inkrig_motion::kinematics::Pose;
use inkrig_motion::{Clip, FeatureLayout, Features, Takes};
use inkrig_transport::Mat;
use serde::Serialize;

/// One key and what came of it. The names are stable.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct KeyRow {
    /// `soft`, `avoid`, `hard`, `never` or `fixed`.
    pub kind: &'static str,
    /// The pose, or the part that stays.
    pub pose: String,
    /// Where the numbers below were taken, seconds of the result: the time that was asked for; else the time at which
    /// the control is nearest to the place (soft) or the motion is nearest to the pose (avoid, never).
    pub seconds: f64,
    /// Distance of the result at that time to the pose, in mean distances of the clip's moments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// What was asked for: the distance to keep, or the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<f64>,
    /// For soft keys: how far the result is from the pose against how far the control is from the place, Pearson's
    /// correlation over all times. 1 is all that the key wants.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// For hard keys: the largest turn by which a joint differs from the pose, radians. Heading does not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation_error: Option<f64>,
    /// For hard keys: the farthest that a joint is from where it is in the pose, relative to the travelling joint, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error: Option<f64>,
    /// The fastest that a joint moves at the pose (hard) or at the borders of the part (fixed), over the 99.9th
    /// percentile of the clip's: above 2 it jumps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump: Option<f64>,
}

/// A finished motion and what it was made of.
pub(crate) struct Finished<'a> {
    result: &'a Clip,
    /// Of a loop: with its first frame again at its end.
    ring: Option<Clip>,
    source: &'a Clip,
    travel_joint: usize,
    control: &'a Mat<f32>,
    rows: &'a Layout,
    columns: &'a Layout,
    /// Features of the result at the matching rate less the mean.
    own: Mat<f32>,
    /// The same of the source.
    frames: Mat<f32>,
    mean: Vec<f32>,
    /// 1 over the mean distance of the source's patches.
    scale: f32,
    /// The 99.9th percentile of a joint's speed in the source, metres a second.
    fastest: f64,
    matching_rate: f64,
}

impl Keys {
    /// How well they were met, one row a key in the order in which they were given. Source and result are at the source's
    /// own rate, features and control at the matching rate.
    pub(crate) fn met(
        &self,
        (source, result): (&Takes, &Clip),
        layout: &FeatureLayout,
        (features, columns): (&Features, &Layout),
        (control, rows): (&Mat<f32>, &Layout),
        options: &Options,
    ) -> Result<Vec<KeyRow>, AlignError> {
        if self.list.is_empty() {
            return Ok(Vec::new());
        }
        let mean = column_means(features);
        let frames = centred(features, &mean);
        let unit = sampled::unit((frames.view(), columns), options.threads)?;
        let travel_joint = layout.travel_joint();
        let finished = Finished {
            result,
            ring: if rows.is_cyclic() && result.frames() > 1 { Some(continued(result)?) } else { None },
            source: source.clip(),
            travel_joint,
            control,
            rows,
            columns,
            own: result_frames(result, layout, rows, &mean, options.matching_rate)?,
            frames,
            mean,
            scale: (1.0 / unit) as f32,
            fastest: Dynamics::of_takes(source, travel_joint).speed_q999,
            matching_rate: options.matching_rate,
        };
        Ok(self.list.iter().map(|key| finished.row(key)).collect())
    }
}

impl Finished<'_> {
    fn row(&self, key: &Resolved) -> KeyRow {
        match key {
            Resolved::Soft { pose, place, moment, .. } => {
                let (control, rows) = (self.control.view(), self.rows);
                let to_place = place.patch(rows, rows, control).distances(control, rows, 1.0);
                let to_pose = self.distances(moment);
                let nearest = least(&to_place);
                KeyRow {
                    distance: to_pose.get(nearest).map(|&distance| f64::from(distance)),
                    correlation: Some(pearson(&to_place, &to_pose)),
                    ..self.at_row("soft", pose, nearest)
                }
            }
            Resolved::Avoid { pose, moment, distance, .. } => self.nearest("avoid", pose, moment, *distance),
            Resolved::Never { pose, moment, radius } => self.nearest("never", pose, moment, *radius),
            Resolved::Hard(hard) => self.hard(hard),
            Resolved::Fixed(fixed) => {
                let rate = self.result.frame_rate();
                let (first, end) = (fixed.out.start, fixed.out.end);
                KeyRow {
                    kind: "fixed",
                    pose: format!("{:.3} s to {:.3} s", first as f64 / rate, end as f64 / rate),
                    seconds: first as f64 / rate,
                    jump: Some(self.jump(first).max(self.jump(end))),
                    ..KeyRow::default()
                }
            }
        }
    }

    /// Distances of the result's patches to a moment, in mean distances.
    fn distances(&self, moment: &Moment) -> Vec<f32> {
        let columns = self.columns;
        let patch = match moment {
            Moment::Own(_) => moment.patch(columns, columns, self.frames.view()),
            Moment::Other(passage) => {
                let last = passage.features.rows() - 1;
                let size = columns.patch();
                let frames = Mat::from_fn(size, self.mean.len(), |row, column| {
                    let row = (passage.centre + row).saturating_sub(size / 2).min(last);
                    passage.features.row(row)[column] - self.mean[column]
                });
                KeyPatch { frames, off_squared: 0.0 }
            }
        };
        patch.distances(self.own.view(), self.rows, self.scale)
    }

    /// Where the result comes nearest to a pose.
    fn nearest(&self, kind: &'static str, pose: &str, moment: &Moment, asked: f64) -> KeyRow {
        let distances = self.distances(moment);
        let row = least(&distances);
        let distance = distances.get(row).map(|&distance| f64::from(distance));
        KeyRow { distance, asked: Some(asked), ..self.at_row(kind, pose, row) }
    }

    fn at_row(&self, kind: &'static str, pose: &str, row: usize) -> KeyRow {
        let rows = self.rows;
        let seconds = ((row + rows.patch() / 2) % rows.frames().max(1)) as f64 / self.matching_rate;
        KeyRow { kind, pose: pose.to_string(), seconds, ..KeyRow::default() }
    }

    fn hard(&self, hard: &Hard) -> KeyRow {
        let (result, source) = (self.result, self.source);
        let (turned, apart) = pose_errors((result, hard.out), (source, hard.own), self.travel_joint);
        KeyRow {
            kind: "hard",
            pose: format!("frame {}", hard.given),
            seconds: hard.out as f64 / result.frame_rate(),
            rotation_error: Some(turned),
            position_error: Some(apart),
            jump: Some(self.jump(hard.out)),
            ..KeyRow::default()
        }
    }

    /// The fastest joint in the two steps before and after the border in front of a frame, over the source's fastest.
    fn jump(&self, frame: usize) -> f64 {
        let clip = self.ring.as_ref().unwrap_or(self.result);
        let around = self.steps(clip, frame);
        // In a loop the beginning comes after the end.
        let frames = self.result.frames();
        if self.ring.is_some() && frame < 2 { around.max(self.steps(clip, frame + frames)) } else { around }
    }

    fn steps(&self, clip: &Clip, frame: usize) -> f64 {
        let mut pose = Pose::new(clip.skeleton());
        let mut before: Option<Vec<Vec3>> = None;
        let mut fastest = 0.0_f64;
        for frame in frame.saturating_sub(2)..(frame + 2).min(clip.frames()) {
            pose.set(clip, frame);
            let root = pose.positions[self.travel_joint];
            let places: Vec<Vec3> = pose.positions.iter().map(|&place| place - root).collect();
            let steps = before.iter().flatten().zip(&places);
            fastest = steps.map(|(a, b)| f64::from(a.distance(*b))).fold(fastest, f64::max);
            before = Some(places);
        }
        let speed = fastest * clip.frame_rate();
        if self.fastest > 0.0 { speed / self.fastest } else { 0.0 }
    }
}

/// How far a pose of one clip is from one of another of the same skeleton, wherever it stands and is headed: the largest
/// turn by which a joint differs, radians, and the farthest that a joint is from where it is there, relative to the
/// travelling joint, metres.
///
/// # Panics
/// When a frame is not there.
pub fn pose_errors(
    (result, at): (&Clip, usize),
    (source, frame): (&Clip, usize),
    travel_joint: usize,
) -> (f64, f64) {
    let seen = |clip: &Clip, frame: usize| {
        let mut pose = Pose::new(clip.skeleton());
        pose.set(clip, frame);
        pose
    };
    let (got, wanted) = (seen(result, at), seen(source, frame));
    let root = travel_joint;
    // What turns the whole figure as it stands is heading, and no error.
    let turn = got.rotations[root] * wanted.rotations[root].inverse();
    let relative = |pose: &Pose, joint: usize| pose.positions[joint] - pose.positions[root];
    let distance = |joint: usize| f64::from(relative(&got, joint).distance(turn * relative(&wanted, joint)));
    let joints = result.skeleton().len();
    let above = result.skeleton().ancestors(root);
    let own = |joint: &usize| {
        *joint != root && !above[*joint] && result.skeleton().joints()[*joint].parent.is_some()
    };
    let pairs = result.rotations(at).iter().zip(source.rotations(frame));
    let turned = pairs.enumerate().filter(|(joint, _)| own(joint)).map(|(_, (a, b))| angle(*a, *b));
    (turned.fold(tilt(turn), f64::max), (0..joints).filter(own).map(distance).fold(0.0, f64::max))
}

fn least(values: &[f32]) -> usize {
    values.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index)
}

/// The angle between two rotations, radians; exact for small ones, where a scalar product is not.
fn angle(a: Quat, b: Quat) -> f64 {
    let (a, b) = (a.as_dquat(), b.as_dquat());
    let rest = a.inverse() * b;
    2.0 * rest.xyz().length().atan2(rest.w.abs())
}

/// By how much a rotation is no turn about the vertical, radians.
fn tilt(turn: Quat) -> f64 {
    let turn = turn.as_dquat();
    2.0 * turn.x.hypot(turn.z).atan2(turn.y.hypot(turn.w))
}
