//! Files of weights: ours there and back, PyTorch's imported, wrong ones refused with a reason.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "functions beside the tests may fail too"
)]

mod torch_files;

use inkrig_generate::checkpoint::{
    About, CheckpointError, Import, ModelFile, ModelKind, ModelStatistics, NumberKind, Safetensors,
    TensorSource, TorchFile, read_statistics,
};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::networks::{Parts, Sizes, Vae, tensors};
use inkrig_generate::sampling::Semantics;
use inkrig_generate::weights::{Tensor, Tensors, hashed};
use std::io::Cursor;
use torch_files::{Described, Entry, Pickler, checkpoint, strides, zip};

fn open(file: &[u8]) -> Result<TorchFile<Cursor<&[u8]>>, CheckpointError> {
    TorchFile::open(Cursor::new(file))
}

fn statistics() -> ModelStatistics {
    let ramp = |count: usize| (0..count).map(|at| 0.1 + at as f32 * 0.37).collect::<Vec<f32>>();
    ModelStatistics { mean: ramp(263), std: ramp(263), mean_raw: ramp(66), std_raw: ramp(66) }
}

fn import(file: &[u8], about: &About) -> (Import, Vec<u8>) {
    let mut source = open(file).unwrap();
    let plan = Import::plan(source.listed(), false).unwrap();
    let mut out = Cursor::new(Vec::new());
    plan.write(&mut source, about, &mut out).unwrap();
    (plan, out.into_inner())
}

#[test]
fn a_checkpoint_with_all_networks_becomes_a_model_file_number_for_number() {
    let sizes = Sizes { heads: 4, ..Sizes::tiny() };
    let weights = hashed(&sizes, Parts::ALL);
    let skeleton = std::array::from_fn(|joint| [0.0, joint as f32 * 0.01, -0.3].into());
    let about = About {
        name: "kicks".into(),
        licence: "CC0".into(),
        statistics: Some(statistics()),
        skeleton: Some(skeleton),
        ..About::default()
    };
    let (plan, file) = import(&checkpoint(&weights, false), &about);
    assert_eq!((plan.kind(), plan.sizes(), plan.parts()), (ModelKind::Sketch2Anim, &sizes, Parts::ALL));
    assert_eq!(plan.missing().count() + plan.ignored().len(), 0);
    assert_eq!(plan.rows().iter().map(|row| row.found).sum::<usize>(), weights.len());
    assert!(plan.remarks()[0].contains("--blend-model"), "{:?}", plan.remarks());

    let mut model = ModelFile::open(Cursor::new(&file)).unwrap();
    assert_eq!(model.tensors().unwrap(), weights);
    let header = model.header().clone();
    assert_eq!(
        (header.semantics, header.text, header.is_distilled()),
        (Semantics::Official, TextEncoderKind::SentenceT5, true)
    );
    assert_eq!((header.name.as_str(), header.licence.as_str()), ("kicks", "CC0"));
    assert_eq!(header.statistics().unwrap().0.mean(), statistics().mean);
    assert_eq!(header.skeleton().unwrap(), skeleton);
    Vae::new(&header.sizes, &model.tensors().unwrap()).unwrap();
    // Others read it too.
    let others = safetensors::SafeTensors::deserialize(&file).unwrap();
    assert_eq!(others.len(), weights.len());
}

#[test]
fn half_precision_is_read_and_written() {
    let sizes = Sizes { heads: 4, ..Sizes::tiny() };
    let weights = hashed(&sizes, Parts::VAE);
    let about = About { half: true, ..About::default() };
    let (_, file) = import(&checkpoint(&weights, true), &about);
    let back = ModelFile::open(Cursor::new(&file)).unwrap().tensors().unwrap();
    for (name, tensor) in weights.iter() {
        for (a, b) in tensor.data().iter().zip(back.get(name).unwrap().data()) {
            assert!((a - b).abs() <= a.abs() / 1024.0 + 1e-4, "{name}: {a} {b}");
        }
    }
    let (_, single) = import(&checkpoint(&weights, true), &About::default());
    assert_eq!(ModelFile::open(Cursor::new(&single)).unwrap().tensors().unwrap(), back);
    assert!(file.len() * 10 < single.len() * 6);
}

