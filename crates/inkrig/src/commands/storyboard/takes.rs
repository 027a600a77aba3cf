//! Clips that were made already, so that whoever changes one frame waits for that one only.

use inkrig_storyboard::{Generated, MakerOptions, Plan};
use std::collections::VecDeque;
use std::sync::Arc;

/// Orders whose clips are kept at most.
const MOST: usize = 1000;
/// Frames of all kept clips together: one holds 22 joints, so these are about 60 MB.
const MOST_FRAMES: usize = 200_000;

/// Everything that the clips of a frame depend on, besides the model.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::commands) struct Order {
    /// What is drawn.
    pub(super) plan: Plan,
    /// The word's vector.
    pub(super) text: Vec<f32>,
    /// How they are sampled.
    pub(super) options: MakerOptions,
    /// The number that they are sampled with.
    pub(super) number: usize,
}

/// Clips of the newest orders, each order's best first. For one model.
#[derive(Debug, Default)]
pub(in crate::commands) struct Takes {
    kept: VecDeque<(Order, Arc<[Generated]>)>,
    frames: usize,
}

impl Takes {
    /// The clips of an order, if they are kept: exactly those that it would give again.
    pub(super) fn of(&mut self, order: &Order) -> Option<Arc<[Generated]>> {
        let at = self.kept.iter().position(|(other, _)| other == order)?;
        let found = self.kept.remove(at)?;
        let clips = found.1.clone();
        // What was used last is forgotten last.
        self.kept.push_back(found);
        Some(clips)
    }

    pub(super) fn keep(&mut self, order: Order, clips: Vec<Generated>) -> Arc<[Generated]> {
        let clips: Arc<[Generated]> = clips.into();
        self.frames += frames(&clips);
        self.kept.push_back((order, clips.clone()));
        while self.kept.len() > MOST || (self.frames > MOST_FRAMES && self.kept.len() > 1) {
            let Some((_, gone)) = self.kept.pop_front() else { break };
            self.frames -= frames(&gone);
        }
        clips
    }
}

fn frames(clips: &[Generated]) -> usize {
    clips.iter().map(|clip| clip.motion.len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_generate::sampling::SamplingOptions;
    use inkrig_motion::glam::Vec3;
    use inkrig_motion::humanml::{Camera, JOINTS};

    fn order(number: usize, frames: usize) -> (Order, Vec<Generated>) {
        let plan = Plan::of_word("kick".into(), frames, Camera::default());
        let options =
            MakerOptions { sampling: SamplingOptions::default(), drawn: true, candidates: 1, seed: 0 };
        let clip = Generated {
            motion: vec![[Vec3::ZERO; JOINTS]; frames],
            contacts: Vec::new(),
            plan: plan.clone(),
            error: 0.0,
            worst: 0.0,
            candidate: 0,
            evaluations: 0,
        };
        (Order { plan, text: vec![1.0], options, number }, vec![clip])
    }

    /// Whether they are kept.
    fn has(takes: &Takes, order: &Order) -> bool {
        takes.kept.iter().any(|(other, _)| other == order)
    }

    #[test]
    fn what_was_not_used_for_longest_is_forgotten() {
        let mut takes = Takes::default();
        let long = MOST_FRAMES / 3;
        let orders: Vec<Order> = (0..3)
            .map(|number| {
                let (order, clips) = order(number, long);
                takes.keep(order.clone(), clips);
                order
            })
            .collect();
        assert!(orders.iter().all(|order| has(&takes, order)));
        assert!(takes.of(&orders[0]).is_some(), "it is used again");
        let (another, clips) = order(3, long);
        takes.keep(another.clone(), clips);
        let now: Vec<bool> = orders.iter().chain([&another]).map(|order| has(&takes, order)).collect();
        assert_eq!(now, [true, false, true, true]);
        let moved = Order { plan: Plan { frames: 3, ..orders[0].plan.clone() }, ..orders[0].clone() };
        assert!(!has(&takes, &moved), "another plan is another order");
        assert!(takes.of(&Order { text: vec![2.0], ..orders[0].clone() }).is_none());
    }
}
