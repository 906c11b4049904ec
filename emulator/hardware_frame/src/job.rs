//! A frame for the device: words of fragments, tiles of texels, levels and constants.

use std::fmt::Write as _;

use roughxel_core::design::ScaledReflectionInput;
use roughxel_core::sampler::{CubeMemory, level_edge};
use roughxel_core::scalar_api::environment_scale;
use roughxel_frame::raster::RasterError;
use roughxel_frame::{FragmentReflection, FrameFragment, Prepared};
use roughxel_netlist::integers::integers_at;
use roughxel_netlist::verilog::PortDescription;
use roughxel_shader::{CubeTexels, Effect};
use thiserror::Error;

use crate::device::Device;

/// Most pixels of a frame for the device.
pub const MAX_PIXELS: u64 = 1 << 20;
/// Edge of the tiles of texels that a burst of the memory reads.
const TILE_EDGE: u32 = 4;
/// Edge of the tiles of pixels that a rasteriser draws one after the other.
const PIXEL_TILE: u32 = 8;

/// Reason why a frame is no job for the device.
#[derive(Debug, Error)]
pub enum JobError {
    /// More pixels than [`MAX_PIXELS`].
    #[error("a simulated frame has at most 2^20 pixels, and this one has {0}; use --size")]
    TooLarge(u64),
    /// An object with an effect that the device does not have.
    #[error("object {object} has {effect}, which the device does not draw")]
    Effect {
        /// Number of the object, from 1.
        object: usize,
        /// Name of the effect.
        effect: &'static str,
    },
    /// An environment brighter than 64 × white.
    #[error("the environment is brighter than 64 × white, and the device filters linear codes alone")]
    Bright,
    /// A scene without environment.
    #[error("the scene shows no environment")]
    NoEnvironment,
    /// Pixels with a number of samples that the device does not take the mean of.
    #[error("a pixel has {0} samples; the device takes the mean of 1 or 8, as the mode footprint does")]
    Samples(u32),
    /// A number that no port of the device holds.
    #[error("{value} does not fit the port {port}")]
    DoesNotFit {
        /// Name of the port.
        port: String,
        /// The integer.
        value: i64,
    },
    /// A scene that cannot be set up.
    #[error(transparent)]
    Raster(#[from] RasterError),
}

/// A frame for the device.
pub struct Job {
    /// Width and height of the frame.
    pub size: [u32; 2],
    /// Number of fragments.
    pub fragments: usize,
    /// Number of fragments that reflect.
    pub reflecting: usize,
    /// Words of the fragments, 32 bits each.
    pub(crate) words: Vec<u32>,
    /// Words of one fragment.
    pub(crate) words_each: usize,
    pub(crate) constants: Vec<u32>,
    /// Texels of all levels, tile by tile, red in the lowest 16 bits.
    pub(crate) texels: Vec<u64>,
    /// Edge and first tile of each level.
    pub(crate) levels: Vec<[u32; 2]>,
}

/// Bits of one number after the other, the first one lowest.
#[derive(Default)]
struct Bits {
    words: Vec<u32>,
    used: u32,
}

impl Bits {
    fn push(&mut self, value: u64, width: u32) {
        for bit in 0..width {
            if self.used.is_multiple_of(32) {
                self.words.push(0);
            }
            let last = self.words.len() - 1;
            self.words[last] |= ((value >> bit & 1) as u32) << (self.used % 32);
            self.used += 1;
        }
    }

    /// Adds the integers of ports, the first port highest.
    fn push_ports(&mut self, ports: &[PortDescription], values: &[i64]) -> Result<(), JobError> {
        for port in ports.iter().rev() {
            let value = values[port.place];
            let bits = port.format.pack(value);
            let bits = bits.ok_or_else(|| JobError::DoesNotFit { port: port.name.clone(), value })?;
            self.push(bits, port.width);
        }
        Ok(())
    }
}

/// Effects that change a frame and are not in the device.
const MISSING: [Effect; 4] = [Effect::TwoLobes, Effect::Highlight, Effect::Peaks, Effect::Horizon];

impl Job {
    /// Frame of a prepared scene for a device that was made for its reflections. `progress` is called for each of [`Prepared::work`] pieces.
    ///
    /// Errors: everything [`JobError`] lists.
    pub fn new(
        prepared: &Prepared<'_>,
        size: [u32; 2],
        device: &Device,
        progress: &dyn Fn(),
    ) -> Result<Self, JobError> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if pixels > MAX_PIXELS {
            return Err(JobError::TooLarge(pixels));
        }
        for (object, plan) in (1..).zip(prepared.plans()) {
            if let Some(effect) = MISSING.into_iter().find(|&effect| plan.has(effect)) {
                return Err(JobError::Effect { object, effect: effect.name() });
            }
        }
        let environment = prepared.environment_texels().ok_or(JobError::NoEnvironment)?;
        if environment.is_bright() {
            return Err(JobError::Bright);
        }
        let mut fragments = prepared.fragments(progress)?;
        let place = |fragment: &FrameFragment| {
            let [x, y] = fragment.pixel;
            (y / PIXEL_TILE, x / PIXEL_TILE, y, x)
        };
        fragments.sort_by_key(place);

