//! No header makes the decoder allocate more than a small multiple of the bytes that are really there.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "counting what is allocated takes an allocator, which is unsafe by nature; functions beside the tests may fail too"
)]

mod common;

use common::{ENCODED, fixture, seal_ogg, still_flac, wav};
use inkrig_sound::decode;
use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};

struct Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator unchanged; the counters do not touch memory.
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

/// Bytes alive at the worst moment of decoding, above what was alive before, and whether it was read.
fn peak(bytes: &[u8]) -> (usize, bool) {
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    let read = decode(bytes, "").is_ok();
    (PEAK.load(Relaxed) - before, read)
}

/// An Ogg file whose setup header describes `books` codebooks of `2^length` words, in 29 bytes each.
fn codebooks(books: u32, length: u32) -> Vec<u8> {
    let mut bits: Vec<u32> = Vec::new();
    let mut put = |value: u32, width: u32| bits.extend((0..width).map(|place| value >> place & 1));
    put(books - 1, 8);
    for _ in 0..books {
        let entries = 1 << length;
        let header =
            [(0x56_4342, 24), (30, 16), (entries, 24), (1, 1), (length - 1, 5), (entries, length + 1)];
        let lookup = [(1, 4), (0, 32), (0, 32), (0, 4), (0, 1), (1, 1)];
        for (value, width) in header.into_iter().chain(lookup) {
            put(value, width);
        }
    }
    let byte = |eight: &[u32]| eight.iter().enumerate().map(|(place, bit)| (bit << place) as u8).sum::<u8>();
    let mut setup = b"\x05vorbis".to_vec();
    setup.extend(bits.chunks(8).map(byte));
    let ident = b"\x01vorbis\0\0\0\0\x01\x40\x1f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xb8\x01".to_vec();
    let comment = b"\x03vorbis\0\0\0\0\0\0\0\0\x01".to_vec();
    // Without a page of sound the reader would not get as far as the decoder.
    [page(2, 0, &ident), page(0, 1, &comment), page(0, 2, &setup), page(4, 3, &[0; 8])].concat()
}

/// An Ogg page with one packet and its checksum.
fn page(flags: u8, number: u8, packet: &[u8]) -> Vec<u8> {
    let mut page = b"OggS\0".to_vec();
    page.push(flags);
    page.extend([0; 8]);
    page.extend([7, 0, 0, 0, number, 0, 0, 0, 0, 0, 0, 0]);
    page.push((packet.len() / 255 + 1) as u8);
    page.extend(vec![255; packet.len() / 255]);
    page.push((packet.len() % 255) as u8);
    page.extend(packet);
    seal_ogg(&mut page);
    page
}

// The only test of its file: others at the same time would be counted too.
#[test]
fn hostile_headers_allocate_little() {
    let mut lie = fixture("melody.wav");
    lie[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    lie[40..44].copy_from_slice(&0xffff_fff0_u32.to_le_bytes());
    let mut long = fixture("melody.flac");
    // 2^36 - 1 samples, in 36 bits.
    long[21] |= 0x0f;
    long[22..26].fill(0xff);
    let mut blocks = fixture("melody.flac");
    // The largest block and frame sizes.
    blocks[8..18].fill(0xff);
    let mut cases = vec![
        ("a WAV that claims 4 GiB", lie),
        ("a FLAC that claims 2^36 samples", long),
        ("a FLAC of the largest blocks", blocks),
        ("a WAV of 65535 channels", wav(1, 65_535, 8000, 32, &[0; 100])),
        ("a WAV of 26 channels", wav(3, 26, 8000, 64, &[0; 26 * 8 * 500])),
        ("a WAV of 8 bits", wav(1, 1, 8000, 8, &[9; 500_000])),
        ("huge Vorbis codebooks", codebooks(256, 17)),
        ("one huge Vorbis codebook", codebooks(1, 17)),
        ("an ID3 tag of 256 MiB", b"ID3\x04\0\0\x7f\x7f\x7f\x7f".repeat(10)),
        ("nothing but page headers", b"OggS\0\x02\0\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0\0\0\0\0\0".repeat(4000)),
        ("nothing but frame headers", b"\xff\xfb\x90\x64".repeat(20_000)),
    ];
    cases.extend(ENCODED.map(|extension| ("a good file", fixture(&format!("melody.{extension}")))));
    // What is made once for all files: tables of the decoders.
    for extension in ENCODED {
        peak(&fixture(&format!("melody.{extension}")));
    }
    println!("{:<36}{:>10}{:>10}", "case", "bytes", "peak");
    for (name, bytes) in &cases {
        let (peak, read) = peak(bytes);
        println!("{name:<36}{:>10}{peak:>10}  {}", bytes.len(), if read { "read" } else { "refused" });
        assert!(peak <= 16 * bytes.len() + (6 << 20), "{name}: {peak} bytes for a file of {}", bytes.len());
    }
    // A small file may hold a long sound: what it costs goes with the sound, and too long a one is refused by its header.
    let blocks = 400;
    let long = still_flac(8000, blocks, u64::from(blocks) * 16_384);
    let (highest, read) = peak(&long);
    let samples = blocks as usize * 16_384;
    println!("{samples} samples in {} bytes of FLAC: peak {highest}", long.len());
    assert!(read && highest <= 3 * 4 * samples + (6 << 20), "{highest} bytes for {samples} samples");
    let (highest, read) = peak(&still_flac(8000, 2000, 3335 * 8000));
    assert!(!read && highest < 6 << 20, "{highest} bytes for a sound that is too long");
    // The largest codebooks that are let through cost a fixed amount that does not grow with the file.
    for (books, length) in [(63, 9), (4, 14), (2, 14)] {
        let bytes = codebooks(books, length);
        let (peak, _) = peak(&bytes);
        println!("{books} Vorbis codebooks of {length} bits: {} bytes, peak {peak}", bytes.len());
        assert!(peak <= 112 << 20, "{peak} bytes for {books} codebooks");
    }
}
