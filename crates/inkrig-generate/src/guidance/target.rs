//! What a clip shall meet: places of joints at frames, in space or on the picture.

use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Camera, JOINTS};

/// Where joints shall be.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// In space, or as seen by a camera.
    pub view: View,
    /// Places of joints, in any order. Frames beyond the clip do not count.
    pub asks: Vec<Ask>,
    /// On the picture: where in the world joints shall be, of which only how far away that is counts. A picture alone does not say whether what
    /// comes down on it comes near.
    pub depths: Vec<Ask>,
}

/// How a target is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// Places in the world.
    Space,
    /// Places on the picture; z is of no consequence.
    Plane(Camera),
}

/// One joint at one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ask {
    /// Frame of the clip.
    pub frame: usize,
    /// Joint, 0 to 21; others do not count.
    pub joint: usize,
    /// Metres: x, y, z in the world, or x to the right and y up on the picture.
    pub place: Vec3,
}

/// What squared distances are divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mean {
    /// All numbers of all joints and frames, asked for or not, as in the published code.
    AllEntries,
    /// What is asked for, as in the paper.
    Asked,
}

impl View {
    fn axes(&self) -> usize {
        match self {
            Self::Space => 3,
            Self::Plane(_) => 2,
        }
    }
}

impl Target {
    /// Where in the world a joint shall be, as far as its distance goes.
    pub(crate) fn depth(&self, frame: usize, joint: usize) -> Option<Vec3> {
        self.depths.iter().find(|ask| (ask.frame, ask.joint) == (frame, joint)).map(|ask| ask.place)
    }

    /// Asks that a clip of that many frames can meet.
    fn met_by(&self, frames: usize) -> impl Iterator<Item = &Ask> {
        self.asks.iter().filter(move |ask| ask.frame < frames && ask.joint < JOINTS)
    }

    /// What [`Mean`] divides by, for this clip.
    pub(crate) fn entries(&self, frames: usize, mean: Mean) -> usize {
        match mean {
            Mean::AllEntries => frames * JOINTS * self.view.axes(),
            Mean::Asked => self.met_by(frames).count(),
        }
    }

    /// The sum over asks of squared distances, or of distances; gradients of it times `weight` replace what is in
    /// `gradient`, frames x 66 numbers as `joints` has.
    pub(crate) fn distance(
        &self,
        joints: &[f64],
        squared: bool,
        weight: f64,
        gradient: &mut Vec<f64>,
    ) -> f64 {
        gradient.clear();
        gradient.resize(joints.len(), 0.0);
        let mut sum = 0.0;
        for ask in self.met_by(joints.len() / (3 * JOINTS)) {
            let at = 3 * (ask.frame * JOINTS + ask.joint);
            let place = [0, 1, 2].map(|axis| joints[at + axis]);
            let wanted = ask.place.as_dvec3().to_array();
            let off = match &self.view {
                View::Space => [0, 1, 2].map(|axis| place[axis] - wanted[axis]),
                View::Plane(camera) => {
                    let rows = rows(camera);
                    let seen =
                        |axis: usize| (0..3).map(|k| rows[axis][k] * place[k]).sum::<f64>() - wanted[axis];
                    let off = [seen(0), seen(1)];
                    let square = off[0] * off[0] + off[1] * off[1];
                    let factor = weight * if squared { 2.0 } else { 1.0 / square.sqrt().max(1e-9) };
                    for axis in 0..3 {
                        gradient[at + axis] += factor * (rows[0][axis] * off[0] + rows[1][axis] * off[1]);
                    }
                    sum += if squared { square } else { square.sqrt() };
                    continue;
                }
            };
            let square: f64 = off.iter().map(|off| off * off).sum();
            let factor = weight * if squared { 2.0 } else { 1.0 / square.sqrt().max(1e-9) };
            for axis in 0..3 {
                gradient[at + axis] += factor * off[axis];
            }
            sum += if squared { square } else { square.sqrt() };
        }
        sum + self.away(joints, squared, weight, gradient)
    }

    /// The same of how far away joints are; adds to the gradient.
    fn away(&self, joints: &[f64], squared: bool, weight: f64, gradient: &mut [f64]) -> f64 {
        let View::Plane(camera) = &self.view else { return 0.0 };
        let axis = camera.view_from_world().row(2).as_dvec3().to_array();
        let frames = joints.len() / (3 * JOINTS);
        let mut sum = 0.0;
        for ask in self.depths.iter().filter(|ask| ask.frame < frames && ask.joint < JOINTS) {
            let at = 3 * (ask.frame * JOINTS + ask.joint);
            let wanted = ask.place.as_dvec3().to_array();
            let off: f64 = (0..3).map(|k| axis[k] * (joints[at + k] - wanted[k])).sum();
            let factor = weight * if squared { 2.0 * off } else { off.signum() };
            (0..3).for_each(|k| gradient[at + k] += factor * axis[k]);
            sum += if squared { off * off } else { off.abs() };
        }
        sum
    }

    /// Frames at which the joint that is asked for most often is asked for.
    pub(crate) fn densest(&self, frames: usize) -> usize {
        let mut counts = [0; JOINTS];
        for ask in self.met_by(frames) {
            counts[ask.joint] += 1;
        }
        counts.into_iter().max().unwrap_or(0)
    }
}

/// The picture's two axes in the world.
fn rows(camera: &Camera) -> [[f64; 3]; 2] {
    let view = camera.view_from_world();
    [view.row(0).as_dvec3().to_array(), view.row(1).as_dvec3().to_array()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_that_of_the_distance_in_space_on_the_picture_and_away_from_it() {
        let ask = |frame, joint, x| Ask { frame, joint, place: Vec3::new(x, 0.4, -0.3) };
        let joints: Vec<f64> = (0..3 * 3 * JOINTS).map(|i| (i as f64 * 0.7).sin()).collect();
        let camera = Camera::new(0.35, 0.5);
        let depths = vec![ask(1, 0, 0.9), ask(2, 20, 0.1), ask(7, 0, 0.0)];
        for (view, depths) in
            [(View::Space, Vec::new()), (View::Plane(camera), Vec::new()), (View::Plane(camera), depths)]
        {
            let target = Target { view, asks: vec![ask(0, 10, 0.2), ask(1, 0, 0.5)], depths };
            for squared in [true, false] {
                let mut gradient = Vec::new();
                target.distance(&joints, squared, 0.5, &mut gradient);
                let value = |joints: &[f64]| 0.5 * target.distance(joints, squared, 0.5, &mut Vec::new());
                for place in 0..joints.len() {
                    let moved = |by: f64| {
                        let mut joints = joints.clone();
                        joints[place] += by;
                        value(&joints)
                    };
                    let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                    assert!(
                        (slope - gradient[place]).abs() < 1e-6,
                        "{view:?} {place}: {slope} {}",
                        gradient[place]
                    );
                }
            }
        }
    }
}
