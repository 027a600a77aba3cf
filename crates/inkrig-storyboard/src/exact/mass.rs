//! Where a body's mass is.

use super::body::Places;
use inkrig_motion::glam::DVec3;

/// Segments: from where, to where (means of joints), the share of the whole mass, and where on the way its centre is.
///
/// D. A. Winter, Biomechanics and Motor Control of Human Movement, 4th edition, 2009, table 4.1 (after Dempster 1955). Hands are taken at
/// the wrist and the head at its joint, which is near the ear; the trunk lies between hips and shoulders.
type Segment = (&'static [usize], &'static [usize], f64, f64);
const SEGMENTS: [Segment; 14] = [
    (&[1, 2], &[16, 17], 0.497, 0.5),
    (&[15], &[15], 0.081, 0.5),
    (&[1], &[4], 0.1, 0.433),
    (&[2], &[5], 0.1, 0.433),
    (&[4], &[7], 0.0465, 0.433),
    (&[5], &[8], 0.0465, 0.433),
    (&[7], &[10], 0.0145, 0.5),
    (&[8], &[11], 0.0145, 0.5),
    (&[16], &[18], 0.028, 0.436),
    (&[17], &[19], 0.028, 0.436),
    (&[18], &[20], 0.016, 0.43),
    (&[19], &[21], 0.016, 0.43),
    (&[20], &[20], 0.006, 0.5),
    (&[21], &[21], 0.006, 0.5),
];

/// The centre of mass, and the share that each joint's place has in it; a joint may have several.
pub(super) fn centre_of_mass(pose: &Places) -> (DVec3, impl Iterator<Item = (usize, f64)> + use<>) {
    let shares = || {
        SEGMENTS.iter().flat_map(|(from, to, mass, at)| {
            let ends = [(*from, mass * (1.0 - at)), (*to, mass * at)];
            ends.into_iter().flat_map(|(joints, share)| {
                joints.iter().map(move |joint| (*joint, share / joints.len() as f64))
            })
        })
    };
    (shares().map(|(joint, share)| share * pose[joint]).sum(), shares())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::body::doubled;
    use crate::exact::joints_of;
    use crate::exact::tests::standing;

    #[test]
    fn the_centre_of_who_stands_is_a_little_above_the_hips() {
        let pose = doubled(&joints_of(&standing(1))[0]);
        let (centre, shares) = centre_of_mass(&pose);
        assert!((shares.map(|(_, share)| share).sum::<f64>() - 1.0).abs() < 1e-9);
        // Standing people have it at 55 to 57 % of their height: here some 1.7 m.
        assert!((0.9..1.0).contains(&centre.y) && centre.x.abs() < 0.01, "{centre}");
    }
}
