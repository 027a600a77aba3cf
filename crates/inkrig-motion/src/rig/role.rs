//! Parts of a body and the words for them.

use super::words::Words;
#[cfg(test)]
use super::words::{tokens, words};

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
    /// `hip joint`: nothing where there is another word for the thigh, else a thigh.
    HipJoint,
}

/// What a joint's name says; nothing for helpers, fingers, faces and words that are not known.
#[cfg(test)]
pub(super) fn said(name: &str) -> Option<Said> {
    said_by(&words(tokens(name)))
}

/// What the words of a name say.
pub(super) fn said_by(read: &Words) -> Option<Said> {
    if read.helper {
        return None;
    }
    // Some put the side before the word without any mark: lfemur, rtibia.
    plain(read).or_else(|| plain(&side_before(read)?))
}

/// Which limb a twist joint belongs to.
pub(super) fn twist_of(read: &Words) -> Option<(Part, Side)> {
    if !read.twist {
        return None;
    }
    let bare = Words { twist: false, helper: false, ..read.clone() };
    // Biped has `ForeTwist` for the forearm.
    if bare.text == "fore" {
        return Some((Part::LowerArm, bare.side?));
    }
    let found = said_by(&bare)?;
    Some((found.part, found.side?))
}

fn side_before(read: &Words) -> Option<Words> {
    let side = match read.text.chars().next()? {
        'l' => Side::Left,
        'r' => Side::Right,
        _ => return None,
    };
    if read.side.is_some() {
        return None;
    }
    Some(Words { text: read.text.get(1..)?.to_string(), side: Some(side), ..read.clone() })
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
        "clavicle" | "collar" | "clav" | "collarbone" | "scapula" | "shoulderblade" => (Part::Clavicle, None),
        "shoulder" => (Part::Clavicle, Some(Ambiguous::Shoulder)),
        "arm" | "upperarm" | "uparm" | "shldr" | "humerus" | "shldrbend" | "armupper" => {
            (Part::UpperArm, None)
        }
        "forearm" | "lowerarm" | "lowarm" | "elbow" | "radius" | "forearmbend" | "armlower" => {
            (Part::LowerArm, None)
        }
        "hand" | "wrist" => (Part::Hand, None),
        "upleg" | "upperleg" | "thigh" | "femur" | "hip" | "thighbend" | "legupper" => (Part::UpperLeg, None),
        "hipjoint" => (Part::UpperLeg, Some(Ambiguous::HipJoint)),
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
        for name in ["LeftHandIndex1", "lThumb2", "leftEye", "upperarm_twist_01_l", "Hand", "handslot.l"] {
            assert_eq!(said(name), None, "{name}");
        }
        assert_eq!(said("LeftShoulder").unwrap().ambiguous, Some(Ambiguous::Shoulder));
        assert_eq!(said("LHipJoint").unwrap().ambiguous, Some(Ambiguous::HipJoint));
        let twist = |name: &str| twist_of(&words(tokens(name)));
        assert_eq!(twist("upperarm_twist_01_l"), Some((Part::UpperArm, Side::Left)));
        assert_eq!(twist("Bip001 R ForeTwist1"), Some((Part::LowerArm, Side::Right)));
        assert_eq!(twist("LeftForeArmRoll"), Some((Part::LowerArm, Side::Left)));
        assert_eq!(twist("LeftForeArm"), None);
    }
}
