//! A transformer block: attention, perhaps a look at a memory, feed-forward; each added to what came in, then normalised.

use super::Sizes;
use super::dropout::Dropout;
use super::linear::Linear;
use crate::GenerateError;
use crate::numeric::attention::{AttentionWork, Sequence};
use crate::numeric::elementwise::{add, gelu, gelu_gradient};
use crate::numeric::fit;
use crate::numeric::normal::{LayerNorm, Normalised};
use crate::numeric::product::OuterWork;
use crate::weights::Tensors;
use std::ops::Range;

/// Tokens of one or more sequences, one after the other, and what they look at.
#[derive(Clone, Copy)]
pub(crate) struct Layout<'a> {
    /// Tokens of each sequence. Attention stays within them.
    pub(crate) lengths: &'a [usize],
    /// The memory of all sequences, one after the other, and the tokens that each has in it.
    pub(crate) memory: Option<(&'a [f32], usize)>,
}

/// One block with its weights.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    width: usize,
    attention: Attention,
    norm_attention: LayerNorm,
    memory: Option<(Attention, LayerNorm)>,
    widen: Linear,
    narrow: Linear,
    norm: LayerNorm,
    feed_forward: usize,
}

/// What the gradient needs of a forward pass.
#[derive(Debug, Clone, Default)]
pub(crate) struct BlockTape {
    attention: AttentionTape,
    norm_attention: Normalised,
    memory: AttentionTape,
    norm_memory: Normalised,
    wide: Vec<f32>,
    norm: Normalised,
    inputs: Inputs,
}

/// What went into the linear layers of a block: only the gradients of weights need it.
#[derive(Debug, Clone, Default)]
struct Inputs {
    kept: bool,
    dropout: Option<Dropout>,
    x: Vec<f32>,
    mixed: Vec<f32>,
    attended: Vec<f32>,
    memory_mixed: Vec<f32>,
    looked_up: Vec<f32>,
}

impl BlockTape {
    /// Whether the next forward pass keeps what the gradients of weights need.
    pub(crate) fn keep_inputs(&mut self, keep: bool, dropout: Option<Dropout>) {
        self.inputs.kept = keep;
        self.inputs.dropout = dropout;
    }
}

/// The row that the gradients of all weights are added to, in the order of [`crate::weights::Tensors::row`].
pub(crate) struct WeightGradients<'a> {
    pub(crate) row: &'a mut [f32],
    pub(crate) work: &'a mut OuterWork,
}

fn keep(buffer: &mut Vec<f32>, numbers: &[f32]) {
    buffer.clear();
    buffer.extend_from_slice(numbers);
}

/// Buffers that blocks share.
#[derive(Debug, Clone, Default)]
pub(crate) struct BlockWork {
    attention: AttentionWork,
    part: Vec<f32>,
    other: Vec<f32>,
    wide: Vec<f32>,
    dropped: Vec<f32>,
    grads: [Vec<f32>; 3],
}

impl Block {
    pub(crate) fn new(
        weights: &Tensors,
        name: &str,
        sizes: &Sizes,
        memory: bool,
    ) -> Result<Self, GenerateError> {
        let (width, wide) = (sizes.width, sizes.feed_forward);
        let norm = |at: usize| LayerNorm::new(weights, &format!("{name}.norm{at}"), width);
        let attention = |part: &str| Attention::new(weights, &format!("{name}.{part}"), sizes);
        Ok(Self {
            width,
            attention: attention("self_attn")?,
            norm_attention: norm(1)?,
            memory: if memory { Some((attention("multihead_attn")?, norm(2)?)) } else { None },
            widen: Linear::new(weights, &format!("{name}.linear1"), wide, width)?,
            narrow: Linear::new(weights, &format!("{name}.linear2"), width, wide)?,
            norm: norm(if memory { 3 } else { 2 })?,
            feed_forward: wide,
        })
    }

