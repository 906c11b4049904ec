//! Cube maps in one file: KTX2 and DDS, uncompressed, BC6H or BC7. The first level is read.
//!
//! Faces are in the order of both formats, +x, −x, +y, −y, +z, −z, rows from the top (KTX 2.0 §3; Direct3D 11.3 §5.12). Both describe the
//! faces as Vulkan samples them.

use std::io::Read as _;
use std::path::Path;

use exr::prelude::f16;

use super::codes::decode_table;
use super::colour::Transfer;
use super::colour_words::ColourWords;
use super::statement::{Purpose, Statement, Wishes};
use super::{Picture, PictureError, open};

/// Beginning of a DDS file.
const DDS: &[u8; 4] = b"DDS ";

/// Beginning of a KTX2 file.
const KTX2: &[u8; 12] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Longest edge of a face in pixels.
const MAX_FACE_EDGE: u32 = 4096;

/// Largest file in bytes.
const MAX_BYTES: u64 = 1 << 31;

/// Most levels of a cube map: those of its longest edge.
const MAX_LEVELS: u32 = 13;

/// Six faces from one file.
#[derive(Debug)]
pub struct CubeFile {
    /// The faces in linear light.
    pub faces: [Picture; 6],
    /// Words of the file, and decisions.
    pub statement: Statement,
}

/// Format of the texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TexelFormat {
    /// 8-bit codes: bytes a texel, and the places of red, green, blue.
    Codes(usize, [usize; 3]),
    /// Half floats: channels a texel.
    Half(usize),
    /// Floats: channels a texel.
    Float(usize),
    /// Three mantissas of 9 bits with one exponent.
    SharedExponent,
    /// Unsigned floats of 11, 11 and 10 bits.
    Packed11,
    /// BC6H, true if signed.
    Bc6h(bool),
    /// BC7.
    Bc7,
}

/// Faces of a file, undecoded.
struct Content<'a> {
    faces: [&'a [u8]; 6],
    edge: u32,
    format: TexelFormat,
    /// Kind of the file and name of the format.
    name: String,
    /// Transfer function that the file names.
    transfer: Option<Transfer>,
}

/// True if the bytes of a file are those of a KTX2 or DDS file, which may hold a cube map.
pub fn is_cube_file(path: &Path) -> bool {
    let mut head = [0; KTX2.len()];
    let read =
        open(path).and_then(|mut file| file.read_exact(&mut head).map_err(|source| PictureError::open(path, source)));
    read.is_ok() && (head.starts_with(DDS) || head == *KTX2)
}

/// Reads a cube map from a KTX2 or DDS file. `wishes` decide against the words of the file.
///
/// # Errors
/// A file that cannot be opened, is neither KTX2 nor DDS, is no cube map, is truncated, supercompressed or of another texel format; a face
/// that is no square of at most 4096 pixels; a value that is NaN or infinite.
pub fn read_cube(path: &Path, wishes: &Wishes) -> Result<CubeFile, PictureError> {
    let mut bytes = Vec::new();
    open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|source| PictureError::open(path, source))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(PictureError::new(
            format!("`{}` is longer than {MAX_BYTES} bytes", path.display()),
            "scale it down",
        ));
    }
    if bytes.starts_with(DDS) {
        let dds = dds(path, &bytes)?;
        return decode(path, dds_content(path, &dds)?, wishes);
    }
    if bytes.starts_with(KTX2) {
        let reader =
            ktx2::Reader::new(bytes.as_slice()).map_err(|reason| PictureError::damaged(path, "KTX2", reason))?;
        return decode(path, ktx2_content(path, &reader)?, wishes);
    }
    Err(PictureError::unsupported(path, "is neither a KTX2 nor a DDS file", "a KTX2 cube map of half floats"))
}

/// Checks that the faces are squares of an allowed size.
fn check_edge(path: &Path, width: u32, height: u32) -> Result<u32, PictureError> {
    if width == height && (1..=MAX_FACE_EDGE).contains(&width) {
        return Ok(width);
    }
    let reason = format!("has faces of {width}×{height} pixels");
    Err(PictureError::unsupported(path, reason, &format!("squares of at most {MAX_FACE_EDGE} pixels")))
}

