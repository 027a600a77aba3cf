//! Motions where features expect them: the first pose above the origin, facing +z; and back to where they were.

use super::joining::heading;
use crate::GenerateError;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{Joints, Statistics, WIDTH, features, recover_positions};
use inkrig_motion::{Features, MotionError};

/// Where a motion began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Origin {
    turn: Quat,
    place: Vec3,
}

impl Origin {
    /// That of a motion that begins with `pose`.
    pub(crate) fn of(pose: &Joints) -> Self {
        Self { turn: Quat::from_rotation_y(heading(pose)), place: Vec3::new(pose[0].x, 0.0, pose[0].z) }
    }

    /// From the world to a motion that begins above the origin, facing +z.
    pub(crate) fn local(&self, motion: &[Joints]) -> Vec<Joints> {
        let back = self.turn.inverse();
        motion.iter().map(|pose| pose.map(|place| back * (place - self.place))).collect()
    }

    /// Back to the world.
    pub(crate) fn world(&self, motion: &[Joints]) -> Vec<Joints> {
        motion.iter().map(|pose| pose.map(|place| self.turn * place + self.place)).collect()
    }
}

/// Normalised rows of features of a motion at the origin: one less than it has frames.
pub(crate) fn normalised(motion: &[Joints], statistics: &Statistics) -> Result<Vec<f32>, GenerateError> {
    if statistics.mean().len() != WIDTH {
        let (what, got) = ("statistics of features", statistics.mean().len());
        return Err(GenerateError::Length { what, expected: WIDTH, got });
    }
    let mut rows = features(motion)?.as_slice().to_vec();
    statistics.normalise(&mut rows);
    Ok(rows)
}

/// The joints that normalised rows stand for.
pub(crate) fn joints(mut rows: Vec<f32>, statistics: &Statistics) -> Result<Vec<Joints>, MotionError> {
    statistics.restore(&mut rows);
    recover_positions(&Features::new(rows, WIDTH)?)
}
