//! Sentence-T5: the text encoder of the published model (Ni et al. 2022, Raffel et al. 2020).

use super::encoder::TextEncoder;
use super::layers::{Files, attention, look_up, normalise};
use super::unigram::Unigram;
use crate::GenerateError;
use crate::checkpoint::{CheckpointError, TensorSource};
use crate::networks::Linear;
use crate::numeric::elementwise::{add, relu};
use serde::Deserialize;

/// Tokens of a description that are read.
const MOST_TOKENS: usize = 256;

/// The part of `config.json` that says how large the network is.
#[derive(Debug, Clone, Deserialize)]
struct Config {
    vocab_size: usize,
    d_model: usize,
    d_kv: usize,
    d_ff: usize,
    num_layers: usize,
    num_heads: usize,
    #[serde(default = "buckets")]
    relative_attention_num_buckets: usize,
    #[serde(default = "distance")]
    relative_attention_max_distance: usize,
    #[serde(default = "epsilon")]
    layer_norm_epsilon: f32,
    feed_forward_proj: String,
}

fn buckets() -> usize {
    32
}

fn distance() -> usize {
    128
}

fn epsilon() -> f32 {
    1e-6
}

/// The encoder with its tokenizer: mean of all tokens, a linear layer, length 1.
#[derive(Debug)]
pub struct T5Encoder {
    config: Config,
    tokenizer: Unigram,
    words: Vec<f32>,
    /// Buckets x heads.
    nearness: Vec<f32>,
    layers: Vec<Layer>,
    norm: Vec<f32>,
    dense: Linear,
    width: usize,
}

#[derive(Debug)]
struct Layer {
    before_attention: Vec<f32>,
    /// Queries, keys, values, output.
    attention: [Linear; 4],
    before_feed_forward: Vec<f32>,
    /// A second one makes it gated.
    inner: Vec<Linear>,
    outer: Linear,
}

impl T5Encoder {
    /// From the texts of `config.json` and `tokenizer.json`, and weights by the names of `transformers`: those of the encoder, and
    /// `linear.weight` of the layer behind it (`2_Dense`), which may be in a second file. `width` is that of its vectors, 768 as published.
    ///
    /// # Errors
    /// [`CheckpointError`] when a file is not understood, or the weights do not fit the configuration.
    pub fn load(
        config: &str,
        tokenizer: &str,
        weights: &mut [&mut dyn TensorSource],
        width: usize,
    ) -> Result<Self, CheckpointError> {
        let in_config = |what: String| CheckpointError::Header { what: format!("config.json: {what}") };
        let config: Config = serde_json::from_str(config).map_err(|error| in_config(error.to_string()))?;
        let gated = match config.feed_forward_proj.as_str() {
            "relu" => false,
            "gated-gelu" => true,
            other => {
                return Err(in_config(format!(
                    "feed_forward_proj is {other:?}, but must be relu or gated-gelu"
                )));
            }
        };
        let sizes = [
            config.vocab_size,
            config.d_model,
            config.d_kv,
            config.d_ff,
            config.num_heads,
            config.num_layers,
        ];
        let few = config.num_layers <= 64 && config.num_heads <= 128 && config.d_kv <= 1024;
        if sizes.contains(&0)
            || !few
            || config.relative_attention_num_buckets < 4
            || config.d_model > 16_384
            || width == 0
        {
            return Err(in_config("its sizes are those of no T5 encoder".into()));
        }
        let mut files = Files(weights);
        let (model, inner) = (config.d_model, config.num_heads * config.d_kv);
        let shared = files.take("shared.weight", &[config.vocab_size, model]);
        let words =
            shared.or_else(|_| files.take("encoder.embed_tokens.weight", &[config.vocab_size, model]))?;
        let near = "encoder.block.0.layer.0.SelfAttention.relative_attention_bias.weight";
        let nearness = files.take(near, &[config.relative_attention_num_buckets, config.num_heads])?;
        let mut layer = |at: usize| {
            let name = |part: &str| format!("encoder.block.{at}.layer.{part}");
            let mut project = |part: &str, outputs, inputs| files.linear(&name(part), outputs, inputs, false);
            let attention = [
                project("0.SelfAttention.q", inner, model)?,
                project("0.SelfAttention.k", inner, model)?,
                project("0.SelfAttention.v", inner, model)?,
                project("0.SelfAttention.o", model, inner)?,
            ];
            let wide: &[&str] = if gated { &["wi_0", "wi_1"] } else { &["wi"] };
            let wide =
                wide.iter().map(|part| project(&format!("1.DenseReluDense.{part}"), config.d_ff, model));
            let wide = wide.collect::<Result<_, _>>()?;
            let outer = project("1.DenseReluDense.wo", model, config.d_ff)?;
            Ok::<_, CheckpointError>(Layer {
                before_attention: files.take(&name("0.layer_norm.weight"), &[model])?,
                attention,
                before_feed_forward: files.take(&name("1.layer_norm.weight"), &[model])?,
                inner: wide,
                outer,
            })
        };
        let layers = (0..config.num_layers).map(&mut layer).collect::<Result<_, _>>()?;
        let norm = files.take("encoder.final_layer_norm.weight", &[model])?;
        let dense = files.linear("linear", width, model, false)?;
        let tokenizer = Unigram::read(tokenizer)?;
        Ok(Self { config, tokenizer, words, nearness, layers, norm, dense, width })
    }