    /// In place.
    pub(crate) fn forward(
        &self,
        x: &mut [f32],
        layout: Layout<'_>,
        tape: &mut BlockTape,
        work: &mut BlockWork,
    ) {
        fit(&mut work.part, x.len());
        let kept = tape.inputs.kept;
        if kept {
            keep(&mut tape.inputs.x, x);
        }
        let spans = spans(layout.lengths, layout.lengths);
        self.attention.forward(
            x,
            x,
            spans,
            &mut work.part,
            &mut tape.attention,
            &mut work.attention,
            &mut work.other,
        );
        if kept {
            keep(&mut tape.inputs.mixed, &work.other);
        }
        if let Some(dropout) = tape.inputs.dropout {
            dropout.apply(&mut work.part, 0);
        }
        add(x, &work.part);
        self.norm_attention.forward(x, &mut tape.norm_attention);
        if kept {
            keep(&mut tape.inputs.attended, x);
        }

        if let (Some((attention, norm)), Some((memory, tokens))) = (&self.memory, layout.memory) {
            attention.look_up(x, memory, layout.lengths, tokens, tape, work);
            if kept {
                keep(&mut tape.inputs.memory_mixed, &work.other);
            }
            add(x, &work.part);
            norm.forward(x, &mut tape.norm_memory);
        }

        if kept {
            keep(&mut tape.inputs.looked_up, x);
        }
        let wide = x.len() / self.width * self.feed_forward;
        self.widen.forward(x, fit(&mut tape.wide, wide));
        gelu(&tape.wide, fit(&mut work.wide, wide));
        self.narrow.forward(&work.wide, &mut work.part);
        if let Some(dropout) = tape.inputs.dropout {
            dropout.apply(&mut work.part, 1);
        }
        add(x, &work.part);
        self.norm.forward(x, &mut tape.norm);
    }

    /// From the gradient of what came out to that of what went in, in place; that of the memory is added to
    /// `grad_memory`, those of weights where they are asked for (the forward pass has to have kept its inputs then). The
    /// first block of a decoder has nothing before its attention that anybody asks for: with `memory_only` it stops there.
    #[allow(clippy::too_many_arguments, reason = "buffers of one pass")]
    pub(crate) fn backward(
        &self,
        grad: &mut [f32],
        layout: Layout<'_>,
        grad_memory: &mut [f32],
        memory_only: bool,
        tape: &BlockTape,
        work: &mut BlockWork,
        mut weights: Option<&mut WeightGradients<'_>>,
    ) {
        let inputs = &tape.inputs;
        if let Some(to) = weights.as_deref_mut() {
            self.norm.weight_gradient(grad, &tape.norm, to.row);
        }
        self.norm.backward(grad, &tape.norm);
        let mut dropped = std::mem::take(&mut work.dropped);
        let part = inputs.dropout.map_or(&*grad, |dropout| dropout.back(grad, 1, &mut dropped));
        if let Some(to) = weights.as_deref_mut() {
            gelu(&tape.wide, fit(&mut work.wide, tape.wide.len()));
            self.narrow.weight_gradient(&work.wide, part, to.row, to.work);
        }
        self.narrow.backward(part, fit(&mut work.wide, tape.wide.len()), false);
        work.dropped = dropped;
        gelu_gradient(&tape.wide, &mut work.wide);
        if let Some(to) = weights.as_deref_mut() {
            self.widen.weight_gradient(&inputs.looked_up, &work.wide, to.row, to.work);
        }
        self.widen.backward(&work.wide, grad, true);

        if let (Some((attention, norm)), Some((memory, tokens))) = (&self.memory, layout.memory) {
            if let Some(to) = weights.as_deref_mut() {
                norm.weight_gradient(grad, &tape.norm_memory, to.row);
            }
            norm.backward(grad, &tape.norm_memory);
            let (last, kept) = (memory_only, (&inputs.attended[..], &inputs.memory_mixed[..]));
            attention.look_up_back(
                grad,
                memory,
                (layout.lengths, tokens),
                grad_memory,
                last,
                &tape.memory,
                work,
                kept,
                weights.as_deref_mut(),
            );
        }
        if memory_only {
            return;
        }
        if let Some(to) = weights.as_deref_mut() {
            self.norm_attention.weight_gradient(grad, &tape.norm_attention, to.row);
        }
        self.norm_attention.backward(grad, &tape.norm_attention);
        let spans = spans(layout.lengths, layout.lengths);
        let mut dropped = std::mem::take(&mut work.dropped);
        let part = inputs.dropout.map_or(&*grad, |dropout| dropout.back(grad, 0, &mut dropped));
        self.attention.backward(part, spans, &tape.attention, work);
        if let Some(to) = weights {
            self.attention.weight_gradients(&inputs.x, &inputs.x, (&inputs.mixed, part), &work.grads, to);
        }
        work.dropped = dropped;
        let [queries, keys, values] = &work.grads;
        self.attention.queries.backward(queries, grad, true);
        self.attention.keys.backward(keys, grad, true);
        self.attention.values.backward(values, grad, true);
    }
}

