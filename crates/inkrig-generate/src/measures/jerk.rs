//! How smooth a transition is: jerk over time, its peak and its distance from that of real motion (FlowMDM).

use inkrig_motion::humanml::Joints;

/// The mean jerk of HumanML3D's motions, as FlowMDM measured it and the paper compares with, metres per frame^3.
pub const REAL_JERK: f64 = 0.033_031_363;

/// The largest jerk of any joint at every moment: third differences of positions per frame, added up over x, y and z. Three
/// fewer than there are frames.
pub fn jerk(motion: &[Joints]) -> Vec<f64> {
    let at = |window: &[Joints]| {
        let [a, b, c, d] = window else { return 0.0 };
        let joints = a.iter().zip(b).zip(c.iter().zip(d));
        joints
            .map(|((a, b), (c, d))| {
                let third = d.as_dvec3() - 3.0 * c.as_dvec3() + 3.0 * b.as_dvec3() - a.as_dvec3();
                third.abs().element_sum()
            })
            .fold(0.0, f64::max)
    };
    motion.windows(4).map(at).collect()
}

/// The mean of several motions' jerk at every moment of the shortest.
pub fn mean_jerk(curves: &[Vec<f64>]) -> Vec<f64> {
    let length = curves.iter().map(Vec::len).min().unwrap_or(0);
    let mean = |at: usize| curves.iter().filter_map(|curve| curve.get(at)).sum::<f64>() / curves.len() as f64;
    (0..length).map(mean).collect()
}

/// AUJ: how far a curve of jerk is from that of real motion, added up over its moments.
pub fn area_under_jerk(curve: &[f64]) -> f64 {
    curve.iter().map(|jerk| (jerk - REAL_JERK).abs()).sum()
}

/// PJ: the largest jerk. Too little is as unlike real motion as too much.
pub fn peak_jerk(curve: &[f64]) -> f64 {
    curve.iter().copied().fold(0.0, f64::max)
}
