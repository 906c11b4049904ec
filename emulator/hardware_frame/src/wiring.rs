//! Wires of the outermost module: from the outputs of designs through queues to the inputs of others.

use std::fmt::Write as _;

use roughxel_netlist::verilog::PortDescription;

use crate::chain::Chain;
use crate::pin::Pin;

/// Footprints of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Footprint {
    /// Footprint on the plane of a cube face.
    Face,
    /// Footprint on the sphere.
    Sphere,
}

/// Bits of a fragment below the ports of the reflection.
pub(crate) const FRAGMENT_BASE: u32 = 175;
/// Bits of the constants below the ports of the reflection.
pub(crate) const CONSTANT_BASE: u32 = 7;

/// Total width of ports.
pub(crate) fn total(ports: &[PortDescription]) -> u32 {
    ports.iter().map(|port| port.width).sum()
}

/// Ports of a vector whose lowest bit is `base`, first one most significant, each with its slice.
fn slices<'a>(ports: &'a [PortDescription], vector: &str, base: u32) -> Vec<(&'a PortDescription, String)> {
    let mut above = base + total(ports);
    let slice = |port: &'a PortDescription| {
        let high = above - 1;
        above -= port.width;
        (port, if port.width == 1 { format!("{vector}[{high}]") } else { format!("{vector}[{high}:{above}]") })
    };
    ports.iter().map(slice).collect()
}

/// Parts of the text of the outermost module.
pub(crate) struct Wiring {
    /// Sizes, and wires with the outputs of designs.
    pub(crate) wires: String,
    /// Wires with the parts of a footprint.
    pub(crate) foot: String,
    /// Wires with the texels of a channel.
    pub(crate) job_texels: String,
}

impl Wiring {
    /// Connects all designs of a chain. `ports` are those of the reflection that a fragment brings, `constants` its others.
    pub(crate) fn new(
        chain: &mut Chain,
        footprint: Footprint,
        (ports, constants): (&[PortDescription], &[PortDescription]),
    ) -> Self {
        let widths = Widths::new(chain, footprint);
        let wires = aliases(chain, footprint, &widths);
        connect(chain, (ports, constants), &widths);
        Self { wires, foot: footprint_wires(footprint, &widths), job_texels: job_texels() }
    }
}

/// Formats that are the same on both sides of a queue.
struct Widths {
    /// Ports of the probe that its footprint holds.
    foot: Vec<PortDescription>,
    /// Level of detail of a footprint on a face.
    lod: Option<Pin>,
    place: [Pin; 2],
    level_weight: Pin,
    weights: Pin,
    sum: Pin,
    light: Pin,
}

impl Widths {
    fn new(chain: &Chain, footprint: Footprint) -> Self {
        let input = |name, path| chain.input(name, path).unwrap_or_else(|| unreachable!("{name} reads {path}"));
        Self {
            foot: chain.footprint().cloned().collect(),
            lod: (footprint == Footprint::Face).then(|| input("levels", "lod")),
            place: [input("address", "place.st[0]"), input("address", "place.st[1]")],
            level_weight: input("sample", "level_weight"),
            weights: input("sample", "weights[0][0]"),
            sum: input("sum", "sum.sum"),
            light: input("light_0", "sum.sum"),
        }
    }

    fn lod_bits(&self) -> u32 {
        self.lod.map_or(1, |pin| pin.width)
    }

    fn foot_bits(&self) -> u32 {
        total(&self.foot) + self.lod_bits()
    }
}

const FACE: Pin = Pin::count(3);
const LEVEL: Pin = Pin::count(4);
const INDEX: Pin = Pin::count(14);
const EDGE: Pin = Pin::count(15);
const FLAG: Pin = Pin::count(1);
const WEIGHT: Pin = Pin::unsigned(17, 16);
const CHANNEL: Pin = Pin::count(16);
const LIGHT: Pin = Pin::unsigned(30, 24);

