//! The joints of a drawn figure: as a network reads them, with the opinion of the lines, and as the user has said.

use crate::error::{Problem, StoryboardError};
use crate::joints::joint_named;
use crate::page::{Page, bounds, distance};
use inkrig_generate::readers::graph;
use inkrig_generate::readers::ink::crop;
use inkrig_generate::readers::network::Work;
use inkrig_generate::readers::sketch::{
    JOINT_OF_KEY_POINT, KEY_POINTS, MARGIN, Reading, SIDE, SketchReader, UNSURE,
};
use inkrig_motion::humanml::{JOINTS, NAMES};
use inkrig_sketch::storyboard::{Frame, SideChoice, Sides, Stroke};

/// Below this likelihood a joint is taken for not drawn.
const DRAWN: f32 = 0.5;
/// Sides that are less sure than this, as a logarithm, are pointed out.
const SURE: f32 = 1.0;
/// Both ways to read that are farther apart than this share of the figure do not agree.
const APART: f32 = 0.12;
/// Strokes that come nearer than this share of the drawing's height belong to one figure.
const ONE_FIGURE: f64 = 0.08;
/// Of two groups of strokes, the smaller is a figure of its own from this share of the other's height on.
const AS_TALL: f64 = 0.6;
/// The most points that groups of strokes are told apart by.
const SAMPLES: usize = 800;

/// What is known of a drawn figure. Places are canvas units.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The joints that were found; those that a drawing does not have (6, 9, 16, 17) are `None`.
    pub joints: [Option<Found>; JOINTS],
    /// How much likelier these sides of arms and of legs are than the other way round, as logarithms.
    pub sides: [f32; 2],
    /// All ways to tell left from right, the likeliest first; empty where nothing was read.
    pub alternatives: Vec<Alternative>,
    /// How far the lines' own reading is away, as a share of the figure, where there is one.
    pub lines_differ: Option<f32>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// One way to tell left from right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternative {
    /// What a frame has to say for it.
    pub sides: Sides,
    /// How likely the reader takes it to be, 0 to 1; all together are 1.
    pub share: f32,
}

impl Alternative {
    /// What people call it.
    pub fn name(&self) -> &'static str {
        match (self.sides.arms, self.sides.legs) {
            (SideChoice::Read, SideChoice::Read) => "as read",
            (SideChoice::Swapped, SideChoice::Read) => "arms swapped",
            (SideChoice::Read, SideChoice::Swapped) => "legs swapped",
            (SideChoice::Swapped, SideChoice::Swapped) => "mirrored",
        }
    }
}

/// All four, by how much likelier the sides of arms and of legs are than the other way round.
fn alternatives(arms: f32, legs: f32) -> Vec<Alternative> {
    let share = |odds: f32, side: SideChoice| match side {
        SideChoice::Read => 1.0 / (1.0 + (-odds).exp()),
        SideChoice::Swapped => 1.0 / (1.0 + odds.exp()),
    };
    let both = [SideChoice::Read, SideChoice::Swapped];
    let mut all: Vec<Alternative> = both
        .iter()
        .flat_map(|own| both.map(|other| Sides { arms: *own, legs: other }))
        .map(|sides| Alternative { sides, share: share(arms, sides.arms) * share(legs, sides.legs) })
        .collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}

/// Left and right joints of arms, and of legs.
const ARMS: [(usize, usize); 4] = [(13, 14), (16, 17), (18, 19), (20, 21)];
const LEGS: [(usize, usize); 4] = [(1, 2), (4, 5), (7, 8), (10, 11)];

/// A joint that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Canvas units.
    pub at: [f64; 2],
    /// How sure that is, 0 to 1.
    pub confidence: f32,
    /// Whether the user has said so.
    pub pinned: bool,
}

impl Figure {
    /// The same figure with left and right changed; pins stay.
    pub fn mirrored(&self) -> Self {
        let other = |joint: usize| {
            let name = NAMES.get(joint).copied().unwrap_or_default();
            let swapped = match name.split_once('_') {
                Some(("left", rest)) => format!("right_{rest}"),
                Some(("right", rest)) => format!("left_{rest}"),
                _ => name.to_owned(),
            };
            NAMES.iter().position(|name| *name == swapped).unwrap_or(joint)
        };
        let pinned = |joint: usize| self.joints[joint].filter(|found| found.pinned);
        let free = |joint: usize| self.joints[joint].filter(|found| !found.pinned);
        let joints = std::array::from_fn(|joint| pinned(joint).or_else(|| free(other(joint))));
        Self { joints, sides: self.sides.map(|side| -side), ..self.clone() }
    }

