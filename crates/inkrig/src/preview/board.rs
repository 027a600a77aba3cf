//! A storyboard beside the motion that was made of it: what was drawn, when each frame is played, and where its ways are in space.

use super::encode::{decimals, shorten};
use serde::Serialize;

/// What of a storyboard is shown at most: frames, strokes of a frame, points of a stroke or way.
const MOST_FRAMES: usize = 100;
const MOST_STROKES: usize = 500;
const MOST_POINTS: usize = 400;

/// One frame of a storyboard.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BoardFrame {
    /// What is done.
    pub word: String,
    /// When it is played, seconds from the beginning: from, to.
    pub seconds: [f64; 2],
    /// When the drawn pose is taken.
    pub key: Option<f64>,
    /// What was drawn, canvas units, y up.
    pub strokes: Vec<BoardStroke>,
    /// Joints that were read of the figure, canvas units.
    pub joints: Vec<[f64; 2]>,
    /// Where drawn ways are in space.
    pub ways: Vec<BoardWay>,
}

/// A line of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardStroke {
    /// What it stands for.
    pub ink: Ink,
    /// Its points.
    pub points: Vec<[f64; 2]>,
}

/// What a line of the drawing stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Ink {
    /// The figure.
    Body,
    /// A joint's way.
    Way,
    /// Speed.
    Speed,
    /// A word.
    Word,
    /// What stands around.
    Scene,
}

/// A drawn way in space.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardWay {
    /// When its joint sets out, and how many points it has a second.
    pub begins: f64,
    /// See `begins`.
    pub rate: f64,
    /// Metres, y up.
    pub points: Vec<[f32; 3]>,
}

/// A frame as the page knows it: everything drawn is scaled to a box of at most 1 by 1, y up.
#[derive(Debug, Serialize)]
pub(super) struct BoardData {
    word: String,
    seconds: [f64; 2],
    key: Option<f64>,
    /// Width and height of what is drawn.
    size: [f64; 2],
    strokes: Vec<(Ink, Vec<[f64; 2]>)>,
    joints: Vec<[f64; 2]>,
    ways: Vec<WayData>,
}

#[derive(Debug, Serialize)]
struct WayData {
    begins: f64,
    rate: f64,
    points: Vec<[f64; 3]>,
}

impl BoardData {
    pub(super) fn of(frames: &[BoardFrame]) -> Vec<Self> {
        frames.iter().take(MOST_FRAMES).map(Self::of_frame).collect()
    }

    fn of_frame(frame: &BoardFrame) -> Self {
        let strokes = || frame.strokes.iter().take(MOST_STROKES);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in strokes().flat_map(|stroke| &stroke.points).chain(&frame.joints).filter(|at| finite(at))
        {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let span = [0, 1].map(|axis| (high[axis] - low[axis]).max(0.0));
        let scale = 1.0 / span[0].max(span[1]).max(1e-9);
        let boxed = |point: &[f64; 2]| [0, 1].map(|axis| decimals(scale * (point[axis] - low[axis]), 4));
        let line = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            thinned(points).filter(|at| finite(at)).map(boxed).collect()
        };
        let way = |way: &BoardWay| {
            let step = way.points.len().div_ceil(MOST_POINTS).max(1);
            let at = |point: &[f32; 3]| point.map(|number| decimals(f64::from(number), 4));
            WayData {
                begins: decimals(way.begins, 4),
                rate: decimals(way.rate / step as f64, 6),
                points: thinned(&way.points).map(at).collect(),
            }
        };
        Self {
            word: shorten(&frame.word, 100),
            seconds: frame.seconds.map(|seconds| decimals(seconds, 4)),
            key: frame.key.map(|seconds| decimals(seconds, 4)),
            size: span.map(|span| decimals(scale * span, 4)),
            strokes: strokes().map(|stroke| (stroke.ink, line(&stroke.points))).collect(),
            joints: frame.joints.iter().filter(|at| finite(at)).map(boxed).collect(),
            ways: frame.ways.iter().map(way).collect(),
        }
    }
}

fn finite(point: &[f64; 2]) -> bool {
    point.iter().all(|number| number.is_finite())
}

/// So many points as are shown at most, evenly.
fn thinned<T>(points: &[T]) -> impl Iterator<Item = &T> {
    points.iter().step_by(points.len().div_ceil(MOST_POINTS).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_are_boxed_and_thinned_and_what_is_no_number_is_left_out() {
        let points: Vec<[f64; 2]> =
            (0..4000).map(|i| [100.0 + f64::from(i), 50.0]).chain([[f64::NAN, 1.0]]).collect();
        let ways = vec![BoardWay { begins: 0.5, rate: 20.0, points: vec![[f32::INFINITY, 0.0, 1.0]; 900] }];
        let strokes = vec![BoardStroke { ink: Ink::Way, points }];
        let frame = BoardFrame { strokes, ways, joints: vec![[200.0, 1049.0]], ..BoardFrame::default() };
        let data = BoardData::of(&vec![frame; 150]);
        assert_eq!(data.len(), MOST_FRAMES);
        let (ink, line) = &data[0].strokes[0];
        assert!(*ink == Ink::Way && line.len() <= MOST_POINTS && line.len() > MOST_POINTS / 2);
        assert_eq!(line[0], [0.0, 0.0]);
        assert_eq!(data[0].joints[0][1], decimals(999.0 / 3999.0, 4));
        assert!(data[0].ways[0].points.len() <= MOST_POINTS);
        assert_eq!(data[0].ways[0].points[0], [0.0, 0.0, 1.0]);
        assert!((data[0].ways[0].rate - 20.0 / 3.0).abs() < 1e-5);
    }
}
