#![allow(clippy::all, clippy::unwrap_used, clippy::print_stdout, missing_docs)]
use inkrig_motion::kinematics;
fn main() {
    let which = std::env::args().nth(1).unwrap();
    let clip = match which.as_str() {
        "person" => inkrig_samples::make::person::clip().unwrap(),
        "quadruped" => inkrig_samples::make::quadruped::clip().unwrap(),
        "snake" => inkrig_samples::make::snake::clip().unwrap(),
        _ => panic!(),
    };
    let sk = clip.skeleton();
    print!("{{\"names\":[");
    for (i, j) in sk.joints().iter().enumerate() {
        print!("{}\"{}\"", if i > 0 { "," } else { "" }, j.name);
    }
    print!("],\"parents\":[");
    for (i, j) in sk.joints().iter().enumerate() {
        print!("{}{}", if i > 0 { "," } else { "" }, j.parent.map_or(-1, |p| p as i64));
    }
    print!("],\"pos\":[");
    let p = kinematics::positions(&clip);
    for f in 0..clip.frames() {
        print!("{}[", if f > 0 { "," } else { "" });
        for (i, v) in p.frame(f).iter().enumerate() {
            print!("{}[{:.5},{:.5},{:.5}]", if i > 0 { "," } else { "" }, v.x, v.y, v.z);
        }
        print!("]");
    }
    println!("]}}");
}