    /// Where a joint is.
    pub fn at(&self, joint: usize) -> Option<[f64; 2]> {
        self.joints.get(joint).copied().flatten().map(|found| found.at)
    }
}

/// Reads the figure of a frame (`number`, from 1). `None` where no body is drawn and nothing is pinned.
///
/// # Errors
/// When the drawing shows no figure or two, or pins cannot be.
pub fn read_figure(
    frame: &Frame,
    number: usize,
    reader: &SketchReader,
) -> Result<Option<Figure>, StoryboardError> {
    read(frame, reader).map_err(|problem| problem.of_frame(number))
}

fn read(frame: &Frame, reader: &SketchReader) -> Result<Option<Figure>, Problem> {
    let pins = pins(frame)?;
    let drawn = frame.body.iter().any(|stroke| stroke.points.len() > 1);
    if !drawn && pins.iter().all(Option::is_none) {
        return Ok(None);
    }
    let mut figure = Figure {
        joints: [None; JOINTS],
        sides: [0.0; 2],
        alternatives: Vec::new(),
        lines_differ: None,
        notes: Vec::new(),
    };
    if drawn {
        one_figure(&frame.body)?;
        let page = Page::of(&frame.body).ok_or_else(no_ink)?;
        let crop = crop(&page.ink, SIDE, MARGIN).ok_or_else(no_ink)?;
        let reading = reader.read(&crop.ink, &mut Work::default());
        for (point, &joint) in JOINT_OF_KEY_POINT.iter().enumerate() {
            if reading.drawn[point] > DRAWN {
                let at = page.on_canvas(crop.on_page(reading.places[point]));
                let confidence = reading.confidence[point];
                figure.joints[joint] = Some(Found { at, confidence, pinned: false });
            }
        }
        figure.sides = [reading.arms, reading.legs];
        figure.alternatives = alternatives(reading.arms, reading.legs);
        for (part, (pairs, choice)) in
            [(ARMS, frame.sides.arms), (LEGS, frame.sides.legs)].into_iter().enumerate()
        {
            if choice == SideChoice::Swapped {
                pairs.iter().for_each(|(left, right)| figure.joints.swap(*left, *right));
                figure.sides[part] = -figure.sides[part];
            }
        }
        figure.lines_differ = graph::read(&crop.ink).map(|lines| apart(&reading, &lines.places));
    }
    for (joint, at) in pins.iter().enumerate() {
        if let Some(at) = *at {
            figure.joints[joint] = Some(Found { at, confidence: 1.0, pinned: true });
        }
    }
    figure.judge(frame.sides)?;
    Ok(Some(figure))
}

fn no_ink() -> Problem {
    Problem::new("the body has no line", "Draw a figure, or pin its joints")
}

impl Figure {
    /// Says what is missing or not sure.
    fn judge(&mut self, said: Sides) -> Result<(), Problem> {
        let found = |joint: usize| self.joints[joint].is_some();
        let trunk = [0, 3, 12, 15].iter().filter(|joint| found(**joint)).count();
        let pelvis = found(0) || (found(1) && found(2));
        if !pelvis || trunk < 2 {
            return Err(Problem::new(
                "no figure can be read from the drawing: head, neck and pelvis are not found",
                "Draw a head, a trunk, arms and legs that hang together, or pin pelvis, neck and head",
            ));
        }
        let names = |some: &dyn Fn(usize) -> bool| {
            let chosen = JOINT_OF_KEY_POINT.into_iter().filter(|joint| some(*joint));
            chosen.filter_map(|joint| NAMES.get(joint).copied()).collect::<Vec<_>>().join(", ")
        };
        let mut notes = Vec::new();
        if ![4, 5, 7, 8].into_iter().any(found) {
            notes.push(
                "the figure has no legs: they move as the word says. Draw them, or pin left_ankle and right_ankle".into(),
            );
        }
        let unsure = names(&|joint| {
            self.joints[joint].is_some_and(|found| !found.pinned && found.confidence < UNSURE)
        });
        if !unsure.is_empty() {
            notes.push(format!("not sure of {unsure}: pin them where that matters"));
        }
        if let Some(share) = self.lines_differ.filter(|share| *share > APART) {
            notes.push(format!(
                "the figure's lines say otherwise, by {:.0} % of its size: look at the joints on the sheet",
                100.0 * share
            ));
        }
        let asked = [said.arms, said.legs].map(|choice| choice == SideChoice::Read);
        let unsure: Vec<&str> = ["arms", "legs"]
            .into_iter()
            .zip(self.sides.iter().zip(asked))
            .filter_map(|(what, (side, asked))| (asked && side.abs() < SURE).then_some(what))
            .collect();
        if !unsure.is_empty() && self.joints.iter().flatten().any(|found| !found.pinned) {
            let listed: Vec<String> = self
                .alternatives
                .iter()
                .map(|other| format!("{} {:.0} %", other.name(), 100.0 * other.share))
                .collect();
            notes.push(format!(
                "left and right of the {} can hardly be told ({}): where they are wrong, say \"sides\": {{\"{}\": \"swapped\"}} in the frame, or pin one of them",
                unsure.join(" and "),
                listed.join(", "),
                unsure.join("\": \"swapped\", \"")
            ));
        }
        self.notes = notes;
        Ok(())
    }
}

