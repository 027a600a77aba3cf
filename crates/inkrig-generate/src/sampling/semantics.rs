//! Where the paper and the published code say different things about a run.

use serde::{Deserialize, Serialize};

/// Which of the two holds. A model has to be run as it was trained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Semantics {
    /// The paper's text: for models that we train.
    #[default]
    Paper,
    /// The published code: for the weights that its authors published.
    Official,
}

impl Semantics {
    /// Whether a key pose is given relative to the place of its root above the ground (Eq. 8), or where it is.
    pub fn keypose_is_relative(self) -> bool {
        self == Self::Paper
    }

    /// Whether the trajectory's table holds all joints at the frame of the key pose.
    pub fn trajectory_holds_keypose(self) -> bool {
        self == Self::Official
    }

    /// Whether the prediction without text still sees the key pose (against Eq. 14).
    pub fn keypose_without_text(self) -> bool {
        self == Self::Official
    }

    /// Whether the key pose is added to the text that all networks see, once more at every step, or to the adapter's only.
    pub fn keypose_stays_in_text(self) -> bool {
        self == Self::Official
    }

    /// Whether the third number of a point on the picture, a constant 1, is normalised as a depth.
    pub fn depth_is_normalised(self) -> bool {
        self == Self::Official
    }

    /// Whether the loss of reconstruction compares latents without noise, of the last of the steps, or noise.
    pub fn reconstruction_of_latents(self) -> bool {
        self == Self::Official
    }
}
