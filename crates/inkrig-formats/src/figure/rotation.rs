//! The rotation in a matrix that scales, stretches or shears as well.

use inkrig_motion::glam::{DMat3, DQuat};

/// The rotation in a matrix: the nearest one, in the sense of the polar decomposition. `None` when the matrix mirrors
/// or flattens.
pub(crate) fn rotation_of(matrix: DMat3) -> Option<DQuat> {
    let size = matrix.determinant().cbrt();
    if !(size.is_finite() && size > 1e-9) {
        return None;
    }
    let mut nearest = matrix * (1.0 / size);
    // Newton's iteration; a matrix that only turns and scales is there at once.
    for _ in 0..20 {
        let next = (nearest + nearest.inverse().transpose()) * 0.5;
        let change = (next.x_axis - nearest.x_axis).length()
            + (next.y_axis - nearest.y_axis).length()
            + (next.z_axis - nearest.z_axis).length();
        nearest = next;
        if change < 1e-13 {
            break;
        }
    }
    let rotation = DQuat::from_mat3(&nearest);
    (rotation.is_finite() && rotation.length_squared() > 0.5).then(|| rotation.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::glam::DVec3;

    #[test]
    fn the_rotation_is_found_whatever_the_scale() {
        let turn = DQuat::from_euler(inkrig_motion::glam::EulerRot::XYZ, 0.4, -1.2, 2.0);
        for size in [1e-3, 1.0, 100.0] {
            let found = rotation_of(DMat3::from_quat(turn) * size).unwrap();
            assert!(found.dot(turn).abs() > 1.0 - 1e-12, "{size}");
        }
        // A stretch that is symmetric leaves the rotation alone.
        let stretched = DMat3::from_quat(turn) * DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5));
        assert!(rotation_of(stretched).unwrap().dot(turn).abs() > 1.0 - 1e-12);
        assert_eq!(rotation_of(DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0))), None);
        assert_eq!(rotation_of(DMat3::ZERO), None);
    }
}
