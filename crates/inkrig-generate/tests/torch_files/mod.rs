//! Writes files in the form of `torch.save`, right and wrong ones. (`cargo xtask torch` has PyTorch itself write one.)
#![allow(dead_code, clippy::unwrap_used, clippy::panic, reason = "shared by tests")]

use inkrig_generate::weights::Tensors;

/// A pickle being written.
#[derive(Default)]
pub(crate) struct Pickler {
    pub(crate) bytes: Vec<u8>,
}

impl Pickler {
    pub(crate) fn op(&mut self, bytes: &[u8]) -> &mut Self {
        self.bytes.extend_from_slice(bytes);
        self
    }

    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        self.op(b"X").op(&(text.len() as u32).to_le_bytes()).op(text.as_bytes())
    }

    pub(crate) fn whole(&mut self, number: i64) -> &mut Self {
        match i32::try_from(number) {
            Ok(number) => self.op(b"J").op(&number.to_le_bytes()),
            Err(_) => self.op(&[0x8a, 8]).op(&number.to_le_bytes()),
        }
    }

    pub(crate) fn wholes(&mut self, numbers: &[i64]) -> &mut Self {
        self.op(b"(");
        for &number in numbers {
            self.whole(number);
        }
        self.op(b"t")
    }

    pub(crate) fn name(&mut self, module: &str, name: &str) -> &mut Self {
        self.op(format!("c{module}\n{name}\n").as_bytes())
    }

    pub(crate) fn ordered(&mut self) -> &mut Self {
        self.name("collections", "OrderedDict").op(b")R")
    }

    pub(crate) fn tensor(&mut self, tensor: &Described<'_>) -> &mut Self {
        self.name("torch._utils", "_rebuild_tensor_v2").op(b"((").text("storage").name("torch", tensor.class);
        self.text(tensor.key).text("cpu").whole(tensor.stored).op(b"tQ").whole(tensor.start);
        self.wholes(tensor.shape).wholes(tensor.strides).op(&[0x89]).ordered().op(b"tR")
    }

    /// All of a training checkpoint around what `inside` writes as name, tensor, name, tensor.
    pub(crate) fn checkpoint(inside: impl FnOnce(&mut Self)) -> Vec<u8> {
        let mut pickler = Self::default();
        pickler.op(&[0x80, 2]).op(b"}(").text("epoch").whole(12).text("state_dict").ordered().op(b"(");
        inside(&mut pickler);
        // What PyTorch's modules leave behind: attributes of the dictionary.
        pickler
            .op(b"u}")
            .text("_metadata")
            .ordered()
            .op(b"sb")
            .text("lr")
            .op(b"G")
            .op(&1e-4_f64.to_be_bytes());
        pickler.op(b"u.");
        pickler.bytes
    }
}

/// A tensor as a pickle describes it.
pub(crate) struct Described<'a> {
    pub(crate) class: &'a str,
    pub(crate) key: &'a str,
    pub(crate) stored: i64,
    pub(crate) start: i64,
    pub(crate) shape: &'a [i64],
    pub(crate) strides: &'a [i64],
}

/// An entry of an archive; fields say something else than what is there in wrong files.
#[derive(Clone)]
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    pub(crate) method: u16,
    pub(crate) flags: u16,
    /// How long it is said to be, unpacked; else as long as it is.
    pub(crate) length: Option<u32>,
    /// The directory leads to this place instead.
    pub(crate) offset: Option<u32>,
}

impl Entry {
    pub(crate) fn new(name: &str, bytes: Vec<u8>) -> Self {
        Self { name: name.into(), bytes, method: 0, flags: 0, length: None, offset: None }
    }
}

