//! How PyTorch describes a tensor: a storage, which lies in a file of its own beside the pickle, and steps through it.

use super::{Id, Known, Pickle, Value};
use crate::checkpoint::number::NumberKind;

/// Axes of a tensor.
const MOST_AXES: usize = 8;

/// Numbers in a row.
#[derive(Debug, Clone, Copy)]
pub(in crate::checkpoint) struct Storage<'a> {
    pub(in crate::checkpoint) kind: NumberKind,
    /// The name of its file.
    pub(in crate::checkpoint) key: &'a str,
    /// How many numbers it has.
    pub(in crate::checkpoint) numbers: u64,
}

/// A table in a storage. No number of it lies outside.
#[derive(Debug, Clone)]
pub(in crate::checkpoint) struct Strided<'a> {
    pub(in crate::checkpoint) storage: Storage<'a>,
    /// The number of the storage that comes first.
    pub(in crate::checkpoint) start: u64,
    /// How long its axes are.
    pub(in crate::checkpoint) shape: Vec<usize>,
    /// How far the storage is gone on for the next along each axis.
    pub(in crate::checkpoint) strides: Vec<u64>,
}

impl<'a> Pickle<'a> {
    /// `('storage', torch.FloatStorage, '17', 'cpu', 65536)`
    pub(super) fn storage(&self, id: Id) -> Result<Storage<'a>, String> {
        let Value::List(parts) = self.get(id) else {
            return Err("a storage is described by no tuple".into());
        };
        let parts: Vec<&Value<'a>> = parts.iter().take(8).map(|id| self.get(*id)).collect();
        match parts[..] {
            [
                Value::Text("storage"),
                Value::Known(Known::Storage(kind)),
                Value::Text(key),
                Value::Text(_),
                Value::Whole(numbers),
            ] => {
                let numbers =
                    u64::try_from(*numbers).map_err(|_| format!("a storage has {numbers} numbers"))?;
                Ok(Storage { kind: *kind, key, numbers })
            }
            _ => Err("a storage is not described by kind, name, place and length".into()),
        }
    }

    /// `(storage, first, shape, strides, ...)`, checked against its storage.
    pub(super) fn tensor(&self, arguments: &[Id]) -> Result<Strided<'a>, String> {
        let parts: Vec<&Value<'a>> = arguments.iter().take(4).map(|id| self.get(*id)).collect();
        let [Value::Storage(storage), Value::Whole(start), Value::List(shape), Value::List(strides)] =
            parts[..]
        else {
            return Err("a tensor is not described by storage, start, shape and strides".into());
        };
        let (shape, strides) = (self.wholes(shape)?, self.wholes(strides)?);
        let start = u64::try_from(*start).map_err(|_| format!("a tensor starts at number {start}"))?;
        if shape.len() != strides.len() {
            return Err(format!("a tensor has {} axes and {} strides", shape.len(), strides.len()));
        }
        let storage = **storage;
        // Where the last number is, and how many there are.
        let (mut last, mut numbers) = (Some(start), Some(1_u64));
        for (&length, &stride) in shape.iter().zip(&strides) {
            let along = stride.checked_mul(length.saturating_sub(1));
            last = last.zip(along).and_then(|(last, along)| last.checked_add(along));
            numbers = numbers.and_then(|numbers| numbers.checked_mul(length));
        }
        let fits = numbers == Some(0) || last.is_some_and(|last| last < storage.numbers);
        // Strides of 0 would make a large tensor of a small storage.
        if !fits || numbers.is_none_or(|numbers| numbers > storage.numbers) {
            let had = storage.numbers;
            return Err(format!(
                "a tensor of shape {shape:?}, strides {strides:?}, start {start} is larger than its storage of {had} numbers"
            ));
        }
        let shape = shape.iter().map(|&length| usize::try_from(length).map_err(|error| error.to_string()));
        Ok(Strided { storage, start, shape: shape.collect::<Result<_, _>>()?, strides })
    }

    fn wholes(&self, ids: &[Id]) -> Result<Vec<u64>, String> {
        if ids.len() > MOST_AXES {
            return Err(format!("a tensor has {} axes, more than {MOST_AXES}", ids.len()));
        }
        let whole = |id: &Id| match self.get(*id) {
            Value::Whole(number) => u64::try_from(*number)
                .map_err(|_| format!("a tensor's shape or strides have the number {number}")),
            other => Err(format!("a tensor's shape or strides have {} for a number", other.kind())),
        };
        ids.iter().map(whole).collect()
    }
}
