//! Headers of textures, laid out by hand.

fn words(all: &[u32]) -> Vec<u8> {
    all.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Caps2 of a cube map with all faces.
pub(crate) const CUBE: u32 = 0xfe00;

/// A DDS header: 128 bytes, and 20 more for a DXGI format.
pub(crate) fn dds_header(
    [width, height]: [u32; 2],
    levels: u32,
    caps: u32,
    four_cc: &[u8; 4],
    dxgi: Option<u32>,
) -> Vec<u8> {
    let mut bytes = b"DDS ".to_vec();
    // Size; flags caps, height, width, pixel format, levels; height, width, pitch, depth, levels.
    bytes.extend(words(&[124, 0x21007, height, width, 0, 0, levels]));
    bytes.extend([0; 44]);
    bytes.extend(words(&[32, 4]));
    bytes.extend(four_cc);
    bytes.extend([0; 20]);
    // Caps: complex, texture, levels.
    bytes.extend(words(&[0x0040_1008, caps, 0, 0, 0]));
    if let Some(format) = dxgi {
        bytes.extend(words(&[format, 3, if caps == CUBE { 4 } else { 0 }, 1, 0]));
    }
    bytes
}

/// A KTX2 file with one level, without key values.
pub(crate) fn ktx2_file(
    format: u32,
    type_size: u32,
    [width, height]: [u32; 2],
    faces: u32,
    transfer: u8,
    level: &[u8],
) -> Vec<u8> {
    let mut bytes = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    // Format, size of a type, width, height, depth, layers, faces, levels, supercompression.
    bytes.extend(words(&[format, type_size, width, height, 0, 0, faces, 1, 0]));
    let dfd_length = 4 + 24 + 16;
    let dfd_start = 80 + 24;
    bytes.extend(words(&[dfd_start, dfd_length, 0, 0]));
    bytes.extend([0; 16]);
    let level_start = u64::from(dfd_start + dfd_length).next_multiple_of(16);
    for number in [level_start, level.len() as u64, level.len() as u64] {
        bytes.extend(number.to_le_bytes());
    }
    // One basic block: model RGBSDA (1), BT.709 primaries (1), the transfer function, one sample.
    bytes.extend(words(&[dfd_length, 0, 2 | 40 << 16]));
    bytes.extend([1, 1, transfer, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0]);
    bytes.extend([0; 16]);
    bytes.resize(level_start as usize, 0);
    bytes.extend(level);
    bytes
}
