//! One test a convention: its own names, prefixes and additions.

use super::build::Convention;
use inkrig_motion::rig::{Body, Humanoid};

const LEFT_RIGHT: &[(&str, &str)] = &[("Left", "Right"), ("left", "right")];

fn check(convention: &Convention) {
    let (skeleton, body) = convention.build();
    let found = Humanoid::find(&skeleton).unwrap_or_else(|error| panic!("{}: {error}", convention.program));
    assert_eq!(found, body, "{}", convention.program);
    assert_eq!(Body::find(&skeleton), Ok(Body::Humanoid(body)));
}

#[test]
fn mixamo() {
    check(&Convention {
        program: "Mixamo",
        above: &["Armature"],
        hips: "mixamorig:Hips",
        spine: &["mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Spine2"],
        neck: &["mixamorig:Neck"],
        head: "mixamorig:Head",
        left: [
            "mixamorig:LeftShoulder",
            "mixamorig:LeftArm",
            "mixamorig:LeftForeArm",
            "mixamorig:LeftHand",
            "mixamorig:LeftUpLeg",
            "mixamorig:LeftLeg",
            "mixamorig:LeftFoot",
            "mixamorig:LeftToeBase",
        ],
        mirror: LEFT_RIGHT,
        extra: &[
            ("mixamorig:LeftHandThumb1", "mixamorig:LeftHand"),
            ("mixamorig:LeftHandIndex1", "mixamorig:LeftHand"),
            ("mixamorig:LeftToe_End", "mixamorig:LeftToeBase"),
            ("mixamorig:LeftEye", "mixamorig:Head"),
        ],
    });
}

#[test]
fn mixamo_under_a_long_path_and_without_a_colon() {
    check(&Convention {
        program: "Mixamo, as three.js and Maya have it",
        above: &["|Group|Hero"],
        hips: "|Group|Hero|mixamorig9Hips",
        spine: &["|Group|Hero|mixamorig9Spine", "|Group|Hero|mixamorig9Spine1"],
        neck: &["|Group|Hero|mixamorig9Neck"],
        head: "|Group|Hero|mixamorig9Head",
        left: [
            "|Hero|mixamorig9LeftShoulder",
            "|Hero|mixamorig9LeftArm",
            "|Hero|mixamorig9LeftForeArm",
            "|Hero|mixamorig9LeftHand",
            "|Hero|mixamorig9LeftUpLeg",
            "|Hero|mixamorig9LeftLeg",
            "|Hero|mixamorig9LeftFoot",
            "|Hero|mixamorig9LeftToeBase",
        ],
        mirror: LEFT_RIGHT,
        extra: &[],
    });
}

#[test]
fn unreal_mannequin() {
    check(&Convention {
        program: "Unreal",
        above: &["root"],
        hips: "pelvis",
        spine: &["spine_01", "spine_02", "spine_03", "spine_04", "spine_05"],
        neck: &["neck_01", "neck_02"],
        head: "head",
        left: ["clavicle_l", "upperarm_l", "lowerarm_l", "hand_l", "thigh_l", "calf_l", "foot_l", "ball_l"],
        mirror: &[("_l", "_r")],
        extra: &[
            ("upperarm_twist_01_l", "upperarm_l"),
            ("upperarm_twistCor_02_l", "upperarm_l"),
            ("lowerarm_twist_02_l", "lowerarm_l"),
            ("thigh_twist_01_l", "thigh_l"),
            ("calf_twist_01_l", "calf_l"),
            ("clavicle_pec_l", "spine_05"),
            ("thumb_01_l", "hand_l"),
            ("index_metacarpal_l", "hand_l"),
            ("ik_foot_l", "root"),
            ("ik_hand_l", "root"),
            ("weapon_l", "hand_l"),
        ],
    });
}

#[test]
fn vrm_of_vroid() {
    check(&Convention {
        program: "VRoid",
        above: &["Root"],
        hips: "J_Bip_C_Hips",
        spine: &["J_Bip_C_Spine", "J_Bip_C_Chest", "J_Bip_C_UpperChest"],
        neck: &["J_Bip_C_Neck"],
        head: "J_Bip_C_Head",
        left: [
            "J_Bip_L_Shoulder",
            "J_Bip_L_UpperArm",
            "J_Bip_L_LowerArm",
            "J_Bip_L_Hand",
            "J_Bip_L_UpperLeg",
            "J_Bip_L_LowerLeg",
            "J_Bip_L_Foot",
            "J_Bip_L_ToeBase",
        ],
        mirror: &[("_L_", "_R_")],
        extra: &[
            ("J_Sec_L_Bust1", "J_Bip_C_UpperChest"),
            ("J_Sec_Hair1_01", "J_Bip_C_Head"),
            ("J_Adj_L_FaceEye", "J_Bip_C_Head"),
            ("J_Sec_L_SkirtFront0_01", "J_Bip_C_Hips"),
            ("J_Bip_L_Index1", "J_Bip_L_Hand"),
        ],
    });
}

