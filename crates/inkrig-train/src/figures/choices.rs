//! What a drawing is made of: families of styles, trunks, limbs, hands, feet and faces.

/// Kinds of drawings. [`Family::Naive`] is never learned from: with its pen, its proportions and its hand together it stands for drawings of
/// people whom the reader has not met; one by one, [`Style::varied`](super::Style::varied) has nearly all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// One line a limb, as on a whiteboard.
    Stick,
    /// Thin searching lines, several over each other.
    Pencil,
    /// A thick even line.
    Marker,
    /// A line that swells and tapers, limbs as curves.
    Gesture,
    /// A jointed doll: ellipses, boxes and balls.
    Mannequin,
    /// Outlines of limbs that hide what is behind them.
    Outline,
    /// Bodies filled with ink or grey.
    Filled,
    /// A child's drawing; held out.
    Naive,
    /// Somebody with a body and clothes, as in a comic or a child's picture: outlines around wide trunks and limbs, a large head with a
    /// face and hair, hands with fingers, shoes.
    Character,
}

impl Family {
    /// Figures of an animator's storyboard, which are learned from. So is [`Family::Character`], apart from these.
    pub const LEARNED: [Self; 7] = [
        Self::Stick,
        Self::Pencil,
        Self::Marker,
        Self::Gesture,
        Self::Mannequin,
        Self::Outline,
        Self::Filled,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stick => "whiteboard sticks",
            Self::Pencil => "pencil",
            Self::Marker => "marker",
            Self::Gesture => "gesture",
            Self::Mannequin => "mannequin",
            Self::Outline => "outlines",
            Self::Filled => "filled bodies",
            Self::Naive => "a child's felt pen",
            Self::Character => "characters",
        }
    }
}

/// How the trunk is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Torso {
    /// A line along the spine.
    Line,
    /// An ellipse.
    Ellipse,
    /// Four corners.
    Box,
    /// A rounded outline with a waist.
    Bean,
    /// Chest and pelvis apart, with a line between.
    TwoMasses,
}

/// How arms and legs are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limbs {
    /// One stroke with a corner at the joint.
    Line,
    /// One stroke without a corner.
    Curve,
    /// A stroke for each bone.
    Segments,
    /// An outline for each bone.
    Capsules,
    /// One outline around both bones, open where it meets the body.
    Tubes,
}

/// How hands are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hands {
    /// Not at all.
    None,
    /// A small ball.
    Ball,
    /// A few strokes.
    Fingers,
    /// A palm with fingers, all outlined.
    Palm,
}

/// How feet are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feet {
    /// Not at all: the toes cannot be read.
    None,
    /// A stroke.
    Line,
    /// A closed wedge or ellipse.
    Wedge,
}

/// What is on the head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    /// Nothing.
    None,
    /// A nose that says where it looks.
    Nose,
    /// The cross that animators draw.
    Cross,
    /// Eyes and a mouth.
    Eyes,
    /// Hair at the back and on top.
    Hair,
}
