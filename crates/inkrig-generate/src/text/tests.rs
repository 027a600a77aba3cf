//! Encoders and tokenizers against what `transformers` and `tokenizers` made of the same files (`benches/peers/text_fixtures.py`).

use super::bpe::BytePairs;
use super::unigram::Unigram;
use super::{ClipEncoder, T5Encoder, TextEncoder};
use crate::checkpoint::{Safetensors, TensorSource};
use crate::numeric::testing::apart;
use std::collections::BTreeMap;
use std::io::Cursor;

const UNIGRAM: &str = include_str!("../../tests/fixtures/text/unigram.json");
const PAIRS: &str = include_str!("../../tests/fixtures/text/bpe.json");
const TOKENS: &str = include_str!("../../tests/fixtures/text/tokens.json");

type File = Safetensors<Cursor<&'static [u8]>>;

fn open(bytes: &'static [u8]) -> (File, String) {
    let file = Safetensors::open(Cursor::new(bytes)).unwrap();
    let config = file.metadata()["config"].clone();
    (file, config)
}

/// Tokens, and the vector that they should become.
fn cases(file: &mut File) -> Vec<(Vec<u32>, Vec<f32>)> {
    let mut read = |name: String| {
        let at = file.listed().iter().position(|listed| listed.name == name)?;
        Some(file.read(at).unwrap().into_data())
    };
    let case = |at: usize| Some((read(format!("case.{at}.tokens"))?, read(format!("case.{at}.vector"))?));
    let cases: Vec<_> = (0..).map_while(case).collect();
    assert!(cases.len() == 3);
    cases.into_iter().map(|(tokens, vector)| (tokens.iter().map(|x| *x as u32).collect(), vector)).collect()
}

#[test]
fn t5_is_that_of_transformers() {
    for bytes in [
        &include_bytes!("../../tests/fixtures/text/t5.safetensors")[..],
        include_bytes!("../../tests/fixtures/text/t5_gated.safetensors"),
    ] {
        let (mut file, config) = open(bytes);
        let cases = cases(&mut file);
        let encoder = T5Encoder::load(&config, UNIGRAM, &mut [&mut file], 16).unwrap();
        for (tokens, vector) in cases {
            let off = apart(&encoder.encode_tokens(&tokens).unwrap(), &vector);
            assert!(off < 2e-6, "{} tokens: {off}", tokens.len());
        }
        assert_eq!(encoder.width(), 16);
        assert!(encoder.encode_tokens(&[40]).is_err() && encoder.encode_tokens(&[]).is_err());
        // This tokenizer knows more pieces than the network: that is said, and nothing else happens.
        assert!(
            encoder.encode("zebra").is_ok()
                || encoder.encode("zebra").unwrap_err().to_string().contains("belong together")
        );
        let wrong = config.replace("\"d_model\": 24", "\"d_model\": 16");
        assert!(T5Encoder::load(&wrong, UNIGRAM, &mut [&mut file], 16).is_err());
        assert!(T5Encoder::load(&config, PAIRS, &mut [&mut file], 16).is_err());
        assert!(T5Encoder::load("{", UNIGRAM, &mut [&mut file], 16).is_err());
    }
}

#[test]
fn clip_is_that_of_transformers() {
    let (mut file, config) = open(include_bytes!("../../tests/fixtures/text/clip.safetensors"));
    let cases = cases(&mut file);
    let encoder = ClipEncoder::load(&config, PAIRS, &mut [&mut file]).unwrap();
    for (tokens, vector) in cases {
        let off = apart(&encoder.encode_tokens(&tokens).unwrap(), &vector);
        assert!(off < 1e-5, "{} tokens: {off}", tokens.len());
    }
    assert_eq!(encoder.width(), 16);
    assert!(encoder.encode_tokens(&[1; 21]).is_err() && encoder.encode_tokens(&[99]).is_err());
    assert!(ClipEncoder::load(&config, UNIGRAM, &mut [&mut file]).is_err());
    assert!(ClipEncoder::load(&config.replace("quick_gelu", "relu"), PAIRS, &mut [&mut file]).is_err());
}

#[test]
fn tokens_are_those_of_the_tokenizers_library() {
    let cases: BTreeMap<String, Vec<(String, Vec<u32>)>> = serde_json::from_str(TOKENS).unwrap();
    let (unigram, pairs) = (Unigram::read(UNIGRAM).unwrap(), BytePairs::read(PAIRS).unwrap());
    for (text, tokens) in &cases["unigram"] {
        assert_eq!(&unigram.tokens(text, 100), tokens, "{text}");
    }
    for (text, tokens) in &cases["bpe"] {
        assert_eq!(&pairs.tokens(text, 100), tokens, "{text}");
    }
    assert_eq!(unigram.tokens("a a a a", 3).len(), 3);
    assert!(pairs.tokens(&"x".repeat(100_000), 77).len() == 77 && Unigram::read("{}").is_err());
}
