//! One video track as WebM, which is Matroska (RFC 9559) with few codecs: all sizes are known, and the table of what can be jumped to
//! stands before the pictures.

/// Elements, by their numbers in RFC 9559.
mod id {
    pub(super) const EBML: u32 = 0x1A45_DFA3;
    pub(super) const EBML_VERSION: u32 = 0x4286;
    pub(super) const EBML_READ_VERSION: u32 = 0x42F7;
    pub(super) const EBML_MAX_ID_LENGTH: u32 = 0x42F2;
    pub(super) const EBML_MAX_SIZE_LENGTH: u32 = 0x42F3;
    pub(super) const DOC_TYPE: u32 = 0x4282;
    pub(super) const DOC_TYPE_VERSION: u32 = 0x4287;
    pub(super) const DOC_TYPE_READ_VERSION: u32 = 0x4285;
    pub(super) const SEGMENT: u32 = 0x1853_8067;
    pub(super) const SEEK_HEAD: u32 = 0x114D_9B74;
    pub(super) const SEEK: u32 = 0x4DBB;
    pub(super) const SEEK_ID: u32 = 0x53AB;
    pub(super) const SEEK_POSITION: u32 = 0x53AC;
    pub(super) const INFO: u32 = 0x1549_A966;
    pub(super) const TIMESTAMP_SCALE: u32 = 0x2A_D7B1;
    pub(super) const DURATION: u32 = 0x4489;
    pub(super) const MUXING_APP: u32 = 0x4D80;
    pub(super) const WRITING_APP: u32 = 0x5741;
    pub(super) const TRACKS: u32 = 0x1654_AE6B;
    pub(super) const TRACK_ENTRY: u32 = 0xAE;
    pub(super) const TRACK_NUMBER: u32 = 0xD7;
    pub(super) const TRACK_UID: u32 = 0x73C5;
    pub(super) const TRACK_TYPE: u32 = 0x83;
    pub(super) const FLAG_LACING: u32 = 0x9C;
    pub(super) const LANGUAGE: u32 = 0x22_B59C;
    pub(super) const DEFAULT_DURATION: u32 = 0x23_E383;
    pub(super) const CODEC_ID: u32 = 0x86;
    pub(super) const CODEC_PRIVATE: u32 = 0x63A2;
    pub(super) const VIDEO: u32 = 0xE0;
    pub(super) const PIXEL_WIDTH: u32 = 0xB0;
    pub(super) const PIXEL_HEIGHT: u32 = 0xBA;
    pub(super) const COLOUR: u32 = 0x55B0;
    pub(super) const MATRIX: u32 = 0x55B1;
    pub(super) const RANGE: u32 = 0x55B9;
    pub(super) const TRANSFER: u32 = 0x55BA;
    pub(super) const PRIMARIES: u32 = 0x55BB;
    pub(super) const CUES: u32 = 0x1C53_BB6B;
    pub(super) const CUE_POINT: u32 = 0xBB;
    pub(super) const CUE_TIME: u32 = 0xB3;
    pub(super) const CUE_TRACK_POSITIONS: u32 = 0xB7;
    pub(super) const CUE_TRACK: u32 = 0xF7;
    pub(super) const CUE_CLUSTER_POSITION: u32 = 0xF1;
    pub(super) const CLUSTER: u32 = 0x1F43_B675;
    pub(super) const TIMESTAMP: u32 = 0xE7;
    pub(super) const SIMPLE_BLOCK: u32 = 0xA3;
}

/// The only track.
const TRACK: u64 = 1;
const VIDEO_TRACK: u64 = 1;
/// BT.709, and brightness from 16 to 235.
const BT709: u64 = 1;
const LIMITED: u64 = 1;
/// A tick is a millisecond.
const TICK_NANOSECONDS: u64 = 1_000_000;
const SECOND_TICKS: u64 = 1000;
/// The flag of a picture that needs no other.
const WHOLE: u8 = 0x80;

/// What is said of the pictures.
pub(super) struct Track<'a> {
    /// The codec's name, and what a decoder is given first.
    pub(super) codec: &'static str,
    pub(super) description: &'a [u8],
    /// Width and height, pixels.
    pub(super) size: [usize; 2],
    /// Pictures a second.
    pub(super) rate: usize,
}

/// An encoded picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Picture {
    /// Whether it needs no picture before it.
    pub(super) whole: bool,
    pub(super) bytes: Vec<u8>,
}

