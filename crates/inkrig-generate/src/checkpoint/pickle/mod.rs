//! The part of Python's pickle language that files of weights need.
//!
//! A pickle is a program. This machine knows numbers, text, lists, tuples, dictionaries and the few names by which PyTorch
//! describes tensors; it has no way to run anything. Whatever else a pickle names is refused, by that name, where it names it.
//! Values lie in one table and refer to one another by number, so that nothing is nested, nothing is copied, and what a
//! pickle can make us hold is a small multiple of its length.

mod known;
mod machine;
mod opcodes;
mod tensors;

pub(super) use known::Known;
pub(super) use machine::{Pickle, run};
pub(super) use tensors::{Storage, Strided};

/// The number of a value.
pub(super) type Id = u32;

/// Bytes of a pickle that is read; with an optimiser's state a published model's has about one million.
pub(super) const MOST_BYTES: u64 = 4 << 20;

/// What a pickle can build.
#[derive(Debug, Clone)]
pub(super) enum Value<'a> {
    Nothing,
    Truth,
    Whole(i64),
    Float,
    Text(&'a str),
    Raw,
    /// Tuples, lists and sets: no one here needs to tell them apart.
    List(Vec<Id>),
    Map(Vec<[Id; 2]>),
    Known(Known),
    Storage(Box<Storage<'a>>),
    Tensor(Box<Strided<'a>>),
}

impl Value<'_> {
    /// What it is, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Truth => "a truth value",
            Self::Whole(_) => "a whole number",
            Self::Float => "a number",
            Self::Text(_) => "text",
            Self::Raw => "bytes",
            Self::List(_) => "a list",
            Self::Map(_) => "a dictionary",
            Self::Known(_) => "a name",
            Self::Storage(_) => "a storage",
            Self::Tensor(_) => "a tensor",
        }
    }
}
