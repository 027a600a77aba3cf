//! Fuzz targets of the readers of weights, on stable Rust. Under `cargo test` each runs for a second;
//! `BOLERO_RANDOM_TEST_TIME_MS=300000 cargo test --release -p inkrig-generate --test fuzz_checkpoints` runs them for longer.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod torch_files;

use inkrig_generate::checkpoint::{
    About, Import, Listed, ModelFile, ModelHeader, NumberKind, Safetensors, TensorSource, TorchFile,
    read_npy, write_model,
};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::networks::Sizes;
use inkrig_generate::sampling::Semantics;
use inkrig_generate::weights::Tensor;
use std::io::Cursor;
use std::sync::atomic::{AtomicUsize, Ordering};
use torch_files::{Described, Entry, Pickler, zip};

static TRIED: AtomicUsize = AtomicUsize::new(0);
static READABLE: AtomicUsize = AtomicUsize::new(0);

/// What means something to a pickle.
const PIECES: &[&[u8]] = &[
    b"(",
    b"t",
    b"}",
    b"]",
    b")",
    b"R",
    b"Q",
    b"u",
    b"s",
    b"a",
    b"e",
    b"b",
    b"0",
    b"1",
    b"2",
    b"N",
    b".",
    b"h\0",
    b"q\0",
    b"K\x05",
    b"M\xff\xff",
    b"J\xff\xff\xff\xff",
    b"J\0\0\0\x80",
    b"X\x01\0\0\0a",
    b"X\xff\xff\xff\xff",
    b"\x85",
    b"\x86",
    b"\x87",
    b"\x93",
    b"\x94",
    b"\x8a\x08\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"\x8a\0",
    b"\x8b\xff\xff\xff\xff",
    b"ccollections\nOrderedDict\n",
    b"ctorch._utils\n_rebuild_tensor_v2\n",
    b"ctorch\nFloatStorage\n",
    b"ctorch\nHalfStorage\n",
    b"cos\nsystem\n",
    b"c\n\n",
    b"X\x07\0\0\0storage",
    b"X\x0a\0\0\0state_dict",
];

/// Kind, place, argument, second place.
type Edit = (u8, u16, u8, u16);

fn pickle() -> Vec<u8> {
    Pickler::checkpoint(|pickler| {
        for (name, shape, strides) in [("a", [2, 3], [3, 1]), ("b", [3, 2], [1, 3])] {
            let tensor = Described {
                class: "FloatStorage",
                key: "0",
                stored: 6,
                start: 0,
                shape: &shape,
                strides: &strides,
            };
            pickler.text(name).tensor(&tensor);
        }
    })
}

fn archive(pickle: Vec<u8>) -> Vec<u8> {
    zip(&[Entry::new("m/data.pkl", pickle), Entry::new("m/data/0", vec![0; 24])])
}

