//! Rotations as three angles that run on.

use super::fit::Numbers;
use glam::{DQuat, EulerRot};
use std::f64::consts::{PI, TAU};

/// The rotation of three angles: about x first, then y, then z, axes that stay where they are.
pub(super) fn rotation([x, y, z, _]: Numbers) -> DQuat {
    DQuat::from_euler(EulerRot::ZYX, z, y, x)
}

/// The angles of a rotation that lie nearest to others, radians; the fourth number is 0.
pub(super) fn near(rotation: DQuat, before: Numbers) -> Numbers {
    let (z, y, x) = rotation.to_euler(EulerRot::ZYX);
    let run_on = |angle: f64, before: f64| angle + TAU * ((before - angle) / TAU).round();
    // Upright, x and z turn about the same axis; x stays as it was.
    if y.sin().abs() > 1.0 - 1e-9 {
        let z = if y > 0.0 { before[0] - (x - z) } else { (x + z) - before[0] };
        return [before[0], run_on(y, before[1]), run_on(z, before[2]), 0.0];
    }
    let both = [[x, y, z], [x + PI, PI - y, z + PI]];
    let both = both.map(|[x, y, z]| [run_on(x, before[0]), run_on(y, before[1]), run_on(z, before[2]), 0.0]);
    let way = |angles: &Numbers| angles.iter().zip(&before).map(|(a, b)| (a - b).abs()).sum::<f64>();
    let [one, other] = both;
    if way(&other) < way(&one) { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_run_on_through_turns_and_past_the_upright() {
        let mut before = [0.0; 4];
        for step in 0..400 {
            let t = f64::from(step) * 0.05;
            let turned = DQuat::from_rotation_z(t) * DQuat::from_rotation_y(1.9 * (0.7 * t).sin());
            let now = near(turned, before);
            assert!(rotation(now).angle_between(turned) < 1e-6, "{step}");
            assert!((0..3).all(|i| (now[i] - before[i]).abs() < 0.2), "{step}: {before:?} {now:?}");
            before = now;
        }
        assert!(before[2] > 15.0);
        let upright =
            near(DQuat::from_rotation_y(0.5 * PI) * DQuat::from_rotation_x(0.3), [0.1, 1.5, 0.0, 0.0]);
        assert!(
            rotation(upright).angle_between(DQuat::from_rotation_y(0.5 * PI) * DQuat::from_rotation_x(0.3))
                < 1e-6
        );
        assert_eq!(upright[0], 0.1);
    }
}
