//! The text half of CLIP: the paper's text encoder (Radford et al. 2021).

use super::bpe::BytePairs;
use super::encoder::TextEncoder;
use super::layers::{Files, attention, look_up};
use crate::GenerateError;
use crate::checkpoint::{CheckpointError, TensorSource};
use crate::networks::Linear;
use crate::numeric::elementwise::add;
use crate::numeric::normal::{LayerNorm, Normalised};
use crate::weights::{Tensor, Tensors};
use serde::Deserialize;

/// The part of `config.json` that says how large the network is.
#[derive(Debug, Clone, Deserialize)]
struct Config {
    vocab_size: usize,
    hidden_size: usize,
    intermediate_size: usize,
    projection_dim: usize,
    num_hidden_layers: usize,
    num_attention_heads: usize,
    max_position_embeddings: usize,
    #[serde(default = "quick")]
    hidden_act: String,
}

fn quick() -> String {
    "quick_gelu".into()
}

/// The network with its tokenizer. A description's vector is what its last token becomes, projected.
#[derive(Debug)]
pub struct ClipEncoder {
    config: Config,
    tokenizer: BytePairs,
    words: Vec<f32>,
    positions: Vec<f32>,
    layers: Vec<Layer>,
    norm: LayerNorm,
    projection: Linear,
}

#[derive(Debug)]
struct Layer {
    norms: [LayerNorm; 2],
    /// Queries, keys, values, output.
    attention: [Linear; 4],
    feed_forward: [Linear; 2],
}

impl ClipEncoder {
    /// From the texts of `config.json` (of the text half) and `tokenizer.json`, and weights by the names of `transformers`.
    ///
    /// # Errors
    /// [`CheckpointError`] when a file is not understood, or the weights do not fit the configuration.
    pub fn load(
        config: &str,
        tokenizer: &str,
        weights: &mut [&mut dyn TensorSource],
    ) -> Result<Self, CheckpointError> {
        let in_config = |what: String| CheckpointError::Header { what: format!("config.json: {what}") };
        let config: Config = serde_json::from_str(config).map_err(|error| in_config(error.to_string()))?;
        if config.hidden_act != "quick_gelu" {
            return Err(in_config(format!("hidden_act is {:?}, but must be quick_gelu", config.hidden_act)));
        }
        let (width, wide, heads) = (config.hidden_size, config.intermediate_size, config.num_attention_heads);
        let heads_fit =
            (1..=128).contains(&heads) && width > 0 && width.is_multiple_of(heads) && width <= 16_384;
        let sizes = [config.vocab_size, wide, config.projection_dim, config.num_hidden_layers];
        let places = (3..=4096).contains(&config.max_position_embeddings);
        if !heads_fit || sizes.contains(&0) || !places || config.num_hidden_layers > 64 {
            return Err(in_config("its sizes are those of no text encoder of CLIP".into()));
        }
        let mut files = Files(weights);
        let part = |name: &str| format!("text_model.{name}");
        let words = files.take(&part("embeddings.token_embedding.weight"), &[config.vocab_size, width])?;
        let table = [config.max_position_embeddings, width];
        let positions = files.take(&part("embeddings.position_embedding.weight"), &table)?;
        let mut layers = Vec::new();
        for at in 0..config.num_hidden_layers {
            let name = |part: &str| format!("text_model.encoder.layers.{at}.{part}");
            layers.push(Layer {
                norms: [
                    norm(&mut files, &name("layer_norm1"), width)?,
                    norm(&mut files, &name("layer_norm2"), width)?,
                ],
                attention: [
                    files.linear(&name("self_attn.q_proj"), width, width, true)?,
                    files.linear(&name("self_attn.k_proj"), width, width, true)?,
                    files.linear(&name("self_attn.v_proj"), width, width, true)?,
                    files.linear(&name("self_attn.out_proj"), width, width, true)?,
                ],
                feed_forward: [
                    files.linear(&name("mlp.fc1"), wide, width, true)?,
                    files.linear(&name("mlp.fc2"), width, wide, true)?,
                ],
            });
        }
        let norm = norm(&mut files, &part("final_layer_norm"), width)?;
        let projection = files.linear("text_projection", config.projection_dim, width, false)?;
        let tokenizer = BytePairs::read(tokenizer)?;
        Ok(Self { config, tokenizer, words, positions, layers, norm, projection })
    }

    /// The vector of tokens that are known, from the start's to the end's.
    ///
    /// # Errors
    /// [`GenerateError::Setting`] for a token that the network does not know, for none, or more than it has places for.
    pub fn encode_tokens(&self, tokens: &[u32]) -> Result<Vec<f32>, GenerateError> {
        let (width, heads) = (self.config.hidden_size, self.config.num_attention_heads);
        if tokens.is_empty() || tokens.len() > self.config.max_position_embeddings {
            let value = tokens.len().to_string();
            let needed = "at least 1, and no more than the text encoder has places for";
            return Err(GenerateError::Setting { setting: "the number of tokens", value, needed });
        }
        let mut rows = look_up(&self.words, width, tokens)?;
        let places = rows.len();
        add(&mut rows, &self.positions[..places]);
        let scale = 1.0 / ((width / heads) as f32).sqrt();
        // What comes later is not seen, so nothing behind the end matters.
        let earlier = |_: usize, query: usize, key: usize, score: f32| {
            if key <= query { scale * score } else { f32::MIN }
        };
        let mut kept = Normalised::default();
        for layer in &self.layers {
            let mut normed = rows.clone();
            layer.norms[0].forward(&mut normed, &mut kept);
            let [queries, keys, values, output] = &layer.attention;
            let tables = [queries, keys, values].map(|linear| linear.apply(&normed));
            let seen = attention([&tables[0], &tables[1], &tables[2]], width, heads, earlier);
            add(&mut rows, &output.apply(&seen));
            let mut normed = rows.clone();
            layer.norms[1].forward(&mut normed, &mut kept);
            let [inner, outer] = &layer.feed_forward;
            let mut inner = inner.apply(&normed);
            inner.iter_mut().for_each(|x| *x /= 1.0 + (-1.702 * *x).exp());
            add(&mut rows, &outer.apply(&inner));
        }
        let mut last = rows.split_off(rows.len() - width);
        self.norm.forward(&mut last, &mut kept);
        Ok(self.projection.apply(&last))
    }
}

impl TextEncoder for ClipEncoder {
    fn width(&self) -> usize {
        self.config.projection_dim
    }

    fn encode(&self, text: &str) -> Result<Vec<f32>, GenerateError> {
        self.encode_tokens(&self.tokenizer.tokens(text, self.config.max_position_embeddings))
    }
}

fn norm(files: &mut Files<'_, '_>, name: &str, width: usize) -> Result<LayerNorm, CheckpointError> {
    let mut both = Tensors::new();
    for part in ["weight", "bias"] {
        let name = format!("{name}.{part}");
        let numbers = files.take(&name, &[width])?;
        both.insert(name, Tensor::new(vec![width], numbers)?);
    }
    Ok(LayerNorm::new(&both, name, width)?)
}
