//! Light of pixels, and the cost of making it.

use roughxel_core::datapath::pixel::{self, PixelSum};
use roughxel_core::fx::Fx;

use crate::batch::Batch;
use crate::fragments::Place;
use crate::material::Channel;
use crate::phases::PhaseClock;
use crate::signals::ShadedColour;

/// Light of a tile's pixels, summed over objects, lights and samples, and the number of samples read for it.
pub struct Sums {
    /// The light of each pixel.
    pub pixels: Vec<[PixelSum<i32>; 3]>,
    /// Number of bilinear samples, of four texels each.
    pub samples: u64,
    /// Clock of the phases.
    pub clock: PhaseClock,
}

impl Sums {
    /// Sums without light for `pixels` pixels.
    pub fn new(pixels: usize) -> Self {
        Self { pixels: vec![[PixelSum { sum: Fx::zero() }; 3]; pixels], samples: 0, clock: PhaseClock::start() }
    }

    /// Adds a colour to a pixel, as many times as it counts there.
    pub fn add(&mut self, place: Place, colour: [Channel; 3]) {
        let sums = &mut self.pixels[place.pixel as usize];
        *sums = with_colour(*sums, place.times, colour);
    }

    /// Adds the colours of a batch. Samples of a pixel mostly follow each other, and their sum does not go through memory.
    pub(crate) fn add_all(&mut self, places: &[Place], colours: &Batch<ShadedColour<i32>>) {
        let mut colours = colours.colours();
        for of_pixel in places.chunk_by(|a, b| a.pixel == b.pixel) {
            let sums = &mut self.pixels[of_pixel[0].pixel as usize];
            *sums = of_pixel
                .iter()
                .zip(&mut colours)
                .fold(*sums, |sums, (place, colour)| with_colour(sums, place.times, colour));
        }
    }
}

/// Sums with a colour that counts `times` times.
#[inline(always)]
fn with_colour(mut sums: [PixelSum<i32>; 3], times: u32, colour: [Channel; 3]) -> [PixelSum<i32>; 3] {
    for _ in 0..times {
        for (sum, channel) in sums.iter_mut().zip(colour) {
            *sum = pixel::sum(sum, channel);
        }
    }
    sums
}
