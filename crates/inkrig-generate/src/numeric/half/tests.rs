use super::*;
use crate::numeric::testing::numbers;

fn rounded_one(x: f32) -> f32 {
    f32::from_bits(pair_of(0.0, x))
}

fn rounded(numbers: &[f32]) -> Vec<f64> {
    numbers.iter().map(|&x| f64::from(rounded_one(x))).collect()
}

#[test]
fn halves_are_the_nearest() {
    let back = rounded_one;
    assert_eq!(back(1.0), 1.0);
    assert_eq!(back(1.0 + 1.0 / 256.0), 1.0, "the even one of two");
    assert_eq!(back(1.0 + 3.0 / 256.0), 1.0 + 4.0 / 256.0);
    assert_eq!(back(-2.7173), -2.718_75);
}

#[test]
fn products_of_all_shapes_are_those_of_rounded_factors() {
    if !available() {
        println!("skipped: this processor multiplies no numbers of bfloat16");
        return;
    }
    // Used again and again, from large to small and back, so that nothing of an earlier product may be left.
    let (mut packed, mut turned, mut work) =
        (HalfPacked::default(), HalfPacked::default(), HalfWork::default());
    for (rows, columns, depth) in
        [(41, 263, 40), (1, 1, 1), (3, 32, 7), (33, 33, 64), (70, 5, 131), (1030, 7, 5), (3, 2, 9)]
    {
        let (x, weight, bias) = (numbers(1, rows * depth), numbers(2, columns * depth), numbers(3, columns));
        let (exact_x, exact_weight) = (rounded(&x), rounded(&weight));
        packed.fill_transposed(&weight, depth, columns);
        let by_depth: Vec<f32> =
            (0..depth).flat_map(|at| weight.iter().skip(at).step_by(depth).copied()).collect();
        turned.fill(&by_depth, depth, columns);
        assert_eq!(packed.tiles, turned.tiles);
        let mut out = vec![7.0; rows * columns];
        multiply_half(&x, &packed, Some(&bias), &mut out, false, &mut work);
        let mut twice = out.clone();
        multiply_half(&x, &packed, None, &mut twice, true, &mut work);
        for (at, (got, more)) in out.iter().zip(&twice).enumerate() {
            let (row, column) = (at / columns, at % columns);
            let sum: f64 =
                (0..depth).map(|k| exact_x[row * depth + k] * exact_weight[column * depth + k]).sum();
            let wanted = sum + f64::from(bias[column]);
            assert!((f64::from(*got) - wanted).abs() < 1e-4, "{rows} {columns} {depth}: {got} {wanted}");
            assert!((f64::from(*more) - wanted - sum).abs() < 2e-4);
        }
        // The gradient of the weight: columns x depth.
        let mut gradient = vec![0.0; columns * depth];
        add_half_weight_gradient(&out, columns, &x, depth, &mut gradient, (&mut work, &mut turned));
        let exact_out = rounded(&out);
        for (at, got) in gradient.iter().enumerate() {
            let (column, k) = (at / depth, at % depth);
            let wanted: f64 =
                (0..rows).map(|row| exact_out[row * columns + column] * exact_x[row * depth + k]).sum();
            assert!((f64::from(*got) - wanted).abs() < 2e-3, "{rows} {columns} {depth}: {got} {wanted}");
        }
    }
}

#[test]
fn a_table_that_is_turned_is_the_transpose() {
    let (mut by_turning, mut by_hand) = (HalfWork::default(), HalfWork::default());
    for (height, columns) in [(131, 40), (1, 1), (7, 33), (32, 32), (45, 2)] {
        let x = numbers(5, height * columns);
        let transpose: Vec<f32> =
            (0..columns).flat_map(|column| x.iter().skip(column).step_by(columns).copied()).collect();
        let (own, wanted) = (by_turning.turn(&x, columns), by_hand.fill(&transpose, height));
        assert_eq!((own.row, own.pair), (wanted.row, wanted.pair));
        assert_eq!(by_turning.pairs, by_hand.pairs, "{height} {columns}");
    }
}

#[test]
fn a_block_goes_to_its_place_and_nowhere_else() {
    let block: [f32; BLOCK * BLOCK] = array::from_fn(|at| at as f32);
    for (columns, column, width) in [(40, 0, 32), (40, 32, 8), (1, 0, 1), (63, 32, 31)] {
        let (bias, rows) = (numbers(1, width), 5);
        for add in [false, true] {
            let mut out = vec![0.5; rows * columns];
            let bias = (!add).then_some(&bias[..]);
            write(&block, &mut out, &Place { columns, column, width, bias, add });
            for (at, out) in out.iter().enumerate() {
                let (row, at) = (at / columns, at % columns);
                let wanted = match at.checked_sub(column).filter(|at| *at < width) {
                    None => 0.5,
                    Some(at) => block[row * BLOCK + at] + bias.map_or(0.5, |bias| bias[at]),
                };
                assert_eq!(*out, wanted, "{columns} {column} {width} {add}");
            }
        }
    }
}
