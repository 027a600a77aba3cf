//! Runs a pickle, which here only means: builds a table of values.

use super::opcodes::{self as op, other};
use super::{Id, Known, Strided, Value};
use crate::checkpoint::CheckpointError;
use crate::checkpoint::bytes::Cursor;
use crate::checkpoint::error::shown;
use std::collections::HashMap;

/// Values of a pickle.
const MOST_VALUES: usize = 1_000_000;
/// Tensors and storages of a pickle: they take most.
const MOST_TENSORS: usize = 100_000;
/// Bytes of a name that is looked up.
const MOST_NAME: usize = 256;

/// What a pickle built.
pub(in crate::checkpoint) struct Pickle<'a> {
    pub(super) values: Vec<Value<'a>>,
    /// The one that it ended with.
    pub(in crate::checkpoint) root: Id,
}

impl<'a> Pickle<'a> {
    pub(in crate::checkpoint) fn get(&self, id: Id) -> &Value<'a> {
        self.values.get(id as usize).unwrap_or(&Value::Nothing)
    }
}

/// Builds what the bytes describe.
pub(in crate::checkpoint) fn run(bytes: &[u8]) -> Result<Pickle<'_>, CheckpointError> {
    let mut machine = Machine {
        input: Cursor::new(bytes),
        at: 0,
        pickle: Pickle { values: Vec::new(), root: 0 },
        tensors: 0,
        stack: Vec::new(),
        marks: Vec::new(),
        memo: HashMap::new(),
    };
    while !machine.step()? {}
    Ok(machine.pickle)
}

struct Machine<'a> {
    input: Cursor<'a>,
    /// Where the opcode is.
    at: usize,
    pickle: Pickle<'a>,
    tensors: usize,
    stack: Vec<Id>,
    /// Heights of the stack.
    marks: Vec<u32>,
    memo: HashMap<u32, Id>,
}

type Done = Result<(), CheckpointError>;

impl<'a> Machine<'a> {
    /// One opcode; true after the last.
    fn step(&mut self) -> Result<bool, CheckpointError> {
        self.at = self.input.at();
        let opcode = self.need(Cursor::u8)?;
        match opcode {
            op::STOP => {
                self.pickle.root = self.pop()?;
                return Ok(true);
            }
            op::PROTO => {
                let version = self.need(Cursor::u8)?;
                if version > 5 {
                    return Err(self.wrong(format!("pickle's version {version} is not known")));
                }
            }
            op::FRAME => self.skip(8)?,
            op::MARK => self.marks.push(self.stack.len() as u32),
            op::POP => {
                self.pop()?;
            }
            op::POP_MARK => {
                self.pop_mark()?;
            }
            op::DUP => {
                let top = self.top()?;
                self.stack.push(top);
            }
            op::NONE => self.push(Value::Nothing)?,
            op::NEWTRUE | op::NEWFALSE => self.push(Value::Truth)?,
            op::BINFLOAT => {
                self.skip(8)?;
                self.push(Value::Float)?;
            }
            op::BININT | op::BININT1 | op::BININT2 | op::LONG1 | op::LONG4 => self.whole(opcode)?,
            op::BINUNICODE | op::SHORT_BINUNICODE | op::BINUNICODE8 | op::BINSTRING | op::SHORT_BINSTRING => {
                self.text(opcode)?;
            }
            op::BINBYTES | op::SHORT_BINBYTES | op::BINBYTES8 => {
                let length = self.length(opcode)?;
                self.skip(length)?;
                self.push(Value::Raw)?;
            }
            op::EMPTY_LIST | op::EMPTY_TUPLE | op::EMPTY_SET => self.push(Value::List(Vec::new()))?,
            op::EMPTY_DICT => self.push(Value::Map(Vec::new()))?,
            op::TUPLE | op::LIST => {
                let items = self.pop_mark()?;
                self.push(Value::List(items))?;
            }
            op::TUPLE1 | op::TUPLE2 | op::TUPLE3 => {
                let items = self.pop_items(usize::from(opcode - op::TUPLE1) + 1)?;
                self.push(Value::List(items))?;
            }
            op::DICT => {
                let items = self.pop_mark()?;
                self.push(Value::Map(Vec::new()))?;
                self.add_pairs(&items)?;
            }
            op::APPEND => {
                let item = self.pop()?;
                self.add_items(&[item])?;
            }
            op::APPENDS | op::ADDITEMS => {
                let items = self.pop_mark()?;
                self.add_items(&items)?;
            }
            op::SETITEM => {
                let pair = self.pop_items(2)?;
                self.add_pairs(&pair)?;
            }
            op::SETITEMS => {
                let items = self.pop_mark()?;
                self.add_pairs(&items)?;
            }
            op::BINPUT | op::LONG_BINPUT | op::MEMOIZE => self.remember(opcode)?,
            op::BINGET | op::LONG_BINGET => self.recall(opcode)?,
            op::GLOBAL | op::INST | op::STACK_GLOBAL => self.name(opcode)?,
            op::BINPERSID => self.storage()?,
            op::REDUCE | op::NEWOBJ => self.call()?,
            // The state of what lies below it: attributes that tensors and dictionaries of weights do not need.
            op::BUILD => {
                self.pop()?;
            }
            _ => return Err(self.wrong(format!("opcode {opcode:#04x} {}", other(opcode)))),
        }
        Ok(false)
    }

