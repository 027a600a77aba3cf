//! Arms and legs of the person: arms by angles, legs from the hips to where the feet are.

use super::{
    super::{
        figure::{Pose, ahead, turn},
        limb_ik::two_bone,
    },
    Body, SHANK, SIDES, THIGH,
    acting::Arm,
};
use inkrig_motion::glam::DQuat;
use std::f64::consts::FRAC_PI_2;

impl Body {
    /// Hangs an arm from the chest: the walking swing, or what is acted instead.
    pub(super) fn arm(&self, pose: &mut Pose<'_>, side: usize, frame: usize) {
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let (keep, acted) = self.acting[frame].arms[side];
        let swing = -sign * 0.62 * self.lead_late[frame];
        let speed = self.speed[frame].min(1.6);
        let front = 0.5 * (swing + (swing * swing + 0.01).sqrt());
        let idle = Arm {
            flex: 0.07 + swing + 0.05 * front,
            abduct: 0.17 + 0.02 * speed - 0.9 * self.bounce[frame],
            twist: -0.12 - 0.1 * front,
            elbow: 0.17 + 0.1 * speed + 0.5 * front - 1.2 * self.bounce[frame],
            pronate: 0.25,
            wrist: [0.0, 0.12 - 0.15 * swing],
        };
        let arm = idle.mix(acted, 1.0 - keep);
        let hang = DQuat::from_rotation_z(-sign * FRAC_PI_2);
        let raised = 0.5 * (arm.abduct - 0.7 + ((arm.abduct - 0.7).powi(2) + 0.05).sqrt());
        let shoulder = turn(-0.12 * sign * arm.flex, 0.0, sign * (0.3 * raised - 0.03));
        let upper = DQuat::from_rotation_z(sign * (arm.abduct - 0.3 * raised))
            * DQuat::from_rotation_x(-arm.flex)
            * DQuat::from_rotation_y(sign * arm.twist);
        let lower = DQuat::from_rotation_x(-arm.elbow) * DQuat::from_rotation_y(-sign * arm.pronate);
        let hand = DQuat::from_rotation_x(-arm.wrist[0]) * DQuat::from_rotation_z(-sign * arm.wrist[1]);
        let parts = [
            ("Shoulder", shoulder),
            ("Arm", upper * hang),
            ("ForeArm", hang.inverse() * lower * hang),
            ("Hand", hang.inverse() * hand * hang),
        ];
        for (part, rotation) in parts {
            if let Some(joint) = find(pose, side, part) {
                pose.local[joint] = rotation.normalize();
            }
        }
    }

    /// Lays a leg from the hips to the foot.
    pub(super) fn leg(&self, pose: &mut Pose<'_>, side: usize, frame: usize) {
        let names = ["UpLeg", "Leg", "Foot", "Toe"].map(|part| find(pose, side, part));
        let [Some(thigh), Some(shank), Some(foot), Some(toe)] = names else { return };
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let stand = &self.feet[side][frame];
        // Knees point between hips and toes, and outward in a crouch.
        let outward = 0.03 + 0.9 * self.acting[frame].crouch.max(0.0);
        let yaw = 0.5 * (stand.yaw + self.heading[frame]) + sign * outward;
        let limb = two_bone(pose.world(thigh).0, stand.ankle, (THIGH, SHANK), ahead(yaw));
        pose.set_world(thigh, limb.upper);
        pose.set_world(shank, limb.lower);
        pose.set_world(foot, stand.rotation);
        pose.local[toe] = DQuat::from_rotation_x(stand.toe);
    }
}

/// The joint of a side, by its part of the name.
pub(super) fn find(pose: &Pose<'_>, side: usize, part: &str) -> Option<usize> {
    pose.rig().find(&format!("{}{part}", SIDES[side]))
}
