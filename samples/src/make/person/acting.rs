//! What the body does besides stepping, as numbers.

/// What the body does besides stepping, at one time. Angles in radians, lengths in metres; left and up count up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Acting {
    /// How far the hips sink.
    pub(crate) crouch: f64,
    /// How far the hips move to the left, and ahead, over the feet.
    pub(crate) sway: [f64; 2],
    /// How far both heels rise.
    pub(crate) heels: f64,
    /// Lean of the trunk: ahead, to the left, turned to the left.
    pub(crate) trunk: [f64; 3],
    /// Head against the trunk's heading: nod down, tilt to the left, turn to the left.
    pub(crate) head: [f64; 3],
    /// How much of the walking swing the arms keep, and what they do instead; left first.
    pub(crate) arms: [(f64, Arm); 2],
}

/// The pose of an arm, radians. All 0 hangs straight down with the palm to the body.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Arm {
    /// Forward.
    pub(crate) flex: f64,
    /// Out to the side.
    pub(crate) abduct: f64,
    /// The upper arm turned outward about itself.
    pub(crate) twist: f64,
    /// Bend of the elbow.
    pub(crate) elbow: f64,
    /// The palm turned to the back.
    pub(crate) pronate: f64,
    /// The hand bent to the thumb's side, and to the palm's.
    pub(crate) wrist: [f64; 2],
}

impl Arm {
    /// `part` of the way to `other`.
    pub(crate) fn mix(self, other: Self, part: f64) -> Self {
        let mix = |a: f64, b: f64| a + part * (b - a);
        Self {
            flex: mix(self.flex, other.flex),
            abduct: mix(self.abduct, other.abduct),
            twist: mix(self.twist, other.twist),
            elbow: mix(self.elbow, other.elbow),
            pronate: mix(self.pronate, other.pronate),
            wrist: [mix(self.wrist[0], other.wrist[0]), mix(self.wrist[1], other.wrist[1])],
        }
    }
}
