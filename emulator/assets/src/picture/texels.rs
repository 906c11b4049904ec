//! Texels of textures: codes, floats and blocks, as KTX2 and DDS files hold them.

use exr::prelude::f16;

/// Decoder of a block to 8-bit codes.
type DecodeBlock = fn(&[u8], &mut [u8]);

/// Format of the texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TexelFormat {
    /// Codes of 8 bits.
    Codes(Places),
    /// Half floats: numbers a texel.
    Half(usize),
    /// Floats: numbers a texel.
    Float(usize),
    /// Three mantissas of 9 bits with one exponent.
    SharedExponent,
    /// Unsigned floats of 11, 11 and 10 bits.
    Packed11,
    /// BC1: three channels in blocks of 8 bytes.
    Bc1,
    /// BC2: three channels and alpha.
    Bc2,
    /// BC3: three channels and alpha.
    Bc3,
    /// BC4: one channel in blocks of 8 bytes.
    Bc4,
    /// BC5: two channels.
    Bc5,
    /// BC6H, true if signed.
    Bc6h(bool),
    /// BC7.
    Bc7,
}

/// Places of 8-bit codes in a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Places {
    /// Bytes of a texel.
    bytes: usize,
    /// Bytes of grey, of red and green, or of red, green and blue.
    colours: &'static [usize],
    /// True if a byte is alpha.
    has_alpha: bool,
}

impl Places {
    pub(super) const GREY: Self = Self { bytes: 1, colours: &[0], has_alpha: false };
    pub(super) const GREY_ALPHA: Self = Self { bytes: 2, colours: &[0], has_alpha: true };
    pub(super) const RG: Self = Self { bytes: 2, colours: &[0, 1], has_alpha: false };
    pub(super) const RGB: Self = Self { bytes: 3, colours: &[0, 1, 2], has_alpha: false };
    pub(super) const BGR: Self = Self { bytes: 3, colours: &[2, 1, 0], has_alpha: false };
    pub(super) const RGBA: Self = Self { bytes: 4, colours: &[0, 1, 2], has_alpha: true };
    pub(super) const BGRA: Self = Self { bytes: 4, colours: &[2, 1, 0], has_alpha: true };
    pub(super) const RGBX: Self = Self { has_alpha: false, ..Self::RGBA };
    pub(super) const BGRX: Self = Self { has_alpha: false, ..Self::BGRA };
}

impl TexelFormat {
    /// Channels of a texel that become a picture: 1, 2 or 3.
    pub(super) fn channels(self) -> usize {
        match self {
            Self::Codes(places) => places.colours.len(),
            Self::Half(count) | Self::Float(count) => count.min(3),
            Self::Bc4 => 1,
            Self::Bc5 => 2,
            _ => 3,
        }
    }

    /// True if texels have alpha, which is ignored. Blocks of BC1 can be opaque or not; they count as opaque.
    pub(super) fn has_alpha(self) -> bool {
        match self {
            Self::Codes(places) => places.has_alpha,
            Self::Half(count) | Self::Float(count) => count == 4,
            Self::Bc2 | Self::Bc3 | Self::Bc7 => true,
            _ => false,
        }
    }

    /// True for texels of 8-bit codes.
    pub(super) fn is_codes(self) -> bool {
        !matches!(self, Self::Half(_) | Self::Float(_) | Self::SharedExponent | Self::Packed11 | Self::Bc6h(_))
    }

    /// Bytes of an image.
    pub(super) fn bytes(self, [width, height]: [u32; 2]) -> usize {
        let texels = width as usize * height as usize;
        let blocks = width.div_ceil(4) as usize * height.div_ceil(4) as usize;
        match self {
            Self::Codes(places) => places.bytes * texels,
            Self::Half(count) => 2 * count * texels,
            Self::Float(count) => 4 * count * texels,
            Self::SharedExponent | Self::Packed11 => 4 * texels,
            _ => self.block_bytes() * blocks,
        }
    }

    fn block_bytes(self) -> usize {
        if matches!(self, Self::Bc1 | Self::Bc4) { 8 } else { 16 }
    }