/// Reads all; whether there was something to read.
fn read_all(source: &mut dyn TensorSource) -> bool {
    let mut numbers = 0;
    for at in 0..source.listed().len() {
        let listed = source.listed()[at].clone();
        match source.read(at) {
            Ok(tensor) => {
                assert_eq!(tensor.shape(), listed.shape);
                numbers += tensor.data().len();
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    assert!(source.read(source.listed().len()).is_err());
    let _ = Import::plan(source.listed(), true)
        .map(|plan| plan.write(source, &About::default(), Cursor::new(Vec::new())));
    numbers > 0
}

fn torch(file: &[u8]) -> bool {
    match TorchFile::open(Cursor::new(file)) {
        Ok(mut file) => read_all(&mut file),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

fn apply(bytes: &mut Vec<u8>, (kind, place, argument, other): Edit, pieces: &[&[u8]]) {
    let place = usize::from(place) % (bytes.len() + 1);
    let end = (place + usize::from(argument) % 24).min(bytes.len());
    let piece = pieces[usize::from(other) % pieces.len()];
    match kind % 8 {
        0 => bytes.insert(place, argument),
        1 | 2 => drop(bytes.splice(place..place, piece.iter().copied())),
        3 => drop(bytes.splice(place..end, piece.iter().copied())),
        4 => drop(bytes.drain(place..end)),
        5 => {
            let copy = bytes[place..end].to_vec();
            let to = usize::from(other) % (bytes.len() + 1);
            bytes.splice(to..to, copy);
        }
        6 => bytes.truncate(place.max(4)),
        _ => {
            if let Some(byte) = bytes.get_mut(place) {
                *byte = argument;
            }
        }
    }
}

#[test]
fn pickles_changed_at_random() {
    bolero::check!().with_type::<Vec<Edit>>().for_each(|edits| {
        let mut pickle = pickle();
        for edit in edits.iter().take(1) {
            apply(&mut pickle, *edit, PIECES);
        }
        TRIED.fetch_add(1, Ordering::Relaxed);
        READABLE.fetch_add(usize::from(torch(&archive(pickle))), Ordering::Relaxed);
    });
    let (tried, readable) = (TRIED.load(Ordering::Relaxed), READABLE.load(Ordering::Relaxed));
    println!("{tried} pickles, {readable} of them readable");
    assert!(readable * 50 > tried, "a mutator that breaks everything would test nothing behind the pickle");
}

#[test]
fn pickles_of_random_pieces() {
    bolero::check!().with_type::<Vec<u8>>().for_each(|choices| {
        let mut pickle = b"\x80\x02".to_vec();
        for choice in choices {
            pickle.extend_from_slice(PIECES[usize::from(*choice) % PIECES.len()]);
        }
        torch(&archive(pickle));
    });
}

#[test]
fn archives_changed_at_random() {
    let whole = archive(pickle());
    let pieces: &[&[u8]] =
        &[b"PK\x01\x02", b"PK\x03\x04", b"PK\x05\x06", b"PK\x06\x06", b"\xff\xff\xff\xff", b"\0\0\0\0"];
    bolero::check!().with_type::<(Vec<Edit>, Vec<u8>)>().for_each(|(edits, raw)| {
        let mut file = whole.clone();
        for edit in edits.iter().take(3) {
            apply(&mut file, *edit, pieces);
        }
        torch(&file);
        torch(&[b"PK\x03\x04", raw.as_slice()].concat());
    });
}

#[test]
fn safetensors_changed_at_random() {
    let header = ModelHeader::new("a", Sizes::tiny(), Semantics::Paper, TextEncoderKind::Verbs);
    let listed: Vec<Listed> = [("a", NumberKind::F32), ("b", NumberKind::F16)]
        .map(|(name, kind)| Listed { name: name.into(), shape: vec![2, 3], kind })
        .into();
    let mut whole = Cursor::new(Vec::new());
    write_model(&mut whole, &header, &listed, |_| Ok(Tensor::new(vec![2, 3], vec![1.0; 6]).unwrap()))
        .unwrap();
    let whole = whole.into_inner();
    let pieces: &[&[u8]] = &[
        b"\"",
        b"{",
        b"}",
        b"[",
        b"]",
        b",",
        b":",
        b"0",
        b"8",
        b"-1",
        b"1e99",
        b"18446744073709551615",
        b"null",
        b"\"F16\"",
        b"\"I64\"",
        b"\"a\":",
        b"\"__metadata__\":{",
        b"\"data_offsets\":[0,24]",
        b"\\\"",
        b"\"shape\":[0]",
    ];
    bolero::check!().with_type::<(bool, Vec<Edit>)>().for_each(|(keep_length, edits)| {
        let mut file = whole.clone();
        for edit in edits.iter().take(3) {
            apply(&mut file, *edit, pieces);
        }
        if *keep_length && file.len() > 8 {
            // The header ends where it still can, so that its text is looked at.
            let length = (file.len() - 8).saturating_sub(36) as u64;
            file[..8].copy_from_slice(&length.to_le_bytes());
        }
        if let Ok(mut file) = Safetensors::open(Cursor::new(&file)) {
            read_all(&mut file);
        }
        if let Ok(mut model) = ModelFile::open(Cursor::new(&file)) {
            let _ = model.tensors();
        }
    });
}

#[test]
fn numpy_files_at_random() {
    let whole = b"\x93NUMPY\x01\0\x46\0{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }           \n\0\0\0\0\0\0\0\0";
    let pieces: &[&[u8]] = &[b"(", b")", b",", b"9", b"-", b"'<f8'", b"'shape':", b"4294967296"];
    bolero::check!().with_type::<Vec<Edit>>().for_each(|edits| {
        let mut file = whole.to_vec();
        for edit in edits.iter().take(3) {
            apply(&mut file, *edit, pieces);
        }
        if let Ok((shape, numbers)) = read_npy(&file, "x") {
            assert_eq!(shape.iter().product::<usize>(), numbers.len());
        }
    });
}
