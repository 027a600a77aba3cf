//! What holds between joints and the world: the storyboard of ours that says so, from file to motion.

use crate::support::{MODEL, board, generated, p99, poses, understood};
use inkrig_generate::measures::jerk;
use inkrig_motion::humanml::bone_lengths;
use inkrig_storyboard::{Animation, Exact, Generated, Kept, MeetOptions, Rule, animation};

fn worst(animation: &Animation) -> f32 {
    animation.constraints.iter().flatten().map(|kept| kept.miss).fold(0.0, f32::max)
}

#[test]
fn a_bar_a_wall_and_balance_are_kept() {
    let frames = board("lift-and-push").frames;
    let read = frames.iter().map(|frame| understood(frame).unwrap());
    let clips: Vec<Generated> =
        read.enumerate().map(|(at, read)| generated(&read, at + 1, &MODEL.sampling, true)).collect();
    let made = |exact: &Exact| animation(&clips, None, &MODEL.body, exact).unwrap();
    let (off, soft, pinned) =
        (made(&Exact::Off), made(&Exact::Soft), made(&Exact::Pin(MeetOptions::default())));
    for (own, said) in pinned.constraints.iter().zip(&frames) {
        let shown: Vec<String> = own.iter().map(|kept| format!("{:.4}", kept.miss)).collect();
        println!("{}: missed by {shown:?} m", said.word);
        assert_eq!(own.len(), said.constraints.len());
    }
    println!(
        "largest miss: {:.3} m without, {:.3} soft, {:.4} pinned",
        worst(&off),
        worst(&soft),
        worst(&pinned)
    );
    assert!(worst(&off) > 0.05 && worst(&soft) < worst(&off) && worst(&pinned) < 0.01);
    let motion = poses(&pinned.clip);
    let bones = bone_lengths(&motion[0]);
    for (frame, pose) in motion.iter().enumerate() {
        let own = bone_lengths(pose);
        assert!(own.iter().zip(&bones).all(|(a, b)| (a.length() - b.length()).abs() < 1e-3), "{frame}");
    }
    // The bar is held between the frames, too.
    let Kept { constraint, .. } = &pinned.constraints[0][0];
    assert!(matches!(constraint.rule, Rule::Distance([20, 21], Some(_))));
    assert_eq!(constraint.frames, 0..pinned.joined.starts[1]);
    for pose in &motion[constraint.frames.clone()] {
        assert!((pose[20].distance(pose[21]) - 0.5).abs() < 0.01);
    }
    let jerks = [p99(&jerk(&poses(&soft.clip))), p99(&jerk(&motion))];
    println!("P99 of jerk {:.4} soft, {:.4} pinned", jerks[0], jerks[1]);
    assert!(jerks[1] < 1.5 * jerks[0], "{jerks:?}");
}