#[test]
fn unity_humanoid() {
    check(&Convention {
        program: "Unity",
        above: &[],
        hips: "hips",
        spine: &["spine", "chest", "upperChest"],
        neck: &["neck"],
        head: "head",
        left: [
            "leftShoulder",
            "leftUpperArm",
            "leftLowerArm",
            "leftHand",
            "leftUpperLeg",
            "leftLowerLeg",
            "leftFoot",
            "leftToes",
        ],
        mirror: LEFT_RIGHT,
        extra: &[("leftEye", "head"), ("jaw", "head"), ("leftThumbProximal", "leftHand")],
    });
}

/// Rigify's names with what stands before them, and what hangs beside.
fn rigify(program: &'static str, names: [&'static str; 15], extra: &'static [(&'static str, &'static str)]) {
    let [hips, s1, s2, s3, n1, n2, head, clavicle, upper, lower, hand, thigh, shin, foot, toe] = names;
    check(&Convention {
        program,
        above: &["root"],
        hips,
        spine: Box::leak(Box::new([s1, s2, s3])),
        neck: Box::leak(Box::new([n1, n2])),
        head,
        left: [clavicle, upper, lower, hand, thigh, shin, foot, toe],
        mirror: &[(".L", ".R")],
        extra,
    });
}

#[test]
fn rigify_deform_bones_beside_originals_and_mechanics() {
    rigify(
        "Rigify, DEF-",
        [
            "DEF-spine",
            "DEF-spine.001",
            "DEF-spine.002",
            "DEF-spine.003",
            "DEF-spine.004",
            "DEF-spine.005",
            "DEF-spine.006",
            "DEF-shoulder.L",
            "DEF-upper_arm.L",
            "DEF-forearm.L",
            "DEF-hand.L",
            "DEF-thigh.L",
            "DEF-shin.L",
            "DEF-foot.L",
            "DEF-toe.L",
        ],
        &[
            ("DEF-pelvis.L", "DEF-spine"),
            ("DEF-breast.L", "DEF-spine.003"),
            ("ORG-upper_arm.L", "DEF-shoulder.L"),
            ("ORG-thigh.L", "DEF-spine"),
            ("MCH-spine.001", "root"),
            ("upper_arm_fk.L", "root"),
            ("thigh_ik.L", "root"),
        ],
    );
}

#[test]
fn rigify_originals_and_metarig() {
    rigify(
        "Rigify, ORG-",
        [
            "ORG-spine",
            "ORG-spine.001",
            "ORG-spine.002",
            "ORG-spine.003",
            "ORG-spine.004",
            "ORG-spine.005",
            "ORG-spine.006",
            "ORG-shoulder.L",
            "ORG-upper_arm.L",
            "ORG-forearm.L",
            "ORG-hand.L",
            "ORG-thigh.L",
            "ORG-shin.L",
            "ORG-foot.L",
            "ORG-toe.L",
        ],
        &[("ORG-pelvis.L", "ORG-spine"), ("ORG-heel.02.L", "ORG-foot.L")],
    );
    rigify(
        "Rigify, metarig",
        [
            "spine",
            "spine.001",
            "spine.002",
            "spine.003",
            "spine.004",
            "spine.005",
            "spine.006",
            "shoulder.L",
            "upper_arm.L",
            "forearm.L",
            "hand.L",
            "thigh.L",
            "shin.L",
            "foot.L",
            "toe.L",
        ],
        &[("pelvis.L", "spine"), ("heel.02.L", "foot.L"), ("palm.01.L", "hand.L"), ("breast.L", "spine.003")],
    );
}

