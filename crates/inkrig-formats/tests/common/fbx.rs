//! FBX files as text, put together by hand.

use std::fmt::Write;

/// A file in the making.
pub(crate) struct Text {
    /// Properties of the global settings.
    pub(crate) settings: String,
    pub(crate) objects: String,
    pub(crate) connections: String,
    next: u32,
}

/// Ticks in a second.
pub(crate) const SECOND: i64 = 46_186_158_000;

/// An `int` property.
pub(crate) fn int(name: &str, value: i64) -> String {
    format!("P: \"{name}\", \"int\", \"Integer\", \"\",{value}\n")
}

/// A property of three numbers of a node.
pub(crate) fn vector(name: &str, [x, y, z]: [f64; 3]) -> String {
    format!("P: \"{name}\", \"{name}\", \"\", \"A\",{x},{y},{z}\n")
}

impl Text {
    pub(crate) fn new() -> Self {
        let settings = [
            int("UpAxis", 1),
            int("UpAxisSign", 1),
            int("FrontAxis", 2),
            int("FrontAxisSign", 1),
            int("CoordAxis", 0),
            int("CoordAxisSign", 1),
            "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n".into(),
            "P: \"TimeMode\", \"enum\", \"\", \"\",6\n".into(),
        ];
        Self { settings: settings.concat(), objects: String::new(), connections: String::new(), next: 1000 }
    }

    /// A leg of two bones and a tip, a metre long: the hip turns by 90 degrees about x in a second and goes ahead.
    pub(crate) fn leg() -> Self {
        let mut text = Self::new();
        text.node(1, "hip", "LimbNode", 0, &vector("Lcl Translation", [0.0, 100.0, 0.0]));
        text.node(2, "knee", "LimbNode", 1, &vector("Lcl Translation", [0.0, -50.0, 0.0]));
        text.node(3, "tip", "Null", 2, &vector("Lcl Translation", [0.0, -50.0, 0.0]));
        text.stack(100, "walk", [0, SECOND]);
        text.curves(100, 1, "Lcl Rotation", &[Some("0:0 30:90"), Some("0:0"), Some("0:0")]);
        text.curves(100, 1, "Lcl Translation", &[None, Some("0:100"), Some("0:0 30:300")]);
        text
    }

    /// A node below `parent` (0 is the scene), with what says that it is a bone where it is one.
    pub(crate) fn node(&mut self, id: u32, name: &str, kind: &str, parent: u32, properties: &str) {
        let _ = writeln!(
            self.objects,
            "Model: {id}, \"Model::{name}\", \"{kind}\" {{\nVersion: 232\nProperties70: {{\n{properties}}}\n}}"
        );
        let _ = writeln!(self.connections, "C: \"OO\",{id},{parent}");
        if kind == "LimbNode" {
            let attribute = self.id();
            let _ = writeln!(
                self.objects,
                "NodeAttribute: {attribute}, \"NodeAttribute::\", \"LimbNode\" {{\nTypeFlags: \"Skeleton\"\n}}"
            );
            let _ = writeln!(self.connections, "C: \"OO\",{attribute},{id}");
        }
    }

    /// A stack with one layer, whose number is the next.
    pub(crate) fn stack(&mut self, id: u32, name: &str, [start, stop]: [i64; 2]) {
        let time = |name: &str, tick: i64| format!("P: \"{name}\", \"KTime\", \"Time\", \"\",{tick}\n");
        let times = time("LocalStart", start) + &time("LocalStop", stop);
        let _ = writeln!(
            self.objects,
            "AnimationStack: {id}, \"AnimStack::{name}\", \"\" {{\nProperties70: {{\n{times}}}\n}}\n\
             AnimationLayer: {}, \"AnimLayer::base\", \"\" {{\n}}",
            id + 1
        );
        let _ = writeln!(self.connections, "C: \"OO\",{},{id}", id + 1);
    }

    /// Linear curves of a property of a node: for each axis `frame:value`, frames being thirtieths of a second.
    pub(crate) fn curves(&mut self, stack: u32, node: u32, property: &str, axes: &[Option<&str>; 3]) {
        self.curves_of(stack, node, property, axes, "4", "0,0,0,0");
    }

    /// As [`Self::curves`], with flags and data of all keys.
    pub(crate) fn curves_of(
        &mut self,
        stack: u32,
        node: u32,
        property: &str,
        axes: &[Option<&str>; 3],
        flags: &str,
        data: &str,
    ) {
        let of = self.id();
        let _ = writeln!(self.objects, "AnimationCurveNode: {of}, \"AnimCurveNode::x\", \"\" {{\n}}");
        let _ =
            writeln!(self.connections, "C: \"OO\",{of},{}\nC: \"OP\",{of},{node}, \"{property}\"", stack + 1);
        for (axis, keys) in ["X", "Y", "Z"].iter().zip(axes) {
            let Some(keys) = keys else { continue };
            let curve = self.id();
            let keys: Vec<(&str, &str)> = keys.split(' ').map(|key| key.split_once(':').unwrap()).collect();
            let time = |frame: &str| (frame.parse::<f64>().unwrap() / 30.0 * SECOND as f64).round() as i64;
            let times: Vec<String> = keys.iter().map(|(frame, _)| time(frame).to_string()).collect();
            let values: Vec<&str> = keys.iter().map(|(_, value)| *value).collect();
            let array = |name: &str, values: &str| {
                format!("{name}: *{} {{\na: {values}\n}}\n", values.split(',').count())
            };
            let arrays = [
                array("KeyTime", &times.join(",")),
                array("KeyValueFloat", &values.join(",")),
                array("KeyAttrFlags", flags),
                array("KeyAttrDataFloat", data),
                array("KeyAttrRefCount", &keys.len().to_string()),
            ];
            let _ = writeln!(
                self.objects,
                "AnimationCurve: {curve}, \"AnimCurve::\", \"\" {{\nDefault: 0\nKeyVer: 4008\n{}}}",
                arrays.concat()
            );
            let _ = writeln!(self.connections, "C: \"OP\",{curve},{of}, \"d|{axis}\"");
        }
    }

    /// The whole file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        format!(
            "; FBX 7.4.0 project file\nFBXHeaderExtension:  {{\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}}\n\
             GlobalSettings:  {{\nVersion: 1000\nProperties70:  {{\n{}}}\n}}\n\
             Objects:  {{\n{}}}\nConnections:  {{\n{}}}\n",
            self.settings, self.objects, self.connections
        )
        .into_bytes()
    }

    fn id(&mut self) -> u32 {
        self.next += 1;
        self.next
    }
}
