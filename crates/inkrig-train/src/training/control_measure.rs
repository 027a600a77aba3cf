//! How well conditions are met by samples of held-out windows.

use super::conditions::Drawer;
use super::control::Base;
use super::latents::{Cut, windows};
use super::motions::Motion;
use super::stage::network;
use crate::TrainError;
use inkrig_generate::guidance::{Ask, View};
use inkrig_generate::measures::{control_errors, pose_error, pose_error_2d};
use inkrig_generate::networks::Decoding;
use inkrig_generate::sampling::{Conditions, Networks, Request, Sampler, SamplingOptions, Semantics, Steps};
use inkrig_generate::text::TextEncoder as _;
use inkrig_generate::weights::Tensors;
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, WIDTH, augment, recover_positions};

/// One joint a window, in turn: the paper's "Average".
const ASKED: [usize; 6] = [0, 10, 11, 15, 20, 21];
/// Steps of sampling: few, for a figure that falls along the way, not for a table.
const STEPS: usize = 10;

/// Held-out windows with one joint at all frames, and a key pose.
pub(super) struct HeldOut {
    conditions: Vec<Conditions>,
    clips: Vec<Vec<Joints>>,
    asked: Vec<usize>,
    keyposes: Vec<usize>,
    no_text: Vec<f32>,
    view: View,
}

impl HeldOut {
    pub(super) fn new(
        motions: &[Motion],
        frames: usize,
        most: usize,
        base: &Base,
        view: View,
    ) -> Result<Self, TrainError> {
        let cut = Cut { frames, stride: frames, other_lengths: 0.0, shortest: frames, longest: frames };
        let mut all = windows(motions, cut, 0);
        all.retain(|window| window.frames == frames);
        let every = all.len().div_ceil(most.max(1)).max(1);
        let drawer = Drawer { features: &base.features, places: &base.places };
        let no_text = base.verbs.encode("").map_err(network)?;
        let mut held_out = Self {
            conditions: Vec::new(),
            clips: Vec::new(),
            asked: Vec::new(),
            keyposes: Vec::new(),
            no_text,
            view,
        };
        for (at, window) in all.iter().step_by(every).enumerate() {
            let clip = drawer.joints(window, motions)?;
            let motion = motions.get(window.motion);
            let stands_out = motion.into_iter().flat_map(|motion| &motion.key_poses);
            let mut own = stands_out.filter_map(|frame| frame.checked_sub(window.first));
            let keypose = own.find(|frame| *frame < clip.len()).unwrap_or(0);
            let joint = ASKED[at % ASKED.len()];
            let verb = motion.and_then(|motion| motion.verbs.first()).copied();
            let seen = |place: Vec3| match view {
                View::Space => place,
                View::Plane(camera) => camera.project(place).extend(0.0),
            };
            let ask = |(frame, joints): (usize, &Joints)| Ask { frame, joint, place: seen(joints[joint]) };
            let request = Request {
                frames: clip.len(),
                text: base.verbs.row(verb).to_vec(),
                view,
                trajectory: clip.iter().enumerate().map(ask).collect(),
                keypose: Some((keypose, augment(&clip[keypose]).map(seen))),
            };
            let conditions = Conditions::new(&request, &base.places, Semantics::Paper);
            held_out.conditions.push(conditions.map_err(network)?);
            held_out.clips.push(clip);
            held_out.asked.push(joint);
            held_out.keyposes.push(keypose);
        }
        if held_out.clips.is_empty() {
            return Err(TrainError::Device("no held-out clip is as long as a window".into()));
        }
        Ok(held_out)
    }
}

/// MPJPE at the key pose, Avg. Err of the trajectory, and first the sum of both, metres: as the conditions are, in space or on the
/// picture.
pub(super) fn measure(
    base: &Base,
    weights: &Tensors,
    held_out: &HeldOut,
) -> Result<Vec<(&'static str, f64)>, TrainError> {
    let sizes = &base.header.sizes;
    let networks = Networks::new(sizes, weights).map_err(network)?;
    let sampler = Sampler { networks: &networks, features: &base.features, no_text: &held_out.no_text };
    let steps = if sizes.guidance_width > 0 { Steps::Lcm(4) } else { Steps::Ddim(STEPS) };
    let usual = SamplingOptions::default();
    let text_weight = base.header.text_weight.unwrap_or(usual.text_weight);
    let options = SamplingOptions { steps, text_weight, guidance: None, ..usual };
    let sampled = sampler.sample(&held_out.conditions, &options, 0).map_err(network)?;
    let frames: Vec<usize> = held_out.clips.iter().map(Vec::len).collect();
    let mut decoding = Decoding::default();
    networks.vae.decode(&sampled.latents, &frames, &mut decoding).map_err(network)?;
    let mut rows = decoding.features();
    let (mut pose, mut path, mut flat) = (0.0, 0.0, [0.0; 2]);
    for (at, clip) in held_out.clips.iter().enumerate() {
        let (own, rest) = rows.split_at(clip.len() * WIDTH);
        rows = rest;
        let mut own = own.to_vec();
        base.features.restore(&mut own);
        let made = Features::new(own, WIDTH).and_then(|table| recover_positions(&table));
        let made = made.map_err(|error| TrainError::Device(error.to_string()))?;
        let (keypose, joint) = (held_out.keyposes[at], held_out.asked[at]);
        pose += pose_error(&made[keypose], &clip[keypose]);
        let asked: Vec<[Option<Vec3>; JOINTS]> = clip
            .iter()
            .map(|joints| std::array::from_fn(|other| (other == joint).then(|| joints[joint])))
            .collect();
        path += control_errors(&made, &asked).map_err(network)?.mean;
        if let View::Plane(camera) = held_out.view {
            let seen = |place: Vec3| camera.project(place).extend(0.0);
            flat[0] += pose_error_2d(&made[keypose], &clip[keypose], &camera);
            let made: Vec<Joints> = made.iter().map(|joints| joints.map(seen)).collect();
            let asked: Vec<_> = asked.iter().map(|row| row.map(|place| place.map(seen))).collect();
            flat[1] += control_errors(&made, &asked).map_err(network)?.mean;
        }
    }
    let count = held_out.clips.len() as f64;
    let (pose, path) = (pose / count, path / count);
    if let View::Plane(_) = held_out.view {
        let [flat_pose, flat_path] = flat.map(|sum| sum / count);
        return Ok(vec![
            ("held_out_error", flat_pose + flat_path),
            ("held_out_mpjpe_2d", flat_pose),
            ("held_out_avg_err_2d", flat_path),
            ("held_out_mpjpe_3d", pose),
            ("held_out_avg_err_3d", path),
        ]);
    }
    Ok(vec![("held_out_error", pose + path), ("held_out_mpjpe_3d", pose), ("held_out_avg_err_3d", path)])
}
