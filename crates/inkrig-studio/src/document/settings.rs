//! How a result is made, and what is done to it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How a result is made, and what is done to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct Settings {
    /// What everything below begins with.
    pub preset: Preset,
    /// Weight of the control's structure against nearness to the clip, 0..1 (alpha).
    pub structure: Option<f64>,
    /// Weight of using all of the clip evenly (lambda).
    pub evenness: Option<f64>,
    /// How many source frames one frame may mix (epsilon).
    pub blend: Option<f64>,
    /// Other seeds find other solutions.
    pub seed: u64,
    /// What the control has alike on two sides changes places.
    pub mirror: bool,
    /// The result is a seamless loop.
    #[serde(rename = "loop")]
    pub cyclic: bool,
    /// Seconds; the control's own without.
    pub length: Option<f64>,
    /// How often the control is followed, at least 1.
    pub repeat: usize,
    /// Frames a second of what is exported; the clip's own without.
    pub fps: Option<f64>,
    /// Which of several solutions, 0 is the first.
    pub solution: usize,
    /// What carries the travel.
    pub root: RootMode,
    /// A path over the ground.
    pub path: Option<GroundPath>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            preset: Preset::Follow,
            structure: None,
            evenness: None,
            blend: None,
            seed: 0,
            mirror: false,
            cyclic: false,
            length: None,
            repeat: 1,
            fps: None,
            solution: 0,
            root: RootMode::Travel,
            path: None,
        }
    }
}

/// Presets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum Preset {
    /// The control's structure first.
    #[default]
    Follow,
    /// The clip's own poses first.
    Natural,
}

/// Ways to carry the travel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum RootMode {
    /// As it is.
    #[default]
    Travel,
    /// On the spot; sway, height and turning stay.
    InPlace,
    /// A root bone on the ground carries it.
    Bone,
    /// The hips carry it.
    Hips,
}

/// A path over the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "camelCase")]
pub enum GroundPath {
    /// Straight ahead.
    Straight,
    /// An arc to the left.
    Arc {
        /// Negative: to the right.
        degrees: f64,
    },
    /// The motion's own way, bent to the left.
    Bend {
        /// Negative: to the right.
        degrees: f64,
    },
    /// As seen from above: x to the right, y away from you.
    Drawn {
        /// In order.
        #[schema(value_type = Vec<(f64, f64)>)]
        points: Vec<[f64; 2]>,
        /// Whether its end is its beginning.
        #[serde(default)]
        closed: bool,
        /// Metres in a unit of the drawing; as long as the motion travels without.
        #[serde(default, rename = "metresPerUnit")]
        metres_per_unit: Option<f64>,
    },
}
