//! Rotations from directions: the shortest between two, the best for several.

use glam::{DMat3, DQuat, DVec3};

/// The shortest rotation from one direction to another. A half turn goes about y, or about x for vertical ones.
pub(crate) fn between(from: DVec3, to: DVec3) -> DQuat {
    let axis = from.cross(to);
    let w = (from.length_squared() * to.length_squared()).sqrt() + from.dot(to);
    let rotation = DQuat::from_xyzw(axis.x, axis.y, axis.z, w);
    if rotation.length_squared() > 1e-16 {
        return rotation.normalize();
    }
    if from == DVec3::ZERO || to == DVec3::ZERO {
        return DQuat::IDENTITY;
    }
    let about = if from.x.abs() + from.z.abs() > 1e-6 * from.y.abs() { DVec3::Y } else { DVec3::X };
    let about = about.reject_from_normalized(from.normalize()).normalize_or(DVec3::X);
    DQuat::from_axis_angle(about, std::f64::consts::PI)
}

/// The rotation that takes each first direction nearest to its second, in the least-squares sense (Wahba's problem,
/// by Davenport's q-method). `near` decides where the directions leave a choice.
pub(crate) fn best_rotation(pairs: &[(DVec3, DVec3)], near: DQuat) -> DQuat {
    // A little of the frame before makes the answer unique and continuous.
    const HOLD: f64 = 1e-3;
    let mut b = DMat3::from_quat(near) * HOLD;
    for &(from, to) in pairs {
        b += DMat3::from_cols(to * from.x, to * from.y, to * from.z);
    }
    let (m, trace) = (b.to_cols_array_2d(), b.x_axis.x + b.y_axis.y + b.z_axis.z);
    // m[column][row]: element (row, column) of B is m[column][row].
    let z = [m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]];
    let mut k = [[0.0; 4]; 4];
    for i in 0..3 {
        for j in 0..3 {
            k[i][j] = m[i][j] + m[j][i] - if i == j { trace } else { 0.0 };
        }
        k[i][3] = z[i];
        k[3][i] = z[i];
    }
    k[3][3] = trace;
    // Shifted so that the largest eigenvalue is the one of largest size; powers of the matrix single it out.
    let shift = 1.0 + k.iter().flatten().map(|value| value.abs()).fold(0.0, f64::max) * 4.0;
    for (i, row) in k.iter_mut().enumerate() {
        row[i] += shift;
    }
    for _ in 0..40 {
        k = squared(&k);
    }
    let column = k.iter().max_by(|a, b| norm(a).total_cmp(&norm(b))).copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = DQuat::from_array(column);
    if rotation.length_squared() > 0.0 && rotation.is_finite() { rotation.normalize() } else { near }
}

/// The square of a symmetric matrix, made of size 1.
fn squared(k: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let mut out = [[0.0; 4]; 4];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value = (0..4).map(|l| k[i][l] * k[l][j]).sum();
        }
    }
    let size = out.iter().flatten().map(|value| value * value).sum::<f64>().sqrt();
    out.map(|row| row.map(|value| value / size))
}

fn norm(row: &[f64; 4]) -> f64 {
    row.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_rotation_takes_one_direction_to_the_other() {
        let directions =
            [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::new(1.0, 2.0, -3.0).normalize()];
        for from in directions {
            for to in directions {
                assert!((between(from, to) * from).distance(to) < 1e-9, "{from} to {to}");
            }
        }
        assert_eq!(between(DVec3::ZERO, DVec3::X), DQuat::IDENTITY);
    }

    #[test]
    fn directions_that_agree_give_their_rotation() {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.5);
        let directions = [DVec3::X, DVec3::new(0.3, 1.0, 0.2).normalize(), DVec3::NEG_Z];
        let pairs = directions.map(|direction| (direction, turn * direction));
        let found = best_rotation(&pairs, DQuat::IDENTITY);
        assert!(found.angle_between(turn) < 5e-3, "{}", found.angle_between(turn));
        assert!(best_rotation(&pairs, turn).angle_between(turn) < 1e-6);
    }

    #[test]
    fn one_direction_turns_no_more_than_it_must() {
        let found = best_rotation(&[(DVec3::Y, DVec3::X)], DQuat::IDENTITY);
        assert!((found * DVec3::Y).distance(DVec3::X) < 2e-3);
        assert!(found.angle_between(DQuat::from_rotation_z(-std::f64::consts::FRAC_PI_2)) < 5e-3);
    }
}
