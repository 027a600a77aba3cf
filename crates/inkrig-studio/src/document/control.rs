//! What the motion shall follow.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A sample of the pen: x, y (canvas units, y up), seconds, pressure 0..1; the last two where they are known.
pub type PenPoint = (f64, f64, Option<f64>, Option<f64>);

/// What the motion shall follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub enum Control {
    /// A drawing.
    Curve {
        /// Strokes of points `[x, y, t, p]`; t runs on one clock over all strokes and never goes back.
        #[schema(value_type = Vec<Vec<(f64, f64, Option<f64>, Option<f64>)>>)]
        strokes: Vec<Vec<PenPoint>>,
        /// Whether the pen's speed is the motion's timing.
        #[serde(default)]
        timing: CurveTiming,
        /// Standard deviation of the smoothing in samples; the program's own without.
        #[serde(default)]
        smooth: Option<f64>,
    },
    /// A wave as an expression.
    Wave {
        /// `sine(0.5Hz..2Hz) for 10s`
        expression: String,
    },
    /// A wave as it was drawn.
    DrawnWave {
        /// Seconds, rising, and values.
        #[schema(value_type = Vec<(f64, f64)>)]
        points: Vec<[f64; 2]>,
    },
    /// Movements by name.
    Labels {
        /// In order.
        segments: Vec<LabelSegment>,
    },
    /// Music or speech.
    Sound {
        /// Its id.
        sound: String,
        /// Standard deviation of the smoothing in samples; the program's own without.
        #[serde(default)]
        smooth: Option<f64>,
        /// Follow its plain wave, not what is heard.
        #[serde(default)]
        outline: bool,
    },
    /// Another motion, of any skeleton.
    Motion {
        /// Its id.
        clip: String,
    },
}

/// How the way along a drawing becomes time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum CurveTiming {
    /// As it was drawn.
    #[default]
    Pen,
    /// Constant speed.
    Even,
}

/// A stretch of time with a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LabelSegment {
    /// Equal names are the same movement.
    pub name: String,
    /// Its length.
    pub seconds: f64,
    /// `#rrggbb`, for the page.
    #[serde(default)]
    pub colour: Option<String>,
}

impl Control {
    /// All pen points.
    pub fn point_count(&self) -> usize {
        match self {
            Self::Curve { strokes, .. } => strokes.iter().map(Vec::len).sum(),
            Self::DrawnWave { points } => points.len(),
            Self::Labels { segments } => segments.len(),
            _ => 0,
        }
    }
}
