//! Two-bone inverse kinematics: a limb of two bones whose end goes to a place.

use glam::Vec3;

/// Where the middle and the end of a limb come to stand when its end is to go to `goal`: both bones keep their lengths and
/// the middle the side to which `pole`, a direction from the first joint, points. The limb is never longer than the share
/// `reach` of its length, so a goal that is too far away is met in direction only. `None` where the goal is the limb's
/// beginning, the pole points along the limb, or a bone has no length.
pub(crate) fn two_bone(
    [first, middle, end]: [Vec3; 3],
    goal: Vec3,
    reach: f32,
    pole: Vec3,
) -> Option<[Vec3; 2]> {
    let (upper, lower) = (middle.distance(first), end.distance(middle));
    let way = goal - first;
    let most = reach * (upper + lower);
    let distance = way.length().clamp(((upper - lower).abs() + 1e-4).min(most), most);
    let along = way.try_normalize().filter(|_| upper * distance > 0.0)?;
    let outwards = pole.reject_from_normalized(along).try_normalize()?;
    let cos =
        ((upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance)).clamp(-1.0, 1.0);
    let new_middle = first + upper * (cos * along + (1.0 - cos * cos).sqrt() * outwards);
    Some([new_middle, first + distance * along])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bones_keep_their_lengths_and_the_knee_its_side() {
        let leg = [Vec3::Y, Vec3::new(0.0, 0.55, 0.1), Vec3::new(0.0, 0.1, 0.0)];
        for goal in [Vec3::new(0.3, 0.3, 0.2), Vec3::new(0.0, 0.2, -0.1), Vec3::new(0.0, -3.0, 0.0)] {
            let [knee, ankle] = two_bone(leg, goal, 0.999, leg[1] - leg[0]).unwrap();
            assert!((knee.distance(leg[0]) - leg[1].distance(leg[0])).abs() < 1e-6);
            assert!((ankle.distance(knee) - leg[2].distance(leg[1])).abs() < 1e-6);
            assert!((ankle - leg[0]).angle_between(goal - leg[0]) < 1e-3);
            let side = (knee - leg[0]).reject_from(goal - leg[0]);
            assert!(side.dot(leg[1] - leg[0]) > 0.0, "{side}");
        }
        assert_eq!(two_bone(leg, leg[0], 0.999, Vec3::Z), None);
        assert_eq!(two_bone([Vec3::Y; 3], leg[0], 0.999, Vec3::Z), None);
        assert_eq!(two_bone(leg, leg[0] - 0.5 * Vec3::Y, 0.999, Vec3::Y), None);
    }
}
