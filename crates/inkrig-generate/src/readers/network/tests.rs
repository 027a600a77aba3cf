use super::*;
use crate::schedule::Noise;

/// Every kind of layer, with channels that fill no vector.
fn plan() -> (Plan, [Value; 2]) {
    plan_of(16, 24)
}

fn plan_of(height: usize, width: usize) -> (Plan, [Value; 2]) {
    let mut plan = Plan::new(Shape { height, width, channels: 1 });
    let stem = plan.patch("stem", 0, [4, 6], [2, 4], [1, 1], 5);
    let a = plan.block("a", stem, 3, 7);
    let low = plan.patch("down", a, [2, 2], [2, 2], [0, 0], 34);
    let low = plan.shrink("again", a, low);
    let low = plan.block("b", low, 5, 9);
    let mean = plan.mean(low);
    let mean = plan.norm("mean", mean);
    let joined = plan.join("up", low, a);
    let last = plan.linear("head", joined, 3);
    (plan, [last, mean])
}

#[test]
fn gradients_are_differences() {
    let (plan, values) = plan();
    assert_eq!(plan.shape(1), Shape { height: 8, width: 6, channels: 5 });
    check_gradients(&plan, values, 7);
    // More places than a block takes at once, and some that are left over.
    let (plan, values) = plan_of(32, 96);
    let places = plan.shape(1).places();
    assert!(places > 2 * forward::PLACES && !places.is_multiple_of(forward::PLACES));
    check_gradients(&plan, values, 31);
}

fn check_gradients(plan: &Plan, [last, mean]: [Value; 2], every: usize) {
    let row: Vec<f32> = plan.random(3).iter().map(|number| number + 0.05).collect();
    let picture = Noise::new(1).normals(plan.shape(0).numbers());
    let ways = [Noise::new(2).normals(plan.shape(last).numbers()), Noise::new(4).normals(34)];
    let loss = |row: &[f32]| -> f64 {
        let network = Network::new(plan.clone(), row).unwrap();
        let mut work = Work::default();
        network.forward(&picture, &mut work);
        let part = |value: Value, way: &[f32]| -> f64 {
            work.value(value).iter().zip(way).map(|(a, b)| f64::from(a * b)).sum()
        };
        part(last, &ways[0]) + part(mean, &ways[1])
    };
    let network = Network::new(plan.clone(), &row).unwrap();
    let (mut work, mut gradient) = (Work::default(), vec![0.0; row.len()]);
    network.forward(&picture, &mut work);
    network.backward(&mut work, &[(last, &ways[0]), (mean, &ways[1])], &mut gradient);
    let largest = gradient.iter().fold(0.0_f32, |most, part| most.max(part.abs()));
    for at in (0..row.len()).step_by(every) {
        let nudged = |by: f32| {
            let mut row = row.clone();
            row[at] += by;
            loss(&row)
        };
        let slope = (nudged(1e-2) - nudged(-1e-2)) / 2e-2;
        let off = (slope - f64::from(gradient[at])).abs() / f64::from(largest);
        assert!(off < 2e-3, "{at}: {slope} {}", gradient[at]);
    }
}

#[test]
fn weights_go_into_tensors_and_back() {
    let (plan, [last, _]) = plan();
    let row = plan.random(5);
    let tensors = Network::to_tensors(&plan, &row).unwrap();
    assert_eq!(tensors.numbers(), row.len());
    let picture = Noise::new(1).normals(16 * 24);
    let run = |network: &Network| {
        let mut work = Work::default();
        network.forward(&picture, &mut work);
        work.value(last).to_vec()
    };
    let own = Network::new(plan.clone(), &row).unwrap();
    assert_eq!(run(&own), run(&Network::from_tensors(plan.clone(), &tensors).unwrap()));
    assert!(Network::new(plan.clone(), &row[1..]).is_err());
    assert!(Network::to_tensors(&plan, &row[1..]).is_err());
    let mut other = own.clone();
    other.set(&plan.random(6)).unwrap();
    assert_ne!(run(&own), run(&other));
}
