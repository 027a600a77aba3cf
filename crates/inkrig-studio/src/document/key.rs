//! Wishes for single poses, as the page says them.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One wish.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Key {
    /// Made by the page; unlike those of the others.
    pub id: String,
    /// Whether it counts.
    #[serde(default = "yes")]
    pub enabled: bool,
    /// What it wishes.
    pub kind: KeyKind,
    /// Where: for soft keys any, for hard ones a time, for others none.
    #[serde(default)]
    pub place: Option<Place>,
    /// Which pose: for all but fixed ones.
    #[serde(default)]
    pub pose: Option<PoseRef>,
    /// How much it counts: soft 0.5, avoid 1 without.
    #[serde(default)]
    pub weight: Option<f64>,
    /// Avoid: from here on a moment costs nothing, in mean distances of the clip's moments; 1 without.
    #[serde(default)]
    pub distance: Option<f64>,
    /// Never: moments nearer than this are left out too, in mean distances; 0.25 without.
    #[serde(default)]
    pub radius: Option<f64>,
    /// Fixed: what stays.
    #[serde(default)]
    pub fixed: Option<FixedPart>,
}

/// Kinds of wishes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum KeyKind {
    /// Near that place, near that pose.
    Soft,
    /// Exactly that pose at that time.
    Hard,
    /// Keep away from the pose.
    Avoid,
    /// Nothing like the pose.
    Never,
    /// A part of an earlier result stays.
    Fixed,
}

/// A place of the control.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "camelCase")]
pub enum Place {
    /// Where the control is at that time.
    Time {
        /// Since the beginning.
        seconds: f64,
    },
    /// A point of the canvas; it need not lie on the curve.
    Point {
        /// x, y
        #[schema(value_type = (f64, f64))]
        point: [f64; 2],
    },
    /// A value of a wave.
    Value {
        /// In the wave's unit.
        value: f64,
    },
    /// A label.
    Label {
        /// Its name.
        label: String,
    },
}

/// A frame of a clip.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PoseRef {
    /// Id of the clip.
    pub clip: String,
    /// From 0, at the clip's own rate.
    pub frame: usize,
}

/// A part of an earlier result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FixedPart {
    /// Id of the clip that holds the result.
    pub clip: String,
    /// Seconds.
    pub from: f64,
    /// Seconds.
    pub to: f64,
}

fn yes() -> bool {
    true
}