/// The file. `parts`: pictures one after the other, of which the first of each part is whole; a part is shorter than half a minute.
pub(super) fn file(track: &Track<'_>, parts: &[Vec<Picture>]) -> Vec<u8> {
    let ticks = |number: usize| number as u64 * SECOND_TICKS / track.rate.max(1) as u64;
    let mut number = 0;
    let clusters: Vec<(u64, Vec<u8>)> = parts
        .iter()
        .map(|part| {
            let begins = ticks(number);
            let mut blocks = unsigned(id::TIMESTAMP, begins);
            for picture in part {
                let after = (ticks(number) - begins) as i16;
                let mut block = vec![0x80 | TRACK as u8];
                block.extend(after.to_be_bytes());
                block.push(if picture.whole { WHOLE } else { 0 });
                block.extend_from_slice(&picture.bytes);
                blocks.extend(element(id::SIMPLE_BLOCK, &block));
                number += 1;
            }
            (begins, element(id::CLUSTER, &blocks))
        })
        .collect();
    let info = info(ticks(number));
    let tracks = tracks(track);
    // Places count from the segment's first byte. Numbers are as long as they can be, so that none of them moves what they tell of.
    let mut heads = Heads { info: 0, tracks: 0, cues: 0 };
    let head = seek_head(&heads).len() as u64;
    heads.info = head;
    heads.tracks = heads.info + info.len() as u64;
    heads.cues = heads.tracks + tracks.len() as u64;
    let mut at = heads.cues + cues(clusters.iter().map(|(time, _)| (*time, 0))).len() as u64;
    let places: Vec<(u64, u64)> = clusters
        .iter()
        .map(|(time, cluster)| {
            let own = at;
            at += cluster.len() as u64;
            (*time, own)
        })
        .collect();
    let mut segment = [seek_head(&heads), info, tracks, cues(places.into_iter())].concat();
    for (_, cluster) in &clusters {
        segment.extend_from_slice(cluster);
    }
    [header(), element(id::SEGMENT, &segment)].concat()
}

/// Where the parts of the segment's head stand.
struct Heads {
    info: u64,
    tracks: u64,
    cues: u64,
}

fn header() -> Vec<u8> {
    let inside = [
        unsigned(id::EBML_VERSION, 1),
        unsigned(id::EBML_READ_VERSION, 1),
        unsigned(id::EBML_MAX_ID_LENGTH, 4),
        unsigned(id::EBML_MAX_SIZE_LENGTH, 8),
        element(id::DOC_TYPE, b"webm"),
        unsigned(id::DOC_TYPE_VERSION, 4),
        unsigned(id::DOC_TYPE_READ_VERSION, 2),
    ];
    element(id::EBML, &inside.concat())
}

fn seek_head(heads: &Heads) -> Vec<u8> {
    let seek = |name: u32, at: u64| {
        let inside = [element(id::SEEK_ID, &name.to_be_bytes()), unsigned(id::SEEK_POSITION, at)];
        element(id::SEEK, &inside.concat())
    };
    let all = [seek(id::INFO, heads.info), seek(id::TRACKS, heads.tracks), seek(id::CUES, heads.cues)];
    element(id::SEEK_HEAD, &all.concat())
}

fn info(ticks: u64) -> Vec<u8> {
    let inside = [
        unsigned(id::TIMESTAMP_SCALE, TICK_NANOSECONDS),
        element(id::DURATION, &(ticks as f64).to_be_bytes()),
        element(id::MUXING_APP, b"inkrig"),
        element(id::WRITING_APP, b"inkrig"),
    ];
    element(id::INFO, &inside.concat())
}

fn tracks(track: &Track<'_>) -> Vec<u8> {
    let colour = [
        unsigned(id::MATRIX, BT709),
        unsigned(id::RANGE, LIMITED),
        unsigned(id::TRANSFER, BT709),
        unsigned(id::PRIMARIES, BT709),
    ];
    let video = [
        unsigned(id::PIXEL_WIDTH, track.size[0] as u64),
        unsigned(id::PIXEL_HEIGHT, track.size[1] as u64),
        element(id::COLOUR, &colour.concat()),
    ];
    let nanoseconds = TICK_NANOSECONDS * SECOND_TICKS / track.rate.max(1) as u64;
    let entry = [
        unsigned(id::TRACK_NUMBER, TRACK),
        unsigned(id::TRACK_UID, TRACK),
        unsigned(id::TRACK_TYPE, VIDEO_TRACK),
        unsigned(id::FLAG_LACING, 0),
        element(id::LANGUAGE, b"und"),
        unsigned(id::DEFAULT_DURATION, nanoseconds),
        element(id::CODEC_ID, track.codec.as_bytes()),
        element(id::CODEC_PRIVATE, track.description),
        element(id::VIDEO, &video.concat()),
    ];
    element(id::TRACKS, &element(id::TRACK_ENTRY, &entry.concat()))
}

/// Times and places of what can be jumped to.
fn cues(points: impl Iterator<Item = (u64, u64)>) -> Vec<u8> {
    let points = points.flat_map(|(time, at)| {
        let place = [unsigned(id::CUE_TRACK, TRACK), unsigned(id::CUE_CLUSTER_POSITION, at)];
        let place = element(id::CUE_TRACK_POSITIONS, &place.concat());
        element(id::CUE_POINT, &[unsigned(id::CUE_TIME, time), place].concat())
    });
    element(id::CUES, &points.collect::<Vec<u8>>())
}

