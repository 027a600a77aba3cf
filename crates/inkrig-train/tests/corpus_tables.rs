//! Motion in NumPy's tables becomes the same corpus as other motion; what is wrong with a table is said and costs nothing.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_formats::{ClipChoice, Format, ImportOptions, read_motion};
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{self, Blocks, JOINTS, Joints, WIDTH};
use inkrig_motion::rig::Humanoid;
use inkrig_motion::{Clip, Features};
use inkrig_train::corpus::{Built, Config, Entry, Manifest, Part, Progress, Shard, Split, build};
use safetensors::{Dtype, SafeTensors};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

fn go_on(_: Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The person of the samples.
fn walker() -> Clip {
    let options = ImportOptions { clip: None::<ClipChoice>, ..ImportOptions::default() };
    let bytes = inkrig_samples::find("person").unwrap().bytes;
    read_motion(bytes, Format::Bvh, &options, &|_, _| Err(std::io::ErrorKind::NotFound.into())).unwrap().clip
}

fn walker_joints() -> Vec<Joints> {
    let clip = walker();
    humanml::from_clip(&clip, &Humanoid::find(clip.skeleton()).unwrap())
}

/// A NumPy file of any header and data.
fn npy_of(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..]].concat();
    bytes.extend_from_slice(header.as_bytes());
    bytes.extend_from_slice(data);
    bytes
}

fn single(numbers: impl IntoIterator<Item = f32>) -> Vec<u8> {
    numbers.into_iter().flat_map(f32::to_le_bytes).collect()
}

fn joints_npy(frames: &[Joints]) -> Vec<u8> {
    let data = single(frames.iter().flatten().flat_map(Vec3::to_array));
    npy_of("<f4", false, &format!("({}, {JOINTS}, 3)", frames.len()), &data)
}

fn features_npy(features: &Features) -> Vec<u8> {
    let data = single(features.as_slice().iter().copied());
    npy_of("<f4", false, &format!("({}, {WIDTH})", features.frames()), &data)
}

/// The checksum of zip archives, the plain way.
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg()))
    })
}

/// A zip archive; with `packed`, entries are deflated, in blocks that hold bytes as they are. `claim` changes what it says of lengths.
fn zip(entries: &[(&str, &[u8])], packed: bool, claim: impl Fn(u32) -> u32) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in entries {
        let blocks = bytes.chunks(60_000).enumerate().flat_map(|(index, block)| {
            let (last, length) = ((index + 1) * 60_000 >= bytes.len(), block.len() as u16);
            [&[u8::from(last)], &length.to_le_bytes()[..], &(!length).to_le_bytes(), block].concat()
        });
        let stored: Vec<u8> = if packed { blocks.collect() } else { bytes.to_vec() };
        let method = if packed { 8_u16 } else { 0 };
        let common = [
            &20_u16.to_le_bytes()[..],
            &[0, 0],
            &method.to_le_bytes(),
            &[0; 4],
            &checksum(bytes).to_le_bytes(),
            &(stored.len() as u32).to_le_bytes(),
            &claim(bytes.len() as u32).to_le_bytes(),
            &(name.len() as u16).to_le_bytes(),
            &[0, 0],
        ]
        .concat();
        let at = out.len() as u32;
        out.extend([b"PK\x03\x04", &common[..], name.as_bytes(), &stored].concat());
        let tail = [&[0; 10][..], &at.to_le_bytes(), name.as_bytes()].concat();
        directory.extend([b"PK\x01\x02", &20_u16.to_le_bytes()[..], &common, &tail].concat());
    }
    let (start, count) = (out.len() as u32, entries.len() as u16);
    let length = directory.len() as u32;
    out.extend(directory);
    out.extend([b"PK\x05\x06", &[0; 4][..], &count.to_le_bytes(), &count.to_le_bytes()].concat());
    out.extend([&length.to_le_bytes()[..], &start.to_le_bytes(), &[0, 0]].concat());
    out
}

struct Desk(tempfile::TempDir);

