//! Reading a checkpoint takes little more memory than its largest tensor, whatever it says of itself.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "counting what is allocated takes an allocator, which is unsafe by nature; functions beside the tests may fail too"
)]

mod torch_files;

use inkrig_generate::checkpoint::{About, CheckpointError, Import, Safetensors, TensorSource, TorchFile};
use inkrig_generate::networks::{Parts, Sizes};
use inkrig_generate::weights::hashed;
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, Seek, SeekFrom, Write};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use torch_files::{Described, Entry, Pickler, checkpoint, zip};

struct Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed to the system's allocator unchanged; the counters do not touch memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let live = LIVE.fetch_add(layout.size(), Relaxed) + layout.size();
        PEAK.fetch_max(live, Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes alive at the worst moment, above what was alive before.
fn peak<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    let result = work();
    (PEAK.load(Relaxed) - before, result)
}

fn open_and_read(file: &[u8]) -> Result<(), CheckpointError> {
    let mut file = TorchFile::open(Cursor::new(file))?;
    for at in 0..file.listed().len() {
        file.read(at)?;
    }
    Ok(())
}

/// A file that counts what is written and keeps nothing.
struct Nowhere {
    at: u64,
    end: u64,
}

impl Write for Nowhere {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.at += bytes.len() as u64;
        self.end = self.end.max(self.at);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Seek for Nowhere {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(by) => self.at.saturating_add_signed(by),
            SeekFrom::End(by) => self.end.saturating_add_signed(by),
        };
        Ok(self.at)
    }
}

// The only test of its file: others at the same time would be counted too.
#[test]
fn hostile_and_large_checkpoints_take_little_memory() {
    const MIB: usize = 1 << 20;
    let storage =
        |pickle: Vec<u8>| zip(&[Entry::new("m/data.pkl", pickle), Entry::new("m/data/0", vec![0; 24])]);
    let of_tensor = |stored: i64, shape: &[i64], strides: &[i64]| {
        storage(Pickler::checkpoint(|pickler| {
            pickler.text("a").tensor(&Described {
                class: "FloatStorage",
                key: "0",
                stored,
                start: 0,
                shape,
                strides,
            });
        }))
    };
    let pickle = |before: &[u8], repeated: &[u8], count: usize, after: &[u8]| {
        storage([&b"\x80\x02"[..], before, &repeated.repeat(count), after, b"."].concat())
    };
    let mut storages = Pickler::default();
    storages
        .op(b"(")
        .text("storage")
        .name("torch", "FloatStorage")
        .text("0")
        .text("cpu")
        .whole(6)
        .op(b"tq\x01Q");
    let mut tensor = Pickler::default();
    tensor
        .name("torch._utils", "_rebuild_tensor_v2")
        .op(b"q\x02(")
        .op(&storages.bytes)
        .whole(0)
        .wholes(&[1; 6]);
    tensor.wholes(&[1; 6]).op(&[0x89]).ordered().op(b"tq\x03R");
    let bomb = |length: u32| {
        let mut entry = Entry::new("m/data/0", vec![0; 1000]);
        (entry.method, entry.length) = (8, Some(length));
        zip(&[Entry::new("m/data.pkl", Vec::new()), entry])
    };
    let many = |count: usize| {
        let entries: Vec<Entry> = (0..count).map(|at| Entry::new(&format!("m/{at}"), Vec::new())).collect();
        zip(&entries)
    };
    let four = 4 * MIB - 100;
    let safetensors = |header: String| [&(header.len() as u64).to_le_bytes()[..], header.as_bytes()].concat();
    let described = r#"{"dtype":"F32","shape":[0],"data_offsets":[0,0]}"#;
    let header = |count: usize| {
        let tensors: Vec<String> = (0..count).map(|at| format!(r#""{at}":{described}"#)).collect();
        safetensors(format!("{{{}}}", tensors.join(",")))
    };
    // What may be taken: a small multiple of the file, and some that any file may take.
    let cases: Vec<(&str, Vec<u8>, usize)> = vec![
        ("a tensor of 2^62 numbers", of_tensor(6, &[1 << 31, 1 << 31], &[0, 0]), MIB),
        ("a storage of 2^62 numbers", of_tensor(1 << 62, &[1 << 62], &[1]), MIB),
        ("a zip bomb", bomb(u32::MAX - 1), MIB),
        ("a million empty lists", pickle(b"", b"]", four, b""), 100 * MIB),
        ("a million empty dictionaries", pickle(b"", b"}", four, b""), 100 * MIB),
        ("four million references", pickle(b"]q\0", b"h\0", four / 2, b""), 100 * MIB),
        ("a list that holds itself", pickle(b"](", b"2", four, b"e"), 120 * MIB),
        ("everything remembered", pickle(b"]", &[0x94], four, b""), 100 * MIB),
        ("marks", pickle(b"", b"(", four, b""), 100 * MIB),
        ("tensors", pickle(&tensor.bytes, b"h\x02h\x03R", four / 5 - 100, b""), 100 * MIB),
        ("storages", pickle(&storages.bytes, b"h\x01Q", four / 3, b""), 100 * MIB),
        ("many zip entries", many(90_000), 60 * MIB),
        ("too many zip entries", many(110_000), 60 * MIB),
        ("a header of safetensors", header(65_000), 60 * MIB),
        ("too many tensors", header(250_000), 60 * MIB),
        ("deep JSON", safetensors(format!(r#"{{"a":{{"x":{}"#, "[".repeat(4 * MIB))), 60 * MIB),
    ];
    for (name, file, most) in cases {
        let is_zip = file.starts_with(b"PK");
        let (taken, read) =
            peak(
                || {
                    if is_zip {
                        open_and_read(&file)
                    } else {
                        Safetensors::open(Cursor::new(&file)).map(drop)
                    }
                },
            );
        println!(
            "{name}: {} kB of file, {} kB taken, {:?}",
            file.len() / 1000,
            taken / 1000,
            read.map_err(|error| error.to_string())
        );
        assert!(taken < most, "{name}: {taken}");
    }

    let file = checkpoint(&hashed(&Sizes::full(), Parts::ALL), true);
    let (taken, written) = peak(|| {
        let mut source = TorchFile::open(Cursor::new(&file)).unwrap();
        let plan = Import::plan(source.listed(), false).unwrap();
        assert_eq!(source.listed().len(), 1129);
        let mut out = Nowhere { at: 0, end: 0 };
        plan.write(&mut source, &About::default(), &mut out).unwrap();
        out.end
    });
    println!(
        "the full model: {} MB of file, {} kB taken, {} MB written",
        file.len() / 1_000_000,
        taken / 1000,
        written / 1_000_000
    );
    assert!(written > 4 * 70_455_689);
    assert!(taken < 12 * MIB, "{taken}");
}