/// Wires with the outputs of designs in the formats that queues hold.
fn aliases(chain: &mut Chain, footprint: Footprint, widths: &Widths) -> String {
    let mut text = String::new();
    let sample_bits = widths.level_weight.width + 20;
    let sizes = [
        ("FOOT_BITS", widths.foot_bits()),
        ("LOD_BITS", widths.lod_bits()),
        ("PLACE_BITS", widths.place[0].width + widths.place[1].width),
        ("LEVEL_WEIGHT_BITS", widths.level_weight.width),
        ("SAMPLE_BITS", sample_bits),
        ("PATCH_WEIGHT_BITS", 2 * widths.weights.width),
        ("SUM_BITS", widths.sum.width),
        ("LIGHT_BITS", widths.light.width),
    ];
    for (name, bits) in sizes {
        let _ = writeln!(text, "  localparam {name} = {bits};");
    }
    let mut alias = |name: &str, parts: &[(&str, &str, Pin)]| {
        let width = parts.iter().map(|(.., pin)| pin.width).sum();
        let parts: Vec<_> = parts.iter().map(|(from, path, pin)| chain.output(from, path, *pin)).collect();
        let parts = if parts.len() == 1 { parts[0].clone() } else { format!("{{{}}}", parts.join(", ")) };
        let _ = writeln!(text, "  wire {}{name} = {parts};", Pin::count(width).vector());
    };
    let foot: Vec<_> = widths.foot.iter().map(|port| ("reflect", port.name.as_str(), Pin::of(port))).collect();
    let lod = widths.lod.map(|pin| ("reflect", "probes.lod", pin));
    match lod {
        Some(lod) => alias("foot_in", &[foot, vec![lod]].concat()),
        // A footprint on the sphere has a level of detail for each probe.
        None => alias("foot_of_reflection", &foot),
    }
    let [s, t] = widths.place;
    alias("probe_place", &[("probe", "place.st[0]", s), ("probe", "place.st[1]", t)]);
    alias("probe_face", &[("probe", "place.face", FACE)]);
    alias("probe_weight", &[("probe", "weight", WEIGHT)]);
    alias("level", &[("levels", "level", LEVEL)]);
    alias("level_weight", &[("levels", "weight", widths.level_weight)]);
    alias("patch_weights", &[("address", "weight[1]", widths.weights), ("address", "weight[0]", widths.weights)]);
    for texel in 0..4 {
        let path = |place: &str| format!("[{texel}].{place}");
        let places = ["across[1]", "across[0]", "texel"].map(|place| {
            [format!("{place}.index[1]"), format!("{place}.index[0]"), format!("{place}.face")]
                .map(|place| path(&place))
        });
        let corner = path("corner");
        let mut parts = vec![("texels", corner.as_str(), FLAG)];
        for [row, column, face] in &places {
            parts.extend([
                ("texels", row.as_str(), INDEX),
                ("texels", column.as_str(), INDEX),
                ("texels", face.as_str(), FACE),
            ]);
        }
        alias(&format!("texel_{texel}"), &parts);
    }
    for channel in 0..3 {
        alias(&format!("corner_{channel}_texel"), &[(&format!("corner_{channel}"), "result", CHANNEL)]);
        alias(&format!("light_{channel}_next"), &[(&format!("light_{channel}"), "sum", widths.light)]);
        alias(&format!("pixel_{channel}_light"), &[(&format!("pixel_{channel}"), "result", LIGHT)]);
    }
    alias("sum_next", &[("sum", "sum", widths.sum)]);
    alias("colour_light", &[("colour", "result", LIGHT)]);
    alias("blend_light", &[("blend", "result", LIGHT)]);
    if footprint == Footprint::Sphere {
        text += "  wire [FOOT_BITS-1:0] foot_in = {foot_of_reflection, 1'b0};\n  wire unused_lod = tag_lod;\n";
    }
    text
}

/// Wires with the parts of a footprint that comes out of its queue.
fn footprint_wires(footprint: Footprint, widths: &Widths) -> String {
    let count = match footprint {
        Footprint::Face => "probes.count",
        Footprint::Sphere => "sweep.count",
    };
    let found = slices(&widths.foot, "foot", widths.lod_bits());
    let (port, slice) = found
        .iter()
        .find(|(port, _)| port.name == count)
        .unwrap_or_else(|| unreachable!("a probe reads the count of its footprint"));
    let lod = if widths.lod_bits() == 1 { "foot[0]".into() } else { format!("foot[{}:0]", widths.lod_bits() - 1) };
    format!("  wire {}foot_count = {slice};\n  wire [LOD_BITS-1:0] foot_lod = {lod};\n", Pin::of(port).vector())
}