#[test]
fn cmu() {
    check(&Convention {
        program: "CMU, ASF",
        above: &[],
        hips: "root",
        spine: &["lowerback", "upperback", "thorax"],
        neck: &["lowerneck", "upperneck"],
        head: "head",
        left: ["lclavicle", "lhumerus", "lradius", "lwrist", "lfemur", "ltibia", "lfoot", "ltoes"],
        mirror: &[
            ("lclavicle", "rclavicle"),
            ("lhumerus", "rhumerus"),
            ("lradius", "rradius"),
            ("lwrist", "rwrist"),
            ("lfemur", "rfemur"),
            ("ltibia", "rtibia"),
            ("lfoot", "rfoot"),
            ("ltoes", "rtoes"),
            ("lhipjoint", "rhipjoint"),
            ("lhand", "rhand"),
            ("lthumb", "rthumb"),
        ],
        extra: &[("lhand", "lwrist"), ("lthumb", "lwrist")],
    });
    check(&Convention {
        program: "CMU, BVH",
        above: &[],
        hips: "Hips",
        spine: &["LowerBack", "Spine", "Spine1"],
        neck: &["Neck", "Neck1"],
        head: "Head",
        left: [
            "LeftShoulder",
            "LeftArm",
            "LeftForeArm",
            "LeftHand",
            "LeftUpLeg",
            "LeftLeg",
            "LeftFoot",
            "LeftToeBase",
        ],
        mirror: &[("Left", "Right"), ("LThumb", "RThumb"), ("LHipJoint", "RHipJoint")],
        extra: &[("LThumb", "LeftHand"), ("LeftFingerBase", "LeftHand"), ("LHipJoint", "Hips")],
    });
}

#[test]
fn smpl() {
    let left = [
        "left_collar",
        "left_shoulder",
        "left_elbow",
        "left_wrist",
        "left_hip",
        "left_knee",
        "left_ankle",
        "left_foot",
    ];
    let spine = &["spine1", "spine2", "spine3"];
    let plain = Convention {
        program: "SMPL",
        above: &[],
        hips: "pelvis",
        spine,
        neck: &["neck"],
        head: "head",
        left,
        mirror: LEFT_RIGHT,
        extra: &[],
    };
    check(&plain);
    check(&Convention {
        program: "SMPL, FBX",
        above: &["m_avg_root"],
        hips: "m_avg_Pelvis",
        spine: &["m_avg_Spine1", "m_avg_Spine2", "m_avg_Spine3"],
        neck: &["m_avg_Neck"],
        head: "m_avg_Head",
        left: [
            "m_avg_L_Collar",
            "m_avg_L_Shoulder",
            "m_avg_L_Elbow",
            "m_avg_L_Wrist",
            "m_avg_L_Hip",
            "m_avg_L_Knee",
            "m_avg_L_Ankle",
            "m_avg_L_Foot",
        ],
        mirror: &[("_L_", "_R_")],
        extra: &[("m_avg_L_Hand", "m_avg_L_Wrist")],
    });
}

#[test]
fn biped() {
    check(&Convention {
        program: "3ds Max Biped",
        above: &["Bip001"],
        hips: "Bip001 Pelvis",
        spine: &["Bip001 Spine", "Bip001 Spine1", "Bip001 Spine2"],
        neck: &["Bip001 Neck"],
        head: "Bip001 Head",
        left: [
            "Bip001 L Clavicle",
            "Bip001 L UpperArm",
            "Bip001 L Forearm",
            "Bip001 L Hand",
            "Bip001 L Thigh",
            "Bip001 L Calf",
            "Bip001 L Foot",
            "Bip001 L Toe0",
        ],
        mirror: &[(" L ", " R "), (" LUp", " RUp")],
        extra: &[
            ("Bip001 LUpArmTwist", "Bip001 L UpperArm"),
            ("Bip001 L ForeTwist", "Bip001 L Forearm"),
            ("Bip001 L Finger0", "Bip001 L Hand"),
            ("Bip001 L Toe0Nub", "Bip001 L Toe0"),
            ("Bip001 Footsteps", "Bip001"),
            ("Bip001 Ponytail1", "Bip001 Head"),
        ],
    });
    check(&Convention {
        program: "Source engine",
        above: &[],
        hips: "ValveBiped.Bip01_Pelvis",
        spine: &["ValveBiped.Bip01_Spine", "ValveBiped.Bip01_Spine1", "ValveBiped.Bip01_Spine4"],
        neck: &["ValveBiped.Bip01_Neck1"],
        head: "ValveBiped.Bip01_Head1",
        left: [
            "ValveBiped.Bip01_L_Clavicle",
            "ValveBiped.Bip01_L_UpperArm",
            "ValveBiped.Bip01_L_Forearm",
            "ValveBiped.Bip01_L_Hand",
            "ValveBiped.Bip01_L_Thigh",
            "ValveBiped.Bip01_L_Calf",
            "ValveBiped.Bip01_L_Foot",
            "ValveBiped.Bip01_L_Toe0",
        ],
        mirror: &[("_L_", "_R_")],
        extra: &[],
    });
}

