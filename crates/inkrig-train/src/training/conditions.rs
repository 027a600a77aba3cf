//! Trajectories and key poses drawn of windows, as somebody could ask for them.

use super::latents::Window;
use super::motions::Motion;
use super::stage::network;
use crate::TrainError;
use inkrig_generate::guidance::{Ask, View};
use inkrig_generate::networks::ConditionRows;
use inkrig_generate::sampling::{Conditions, Request, Semantics};
use inkrig_generate::schedule::Noise;
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, Statistics, WIDTH, augment, recover_positions};

/// The fewest frames of a trajectory at the beginning or the end.
const FEWEST: usize = 4;

/// Shares of kinds of conditions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mixture<'a> {
    pub joints: &'a [usize],
    /// Any joint instead.
    pub any_joints: f64,
    pub trajectory_dropped: f64,
    pub keypose_dropped: f64,
    pub contiguous: f64,
    pub all_frames: f64,
}

/// What is asked of a sample, in the form that networks take, and what the sample is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub joints: Vec<Joints>,
    /// The same, frames x 66 metres.
    pub places: Vec<f32>,
    pub trajectory: ConditionRows,
    pub keypose: ConditionRows,
    /// Frames and joints of the trajectory.
    pub asked: Vec<(usize, usize)>,
    /// The frame of the key pose.
    pub frame: Option<usize>,
    /// All of it, in space.
    pub conditions: Conditions,
}

/// Draws conditions in space.
pub(super) struct Drawer<'a> {
    pub features: &'a Statistics,
    pub places: &'a Statistics,
}

impl Drawer<'_> {
    /// The joints of a window.
    pub(super) fn joints(&self, window: &Window, motions: &[Motion]) -> Result<Vec<Joints>, TrainError> {
        let mut rows = window.rows(motions).to_vec();
        self.features.restore(&mut rows);
        Features::new(rows, WIDTH)
            .and_then(|table| recover_positions(&table))
            .map_err(|error| TrainError::Device(error.to_string()))
    }

    pub(super) fn draw(
        &self,
        window: &Window,
        motions: &[Motion],
        mixture: &Mixture<'_>,
        noise: &mut Noise,
    ) -> Result<Drawn, TrainError> {
        let joints = self.joints(window, motions)?;
        let frames = joints.len();
        let [no_trajectory, no_keypose] =
            [mixture.trajectory_dropped, mixture.keypose_dropped].map(|share| noise.uniform() < share);
        // Nothing is learned of a sample without both.
        let no_keypose = no_keypose && !no_trajectory;
        let asked = if no_trajectory { Vec::new() } else { asked(frames, mixture, noise) };
        let stands_out: Vec<usize> = motions
            .get(window.motion)
            .into_iter()
            .flat_map(|motion| &motion.key_poses)
            .filter_map(|frame| frame.checked_sub(window.first).filter(|frame| *frame < frames))
            .collect();
        let keypose = keypose_frame(frames, &stands_out, noise);
        let ask = |&(frame, joint): &(usize, usize)| Ask { frame, joint, place: joints[frame][joint] };
        let request = Request {
            frames,
            text: Vec::new(),
            view: View::Space,
            trajectory: asked.iter().map(ask).collect(),
            keypose: (!no_keypose).then(|| (keypose, augment(&joints[keypose]))),
        };
        let conditions = Conditions::new(&request, self.places, Semantics::Paper).map_err(network)?;
        Ok(Drawn {
            places: joints.iter().flatten().flat_map(Vec3::to_array).collect(),
            trajectory: conditions.trajectory().to_vec(),
            keypose: conditions.keypose().into_iter().cloned().collect(),
            asked,
            frame: (!no_keypose).then_some(keypose),
            joints,
            conditions,
        })
    }
}

/// One to all of the joints, each at its own frames.
fn asked(frames: usize, mixture: &Mixture<'_>, noise: &mut Noise) -> Vec<(usize, usize)> {
    let mut joints = mixture.joints.to_vec();
    let count = 1 + below(joints.len(), noise);
    if mixture.any_joints > 0.0 && noise.uniform() < mixture.any_joints {
        joints = (0..JOINTS).collect();
    }
    let kind = noise.uniform();
    let mut asked = Vec::new();
    for place in 0..count {
        let other = place + below(joints.len() - place, noise);
        joints.swap(place, other);
        let joint = joints[place];
        let own: Vec<usize> = if kind < mixture.contiguous {
            let length = (FEWEST + below(frames.saturating_sub(FEWEST) + 1, noise)).min(frames);
            let first = if noise.uniform() < 0.5 { 0 } else { frames - length };
            (first..first + length).collect()
        } else if kind < mixture.contiguous + mixture.all_frames {
            (0..frames).collect()
        } else {
            // A number of frames, and then each frame as likely as another.
            let mut left = 1 + below(frames.saturating_sub(1).max(1), noise);
            let chosen = (0..frames).filter(|frame| {
                let take = noise.uniform() * ((frames - frame) as f64) < left as f64;
                left -= usize::from(take && left > 0);
                take
            });
            chosen.collect()
        };
        asked.extend(own.into_iter().map(|frame| (frame, joint)));
    }
    asked
}

