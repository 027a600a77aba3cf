//! Two-bone inverse kinematics, closed form: the law of cosines.

use inkrig_motion::glam::{DMat3, DQuat, DVec3};

/// A solved limb of two bones.
#[derive(Debug, Clone, Copy)]
pub struct Limb {
    /// World rotation of the upper bone.
    pub upper: DQuat,
    /// World rotation of the lower bone.
    pub lower: DQuat,
    /// World direction of the upper bone, unit length.
    pub upper_along: DVec3,
    /// World direction of the lower bone, unit length.
    pub lower_along: DVec3,
    /// Distance asked for over the limb's full length: above 1 the end falls short of its target.
    pub reach: f64,
}

/// Lays two bones of the given lengths (metres) from `root` to `target` so that the joint between them points to
/// `pole` (a direction, world). A bone's rotation is the identity when it hangs along -y and `pole` is +z.
pub fn two_bone(root: DVec3, target: DVec3, lengths: (f64, f64), pole: DVec3) -> Limb {
    let (upper, lower) = lengths;
    let line = target - root;
    let reach = line.length() / (upper + lower);
    let distance = line.length().clamp((upper - lower).abs() + 1e-6, (upper + lower) * (1.0 - 1e-9));
    let axis = line.normalize_or(DVec3::NEG_Y);
    let side = (-axis).cross(pole).normalize_or(DVec3::X);
    let bend = axis.cross(side);
    let cosine = (upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let upper_along = (axis * cosine + bend * sine).normalize();
    let lower_along = ((axis * distance - upper_along * upper) / lower).normalize();
    Limb { upper: hang(upper_along, side), lower: hang(lower_along, side), upper_along, lower_along, reach }
}

/// How far `root` must sink, metres, so that `target` is no farther away than `reach`. 0 when it is near enough, and
/// when it is too far aside for sinking to help.
pub fn sink(root: DVec3, target: DVec3, reach: f64) -> f64 {
    let line = target - root;
    let height = (reach * reach - line.x * line.x - line.z * line.z).max(0.0).sqrt();
    if height > 0.0 { (-line.y - height).max(0.0) } else { 0.0 }
}

/// Draws `target` nearer to `root` so that a limb of full length `length` never snaps straight: distances above
/// `from` of the length are squeezed into the next tenth. `amount` 0..=1 is how much of this is done.
pub fn relax(root: DVec3, target: DVec3, length: f64, from: f64, amount: f64) -> DVec3 {
    const ROOM: f64 = 0.1;
    let line = target - root;
    let reach = line.length() / length;
    if reach <= from {
        return target;
    }
    let squeezed = from + ROOM * ((reach - from) / ROOM).tanh();
    root + line * (1.0 + amount * (squeezed / reach - 1.0))
}

/// The rotation that lays -y along `along` and keeps +x as near to `side` as it can.
pub fn hang(along: DVec3, side: DVec3) -> DQuat {
    let y = -along;
    let z = side.cross(y).normalize_or(DVec3::Z);
    DQuat::from_mat3(&DMat3::from_cols(y.cross(z), y, z)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_meets_the_target_and_the_knee_points_to_the_pole() {
        let root = DVec3::new(0.1, 0.9, 0.0);
        for target in [DVec3::new(0.1, 0.15, 0.25), DVec3::new(0.3, 0.4, -0.2), DVec3::new(-0.2, 0.2, 0.1)] {
            let limb = two_bone(root, target, (0.42, 0.41), DVec3::Z);
            let knee = root + limb.upper * (DVec3::NEG_Y * 0.42);
            let end = knee + limb.lower * (DVec3::NEG_Y * 0.41);
            assert!(end.distance(target) < 1e-9);
            assert!((knee - root.lerp(end, 0.5)).z > 0.0);
            assert!((limb.upper.inverse() * limb.lower).xyz().abs().x > 0.0);
            assert!((limb.upper.inverse() * limb.lower).xyz().y.abs() < 1e-9, "a hinge turns about x only");
        }
    }

    #[test]
    fn sinking_brings_the_target_into_reach() {
        let (root, target) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.3, 0.1, 0.1));
        let lower = root - DVec3::Y * sink(root, target, 0.8);
        assert!((lower.distance(target) - 0.8).abs() < 1e-12);
        assert_eq!(sink(root, target, 1.0), 0.0);
    }

    #[test]
    fn a_relaxed_limb_stays_below_its_length() {
        let far = relax(DVec3::ZERO, DVec3::new(0.0, -2.0, 0.0), 1.0, 0.85, 1.0);
        assert!(far.length() < 0.951);
        let (near, kept) = (DVec3::new(0.0, -0.8, 0.0), DVec3::new(0.0, -0.9, 0.0));
        assert_eq!(relax(DVec3::ZERO, near, 1.0, 0.85, 1.0), near);
        assert_eq!(relax(DVec3::ZERO, kept, 1.0, 0.85, 0.0), kept);
    }

    #[test]
    fn too_far_is_said() {
        let limb = two_bone(DVec3::ZERO, DVec3::new(0.0, -2.0, 0.0), (0.5, 0.5), DVec3::Z);
        assert!((limb.reach - 2.0).abs() < 1e-12 && limb.upper.angle_between(DQuat::IDENTITY) < 1e-3);
    }
}
