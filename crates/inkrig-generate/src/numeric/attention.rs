//! Attention of several heads over one sequence, and its gradient.

use super::elementwise::{softmax, softmax_gradient};
use super::fit;
use super::product::{Out, Packed, Rows, multiply};

/// Queries, keys and values of one sequence, each a table as wide as the network: heads lie side by side.
#[derive(Clone, Copy)]
pub(crate) struct Sequence<'a> {
    pub(crate) queries: &'a [f32],
    pub(crate) keys: &'a [f32],
    pub(crate) values: &'a [f32],
    pub(crate) width: usize,
    pub(crate) heads: usize,
}

/// Buffers of a call.
#[derive(Debug, Clone, Default)]
pub(crate) struct AttentionWork {
    packed: Packed,
    scores: Vec<f32>,
    turned: Vec<f32>,
}

impl Sequence<'_> {
    fn head(&self) -> usize {
        self.width / self.heads
    }

    fn lengths(&self) -> (usize, usize) {
        (self.queries.len() / self.width, self.keys.len() / self.width)
    }

    fn scale(&self) -> f32 {
        1.0 / (self.head() as f32).sqrt()
    }

    /// How many probabilities there are: heads x queries x keys.
    pub(crate) fn probabilities(&self) -> usize {
        let (queries, keys) = self.lengths();
        self.heads * queries * keys
    }

    /// Each query's mean of values, into `out` (queries x width), and the weights it was taken with.
    pub(crate) fn attend(&self, out: &mut [f32], probabilities: &mut [f32], work: &mut AttentionWork) {
        let (queries, keys) = self.lengths();
        let (width, head) = (self.width, self.head());
        for (at, scores) in probabilities.chunks_exact_mut(queries * keys).enumerate() {
            let first = at * head;
            work.packed.fill_transposed(&self.keys[first..], head, keys, width);
            let rows = Rows { data: &self.queries[first..], stride: width, count: queries };
            multiply(rows, &work.packed, None, Out { data: scores, stride: keys, add: false });
            softmax(scores, keys, self.scale());
            work.packed.fill(&self.values[first..], keys, head, width);
            let rows = Rows { data: scores, stride: keys, count: queries };
            let out = Out { data: &mut out[first..], stride: width, add: false };
            multiply(rows, &work.packed, None, out);
        }
    }

    /// From the gradient of what [`Self::attend`] gave to those of queries, keys and values, added to what they are.
    pub(crate) fn back(
        &self,
        grad: &[f32],
        probabilities: &[f32],
        [grad_queries, grad_keys, grad_values]: [&mut [f32]; 3],
        work: &mut AttentionWork,
    ) {
        let (queries, keys) = self.lengths();
        let (width, head) = (self.width, self.head());
        let scores = fit(&mut work.scores, queries * keys);
        let turned = fit(&mut work.turned, queries * keys);
        for (at, probabilities) in probabilities.chunks_exact(queries * keys).enumerate() {
            let first = at * head;
            let of_queries = |table| Rows { data: table, stride: width, count: queries };
            work.packed.fill_transposed(&self.values[first..], head, keys, width);
            let out = Out { data: scores, stride: keys, add: false };
            multiply(of_queries(&grad[first..]), &work.packed, None, out);
            softmax_gradient(probabilities, scores, keys, self.scale());

            work.packed.fill(&self.keys[first..], keys, head, width);
            let rows = Rows { data: scores, stride: keys, count: queries };
            let out = Out { data: &mut grad_queries[first..], stride: width, add: true };
            multiply(rows, &work.packed, None, out);

            transpose(scores, keys, turned);
            work.packed.fill(&self.queries[first..], queries, head, width);
            let rows = Rows { data: turned, stride: queries, count: keys };
            let out = Out { data: &mut grad_keys[first..], stride: width, add: true };
            multiply(rows, &work.packed, None, out);

            transpose(probabilities, keys, turned);
            work.packed.fill(&grad[first..], queries, head, width);
            let rows = Rows { data: turned, stride: queries, count: keys };
            let out = Out { data: &mut grad_values[first..], stride: width, add: true };
            multiply(rows, &work.packed, None, out);
        }
    }
}

fn transpose(rows: &[f32], width: usize, out: &mut [f32]) {
    let height = rows.len() / width.max(1);
    for (at, row) in rows.chunks_exact(width).enumerate() {
        for (column, value) in row.iter().enumerate() {
            out[column * height + at] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::numbers;
    use super::*;

    #[test]
    fn gradients_are_differences() {
        let (width, heads, queries, keys) = (8, 2, 5, 3);
        let tables = [numbers(1, queries * width), numbers(2, keys * width), numbers(3, keys * width)];
        let way = numbers(4, queries * width);
        let run = |tables: &[Vec<f32>; 3]| {
            let [queries, keys, values] = tables;
            let sequence = Sequence { queries, keys, values, width, heads };
            let mut probabilities = vec![0.0; sequence.probabilities()];
            let (mut out, mut work) = (vec![0.0; way.len()], AttentionWork::default());
            sequence.attend(&mut out, &mut probabilities, &mut work);
            let total = out.iter().zip(&way).map(|(a, b)| f64::from(a * b)).sum::<f64>();
            let mut grads = [vec![0.0; queries.len()], vec![0.0; keys.len()], vec![0.0; values.len()]];
            let [a, b, c] = &mut grads;
            sequence.back(&way, &probabilities, [a, b, c], &mut work);
            (total, grads)
        };
        let (_, grads) = run(&tables);
        for table in 0..3 {
            for at in [0, 9, 17] {
                let (mut more, mut less) = (tables.clone(), tables.clone());
                more[table][at] += 1e-2;
                less[table][at] -= 1e-2;
                let slope = (run(&more).0 - run(&less).0) / 2e-2;
                let got = f64::from(grads[table][at]);
                assert!((slope - got).abs() < 2e-3, "{table} {at}: {slope} {got}");
            }
        }
    }
}