/// Reads the content of a KTX2 file.
fn ktx2_content<'a>(path: &Path, reader: &'a ktx2::Reader<&'a [u8]>) -> Result<Content<'a>, PictureError> {
    use ktx2::Format as F;
    let header = reader.header();
    let unsupported =
        |reason: String| PictureError::unsupported(path, reason, "a KTX2 cube map of half floats, not supercompressed");
    if header.face_count != 6 || header.layer_count > 1 || header.pixel_depth > 0 {
        return Err(unsupported("is no single cube map".to_owned()));
    }
    if let Some(scheme) = header.supercompression_scheme {
        return Err(unsupported(format!("is supercompressed ({scheme:?})")));
    }
    let Some(format) = header.format else {
        return Err(unsupported("holds Basis Universal texels".to_owned()));
    };
    let texels = match format {
        F::R8G8B8A8_UNORM | F::R8G8B8A8_SRGB => TexelFormat::Codes(4, [0, 1, 2]),
        F::B8G8R8A8_UNORM | F::B8G8R8A8_SRGB => TexelFormat::Codes(4, [2, 1, 0]),
        F::R8G8B8_UNORM | F::R8G8B8_SRGB => TexelFormat::Codes(3, [0, 1, 2]),
        F::R16G16B16A16_SFLOAT => TexelFormat::Half(4),
        F::R16G16B16_SFLOAT => TexelFormat::Half(3),
        F::R32G32B32A32_SFLOAT => TexelFormat::Float(4),
        F::R32G32B32_SFLOAT => TexelFormat::Float(3),
        F::E5B9G9R9_UFLOAT_PACK32 => TexelFormat::SharedExponent,
        F::B10G11R11_UFLOAT_PACK32 => TexelFormat::Packed11,
        F::BC6H_UFLOAT_BLOCK => TexelFormat::Bc6h(false),
        F::BC6H_SFLOAT_BLOCK => TexelFormat::Bc6h(true),
        F::BC7_UNORM_BLOCK | F::BC7_SRGB_BLOCK => TexelFormat::Bc7,
        other => return Err(unsupported(format!("holds texels of the format {other:?}"))),
    };
    let edge = check_edge(path, header.pixel_width, header.pixel_height)?;
    let transfer = match reader.transfer_function() {
        Some(ktx2::TransferFunction::SRGB) => Some(Transfer::Srgb),
        Some(ktx2::TransferFunction::Linear) => Some(Transfer::Linear),
        _ => None,
    };
    let size = face_bytes(texels, edge);
    let data = reader.levels().next().map_or(&[][..], |level| level.data);
    // Faces follow each other without a gap (KTX 2.0 §3.9.7).
    let faces = split(path, "KTX2", |face| data.get(face * size..(face + 1) * size))?;
    Ok(Content { faces, edge, format: texels, name: format!("KTX2, {format:?}"), transfer })
}

/// Parses a DDS file.
fn dds(path: &Path, bytes: &[u8]) -> Result<ddsfile::Dds, PictureError> {
    let dds = ddsfile::Dds::read(bytes).map_err(|reason| PictureError::damaged(path, "DDS", reason))?;
    check_edge(path, dds.get_width(), dds.get_height())?;
    if dds.get_num_mipmap_levels() > MAX_LEVELS {
        return Err(PictureError::damaged(path, "DDS", "it has more levels than its size allows"));
    }
    Ok(dds)
}

