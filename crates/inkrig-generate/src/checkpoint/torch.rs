//! Files that PyTorch saved: `.ckpt`, `.pt`, `.pth`.

use super::CheckpointError;
use super::bytes::Bytes;
use super::error::shown;
use super::pickle::{self, Pickle, Storage, Strided, Value};
use super::source::{Listed, TensorSource, check_size, finished};
use super::zip::{self, Entry};
use crate::weights::Tensor;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek};

/// The first bytes of a zip archive.
const ZIP: &[u8] = b"PK\x03\x04";
/// How files from before PyTorch 1.6 begin: a pickle of a certain number.
const OLD: &[u8] = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19";
const SAVE_AGAIN: &str =
    "save it again in a newer PyTorch: torch.save(torch.load(FILE, weights_only=True), NEW_FILE)";

/// A file that `torch.save` wrote, as zip archive (since PyTorch 1.6). Nothing in it is run: see the notes on pickles in
/// [the room's documentation](super).
#[derive(Debug)]
pub struct TorchFile<R> {
    bytes: Bytes<R>,
    listed: Vec<Listed>,
    places: Vec<Place>,
    skipped: Vec<String>,
}

/// Where a tensor's numbers are.
#[derive(Debug)]
struct Place {
    entry: Entry,
    start: u64,
    strides: Vec<u64>,
}

impl<R: Read + Seek> TorchFile<R> {
    /// Lists the tensors of a state dictionary: that of the key `state_dict` of a training checkpoint, or the dictionary
    /// itself.
    ///
    /// # Errors
    /// [`CheckpointError`] when the file is damaged, is of another kind, names anything but tensors, dictionaries, lists, numbers
    /// and text, or says two things under one name.
    pub fn open(file: R) -> Result<Self, CheckpointError> {
        let mut bytes = Bytes::new(file)?;
        let start = bytes.part(0, bytes.length().min(OLD.len() as u64), "the file")?;
        if !start.starts_with(ZIP) {
            return Err(not_a_zip(&mut bytes, &start));
        }
        let entries = zip::entries(&mut bytes, zip::Purpose::Weights)?;
        let folder = folder(&entries)?;
        if let Some(order) = entries.get(&format!("{folder}byteorder"))
            && bytes.part(order.start, order.length.min(16), "the byte order")? != b"little"
        {
            let what = "its numbers begin with their highest byte".into();
            return Err(CheckpointError::Unsupported { what, todo: "save it again on a common computer" });
        }
        let pickle = read_pickle(&mut bytes, &entries, &folder)?;
        let pickle = pickle::run(&pickle)?;
        let (mut listed, mut places, mut skipped) = (Vec::new(), Vec::new(), Vec::new());
        for (name, tensor) in state_dict(&pickle, &mut skipped)? {
            let entry = find_storage(&entries, &folder, &tensor.storage, name)?;
            listed.push(Listed { name: name.into(), shape: tensor.shape.clone(), kind: tensor.storage.kind });
            places.push(Place { entry, start: tensor.start, strides: tensor.strides.clone() });
        }
        Ok(Self { bytes, listed, places, skipped })
    }

    /// Names in the state dictionary that are no tensors.
    pub fn skipped(&self) -> &[String] {
        &self.skipped
    }
}

impl<R: Read + Seek> TensorSource for TorchFile<R> {
    fn listed(&self) -> &[Listed] {
        &self.listed
    }

    fn read(&mut self, at: usize) -> Result<Tensor, CheckpointError> {
        let (Some(listed), Some(place)) = (self.listed.get(at), self.places.get(at)) else {
            return Err(CheckpointError::damaged(format!("there is no tensor number {at}")));
        };
        check_size(listed)?;
        let size = listed.kind.size() as u64;
        let numbers = listed.numbers();
        let along = listed.shape.iter().zip(&place.strides);
        let span = if numbers == 0 {
            0
        } else {
            along.map(|(&length, stride)| (length as u64 - 1) * stride).sum::<u64>() + 1
        };
        let what = format!("the tensor {}", shown(&listed.name));
        let mut data = Vec::with_capacity(usize::try_from(span).unwrap_or_default().min(MOST_RESERVED));
        let mut checksum = 0;
        self.bytes.pieces(place.entry.start + place.start * size, span * size, &what, |piece| {
            checksum = zip::checksum(checksum, piece);
            listed.kind.decode(piece, &mut data);
        })?;
        // Part of a storage has no checksum of its own.
        if span * size == place.entry.length && checksum != place.entry.checksum {
            let what = "its checksum is wrong: the file is damaged; get it again";
            return Err(CheckpointError::tensor(&listed.name, what));
        }
        if !in_order(&listed.shape, &place.strides) {
            data = gather(&listed.shape, &place.strides, &data);
        }
        finished(listed, data)
    }
}

/// Numbers for which room is made before they are read; for more it grows.
const MOST_RESERVED: usize = 1 << 20;

/// What a file is that is no zip archive.
fn not_a_zip<R: Read + Seek>(bytes: &mut Bytes<R>, start: &[u8]) -> CheckpointError {
    let unsupported = |what: &str, todo| CheckpointError::Unsupported { what: what.into(), todo };
    if start.starts_with(OLD) {
        return unsupported("this file is in PyTorch's form from before version 1.6", SAVE_AGAIN);
    }
    if start.starts_with(&[0x80]) {
        // Worth a look for the sake of the message: one that asks for code is told by name.
        let length = bytes.length().min(pickle::MOST_BYTES);
        let read = bytes.part(0, length, "the pickle");
        if let Err(refused @ CheckpointError::Refused { .. }) =
            read.and_then(|bytes| pickle::run(&bytes).map(drop))
        {
            return refused;
        }
        return unsupported("this file is a bare pickle", SAVE_AGAIN);
    }
    unsupported("this file is none that PyTorch saved", "give a .ckpt, .pt, .pth or .safetensors file")
}