#[test]
fn mld_and_motionlcm_are_told_apart_and_renamed() {
    for (guidance_width, kind, text) in
        [(0, ModelKind::Mld, TextEncoderKind::Clip), (16, ModelKind::MotionLcm, TextEncoderKind::SentenceT5)]
    {
        let sizes = Sizes { heads: 4, guidance_width, ..Sizes::tiny() };
        let parts = Parts { control: false, control_2d: false, ..Parts::ALL };
        let ours = hashed(&sizes, parts);
        let mut theirs: Tensors = ours
            .iter()
            .map(|(name, tensor)| (name.replace("denoiser.denoiser.", "denoiser."), tensor.clone()))
            .collect();
        let extra = Tensor::new(vec![2], vec![0.0; 2]).unwrap();
        for name in
            ["denoiser.mem_pos.pe", "controlnet.x.weight", "t2m_moveencoder.main.0.bias", "text_encoder.a"]
        {
            theirs.insert(name, extra.clone());
        }
        let (plan, file) = import(&checkpoint(&theirs, false), &About::default());
        assert_eq!(plan.kind(), kind);
        assert_eq!(plan.remarks().iter().any(|remark| remark.contains("--blend-model")), guidance_width > 0);
        let why: Vec<&str> = plan.ignored().iter().map(|(_, why)| *why).collect();
        assert_eq!(why.len(), 4);
        for reason in ["another make", "no network of ours", "--evaluator", "files of their own"] {
            assert!(why.iter().any(|why| why.contains(reason)), "{reason}");
        }
        let mut model = ModelFile::open(Cursor::new(&file)).unwrap();
        assert_eq!(model.header().text, text);
        assert_eq!(model.tensors().unwrap(), ours);
        let refused = model.header().statistics().unwrap_err().to_string();
        assert!(refused.contains("--stats") && refused.contains("Mean_raw.npy"), "{refused}");
        assert!(model.header().skeleton().unwrap_err().to_string().contains("000021.npy"));
    }
}

#[test]
fn what_is_missing_or_strange_is_said() {
    let sizes = Sizes { heads: 4, ..Sizes::tiny() };
    let without = |gone: &str| -> Tensors {
        hashed(&sizes, Parts::ALL).into_iter().filter(|(name, _)| !name.starts_with(gone)).collect()
    };
    let file = checkpoint(&without("controlnet.encoder.middle_block.linear1"), false);
    let mut source = open(&file).unwrap();
    let plan = Import::plan(source.listed(), false).unwrap();
    assert_eq!(plan.missing().count(), 2);
    let mut out = Cursor::new(Vec::new());
    let error = plan.write(&mut source, &About::default(), &mut out).unwrap_err().to_string();
    assert_eq!(
        error,
        "this is no model that inkrig knows: it looks like Sketch2Anim, but 2 tensors are missing, such as controlnet.encoder.middle_block.linear1.bias"
    );
    assert!(out.into_inner().is_empty(), "nothing is written");
    // A tensor that no network reads may be missing.
    let file = checkpoint(&without("denoiser.pose_encoder.mem_pos"), false);
    assert_eq!(Import::plan(open(&file).unwrap().listed(), false).unwrap().missing().count(), 0);

    let plan = |tensors: &Tensors| {
        Import::plan(open(&checkpoint(tensors, false)).unwrap().listed(), false).unwrap_err().to_string()
    };
    assert!(plan(&without("vae.")).contains("no tensor of a motion VAE"));
    let mut strange = without("vae.final_layer.bias");
    strange.insert("vae.final_layer.bias", Tensor::new(vec![7], vec![0.0; 7]).unwrap());
    assert!(plan(&strange).contains("the tensor vae.final_layer.bias: its shape is [7], but [263] follows"));
    let mut newer = without("nothing");
    newer.insert("vae.latent_pre.weight", Tensor::new(vec![1], vec![0.0]).unwrap());
    assert!(plan(&newer).contains("version 2"));
}

