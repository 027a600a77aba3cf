//! A body of capsules, so that the file shows something in every program: a mesh, its material, and a cluster for each
//! joint that it hangs on.

use super::{
    Scene,
    document::{Document, Value, object_name},
    ids::Ids,
};
use crate::{FormatError, body::body};
use Value::{Double, Doubles, Int, Ints, Long, Text};
use inkrig_motion::glam::{DMat4, DVec3};
use std::collections::BTreeMap;

/// The skin in the file's unit and axes.
pub(super) struct Mesh {
    places: Vec<DVec3>,
    normals: Vec<DVec3>,
    indices: Vec<u32>,
    /// The corners that move with each joint.
    corners: BTreeMap<usize, Vec<i32>>,
    /// Where each joint rests in the world.
    joints: Vec<DVec3>,
}

impl Mesh {
    pub(super) fn of(scene: &Scene<'_>) -> Result<Self, FormatError> {
        // Summed up as a reader will: the pose of the mesh is then exactly that of the limbs.
        let mut joints: Vec<DVec3> = Vec::with_capacity(scene.names.len());
        for (index, joint) in scene.clip.skeleton().joints().iter().enumerate() {
            let parent = joint.parent.and_then(|parent| joints.get(parent)).copied().unwrap_or_default();
            joints.push(parent + scene.place(joint.offset, index)?);
        }
        let body = body(scene.clip, &|_| true);
        let mut corners = BTreeMap::<usize, Vec<i32>>::new();
        for (corner, &joint) in body.bones.iter().enumerate() {
            corners.entry(joint).or_default().push(corner as i32);
        }
        let places = body.places.iter().zip(&body.bones).map(|(place, joint)| scene.place(*place, *joint));
        let up = scene.options.up;
        Ok(Self {
            places: places.collect::<Result<_, _>>()?,
            normals: body.normals.iter().map(|normal| up.file_from_clip(normal.as_dvec3())).collect(),
            indices: body.indices,
            corners,
            joints,
        })
    }

    /// How many joints it hangs on.
    pub(super) fn clusters(&self) -> usize {
        self.corners.len()
    }

    pub(super) fn objects(
        &self,
        document: &mut Document,
        scene: &Scene<'_>,
        ids: &Ids,
    ) -> Result<(), FormatError> {
        self.geometry(document, ids)?;
        document.open("Model", &[Long(ids.mesh()), Text(&object_name("body", "Model")), Text("Mesh")])?;
        document.leaf("Version", &[Int(232)])?;
        document.open("Properties70", &[])?;
        document.property("DefaultAttributeIndex", ["int", "Integer", ""], &[Int(0)])?;
        document.close()?;
        document.leaf("Shading", &[Value::Flag(true)])?;
        document.leaf("Culling", &[Text("CullingOff")])?;
        document.close()?;
        document
            .open("Material", &[Long(ids.material()), Text(&object_name("body", "Material")), Text("")])?;
        document.leaf("Version", &[Int(102)])?;
        document.leaf("ShadingModel", &[Text("lambert")])?;
        document.leaf("MultiLayer", &[Int(0)])?;
        document.open("Properties70", &[])?;
        let colour = [Double(0.42), Double(0.52), Double(0.63)];
        document.property("DiffuseColor", ["Color", "", "A"], &colour)?;
        document.close()?;
        document.close()?;
        document
            .open("Deformer", &[Long(ids.skin()), Text(&object_name("body", "Deformer")), Text("Skin")])?;
        document.leaf("Version", &[Int(101)])?;
        document.leaf("Link_DeformAcuracy", &[Double(50.0)])?;
        document.close()?;
        for (index, (&joint, corners)) in self.corners.iter().enumerate() {
            let name = scene.names.get(joint).map_or("", String::as_str);
            let title = object_name(name, "SubDeformer");
            let place = self.joints.get(joint).copied().unwrap_or_default();
            document.open("Deformer", &[Long(ids.cluster(index)), Text(&title), Text("Cluster")])?;
            document.leaf("Version", &[Int(100)])?;
            document.leaf("UserData", &[Text(""), Text("")])?;
            document.leaf("Indexes", &[Ints(corners)])?;
            document.leaf("Weights", &[Doubles(&vec![1.0; corners.len()])])?;
            document.leaf("Transform", &[Doubles(&matrix(-place))])?;
            document.leaf("TransformLink", &[Doubles(&matrix(place))])?;
            document.close()?;
        }
        self.bind_pose(document, ids)
    }