    fn whole(&mut self, opcode: u8) -> Done {
        let number = match opcode {
            op::BININT => self.need(Cursor::i32)?.into(),
            op::BININT1 => self.need(Cursor::u8)?.into(),
            op::BININT2 => self.need(Cursor::u16)?.into(),
            _ => {
                let length = self.length(opcode)?;
                let bytes = self.need(|input| input.take(length))?;
                let negative = bytes.last().is_some_and(|last| last & 0x80 != 0);
                let mut wide = if negative { [0xff; 8] } else { [0; 8] };
                for (wide, byte) in wide.iter_mut().zip(bytes) {
                    *wide = *byte;
                }
                if length > wide.len() {
                    return Err(self.wrong("a whole number is longer than 8 bytes".into()));
                }
                i64::from_le_bytes(wide)
            }
        };
        self.push(Value::Whole(number))
    }

    fn text(&mut self, opcode: u8) -> Done {
        let length = self.length(opcode)?;
        let bytes = self.need(|input| input.take(length))?;
        let text = str::from_utf8(bytes).map_err(|_| self.wrong("a text is not UTF-8".into()))?;
        self.push(Value::Text(text))
    }

    fn length(&mut self, opcode: u8) -> Result<usize, CheckpointError> {
        let length = match opcode {
            op::SHORT_BINUNICODE | op::SHORT_BINSTRING | op::SHORT_BINBYTES | op::LONG1 => {
                self.need(Cursor::u8)?.into()
            }
            op::BINUNICODE8 | op::BINBYTES8 => self.need(Cursor::u64)?,
            _ => self.need(Cursor::u32)?.into(),
        };
        usize::try_from(length).map_err(|_| self.ended())
    }

    fn remember(&mut self, opcode: u8) -> Done {
        let place = match opcode {
            op::BINPUT => self.need(Cursor::u8)?.into(),
            op::LONG_BINPUT => self.need(Cursor::u32)?,
            _ => self.memo.len() as u32,
        };
        let top = self.top()?;
        self.memo.insert(place, top);
        if self.memo.len() > MOST_VALUES {
            return Err(self.too_much("values that a pickle remembers", MOST_VALUES));
        }
        Ok(())
    }

    fn recall(&mut self, opcode: u8) -> Done {
        let place =
            if opcode == op::BINGET { self.need(Cursor::u8)?.into() } else { self.need(Cursor::u32)? };
        let nothing = || self.wrong(format!("value {place} is used before it is there"));
        let id = *self.memo.get(&place).ok_or_else(nothing)?;
        self.stack.push(id);
        Ok(())
    }

    /// The only way to anything but data; what is not known ends here.
    fn name(&mut self, opcode: u8) -> Done {
        let (module, name) = if opcode == op::STACK_GLOBAL {
            let items = self.pop_items(2)?;
            match [0, 1].map(|at| items.get(at).map(|id| self.pickle.get(*id))) {
                [Some(Value::Text(module)), Some(Value::Text(name))] => (*module, *name),
                _ => return Err(self.wrong("a name is no text".into())),
            }
        } else {
            let lines = self.input.line(MOST_NAME).zip(self.input.line(MOST_NAME));
            let Some((module, name)) = lines else {
                return Err(self.wrong(format!("a name is longer than {MOST_NAME} bytes, or has no end")));
            };
            let utf8 = |bytes| str::from_utf8(bytes).map_err(|_| self.wrong("a name is not UTF-8".into()));
            (utf8(module)?, utf8(name)?)
        };
        match Known::find(module, name) {
            Some(known) if opcode != op::INST => self.push(Value::Known(known)),
            _ => {
                let name = format!("{}.{}", shown(module), shown(name));
                Err(CheckpointError::Refused { name, at: self.at })
            }
        }
    }

    fn storage(&mut self) -> Done {
        let id = self.pop()?;
        self.count_tensor()?;
        let storage = self.pickle.storage(id).map_err(|what| self.wrong(what))?;
        self.push(Value::Storage(Box::new(storage)))
    }