/// A checkpoint of one tensor that is described as `change` says; 6 numbers are there.
fn one(change: impl FnOnce(&mut Described<'_>)) -> Vec<u8> {
    let mut tensor =
        Described { class: "FloatStorage", key: "0", stored: 6, start: 0, shape: &[2, 3], strides: &[3, 1] };
    change(&mut tensor);
    with_pickle(Pickler::checkpoint(|pickler| {
        pickler.text("a").tensor(&tensor);
    }))
}

fn with_pickle(pickle: Vec<u8>) -> Vec<u8> {
    zip(&entries(pickle))
}

fn entries(pickle: Vec<u8>) -> Vec<Entry> {
    let numbers = (0..6).flat_map(|at| (at as f32).to_le_bytes()).collect();
    vec![
        Entry::new("m/data.pkl", pickle),
        Entry::new("m/data/0", numbers),
        Entry::new("m/version", b"3\n".to_vec()),
    ]
}

fn good() -> Vec<u8> {
    Pickler::checkpoint(|pickler| {
        let (shape, strides) = (&[2, 3], &[3, 1]);
        pickler.text("a").tensor(&Described {
            class: "FloatStorage",
            key: "0",
            stored: 6,
            start: 0,
            shape,
            strides,
        });
    })
}

#[test]
fn views_of_a_storage_are_read_as_they_are_seen() {
    let read = |file: Vec<u8>| open(&file).unwrap().read(0).unwrap().into_data();
    assert_eq!(read(one(|_| ())), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(
        read(one(|tensor| (tensor.shape, tensor.strides) = (&[3, 2], &[1, 3]))),
        [0.0, 3.0, 1.0, 4.0, 2.0, 5.0]
    );
    assert_eq!(
        read(one(|tensor| (tensor.start, tensor.shape, tensor.strides) = (1, &[2], &[4]))),
        [1.0, 5.0]
    );
    assert_eq!(read(one(|tensor| (tensor.shape, tensor.strides) = (&[], &[]))), [0.0]);
    assert_eq!(read(one(|tensor| (tensor.shape, tensor.strides) = (&[0, 3], &[3, 1]))), [0.0; 0]);
    assert_eq!(read(one(|tensor| (tensor.shape, tensor.strides) = (&[3, 1], &[2, 99]))), [0.0, 2.0, 4.0]);
    assert_eq!(strides(&[2, 3, 4]), [12, 4, 1]);
}

#[test]
fn a_pickle_that_names_code_is_refused_by_that_name() {
    let attack = |write: &dyn Fn(&mut Pickler)| {
        let mut pickler = Pickler::default();
        write(pickler.op(&[0x80, 2]));
        pickler.op(b".");
        pickler.bytes
    };
    let system = attack(&|pickler| {
        pickler.name("os", "system").op(b"(").text("touch /tmp/hacked").op(b"tR");
    });
    let message = "the file asks for os.system (byte 2 of its pickle), which weights do not need: nothing of it was run, and it is not read. Where you trust its maker, load it in PyTorch and save its state_dict alone";
    assert_eq!(open(&with_pickle(system.clone())).unwrap_err().to_string(), message);
    // The same without an archive around it.
    assert_eq!(open(&system).unwrap_err().to_string(), message);
    let cases: [(&str, Vec<u8>); 7] = [
        (
            "posix.system",
            attack(&|pickler| {
                pickler.text("posix").text("system").op(&[0x93]);
            }),
        ),
        (
            "builtins.eval",
            attack(&|pickler| {
                pickler.name("builtins", "eval").op(b"(").text("1").op(b"tR");
            }),
        ),
        (
            "os.system",
            attack(&|pickler| {
                pickler.op(b"(").text("ls").op(b"ios\nsystem\n");
            }),
        ),
        (
            "subprocess.Popen",
            attack(&|pickler| {
                pickler.name("subprocess", "Popen").op(b")").op(&[0x81]);
            }),
        ),
        (
            "torch.load",
            attack(&|pickler| {
                pickler.name("torch", "load");
            }),
        ),
        (
            "torch.EvilStorage",
            attack(&|pickler| {
                pickler.name("torch", "EvilStorage");
            }),
        ),
        (
            "collections.abc",
            attack(&|pickler| {
                pickler.name("collections", "abc");
            }),
        ),
    ];
    for (name, pickle) in cases {
        match open(&with_pickle(pickle)).unwrap_err() {
            CheckpointError::Refused { name: refused, .. } => assert_eq!(refused, name),
            other => panic!("{name}: {other}"),
        }
    }
}

#[test]
fn tensors_that_lie_are_refused() {
    for (file, said) in [
        (one(|tensor| tensor.shape = &[i64::MAX, 2]), "larger than its storage of 6 numbers"),
        (
            one(|tensor| (tensor.shape, tensor.strides) = (&[1 << 40], &[0])),
            "larger than its storage of 6 numbers",
        ),
        (one(|tensor| tensor.strides = &[4, 1]), "larger than its storage of 6 numbers"),
        (one(|tensor| tensor.start = 1), "larger than its storage of 6 numbers"),
        (one(|tensor| tensor.start = -1), "a tensor starts at number -1"),
        (one(|tensor| tensor.strides = &[-3, 1]), "shape or strides have the number -3"),
        (one(|tensor| tensor.strides = &[1]), "2 axes and 1 strides"),
        (one(|tensor| (tensor.shape, tensor.strides) = (&[1; 9], &[1; 9])), "9 axes"),
        (one(|tensor| tensor.stored = 7), "7 numbers of 4 bytes are promised, but 24 bytes are there"),
        (one(|tensor| tensor.stored = i64::MAX), "are promised, but 24 bytes are there"),
        (one(|tensor| tensor.stored = -1), "a storage has -1 numbers"),
        (
            one(|tensor| tensor.class = "DoubleStorage"),
            "6 numbers of 8 bytes are promised, but 24 bytes are there",
        ),
        (one(|tensor| tensor.class = "HalfStorage"), "6 numbers of 2 bytes are promised"),
        (one(|tensor| tensor.key = "../data.pkl"), "its numbers, m/data/../data.pkl, are not in the file"),
        (one(|tensor| tensor.class = "float32"), "a storage is not described by"),
    ] {
        let error = open(&file).unwrap_err().to_string();
        assert!(error.contains(said), "{said}: {error}");
    }
    let mut entries = entries(good());
    entries[1].bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = open(&zip(&entries)).unwrap().read(0).unwrap_err().to_string();
    assert_eq!(error, "the tensor a: number 0 is NaN, so the model is broken");
    let twice = Pickler::checkpoint(|pickler| {
        let (shape, strides) = (&[2, 3], &[3, 1]);
        for _ in 0..2 {
            pickler.text("a").tensor(&Described {
                class: "FloatStorage",
                key: "0",
                stored: 6,
                start: 0,
                shape,
                strides,
            });
        }
    });
    let error = open(&with_pickle(twice)).unwrap_err().to_string();
    assert_eq!(error, "the tensor a is there twice: the file says two things at once and is not read");
}

#[test]
fn archives_that_lie_are_refused() {
    let change = |edit: &dyn Fn(&mut Vec<Entry>)| {
        let mut entries = entries(good());
        edit(&mut entries);
        zip(&entries)
    };
    assert!(open(&change(&|_| ())).is_ok());
    for (file, said) in [
        (change(&|entries| entries.push(entries[1].clone())), "the zip entry m/data/0 is there twice"),
        (
            change(&|entries| (entries[1].method, entries[1].length) = (8, Some(u32::MAX - 1))),
            "the zip entry m/data/0 is compressed; weights are stored as they are",
        ),
        (change(&|entries| entries[1].length = Some(1 << 30)), "the zip entry m/data/0 is compressed"),
        (change(&|entries| entries[1].flags = 1), "the zip entry m/data/0 is encrypted"),
        (change(&|entries| entries[1].offset = Some(0)), " overlap: the file is damaged"),
        (change(&|entries| entries[1].offset = Some(1)), "the zip entry m/data/0 is not where it should be"),
        (change(&|entries| entries[1].offset = Some(1 << 30)), "reaches beyond the end of the file"),
        (change(&|entries| entries[0].name = "m/data.pk".into()), "this zip archive has no data.pkl"),
        (
            change(&|entries| entries.push(Entry::new("n/data.pkl", good()))),
            "the zip entry data.pkl is there twice",
        ),
        (change(&|entries| entries.push(Entry::new("m/constants.pkl", good()))), "TorchScript"),
        (change(&|entries| entries.push(Entry::new("m/byteorder", b"big".to_vec()))), "highest byte"),
        (
            change(&|entries| entries[0].bytes = vec![0x80; 5 << 20]),
            "bytes in data.pkl: 5242880, more than the 4194304",
        ),
    ] {
        let error = open(&file).unwrap_err().to_string();
        assert!(error.contains(said), "{said}: {error}");
    }
    let mut damaged = change(&|_| ());
    let at = damaged.windows(8).position(|bytes| bytes == [0, 0, 0x80, 0x3f, 0, 0, 0, 0x40]).unwrap();
    damaged[at] = 1;
    let error = open(&damaged).unwrap().read(0).unwrap_err().to_string();
    assert_eq!(error, "the tensor a: its checksum is wrong: the file is damaged; get it again");
}

#[test]
fn every_cut_is_refused_and_every_other_file_is_named() {
    let file = with_pickle(good());
    for end in 0..file.len() {
        let error = open(&file[..end]).unwrap_err().to_string();
        assert!(error.contains("damaged") || error.contains("none that PyTorch saved"), "{end}: {error}");
    }
    let old = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.\x80\x02M\xe9\x03.";
    let error = open(old).unwrap_err().to_string();
    assert!(error.contains("before version 1.6; save it again in a newer PyTorch"), "{error}");
    assert!(open(b"\x80\x02}.").unwrap_err().to_string().contains("a bare pickle"));
    assert!(open(b"BVH").unwrap_err().to_string().contains("none that PyTorch saved"));
    let no_tensors = Pickler::checkpoint(|pickler| {
        pickler.text("steps").whole(3);
    });
    let error = open(&with_pickle(no_tensors)).unwrap_err().to_string();
    assert_eq!(error, "this is no model that inkrig knows: the file holds no tensors by name, only: steps");
    assert!(
        open(&with_pickle(b"\x80\x02K\x01.".to_vec()))
            .unwrap_err()
            .to_string()
            .contains("holds a whole number")
    );
}

#[test]
fn a_pickle_that_makes_no_sense_is_said_to_at_its_byte() {
    for (pickle, said) in [
        (&b"\x80\x02."[..], "byte 2 of the pickle: something is used that is not there"),
        (b"\x80\x02u.", "byte 2 of the pickle: a list ends that did not begin"),
        (b"\x80\x02K\x01K\x02R.", "a whole number is called as if it were a function"),
        (b"\x80\x02h\x07.", "value 7 is used before it is there"),
        (b"\x80\x02K\x01K\x02a.", "something is added to what is no list"),
        (b"\x80\x02K\x01K\x02K\x03s.", "a key is set in what is no dictionary"),
        (b"\x80\x02}(K\x01u.", "a key has no value"),
        (b"\x80\x09.", "pickle's version 9 is not known"),
        (b"I1\n.", "is in pickle's oldest form"),
        (b"\x80\x02\x82\x01.", "registry of extensions"),
        (b"\x80\x02Pabc\n.", "refers to something outside"),
        (b"\x80\x02\xff", "is no opcode"),
        (b"\x80\x02X\xff\xff\xff\xffabc", "the pickle ends in the middle"),
        (b"\x80\x02\x8d\xff\xff\xff\xff\xff\xff\xff\xffabc", "the pickle ends in the middle"),
        (b"\x80\x02\x8a\x09\x01\x01\x01\x01\x01\x01\x01\x01\x01.", "longer than 8 bytes"),
        (b"\x80\x02X\x01\x00\x00\x00\xff.", "a text is not UTF-8"),
    ] {
        let error = open(&with_pickle(pickle.to_vec())).unwrap_err().to_string();
        assert!(error.contains(said), "{said}: {error}");
    }
    // Deep nesting, forwards and backwards: values lie flat, so nothing overflows.
    let deep = [&b"\x80\x02"[..], &b"]".repeat(900_000), &b"a".repeat(899_999), b"."].concat();
    assert!(open(&with_pickle(deep)).unwrap_err().to_string().contains("holds a list"));
}

#[test]
fn safetensors_that_lie_are_refused() {
    let file = |header: &str, data: usize| {
        let mut file = (header.len() as u64).to_le_bytes().to_vec();
        file.extend_from_slice(header.as_bytes());
        file.resize(file.len() + data, 0);
        file
    };
    let open = |bytes: &[u8]| Safetensors::open(Cursor::new(bytes.to_vec())).map(|file| file.listed().len());
    let tensor = |offsets: &str| format!(r#"{{"dtype":"F32","shape":[2],"data_offsets":{offsets}}}"#);
    let (first, second) = (tensor("[0,8]"), tensor("[8,16]"));
    assert_eq!(open(&file(&format!(r#"{{"a":{first},"b":{second}}}"#), 16)).unwrap(), 2);
    for (header, data, said) in [
        (format!(r#"{{"a":{first},"a":{second}}}"#), 16, "the tensor a is there twice"),
        (format!(r#"{{"a":{first},"b":{first}}}"#), 8, "do not follow the one before"),
        (format!(r#"{{"a":{first},"b":{}}}"#, tensor("[12,20]")), 20, "do not follow the one before"),
        (format!(r#"{{"a":{}}}"#, tensor("[0,4]")), 4, "do not fill its shape"),
        (format!(r#"{{"a":{}}}"#, tensor("[8,0]")), 8, "do not follow"),
        (format!(r#"{{"a":{first}}}"#), 7, "8 bytes of tensors are promised, 7 are there"),
        (format!(r#"{{"a":{first}}}"#), 9, "8 bytes of tensors are promised, 9 are there"),
        (
            r#"{"a":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,0]}}"#.into(),
            0,
            "too long ones",
        ),
        (
            r#"{"a":{"dtype":"F32","shape":[2305843009213693952,2],"data_offsets":[0,0]}}"#.into(),
            0,
            "do not fill its shape",
        ),
        (r#"{"a":{"dtype":"X9","shape":[2],"data_offsets":[0,8]}}"#.into(), 8, "unknown kind X9"),
        (r#"{"a":{"dtype":"F32","shape":[-2],"data_offsets":[0,8]}}"#.into(), 8, "the header:"),
        (r#"{"__metadata__":{"x":"1","x":"2"}}"#.into(), 0, "the text x is there twice"),
        ("[".repeat(5000), 0, "the header:"),
        ("{".into(), 0, "the header:"),
    ] {
        let error = open(&file(&header, data)).unwrap_err().to_string();
        assert!(error.contains(said), "{said}: {error}");
    }
    assert!(
        open(&u64::MAX.to_le_bytes())
            .unwrap_err()
            .to_string()
            .contains("bytes in the header: 18446744073709551615")
    );
    assert!(
        open(&(1_u64 << 20).to_le_bytes()).unwrap_err().to_string().contains("beyond the end of the file")
    );
    let other = open(b"HIERARCHY\nROOT Hips\n").unwrap_err().to_string();
    assert!(other.starts_with("this is no safetensors file; give one"), "{other}");
    let large = [&u64::MAX.to_le_bytes()[..], b"{"].concat();
    assert!(open(&large).unwrap_err().to_string().contains("bytes in the header"));
    assert!(open(b"abc").unwrap_err().to_string().contains("beyond the end of the file"));
}

#[test]
fn a_model_file_is_refused_when_anything_of_it_changed() {
    let sizes = Sizes { heads: 4, ..Sizes::tiny() };
    let (_, file) = import(
        &checkpoint(&hashed(&sizes, Parts::VAE), false),
        &About { statistics: Some(statistics()), ..About::default() },
    );
    let open =
        |file: &[u8]| ModelFile::open(Cursor::new(file.to_vec())).and_then(|mut model| model.tensors());
    assert!(open(&file).is_ok());
    let mut changed = file.clone();
    let last = changed.len() - 1;
    changed[last] ^= 1;
    let error = open(&changed).unwrap_err().to_string();
    assert!(error.contains("the checksum of the weights"), "{error}");
    let replaced = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let at = file.windows(from.len()).position(|bytes| bytes == from.as_bytes()).expect(from);
        let mut changed = file.clone();
        changed[at..at + to.len()].copy_from_slice(to.as_bytes());
        open(&changed).unwrap_err().to_string()
    };
    assert!(replaced(r#"\"version\":1"#, r#"\"version\":7"#).contains("form 7"));
    assert!(replaced(r#"\"heads\":4"#, r#"\"heads\":3"#).contains("width is 16"));
    assert!(replaced("left_hip", "left_hop").contains("its joints are not the 22"));
    assert!(replaced("inkrig.model", "inkrig.modem").contains("is no model of ours"));
    assert!(replaced("sentence-t5", "sentence-t6").contains("the header:"));
}

#[test]
fn statistics_come_from_numpys_files() {
    let npy = |shape: &str, numbers: &[f32]| {
        let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
        bytes.extend_from_slice(header.as_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    };
    let given = statistics();
    let folder = |name: &str| match name {
        "Mean.npy" => Some(npy("(263,)", &given.mean)),
        "Std.npy" => Some(npy("(263,)", &given.std)),
        "Mean_raw.npy" => Some(npy("(22, 3)", &given.mean_raw)),
        "Std_raw.npy" => Some(npy("(66,)", &given.std_raw)),
        "000021.npy" => {
            Some(npy("(2, 22, 3)", &(0..132).map(|at| (at % 7) as f32 * 0.1).collect::<Vec<_>>()))
        }
        _ => None,
    };
    let (read, skeleton) = read_statistics(|name| Ok(folder(name))).unwrap();
    assert_eq!(read, given);
    // The left hip's bone points along +x and is as long as the way from the pelvis.
    let hip = skeleton.unwrap()[1];
    assert!((hip.x - hip.length()).abs() < 1e-6 && hip.x > 0.1);
    let error = |gone: &str| {
        read_statistics(|name| Ok(folder(name).filter(|_| name != gone)))
            .map(|read| read.1.is_none())
            .map_err(|error| error.to_string())
    };
    assert_eq!(error("Std_raw.npy").unwrap_err(), "Std_raw.npy: is not in the folder of statistics");
    assert!(error("000021.npy").unwrap());
    let wrong = read_statistics(|name| Ok(Some(npy("(263,)", &given.mean)).filter(|_| name != "x")))
        .unwrap_err()
        .to_string();
    assert_eq!(wrong, "Mean_raw.npy: has the shape [263], but 66 numbers are needed");
}

#[test]
fn all_published_names_are_found_and_no_other() {
    // Shapes only: the numbers of a full model take 282 MB, and are read in the test of memory.
    let listed: Vec<_> = tensors(&Sizes::full(), Parts::ALL)
        .into_iter()
        .map(|spec| inkrig_generate::checkpoint::Listed {
            name: spec.name,
            shape: spec.shape,
            kind: NumberKind::F32,
        })
        .collect();
    let plan = Import::plan(&listed, false).unwrap();
    assert_eq!(plan.sizes(), &Sizes::full());
    assert_eq!((plan.rows().iter().map(|row| row.found).sum::<usize>(), plan.missing().count()), (1129, 0));
}
