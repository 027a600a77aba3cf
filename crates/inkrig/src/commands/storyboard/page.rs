//! The page of a storyboard: the frame that is played, and the motion with what was drawn in space.

use super::Made;
use crate::preview::{self, BoardFrame, BoardStroke, BoardWay, ControlView, Figure, HeatMap, Ink, Preview};
use inkrig_motion::Clip;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{FRAME_RATE, Joints};
use inkrig_motion::kinematics;
use inkrig_sketch::storyboard::{Frame, Storyboard, Stroke};
use inkrig_storyboard::{Goal, Source, Understood};

/// The page as HTML. `shown` is the motion on a character of the user's, if there is one: ways are not drawn beside that, as it has
/// another size.
pub(in crate::commands) fn page(
    title: &str,
    board: &Storyboard,
    (understood, made): (&[Understood], &Made),
    shown: Option<&Clip>,
    (figures, notes): (&[Figure], &[String]),
) -> String {
    let clip = shown.unwrap_or(&made.animation.clip);
    let motion: Vec<Joints> = {
        let places = kinematics::positions(&made.animation.clip);
        (0..made.animation.clip.frames()).filter_map(|frame| places.frame(frame).try_into().ok()).collect()
    };
    let frames: Vec<BoardFrame> = board
        .frames
        .iter()
        .zip(understood)
        .enumerate()
        .map(|(row, (frame, read))| {
            let ways = if shown.is_none() { ways(row, made, &motion) } else { Vec::new() };
            board_frame(row, frame, read, made, ways)
        })
        .collect();
    let way: Vec<[f64; 2]> =
        motion.iter().map(|pose| [f64::from(pose[0].x), f64::from(-pose[0].z)]).collect();
    preview::render(&Preview {
        title,
        result: clip,
        source: clip,
        control: ControlView::Way(&way),
        control_rate: FRAME_RATE,
        heat_map: HeatMap::default(),
        best_source: &[],
        confidence: &[],
        guide: None,
        board: &frames,
        figures,
        notes,
    })
}

fn board_frame(row: usize, frame: &Frame, read: &Understood, made: &Made, ways: Vec<BoardWay>) -> BoardFrame {
    let begins = made.animation.joined.starts.get(row).copied().unwrap_or(0);
    let (length, key) = made
        .clips
        .get(row)
        .map_or((0, None), |clip| (clip.plan.frames, clip.plan.keypose.as_ref().map(|(frame, _)| *frame)));
    let seconds = |frame: usize| frame as f64 / FRAME_RATE;
    let lines = |ink: Ink, strokes: &[Stroke]| -> Vec<BoardStroke> {
        strokes.iter().map(|stroke| BoardStroke { ink, points: stroke.points.clone() }).collect()
    };
    let drawn_ways: Vec<Stroke> = frame.trajectories.iter().map(|way| way.points.clone()).collect();
    let strokes = [
        lines(Ink::Scene, &frame.scene),
        lines(Ink::Body, &frame.body),
        lines(Ink::Way, &drawn_ways),
        lines(Ink::Speed, &frame.speed_lines),
        lines(Ink::Word, &frame.lettering),
    ];
    BoardFrame {
        word: read.plan.word.clone(),
        seconds: [seconds(begins), seconds(begins + length)],
        key: key.map(|frame| seconds(begins + frame)),
        strokes: strokes.concat(),
        joints: read
            .figure
            .iter()
            .flat_map(|figure| figure.joints.iter().flatten())
            .map(|found| found.at)
            .collect(),
        ways,
    }
}

/// Drawn ways in space, and then the path: a drawing says nothing of how far away they are, so each place is as far as its joint, and
/// a path nothing of how high it is.
pub(in crate::commands) fn ways(row: usize, made: &Made, motion: &[Joints]) -> Vec<BoardWay> {
    let (Some(goals), Some(clip)) = (made.animation.goals.get(row), made.clips.get(row)) else {
        return Vec::new();
    };
    let place = |goal: &Goal| Some(in_space(goal, motion.get(goal.frame)?).to_array());
    let drawn = clip.plan.ways.iter().map(|(joint, ..)| (*joint, Source::Way));
    let path = clip.plan.path.iter().map(|_| (0, Source::Path));
    drawn
        .chain(path)
        .filter_map(|(joint, source)| {
            let own = || goals.iter().filter(|goal| goal.source == source && goal.joint == joint);
            let begins = own().map(|goal| goal.frame).min()? as f64 / FRAME_RATE;
            Some(BoardWay { begins, rate: FRAME_RATE, points: own().filter_map(place).collect() })
        })
        .collect()
}

/// The drawn pose of a frame in space, with what is not drawn where the motion has it.
pub(in crate::commands) fn pose(row: usize, made: &Made, motion: &[Joints]) -> Option<Joints> {
    let (frame, _) = made.clips.get(row)?.plan.keypose.as_ref()?;
    let at = made.animation.joined.starts.get(row)? + frame;
    let own = *motion.get(at)?;
    let mut pose = own;
    let drawn_at = |goal: &&Goal| goal.frame == at && !matches!(goal.source, Source::Edit | Source::Path);
    for goal in made.animation.goals.get(row)?.iter().filter(drawn_at) {
        *pose.get_mut(goal.joint)? = in_space(goal, &own);
    }
    Some(pose)
}

/// Where a goal is in space: on the picture where it was drawn, and as far away as its joint.
fn in_space(goal: &Goal, pose: &Joints) -> Vec3 {
    let own = pose.get(goal.joint).copied().unwrap_or_default();
    let miss = goal.miss(own);
    own - goal.axes[0] * miss.x - goal.axes[1] * miss.y
}
