//! A pose of the source in which it stands.

use super::figure::Figure;
use crate::Clip;
use crate::kinematics::Pose;

/// The source's pose that the target is turned to.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) pose: Pose,
    /// It is the pose in which nothing is turned.
    pub(super) at_rest: bool,
    /// Lowest of all frames' feet, metres.
    pub(super) ground: f32,
    /// Height of the figure's legs in this pose, metres.
    pub(super) height: f32,
    /// Mean length of its legs, metres.
    pub(super) leg: f32,
}

/// The pose in which nothing is turned, where that is one that the figure can stand in; else the frame that is most
/// upright with its legs straightest. Files of some programs have bones in any direction while nothing is turned.
pub(super) fn find(source: &Clip, figure: &Figure) -> Reference {
    let rest = Pose::new(source.skeleton());
    let mut lowest = f32::INFINITY;
    let (mut best, mut best_score) = (rest.clone(), figure.stands(&rest));
    let stands = best_score > 0.9;
    let mut pose = rest;
    for frame in 0..source.frames() {
        pose.set(source, frame);
        lowest = lowest.min(figure.sole(&pose));
        let own = figure.stands(&pose);
        if !stands && own > best_score {
            best_score = own;
            best = pose.clone();
        }
    }
    let (height, leg) = (figure.height(&best), figure.leg_length(&best));
    Reference { pose: best, at_rest: stands, ground: lowest, height, leg }
}