/// The one folder in which everything lies, with its slash.
fn folder(entries: &BTreeMap<String, Entry>) -> Result<String, CheckpointError> {
    let mut folders = entries.keys().filter_map(|name| name.strip_suffix("data.pkl"));
    let folder = folders.next().ok_or_else(|| CheckpointError::Unsupported {
        what: "this zip archive has no data.pkl, so PyTorch did not save it".into(),
        todo: "give a .ckpt, .pt, .pth or .safetensors file",
    })?;
    if folders.next().is_some() {
        return Err(CheckpointError::Twice { what: "the zip entry", name: "data.pkl".into() });
    }
    if entries.contains_key(&format!("{folder}constants.pkl")) {
        let what = "this file is a TorchScript program".into();
        let todo = "save its state_dict: torch.save(torch.jit.load(FILE).state_dict(), NEW_FILE)";
        return Err(CheckpointError::Unsupported { what, todo });
    }
    Ok(folder.to_owned())
}

fn read_pickle<R: Read + Seek>(
    bytes: &mut Bytes<R>,
    entries: &BTreeMap<String, Entry>,
    folder: &str,
) -> Result<Vec<u8>, CheckpointError> {
    let missing = || CheckpointError::damaged("the zip archive has no data.pkl");
    let entry = entries.get(&format!("{folder}data.pkl")).ok_or_else(missing)?;
    if entry.length > pickle::MOST_BYTES {
        let (got, most) = (entry.length, pickle::MOST_BYTES);
        return Err(CheckpointError::TooMuch { what: "bytes in data.pkl".into(), got, most });
    }
    let pickle = bytes.part(entry.start, entry.length, "data.pkl")?;
    if zip::checksum(0, &pickle) != entry.checksum {
        return Err(CheckpointError::damaged("the checksum of data.pkl is wrong"));
    }
    Ok(pickle)
}

/// Tensors by name, in the order of the file.
fn state_dict<'a, 'b>(
    pickle: &'b Pickle<'a>,
    skipped: &mut Vec<String>,
) -> Result<Vec<(&'a str, &'b Strided<'a>)>, CheckpointError> {
    let unknown = |what: String| Err(CheckpointError::Unknown { what });
    let Value::Map(root) = pickle.get(pickle.root) else {
        return unknown(format!("the file holds {}, not a dictionary", pickle.get(pickle.root).kind()));
    };
    let mut state_dicts =
        root.iter().filter(|[key, _]| matches!(pickle.get(*key), Value::Text("state_dict")));
    let map = match (state_dicts.next(), state_dicts.next()) {
        (None, _) => root,
        (Some([_, inner]), None) => match pickle.get(*inner) {
            Value::Map(inner) => inner,
            other => return unknown(format!("its state_dict is {}, not a dictionary", other.kind())),
        },
        _ => return Err(CheckpointError::Twice { what: "the key", name: "state_dict".into() }),
    };
    let mut tensors = Vec::new();
    let mut names = BTreeSet::new();
    for [key, value] in map {
        let Value::Text(name) = *pickle.get(*key) else { continue };
        if !names.insert(name) {
            return Err(CheckpointError::Twice { what: "the tensor", name: shown(name) });
        }
        match pickle.get(*value) {
            Value::Tensor(tensor) => tensors.push((name, &**tensor)),
            _ => skipped.push(shown(name)),
        }
    }
    if tensors.is_empty() {
        let keys: Vec<String> = skipped.iter().take(8).cloned().collect();
        return unknown(format!("the file holds no tensors by name, only: {}", keys.join(", ")));
    }
    Ok(tensors)
}

fn find_storage(
    entries: &BTreeMap<String, Entry>,
    folder: &str,
    storage: &Storage<'_>,
    tensor: &str,
) -> Result<Entry, CheckpointError> {
    let place = format!("{folder}data/{}", storage.key);
    let missing =
        || CheckpointError::tensor(tensor, format!("its numbers, {}, are not in the file", shown(&place)));
    let entry = *entries.get(&place).ok_or_else(missing)?;
    let needed = storage.numbers.checked_mul(storage.kind.size() as u64);
    if needed != Some(entry.length) {
        let (numbers, size, got) = (storage.numbers, storage.kind.size(), entry.length);
        let what = format!("{numbers} numbers of {size} bytes are promised, but {got} bytes are there");
        return Err(CheckpointError::tensor(tensor, what));
    }
    Ok(entry)
}

/// Whether numbers lie as rows of rows; axes of length 1 may have any stride.
fn in_order(shape: &[usize], strides: &[u64]) -> bool {
    let mut next = 1;
    for (&length, &stride) in shape.iter().zip(strides).rev() {
        if length != 1 && stride != next {
            return false;
        }
        next *= length as u64;
    }
    true
}

/// Numbers in the order of rows, out of a storage in which they lie in steps.
fn gather(shape: &[usize], strides: &[u64], data: &[f32]) -> Vec<f32> {
    let numbers = shape.iter().product();
    let mut place = vec![0_usize; shape.len()];
    let mut at = 0_u64;
    let mut out = Vec::with_capacity(numbers);
    while out.len() < numbers {
        out.push(usize::try_from(at).ok().and_then(|at| data.get(at)).copied().unwrap_or_default());
        for ((place, &length), &stride) in place.iter_mut().zip(shape).zip(strides).rev() {
            *place += 1;
            at += stride;
            if *place < length {
                break;
            }
            at -= stride * *place as u64;
            *place = 0;
        }
    }
    out
}