    /// The vector of tokens that are known, the end's included.
    ///
    /// # Errors
    /// [`GenerateError::Setting`] for a token that the network does not know, or for none.
    pub fn encode_tokens(&self, tokens: &[u32]) -> Result<Vec<f32>, GenerateError> {
        if tokens.is_empty() || tokens.len() > MOST_TOKENS {
            let value = tokens.len().to_string();
            return Err(GenerateError::Setting {
                setting: "the number of tokens",
                value,
                needed: "1 to 256",
            });
        }
        let (model, heads) = (self.config.d_model, self.config.num_heads);
        let inner = heads * self.config.d_kv;
        let mut rows = look_up(&self.words, model, tokens)?;
        let near = |head: usize, query: usize, key: usize, score: f32| {
            score + self.nearness.get(self.bucket(query, key) * heads + head).copied().unwrap_or_default()
        };
        for layer in &self.layers {
            let normed = self.scaled(&rows, &layer.before_attention);
            let [queries, keys, values, output] = &layer.attention;
            let tables = [queries, keys, values].map(|linear| linear.apply(&normed));
            let seen = attention([&tables[0], &tables[1], &tables[2]], inner, heads, near);
            add(&mut rows, &output.apply(&seen));
            let normed = self.scaled(&rows, &layer.before_feed_forward);
            let mut wide: Vec<Vec<f32>> = layer.inner.iter().map(|linear| linear.apply(&normed)).collect();
            let mut inner = wide.swap_remove(0);
            match wide.first() {
                Some(gate) => inner.iter_mut().zip(gate).for_each(|(x, gate)| *x = tanh_gelu(*x) * gate),
                None => relu(&mut inner),
            }
            add(&mut rows, &layer.outer.apply(&inner));
        }
        let rows = self.scaled(&rows, &self.norm);
        let mut mean = vec![0.0; model];
        for row in rows.chunks_exact(model) {
            add(&mut mean, row);
        }
        mean.iter_mut().for_each(|x| *x /= tokens.len() as f32);
        let mut vector = self.dense.apply(&mean);
        normalise(&mut vector);
        Ok(vector)
    }

    /// Rows divided by their root mean square, nothing subtracted.
    fn scaled(&self, rows: &[f32], scale: &[f32]) -> Vec<f32> {
        let mut out = Vec::with_capacity(rows.len());
        for row in rows.chunks_exact(scale.len()) {
            let power = row.iter().map(|x| x * x).sum::<f32>() / row.len() as f32;
            let factor = 1.0 / (power + self.config.layer_norm_epsilon).sqrt();
            out.extend(row.iter().zip(scale).map(|(x, scale)| x * factor * scale));
        }
        out
    }

    /// Which of the learned biases two places have: one each for near ones, then wider and wider ranges.
    fn bucket(&self, query: usize, key: usize) -> usize {
        let half = self.config.relative_attention_num_buckets / 2;
        let exact = half / 2;
        let far = query.abs_diff(key);
        let within = if far < exact {
            far
        } else {
            let most = self.config.relative_attention_max_distance.max(exact + 1) as f32;
            let share = (far as f32 / exact as f32).ln() / (most / exact as f32).ln();
            (exact + (share * (half - exact) as f32) as usize).min(half - 1)
        };
        within + if key > query { half } else { 0 }
    }
}

impl TextEncoder for T5Encoder {
    fn width(&self) -> usize {
        self.width
    }

    fn encode(&self, text: &str) -> Result<Vec<f32>, GenerateError> {
        self.encode_tokens(&self.tokenizer.tokens(text, MOST_TOKENS))
    }
}

fn tanh_gelu(x: f32) -> f32 {
    const ROOT: f32 = 0.797_884_6;
    0.5 * x * (1.0 + (ROOT * (x + 0.044_715 * x * x * x)).tanh())
}
