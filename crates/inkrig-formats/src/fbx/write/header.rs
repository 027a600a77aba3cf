//! What stands around the objects: the header, the settings, the kinds of objects, the list of takes.

use super::{
    Scene,
    animation::Animation,
    body::Mesh,
    document::{Document, Value, object_name},
    ids::Ids,
};
use crate::{FormatError, UpAxis, fbx::TIME_MODES};
use Value::{Bytes, Double, Int, Long, Text};

/// The same bytes for the same clip: no clock is asked. The file's id below belongs to this time.
const CREATED: &str = "1970-01-01 10:00:00:000";
const FILE_ID: [u8; 16] =
    [0x28, 0xb3, 0x2a, 0xeb, 0xb6, 0x24, 0xcc, 0xc2, 0xbf, 0xc8, 0xb0, 0x2a, 0xa9, 0x2b, 0xfc, 0xf1];

const CREATOR: &str = concat!("inkrig ", env!("CARGO_PKG_VERSION"));

/// What stands before the objects.
pub(super) fn before(
    document: &mut Document,
    scene: &Scene<'_>,
    ids: &Ids,
    animation: &Animation,
    mesh: &Mesh,
) -> Result<(), FormatError> {
    extension(document)?;
    document.leaf("FileId", &[Bytes(&FILE_ID)])?;
    document.leaf("CreationTime", &[Text(CREATED)])?;
    document.leaf("Creator", &[Text(CREATOR)])?;
    settings(document, scene, animation)?;
    document.open("Documents", &[])?;
    document.leaf("Count", &[Int(1)])?;
    document.open("Document", &[Long(Ids::DOCUMENT), Text("Scene"), Text("Scene")])?;
    document.open("Properties70", &[])?;
    document.property("SourceObject", ["object", "", ""], &[])?;
    document.property("ActiveAnimStackName", ["KString", "", ""], &[Text(&scene.name)])?;
    document.close()?;
    document.leaf("RootNode", &[Long(Ids::ROOT)])?;
    document.close()?;
    document.close()?;
    document.leaf("References", &[])?;
    definitions(document, ids, animation, mesh)
}

/// The takes, which older programs look for.
pub(super) fn takes(
    document: &mut Document,
    scene: &Scene<'_>,
    animation: &Animation,
) -> Result<(), FormatError> {
    let span = [Long(0), Long(animation.last_tick())];
    document.open("Takes", &[])?;
    document.leaf("Current", &[Text(&scene.name)])?;
    document.open("Take", &[Text(&scene.name)])?;
    document.leaf("FileName", &[Text(&format!("{}.tak", scene.name))])?;
    document.leaf("LocalTime", &span)?;
    document.leaf("ReferenceTime", &span)?;
    document.close()?;
    document.close()
}

fn extension(document: &mut Document) -> Result<(), FormatError> {
    document.open("FBXHeaderExtension", &[])?;
    document.leaf("FBXHeaderVersion", &[Int(1003)])?;
    document.leaf("FBXVersion", &[Int(7400)])?;
    document.leaf("EncryptionType", &[Int(0)])?;
    document.open("CreationTimeStamp", &[])?;
    let stamp = [("Version", 1000), ("Year", 1970), ("Month", 1), ("Day", 1), ("Hour", 10), ("Minute", 0)];
    for (name, value) in stamp.into_iter().chain([("Second", 0), ("Millisecond", 0)]) {
        document.leaf(name, &[Int(value)])?;
    }
    document.close()?;
    document.leaf("Creator", &[Text(CREATOR)])?;
    document.open("SceneInfo", &[Text(&object_name("GlobalInfo", "SceneInfo")), Text("UserData")])?;
    document.leaf("Type", &[Text("UserData")])?;
    document.leaf("Version", &[Int(100)])?;
    document.open("MetaData", &[])?;
    document.leaf("Version", &[Int(100)])?;
    for name in ["Title", "Subject", "Author", "Keywords", "Revision", "Comment"] {
        document.leaf(name, &[Text("")])?;
    }
    document.close()?;
    document.open("Properties70", &[])?;
    for name in ["Original", "LastSaved"] {
        document.property(name, ["Compound", "", ""], &[])?;
        let values = [("ApplicationName", "inkrig"), ("ApplicationVersion", env!("CARGO_PKG_VERSION"))];
        for (part, value) in values {
            document.property(&format!("{name}|{part}"), ["KString", "", ""], &[Text(value)])?;
        }
    }
    document.close()?;
    document.close()?;
    document.close()
}

