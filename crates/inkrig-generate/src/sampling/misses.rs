//! By how much motions miss what they are asked for.

use super::Conditions;
use crate::GenerateError;
use crate::guidance::{Places, away, between, of_pose, of_pose_back, seen_part};
use crate::networks::{Decoding, MISSED, Vae, missed, missed_back};
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH, augment};

/// Numbers of a frame's places.
const PLACES: usize = 3 * JOINTS;

/// Buffers.
#[derive(Debug, Default)]
pub(crate) struct Misses {
    decoding: Decoding,
    places: Places,
}

impl Misses {
    /// A row of [`missed`] numbers for each clean latent, as its linear path decodes it. On the picture a miss is the shortest way in space to
    /// where the camera sees no miss.
    pub(crate) fn of(
        &mut self,
        vae: &Vae,
        features: &Statistics,
        clean: &[f32],
        conditions: &[Conditions],
    ) -> Result<Vec<f32>, GenerateError> {
        let frames: Vec<usize> = conditions.iter().map(|own| own.frames).collect();
        vae.decode_quickly(clean, &frames, &mut self.decoding)?;
        let mut rest = self.decoding.features();
        let mut rows = Vec::new();
        for own in conditions {
            let (features_of, others) = rest.split_at(own.frames * WIDTH);
            rest = others;
            self.places.recover(features_of, features)?;
            let (asks, pose) = ways(own, &self.places.joints);
            rows.extend(missed(own.frames, &asks, pose.as_deref()));
        }
        Ok(rows)
    }

    /// From the gradient of the rows that [`Self::of`] gave last to that of the latents.
    pub(crate) fn backward(
        &mut self,
        vae: &Vae,
        features: &Statistics,
        conditions: &[Conditions],
        grad: &[f32],
    ) -> Result<Vec<f32>, GenerateError> {
        let (mut first, mut grads, mut of_row) = (0, Vec::new(), Vec::new());
        for (own, grad) in conditions.iter().zip(grad.chunks_exact(MISSED)) {
            let range = first..first + own.frames * WIDTH;
            first = range.end;
            self.places.recover(&self.decoding.features()[range], features)?;
            let (asks, pose) = ways(own, &self.places.joints);
            let (of_asks, of_pose) = missed_back(own.frames, &asks, pose.as_deref(), grad);
            let mut of_joints = vec![0.0; self.places.joints.len()];
            let mut add = |frame: usize, joint: usize, by: Vec3| {
                let at = frame * PLACES + 3 * joint;
                if let Some(own) = of_joints.get_mut(at..at + 3) {
                    own.iter_mut().zip(by.to_array()).for_each(|(sum, by)| *sum += f64::from(by));
                }
            };
            let view = own.target.view;
            for ((frame, joint, _), of) in asks.iter().zip(of_asks) {
                let of = Vec3::from_array(of);
                let away = own.target.depth(*frame, *joint).map_or(Vec3::ZERO, |_| away(view, of));
                add(*frame, *joint, -(seen_part(view, of) + away));
            }
            if let Some((frame, _)) = &own.pose {
                for (joint, by) in of_pose_back(view, &of_pose).into_iter().enumerate() {
                    add(*frame, joint, by);
                }
            }
            self.places.gradient(&of_joints, features, &mut of_row);
            grads.extend_from_slice(&of_row);
        }
        vae.gradient_quickly(&grads, &mut self.decoding)
    }
}

/// How far it is from each joint to where it is asked to be, metres in space; then the same of the key pose.
type Ways = (Vec<(usize, usize, [f32; 3])>, Option<Vec<f32>>);

fn ways(own: &Conditions, joints: &[f64]) -> Ways {
    let place = |frame: usize, joint: usize| {
        let at = frame * PLACES + 3 * joint;
        joints.get(at..at + 3).map(|at| Vec3::new(at[0] as f32, at[1] as f32, at[2] as f32))
    };
    let view = own.target.view;
    let asks = own.target.asks.iter().filter(|ask| ask.joint < JOINTS && ask.frame < own.frames);
    let missed_by = asks.filter_map(|ask| {
        let now = place(ask.frame, ask.joint)?;
        let depth = own.target.depth(ask.frame, ask.joint);
        let by = between(view, now, ask.place) + depth.map_or(Vec3::ZERO, |wanted| away(view, wanted - now));
        Some((ask.frame, ask.joint, by.to_array()))
    });
    let pose = own.pose.as_ref().and_then(|(frame, wanted)| {
        let mut now = [Vec3::ZERO; JOINTS];
        for (joint, now) in now.iter_mut().enumerate() {
            *now = place(*frame, joint)?;
        }
        Some(of_pose(view, &augment(&now), wanted))
    });
    (missed_by.collect(), pose)
}

#[cfg(test)]
mod tests {
    use super::super::{Request, Semantics};
    use super::*;
    use crate::guidance::{Ask, View};
    use inkrig_motion::humanml::{Camera, Joints};