impl Desk {
    fn new(corpus: &str, files: &[(&str, Vec<u8>)]) -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        files.iter().for_each(|(name, bytes)| desk.put(name, bytes));
        desk.put("corpus.toml", corpus.as_bytes());
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) {
        std::fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        std::fs::write(self.path(name), bytes).unwrap();
    }

    fn build(&self) -> Built {
        let config = Config::read(&self.path("corpus.toml")).unwrap();
        build(&config, &self.path("corpus"), Shard::ALL, 2, &go_on).unwrap().unwrap()
    }

    fn features(&self, entry: &Entry) -> Features {
        let part = Part::read(&self.path("corpus").join(&entry.part)).unwrap();
        part.clips[entry.index].prepared.features.clone()
    }
}

fn why<'a>(built: &'a Built, file: &str) -> &'a str {
    built.rejected.iter().find(|entry| entry.file == file).map_or("", |entry| entry.why.as_str())
}

fn largest(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn a_walker_is_the_same_in_tables_as_in_bvh() {
    let own = walker_joints();
    // As AMASS has it: z up, 52 joints, 120 frames a second, double precision.
    let mut amass = Vec::new();
    for pair in own.windows(2) {
        for step in 0..6 {
            let places = (0..52).map(|joint| match joint {
                0..JOINTS => pair[0][joint].lerp(pair[1][joint], step as f32 / 6.0),
                _ => Vec3::ONE,
            });
            amass.extend(places.flat_map(|place| [place.x, -place.z, place.y].map(f64::from)));
        }
    }
    let frames = amass.len() / 156;
    let amass: Vec<u8> = amass.into_iter().flat_map(f64::to_le_bytes).collect();
    let joints = npy_of("<f8", false, &format!("({frames}, 52, 3)"), &amass);
    let rate = npy_of("<f8", false, "()", &120.0_f64.to_le_bytes());
    let gender = npy_of("<U4", false, "()", &[0; 16]);
    let npz = |packed| {
        let tables = [("gender.npy", &gender[..]), ("joints.npy", &joints), ("mocap_framerate.npy", &rate)];
        zip(&tables, packed, |length| length)
    };
    // A rate of turning is the sine of half an angle, whose sign is lost as a body turns its back: only the beginning is compared.
    let features = humanml::features(&humanml::ground(&own[..160])).unwrap();
    let desk = Desk::new(
        "body = 'bvh/walk.bvh'\n\
         [[source]]\nname='bvh'\nfolder='bvh'\nlicence='free'\n\
         [[source]]\nname='amass'\nfolder='amass'\nlicence='free'\nformat='joints'\nup='z'\n\
         [[source]]\nname='plain'\nfolder='plain'\nlicence='free'\nformat='joints'\nframe_rate=20\n\
         [[source]]\nname='humanml'\nfolder='HumanML3D'\nlicence='non-commercial'\nformat='humanml3d'\n",
        &[
            ("bvh/walk.bvh", inkrig_samples::find("person").unwrap().bytes.to_vec()),
            ("amass/ann/packed.npz", npz(true)),
            ("amass/ann/WalkLeft.npz", npz(false)),
            ("amass/ann/LICENSE.txt", b"words".to_vec()),
            ("plain/walk.npy", joints_npy(&own)),
            ("HumanML3D/new_joints/000000.npy", joints_npy(&own)),
            ("HumanML3D/new_joint_vecs/000001.npy", features_npy(&features)),
        ],
    );
    let built = desk.build();
    assert_eq!(built.rejected, []);
    let entries = built.manifest.entries();
    let files: Vec<_> = entries.iter().map(|entry| (entry.file.as_str(), entry.subject.as_str())).collect();
    assert_eq!(
        files,
        [
            ("walk.bvh", "bvh"),
            ("ann/WalkLeft.npz", "ann"),
            ("ann/packed.npz", "ann"),
            ("walk.npy", "plain"),
            ("new_joints/000000.npy", "humanml"),
            ("new_joint_vecs/000001.npy", "humanml"),
        ]
    );
    assert_eq!((entries[1].text.as_str(), entries[1].mirrored_text.as_str()), ("WalkLeft", "WalkRight"));
    let bvh = desk.features(&entries[0]);
    for entry in &entries[1..] {
        let table = desk.features(entry);
        // Features lack the motion's last frame, and a body faces where it does in the second around: the end may differ.
        let rows =
            if table.frames() == bvh.frames() { table.frames() } else { table.frames().saturating_sub(81) };
        assert!(rows > 70, "{}: {rows}", entry.file);
        println!("{}: {} of {} rows", entry.file, rows, table.frames());
        for block in [0..Blocks::ROTATIONS.start, Blocks::VELOCITIES, Blocks::CONTACTS, Blocks::ROTATIONS] {
            let pick = |of: &Features| -> Vec<f32> {
                (0..rows).flat_map(|row| of.row(row)[block.clone()].to_vec()).collect()
            };
            let (table, bvh) = (pick(&table), pick(&bvh));
            let off = largest(&table, &bvh);
            println!("  columns {block:?}: {off:.1e}");
            let most = if entry.file.starts_with("new_joint_vecs") { 1e-3 } else { 2e-5 };
            assert!(off < most, "{} columns {block:?}: {off}", entry.file);
        }
    }
    // The same command once more makes nothing anew, and the same whole.
    let config = Config::read(&desk.path("corpus.toml")).unwrap();
    let all_kept =
        |at: Progress<'_>| if at.kept { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    assert_eq!(build(&config, &desk.path("corpus"), Shard::ALL, 1, &all_kept).unwrap().unwrap(), built);
}

#[test]
fn humanml3d_brings_its_captions_parts_and_splits() {
    let own = walker_joints();
    let frames: Vec<Joints> = own.iter().cycle().take(own.len().min(60)).copied().collect();
    let table = joints_npy(&frames);
    let at = |name: &str| format!("h/new_joints/{name}.npy");
    let seconds = frames.len() as f64 / 20.0;
    let captions = "someone is here#x#0.0#0.0\na person kicks with the left foot.#x#0.0#0.0\n\
                    a man jumps#x#0.25#1.75\n";
    let desk = Desk::new(
        "[[source]]\nname='h'\nfolder='h'\nlicence='non-commercial'\nformat='humanml3d'\n",
        &[
            (&at("000000"), table.clone()),
            (&at("M000000"), table.clone()),
            (&at("000001"), table.clone()),
            (&at("000002"), table.clone()),
            (&at("M000003"), table.clone()),
            (&at("000004"), table.clone()),
            ("h/new_joints/notes.md", b"words".to_vec()),
            ("h/Mean.npy", b"words".to_vec()),
            ("h/texts/000000.txt", captions.into()),
            ("h/texts/000001.txt", b"only words".to_vec()),
            ("h/texts/000002.txt", b"a person turns#x#100.0#101.0".to_vec()),
            ("h/texts/M000003.txt", "a person waves#x#nan#nan".into()),
            ("h/train.txt", b"M000003\n000004\n".to_vec()),
            ("h/val.txt", b"\n".to_vec()),
            ("h/test.txt", b"000000\r\n000004\r\nM000000\r\n".to_vec()),
        ],
    );
    let built = desk.build();
    let entries = built.manifest.entries();
    let seen: Vec<_> = entries
        .iter()
        .map(|entry| (entry.file.as_str(), entry.clip.as_deref(), entry.split, entry.text.as_str()))
        .collect();
    let kick = "a person kicks with the left foot.";
    assert_eq!(
        seen,
        [
            ("new_joints/000000.npy", None, Split::Test, kick),
            ("new_joints/000000.npy", Some("0.25-1.75 s"), Split::Test, "a man jumps"),
            ("new_joints/000004.npy", None, Split::Test, ""),
            ("new_joints/M000003.npy", None, Split::Train, "a person waves"),
        ]
    );
    assert_eq!((entries[0].frames, entries[1].frames), (frames.len() - 1, 35 - 5 - 1));
    assert_eq!(entries[0].actions, ["kick"]);
    assert!(entries[0].mirrored_text.contains("right foot") && entries[0].licence == "non-commercial");
    assert_ne!(entries[0].part, entries[1].part);
    let part = &frames[5..35];
    let direct =
        humanml::features(&humanml::ground(&humanml::uniform(part, &humanml::bone_lengths(&frames[0]))));
    let off = largest(desk.features(&entries[1]).as_slice(), direct.unwrap().as_slice());
    println!("a part of {seconds} seconds: {off:.1e}");
    assert!(off < 1e-5);
    let only = why(&built, "new_joints/000001.npy");
    assert_eq!(only, "cannot be read: line 1 of its captions: it must be caption#tokens#start#end");
    assert!(why(&built, "new_joints/000002.npy").contains("too short: 0 frames"));
    assert!(!built.rejected.iter().any(|entry| entry.file.contains("M000000")));
    assert_eq!(built.rejected.len(), 2);

    std::fs::remove_dir_all(desk.path("h/new_joints")).unwrap();
    let config = Config::read(&desk.path("corpus.toml")).unwrap();
    let error = build(&config, &desk.path("other"), Shard::ALL, 1, &go_on).unwrap_err().to_string();
    assert!(error.contains("no .npy file in new_joint_vecs or new_joints"), "{error}");
}

#[test]
fn a_table_that_cannot_be_used_says_why() {
    let own = walker_joints();
    let good = joints_npy(&own);
    let rate = |rate: f64| npy_of("<f8", false, "()", &rate.to_le_bytes());
    let whole = npy_of("<i8", false, "()", &20_i64.to_le_bytes());
    let npz = |tables: &[(&str, &[u8])]| zip(tables, false, |length| length);
    let shape = |shape: &str| {
        let data = single(own.iter().flatten().flat_map(Vec3::to_array));
        npy_of("<f4", false, shape, &data)
    };
    let mut broken = own.clone();
    broken[3][4].x = f32::NAN;
    let far: Vec<Joints> = own.iter().map(|pose| pose.map(|place| place + 2000.0 * Vec3::X)).collect();
    let poses = npz(&[("poses.npy", &good), ("trans.npy", &good), ("mocap_framerate.npy", &rate(120.0))]);
    let bomb = zip(&[("joints.npy", &good), ("fps.npy", &whole)], true, |_| u32::MAX - 1);
    let liar = zip(&[("joints.npy", &good), ("fps.npy", &whole)], true, |length| length - 4);
    let tail = npy_of("<f4", false, "(5000000, 24, 3)", &[0; 64]);
    let cases: [(&str, Vec<u8>, &str); 21] = [
        (
            "j/smpl.npz",
            poses,
            "no human body: it has the turns of a body model (poses) and no places of joints",
        ),
        ("j/other.npz", npz(&[("betas.npy", &good)]), "no table `joints`, `Jtr` or `positions`"),
        ("j/rateless.npy", good.clone(), "how many frames a second"),
        ("j/rateless.npz", npz(&[("Jtr.npy", &good)]), "give frame_rate in its [[source]]"),
        ("j/still.npz", npz(&[("joints.npy", &good), ("fps.npy", &rate(0.0))]), "0 frames a second are none"),
        ("j/rates.npz", npz(&[("joints.npy", &good), ("fps.npy", &good)]), "fps"),
        ("j/bomb.npz", bomb, "bytes in the table"),
        ("j/liar.npz", liar, "not what the archive says of it"),
        ("j/cut.npz", npz(&[("joints.npy", &good)])[..900].to_vec(), "no directory at its end"),
        ("j/empty.npz", Vec::new(), "is no NumPy file"),
        ("j/few.npy", shape(&format!("({}, 11, 3)", 2 * own.len())), "11 joints, 22 in the order of SMPL"),
        ("j/flat.npy", shape(&format!("({}, 66)", own.len())), "frames x joints x 3 is needed"),
        ("j/huge.npy", tail, "other numbers than its shape says"),
        ("j/none.npy", npy_of("<f4", false, "(0, 22, 3)", &[]), "frames x joints x 3 is needed"),
        ("j/nan.npy", joints_npy(&broken), "no finite number"),
        ("j/pickle.npy", npy_of("|O", false, "(1, 22, 3)", b"cos\nsystem\n"), "other than f4 or f8"),
        ("j/fortran.npy", npy_of("<f4", true, "(1, 22, 3)", &[0; 264]), "Fortran"),
        ("r/far.npy", joints_npy(&far), "farther than a kilometre"),
        ("r/features.npy", npy_of("<f4", false, "(1, 263)", &[0; 1052]), "format = \"humanml3d\""),
        ("r/short.npy", joints_npy(&own[..5]), "too short: 5 frames"),
        ("m/table.npy", good.clone(), "give its [[source]] format = \"joints\""),
    ];
    let sources = "[[source]]\nname='j'\nfolder='j'\nlicence='free'\nformat='joints'\n\
                   [[source]]\nname='r'\nfolder='r'\nlicence='free'\nformat='joints'\nframe_rate=20\n\
                   [[source]]\nname='m'\nfolder='m'\nlicence='free'\n";
    let mut files: Vec<(&str, Vec<u8>)> =
        cases.iter().map(|(name, bytes, _)| (*name, bytes.clone())).collect();
    files.push(("j/good.npz", npz(&[("positions.npy", &good), ("fps.npy", &whole)])));
    files.push(("r/long.npy", npy_of("<f4", false, "(72002, 22, 3)", &vec![0; 72_002 * 264])));
    let desk = Desk::new(sources, &files);
    let built = desk.build();
    let used: Vec<_> = built.manifest.entries().iter().map(|entry| entry.file.as_str()).collect();
    assert_eq!(used, ["good.npz"]);
    for (name, _, said) in &cases {
        let (_, file) = name.split_once('/').unwrap();
        let why = why(&built, file);
        assert!(why.contains(said), "{name}: {why}");
    }
    assert!(why(&built, "long.npy").contains("longer than an hour"));
    assert_eq!(built.rejected.len(), cases.len() + 1);

    // Whatever a byte of an archive is: it is read or refused.
    let archive = zip(&[("joints.npy", &good[..400]), ("fps.npy", &whole)], true, |length| length);
    for at in 0..archive.len() {
        let mut bytes = archive.clone();
        bytes[at] ^= 0x41;
        desk.put(&format!("j/x{at}.npz"), &bytes);
    }
    assert_eq!(desk.build().manifest.entries().len(), 1);
}

/// A file of the reference folder; `None`, said in one line, where that is not there.
fn vectors(name: &str) -> Option<Vec<u8>> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("vectors/sketch2anim").join(name).with_extension("safetensors");
    let bytes = std::fs::read(&file).ok();
    if bytes.is_none() {
        println!("skipped: no reference vectors at {}", file.display());
    }
    bytes
}