fn settings(document: &mut Document, scene: &Scene<'_>, animation: &Animation) -> Result<(), FormatError> {
    // Which axis, and its sign.
    let [up, front] = match scene.options.up {
        UpAxis::Y => [(1, 1), (2, 1)],
        UpAxis::Z => [(2, 1), (1, -1)],
    };
    let rate = scene.clip.frame_rate();
    let mode = TIME_MODES.into_iter().find(|(known, _)| *known == rate).map_or(14, |(_, mode)| mode);
    // The format counts in centimetres.
    let unit = scene.options.metres_per_unit * 100.0;
    let (int, double, time) = (["int", "Integer", ""], ["double", "Number", ""], ["KTime", "Time", ""]);
    document.open("GlobalSettings", &[])?;
    document.leaf("Version", &[Int(1000)])?;
    document.open("Properties70", &[])?;
    let axes = [("UpAxis", up), ("FrontAxis", front), ("CoordAxis", (0, 1)), ("OriginalUpAxis", up)];
    for (name, (axis, sign)) in axes {
        document.property(name, int, &[Int(axis)])?;
        document.property(&format!("{name}Sign"), int, &[Int(sign)])?;
    }
    document.property("UnitScaleFactor", double, &[Double(unit)])?;
    document.property("OriginalUnitScaleFactor", double, &[Double(unit)])?;
    document.property("AmbientColor", ["ColorRGB", "Color", ""], &[Double(0.0); 3])?;
    document.property("DefaultCamera", ["KString", "", ""], &[Text("Producer Perspective")])?;
    document.property("TimeMode", ["enum", "", ""], &[Int(mode)])?;
    document.property("TimeSpanStart", time, &[Long(0)])?;
    document.property("TimeSpanStop", time, &[Long(animation.last_tick())])?;
    document.property("CustomFrameRate", double, &[Double(rate)])?;
    document.close()?;
    document.close()
}

/// Which kinds of objects there are, how many, and what they have that does not say otherwise.
fn definitions(
    document: &mut Document,
    ids: &Ids,
    animation: &Animation,
    mesh: &Mesh,
) -> Result<(), FormatError> {
    let count = |count: usize| i32::try_from(count).unwrap_or(i32::MAX);
    let (nodes, curves) = (animation.curve_nodes(), 3 * animation.curve_nodes());
    let kinds = [
        ("GlobalSettings", 1, ""),
        ("NodeAttribute", ids.joints, "FbxSkeleton"),
        ("Model", ids.joints + 1, "FbxNode"),
        ("Geometry", 1, "FbxMesh"),
        ("Material", 1, "FbxSurfaceLambert"),
        ("Deformer", 1 + mesh.clusters(), ""),
        ("Pose", 1, ""),
        ("AnimationStack", 1, "FbxAnimStack"),
        ("AnimationLayer", 1, "FbxAnimLayer"),
        ("AnimationCurveNode", nodes, "FbxAnimCurveNode"),
        ("AnimationCurve", curves, ""),
    ];
    document.open("Definitions", &[])?;
    document.leaf("Version", &[Int(100)])?;
    let total = kinds.iter().map(|(_, count, _)| count).sum();
    document.leaf("Count", &[Int(count(total))])?;
    for (kind, number, template) in kinds {
        document.open("ObjectType", &[Text(kind)])?;
        document.leaf("Count", &[Int(count(number))])?;
        if !template.is_empty() {
            document.open("PropertyTemplate", &[Text(template)])?;
            document.open("Properties70", &[])?;
            defaults(document, template)?;
            document.close()?;
            document.close()?;
        }
        document.close()?;
    }
    document.close()
}

fn defaults(document: &mut Document, template: &str) -> Result<(), FormatError> {
    let (zero, one) = ([Double(0.0); 3], [Double(1.0); 3]);
    let time = ["KTime", "Time", ""];
    match template {
        "FbxNode" => {
            document.property("RotationOrder", ["enum", "", ""], &[Int(0)])?;
            document.property("RotationActive", ["bool", "", ""], &[Int(0)])?;
            document.property("InheritType", ["enum", "", ""], &[Int(0)])?;
            document.property("Lcl Translation", ["Lcl Translation", "", "A"], &zero)?;
            document.property("Lcl Rotation", ["Lcl Rotation", "", "A"], &zero)?;
            document.property("Lcl Scaling", ["Lcl Scaling", "", "A"], &one)?;
            document.property("Visibility", ["Visibility", "", "A"], &[Double(1.0)])
        }
        "FbxSkeleton" => {
            document.property("Size", ["double", "Number", ""], &[Double(100.0)])?;
            document.property("LimbLength", ["double", "Number", "H"], &[Double(1.0)])
        }
        "FbxAnimStack" => {
            for name in ["LocalStart", "LocalStop", "ReferenceStart", "ReferenceStop"] {
                document.property(name, time, &[Long(0)])?;
            }
            Ok(())
        }
        "FbxMesh" => document.property("Color", ["ColorRGB", "Color", ""], &[Double(0.8); 3]),
        "FbxSurfaceLambert" => document.property("DiffuseColor", ["Color", "", "A"], &[Double(0.8); 3]),
        "FbxAnimLayer" => document.property("Weight", ["Number", "", "A"], &[Double(100.0)]),
        _ => document.property("d", ["Compound", "", ""], &[]),
    }
}
