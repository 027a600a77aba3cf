//! Triangular filters on Slaney's mel scale with Slaney's area norm.
//!
//! M. Slaney, "Auditory Toolbox", technical report 1998-010, Interval Research; the default of librosa's `filters.mel`.

/// One filter: its first bin and the weights from there.
pub(crate) struct Filter {
    pub(crate) first: usize,
    pub(crate) weights: Vec<f64>,
}

/// `bands` filters over the bins of a transform of `window` samples at `rate` Hz, from 0 to half the rate.
pub(crate) fn mel_filters(rate: f64, window: usize, bands: usize) -> Vec<Filter> {
    let top = mel_from_hz(rate / 2.0);
    let edge = |index: usize| hz_from_mel(top * index as f64 / (bands + 1) as f64);
    let bin_hz = rate / window as f64;
    let filter = |band: usize| {
        let (low, middle, high) = (edge(band), edge(band + 1), edge(band + 2));
        // Each filter has the same area, so that wide ones are not louder.
        let area = 2.0 / (high - low);
        let weight = |bin: usize| {
            let hz = bin as f64 * bin_hz;
            let slopes = ((hz - low) / (middle - low)).min((high - hz) / (high - middle));
            // librosa keeps its filters in single precision.
            f64::from((slopes.max(0.0) as f32) * area as f32)
        };
        let first = (low / bin_hz).floor() as usize;
        let end = ((high / bin_hz).ceil() as usize).min(window / 2);
        Filter { first, weights: (first..=end).map(weight).collect() }
    };
    (0..bands).map(filter).collect()
}

/// Linear below 1000 Hz: 3 mel for 200 Hz.
const HZ_PER_MEL: f64 = 200.0 / 3.0;
/// Logarithmic above: 27 steps for a factor of 6.4.
const CORNER_HZ: f64 = 1000.0;

fn mel_from_hz(hz: f64) -> f64 {
    if hz < CORNER_HZ {
        return hz / HZ_PER_MEL;
    }
    CORNER_HZ / HZ_PER_MEL + (hz / CORNER_HZ).ln() / (6.4_f64.ln() / 27.0)
}

fn hz_from_mel(mel: f64) -> f64 {
    let corner = CORNER_HZ / HZ_PER_MEL;
    if mel < corner {
        return mel * HZ_PER_MEL;
    }
    CORNER_HZ * ((6.4_f64.ln() / 27.0) * (mel - corner)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_has_slaneys_values() {
        assert!((mel_from_hz(1000.0) - 15.0).abs() < 1e-12);
        assert!((mel_from_hz(6400.0) - 42.0).abs() < 1e-12);
        for hz in [20.0, 999.0, 1001.0, 11_025.0] {
            assert!((hz_from_mel(mel_from_hz(hz)) - hz).abs() < 1e-9, "{hz}");
        }
    }

    #[test]
    fn every_filter_has_weight_and_fits() {
        for (band, filter) in mel_filters(22_050.0, 2048, 128).iter().enumerate() {
            assert!(filter.weights.iter().sum::<f64>() > 0.0, "band {band} is empty");
            assert!(filter.first + filter.weights.len() <= 1025, "band {band} is out of range");
        }
    }
}
