//! The fields of a vector word: which there are, where they lie, and how integers of ports go in and out.
//!
//! A datapath's list names every port and every stage's outcome it may have, in pipeline order. A set has those that exist
//! under its effects: inputs that an operation of the recorded design reads, outcomes that are no constants, so its columns
//! are the ports of the hardware made for the same effects. A field keeps the bits its profile keeps and takes whole hex
//! digits.

use std::collections::HashMap;

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_core::status::{LIGHT_STATUS_BITS, STATUS_BITS, StatusBit};
use serde::{Deserialize, Serialize};

use crate::net::design::Design;

/// Stages in pipeline order; of several differing fields the one of the earliest stage is named first.
pub const STAGES: [&str; 17] = [
    "input",
    "frame",
    "perturb",
    "roughness",
    "reflect",
    "cube_face",
    "columns",
    "ellipse",
    "axes",
    "probes",
    "half",
    "highlight",
    "local",
    "horizon",
    "peaks",
    "status",
    "check",
];

/// Bits of the check value at the end of a word.
pub(crate) const CHECK_BITS: u32 = 32;

/// Which way a field goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Into the datapath.
    In,
    /// Between two stages.
    Tap,
    /// Out of the datapath.
    Out,
    /// Not part of the datapath: the check value of the word.
    Check,
}

/// One field of a word, as the manifest describes it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// Name, unique in the word.
    pub name: String,
    /// Which way it goes.
    pub direction: Direction,
    /// Stage that makes it, one of [`STAGES`].
    pub stage: String,
    /// Path of the port or output of the datapath's design that carries it; empty for the check value.
    pub port: String,
    /// Place of its lowest bit in the word, a multiple of 4.
    pub lsb: u32,
    /// Bits; the bits above it, up to the next multiple of 4, are zero.
    pub width: u32,
    /// Two's complement.
    pub signed: bool,
    /// Fraction bits: the value is the integer over 2^fraction_bits (times 2^exponent for a mantissa).
    pub fraction_bits: u32,
    /// Unit.
    pub unit: String,
    /// Largest accepted difference in last places; 0 is exact.
    pub tolerance: u32,
    /// What it is.
    pub description: String,
}

impl Field {
    /// Hex digits the field takes.
    pub fn digits(&self) -> u32 {
        self.width.div_ceil(4)
    }

    /// The integer in the field's bits.
    pub(crate) fn integer(&self, bits: u32) -> i64 {
        let spare = 64 - self.width;
        let bits = u64::from(bits) << spare;
        if self.signed { bits.cast_signed() >> spare } else { (bits >> spare).cast_signed() }
    }

    /// Where the stage stands in the pipeline.
    pub(crate) fn rank(&self) -> usize {
        STAGES.iter().position(|stage| *stage == self.stage).unwrap_or(STAGES.len())
    }
}

/// Where the integer of a field is.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Among the ports of the design.
    Port(usize),
    /// Among its outputs.
    Output(usize),
}

/// The fields of a word, most significant first, for one datapath, its effects and one profile.
#[derive(Clone, Debug)]
pub struct Layout {
    fields: Vec<Field>,
    /// Where the integer of each field but the check value comes from, and how many of its low bits the profile drops.
    sources: Vec<(Source, u32)>,
    /// Ports of the design, those without a field included.
    ports: usize,
}

impl Layout {
    /// The fields of a datapath under its effects and `p`.
    pub fn new(datapath: Datapath, effects: &Effects, p: &Precision) -> Self {
        let net = Design::of(datapath).record(effects, p);
        let read = net.ports_read();
        let ports = net.ports.iter().enumerate().filter(|(place, _)| read[*place]);
        let inputs = ports.map(|(place, port)| (port.name.clone(), place)).collect();
        let outputs = net.outputs.iter().enumerate().filter(|(_, output)| net.constant(output).is_none());
        let outputs = outputs.map(|(place, output)| (output.name.clone(), place)).collect();
        let list = Vec::new();
        let mut build =
            Builder { p, inputs, outputs, direction: Direction::In, stage: "input", list, sources: Vec::new() };
        match datapath {
            Datapath::Reflection => reflection(&mut build),
            Datapath::Highlight => highlight(&mut build),
            Datapath::Peak => peak(&mut build),
        }
        build.finish(net.ports.len())
    }