/// A zip archive with numbers at multiples of 64 bytes and a directory of the 64 bit kind, as PyTorch writes it.
pub(crate) fn zip(entries: &[Entry]) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for entry in entries {
        let header = out.len();
        let checksum = checksum(&entry.bytes);
        let packed = entry.bytes.len() as u32;
        let length = entry.length.unwrap_or(packed);
        let padding =
            (header + 30 + entry.name.len() + 4).next_multiple_of(64) - (header + 30 + entry.name.len() + 4);
        let fields = |out: &mut Vec<u8>| {
            for field in [entry.flags, entry.method, 0, 0] {
                out.extend_from_slice(&field.to_le_bytes());
            }
            for field in [checksum, packed, length] {
                out.extend_from_slice(&field.to_le_bytes());
            }
            out.extend_from_slice(&(entry.name.len() as u16).to_le_bytes());
        };
        out.extend_from_slice(b"PK\x03\x04\0\0");
        fields(&mut out);
        out.extend_from_slice(&(padding as u16 + 4).to_le_bytes());
        out.extend_from_slice(entry.name.as_bytes());
        out.extend_from_slice(b"FB");
        out.extend_from_slice(&(padding as u16).to_le_bytes());
        out.resize(out.len() + padding, b'Z');
        out.extend_from_slice(&entry.bytes);
        directory.extend_from_slice(b"PK\x01\x02\0\0\0\0");
        fields(&mut directory);
        directory.resize(directory.len() + 12, 0);
        directory.extend_from_slice(&entry.offset.unwrap_or(header as u32).to_le_bytes());
        directory.extend_from_slice(entry.name.as_bytes());
    }
    let (start, count) = (out.len() as u64, entries.len() as u64);
    out.extend_from_slice(&directory);
    let end = out.len() as u64;
    out.extend_from_slice(b"PK\x06\x06");
    for field in [44, 0, 0, count, count, directory.len() as u64, start] {
        // Versions, and numbers of disks, are four fields of two and four bytes, all zero here.
        out.extend_from_slice(&u64::to_le_bytes(field));
    }
    // The fields above are twelve bytes of versions and disks; one of the two zeros is four bytes too long.
    let cut = end as usize + 4 + 8 + 12;
    out.drain(cut..cut + 4);
    out.extend_from_slice(b"PK\x06\x07\0\0\0\0");
    out.extend_from_slice(&end.to_le_bytes());
    out.extend_from_slice(&1_u32.to_le_bytes());
    out.extend_from_slice(b"PK\x05\x06\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\0\0");
    out
}

/// A whole training checkpoint of these tensors, in single or half precision.
pub(crate) fn checkpoint(tensors: &Tensors, half: bool) -> Vec<u8> {
    let mut entries =
        vec![Entry::new("archive/data.pkl", Vec::new()), Entry::new("archive/byteorder", b"little".to_vec())];
    let pickle = Pickler::checkpoint(|pickler| {
        for (at, (name, tensor)) in tensors.iter().enumerate() {
            let shape: Vec<i64> = tensor.shape().iter().map(|&length| length as i64).collect();
            let key = at.to_string();
            let class = if half { "HalfStorage" } else { "FloatStorage" };
            let (stored, strides) = (tensor.data().len() as i64, strides(&shape));
            let described =
                Described { class, key: &key, stored, start: 0, shape: &shape, strides: &strides };
            pickler.text(name).tensor(&described);
            let bytes = if half {
                tensor.data().iter().flat_map(|&number| half_bits(number).to_le_bytes()).collect()
            } else {
                tensor.data().iter().flat_map(|number| number.to_le_bytes()).collect()
            };
            entries.push(Entry::new(&format!("archive/data/{at}"), bytes));
        }
    });
    entries[0].bytes = pickle;
    entries.push(Entry::new("archive/version", b"3\n".to_vec()));
    zip(&entries)
}

pub(crate) fn strides(shape: &[i64]) -> Vec<i64> {
    let mut strides = vec![1; shape.len()];
    for at in (1..shape.len()).rev() {
        strides[at - 1] = strides[at] * shape[at];
    }
    strides
}

/// Half precision by cutting off, for numbers of its normal range; all others become 0.
pub(crate) fn half_bits(number: f32) -> u16 {
    let bits = number.to_bits();
    let exponent = (bits >> 23 & 0xff) as i32 - 112;
    if (1..31).contains(&exponent) {
        (bits >> 16 & 0x8000) as u16 | (exponent as u16) << 10 | (bits >> 13 & 0x3ff) as u16
    } else {
        0
    }
}

/// The checksum of zip, bit by bit.
pub(crate) fn checksum(bytes: &[u8]) -> u32 {
    // A table would be quicker to run; this is quicker to believe.
    let table: Vec<u32> = (0..256_u32)
        .map(|value| {
            (0..8).fold(value, |value, _| if value & 1 == 1 { 0xedb8_8320 ^ value >> 1 } else { value >> 1 })
        })
        .collect();
    !bytes.iter().fold(!0, |crc: u32, byte| table[usize::from(crc as u8 ^ byte)] ^ crc >> 8)
}
