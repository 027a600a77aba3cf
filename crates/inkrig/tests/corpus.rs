//! All motion of the reference folder is read as the program reads it, in a table:
//! `cargo test --release -p inkrig --test corpus -- --nocapture`.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may panic, and prints its table"
)]

use inkrig::{cli::ImportArgs, load};
use inkrig_formats::{Format, Import};
use inkrig_motion::kinematics;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Files that hold a skeleton only: for motions beside them, or, of the last, not even that.
const NO_MOTIONS: [&str; 3] = ["deepmimic/dog3d.txt", "deepmimic/humanoid3d.txt", "creatures/fox-model.glb"];

#[test]
fn every_motion_of_the_reference_folder_is_read() {
    let Some(data) = data() else { return };
    let index = frames_of_captures(&data);
    let mut table: BTreeMap<(String, &str), Line> = BTreeMap::new();
    let mut checked = 0;
    for path in files(&data) {
        let name = path.strip_prefix(&data).unwrap().to_str().unwrap().to_owned();
        let Some(format) = path.extension().and_then(|ending| Format::from_extension(ending.to_str()?))
        else {
            continue;
        };
        if NO_MOTIONS.contains(&name.as_str()) {
            continue;
        }
        let capture = index.get(&name);
        // AMC files have no frame rate.
        let source_fps = capture.filter(|_| format == Format::Amc).map(|(rate, _)| *rate);
        let read = |clip: Option<String>| {
            load::motion(&path, &ImportArgs { source_fps, clip, ..ImportArgs::default() })
                .unwrap_or_else(|error| panic!("{error}"))
        };
        let line = table.entry((name.split('/').next().unwrap().to_owned(), format.name())).or_default();
        line.files += 1;
        let first = read(None);
        if let Some((_, frames)) = capture {
            assert_eq!(first.clip.frames(), *frames, "{name}");
            checked += 1;
        }
        for number in 2..=first.clips.len() {
            line.add(&name, &read(Some(number.to_string())));
        }
        line.add(&name, &first);
    }
    println!(
        "{:<30}{:<11}{:>6}{:>7}  joints   frames  seconds  size, m",
        "folder", "format", "files", "clips"
    );
    let mut all = Line::default();
    for ((folder, format), line) in &table {
        println!("{folder:<30}{format:<11}{}", line.text());
        all.join(line);
    }
    println!("{:<41}{}", "all", all.text());
    assert_eq!(checked, index.len(), "captures of the index");
    // As `find` counts the files, without those of NO_MOTIONS.
    let count =
        |format: &str| table.iter().filter(|((_, own), _)| *own == format).map(|(_, line)| line.files).sum();
    let counts: [usize; 4] = ["BVH", "AMC", "GLB", "DeepMimic"].map(count);
    assert_eq!(counts, [357, 318, 19, 24]);
}

#[test]
fn files_without_a_motion_say_so() {
    let Some(data) = data() else { return };
    for (name, words) in NO_MOTIONS.iter().zip(["no skeleton", "no skeleton", "a mesh without a skeleton"]) {
        let error = load::motion(&data.join(name), &ImportArgs::default()).unwrap_err().to_string();
        println!("{name}: {error}");
        assert!(error.contains(words), "{error}");
    }
}

/// What a folder holds in one format.
#[derive(Default)]
struct Line {
    files: usize,
    clips: usize,
    /// Numbers of joints that occur, end sites left out.
    joints: BTreeSet<usize>,
    frames: usize,
    seconds: f64,
    /// Smallest and largest figure, metres.
    sizes: Option<[f32; 2]>,
}

impl Line {
    fn add(&mut self, name: &str, import: &Import) {
        let (clip, skeleton) = (&import.clip, import.clip.skeleton());
        let positions = kinematics::positions(clip);
        for frame in 0..clip.frames() {
            assert!(positions.frame(frame).iter().all(|place| place.is_finite()), "{name} at {frame}");
        }
        let joints = skeleton.joints().iter().filter(|joint| !joint.end_site).count();
        let size = skeleton.extent();
        assert!(clip.frames() > 0 && (10.0..=121.0).contains(&clip.frame_rate()), "{name}");
        // From a bird to a wolf drawn three times its size: a wrong unit would be ten times off, or more.
        assert!((0.3..10.0).contains(&size), "{name}: {size} m");
        self.join(&Self {
            files: 0,
            clips: 1,
            joints: BTreeSet::from([joints]),
            frames: clip.frames(),
            seconds: clip.frames() as f64 / clip.frame_rate(),
            sizes: Some([size; 2]),
        });
    }

    fn join(&mut self, other: &Self) {
        self.files += other.files;
        self.clips += other.clips;
        self.joints.extend(&other.joints);
        self.frames += other.frames;
        self.seconds += other.seconds;
        self.sizes = match (self.sizes, other.sizes) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (one, other) => one.or(other),
        };
    }

    fn text(&self) -> String {
        let (least, most) = (self.joints.first().unwrap_or(&0), self.joints.last().unwrap_or(&0));
        let [small, large] = self.sizes.unwrap_or_default();
        format!(
            "{:>6}{:>7}{:>8}{:>9}{:>9.1}{:>9}",
            self.files,
            self.clips,
            format!("{least}-{most}"),
            self.frames,
            self.seconds,
            format!("{small:.1}-{large:.1}")
        )
    }
}

/// The folder `data`; `None`, said in one line, where it is not there.
fn data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or(beside, PathBuf::from).join("data");
    if folder.is_dir() {
        return Some(folder);
    }
    assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "no reference data in {}", folder.display());
    println!("skipped: no reference data in {}", folder.display());
    None
}

/// All files below a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries.into_iter().flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// Frames a second and frames of every capture that the folder's own index lists.
fn frames_of_captures(data: &Path) -> BTreeMap<String, (f64, usize)> {
    let index = std::fs::read_to_string(data.join("cmu-index.csv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[2].to_owned(), (cells[3].parse().unwrap(), cells[4].parse().unwrap()))
    };
    index.lines().skip(1).map(row).collect()
}