        let map = environment_scale(environment.edge() as u16, &device.precision);
        let port_count = device.ports.iter().chain(&device.constants).map(|port| port.place + 1).max().unwrap_or(0);
        let values = |reflection: Option<&FragmentReflection>| match reflection {
            Some(of) => integers_at(&ScaledReflectionInput { fragment: of.ports, map }, &device.precision),
            None => vec![0; port_count],
        };
        let mut constants = Bits::default();
        constants.push(u64::from(environment.levels() - 1), 4);
        constants.push(environment.exponent() as u64, 3);
        let any = fragments.iter().find_map(|fragment| fragment.reflection.as_ref());
        constants.push_ports(&device.constants, &values(any))?;

        let (mut words, mut words_each, mut reflecting) = (Vec::new(), 0, 0);
        for (index, fragment) in fragments.iter().enumerate() {
            let is_last = fragments.get(index + 1).is_none_or(|next| next.pixel != fragment.pixel);
            let reflection = fragment.reflection.as_ref();
            reflecting += usize::from(reflection.is_some());
            if ![1, 8].contains(&fragment.samples) {
                return Err(JobError::Samples(fragment.samples));
            }
            let mut bits = Bits::default();
            bits.push(u64::from(fragment.pixel[1] * size[0] + fragment.pixel[0]), 26);
            bits.push(fragment.times.into(), 4);
            bits.push(is_last.into(), 1);
            bits.push((fragment.samples == 8).into(), 1);
            bits.push(reflection.is_none().into(), 1);
            bits.push(reflection.is_some_and(|of| of.is_rough).into(), 1);
            for channel in 0..3 {
                bits.push(reflection.map_or(0, |of| of.reflectance[channel].raw() as u64), 17);
            }
            for channel in fragment.colour {
                bits.push(channel.raw() as u64, 30);
            }
            bits.push_ports(&device.ports, &values(reflection))?;
            words_each = bits.words.len();
            words.append(&mut bits.words);
        }
        let (texels, levels) = tiled(environment);
        let constants = constants.words;
        Ok(Self { size, fragments: fragments.len(), reflecting, words, words_each, constants, texels, levels })
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Bytes of the texels.
    pub fn texel_bytes(&self) -> usize {
        8 * self.texels.len()
    }

    /// Files that the model reads, name and content.
    pub(crate) fn files(&self) -> [(&'static str, Vec<u8>); 3] {
        let mut text = format!("{} {} {}\n{}", self.pixels(), self.fragments, self.words_each, self.constants.len());
        for word in &self.constants {
            let _ = write!(text, " {word}");
        }
        let _ = writeln!(text, "\n{}", self.levels.len());
        for [edge, start] in &self.levels {
            let _ = writeln!(text, "{edge} {start}");
        }
        let words = self.words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let texels = self.texels.iter().flat_map(|texel| texel.to_le_bytes()).collect();
        [("frame.txt", text.into_bytes()), ("fragments.bin", words), ("texels.bin", texels)]
    }
}

/// Texels in tiles by level, face, row and column, and the edge and first tile of each level. Texels beyond a face are black.
fn tiled(environment: &CubeTexels) -> (Vec<u64>, Vec<[u32; 2]>) {
    let (mut texels, mut levels) = (Vec::new(), Vec::new());
    for level in 0..environment.levels() {
        let edge = level_edge(environment.edge(), level);
        levels.push([edge, (texels.len() as u32) / (TILE_EDGE * TILE_EDGE)]);
        let across = edge.div_ceil(TILE_EDGE);
        for tile in 0..6 * across * across {
            let (face, row, column) = (tile / (across * across), tile / across % across, tile % across);
            for place in 0..TILE_EDGE * TILE_EDGE {
                let [column, row] = [TILE_EDGE * column + place % TILE_EDGE, TILE_EDGE * row + place / TILE_EDGE];
                let inside = column < edge && row < edge;
                let [red, green, blue] =
                    if inside { environment.texel(level, face, column, row).map(u64::from) } else { [0; 3] };
                texels.push(red | green << 16 | blue << 32);
            }
        }
    }
    (texels, levels)
}
