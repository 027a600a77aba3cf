//! FBX: binary and text to read, binary 7.4 to write.

mod read;
mod write;

pub use read::read_fbx;
pub(crate) use read::read_fbx_with;
pub use write::write_fbx;

/// Ticks of the format's clock in a second.
const TICKS: f64 = 46_186_158_000.0;

/// Rates that the format has a number for (`TimeMode`), frames a second. Others are said as they are, by number 14.
const TIME_MODES: [(f64, i32); 11] = [
    (120.0, 1),
    (100.0, 2),
    (60.0, 3),
    (50.0, 4),
    (48.0, 5),
    (30.0, 6),
    (25.0, 10),
    (24.0, 11),
    (1000.0, 12),
    (96.0, 15),
    (72.0, 16),
];

/// The property of a limb that says that it is an end site.
const END_SITE: &str = "inkrig_end_site";