/// Attention with its projections.
#[derive(Debug, Clone)]
struct Attention {
    heads: usize,
    width: usize,
    queries: Linear,
    keys: Linear,
    values: Linear,
    out: Linear,
}

#[derive(Debug, Clone, Default)]
struct AttentionTape {
    queries: Vec<f32>,
    keys: Vec<f32>,
    values: Vec<f32>,
    probabilities: Vec<f32>,
}

/// Where each sequence's queries are, and its keys, in tokens.
type Spans = (Range<usize>, Range<usize>);

fn spans<'a>(queries: &'a [usize], keys: &'a [usize]) -> impl Iterator<Item = Spans> + 'a {
    queries.iter().zip(keys).scan((0, 0), |(query, key), (queries, keys)| {
        let span = (*query..*query + queries, *key..*key + keys);
        (*query, *key) = (span.0.end, span.1.end);
        Some(span)
    })
}

impl Attention {
    fn new(weights: &Tensors, name: &str, sizes: &Sizes) -> Result<Self, GenerateError> {
        let width = sizes.width;
        Ok(Self {
            heads: sizes.heads,
            width,
            queries: Linear::part(weights, name, width, 0)?,
            keys: Linear::part(weights, name, width, 1)?,
            values: Linear::part(weights, name, width, 2)?,
            out: Linear::new(weights, &format!("{name}.out_proj"), width, width)?,
        })
    }

    #[allow(clippy::too_many_arguments)]
    fn forward(
        &self,
        x: &[f32],
        memory: &[f32],
        spans: impl Iterator<Item = Spans>,
        out: &mut [f32],
        tape: &mut AttentionTape,
        work: &mut AttentionWork,
        mixed: &mut Vec<f32>,
    ) {
        let AttentionTape { queries, keys, values, probabilities } = tape;
        self.queries.forward(x, fit(queries, x.len()));
        self.keys.forward(memory, fit(keys, memory.len()));
        self.values.forward(memory, fit(values, memory.len()));
        fit(mixed, x.len());
        probabilities.clear();
        for (of_queries, of_keys) in spans {
            let mixed = &mut mixed[of_queries.start * self.width..of_queries.end * self.width];
            let sequence = self.sequence([queries, keys, values], of_queries, of_keys);
            let first = probabilities.len();
            probabilities.resize(first + sequence.probabilities(), 0.0);
            sequence.attend(mixed, &mut probabilities[first..], work);
        }
        self.out.forward(mixed, out);
    }

    /// The gradients of queries, keys and values, into the buffers of `work`.
    fn backward(
        &self,
        grad: &[f32],
        spans: impl Iterator<Item = Spans>,
        tape: &AttentionTape,
        work: &mut BlockWork,
    ) {
        self.out.backward(grad, fit(&mut work.part, grad.len()), false);
        for (buffer, of) in work.grads.iter_mut().zip([&tape.queries, &tape.keys, &tape.values]) {
            buffer.clear();
            buffer.resize(of.len(), 0.0);
        }
        let mut first = 0;
        let width = self.width;
        for (queries, keys) in spans {
            let tables = [&tape.queries[..], &tape.keys, &tape.values];
            let sequence = self.sequence(tables, queries.clone(), keys.clone());
            let count = sequence.probabilities();
            let [a, b, c] = &mut work.grads;
            let (of_queries, of_keys) =
                (width * queries.start..width * queries.end, width * keys.start..width * keys.end);
            let grads = [&mut a[of_queries.clone()], &mut b[of_keys.clone()], &mut c[of_keys]];
            let probabilities = &tape.probabilities[first..first + count];
            sequence.back(&work.part[of_queries], probabilities, grads, &mut work.attention);
            first += count;
        }
    }

