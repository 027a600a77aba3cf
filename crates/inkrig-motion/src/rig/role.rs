//! Parts of a body and the words for them.

use super::words::{Words, words};

/// A side of the body, its own: the left hand is on the left of the one whose hand it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// Both, the left one first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// The side of a word such as `l`, `left` or `rgt`.
    pub(super) fn of_word(word: &str) -> Option<Self> {
        match word {
            "l" | "left" | "lft" | "lf" => Some(Self::Left),
            "r" | "right" | "rgt" | "rt" => Some(Self::Right),
            _ => None,
        }
    }
}

/// A part of a two-legged body. Those from [`Self::Clavicle`] on come in pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// Where legs and spine meet.
    Hips,
    /// A joint between hips and neck.
    Spine,
    /// Between the uppermost spine joint and the head.
    Neck,
    /// At the base of the skull.
    Head,
    /// The collar bone.
    Clavicle,
    /// From shoulder to elbow.
    UpperArm,
    /// From elbow to wrist.
    LowerArm,
    /// From the wrist on.
    Hand,
    /// From hip to knee.
    UpperLeg,
    /// From knee to ankle.
    LowerLeg,
    /// From the ankle on.
    Foot,
    /// From the ball of the foot on.
    Toes,
}

/// What a name says that its joint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Said {
    pub(super) part: Part,
    pub(super) side: Option<Side>,
    /// The word means one thing in some skeletons and another in others; see [`Ambiguous`].
    pub(super) ambiguous: Option<Ambiguous>,
}

/// Words that need a look at the rest of the skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ambiguous {
    /// `shoulder`: a collar bone where there is another word for the upper arm, else the upper arm.
    Shoulder,
    /// `leg`: a shin where there is another word for the thigh, else a thigh.
    Leg,
}

/// What a joint's name says; nothing for helpers, fingers, faces and words that are not known.
pub(super) fn said(name: &str) -> Option<Said> {
    let read = words(name);
    if read.helper {
        return None;
    }
    // Some put the side before the word without any mark: lfemur, rtibia.
    plain(&read).or_else(|| {
        let side = match read.text.chars().next()? {
            'l' => Side::Left,
            'r' => Side::Right,
            _ => return None,
        };
        if read.side.is_some() {
            return None;
        }
        let rest = Words { text: read.text.get(1..)?.to_string(), side: Some(side), ..read.clone() };
        plain(&rest)
    })
}

fn plain(read: &Words) -> Option<Said> {
    let (part, ambiguous) = match read.text.as_str() {
        "hips" | "pelvis" | "cog" => (Part::Hips, None),
        // `hip` in the middle is the hips, at a side the beginning of a leg.
        "hip" if read.side.is_none() => (Part::Hips, None),
        "spine" | "lowerback" | "upperback" | "thorax" | "abdomen" | "chest" | "upperchest" | "torso"
        | "waist" | "tospine" | "ribcage" | "back" | "belly" | "abdomenlower" | "abdomenupper"
        | "chestlower" | "chestupper" => (Part::Spine, None),
        "neck" | "lowerneck" | "upperneck" | "necklower" | "neckupper" => (Part::Neck, None),
        "head" => (Part::Head, None),
        "clavicle" | "collar" | "clav" | "collarbone" => (Part::Clavicle, None),
        "shoulder" => (Part::Clavicle, Some(Ambiguous::Shoulder)),
        "arm" | "upperarm" | "uparm" | "shldr" | "humerus" | "shldrbend" | "armupper" => {
            (Part::UpperArm, None)
        }
        "forearm" | "lowerarm" | "lowarm" | "elbow" | "radius" | "forearmbend" | "armlower" => {
            (Part::LowerArm, None)
        }
        "hand" | "wrist" => (Part::Hand, None),
        "upleg" | "upperleg" | "thigh" | "femur" | "hip" | "thighbend" | "legupper" => (Part::UpperLeg, None),
        "leg" => (Part::LowerLeg, Some(Ambiguous::Leg)),
        "lowerleg" | "lowleg" | "shin" | "calf" | "tibia" | "knee" | "leglower" => (Part::LowerLeg, None),
        "foot" | "ankle" => (Part::Foot, None),
        "toe" | "toes" | "toebase" | "ball" => (Part::Toes, None),
        _ => return None,
    };
    let paired = part >= Part::Clavicle;
    (paired == read.side.is_some()).then_some(Said { part, side: read.side, ambiguous })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_many_programs_name_the_same_parts() {
        let left = Some(Side::Left);
        for name in
            ["LeftUpLeg", "thigh_l", "L_Thigh", "lfemur", "left_hip", "UpperLeg.L", "lThigh", "DEF-thigh.L"]
        {
            assert_eq!(said(name).map(|said| (said.part, said.side)), Some((Part::UpperLeg, left)), "{name}");
        }
        for name in ["Hips", "pelvis", "hip", "mixamorig:Hips", "Bip01 Pelvis"] {
            assert_eq!(said(name).map(|said| said.part), Some(Part::Hips), "{name}");
        }
        for name in
            ["LHipJoint", "LeftHandIndex1", "lThumb2", "leftEye", "upperarm_twist_01_l", "Hand", "handslot.l"]
        {
            assert_eq!(said(name), None, "{name}");
        }
        assert_eq!(said("LeftShoulder").unwrap().ambiguous, Some(Ambiguous::Shoulder));
    }
}
