//! Rotations as features: the 6D form, and the way back from averages.

use glam::{Mat3, Quat, Vec3};

/// The 6D form of a rotation: the first two columns of its matrix, one after the other (Zhou et al. 2019).
pub fn to_6d(rotation: Quat) -> [f32; 6] {
    let matrix = Mat3::from_quat(rotation);
    let (x, y) = (matrix.x_axis, matrix.y_axis);
    [x.x, x.y, x.z, y.x, y.y, y.z]
}

/// The rotation nearest to an averaged 6D form: nearest orthonormal pair in the least-squares sense (the polar
/// factor of the 3x2 matrix), so that neither column is preferred as in Gram-Schmidt.
///
/// `None` when the average has lost its direction: a column is (almost) zero, or the two are (almost) parallel, or
/// a value is not finite.
pub fn from_6d(values: [f32; 6]) -> Option<Quat> {
    let [ax, ay, az, bx, by, bz] = values;
    let (a, b) = (Vec3::new(ax, ay, az).as_dvec3(), Vec3::new(bx, by, bz).as_dvec3());
    // S = M^T M is 2x2; M S^(-1/2) has orthonormal columns. With t = sqrt(tr S + 2 sqrt(det S)):
    // S^(1/2) = (S + sqrt(det S) I) / t, whose inverse is closed form.
    let (aa, ab, bb) = (a.length_squared(), a.dot(b), b.length_squared());
    let root = (aa * bb - ab * ab).max(0.0).sqrt();
    let trace = (aa + bb + 2.0 * root).sqrt();
    if !(root.is_finite() && root > 1e-6 && trace > 0.0) {
        return None;
    }
    let (h_aa, h_ab, h_bb) = ((aa + root) / trace, ab / trace, (bb + root) / trace);
    let det = h_aa * h_bb - h_ab * h_ab;
    let x = (a * h_bb - b * h_ab) / det;
    let y = (b * h_aa - a * h_ab) / det;
    let matrix = glam::DMat3::from_cols(x, y, x.cross(y));
    let rotation = glam::DQuat::from_mat3(&matrix).normalize().as_quat();
    rotation.is_finite().then_some(rotation)
}

/// The twist of a rotation about an axis of unit length, radians in -pi..=pi (swing-twist split). 0 when the
/// rotation is a half turn about an axis across it, where the twist is not defined.
pub fn twist_angle(rotation: Quat, axis: Vec3) -> f32 {
    let along = rotation.xyz().dot(axis);
    let angle = 2.0 * along.atan2(rotation.w);
    crate::root::wrap_angle(angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rotations() -> impl Strategy<Value = Quat> {
        (-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0)
            .prop_filter("a direction", |(x, y, z, w)| x * x + y * y + z * z + w * w > 1e-2)
            .prop_map(|(x, y, z, w)| Quat::from_xyzw(x, y, z, w).normalize())
    }

    proptest! {
        #[test]
        fn six_numbers_and_back(rotation in rotations(), scale in 0.1_f32..2.0) {
            let scaled = to_6d(rotation).map(|value| value * scale);
            let back = from_6d(scaled).unwrap();
            prop_assert!(back.dot(rotation).abs() > 1.0 - 1e-6);
        }

        #[test]
        fn the_mean_of_two_is_half_way(rotation in rotations(), angle in 0.0_f32..1.5) {
            let (left, right) = (rotation * Quat::from_rotation_z(angle), rotation * Quat::from_rotation_z(-angle));
            let (l, r) = (to_6d(left), to_6d(right));
            let mean = std::array::from_fn(|i| 0.5 * (l[i] + r[i]));
            prop_assert!(from_6d(mean).unwrap().dot(rotation).abs() > 1.0 - 1e-5);
        }
    }

    #[test]
    fn averages_without_direction_are_refused() {
        assert_eq!(from_6d([0.0; 6]), None);
        assert_eq!(from_6d([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]), None);
        assert_eq!(from_6d([f32::NAN, 0.0, 0.0, 0.0, 1.0, 0.0]), None);
    }

    #[test]
    fn twist_is_the_turn_about_the_axis() {
        let rotation = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.4);
        assert!((twist_angle(rotation, Vec3::Y) - 0.7).abs() < 1e-6);
        assert!((twist_angle(-rotation, Vec3::Y) - 0.7).abs() < 1e-6);
    }
}