    /// The fields, most significant first.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Bits of a word, a multiple of 4.
    pub fn word_bits(&self) -> u32 {
        self.fields.iter().map(|field| 4 * field.digits()).sum()
    }

    /// Characters of a word's line, underscores included, the end of line not.
    pub(crate) fn line_length(&self) -> usize {
        self.word_bits() as usize / 4 + self.fields.len() - 1
    }

    /// The field at bit `place` of the word and the bit inside it.
    pub(crate) fn field_at(&self, place: u32) -> Option<(usize, u32)> {
        let index = self.fields.iter().position(|field| field.lsb <= place)?;
        Some((index, place - self.fields[index].lsb))
    }

    /// The fields' bits of the integers of ports and outputs, the check value left out; or the first field that is too narrow
    /// for its integer.
    pub(crate) fn encode(&self, inputs: &[i64], outputs: &[i64]) -> Result<Vec<u32>, usize> {
        let encode_field = |(index, (field, &(source, drop))): (usize, (&Field, &(Source, u32)))| {
            let integer = match source {
                Source::Port(place) => inputs[place],
                Source::Output(place) => outputs[place],
            };
            let bits = (integer >> drop) as u32 & mask(field.width);
            if field.integer(bits) << drop == integer { Ok(bits) } else { Err(index) }
        };
        self.fields.iter().zip(&self.sources).enumerate().map(encode_field).collect()
    }

    /// The integers of the ports in the fields' bits of a word; ports without a field are 0.
    pub(crate) fn decode(&self, bits: &[u32]) -> Vec<i64> {
        let mut inputs = vec![0; self.ports];
        for ((field, &(source, drop)), bits) in self.fields.iter().zip(&self.sources).zip(bits) {
            if let Source::Port(place) = source {
                inputs[place] = field.integer(bits & mask(field.width)) << drop;
            }
        }
        inputs
    }
}

/// The lowest `width` bits, 1…32.
pub(crate) const fn mask(width: u32) -> u32 {
    u32::MAX >> (32 - width)
}

/// Components of a vector.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Sides of a horizon in the frame of the surface.
const SIDES: [&str; 4] = ["neg_x", "pos_x", "neg_y", "pos_y"];

/// The surface: n, v, the frame's vectors, bumps and roughness.
fn surface(build: &mut Builder<'_>, path: &str) {
    let at = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    build.vector("normal", &at("normal"), "length", "surface normal n, any length");
    build.vector("view", &at("view"), "length", "view vector v, from the surface to the eye, any length");
    build.vector("tangent_0", &at("tangents[0]"), "length", "main direction h, or p_u where the frame is natural");
    build.vector("tangent_1", &at("tangents[1]"), "length", "p_v where the frame is natural");
    build.offset("offset_1", &at("offset[0]"), "bump offset b1, relative to |n|");
    build.offset("offset_2", &at("offset[1]"), "bump offset b2, relative to |n|");
    build.offset("roughness_1", &at("roughness[0]"), "roughness d1, relative to |n|; I1 where it is isotropic");
    build.offset("roughness_2", &at("roughness[1]"), "roughness d2, relative to |n|");
    build.offset("roughness_3", &at("roughness[2]"), "roughness d3, relative to |n|");
}

/// The tangents.
fn frame(build: &mut Builder<'_>) {
    build.at(Direction::Tap, "frame");
    build.vector("frame_e1", "frame[0]", "length", "tangent E1, scaled by |n|");
    build.vector("frame_e2", "frame[1]", "length", "tangent E2, scaled by |n|");
}

fn perturbed(build: &mut Builder<'_>) {
    build.at(Direction::Tap, "perturb");
    build.vector("normal_mod", "normal_mod", "length", "perturbed normal n_mod");
}

fn half(build: &mut Builder<'_>) {
    build.at(Direction::Tap, "half");
    build.vector("half", "half", "1", "half vector h = l/|l| + v/|v|");
}

