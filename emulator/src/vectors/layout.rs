//! The fields of a vector word: which there are, where they lie, and how port values go in and out.
//!
//! Three lists walk the ports in one order: [`Layout::new`] names the fields, [`port_words`] reads them and
//! [`fragment`] puts inputs back. A field keeps the bits its profile keeps and takes whole hex digits.

use fixed::types::{I2F30, I4F28};
use roughxel_core::ports::{BlockNumber, BlockPair, BlockVector, ReflectionIn, ReflectionOut};
use roughxel_core::precision::Precision;
use roughxel_core::status::STATUS_BITS;
use serde::{Deserialize, Serialize};

/// Stages in pipeline order; of several differing fields the one of the earliest stage is named first.
pub const STAGES: [&str; 11] =
    ["input", "frame", "perturb", "reflect", "cube_face", "columns", "ellipse", "axes", "probes", "status", "check"];

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

/// The fields of a word, most significant first, for one profile.
#[derive(Clone, Debug)]
pub struct Layout {
    fields: Vec<Field>,
    /// Low bits of each port that the profile does not keep.
    drops: Vec<u32>,
}

impl Layout {
    /// The fields of the reflection datapath under `p`.
    pub fn new(p: &Precision) -> Self {
        let mut build = Builder { p, direction: Direction::In, stage: "input", fields: Vec::new(), drops: Vec::new() };
        build.vector("normal", "length", "surface normal n, any length");
        build.vector("view", "length", "view vector v, from the surface to the eye, any length");
        build.vector("tangent_0", "length", "main direction h, or p_u where the frame is natural");
        build.vector("tangent_1", "length", "p_v where the frame is natural");
        build.offset("offset_1", "bump offset b1, relative to |n|");
        build.offset("offset_2", "bump offset b2, relative to |n|");
        build.offset("roughness_1", "roughness d1, relative to |n|; I1 where it is isotropic");
        build.offset("roughness_2", "roughness d2, relative to |n|");
        build.offset("roughness_3", "roughness d3, relative to |n|");
        build.vector("dview_dx", "length per pixel", "dv/dx, one pixel to the right");
        build.vector("dview_dy", "length per pixel", "dv/dy, one pixel down");
        build.vector("dnormal_dx", "length per pixel", "dn/dx, in the units of n");
        build.vector("dnormal_dy", "length per pixel", "dn/dy, in the units of n");
        build.unsigned(
            "edge_texels",
            16,
            0,
            0,
            "texels",
            "edge of a face at level 0; 0 reads as 1, more than 16384 as 16384",
        );

        build.at(Direction::Tap, "frame");
        build.vector("frame_e1", "length", "tangent E1, scaled by |n|");
        build.vector("frame_e2", "length", "tangent E2, scaled by |n|");
        build.at(Direction::Tap, "perturb");
        build.vector("normal_mod", "length", "perturbed normal n_mod");
        build.at(Direction::Tap, "reflect");
        build.vector("reflected", "length^3", "reflected vector r = 2 n_mod (v.n_mod) - v |n_mod|^2");
        build.at(Direction::Tap, "columns");
        build.pair("column_dx", "half faces per pixel", "d(s,t) for one pixel to the right");
        build.pair("column_dy", "half faces per pixel", "d(s,t) for one pixel down");
        build.pair("column_d1", "half faces", "d(s,t) for the roughness tangent d1 E1 (isotropic: I1 E1)");
        build.pair("column_d2", "half faces", "d(s,t) for the roughness tangent d2 E1 + d3 E2 (isotropic: I1 E2)");
        build.at(Direction::Tap, "ellipse");
        build.block(
            "covariance",
            &["a", "b", "c"],
            "half faces squared",
            "covariance K = [[a, b], [b, c]] on the face",
        );
        build.block("determinant", &["m"], "half faces^4", "det K");
        build.at(Direction::Tap, "axes");
        build.block("major", &["m"], "half faces", "standard deviation lambda1 along the major axis");
        build.block("minor", &["m"], "half faces", "standard deviation lambda2 along the minor axis");
        build.mantissa("direction_s", "1", "unit direction of the major axis, s");
        build.mantissa("direction_t", "1", "unit direction of the major axis, t");

        build.at(Direction::Out, "cube_face");
        build.unsigned("face", 3, 0, 0, "1", "face 0 to 5: +x, -x, +y, -y, +z, -z");
        build.mantissa("s", "half faces", "s in [-1, 1], to the right on the face");
        build.mantissa("t", "half faces", "t in [-1, 1], down on the face");
        build.at(Direction::Out, "probes");
        build.unsigned("probes", 5, 0, 0, "1", "number of probes, 1 to 16");
        build.signed("step_s", 32, 28, 0, "half faces", "step from one probe to the next, s");
        build.signed("step_t", 32, 28, 0, "half faces", "step from one probe to the next, t");
        build.unsigned("lod", 4 + p.lod_bits, p.lod_bits, 16 - p.lod_bits, "levels", "level of detail");
        build.at(Direction::Out, "status");
        let names: Vec<_> = STATUS_BITS.iter().map(|(bit, name)| format!("{} {name}", *bit as u32)).collect();
        let width = STATUS_BITS.iter().fold(0, |all, (bit, _)| all | *bit as u32).checked_ilog2().unwrap_or(0) + 1;
        build.unsigned("status", width, 0, 0, "bits", &format!("sticky bits: {}", names.join(", ")));

        build.at(Direction::Check, "check");
        build.unsigned("check", CHECK_BITS, 0, 0, "1", "CRC-32 of the bits above, see FORMAT.md");
        build.finish()
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

    /// The fields' bits of a fragment and its result, the check value left out; or the first field that is too
    /// narrow for its port's value.
    pub(crate) fn encode(&self, input: &ReflectionIn, output: &ReflectionOut) -> Result<Vec<u32>, usize> {
        let encode_field = |(index, word): (usize, i32)| {
            let (field, drop) = (&self.fields[index], self.drops[index]);
            let bits = (word >> drop).cast_unsigned() & mask(field.width);
            let back = field.integer(bits) << drop;
            if back == i64::from(word) { Ok(bits) } else { Err(index) }
        };
        port_words(input, output).into_iter().enumerate().map(encode_field).collect()
    }

    /// The inputs in the fields' bits of a word.
    pub(crate) fn decode(&self, bits: &[u32]) -> ReflectionIn {
        let fields = self.fields.iter().zip(&self.drops).zip(bits);
        let words = fields.map(|((field, drop), bits)| (field.integer(bits & mask(field.width)) << drop) as i32);
        fragment(words)
    }
}

/// The lowest `width` bits, 1…32.
pub(crate) const fn mask(width: u32) -> u32 {
    u32::MAX >> (32 - width)
}

struct Builder<'a> {
    p: &'a Precision,
    direction: Direction,
    stage: &'static str,
    fields: Vec<Field>,
    drops: Vec<u32>,
}

