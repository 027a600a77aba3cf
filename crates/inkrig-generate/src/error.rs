//! Why a model could not be read or used.

/// What stood in the way, and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// A tensor's numbers do not fill its shape.
    #[error("the tensor {name} has {got} numbers, but its shape {shape:?} needs {expected}")]
    TensorLength {
        /// Its name.
        name: String,
        /// Its shape.
        shape: Vec<usize>,
        /// The product of the shape.
        expected: usize,
        /// How many numbers there are.
        got: usize,
    },
    /// A tensor that a network needs is not there.
    #[error("the model has no tensor {name}: it is not a model for this configuration")]
    MissingTensor {
        /// The name that was looked for.
        name: String,
    },
    /// A tensor has a shape that the network cannot use.
    #[error(
        "the tensor {name} is {got:?}, but this configuration needs {expected:?}: choose the configuration that the model was made with"
    )]
    TensorShape {
        /// Its name.
        name: String,
        /// What the configuration says.
        expected: Vec<usize>,
        /// What the model has.
        got: Vec<usize>,
    },
    /// A table that has another length than it needs.
    #[error("the {what} has {got} numbers, but needs {expected}")]
    Length {
        /// What it is.
        what: &'static str,
        /// Numbers that are needed.
        expected: usize,
        /// Numbers that were given.
        got: usize,
    },
    /// A table without rows, with too many, or with a broken one.
    #[error("the {what}: {numbers} numbers are not 1 to {most} rows of {width}")]
    Rows {
        /// What it is.
        what: &'static str,
        /// Numbers that were given.
        numbers: usize,
        /// Numbers of a row.
        width: usize,
        /// Rows that are possible.
        most: usize,
    },
    /// Clips of one run that have different kinds of conditions.
    #[error(
        "clips that are generated at once must all have a trajectory or none, a key pose or none, and be drawn in space or all on the picture: generate the others in a run of their own"
    )]
    MixedConditions,
    /// A configuration that cannot be read.
    #[error("the configuration cannot be read: {reason}")]
    Configuration {
        /// What and where.
        reason: String,
    },
    /// A motion that has no features, or features that are none.
    #[error(transparent)]
    Motion(#[from] inkrig_motion::MotionError),
    /// A description in which no action is known.
    #[error("no action that the model knows is in {text:?}; near ones are: {near}")]
    Words {
        /// The description.
        text: String,
        /// What is spelled most like it.
        near: String,
    },
    /// A setting that makes no sense.
    #[error("{setting} is {value}, but must be {needed}")]
    Setting {
        /// What was set.
        setting: &'static str,
        /// What to.
        value: String,
        /// What is possible.
        needed: &'static str,
    },
    /// Nothing to train on.
    #[error("no {kind} device is there: install its driver, or train on another device")]
    NoDevice {
        /// The kind that was asked for.
        kind: String,
    },
    /// A device that stopped working.
    #[error("the device that is trained on gave up: {reason}")]
    Device {
        /// In its driver's words.
        reason: String,
    },
}