/// Reads the content of a DDS file.
fn dds_content<'a>(path: &Path, dds: &'a ddsfile::Dds) -> Result<Content<'a>, PictureError> {
    use ddsfile::{D3DFormat as D, DxgiFormat as F};
    let unsupported = |reason: String| PictureError::unsupported(path, reason, "a DDS cube map of half floats or BC6H");
    let is_cube = match &dds.header10 {
        Some(header) => header.misc_flag.contains(ddsfile::MiscFlag::TEXTURECUBE) && header.array_size == 1,
        None => dds.header.caps2.contains(ddsfile::Caps2::CUBEMAP | ddsfile::Caps2::CUBEMAP_ALLFACES),
    };
    if !is_cube {
        return Err(unsupported("is no single cube map with six faces".to_owned()));
    }
    let (format, name, transfer) = if dds.header10.is_some() {
        let format = dds.get_dxgi_format().ok_or_else(|| unsupported("has no known texel format".to_owned()))?;
        let (texels, transfer) = match format {
            F::R8G8B8A8_UNorm => (TexelFormat::Codes(4, [0, 1, 2]), Transfer::Linear),
            F::R8G8B8A8_UNorm_sRGB => (TexelFormat::Codes(4, [0, 1, 2]), Transfer::Srgb),
            F::B8G8R8A8_UNorm | F::B8G8R8X8_UNorm => (TexelFormat::Codes(4, [2, 1, 0]), Transfer::Linear),
            F::B8G8R8A8_UNorm_sRGB | F::B8G8R8X8_UNorm_sRGB => (TexelFormat::Codes(4, [2, 1, 0]), Transfer::Srgb),
            F::R16G16B16A16_Float => (TexelFormat::Half(4), Transfer::Linear),
            F::R32G32B32A32_Float => (TexelFormat::Float(4), Transfer::Linear),
            F::R32G32B32_Float => (TexelFormat::Float(3), Transfer::Linear),
            F::R9G9B9E5_SharedExp => (TexelFormat::SharedExponent, Transfer::Linear),
            F::R11G11B10_Float => (TexelFormat::Packed11, Transfer::Linear),
            F::BC6H_UF16 => (TexelFormat::Bc6h(false), Transfer::Linear),
            F::BC6H_SF16 => (TexelFormat::Bc6h(true), Transfer::Linear),
            F::BC7_UNorm => (TexelFormat::Bc7, Transfer::Linear),
            F::BC7_UNorm_sRGB => (TexelFormat::Bc7, Transfer::Srgb),
            other => return Err(unsupported(format!("holds texels of the format {other:?}"))),
        };
        (texels, format!("{format:?}"), Some(transfer))
    } else {
        let format = dds.get_d3d_format().ok_or_else(|| unsupported("has no known texel format".to_owned()))?;
        let texels = match format {
            D::A8R8G8B8 | D::X8R8G8B8 => TexelFormat::Codes(4, [2, 1, 0]),
            D::A8B8G8R8 | D::X8B8G8R8 => TexelFormat::Codes(4, [0, 1, 2]),
            D::R8G8B8 => TexelFormat::Codes(3, [2, 1, 0]),
            D::A16B16G16R16F => TexelFormat::Half(4),
            D::A32B32G32R32F => TexelFormat::Float(4),
            other => return Err(unsupported(format!("holds texels of the format {other:?}"))),
        };
        (texels, format!("{format:?}"), None)
    };
    let edge = dds.get_width();
    let size = face_bytes(format, edge);
    // Each face has its levels behind it.
    let faces = split(path, "DDS", |face| dds.get_data(face as u32).ok().and_then(|data| data.get(..size)))?;
    Ok(Content { faces, edge, format, name: format!("DDS, {name}"), transfer })
}

/// The six faces, or the error for a file that ends before them.
fn split<'a>(path: &Path, kind: &str, face: impl Fn(usize) -> Option<&'a [u8]>) -> Result<[&'a [u8]; 6], PictureError> {
    let mut faces = [&[][..]; 6];
    for (index, slot) in faces.iter_mut().enumerate() {
        *slot = face(index).ok_or_else(|| PictureError::damaged(path, kind, format!("it ends within face {index}")))?;
    }
    Ok(faces)
}

/// Bytes of a face.
fn face_bytes(format: TexelFormat, edge: u32) -> usize {
    let (edge, blocks) = (edge as usize, edge.div_ceil(4) as usize);
    match format {
        TexelFormat::Codes(bytes, _) => bytes * edge * edge,
        TexelFormat::Half(channels) => 2 * channels * edge * edge,
        TexelFormat::Float(channels) => 4 * channels * edge * edge,
        TexelFormat::SharedExponent | TexelFormat::Packed11 => 4 * edge * edge,
        TexelFormat::Bc6h(_) | TexelFormat::Bc7 => 16 * blocks * blocks,
    }
}

/// Decodes the faces of a file.
fn decode(path: &Path, content: Content<'_>, wishes: &Wishes) -> Result<CubeFile, PictureError> {
    let Content { faces, edge, format, name, transfer } = content;
    let mut statement = Statement { kind: name.clone(), size: [edge, edge], ..Statement::default() };
    let is_codes = matches!(format, TexelFormat::Codes(..) | TexelFormat::Bc7);
    // Codes whose file says nothing are colours as everywhere else.
    let default = if is_codes { Transfer::Srgb } else { Transfer::Linear };
    let words = ColourWords { transfer: transfer.map(|transfer| (name, transfer)), ..ColourWords::new(default) };
    let colours = words.decide(Purpose::Environment, wishes, &mut statement);
    let table = decode_table(255, colours.transfer);
    let mut faces =
        faces.map(|bytes| Picture { width: edge, height: edge, pixels: pixels(bytes, edge, format, &table) });
    for (face, picture) in faces.iter().enumerate() {
        if let Some(index) = picture.pixels.iter().position(|pixel| !pixel.iter().all(|value| value.is_finite())) {
            let (x, y) = (index as u32 % edge, index as u32 / edge);
            let place = format!("face {face}, pixel ({x}, {y})");
            return Err(PictureError::unsupported(
                path,
                format!("has a value that is not finite at {place}"),
                "finite values",
            ));
        }
    }
    faces.iter_mut().for_each(|face| colours.convert(&mut face.pixels));
    Ok(CubeFile { faces, statement })
}