impl Builder<'_> {
    fn at(&mut self, direction: Direction, stage: &'static str) {
        (self.direction, self.stage) = (direction, stage);
    }

    fn field(&mut self, name: &str, signed: bool, [width, fraction_bits, drop]: [u32; 3], unit: &str, text: &str) {
        self.fields.push(Field {
            name: name.into(),
            direction: self.direction,
            stage: self.stage.into(),
            lsb: 0,
            width,
            signed,
            fraction_bits,
            unit: unit.into(),
            tolerance: 0,
            description: text.into(),
        });
        self.drops.push(drop);
    }

    fn signed(&mut self, name: &str, width: u32, fraction_bits: u32, drop: u32, unit: &str, text: &str) {
        self.field(name, true, [width, fraction_bits, drop], unit, text);
    }

    fn unsigned(&mut self, name: &str, width: u32, fraction_bits: u32, drop: u32, unit: &str, text: &str) {
        self.field(name, false, [width, fraction_bits, drop], unit, text);
    }

    /// I2F30 of which the profile keeps p fraction bits.
    fn mantissa(&mut self, name: &str, unit: &str, text: &str) {
        let p = self.p.fraction_bits;
        self.signed(name, p + 2, p, 30 - p, unit, text);
    }

    /// I4F28 of which the profile keeps p − 2 fraction bits.
    fn offset(&mut self, name: &str, text: &str) {
        let bits = self.p.offset_bits();
        self.signed(name, bits + 4, bits, 28 - bits, "|n|", text);
    }

    fn block(&mut self, name: &str, components: &[&str], unit: &str, text: &str) {
        for component in components {
            self.mantissa(&format!("{name}_{component}"), unit, &format!("{text}: mantissa {component}"));
        }
        self.signed(&format!("{name}_e"), 16, 0, 0, "1", &format!("{text}: exponent of two"));
    }

    fn vector(&mut self, name: &str, unit: &str, text: &str) {
        self.block(name, &["x", "y", "z"], unit, text);
    }

    fn pair(&mut self, name: &str, unit: &str, text: &str) {
        self.block(name, &["s", "t"], unit, text);
    }

    fn finish(mut self) -> Layout {
        let mut lsb = 0;
        for field in self.fields.iter_mut().rev() {
            field.lsb = lsb;
            lsb += 4 * field.digits();
        }
        Layout { fields: self.fields, drops: self.drops }
    }
}

