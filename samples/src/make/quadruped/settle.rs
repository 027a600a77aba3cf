//! Trunk and legs come to terms: standing legs pull the trunk down to where they reach, swinging legs go with it.

use super::{
    super::{
        ease::{gaussian, lowest},
        figure::{Pose, Rig},
    },
    Trunk,
    hound::{self, TRUNK},
    swing,
};
use inkrig_motion::glam::DVec3;

impl Trunk {
    /// Lays the paws of all frames, seen from where the trunk is now.
    fn place_paws(&mut self, rig: &Rig) {
        let bodies: Vec<Pose<'_>> = (0..self.frames()).map(|frame| self.body(rig, frame)).collect();
        self.paws = [0, 1, 2, 3].map(|leg| {
            let carriers: Vec<DVec3> = bodies.iter().map(|body| hound::carrier(body, leg)).collect();
            self.times
                .iter()
                .map(|&time| swing::paw(&self.plants[leg], &carriers, hound::RELAXED[leg / 2], time))
                .collect()
        });
    }

    /// Lowers hips and shoulders where a leg would have to be stretched, and lays the paws.
    pub(super) fn settle(&mut self, rig: &Rig) {
        const ROUNDS: usize = 3;
        self.place_paws(rig);
        for _ in 0..ROUNDS {
            let needed: Vec<[f64; 2]> = (0..self.frames())
                .map(|frame| {
                    let mut pose = self.pose(rig, frame);
                    let sink = [0, 1, 2, 3].map(|leg: usize| {
                        let paw = &self.paws[leg][frame];
                        let sink = hound::leg(&mut pose, leg, paw, self.bow[frame]);
                        // In the air it is the leg that gives way.
                        if paw.stands { -sink } else { 0.0 }
                    });
                    [sink[0].min(sink[1]), sink[2].min(sink[3])]
                })
                .collect();
            let smooth = |end: usize| {
                let values: Vec<f64> = needed.iter().map(|needed| needed[end]).collect();
                gaussian(&lowest(&values, 3), 1.8)
            };
            let (hind, fore) = (smooth(0), smooth(1));
            for frame in 0..self.frames() {
                self.hips[frame].y += hind[frame];
                self.pitch[frame] += (hind[frame] - fore[frame]) / TRUNK;
            }
            self.place_paws(rig);
        }
    }
}
