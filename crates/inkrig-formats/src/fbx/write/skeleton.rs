//! The joints: a model each, with what says that it is a limb.

use super::{
    Scene,
    document::{Document, Value, object_name},
    ids::Ids,
};
use crate::{FormatError, fbx::END_SITE};
use Value::{Double, Flag, Int, Long, Text};

pub(super) fn objects(document: &mut Document, scene: &Scene<'_>, ids: &Ids) -> Result<(), FormatError> {
    let joints = scene.clip.skeleton().joints();
    let mut parents = vec![false; joints.len()];
    for slot in joints.iter().filter_map(|joint| joint.parent) {
        if let Some(slot) = parents.get_mut(slot) {
            *slot = true;
        }
    }
    for (index, (joint, name)) in joints.iter().zip(&scene.names).enumerate() {
        let place = scene.place(joint.offset, index)?;
        let title = object_name(name, "NodeAttribute");
        document.open("NodeAttribute", &[Long(ids.attribute(index)), Text(&title), Text("LimbNode")])?;
        document.leaf("TypeFlags", &[Text("Skeleton")])?;
        document.close()?;
        let title = object_name(name, "Model");
        document.open("Model", &[Long(ids.model(index)), Text(&title), Text("LimbNode")])?;
        document.leaf("Version", &[Int(232)])?;
        document.open("Properties70", &[])?;
        document.property("RotationActive", ["bool", "", ""], &[Int(1)])?;
        // Scales are passed on as in a matrix; there are none.
        document.property("InheritType", ["enum", "", ""], &[Int(1)])?;
        document.property("DefaultAttributeIndex", ["int", "Integer", ""], &[Int(0)])?;
        let place = place.to_array().map(Double);
        document.property("Lcl Translation", ["Lcl Translation", "", "A"], &place)?;
        document.property("Lcl Rotation", ["Lcl Rotation", "", "A"], &[Double(0.0); 3])?;
        document.property("Lcl Scaling", ["Lcl Scaling", "", "A"], &[Double(1.0); 3])?;
        if joint.end_site && parents.get(index) == Some(&false) {
            document.property(END_SITE, ["bool", "", "U"], &[Int(1)])?;
        }
        document.close()?;
        document.leaf("Shading", &[Flag(true)])?;
        document.leaf("Culling", &[Text("CullingOff")])?;
        document.close()?;
    }
    Ok(())
}

pub(super) fn connections(document: &mut Document, scene: &Scene<'_>, ids: &Ids) -> Result<(), FormatError> {
    for (index, joint) in scene.clip.skeleton().joints().iter().enumerate() {
        let parent = joint.parent.map_or(Ids::ROOT, |parent| ids.model(parent));
        document.leaf("C", &[Text("OO"), Long(ids.model(index)), Long(parent)])?;
        document.leaf("C", &[Text("OO"), Long(ids.attribute(index)), Long(ids.model(index))])?;
    }
    Ok(())
}