fn reflection(build: &mut Builder<'_>) {
    surface(build, "");
    build.vector("dview_dx", "dview[0]", "length per pixel", "dv/dx, one pixel to the right");
    build.vector("dview_dy", "dview[1]", "length per pixel", "dv/dy, one pixel down");
    build.vector("dnormal_dx", "dnormal[0]", "length per pixel", "dn/dx, in the units of n");
    build.vector("dnormal_dy", "dnormal[1]", "length per pixel", "dn/dy, in the units of n");
    let text = "edge of a face at level 0; 0 reads as 1, more than 16384 as 16384";
    build.unsigned("edge_texels", "edge_texels", [16, 0, 0], "texels", text);

    frame(build);
    perturbed(build);
    build.at(Direction::Tap, "reflect");
    build.vector("reflected", "reflected", "length^3", "reflected vector r = 2 n_mod (v.n_mod) - v |n_mod|^2");
    build.at(Direction::Tap, "columns");
    build.pair("column_dx", "columns[0]", "half faces per pixel", "d(s,t) for one pixel to the right");
    build.pair("column_dy", "columns[1]", "half faces per pixel", "d(s,t) for one pixel down");
    let text = "d(s,t) for the roughness tangent d1 E1 (isotropic: I1 E1)";
    build.pair("column_d1", "columns[2]", "half faces", text);
    let text = "d(s,t) for the roughness tangent d2 E1 + d3 E2 (isotropic: I1 E2)";
    build.pair("column_d2", "columns[3]", "half faces", text);
    build.at(Direction::Tap, "ellipse");
    let text = "covariance K = [[a, b], [b, c]] on the face";
    build.block("covariance", "covariance", &["a", "b", "c"], "half faces squared", text);
    build.number("determinant", "determinant", "half faces^4", "det K");
    build.at(Direction::Tap, "axes");
    build.number("major", "major", "half faces", "standard deviation lambda1 along the major axis");
    build.number("minor", "minor", "half faces", "standard deviation lambda2 along the minor axis");
    build.mantissa("direction_s", "direction[0]", "1", "unit direction of the major axis, s");
    build.mantissa("direction_t", "direction[1]", "1", "unit direction of the major axis, t");

    build.at(Direction::Out, "cube_face");
    build.unsigned("face", "face", [3, 0, 0], "1", "face 0 to 5: +x, -x, +y, -y, +z, -z");
    build.mantissa("s", "st[0]", "half faces", "s in [-1, 1], to the right on the face");
    build.mantissa("t", "st[1]", "half faces", "t in [-1, 1], down on the face");
    build.at(Direction::Out, "probes");
    build.unsigned("probes", "probes", [5, 0, 0], "1", "number of probes, 1 to 16");
    build.signed("step_s", "step[0]", [32, 28, 0], "half faces", "step from one probe to the next, s");
    build.signed("step_t", "step[1]", [32, 28, 0], "half faces", "step from one probe to the next, t");
    let bits = build.p.lod_bits;
    build.unsigned("lod", "lod", [4 + bits, bits, 16 - bits], "levels", "level of detail");
    build.status(STATUS_BITS.iter());
}

/// Sticky bits of the reflection datapath that a light has, too.
fn surface_bits() -> impl Iterator<Item = &'static (StatusBit, &'static str)> {
    let shared = |bit: &StatusBit| matches!(bit, StatusBit::NormalZero | StatusBit::ViewZero | StatusBit::FramePole);
    STATUS_BITS.iter().filter(move |(bit, _)| shared(bit))
}

fn highlight(build: &mut Builder<'_>) {
    surface(build, "surface");
    build.vector("light", "light", "length", "vector l from the surface to the light, any length");
    build.signed("shininess", "shininess.exponent", [32, 16, 0], "1", "exponent m, saturated to 1 to 8192");
    build.signed("shininess_root", "shininess.root", [32, 24, 0], "1", "root of m, saturated to 1 to 91");

    frame(build);
    perturbed(build);
    build.at(Direction::Tap, "roughness");
    build.vector("rough_1", "tangents[0]", "length", "roughness tangent d1 E1 (isotropic: I1 E1)");
    build.vector("rough_2", "tangents[1]", "length", "roughness tangent d2 E1 + d3 E2 (isotropic: I1 E2)");
    half(build);
    build.at(Direction::Tap, "highlight");
    build.vector("spread_1", "spread[0]", "1", "sqrt(m)/|n_mod| times rough_1");
    build.vector("spread_2", "spread[1]", "1", "sqrt(m)/|n_mod| times rough_2");
    build.number("amplitude", "amplitude", "1", "1/sqrt(det(I + m K))");

    build.at(Direction::Out, "highlight");
    build.unsigned("f", "f", [25, 24, 0], "1", "share of the light that the highlight returns, 0 to 1");
    build.status(surface_bits().chain(LIGHT_STATUS_BITS.iter().filter(|(bit, _)| *bit as u32 <= 1 << 11)));
}

