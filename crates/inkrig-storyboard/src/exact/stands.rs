//! Which feet stand while a motion is moved.

use super::asked::{Asked, Goal};
use super::body::Places;
use super::costs::FEET;

/// What stands goes less than this from frame to frame, metres.
const STILL: f64 = 0.006;
/// A foot that is put higher or lower by more than this does not stand there, metres.
const LIFTED: f32 = 0.03;
/// Nor so many frames before and after.
const LIFT: usize = 6;

/// A joint of a foot that stands until the next frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stand {
    pub(super) frame: usize,
    pub(super) joint: usize,
    /// Whether it stands at another place than before.
    pub(super) elsewhere: bool,
}

/// Feet that stand in a motion, and go on doing so. A foot that is led along a way does not; one that is put elsewhere stands there.
pub(super) fn stands(places: &[Places], standing: &[[bool; 2]], asked: &Asked<'_>) -> Vec<Stand> {
    let mut stands = Vec::new();
    for (side, foot) in FEET.into_iter().enumerate() {
        let led =
            |frame: usize| asked.goals.iter().any(|goal| goal.frame == frame && foot.contains(&goal.joint));
        let held = |frame: usize| foot.iter().any(|joint| asked.on_something(frame, *joint));
        let edits: Vec<&Goal> = asked.edits().filter(|goal| foot.contains(&goal.joint)).collect();
        let lifted = |frame: usize| {
            edits.iter().filter(|goal| frame.abs_diff(goal.frame) <= LIFT).any(|goal| {
                let before = places.get(goal.frame).map(|pose| pose[goal.joint].as_vec3());
                before.is_some_and(|place| (goal.nearest(place) - place).y.abs() > LIFTED)
            })
        };
        let still = |frame: usize| {
            let stood = |frame: usize| standing.get(frame).is_some_and(|stands| stands[side]);
            stood(frame) && stood(frame + 1)
        };
        let mut frame = 0;
        while frame + 1 < places.len() {
            // A stance as a whole.
            let first = frame;
            while frame + 1 < places.len() && still(frame) {
                frame += 1;
            }
            let put = edits.iter().any(|goal| (first..=frame).contains(&goal.frame));
            for at in first..frame {
                if (led(at) && led(at + 1)) || lifted(at) || held(at) != held(at + 1) {
                    continue;
                }
                for joint in foot {
                    if places[at][joint].distance(places[at + 1][joint]) < STILL {
                        stands.push(Stand { frame: at, joint, elsewhere: put || held(at) });
                    }
                }
            }
            frame += 1;
        }
    }
    stands.sort_by_key(|stand| stand.frame);
    stands
}
