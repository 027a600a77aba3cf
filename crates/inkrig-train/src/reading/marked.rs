//! Drawings on which somebody marked the joints (as AnimatedDrawings keeps them).

use crate::TrainError;
use inkrig_generate::readers::sketch::KEY_POINTS;
use std::path::{Path, PathBuf};

/// Names of marked joints and the key points that they are. Shoulders lie beside the collars that the reader finds, so they
/// are left out.
const MARKED: [(&str, usize); 10] = [
    ("hip", 0),
    ("right_hip", 2),
    ("left_hip", 1),
    ("right_elbow", 15),
    ("left_elbow", 14),
    ("right_hand", 17),
    ("left_hand", 16),
    ("right_knee", 5),
    ("left_knee", 4),
    ("neck", 13),
];
/// Feet are marked at the ankle.
const FEET: [(&str, usize); 2] = [("right_foot", 7), ("left_foot", 6)];

/// A drawing with joints, pixels from the left and from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkedDrawing {
    /// The picture's file.
    pub picture: PathBuf,
    /// Key points and where they are.
    pub joints: Vec<(usize, [f32; 2])>,
    /// From the hip to where the arms begin, pixels.
    pub torso: f32,
}

impl MarkedDrawing {
    /// Reads the marks: a YAML list of `- loc:` with two numbers and `name:`.
    ///
    /// # Errors
    /// When there are no joints of a body.
    pub fn read(picture: &Path, path: &Path, text: &str) -> Result<Self, TrainError> {
        let mut numbers: Vec<f32> = Vec::new();
        let mut named: Vec<(String, [f32; 2])> = Vec::new();
        for line in text.lines().map(str::trim) {
            if line == "- loc:" {
                numbers.clear();
            } else if let Some(number) = line.strip_prefix("- ").and_then(|number| number.parse().ok()) {
                numbers.push(number);
            } else if let Some(name) = line.strip_prefix("name: ")
                && let [x, y] = numbers[..]
            {
                named.push((name.to_string(), [x, y]));
            }
        }
        let place = |name: &str| named.iter().find(|(own, _)| own == name).map(|(_, place)| *place);
        let joints: Vec<(usize, [f32; 2])> =
            MARKED.iter().chain(&FEET).filter_map(|(name, point)| Some((*point, place(name)?))).collect();
        let (Some(hip), Some(torso)) = (place("hip"), place("torso")) else {
            let what = "holds no joints named hip and torso".to_string();
            return Err(TrainError::Content { path: path.to_path_buf(), what });
        };
        let torso = (hip[0] - torso[0]).hypot(hip[1] - torso[1]);
        Ok(Self { picture: picture.to_path_buf(), joints, torso })
    }
}

/// How many marked joints lie within a share of the torso's length of where they were found (pixels of the picture).
pub fn measure_marked(drawing: &MarkedDrawing, places: &[[f32; 2]; KEY_POINTS], within: f32) -> usize {
    let near = |(point, [x, y]): &&(usize, [f32; 2])| {
        let [a, b] = places[*point];
        (a - x).hypot(b - y) <= within * drawing.torso
    };
    drawing.joints.iter().filter(near).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_read_and_counted() {
        let text = "height: 9\nskeleton:\n- loc:\n  - 10\n  - 50\n  name: hip\n  parent: root\n- loc:\n  - 10\n  - 30\n  name: torso\n\
                    - loc:\n  - 40\n  - 35\n  name: left_hand\n";
        let drawing = MarkedDrawing::read(Path::new("a.png"), Path::new("a.yaml"), text).unwrap();
        assert_eq!(drawing.joints, [(0, [10.0, 50.0]), (16, [40.0, 35.0])]);
        assert_eq!(drawing.torso, 20.0);
        let mut places = [[0.0; 2]; KEY_POINTS];
        places[0] = [11.0, 51.0];
        places[16] = [43.0, 35.0];
        assert_eq!(measure_marked(&drawing, &places, 0.1), 1);
        assert_eq!(measure_marked(&drawing, &places, 0.2), 2);
        assert!(MarkedDrawing::read(Path::new("a.png"), Path::new("a.yaml"), "name: x").is_err());
    }
}
