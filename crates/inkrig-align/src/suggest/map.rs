//! The clip as a map: moments that are alike lie near to each other.

use super::embedding::{place, place_one, stress};
use super::moments::{Moment, Moments};
use crate::AlignError;
use inkrig_transport::Mat;

/// Moments that are placed by all their distances to each other; the rest by their distances to these.
const LANDMARKS: usize = 256;

/// A plane on which every moment of a clip has a place. Distances on it are as near as a plane can be to those between
/// patches, in the same unit: the mean distance of two moments. The same clip gives the same map.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionMap {
    /// Every frame at the matching rate.
    pub frames: Vec<MapFrame>,
    /// How much of the distances between landmarks the plane does not show: sqrt(sum (d - D)^2 / sum D^2). 0 is a perfect
    /// map; movements of a whole body have about 0.2 to 0.4.
    pub stress: f64,
}

/// A moment on the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapFrame {
    /// Where in the source.
    pub moment: Moment,
    /// Where on the map: x along the direction in which the clip differs most.
    pub place: [f64; 2],
}

impl MotionMap {
    /// The map of a clip: landmark multidimensional scaling by least stress. Time and memory are linear in its length.
    ///
    /// # Errors
    /// When distances cannot be computed, which does not happen for [`Moments`] that could be made.
    pub fn of(moments: &Moments) -> Result<Self, AlignError> {
        let landmarks = moments.spread(LANDMARKS);
        let distances = moments.distances_of(&landmarks)?;
        let between = Mat::from_fn(landmarks.len(), landmarks.len(), |i, j| {
            // Symmetric to the last bit.
            distances.row(i.min(j))[landmarks[i.max(j)]]
        });
        let points = place(&between);
        let mut to_landmarks = vec![0.0; landmarks.len()];
        let places: Vec<[f64; 2]> = (0..moments.count())
            .map(|patch| match landmarks.binary_search(&patch) {
                Ok(landmark) => points[landmark],
                Err(_) => {
                    (0..landmarks.len()).for_each(|index| to_landmarks[index] = distances.row(index)[patch]);
                    place_one(&points, &to_landmarks, start(&points, &to_landmarks))
                }
            })
            .collect();
        let frames = moments.frames().iter().enumerate().map(|(frame, &moment)| MapFrame {
            moment,
            place: places[moments.patch_around(frame).min(places.len() - 1)],
        });
        Ok(Self { frames: frames.collect(), stress: stress(&points, &between) })
    }

    /// The place of the frame nearest to a frame of the source as it was given.
    pub fn place_of(&self, frame: usize) -> Option<[f64; 2]> {
        self.frames.iter().min_by_key(|at| at.moment.frame.abs_diff(frame)).map(|at| at.place)
    }
}

/// The place of the nearest landmark.
fn start(points: &[[f64; 2]], distances: &[f32]) -> [f64; 2] {
    let nearest = points.iter().zip(distances).min_by(|a, b| a.1.total_cmp(b.1));
    nearest.map_or([0.0; 2], |(point, _)| *point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use crate::testing::swinging;

    #[test]
    fn neighbours_in_time_are_neighbours_on_the_map() {
        let moments = Moments::of(&swinging(12.0, 30.0).into(), &Options::default()).unwrap();
        assert!(moments.count() > LANDMARKS);
        let map = MotionMap::of(&moments).unwrap();
        assert_eq!(map.frames.len(), 361);
        assert!(map.stress < 0.4, "{}", map.stress);
        for pair in map.frames.windows(2) {
            let [a, b] = [pair[0].place, pair[1].place];
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.5, "{pair:?}");
        }
        assert_eq!(map, MotionMap::of(&moments).unwrap());
        assert_eq!(map.place_of(100), Some(map.frames[100].place));
    }
}
