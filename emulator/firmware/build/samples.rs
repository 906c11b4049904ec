//! Fragments of the tile as constants, so that a priced program does no set-up.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use roughxel_core::ports::{BlockPort, ReflectionIn, TextureIn};

#[path = "../../../core/oracle/tests/oracle/tile/drawn.rs"]
#[expect(dead_code, reason = "the programs draw it, too")]
mod tile;

/// Number of samples: instructions are means over them.
const SAMPLES: usize = 64;

/// Writes `samples.rs`, the lists of both kinds of fragments.
pub fn write(out: &Path) {
    println!("cargo:rerun-if-changed=../../core/oracle/tests/oracle/tile/drawn.rs");
    let mut all = Vec::new();
    tile::fragments(|_, fragment| all.push(*fragment));
    let chosen = || (0..SAMPLES).map(|index| &all[index * all.len() / SAMPLES]);
    let mut text = String::from("pub static REFLECTIONS: [ReflectionIn; SAMPLES] = [\n");
    for fragment in chosen() {
        writeln!(text, "{},", reflection(&fragment.reflection)).expect("a text grows");
    }
    text += "];\npub static TEXTURES: [TextureIn; SAMPLES] = [\n";
    for fragment in chosen() {
        let texture = fragment.texture.expect("the tile has texture coordinates");
        writeln!(text, "{},", self::texture(&texture)).expect("a text grows");
    }
    write!(text, "];\n/// Number of fragments.\npub const SAMPLES: usize = {SAMPLES};\n").expect("a text grows");
    fs::write(out.join("samples.rs"), text).expect("it can be written");
}

fn block<const N: usize>(block: &BlockPort<N>) -> String {
    let BlockPort { mantissa, exponent } = block;
    format!("BlockPort {{ mantissa: [{}], exponent: {exponent} }}", bits("I2F30", mantissa.map(|m| m.to_bits())))
}

fn blocks<const N: usize>(pair: &[BlockPort<N>; 2]) -> String {
    format!("[{}, {}]", block(&pair[0]), block(&pair[1]))
}

fn bits<T: std::fmt::Display, const N: usize>(kind: &str, bits: [T; N]) -> String {
    bits.map(|bits| format!("{kind}::from_bits({bits})")).join(", ")
}

fn reflection(fragment: &ReflectionIn) -> String {
    let ReflectionIn { surface, dview, dnormal, edge_texels } = fragment;
    format!(
        "ReflectionIn {{ surface: SurfaceIn {{ normal: {}, view: {}, frame_vectors: {}, offset: [{}], roughness: [{}] }}, dview: {}, \
         dnormal: {}, edge_texels: {edge_texels} }}",
        block(&surface.normal),
        block(&surface.view),
        blocks(&surface.frame_vectors),
        bits("I4F28", surface.offset.map(|b| b.to_bits())),
        bits("I4F28", surface.roughness.map(|d| d.to_bits())),
        blocks(dview),
        blocks(dnormal),
    )
}

fn texture(fragment: &TextureIn) -> String {
    let TextureIn { uv, duv } = fragment;
    format!("TextureIn {{ uv: [{}], duv: {} }}", bits("U0F32", uv.map(|u| u.to_bits())), blocks(duv))
}
