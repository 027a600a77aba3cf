//! The part of a clip that is nearest to a frame, by word and by the shape of its way over the ground.

use super::super::{Example, Library, words};
use super::read::CreatureFrame;
use super::way::World;
use inkrig_motion::glam::DVec2;
use inkrig_motion::ground::{Trajectory, TravelOptions};

/// Points that ways are compared by.
const POINTS: usize = 16;
/// A window that goes less far than this, in sizes of the body, stays where it is.
pub(super) const STILL: f64 = 0.5;
/// What a clip that stays where it is has instead of a way's distance.
const IN_PLACE: f32 = 0.5;
/// How much a way counts beside a word.
const PATH: f32 = 0.5;
/// Windows begin at so many places of a clip at most.
const PLACES: usize = 60;

/// A part of a clip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window<'a> {
    pub(super) of: &'a Example,
    pub(super) first: usize,
    pub(super) length: usize,
    pub(super) word: f32,
    pub(super) path: Option<f32>,
}

/// The nearest window; clips that are too short are taken as a whole, and repeated later.
pub(super) fn nearest<'a>(
    library: &'a Library,
    frame: &CreatureFrame,
    way: Option<&World>,
) -> Option<Window<'a>> {
    let drawn: Option<Vec<DVec2>> = way.filter(|way| way.over_ground).map(|way| {
        let flat: Vec<DVec2> =
            way.places.iter().map(|place| DVec2::new(f64::from(place.x), f64::from(place.z))).collect();
        spread(&flat)
    });
    let mut best: Option<(f32, Window<'a>)> = None;
    for example in &library.examples {
        let clip = &example.clip;
        let word = words::distance(&frame.word, &example.said);
        let trajectory = Trajectory::of(clip, &TravelOptions::default());
        let size = f64::from(clip.skeleton().extent()).max(1e-3);
        let length = ((frame.seconds * clip.frame_rate()).round() as usize).clamp(2, clip.frames());
        let last = clip.frames() - length;
        for first in (0..=last).step_by((last / PLACES).max(1)) {
            let own = &trajectory.path[first..first + length];
            let path = drawn.as_ref().map(|drawn| {
                let gone: f64 = own.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
                if gone < STILL * size { IN_PLACE } else { apart(drawn, &spread(own)) }
            });
            let score = word + PATH * path.unwrap_or(0.0);
            if best.as_ref().is_none_or(|(least, _)| score < *least) {
                best = Some((score, Window { of: example, first, length, word, path }));
            }
        }
    }
    best.map(|(_, window)| window)
}

/// Points evenly over time.
fn spread(path: &[DVec2]) -> Vec<DVec2> {
    let last = path.len().saturating_sub(1);
    let at = |point: usize| {
        let place = last as f64 * point as f64 / (POINTS - 1) as f64;
        let low = (place.floor() as usize).min(last);
        let (a, b) = (path.get(low), path.get((low + 1).min(last)));
        a.zip(b).map(|(a, b)| a.lerp(*b, place.fract())).unwrap_or_default()
    };
    (0..POINTS).map(at).collect()
}

/// The share of one way that no turn, scale and shift of the other explains, 0 to 1 (Procrustes).
fn apart(a: &[DVec2], b: &[DVec2]) -> f32 {
    let middle = |points: &[DVec2]| points.iter().copied().sum::<DVec2>() / points.len().max(1) as f64;
    let (ma, mb) = (middle(a), middle(b));
    let (mut along, mut across, mut aa, mut bb) = (0.0, 0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (*a - ma, *b - mb);
        along += a.dot(b);
        across += a.perp_dot(b);
        (aa, bb) = (aa + a.length_squared(), bb + b.length_squared());
    }
    let explained = (along * along + across * across) / (aa * bb).max(f64::MIN_POSITIVE);
    (1.0 - explained).max(0.0).sqrt() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_are_alike_however_turned_and_large_but_not_bent() {
        let straight: Vec<DVec2> = (0..30).map(|at| DVec2::new(0.1 * f64::from(at), 0.0)).collect();
        let turned: Vec<DVec2> = straight.iter().map(|at| DVec2::new(3.0, 5.0 * at.x)).collect();
        let round: Vec<DVec2> =
            (0..30).map(|at| DVec2::from_angle(std::f64::consts::TAU * f64::from(at) / 29.0)).collect();
        assert!(apart(&spread(&straight), &spread(&turned)) < 1e-3);
        assert!(apart(&spread(&straight), &spread(&round)) > 0.7);
    }
}
