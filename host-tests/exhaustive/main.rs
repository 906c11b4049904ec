//! Narrow words whose inputs can be enumerated: every input is tried against float64 and in the checked backend, which stops if an operation leaves
//! its wire.
//!
//! 8-bit words have mantissas of at most 6 fraction bits, so a stage of two or three operands has 2^24 inputs or fewer. On 16-bit words, a function
//! of one operand does. Each test prints and asserts the number of inputs it tried, and the share of its bar that the worst error takes. Bars are
//! sums of the roundings in [`bounds`]; none is fitted to measurements.

mod axes;
mod bounds;
mod cube_face;
mod elementary;
mod ellipse;
mod probes;

use std::fmt::Debug;
use std::ops::AddAssign;

use roughxel_core::block::MANTISSA;
use roughxel_core::precision::{Newton, Precision};
use roughxel_host_tests::checked::CheckedWire;

/// The checked backend on 8-bit words.
type Checked8 = CheckedWire<i8>;

/// Fraction bits of an 8-bit mantissa.
const FRACTION: u32 = i8::BITS - MANTISSA;
/// 1 as an 8-bit mantissa.
const ONE: i64 = 1 << FRACTION;

/// The knobs of a datapath on 8-bit words: seeds have as many index bits as a mantissa has fraction bits.
fn tiny(fraction_bits: u32, steps: u32) -> Precision {
    let newton = Newton { seed_bits: 6, steps };
    Precision { fraction_bits, reciprocal: newton, inverse_root: newton, lod_bits: 4, ..Precision::COMPACT }
}

/// Every p to test 8-bit words with, with and without a Newton step.
fn tiny_precisions() -> impl Iterator<Item = Precision> {
    [4, 5, 6].into_iter().flat_map(|fraction_bits| [0, 1].map(|steps| tiny(fraction_bits, steps)))
}

/// The value of an 8-bit mantissa.
fn real(m: i64) -> f64 {
    m as f64 / ONE as f64
}

/// Every mantissa in [−1, 1] that p bits keep.
fn mantissas(p: &Precision) -> impl Iterator<Item = i64> + Clone + use<> {
    let unit = 1 << (FRACTION - p.fraction_bits);
    (-ONE..=ONE).step_by(unit)
}

/// Every mantissa in [½, 1] that p bits keep.
fn normalised(p: &Precision) -> impl Iterator<Item = i64> + Clone + use<> {
    mantissas(p).filter(|&m| m >= ONE / 2)
}

/// Number of inputs tried, the largest of `N` errors, and the largest share of its bar that each error took.
#[derive(Clone, Copy)]
struct Tried<const N: usize> {
    inputs: u64,
    errors: [f64; N],
    shares: [f64; N],
}

impl<const N: usize> Tried<N> {
    fn none() -> Self {
        Self { inputs: 0, errors: [0.0; N], shares: [0.0; N] }
    }

    /// Asserts that an error stays within its bar.
    #[track_caller]
    fn hold(&mut self, figure: usize, error: f64, bar: f64, input: impl Debug) {
        assert!(error <= bar, "{figure}: {error} beyond {bar} at {input:?}");
        if error > 0.0 {
            self.errors[figure] = self.errors[figure].max(error);
            self.shares[figure] = self.shares[figure].max(error / bar);
        }
    }

    /// Prints the results, and asserts the number of inputs.
    #[track_caller]
    fn report(&self, name: &str, figures: [&str; N], inputs: u64) {
        eprintln!("{name}: {} inputs", self.inputs);
        for ((figure, share), error) in figures.iter().zip(self.shares).zip(self.errors) {
            eprintln!("{name}: {figure} errs by 2^{:.3} at worst, and takes {share:.3} of its bar", error.log2());
        }
        assert_eq!(self.inputs, inputs, "inputs of {name}");
    }
}

impl<const N: usize> AddAssign for Tried<N> {
    fn add_assign(&mut self, other: Self) {
        self.inputs += other.inputs;
        for i in 0..N {
            self.errors[i] = self.errors[i].max(other.errors[i]);
            self.shares[i] = self.shares[i].max(other.shares[i]);
        }
    }
}

/// Tries everything in parallel: `work` counts and checks the inputs of one item.
fn try_all<T: Send, const N: usize>(
    items: impl IntoIterator<Item = T>,
    work: impl Fn(&mut Tried<N>, T) + Sync,
) -> Tried<N> {
    use rayon::prelude::*;
    let items: Vec<T> = items.into_iter().collect();
    let tried = |item| {
        let mut tried = Tried::none();
        work(&mut tried, item);
        tried
    };
    items.into_par_iter().with_max_len(1).map(tried).reduce(Tried::none, |mut a, b| {
        a += b;
        a
    })
}