/// Its number, its size, and what is in it.
fn element(name: u32, inside: &[u8]) -> Vec<u8> {
    let mut bytes: Vec<u8> = name.to_be_bytes().into_iter().skip_while(|byte| *byte == 0).collect();
    bytes.extend(size(inside.len() as u64));
    bytes.extend_from_slice(inside);
    bytes
}

/// A size in as few bytes as hold it: the place of the first bit that is set says how many; all bits set would mean that nobody knows.
fn size(length: u64) -> Vec<u8> {
    let bytes = (1..8).find(|bytes| length < (1 << (7 * bytes)) - 1).unwrap_or(8);
    let marked = length | 1 << (7 * bytes);
    marked.to_be_bytes().into_iter().skip(8 - bytes).collect()
}

/// A whole number, always in eight bytes.
fn unsigned(name: u32, value: u64) -> Vec<u8> {
    element(name, &value.to_be_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is in a file, by a reader of its own: number, where it begins in its parent, and its bytes.
    fn inside(mut bytes: &[u8]) -> Vec<(u32, usize, &[u8])> {
        let (whole, mut found) = (bytes.len(), Vec::new());
        while let Some(first) = bytes.first() {
            let at = whole - bytes.len();
            let name = 1 + first.leading_zeros() as usize;
            let number = bytes[..name].iter().fold(0, |sum, byte| sum << 8 | u32::from(*byte));
            let long = 1 + bytes[name].leading_zeros() as usize;
            let size = bytes[name..name + long].iter().fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte));
            let size = (size & !(1 << (7 * long))) as usize;
            found.push((number, at, &bytes[name + long..name + long + size]));
            bytes = &bytes[name + long + size..];
        }
        found
    }

    fn only(bytes: &[u8], name: u32) -> &[u8] {
        let all: Vec<&[u8]> =
            inside(bytes).into_iter().filter(|own| own.0 == name).map(|own| own.2).collect();
        assert_eq!(all.len(), 1, "{name:x}");
        all[0]
    }

    fn number(bytes: &[u8]) -> u64 {
        bytes.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte))
    }

    fn two_parts() -> Vec<u8> {
        let picture = |whole, length| Picture { whole, bytes: vec![5; length] };
        let parts = [vec![picture(true, 300), picture(false, 127)], vec![picture(true, 20_000)]];
        file(&Track { codec: "V_AV1", description: &[0x81, 4], size: [680, 360], rate: 20 }, &parts)
    }

    #[test]
    fn every_place_that_is_told_is_one() {
        let bytes = two_parts();
        let top = inside(&bytes);
        assert_eq!(top.iter().map(|own| own.0).collect::<Vec<_>>(), [id::EBML, id::SEGMENT]);
        assert_eq!(only(top[0].2, id::DOC_TYPE), b"webm");
        let segment = top[1].2;
        let at = |place: u64| inside(segment).into_iter().find(|own| own.1 as u64 == place).unwrap();
        for (_, _, seek) in inside(only(segment, id::SEEK_HEAD)) {
            let place = number(only(seek, id::SEEK_POSITION));
            assert_eq!(u64::from(at(place).0), number(only(seek, id::SEEK_ID)));
        }
        let cues: Vec<(u64, u64)> = inside(only(segment, id::CUES))
            .iter()
            .map(|(_, _, cue)| {
                let place = only(only(cue, id::CUE_TRACK_POSITIONS), id::CUE_CLUSTER_POSITION);
                let (name, _, cluster) = at(number(place));
                assert_eq!(name, id::CLUSTER);
                (number(only(cue, id::CUE_TIME)), number(only(cluster, id::TIMESTAMP)))
            })
            .collect();
        assert_eq!(cues, [(0, 0), (100, 100)]);
    }

    #[test]
    fn pictures_stand_at_their_times() {
        let bytes = two_parts();
        let segment = inside(&bytes)[1].2;
        let duration = only(only(segment, id::INFO), id::DURATION);
        assert_eq!(f64::from_be_bytes(duration.try_into().unwrap()), 150.0);
        let mut found = Vec::new();
        for (_, _, cluster) in inside(segment).into_iter().filter(|own| own.0 == id::CLUSTER) {
            let begins = number(only(cluster, id::TIMESTAMP));
            for (_, _, block) in inside(cluster).into_iter().filter(|own| own.0 == id::SIMPLE_BLOCK) {
                assert_eq!(block[0], 0x81);
                found.push((begins + number(&block[1..3]), block[3], block.len() - 4));
            }
        }
        assert_eq!(found, [(0, WHOLE, 300), (50, 0, 127), (100, WHOLE, 20_000)]);
    }

    #[test]
    fn sizes_are_as_short_as_they_may_be() {
        assert_eq!(size(0), [0x80]);
        assert_eq!(size(126), [0xfe]);
        // In one byte it would be the one that says that nobody knows.
        assert_eq!(size(127), [0x40, 127]);
        assert_eq!(size(16_382), [0x7f, 0xfe]);
        assert_eq!(size(16_383), [0x20, 0x3f, 0xff]);
        assert_eq!(size(1 << 50), (1_u64 << 50 | 1 << 56).to_be_bytes());
    }
}