#[test]
fn motion_builder() {
    check(&Convention {
        program: "MotionBuilder, HumanIK",
        above: &["Character1_Reference"],
        hips: "Character1_Hips",
        spine: &["Character1_Spine", "Character1_Spine1", "Character1_Spine2", "Character1_Spine3"],
        neck: &["Character1_Neck", "Character1_Neck1"],
        head: "Character1_Head",
        left: [
            "Character1_LeftShoulder",
            "Character1_LeftArm",
            "Character1_LeftForeArm",
            "Character1_LeftHand",
            "Character1_LeftUpLeg",
            "Character1_LeftLeg",
            "Character1_LeftFoot",
            "Character1_LeftToeBase",
        ],
        mirror: LEFT_RIGHT,
        extra: &[
            ("Character1_LeftArmRoll", "Character1_LeftArm"),
            ("Character1_LeftForeArmRoll", "Character1_LeftForeArm"),
            ("Character1_LeftUpLegRoll", "Character1_LeftUpLeg"),
            ("Character1_LeftHandIndex1", "Character1_LeftHand"),
        ],
    });
}

#[test]
fn poser_and_daz() {
    check(&Convention {
        program: "Poser",
        above: &[],
        hips: "hip",
        spine: &["abdomen", "chest"],
        neck: &["neck"],
        head: "head",
        left: ["lCollar", "lShldr", "lForeArm", "lHand", "lThigh", "lShin", "lFoot", ""],
        mirror: &[
            ("lCollar", "rCollar"),
            ("lShldr", "rShldr"),
            ("lForeArm", "rForeArm"),
            ("lHand", "rHand"),
            ("lThigh", "rThigh"),
            ("lShin", "rShin"),
            ("lFoot", "rFoot"),
            ("lThumb", "rThumb"),
            ("lButtock", "rButtock"),
            ("leftEye", "rightEye"),
        ],
        extra: &[("lThumb1", "lHand"), ("leftEye", "head"), ("lButtock", "hip")],
    });
    check(&Convention {
        program: "DAZ Genesis 8",
        above: &["Genesis8Female"],
        hips: "hip",
        spine: &["abdomenLower", "abdomenUpper", "chestLower", "chestUpper"],
        neck: &["neckLower", "neckUpper"],
        head: "head",
        left: ["lCollar", "lShldrBend", "lForearmBend", "lHand", "lThighBend", "lShin", "lFoot", "lToe"],
        mirror: &[
            ("lCollar", "rCollar"),
            ("lShldr", "rShldr"),
            ("lForearm", "rForearm"),
            ("lHand", "rHand"),
            ("lThigh", "rThigh"),
            ("lShin", "rShin"),
            ("lFoot", "rFoot"),
            ("lToe", "rToe"),
            ("lBigToe", "rBigToe"),
            ("lPectoral", "rPectoral"),
        ],
        extra: &[
            ("pelvis", "hip"),
            ("lShldrTwist", "lShldrBend"),
            ("lForearmTwist", "lForearmBend"),
            ("lThighTwist", "lThighBend"),
            ("lBigToe", "lToe"),
            ("lPectoral", "chestUpper"),
        ],
    });
}

#[test]
fn a_prefix_of_nobodys_convention() {
    check(&Convention {
        program: "own prefix",
        above: &["ninja_b_world"],
        hips: "ninja_b_hips_jnt",
        spine: &["ninja_b_spine1_jnt", "ninja_b_spine2_jnt"],
        neck: &["ninja_b_neck_jnt"],
        head: "ninja_b_head_jnt",
        left: [
            "ninja_b_lf_clavicle_jnt",
            "ninja_b_lf_shoulder_jnt",
            "ninja_b_lf_elbow_jnt",
            "ninja_b_lf_wrist_jnt",
            "ninja_b_lf_hip_jnt",
            "ninja_b_lf_knee_jnt",
            "ninja_b_lf_ankle_jnt",
            "ninja_b_lf_ball_jnt",
        ],
        mirror: &[("_lf_", "_rt_")],
        extra: &[],
    });
}
