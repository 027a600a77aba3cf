//! Storyboards: stick figures in poses that were set by hand, with the ways of joints, drawn as a hand draws.

mod boards;
mod hand;
mod page;
mod pose;

use hand::{Hand, UNITS, in_time};
use inkrig_motion::glam::DVec3;
use inkrig_sketch::SketchError;
use inkrig_sketch::storyboard::{
    Constraint, Frame, FrameCamera, Storyboard, Stroke, Trajectory, write_storyboard,
};
use pose::{Placed, Pose, seen};

pub use page::{COLOURS, Page};

/// Radius of the head, metres.
const HEAD: f64 = 0.1;

/// File names and bytes of all storyboards.
///
/// # Errors
/// Never in practice: when a storyboard is refused.
pub fn files() -> Result<Vec<(String, Vec<u8>)>, SketchError> {
    let mut files = Vec::new();
    for (name, board) in boards::all() {
        files.push((format!("{name}.json"), write_storyboard(&board)?.into_bytes()));
        files.push((format!("{name}.svg"), to_svg(&board).into_bytes()));
    }
    Ok(files)
}

/// A frame in the making.
struct Sketch {
    hand: Hand,
    placed: Placed,
    frame: Frame,
}

impl Sketch {
    /// A figure in a pose.
    fn of(word: &str, pose: &Pose, seed: u64) -> Self {
        let camera = FrameCamera::default();
        let placed = pose.placed();
        let mut hand = Hand::new(seed);
        let at = |place: DVec3| seen(&camera, place);
        let mut body = vec![hand.round(at(placed.head + DVec3::Y * 0.07), HEAD)];
        body.push(hand.line(&[
            at(placed.neck + DVec3::Y * 0.03),
            at(placed.neck.lerp(placed.pelvis, 0.5)),
            at(placed.pelvis),
        ]));
        let [left, right] = [placed.arms[0][0], placed.arms[1][0]];
        body.push(hand.corners(&[at(left), at(placed.neck.lerp(0.5 * (left + right), 0.7)), at(right)]));
        for arm in placed.arms {
            body.push(hand.corners(&arm.map(at)));
        }
        for [hip, knee, ankle, toe] in placed.legs {
            body.push(hand.corners(&[at(placed.pelvis.lerp(hip, 0.5)), at(knee), at(ankle), at(toe)]));
        }
        Self { hand, placed, frame: Frame { word: word.into(), body, camera, ..Frame::default() } }
    }

    /// A way through places in space, metres; the first or last is the joint's own.
    fn way(mut self, through: &[DVec3]) -> Self {
        let line = self.line(through);
        self.frame.trajectories.push(Trajectory { points: line, ..Trajectory::default() });
        self
    }

    /// The same with the pen's own time.
    fn way_in(mut self, seconds: f64, through: &[DVec3]) -> Self {
        let line = in_time(self.line(through), seconds);
        self.frame.trajectories.push(Trajectory { points: line, ..Trajectory::default() });
        self
    }

    fn line(&mut self, through: &[DVec3]) -> Stroke {
        let camera = self.frame.camera;
        let flat: Vec<[f64; 2]> = through.iter().map(|place| seen(&camera, *place)).collect();
        self.hand.line(&flat)
    }

    /// Dashes beside the last trajectory, over this part of it.
    fn quick(mut self, dashes: usize, part: std::ops::Range<f64>) -> Self {
        let points = self.frame.trajectories.last().map(|way| way.points.points.clone()).unwrap_or_default();
        let at = |share: f64| points.get((share * points.len() as f64) as usize).copied();
        for dash in 0..dashes {
            let off = [5.0 + 5.0 * dash as f64, -4.0 - 5.0 * dash as f64];
            let ends = [at(part.start), at(0.5 * (part.start + part.end)), at(part.end)];
            let places: Vec<[f64; 2]> = ends
                .iter()
                .flatten()
                .map(|place| [(place[0] + off[0]) / UNITS, (place[1] + off[1]) / UNITS])
                .collect();
            let line = self.hand.line(&places);
            self.frame.speed_lines.push(line);
        }
        self
    }

    /// Lines of what stands around.
    fn scene(mut self, lines: &[&[DVec3]]) -> Self {
        let camera = self.frame.camera;
        for line in lines {
            let flat: Vec<[f64; 2]> = line.iter().map(|place| seen(&camera, *place)).collect();
            let drawn = self.hand.corners(&flat);
            self.frame.scene.push(drawn);
        }
        self
    }

    fn seconds(mut self, seconds: f64) -> Self {
        self.frame.seconds = Some(seconds);
        self
    }

    /// Something that holds in space.
    fn holds(mut self, constraint: Constraint) -> Self {
        self.frame.constraints.push(constraint);
        self
    }

    fn notes(mut self, notes: &str) -> Self {
        self.frame.notes = notes.into();
        self
    }
}

fn board(title: &str, frames: Vec<Sketch>) -> Storyboard {
    Storyboard { title: title.into(), frames: frames.into_iter().map(|sketch| sketch.frame).collect() }
}

/// A storyboard as a drawing: a group for each frame, a group for each kind of line.
pub fn to_svg(board: &Storyboard) -> String {
    const GAP: f64 = 60.0;
    let mut body = String::new();
    let (mut right, mut top) = (GAP, 0.0_f64);
    for (number, frame) in board.frames.iter().enumerate() {
        let points = || frame.strokes().chain(&frame.scene).flat_map(|stroke| &stroke.points);
        let bound = |axis: usize| {
            points()
                .fold((0.0_f64, 0.0_f64), |(low, high), point| (low.min(point[axis]), high.max(point[axis])))
        };
        let ((left, wide), (low, high)) = (bound(0), bound(1));
        let place = |[x, y]: &[f64; 2]| format!("{:.1} {:.1}", x - left + right, GAP + 500.0 - y);
        let group = |name: &str, colour: &str, strokes: &mut dyn Iterator<Item = &Stroke>| {
            let paths: String = strokes
                .map(|stroke| {
                    let points: Vec<String> = stroke.points.iter().map(place).collect();
                    format!("   <path d=\"M{}\"/>\n", points.join("L"))
                })
                .collect();
            if paths.is_empty() {
                paths
            } else {
                format!("  <g id=\"{name}-{}\" stroke=\"{colour}\">\n{paths}  </g>\n", number + 1)
            }
        };
        body += &format!(" <g id=\"frame-{}\">\n", number + 1);
        body += &group("scene", "#b4b4b4", &mut frame.scene.iter());
        body += &group("body", "#000000", &mut frame.body.iter());
        body += &group("trajectory", "#00a0be", &mut frame.trajectories.iter().map(|way| &way.points));
        body += &group("speed", "#f08c00", &mut frame.speed_lines.iter());
        let word = frame.word.replace('&', "&amp;").replace('<', "&lt;");
        body += &format!(
            "  <text x=\"{right:.0}\" y=\"{GAP:.0}\" font-size=\"28\" fill=\"#000000\" stroke=\"none\">{word}</text>\n"
        );
        body += " </g>\n";
        right += wide - left + GAP;
        top = top.max(GAP + 500.0 - low + GAP).max(high);
    }
    let title = board.title.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {right:.0} {top:.0}\" fill=\"none\" stroke-width=\"4\" stroke-linecap=\"round\">\n <title>{title}</title>\n{body}</svg>\n"
    )
}