/// Joints that the user has placed.
fn pins(frame: &Frame) -> Result<[Option<[f64; 2]>; JOINTS], Problem> {
    let mut places: [Option<[f64; 2]>; JOINTS] = [None; JOINTS];
    for pin in &frame.pins {
        let joint = joint_named(&pin.joint)?;
        match places[joint] {
            Some(before) if before != pin.at => {
                return Err(Problem::new(
                    format!(
                        "{} is pinned to two places, ({}, {}) and ({}, {})",
                        pin.joint, before[0], before[1], pin.at[0], pin.at[1]
                    ),
                    "Leave one of them out",
                ));
            }
            _ => places[joint] = Some(pin.at),
        }
    }
    Ok(places)
}

/// Refuses a drawing of two figures that stand apart.
fn one_figure(strokes: &[Stroke]) -> Result<(), Problem> {
    let all: Vec<(usize, [f64; 2])> = strokes
        .iter()
        .enumerate()
        .flat_map(|(number, stroke)| stroke.points.iter().map(move |point| (number, *point)))
        .collect();
    let Some((low, high)) = bounds(all.iter().map(|(_, point)| point)) else { return Ok(()) };
    let near = ONE_FIGURE * (high[1] - low[1]);
    let sampled: Vec<&(usize, [f64; 2])> = all.iter().step_by(all.len().div_ceil(SAMPLES).max(1)).collect();
    // Each stroke's group is the least number of a stroke that it hangs together with.
    let mut group: Vec<usize> = (0..strokes.len()).collect();
    for (at, (a, here)) in sampled.iter().enumerate() {
        for (b, there) in sampled.iter().skip(at + 1) {
            let (one, other) = (group[*a], group[*b]);
            if one != other && distance(*here, *there) < near {
                let (least, most) = (one.min(other), one.max(other));
                group.iter_mut().filter(|own| **own == most).for_each(|own| *own = least);
            }
        }
    }
    let mut spans: Vec<Option<[f64; 2]>> = vec![None; strokes.len()];
    for (stroke, point) in &all {
        let span = spans[group[*stroke]].get_or_insert([point[1]; 2]);
        *span = [span[0].min(point[1]), span[1].max(point[1])];
    }
    let mut heights: Vec<f64> = spans.into_iter().flatten().map(|[low, high]| high - low).collect();
    heights.sort_by(|a, b| b.total_cmp(a));
    match heights[..] {
        [tallest, second, ..] if second > AS_TALL * tallest => Err(Problem::new(
            "the drawing shows two figures",
            "Leave one in body, and give the other a frame of its own or move its strokes to scene",
        )),
        _ => Ok(()),
    }
}

/// Mean distance of both readings as a share of the crop, left and right left open.
fn apart(reading: &Reading, lines: &[[f32; 2]; KEY_POINTS]) -> f32 {
    let off = |reading: &Reading| {
        let pairs = reading.places.iter().zip(lines).zip(&reading.drawn).filter(|(_, drawn)| **drawn > DRAWN);
        let (sum, count) = pairs.fold((0.0, 0.0_f32), |(sum, count), ((a, b), _)| {
            (sum + (a[0] - b[0]).hypot(a[1] - b[1]), count + 1.0)
        });
        sum / count.max(1.0) / SIDE as f32
    };
    off(reading).min(off(&reading.mirrored()))
}
