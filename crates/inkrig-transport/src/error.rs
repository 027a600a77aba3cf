use thiserror::Error;

/// What can be wrong with the inputs of this crate. Nothing here panics on data from outside.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TransportError {
    /// The length of a buffer is not the product of the stated rows and columns.
    #[error(
        "a {rows} x {cols} matrix needs {rows} * {cols} values, got {len}; pass the shape the data really has"
    )]
    Length {
        /// Stated rows.
        rows: usize,
        /// Stated columns.
        cols: usize,
        /// Values given.
        len: usize,
    },
    /// A matrix has another shape than its place in the problem asks for.
    #[error("`{name}` is {rows} x {cols}, expected {expected_rows} x {expected_cols}; {hint}")]
    Shape {
        /// The argument.
        name: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        cols: usize,
        /// Rows it should have.
        expected_rows: usize,
        /// Columns it should have.
        expected_cols: usize,
        /// What to do.
        hint: &'static str,
    },
    /// A matrix has no rows or no columns.
    #[error("`{name}` is empty; a problem needs at least one control point and one source point")]
    Empty {
        /// The argument.
        name: &'static str,
    },
    /// A value is not finite, negative, or so large that its square could overflow.
    #[error(
        "`{name}` holds {value} at row {row}, column {col}; values must lie between 0 and 1e6: \
         divide distances by their mean or maximum"
    )]
    Value {
        /// The argument.
        name: &'static str,
        /// Row of the first bad value.
        row: usize,
        /// Column of the first bad value.
        col: usize,
        /// The value.
        value: f64,
    },
    /// A linear cost is not finite or too large.
    #[error("`{name}` holds {value} at row {row}, column {col}; values must lie between -1e6 and 1e6")]
    Bias {
        /// The argument.
        name: &'static str,
        /// Row of the first bad value.
        row: usize,
        /// Column of the first bad value.
        col: usize,
        /// The value.
        value: f64,
    },
    /// A distance matrix is not symmetric, or its diagonal is not zero.
    #[error(
        "`{name}` is not a self-distance matrix: {value} at row {row}, column {col}, expected {expected}; \
         it must be symmetric with a zero diagonal"
    )]
    Distance {
        /// The argument.
        name: &'static str,
        /// Row of the first bad value.
        row: usize,
        /// Column of the first bad value.
        col: usize,
        /// The value.
        value: f64,
        /// The mirrored entry, or 0 on the diagonal.
        expected: f64,
    },
    /// A parameter is out of its range.
    #[error("`{name}` is {value}; it must be {range}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range in words.
        range: &'static str,
    },
    /// `alpha < 1` weighs a cost that was not given.
    #[error("alpha is {alpha} but there is no cost matrix; give one, or set alpha to 1")]
    MissingCost {
        /// The weight given.
        alpha: f64,
    },
    /// `Start::Continue` was asked of a workspace that holds no plan of this shape.
    #[error(
        "cannot continue: the workspace holds a {have_rows} x {have_cols} plan and the problem is {rows} x {cols}; \
         solve once with Start::Independent first"
    )]
    NothingToContinue {
        /// Rows of the plan in the workspace, 0 when there is none.
        have_rows: usize,
        /// Columns of the plan in the workspace, 0 when there is none.
        have_cols: usize,
        /// Rows of the problem.
        rows: usize,
        /// Columns of the problem.
        cols: usize,
    },
    /// A mask names a row or a column that the problem has not.
    #[error("the mask names {what} {index}, the problem has {count}; count from 0")]
    MaskIndex {
        /// "row" or "column".
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A mask fixes one row on two columns.
    #[error("the mask fixes row {row} on column {first} and on column {second}; keep one of them")]
    FixedTwice {
        /// The row.
        row: usize,
        /// The column named first.
        first: usize,
        /// The other column.
        second: usize,
    },
    /// A mask fixes a row on a column that it forbids.
    #[error("the mask fixes row {row} on column {col}, which it also forbids; drop one of the two")]
    FixedOnForbidden {
        /// The row.
        row: usize,
        /// The column.
        col: usize,
    },
    /// No column is left for a row.
    #[error("no column is left for row {row}: every column it may use is forbidden; forbid fewer")]
    NoColumn {
        /// The first such row.
        row: usize,
    },
}