/// Texels of the channel that the filter takes.
fn job_texels() -> String {
    let texel = |place: u32| format!("  wire [15:0] job_texel_{place} = job[{} + 16*channel +: 16];\n", 48 * place);
    (0..8).map(texel).collect()
}

/// Connects the inputs of all designs.
fn connect(chain: &mut Chain, (ports, constants): (&[PortDescription], &[PortDescription]), widths: &Widths) {
    for (port, slice) in slices(ports, "in_fragment", FRAGMENT_BASE) {
        chain.connect("reflect", &port.name, slice);
    }
    for (port, slice) in slices(constants, "constants", CONSTANT_BASE) {
        chain.connect("reflect", &port.name, slice);
    }
    for (port, slice) in slices(&widths.foot, "foot", widths.lod_bits()) {
        chain.connect("probe", &port.name, slice);
    }
    chain.connect_wire("probe", "index", "index", LEVEL);
    chain.connect_wire("probe", "last_level", "last_level", LEVEL);
    match widths.lod {
        Some(pin) => chain.connect_wire("levels", "lod", "tag_lod", pin),
        None => {
            if let Some(pin) = chain.input("levels", "lod") {
                let lod = chain.output("probe", "lod", pin);
                chain.connect("levels", "lod", lod);
            }
        }
    }
    chain.connect_wire("levels", "rough", "tag_rough", FLAG);
    let [s, t] = widths.place;
    let slice = |high: u32, low: u32| format!("hold_place[{high}:{low}]");
    chain.connect("address", "place.st[0]", slice(s.width + t.width - 1, t.width));
    chain.connect("address", "place.st[1]", slice(t.width - 1, 0));
    chain.connect_wire("address", "edge", "patch_edge", EDGE);
    chain.connect_wire("texels", "face", "texels_face", FACE);
    chain.connect_wire("texels", "edge", "texels_edge", EDGE);
    for axis in 0..2 {
        let path = format!("address.index[{axis}]");
        if let Some(pin) = chain.input("texels", &path) {
            let index = chain.output("address", &format!("index[{axis}]"), pin);
            chain.connect("texels", &path, index);
        }
        for level in 0..2 {
            let low = (2 * level + axis) * widths.weights.width;
            let slice = format!("job_weights[{}:{low}]", low + widths.weights.width - 1);
            chain.connect("sample", &format!("weights[{level}][{axis}]"), slice);
        }
    }
    for channel in 0..3 {
        let name = format!("corner_{channel}");
        let low = 16 * channel;
        chain.connect(&name, "texels[0]", format!("parts[{}:{low}]", low + 15));
        chain.connect(&name, "texels[1]", format!("parts[{}:{}]", low + 63, low + 48));
        chain.connect(&name, "texels[2]", format!("cache_texel[{}:{low}]", low + 15));
        let (light, pixel) = (format!("light_{channel}"), format!("pixel_{channel}"));
        let letter = ["r", "g", "b"][channel];
        chain.connect_wire(&light, "sum.sum", &format!("light_{letter}"), widths.light);
        chain.connect_wire(&light, "colour", &format!("blended_{letter}"), LIGHT);
        chain.connect_wire(&pixel, "sum", &format!("mean_{letter}"), widths.light);
    }
    for place in 0..8 {
        let path = format!("texels[{}][{}]", place / 4, place % 4);
        chain.connect_wire("sample", &path, &format!("job_texel_{place}"), CHANNEL);
    }
    chain.connect_wire("sample", "level_weight", "job_level_weight", widths.level_weight);
    for (from, to, path) in [("sample", "sum", "sample"), ("mean", "colour", "sample")] {
        if let Some(pin) = chain.input(to, path) {
            let result = chain.output(from, "result", pin);
            chain.connect(to, path, result);
        }
    }
    chain.connect_wire("sum", "weight", "sample_weight", WEIGHT);
    chain.connect_wire("sum", "sum.sum", "sum_so_far", widths.sum);
    if let Some(pin) = chain.input("mean", "sum") {
        let sum = chain.output("sum", "sum", pin);
        chain.connect("mean", "sum", sum);
    }
    chain.connect_wire("colour", "exponent", "exponent", FACE);
    chain.connect_wire("blend", "surface", "surface", LIGHT);
    chain.connect_wire("blend", "reflection", "reflection", LIGHT);
    chain.connect_wire("blend", "reflectance", "reflectance", WEIGHT);
}