/// The first frame, the last, one that stands out, or any.
fn keypose_frame(frames: usize, stands_out: &[usize], noise: &mut Noise) -> usize {
    let kind = noise.uniform();
    let any = below(frames, noise);
    let other = below(stands_out.len().max(1), noise);
    match kind {
        kind if kind < 0.3 => 0,
        kind if kind < 0.5 => frames - 1,
        kind if kind < 0.8 => stands_out.get(other).copied().unwrap_or(any),
        _ => any,
    }
}

fn below(count: usize, noise: &mut Noise) -> usize {
    ((noise.uniform() * count as f64) as usize).min(count.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn mixture(contiguous: f64, all_frames: f64) -> Mixture<'static> {
        let joints = &[0, 10, 11, 15, 20, 21];
        Mixture {
            joints,
            any_joints: 0.0,
            trajectory_dropped: 0.3,
            keypose_dropped: 0.3,
            contiguous,
            all_frames,
        }
    }

    #[test]
    fn trajectories_are_of_their_kind() {
        let mut noise = Noise::new(1);
        let by_joint = |asked: &[(usize, usize)]| {
            let joints: BTreeSet<usize> = asked.iter().map(|(_, joint)| *joint).collect();
            let frames = |joint| -> Vec<usize> {
                asked.iter().filter(|own| own.1 == joint).map(|own| own.0).collect()
            };
            joints.into_iter().map(|joint| (joint, frames(joint))).collect::<Vec<_>>()
        };
        let mut counts = BTreeSet::new();
        for _ in 0..300 {
            let whole = by_joint(&asked(20, &mixture(0.0, 1.0), &mut noise));
            assert!(whole.iter().all(|(_, frames)| frames.len() == 20));
            counts.insert(whole.len());
            for (_, frames) in by_joint(&asked(20, &mixture(1.0, 0.0), &mut noise)) {
                assert!(frames.len() >= FEWEST && frames.windows(2).all(|pair| pair[1] == pair[0] + 1));
                assert!(frames[0] == 0 || frames[frames.len() - 1] == 19);
            }
            for (_, frames) in by_joint(&asked(20, &mixture(0.0, 0.0), &mut noise)) {
                assert!((1..20).contains(&frames.len()), "{frames:?}");
                assert!(frames.windows(2).all(|pair| pair[1] > pair[0]));
            }
        }
        assert_eq!(counts.into_iter().collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6]);
        let frames: BTreeSet<usize> = (0..500).map(|_| keypose_frame(10, &[4], &mut noise)).collect();
        assert_eq!(frames.len(), 10);
    }

    #[test]
    fn every_subset_of_conditions_is_drawn_and_none_without_any() {
        let rows: Vec<f32> = Noise::new(2).normals(30 * WIDTH).iter().map(|x| 0.1 * x).collect();
        let motions = [Motion { rows, verbs: vec![0], key_poses: vec![7], weight: 1.0 }];
        let window = Window { motion: 0, first: 5, frames: 20 };
        let features = Statistics::new(vec![0.0; WIDTH], vec![1.0; WIDTH]).unwrap();
        let places = Statistics::new(vec![0.0; 66], vec![1.0; 66]).unwrap();
        let drawer = Drawer { features: &features, places: &places };
        let mut kinds = BTreeSet::new();
        let mut noise = Noise::new(3);
        for _ in 0..200 {
            let drawn = drawer.draw(&window, &motions, &mixture(0.4, 0.3), &mut noise).unwrap();
            kinds.insert((drawn.trajectory.is_empty(), drawn.keypose.is_empty()));
            assert_eq!(drawn.places.len(), 20 * 66);
            assert_eq!(drawn.trajectory.is_empty(), drawn.asked.is_empty());
            for &(frame, joint) in &drawn.asked {
                let row = &drawn.trajectory.iter().find(|(own, _)| *own == frame).unwrap().1;
                assert_eq!(row[3 * joint..][..3], drawn.places[66 * frame + 3 * joint..][..3]);
            }
        }
        assert_eq!(kinds.into_iter().collect::<Vec<_>>(), [(false, false), (false, true), (true, false)]);
    }
}