fn peak(build: &mut Builder<'_>) {
    surface(build, "surface");
    build.vector("light", "light", "length", "vector l from the surface to the light, any length");
    for (axis, name) in AXES.iter().enumerate() {
        let text = format!("stored peak: N, component {name} in the frame of the surface");
        build.signed(&format!("stored_{name}"), &format!("peak.normal[{axis}]"), [16, 15, 0], "1", &text);
    }
    let code = "code c.f of 4 + 12 bits, see FORMAT.md";
    build.unsigned(
        "stored_amplitude",
        "peak.amplitude",
        [16, 0, 0],
        "2^-21",
        &format!("stored peak: amplitude a, {code}"),
    );
    build.unsigned(
        "stored_exponent",
        "peak.exponent",
        [16, 0, 0],
        "2^-13",
        &format!("stored peak: exponent n, {code}"),
    );
    for (side, name) in SIDES.iter().enumerate() {
        let text = "stored horizon: slope at which its ramp begins, or of its step";
        build.signed(&format!("horizon_{name}"), &format!("horizon.low[{side}]"), [16, 12, 0], "1", text);
    }
    for (side, name) in SIDES.iter().enumerate() {
        let text = format!("stored horizon: inverse width of its ramp, {code}; 0 is a step");
        let path = format!("horizon.inverse_width[{side}]");
        build.unsigned(&format!("horizon_{name}_width"), &path, [16, 0, 0], "2^-14", &text);
    }
    build.signed("weight", "weight", [32, 16, 0], "1", "share of the fragment that the peak has, saturated to 0 to 1");

    frame(build);
    half(build);
    build.at(Direction::Tap, "local");
    for (axis, name) in AXES.iter().enumerate() {
        let text = format!("half vector along {}, unit length", ["E1", "E2", "n"][axis]);
        build.mantissa(&format!("local_half_{name}"), &format!("direction[{axis}]"), "1", &text);
    }
    build.block("local_light", "light", &AXES, "length", "l along x = E1, y = E2, z = n");
    build.block("local_eye", "eye", &AXES, "length", "v along x = E1, y = E2, z = n");
    build.at(Direction::Tap, "horizon");
    for (of, (name, vector)) in [("light", "l"), ("eye", "v")].iter().enumerate() {
        for (axis, place) in ["x", "y"].iter().enumerate() {
            let text = format!("slope z/|{place}| of {vector} in the frame of the surface, cut to 8");
            build.slope(&format!("slope_{name}_{place}"), &format!("slopes[{of}][{axis}]"), &text);
        }
    }
    build.unsigned("visibility", "visibility", [17, 16, 0], "1", "share of the facets that light and eye clear");

    build.at(Direction::Out, "peaks");
    build.unsigned("peak", "peak", [30, 24, 0], "1", "light that the peak returns, 0 to below 64");
    let of_peaks = |bit: StatusBit| bit != StatusBit::HalfBelowSurface;
    build.status(surface_bits().chain(LIGHT_STATUS_BITS.iter().filter(|(bit, _)| of_peaks(*bit))));
}

struct Builder<'a> {
    p: &'a Precision,
    /// Places of the ports that are read, by path.
    inputs: HashMap<String, usize>,
    /// Places of the outputs that are no constants.
    outputs: HashMap<String, usize>,
    direction: Direction,
    stage: &'static str,
    list: Vec<Field>,
    sources: Vec<(Source, u32)>,
}

