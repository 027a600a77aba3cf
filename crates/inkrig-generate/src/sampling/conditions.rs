//! What a clip is asked for, as the networks take it.

use super::Semantics;
use crate::GenerateError;
use crate::guidance::{Ask, Target, View};
use crate::networks::Domain;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, Statistics};

/// Numbers of a frame: 22 joints, three each.
const POSE: usize = 3 * JOINTS;

/// Conditions in metres. On the picture x is to the right and y up, and z of no consequence.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Frames of the clip, 20 a second.
    pub frames: usize,
    /// The text's vector, as long as the model's `text_width`.
    pub text: Vec<f32>,
    /// Space, or the picture of a camera.
    pub view: View,
    /// Where joints shall be.
    pub trajectory: Vec<Ask>,
    /// Which pose the clip shall have at which frame. Its joints are [augmented](inkrig_motion::humanml::augment) ones.
    pub keypose: Option<(usize, Joints)>,
}

/// A [`Request`] in the networks' numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditions {
    pub(crate) frames: usize,
    pub(crate) text: Vec<f32>,
    pub(crate) domain: Domain,
    pub(crate) trajectory: Vec<(usize, Vec<f32>)>,
    pub(crate) keypose: Option<(usize, Vec<f32>)>,
    pub(crate) target: Target,
    /// What guidance follows, where that is more than the trajectory.
    pub(crate) guide: Option<Target>,
    /// The key pose in metres.
    pub(crate) pose: Option<(usize, Joints)>,
}

impl Conditions {
    /// Normalises a request; `spatial` are statistics of 66 numbers, places of joints.
    ///
    /// # Errors
    /// When the statistics are not of 66 numbers, there is no frame, or something is asked for beyond the clip.
    pub fn new(request: &Request, spatial: &Statistics, semantics: Semantics) -> Result<Self, GenerateError> {
        let outside = |setting, value: usize, needed| GenerateError::Setting {
            setting,
            value: value.to_string(),
            needed,
        };
        if spatial.mean().len() != POSE {
            let (what, got) = ("statistics of places", spatial.mean().len());
            return Err(GenerateError::Length { what, expected: POSE, got });
        }
        if request.frames == 0 {
            return Err(outside("the number of frames", 0, "at least 1"));
        }
        if let Some(ask) =
            request.trajectory.iter().find(|ask| ask.frame >= request.frames || ask.joint >= JOINTS)
        {
            return Err(outside(
                "a trajectory's frame",
                ask.frame,
                "before the clip's end, for a joint from 0 to 21",
            ));
        }
        let domain = if request.view == View::Space { Domain::Space } else { Domain::Plane };
        let rows = Rows { spatial, domain, semantics };
        let mut trajectory: Vec<(usize, Vec<f32>)> = Vec::new();
        let mut asks = request.trajectory.clone();
        if let (Some((frame, pose)), true) = (&request.keypose, semantics.trajectory_holds_keypose()) {
            asks.extend(pose.iter().enumerate().map(|(joint, &place)| Ask { frame: *frame, joint, place }));
        }
        asks.sort_by_key(|ask| ask.frame);
        for ask in &asks {
            if trajectory.last().is_none_or(|(frame, _)| *frame != ask.frame) {
                trajectory.push((ask.frame, vec![0.0; POSE]));
            }
            if let Some((_, row)) = trajectory.last_mut() {
                rows.set(row, ask.joint, ask.place);
            }
        }
        let keypose = match &request.keypose {
            Some((frame, _)) if *frame >= request.frames => {
                return Err(outside("the key pose's frame", *frame, "before the clip's end"));
            }
            Some((frame, pose)) => Some((*frame, rows.keypose(pose))),
            None => None,
        };
        let pose = request.keypose;
        let target = Target { view: request.view, asks: request.trajectory.clone(), depths: Vec::new() };
        let (frames, text) = (request.frames, request.text.clone());
        Ok(Self { frames, text, domain, trajectory, keypose, target, guide: None, pose })
    }

    /// From tables that are normalised already: frames x 66 each, zeros where nothing is asked for.
    ///
    /// # Errors
    /// When a row is not of 66 numbers.
    pub fn from_tables(
        frames: usize,
        text: Vec<f32>,
        domain: Domain,
        trajectory: Vec<(usize, Vec<f32>)>,
        keypose: Option<(usize, Vec<f32>)>,
        target: Target,
    ) -> Result<Self, GenerateError> {
        match trajectory.iter().chain(&keypose).find(|(_, row)| row.len() != POSE) {
            Some((_, row)) => {
                Err(GenerateError::Length { what: "row of a condition", expected: POSE, got: row.len() })
            }
            None => Ok(Self { frames, text, domain, trajectory, keypose, target, guide: None, pose: None }),
        }
    }