    pub(super) fn connections(&self, document: &mut Document, ids: &Ids) -> Result<(), FormatError> {
        let mut connect =
            |child: i64, parent: i64| document.leaf("C", &[Text("OO"), Long(child), Long(parent)]);
        connect(ids.mesh(), Ids::ROOT)?;
        connect(ids.geometry(), ids.mesh())?;
        connect(ids.material(), ids.mesh())?;
        connect(ids.skin(), ids.geometry())?;
        for (index, &joint) in self.corners.keys().enumerate() {
            connect(ids.cluster(index), ids.skin())?;
            connect(ids.model(joint), ids.cluster(index))?;
        }
        Ok(())
    }

    fn geometry(&self, document: &mut Document, ids: &Ids) -> Result<(), FormatError> {
        // The last corner of a face is told by its sign.
        let corner =
            |(place, &index): (usize, &u32)| if place % 3 == 2 { !(index as i32) } else { index as i32 };
        let faces: Vec<i32> = self.indices.iter().enumerate().map(corner).collect();
        document.open(
            "Geometry",
            &[Long(ids.geometry()), Text(&object_name("body", "Geometry")), Text("Mesh")],
        )?;
        document.leaf("GeometryVersion", &[Int(124)])?;
        document.leaf("Vertices", &[Doubles(&flat(&self.places))])?;
        document.leaf("PolygonVertexIndex", &[Ints(&faces)])?;
        let layer = |document: &mut Document, kind: &str, mapping: &str, reference: &str| {
            document.open(kind, &[Int(0)])?;
            document.leaf("Version", &[Int(101)])?;
            document.leaf("Name", &[Text("")])?;
            document.leaf("MappingInformationType", &[Text(mapping)])?;
            document.leaf("ReferenceInformationType", &[Text(reference)])
        };
        layer(document, "LayerElementNormal", "ByVertice", "Direct")?;
        document.leaf("Normals", &[Doubles(&flat(&self.normals))])?;
        document.close()?;
        layer(document, "LayerElementMaterial", "AllSame", "IndexToDirect")?;
        document.leaf("Materials", &[Ints(&[0])])?;
        document.close()?;
        document.open("Layer", &[Int(0)])?;
        document.leaf("Version", &[Int(100)])?;
        for kind in ["LayerElementNormal", "LayerElementMaterial"] {
            document.open("LayerElement", &[])?;
            document.leaf("Type", &[Text(kind)])?;
            document.leaf("TypedIndex", &[Int(0)])?;
            document.close()?;
        }
        document.close()?;
        document.close()
    }

    /// The rest pose once more, for programs that ask for it.
    fn bind_pose(&self, document: &mut Document, ids: &Ids) -> Result<(), FormatError> {
        document.open("Pose", &[Long(ids.pose()), Text(&object_name("body", "Pose")), Text("BindPose")])?;
        document.leaf("Type", &[Text("BindPose")])?;
        document.leaf("Version", &[Int(100)])?;
        document.leaf("NbPoseNodes", &[Int(i32::try_from(self.joints.len() + 1).unwrap_or(i32::MAX))])?;
        let joints = self.joints.iter().enumerate().map(|(joint, place)| (ids.model(joint), *place));
        for (node, place) in std::iter::once((ids.mesh(), DVec3::ZERO)).chain(joints) {
            document.open("PoseNode", &[])?;
            document.leaf("Node", &[Long(node)])?;
            document.leaf("Matrix", &[Doubles(&matrix(place))])?;
            document.close()?;
        }
        document.close()
    }
}

fn flat(vectors: &[DVec3]) -> Vec<f64> {
    vectors.iter().flat_map(DVec3::to_array).collect()
}

fn matrix(place: DVec3) -> [f64; 16] {
    DMat4::from_translation(place).to_cols_array()
}