impl Builder<'_> {
    fn at(&mut self, direction: Direction, stage: &'static str) {
        (self.direction, self.stage) = (direction, stage);
    }

    /// A field, if what it would carry exists.
    fn field(
        &mut self,
        name: &str,
        port: &str,
        signed: bool,
        [width, fraction_bits, drop]: [u32; 3],
        unit: &str,
        text: &str,
    ) {
        let source = match self.direction {
            Direction::In => self.inputs.get(port).copied().map(Source::Port),
            _ => self.outputs.get(port).copied().map(Source::Output),
        };
        let Some(source) = source else { return };
        self.sources.push((source, drop));
        self.push(name, port, signed, [width, fraction_bits], unit, text);
    }

    fn push(&mut self, name: &str, port: &str, signed: bool, [width, fraction_bits]: [u32; 2], unit: &str, text: &str) {
        self.list.push(Field {
            name: name.into(),
            direction: self.direction,
            stage: self.stage.into(),
            port: port.into(),
            lsb: 0,
            width,
            signed,
            fraction_bits,
            unit: unit.into(),
            tolerance: 0,
            description: text.into(),
        });
    }

    /// Width, fraction bits and dropped low bits.
    fn signed(&mut self, name: &str, port: &str, format: [u32; 3], unit: &str, text: &str) {
        self.field(name, port, true, format, unit, text);
    }

    fn unsigned(&mut self, name: &str, port: &str, format: [u32; 3], unit: &str, text: &str) {
        self.field(name, port, false, format, unit, text);
    }

    /// I2F30 of which the profile keeps p fraction bits.
    fn mantissa(&mut self, name: &str, port: &str, unit: &str, text: &str) {
        let p = self.p.fraction_bits;
        self.signed(name, port, [p + 2, p, 30 - p], unit, text);
    }

    /// I4F28 of which the profile keeps p − 2 fraction bits.
    fn offset(&mut self, name: &str, port: &str, text: &str) {
        let bits = self.p.offset_bits();
        self.signed(name, port, [bits + 4, bits, 28 - bits], "|n|", text);
    }

    /// I6F26 within ±8 of which the profile keeps p − 4 fraction bits.
    fn slope(&mut self, name: &str, port: &str, text: &str) {
        let p = self.p.fraction_bits;
        self.signed(name, port, [p + 1, p - 4, 30 - p], "1", text);
    }

    fn block(&mut self, name: &str, port: &str, components: &[&str], unit: &str, text: &str) {
        for (index, component) in components.iter().enumerate() {
            let (name, port) = (format!("{name}_{component}"), format!("{port}.mantissa[{index}]"));
            self.mantissa(&name, &port, unit, &format!("{text}: mantissa {component}"));
        }
        let (name, port) = (format!("{name}_e"), format!("{port}.exponent"));
        self.signed(&name, &port, [16, 0, 0], "1", &format!("{text}: exponent of two"));
    }

    fn vector(&mut self, name: &str, port: &str, unit: &str, text: &str) {
        self.block(name, port, &AXES, unit, text);
    }

    fn pair(&mut self, name: &str, port: &str, unit: &str, text: &str) {
        self.block(name, port, &["s", "t"], unit, text);
    }

    fn number(&mut self, name: &str, port: &str, unit: &str, text: &str) {
        self.block(name, port, &["m"], unit, text);
    }

    fn status<'b>(&mut self, bits: impl Iterator<Item = &'b (StatusBit, &'static str)>) {
        self.at(Direction::Out, "status");
        let bits: Vec<_> = bits.collect();
        let names: Vec<_> = bits.iter().map(|(bit, name)| format!("{} {name}", *bit as u32)).collect();
        let width = bits.iter().fold(0, |all, (bit, _)| all | *bit as u32).checked_ilog2().unwrap_or(0) + 1;
        self.unsigned("status", "status", [width, 0, 0], "bits", &format!("sticky bits: {}", names.join(", ")));
    }

    fn finish(mut self, ports: usize) -> Layout {
        self.at(Direction::Check, "check");
        self.push("check", "", false, [CHECK_BITS, 0], "1", "CRC-32 of the bits above, see FORMAT.md");
        let mut lsb = 0;
        for field in self.list.iter_mut().rev() {
            field.lsb = lsb;
            lsb += 4 * field.digits();
        }
        Layout { fields: self.list, sources: self.sources, ports }
    }
}
