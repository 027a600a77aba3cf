//! Feet that slide while they stand (GMD's measure, as MotionLCM has it).

use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{FRAME_RATE, Joints};

/// Joints of the feet: the balls.
const FEET: [usize; 2] = [10, 11];
/// A foot below this stands, metres.
const LOW: f32 = 0.05;
/// A foot that stands and is quicker than this slides, metres a second.
const QUICK: f64 = 0.5;
/// Frames over which a speed is averaged.
const WINDOW: usize = 5;

/// What feet do from each frame to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Skating {
    /// The share of moments in which a foot slides.
    pub ratio: f64,
    /// Left and right foot: the speed over five moments while the foot stands, else 0; metres a second.
    pub speeds: [Vec<f64>; 2],
}

/// Measures one motion. Nothing slides in one of fewer than two frames.
pub fn skating(motion: &[Joints]) -> Skating {
    let moments = motion.len().saturating_sub(1);
    let mut slides = vec![false; moments];
    let speeds = FEET.map(|foot| {
        let pairs = || motion.windows(2).map(|pair| [pair[0][foot], pair[1][foot]]);
        let speed = |[a, b]: [Vec3; 2]| f64::from(b.x - a.x).hypot(f64::from(b.z - a.z)) * FRAME_RATE;
        let speeds: Vec<f64> = pairs().map(speed).collect();
        let half = WINDOW / 2;
        let averaged = |at: usize| {
            // Beyond the ends a foot counts as still.
            let window = at.saturating_sub(half)..(at + half + 1).min(moments);
            speeds[window].iter().sum::<f64>() / WINDOW as f64
        };
        let standing = pairs().map(|pair| pair.iter().all(|place| place.y < LOW));
        let both = standing.enumerate().map(|(at, stands)| (stands, speeds[at], averaged(at)));
        both.zip(&mut slides)
            .map(|((stands, speed, averaged), slides)| {
                *slides |= stands && speed > QUICK && averaged > QUICK;
                if stands { averaged } else { 0.0 }
            })
            .collect()
    });
    let count = slides.iter().filter(|slides| **slides).count();
    Skating { ratio: count as f64 / moments.max(1) as f64, speeds }
}