    /// Nothing is called: the few known names say what to make of what was given.
    fn call(&mut self) -> Done {
        let pair = self.pop_items(2)?;
        let [callable, arguments] = pair[..] else { return Err(self.ended()) };
        let Value::Known(known) = *self.pickle.get(callable) else {
            let kind = self.pickle.get(callable).kind();
            return Err(self.wrong(format!("{kind} is called as if it were a function")));
        };
        let Value::List(arguments) = self.pickle.get(arguments) else {
            return Err(self.wrong("what a function is given is no tuple".into()));
        };
        match known {
            Known::OrderedDict if arguments.is_empty() => self.push(Value::Map(Vec::new())),
            Known::OrderedDict => {
                Err(self.wrong("a dictionary is made of a list in the manner of old files".into()))
            }
            Known::List | Known::Parameter => {
                let Some(&first) = arguments.first() else { return self.push(Value::List(Vec::new())) };
                self.stack.push(first);
                Ok(())
            }
            Known::Tensor => {
                let tensor = self.pickle.tensor(arguments).map_err(|what| self.wrong(what))?;
                self.count_tensor()?;
                self.push(Value::Tensor(Box::<Strided<'_>>::new(tensor)))
            }
            Known::Storage(_) | Known::Constant => {
                Err(self.wrong("a kind of number is called as if it were a function".into()))
            }
        }
    }

    fn add_items(&mut self, items: &[Id]) -> Done {
        let list = self.top()?;
        match self.pickle.values.get_mut(list as usize) {
            Some(Value::List(list)) => {
                list.extend_from_slice(items);
                Ok(())
            }
            _ => Err(self.wrong("something is added to what is no list".into())),
        }
    }

    fn add_pairs(&mut self, items: &[Id]) -> Done {
        let map = self.top()?;
        let (pairs, []) = items.as_chunks::<2>() else {
            return Err(self.wrong("a key has no value".into()));
        };
        match self.pickle.values.get_mut(map as usize) {
            Some(Value::Map(map)) => {
                map.extend_from_slice(pairs);
                Ok(())
            }
            _ => Err(self.wrong("a key is set in what is no dictionary".into())),
        }
    }

    fn push(&mut self, value: Value<'a>) -> Done {
        if self.pickle.values.len() >= MOST_VALUES {
            return Err(self.too_much("values of a pickle", MOST_VALUES));
        }
        self.stack.push(self.pickle.values.len() as Id);
        self.pickle.values.push(value);
        Ok(())
    }

    fn count_tensor(&mut self) -> Done {
        self.tensors += 1;
        if self.tensors > MOST_TENSORS {
            return Err(self.too_much("tensors of a pickle", MOST_TENSORS));
        }
        Ok(())
    }

    fn top(&self) -> Result<Id, CheckpointError> {
        self.stack.last().copied().ok_or_else(|| self.empty())
    }

    fn pop(&mut self) -> Result<Id, CheckpointError> {
        let Some(id) = self.stack.pop() else { return Err(self.empty()) };
        Ok(id)
    }

    fn pop_items(&mut self, count: usize) -> Result<Vec<Id>, CheckpointError> {
        let start = self.stack.len().checked_sub(count).ok_or_else(|| self.empty())?;
        Ok(self.stack.split_off(start))
    }

    fn pop_mark(&mut self) -> Result<Vec<Id>, CheckpointError> {
        let Some(mark) = self.marks.pop() else {
            return Err(self.wrong("a list ends that did not begin".into()));
        };
        if mark as usize > self.stack.len() {
            return Err(self.empty());
        }
        Ok(self.stack.split_off(mark as usize))
    }

    fn need<T>(&mut self, read: impl FnOnce(&mut Cursor<'a>) -> Option<T>) -> Result<T, CheckpointError> {
        read(&mut self.input).ok_or_else(|| CheckpointError::damaged("the pickle ends in the middle"))
    }

    fn skip(&mut self, length: usize) -> Done {
        self.need(|input| input.take(length)).map(drop)
    }

    fn ended(&self) -> CheckpointError {
        CheckpointError::damaged("the pickle ends in the middle")
    }

    fn empty(&self) -> CheckpointError {
        self.wrong("something is used that is not there".into())
    }

    fn wrong(&self, what: String) -> CheckpointError {
        CheckpointError::Pickle { at: self.at, what }
    }

    fn too_much(&self, what: &str, most: usize) -> CheckpointError {
        CheckpointError::TooMuch { what: what.into(), got: most as u64 + 1, most: most as u64 }
    }
}