fn numbers(bytes: &[u8], name: &str) -> Vec<f32> {
    let file = SafeTensors::deserialize(bytes).unwrap();
    let tensor = file.tensor(name).unwrap();
    let data = tensor.data();
    match tensor.dtype() {
        Dtype::F64 => data.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes) as f32).collect(),
        _ => data.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect(),
    }
}

#[test]
fn the_authors_features_come_out_of_their_joints() {
    let Some(bytes) = vectors("humanml_process") else { return };
    let table = |name: &str| {
        let own = numbers(&bytes, name);
        npy_of("<f4", false, &format!("({}, {JOINTS}, 3)", own.len() / 66), &single(own))
    };
    let desk = Desk::new(
        "body='h/new_joints/000001.npy'\n[[source]]\nname='h'\nfolder='h'\nlicence='non-commercial'\nformat='humanml3d'\n",
        &[
            ("h/new_joints/000000.npy", table("joints_in")),
            ("h/new_joints/000001.npy", table("uniform_skeleton")),
        ],
    );
    let built = desk.build();
    let stored = numbers(&bytes, "features");
    let entries = built.manifest.entries();
    assert_eq!((entries.len(), entries[0].frames * WIDTH), (2, stored.len()));
    let off = largest(desk.features(&entries[0]).as_slice(), &stored);
    println!("against the authors' features: {off:.1e}");
    assert!(off < 1e-4);
    assert!(Manifest::read(Path::new(&desk.path("corpus"))).is_ok());
}