    #[test]
    fn nothing_is_missed_where_everything_is_and_a_picture_asks_only_for_what_it_shows() {
        let places = Statistics::new(vec![0.0; PLACES], vec![1.0; PLACES]).unwrap();
        let at = |frame: usize, joint: usize| {
            Vec3::new(0.1 * frame as f32, 0.05 * joint as f32 + 0.3, 0.02 * (joint * frame) as f32)
        };
        let joints: Vec<f64> = (0..8)
            .flat_map(|frame| (0..JOINTS).flat_map(move |joint| at(frame, joint).to_array()))
            .map(f64::from)
            .collect();
        let camera = Camera::new(0.3, 0.5);
        for view in [View::Space, View::Plane(camera)] {
            let seen = |place: Vec3| match view {
                View::Space => place,
                View::Plane(camera) => camera.project(place).extend(0.0),
            };
            let conditions = |shift: Vec3| {
                let pose: Joints = std::array::from_fn(|joint| at(3, joint));
                let ask = |frame| Ask { frame, joint: 20, place: seen(at(frame, 20) + shift) };
                let request = Request {
                    frames: 8,
                    text: Vec::new(),
                    view,
                    trajectory: (0..8).map(ask).collect(),
                    keypose: Some((3, augment(&pose).map(|place| seen(place + shift)))),
                };
                Conditions::new(&request, &places, Semantics::Paper).unwrap()
            };
            let sizes = |row: &[f32]| row.iter().map(|x| x.abs()).fold(0.0, f32::max);
            let row_of = |shift| {
                let (asks, pose) = ways(&conditions(shift), &joints);
                let row = missed(8, &asks, pose.as_deref());
                let told: Vec<f32> = row.chunks_exact(4).map(|joint| joint[3]).collect();
                assert_eq!(told.iter().take(440).filter(|x| **x == 1.0).count(), 20);
                row
            };
            let still = row_of(Vec3::ZERO);
            let misses = |row: &[f32]| {
                sizes(&row[..1760].chunks(4).flat_map(|at| at[..3].to_vec()).collect::<Vec<_>>())
            };
            assert!(misses(&still) < 1e-5 && sizes(&still[1760..1826]) < 1e-5);
            // Sideways on the picture, and towards the camera.
            let inverse = camera.view_from_world().transpose();
            assert!((misses(&row_of(inverse * Vec3::new(0.1, 0.0, 0.0))) - 0.4).abs() < 0.15);
            let towards = misses(&row_of(inverse * Vec3::new(0.0, 0.0, 0.1)));
            assert_eq!(towards < 1e-4, view != View::Space);
        }
    }

    #[test]
    fn the_gradient_of_misses_is_a_difference() {
        use crate::networks::{Parts, Sizes};
        use crate::schedule::Noise;
        let sizes = Sizes { cosines: 4, ..Sizes::tiny() };
        let vae = Vae::new(&sizes, &crate::weights::hashed(&sizes, Parts::VAE)).unwrap();
        let features = Statistics::new(vec![0.0; WIDTH], vec![0.1; WIDTH]).unwrap();
        let places = Statistics::new(vec![0.0; PLACES], vec![1.0; PLACES]).unwrap();
        let clean = Noise::new(1).normals(sizes.width);
        for view in [View::Space, View::Plane(Camera::default())] {
            let ask = |(frame, joint)| Ask { frame, joint, place: Vec3::new(0.3, 0.4, 0.2) };
            let request = Request {
                frames: 6,
                text: Vec::new(),
                view,
                trajectory: [(0, 10), (5, 0), (5, 7)].map(ask).to_vec(),
                keypose: Some((2, std::array::from_fn(|joint| Vec3::new(0.1, 0.04 * joint as f32, 0.0)))),
            };
            let conditions = [Conditions::new(&request, &places, Semantics::Paper).unwrap()];
            let weights = Noise::new(2).normals(MISSED);
            let mut misses = Misses::default();
            let mut loss = |clean: &[f32]| {
                let row = misses.of(&vae, &features, clean, &conditions).unwrap();
                let sum = row.iter().zip(&weights).map(|(a, b)| f64::from(a * b)).sum::<f64>();
                (sum, misses.backward(&vae, &features, &conditions, &weights).unwrap())
            };
            let (_, grad) = loss(&clean);
            for number in 0..sizes.width {
                let mut moved = |by: f32| {
                    let mut clean = clean.clone();
                    clean[number] += by;
                    loss(&clean).0
                };
                let slope = (moved(1e-3) - moved(-1e-3)) / 2e-3;
                assert!(
                    (slope - f64::from(grad[number])).abs() < 0.02 * (1.0 + slope.abs()),
                    "{view:?} {number}: {slope} {}",
                    grad[number]
                );
            }
        }
    }
}