    /// The same, with how far away joints shall be, see [`Target::depths`].
    pub fn at_depths(mut self, depths: &[Ask]) -> Self {
        self.target.depths = depths.to_vec();
        if let Some(guide) = &mut self.guide {
            guide.depths = depths.to_vec();
        }
        self
    }

    /// The same, with another target for guidance: one that has joints of the key pose too, say.
    pub fn guided_to(self, target: Target) -> Self {
        Self { guide: Some(target), ..self }
    }

    /// The frames of the trajectory that ask for something, with 66 normalised numbers each.
    pub fn trajectory(&self) -> &[(usize, Vec<f32>)] {
        &self.trajectory
    }

    /// The frame of the key pose, and its 66 normalised numbers.
    pub fn keypose(&self) -> Option<&(usize, Vec<f32>)> {
        self.keypose.as_ref()
    }

    /// Whether both have the same kinds of conditions, so that they can be run at once.
    pub(crate) fn alike(&self, other: &Self) -> bool {
        self.domain == other.domain
            && self.trajectory.is_empty() == other.trajectory.is_empty()
            && self.keypose.is_some() == other.keypose.is_some()
    }
}

struct Rows<'a> {
    spatial: &'a Statistics,
    domain: Domain,
    semantics: Semantics,
}

impl Rows<'_> {
    fn set(&self, row: &mut [f32], joint: usize, place: Vec3) {
        let numbers = match self.domain {
            Domain::Space => place.to_array(),
            Domain::Plane => [place.x, place.y, 1.0],
        };
        let (mean, deviation) = (self.spatial.mean(), self.spatial.deviation());
        for (axis, number) in numbers.into_iter().enumerate() {
            let at = 3 * joint + axis;
            let plain = self.domain == Domain::Plane && axis == 2 && !self.semantics.depth_is_normalised();
            row[at] = if plain { number } else { (number - mean[at]) / deviation[at] };
        }
    }

    fn keypose(&self, pose: &Joints) -> Vec<f32> {
        let mut row = vec![0.0; POSE];
        let root = match (self.semantics.keypose_is_relative(), self.domain) {
            (false, _) => Vec3::ZERO,
            (true, Domain::Space) => Vec3::new(pose[0].x, 0.0, pose[0].z),
            (true, Domain::Plane) => Vec3::new(pose[0].x, 0.0, 0.0),
        };
        for (joint, &place) in pose.iter().enumerate() {
            self.set(&mut row, joint, place - root);
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::humanml::Camera;

    fn request(view: View) -> Request {
        let pose: Joints = std::array::from_fn(|joint| Vec3::new(1.0, 0.1 * joint as f32, 2.0));
        let ask = |frame| Ask { frame, joint: 5, place: Vec3::new(3.0, 2.0, 1.0) };
        let trajectory = vec![ask(4), ask(2)];
        Request { frames: 10, text: vec![0.0; 4], view, trajectory, keypose: Some((3, pose)) }
    }

    #[test]
    fn conditions_differ_between_paper_and_code_as_they_should() {
        let spatial = Statistics::new(vec![1.0; POSE], vec![2.0; POSE]).unwrap();
        let paper = Conditions::new(&request(View::Space), &spatial, Semantics::Paper).unwrap();
        let frames =
            |conditions: &Conditions| conditions.trajectory.iter().map(|row| row.0).collect::<Vec<_>>();
        assert_eq!(frames(&paper), [2, 4]);
        assert_eq!(paper.trajectory[0].1[15..18], [1.0, 0.5, 0.0]);
        assert_eq!(paper.keypose.as_ref().unwrap().1[..3], [-0.5, -0.5, -0.5]);
        let official = Conditions::new(&request(View::Space), &spatial, Semantics::Official).unwrap();
        assert_eq!(frames(&official), [2, 3, 4]);
        assert_eq!(official.keypose.as_ref().unwrap().1[..3], [0.0, -0.5, 0.5]);

        let plane = View::Plane(Camera::default());
        let depth =
            |semantics| Conditions::new(&request(plane), &spatial, semantics).unwrap().trajectory[0].1[17];
        assert_eq!((depth(Semantics::Paper), depth(Semantics::Official)), (1.0, 0.0));
    }

    #[test]
    fn what_lies_beyond_the_clip_is_refused() {
        let spatial = Statistics::new(vec![1.0; POSE], vec![2.0; POSE]).unwrap();
        let short = Request { frames: 4, ..request(View::Space) };
        assert!(Conditions::new(&short, &spatial, Semantics::Paper).is_err());
        let short = Request { frames: 3, trajectory: Vec::new(), ..request(View::Space) };
        assert!(Conditions::new(&short, &spatial, Semantics::Paper).is_err());
        let narrow = Statistics::new(vec![1.0; 3], vec![2.0; 3]).unwrap();
        assert!(Conditions::new(&request(View::Space), &narrow, Semantics::Paper).is_err());
    }
}