/// Pixels of one face. `table` decodes 8-bit codes.
fn pixels(bytes: &[u8], edge: u32, format: TexelFormat, table: &[f32]) -> Vec<[f32; 3]> {
    let half = |texel: &[u8], at: usize| f16::from_le_bytes([texel[2 * at], texel[2 * at + 1]]).to_f32();
    let float = |texel: &[u8], at: usize| {
        f32::from_le_bytes([texel[4 * at], texel[4 * at + 1], texel[4 * at + 2], texel[4 * at + 3]])
    };
    let word = |texel: &[u8]| u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]);
    match format {
        TexelFormat::Codes(size, places) => {
            bytes.chunks_exact(size).map(|texel| places.map(|place| table[usize::from(texel[place])])).collect()
        }
        TexelFormat::Half(channels) => {
            bytes.chunks_exact(2 * channels).map(|texel| [0, 1, 2].map(|at| half(texel, at))).collect()
        }
        TexelFormat::Float(channels) => {
            bytes.chunks_exact(4 * channels).map(|texel| [0, 1, 2].map(|at| float(texel, at))).collect()
        }
        TexelFormat::SharedExponent => bytes.chunks_exact(4).map(|texel| shared_exponent(word(texel))).collect(),
        TexelFormat::Packed11 => bytes.chunks_exact(4).map(|texel| packed_11(word(texel))).collect(),
        TexelFormat::Bc6h(signed) => blocks(bytes, edge, |block| {
            let mut texels = [0.0; 48];
            bcdec_rs::bc6h_float(block, &mut texels, 12, signed);
            std::array::from_fn(|at| [texels[3 * at], texels[3 * at + 1], texels[3 * at + 2]])
        }),
        TexelFormat::Bc7 => blocks(bytes, edge, |block| {
            let mut codes = [0; 64];
            bcdec_rs::bc7(block, &mut codes, 16);
            std::array::from_fn(|at| [0, 1, 2].map(|channel| table[usize::from(codes[4 * at + channel])]))
        }),
    }
}

/// Pixels of blocks of 4×4 texels, 16 bytes each. Texels beyond the edge are left out.
fn blocks(bytes: &[u8], edge: u32, decode: impl Fn(&[u8]) -> [[f32; 3]; 16]) -> Vec<[f32; 3]> {
    let (edge, in_row) = (edge as usize, edge.div_ceil(4) as usize);
    let mut pixels = vec![[0.0; 3]; edge * edge];
    for (index, block) in bytes.chunks_exact(16).enumerate() {
        let (left, top) = (4 * (index % in_row), 4 * (index / in_row));
        for (at, texel) in decode(block).into_iter().enumerate() {
            let (x, y) = (left + at % 4, top + at / 4);
            if x < edge && y < edge {
                pixels[y * edge + x] = texel;
            }
        }
    }
    pixels
}

/// Value m · 2^(e − 24) of three 9-bit mantissas (Vulkan 1.3 §15.1.7).
fn shared_exponent(word: u32) -> [f32; 3] {
    let scale = f32::from_bits((((word >> 27) + 127 - 24) << 23).max(1 << 23));
    [0, 9, 18].map(|shift| (word >> shift & 0x1ff) as f32 * scale)
}

/// Values of unsigned floats with 5-bit exponents and 6, 6 and 5 fraction bits (Vulkan 1.3 §15.1.5). They are half floats without a sign
/// and with fewer fraction bits.
fn packed_11(word: u32) -> [f32; 3] {
    let half = |bits: u32| f16::from_bits(bits as u16).to_f32();
    [half((word & 0x7ff) << 4), half((word >> 11 & 0x7ff) << 4), half((word >> 22) << 5)]
}

#[cfg(test)]
mod tests;
