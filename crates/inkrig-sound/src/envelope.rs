//! A curve of one number a frame.

/// One number for each frame of a sound.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// The numbers, in order of time; frame `i` belongs to the time `i / rate_hz` seconds.
    pub values: Vec<f32>,
    /// Frames in a second.
    pub rate_hz: f64,
}