    /// Of all four projections: what queries were made of and what keys and values were, what went into the last one and the
    /// gradient of what came out of it, and the gradients of the three.
    fn weight_gradients(
        &self,
        x: &[f32],
        memory: &[f32],
        (mixed, grad): (&[f32], &[f32]),
        [queries, keys, values]: &[Vec<f32>; 3],
        to: &mut WeightGradients<'_>,
    ) {
        self.out.weight_gradient(mixed, grad, to.row, to.work);
        self.queries.weight_gradient(x, queries, to.row, to.work);
        self.keys.weight_gradient(memory, keys, to.row, to.work);
        self.values.weight_gradient(memory, values, to.row, to.work);
    }

    fn sequence<'a>(
        &self,
        [queries, keys, values]: [&'a [f32]; 3],
        of_queries: Range<usize>,
        of_keys: Range<usize>,
    ) -> Sequence<'a> {
        let (width, heads) = (self.width, self.heads);
        let of_queries = width * of_queries.start..width * of_queries.end;
        let of_keys = width * of_keys.start..width * of_keys.end;
        let (queries, keys, values) = (&queries[of_queries], &keys[of_keys.clone()], &values[of_keys]);
        Sequence { queries, keys, values, width, heads }
    }

    /// What a memory says, into `work.part`. With one token the softmax is 1, so every query gets the same.
    fn look_up(
        &self,
        x: &[f32],
        memory: &[f32],
        lengths: &[usize],
        tokens: usize,
        tape: &mut BlockTape,
        work: &mut BlockWork,
    ) {
        if tokens == 1 {
            self.values.forward(memory, fit(&mut work.other, memory.len()));
            self.out.forward(&work.other, fit(&mut tape.memory.values, memory.len()));
            let answers = tape.memory.values.chunks_exact(self.width);
            let rows =
                lengths.iter().zip(answers).flat_map(|(&length, row)| std::iter::repeat_n(row, length));
            for (out, row) in work.part.chunks_exact_mut(self.width).zip(rows) {
                out.copy_from_slice(row);
            }
            return;
        }
        let keys = vec![tokens; lengths.len()];
        let spans = spans(lengths, &keys);
        let (attention, other) = (&mut work.attention, &mut work.other);
        self.forward(x, memory, spans, &mut work.part, &mut tape.memory, attention, other);
    }

    /// From the gradient of what [`Self::look_up`] was added to: to the memory, and, unless it is the `last`, to what
    /// the queries were made of.
    #[allow(clippy::too_many_arguments)]
    fn look_up_back(
        &self,
        grad: &mut [f32],
        memory: &[f32],
        (lengths, tokens): (&[usize], usize),
        grad_memory: &mut [f32],
        last: bool,
        tape: &AttentionTape,
        work: &mut BlockWork,
        (x, mixed): (&[f32], &[f32]),
        weights: Option<&mut WeightGradients<'_>>,
    ) {
        if tokens == 1 {
            let sums = fit(&mut work.part, memory.len());
            sums.fill(0.0);
            let owners = lengths.iter().enumerate().flat_map(|(at, &length)| std::iter::repeat_n(at, length));
            for (row, owner) in grad.chunks_exact(self.width).zip(owners) {
                add(&mut sums[owner * self.width..][..self.width], row);
            }
            if let Some(to) = weights {
                self.values.forward(memory, fit(&mut work.other, memory.len()));
                self.out.weight_gradient(&work.other, sums, to.row, to.work);
                self.out.backward(sums, fit(&mut work.other, memory.len()), false);
                self.values.weight_gradient(memory, &work.other, to.row, to.work);
            } else {
                self.out.backward(sums, fit(&mut work.other, memory.len()), false);
            }
            self.values.backward(&work.other, grad_memory, true);
            return;
        }
        let keys = vec![tokens; lengths.len()];
        self.backward(grad, spans(lengths, &keys), tape, work);
        if let Some(to) = weights {
            self.weight_gradients(x, memory, (mixed, grad), &work.grads, to);
        }
        let [queries, keys, values] = &work.grads;
        if !last {
            self.queries.backward(queries, grad, true);
        }
        self.keys.backward(keys, grad_memory, true);
        self.values.backward(values, grad_memory, true);
    }
}