    /// Pixels of an image; `table` decodes 8-bit codes. One channel becomes three equal ones, two have 0 for the third.
    pub(super) fn pixels(self, bytes: &[u8], size: [u32; 2], table: &[f32]) -> Vec<[f32; 3]> {
        let half = |texel: &[u8], at: usize| f16::from_le_bytes([texel[2 * at], texel[2 * at + 1]]).to_f32();
        let float = |texel: &[u8], at: usize| {
            f32::from_le_bytes([texel[4 * at], texel[4 * at + 1], texel[4 * at + 2], texel[4 * at + 3]])
        };
        let word = |texel: &[u8]| u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]);
        let some = |count: usize, number: &dyn Fn(usize) -> f32| match count {
            1 => [number(0); 3],
            2 => [number(0), number(1), 0.0],
            _ => [0, 1, 2].map(number),
        };
        match self {
            Self::Codes(Places { bytes: size, colours, .. }) => bytes
                .chunks_exact(size)
                .map(|texel| some(colours.len(), &|channel| table[usize::from(texel[colours[channel]])]))
                .collect(),
            Self::Half(count) => {
                bytes.chunks_exact(2 * count).map(|texel| some(count, &|at| half(texel, at))).collect()
            }
            Self::Float(count) => {
                bytes.chunks_exact(4 * count).map(|texel| some(count, &|at| float(texel, at))).collect()
            }
            Self::SharedExponent => bytes.chunks_exact(4).map(|texel| shared_exponent(word(texel))).collect(),
            Self::Packed11 => bytes.chunks_exact(4).map(|texel| packed_11(word(texel))).collect(),
            Self::Bc6h(signed) => self.blocks(bytes, size, |block| {
                let mut texels = [0.0; 48];
                bcdec_rs::bc6h_float(block, &mut texels, 12, signed);
                std::array::from_fn(|at| [0, 1, 2].map(|channel| texels[3 * at + channel]))
            }),
            Self::Bc1 | Self::Bc2 | Self::Bc3 | Self::Bc4 | Self::Bc5 | Self::Bc7 => {
                // Red, green, blue, alpha; or as many as there are.
                let (decode, count): (DecodeBlock, usize) = match self {
                    Self::Bc1 => (|block, codes| bcdec_rs::bc1(block, codes, 16), 4),
                    Self::Bc2 => (|block, codes| bcdec_rs::bc2(block, codes, 16), 4),
                    Self::Bc3 => (|block, codes| bcdec_rs::bc3(block, codes, 16), 4),
                    Self::Bc4 => (|block, codes| bcdec_rs::bc4(block, codes, 4, false), 1),
                    Self::Bc5 => (|block, codes| bcdec_rs::bc5(block, codes, 8, false), 2),
                    _ => (|block, codes| bcdec_rs::bc7(block, codes, 16), 4),
                };
                self.blocks(bytes, size, |block| {
                    let mut codes = [0; 64];
                    decode(block, &mut codes[..16 * count]);
                    std::array::from_fn(|at| some(count, &|channel| table[usize::from(codes[count * at + channel])]))
                })
            }
        }
    }

    /// Pixels of blocks of 4×4 texels. Texels beyond the edge are left out.
    fn blocks(
        self,
        bytes: &[u8],
        [width, height]: [u32; 2],
        decode: impl Fn(&[u8]) -> [[f32; 3]; 16],
    ) -> Vec<[f32; 3]> {
        let (width, height, in_row) = (width as usize, height as usize, width.div_ceil(4) as usize);
        let mut pixels = vec![[0.0; 3]; width * height];
        for (index, block) in bytes.chunks_exact(self.block_bytes()).enumerate() {
            let (left, top) = (4 * (index % in_row), 4 * (index / in_row));
            for (at, texel) in decode(block).into_iter().enumerate() {
                let (x, y) = (left + at % 4, top + at / 4);
                if x < width && y < height {
                    pixels[y * width + x] = texel;
                }
            }
        }
        pixels
    }
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
mod tests {
    use super::*;

    #[test]
    fn packed_floats_have_the_values_of_their_formats() {
        // 1.0 is 512 · 2^(−9): mantissa 256 with exponent 16 is 256 · 2^(−8).
        assert_eq!(shared_exponent(16 << 27 | 256), [1.0, 0.0, 0.0]);
        assert_eq!(shared_exponent(31 << 27 | 511 << 18), [0.0, 0.0, 65408.0]);
        assert_eq!(shared_exponent(1), [2f32.powi(-24), 0.0, 0.0]);
        // Exponent 15, fraction 0 is 1; the largest finite values are 65024 and 64512.
        assert_eq!(packed_11(15 << 6 | (15 << 6) << 11 | (15 << 5) << 22), [1.0; 3]);
        assert_eq!(packed_11((30 << 6 | 63) | (30 << 5 | 31) << 22), [65024.0, 0.0, 64512.0]);
    }
}