/// Every port as an integer, in the order of the fields.
fn port_words(input: &ReflectionIn, output: &ReflectionOut) -> Vec<i32> {
    fn block(words: &mut Vec<i32>, mantissas: &[I2F30], exponent: i16) {
        words.extend(mantissas.iter().map(|m| m.to_bits()));
        words.push(exponent.into());
    }
    let vector = |words: &mut Vec<i32>, v: &BlockVector| block(words, &v.mantissa, v.exponent);
    let pair = |words: &mut Vec<i32>, v: &BlockPair| block(words, &v.mantissa, v.exponent);
    let number = |words: &mut Vec<i32>, x: &BlockNumber| block(words, &[x.mantissa], x.exponent);

    let mut words = Vec::with_capacity(96);
    let ReflectionIn { normal, view, tangents, offset, roughness, dview, dnormal, edge_texels } = input;
    [normal, view, &tangents[0], &tangents[1]].into_iter().for_each(|v| vector(&mut words, v));
    words.extend(offset.iter().chain(roughness).map(|x| x.to_bits()));
    dview.iter().chain(dnormal).for_each(|v| vector(&mut words, v));
    words.push(i32::from(*edge_texels));

    let o = output;
    [&o.frame[0], &o.frame[1], &o.normal_mod, &o.reflected].into_iter().for_each(|v| vector(&mut words, v));
    o.columns.iter().for_each(|q| pair(&mut words, q));
    vector(&mut words, &o.covariance);
    [&o.determinant, &o.major, &o.minor].into_iter().for_each(|x| number(&mut words, x));
    words.extend(o.direction.map(I2F30::to_bits));
    words.push(i32::from(o.face));
    words.extend(o.st.map(I2F30::to_bits));
    words.push(i32::from(o.probes));
    words.extend(o.step.map(I4F28::to_bits));
    words.push(o.lod.to_bits());
    words.push(o.status.cast_signed());
    words
}

/// The inputs from their integers, in the order of the fields.
fn fragment(words: impl Iterator<Item = i32>) -> ReflectionIn {
    fn vector(next: &mut impl FnMut() -> i32) -> BlockVector {
        BlockVector { mantissa: [next(), next(), next()].map(I2F30::from_bits), exponent: next() as i16 }
    }
    let mut words = words.fuse();
    let mut next = || words.next().unwrap_or(0);
    ReflectionIn {
        normal: vector(&mut next),
        view: vector(&mut next),
        tangents: [vector(&mut next), vector(&mut next)],
        offset: [next(), next()].map(I4F28::from_bits),
        roughness: [next(), next(), next()].map(I4F28::from_bits),
        dview: [vector(&mut next), vector(&mut next)],
        dnormal: [vector(&mut next), vector(&mut next)],
        edge_texels: next() as u16,
    }
}
