//! The scalar datapaths with a C ABI: C, C++ and, by DPI-C, a simulator compute expected values with them.
//!
//! A C structure is an array here: one 32-bit number for each field of a vector word, in the order of the declared bundle. `roughxel vectors c`
//! writes the header with the names of the fields, and a SystemVerilog package. A field holds the bits that the profile keeps, as in a vector word:
//! `vectors/FORMAT.md`. Nothing here allocates, panics or keeps state. Every function can be called from any thread.
//!
//! Every function returns [`OK`] or an error. The lowest 8 bits of an error are its kind, one of `ERROR_…`; the bits above them are the place of the
//! wrong number, if there is one. A function that returns an error writes nothing. A null pointer to an array is an error. Any other pointer has to
//! hold as many numbers as its type says. Outputs may not overlap inputs.

#![no_std]

mod numbers;

use core::ffi::{CStr, c_char};
use core::mem::MaybeUninit;

use roughxel_core::bundle::Bundle;
use roughxel_core::knob::Knob;
use roughxel_core::plan::{Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::ports::{HighlightInput, HighlightOutput, PeakInput, PeakOutput, ReflectionInput, ReflectionOutput};
use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use roughxel_core::scalar_api;

use numbers::{Numbers, numbers_of, range, wires_of};

/// Version of the interface. It changes if programs have to be compiled again.
pub const VERSION: i32 = 1;

/// Success.
pub const OK: i32 = 0;
/// A pointer is null.
pub const ERROR_NULL: i32 = 1;
/// No profile has this name.
pub const ERROR_PROFILE: i32 = 2;
/// A knob is out of its range; the upper bits hold its place.
pub const ERROR_KNOB: i32 = 3;
/// A bit of the effects is unknown, or two kinds of one effect are on.
pub const ERROR_EFFECTS: i32 = 4;
/// An input is out of the range of its field; the upper bits hold its place.
pub const ERROR_INPUT: i32 = 5;

/// Errors by number: name and text of each.
pub const ERRORS: [(&str, &CStr); 6] = [
    ("OK", c"done"),
    ("ERROR_NULL", c"a pointer is null"),
    ("ERROR_PROFILE", c"no profile has that name: there are narrow, paper, compact, standard, precise"),
    ("ERROR_KNOB", c"a knob is out of its range"),
    ("ERROR_EFFECTS", c"an effect is unknown, or two kinds of one effect are on"),
    ("ERROR_INPUT", c"an input is out of the range of its field"),
];

/// Bits of an error below the place of the wrong number.
pub const ERROR_BITS: u32 = 8;

/// Effect of the C interface.
#[derive(Clone, Copy, Debug)]
pub struct EffectBit {
    /// Name, without the prefix of the header.
    pub name: &'static str,
    /// Its bit of a word of effects.
    pub bit: u32,
    /// Description, with the datapaths that have the effect.
    pub description: &'static str,
}

/// Effects in the order of their bits. At most one of the two kinds of an effect may be on. With neither bit of the tangent basis, it has the
/// main direction.
pub const EFFECTS: [EffectBit; 10] = [
    EffectBit { name: "BUMP", bit: 1, description: "bump: reflection and highlight" },
    EffectBit { name: "ROUGHNESS", bit: 1 << 1, description: "anisotropic roughness: reflection and highlight" },
    EffectBit { name: "ROUGHNESS_ISO", bit: 1 << 2, description: "isotropic roughness, which reads roughness_1 alone" },
    EffectBit { name: "CURVATURE", bit: 1 << 3, description: "curvature: reflection" },
    EffectBit { name: "FOOTPRINT", bit: 1 << 4, description: "footprint on a face: reflection" },
    EffectBit { name: "FOOTPRINT_SPHERE", bit: 1 << 5, description: "footprint on the sphere, for wide lobes" },
    EffectBit { name: "HORIZON", bit: 1 << 6, description: "correlated horizons: peak" },
    EffectBit { name: "HORIZON_PRODUCT", bit: 1 << 7, description: "horizons as a product of shares" },
    EffectBit { name: "FRAME_NATURAL", bit: 1 << 8, description: "frame of p_u and p_v instead of the main direction" },
    EffectBit { name: "FRAME_NATURAL_NORMALISED", bit: 1 << 9, description: "the same, lengths dropped" },
];

/// Knobs of a profile, in the order of [`Knob::ALL`].
pub type Knobs = [i32; Knob::ALL.len()];

/// Knobs of a precision as C has them.
pub fn knobs_of(p: &Precision) -> Knobs {
    Knob::ALL.map(|knob| knob.value_in(p) as i32)
}

/// Precision with these knobs.
///
/// Errors: [`ERROR_KNOB`].
pub fn precision_of(knobs: &Knobs) -> Result<Precision, i32> {
    let mut p = Precision::STANDARD;
    for (place, (knob, &value)) in Knob::ALL.into_iter().zip(knobs).enumerate() {
        p = knob.with(value as u32, p);
        // A value beyond the last choice would read as that choice.
        if knob.value_in(&p) != value as u32 {
            return Err(at(ERROR_KNOB, place));
        }
    }
    p.checked().map_err(|knob| at(ERROR_KNOB, knob as usize))
}

/// Bits of the effects as C has them.
pub fn bits_of(effects: &Effects) -> u32 {
    let roughness = [0, 1 << 2, 1 << 1][effects.roughness as usize];
    let footprint = [0, 1 << 4, 1 << 5][effects.footprint as usize];
    let horizon = [0, 1 << 6, 1 << 7][effects.horizon as usize];
    let frame = [0, 1 << 8, 1 << 9][effects.frame as usize];
    u32::from(effects.bump) | roughness | u32::from(effects.curvature) << 3 | footprint | horizon | frame
}

/// Effects of these bits.
///
/// Errors: [`ERROR_EFFECTS`].
pub fn effects_of(bits: u32) -> Result<Effects, i32> {
    // Neither, the lower one or the upper one of a pair of bits.
    fn kind<T>(bits: u32, lower: u32, [neither, low, high]: [T; 3]) -> Result<T, i32> {
        match bits >> lower & 3 {
            0 => Ok(neither),
            1 => Ok(low),
            2 => Ok(high),
            _ => Err(ERROR_EFFECTS),
        }
    }
    if bits >> EFFECTS.len() != 0 {
        return Err(ERROR_EFFECTS);
    }
    let roughness = [RoughnessKind::None, RoughnessKind::Anisotropic, RoughnessKind::Isotropic];
    let frame = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
    Ok(Effects {
        bump: bits & 1 != 0,
        roughness: kind(bits, 1, roughness)?,
        curvature: bits & 1 << 3 != 0,
        footprint: kind(bits, 4, [FootprintKind::None, FootprintKind::Face, FootprintKind::Sphere])?,
        horizon: kind(bits, 6, [HorizonKind::None, HorizonKind::Correlated, HorizonKind::Product])?,
        frame: kind(bits, 8, frame)?,
    })
}

/// Error with the place of the wrong number.
const fn at(error: i32, place: usize) -> i32 {
    error | (place as i32) << ERROR_BITS
}

/// Result as C sees it.
fn code(result: Result<(), i32>) -> i32 {
    result.err().unwrap_or(OK)
}

/// Places the numbers of a result, or returns its error.
fn put<T>(result: Result<T, i32>, into: Option<&mut MaybeUninit<T>>) -> i32 {
    code(into.ok_or(ERROR_NULL).and_then(|into| {
        into.write(result?);
        Ok(())
    }))
}

/// Runs a datapath from numbers to numbers.
fn run<I: Bundle<i32, In<i32> = I>, O: Bundle<i32>, const INPUTS: usize, const OUTPUTS: usize>(
    profile: Option<&Knobs>,
    effects: u32,
    inputs: Option<&Numbers<INPUTS>>,
    outputs: Option<&mut MaybeUninit<Numbers<OUTPUTS>>>,
    datapath: impl FnOnce(&I, &Effects, &Precision) -> O,
) -> i32 {
    let result = || {
        let p = precision_of(profile.ok_or(ERROR_NULL)?)?;
        let effects = effects_of(effects)?;
        let inputs = wires_of::<I, INPUTS>(inputs.ok_or(ERROR_NULL)?, &p).map_err(|place| at(ERROR_INPUT, place))?;
        Ok(numbers_of(&datapath(&inputs, &effects, &p), &p))
    };
    put(result(), outputs)
}

/// Range of the inputs of a datapath.
fn input_range<I: Bundle<i32>, const INPUTS: usize>(
    profile: Option<&Knobs>,
    low: Option<&mut MaybeUninit<Numbers<INPUTS>>>,
    high: Option<&mut MaybeUninit<Numbers<INPUTS>>>,
) -> i32 {
    let (Some(profile), Some(low), Some(high)) = (profile, low, high) else { return ERROR_NULL };
    code(precision_of(profile).map(|p| {
        let (lowest, highest) = range::<I, INPUTS>(&p);
        low.write(lowest);
        high.write(highest);
    }))
}

/// Returns the [`VERSION`] of the library.
// SAFETY (of all these names): nothing else has them.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn roughxel_version() -> i32 {
    VERSION
}

/// Text of an error, one line without a line end; empty for an unknown error. The text is never freed.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn roughxel_error_text(error: i32) -> *const c_char {
    let kind = error & ((1 << ERROR_BITS) - 1);
    ERRORS.get(kind as usize).map_or(c"", |(_, text)| text).as_ptr()
}

/// Knobs of a named profile.
///
/// Errors: [`ERROR_NULL`], [`ERROR_PROFILE`].
///
/// # Safety
/// `name` is null or a text that ends in a zero.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn roughxel_profile_named(name: *const c_char, profile: Option<&mut MaybeUninit<Knobs>>) -> i32 {
    if name.is_null() {
        return ERROR_NULL;
    }
    // SAFETY: the pointer is not null, and the caller promises the rest.
    let name = unsafe { CStr::from_ptr(name) };
    let is_it = |known: &Profile| known.name().as_bytes() == name.to_bytes();
    let found = Profile::ALL.into_iter().find(is_it).ok_or(ERROR_PROFILE);
    put(found.map(|found| knobs_of(&found.precision())), profile)
}

macro_rules! datapaths {
    ($(
        $(#[doc = $doc:literal])*
        $name:ident, $range:ident: $input:ident -> $output:ident, |$of:ident, $effects:ident, $p:ident| $call:expr;
    )*) => {
        $(
            $(#[doc = $doc])*
            ///
            /// Errors: [`ERROR_NULL`], [`ERROR_KNOB`], [`ERROR_EFFECTS`], [`ERROR_INPUT`]. Effects that the datapath does not have change nothing.
            #[allow(unsafe_code)]
            #[unsafe(no_mangle)]
            pub extern "C" fn $name(
                profile: Option<&Knobs>,
                effects: u32,
                inputs: Option<&Numbers<{ <$input<i32> as Bundle<i32>>::WORDS }>>,
                outputs: Option<&mut MaybeUninit<Numbers<{ <$output<i32> as Bundle<i32>>::WORDS }>>>,
            ) -> i32 {
                run::<$input<i32>, $output<i32>, _, _>(profile, effects, inputs, outputs, |$of, $effects, $p| $call)
            }

            /// Lowest and highest number of each input under a profile.
            ///
            /// Errors: [`ERROR_NULL`], [`ERROR_KNOB`].
            #[allow(unsafe_code)]
            #[unsafe(no_mangle)]
            pub extern "C" fn $range(
                profile: Option<&Knobs>,
                low: Option<&mut MaybeUninit<Numbers<{ <$input<i32> as Bundle<i32>>::WORDS }>>>,
                high: Option<&mut MaybeUninit<Numbers<{ <$input<i32> as Bundle<i32>>::WORDS }>>>,
            ) -> i32 {
                input_range::<$input<i32>, _>(profile, low, high)
            }
        )*
    };
}

datapaths! {
    /// The reflection datapath with the outcomes of all its stages.
    roughxel_reflection, roughxel_reflection_input_range: ReflectionInput -> ReflectionOutput,
        |inputs, effects, p| scalar_api::fragment(inputs, &effects.reflection(), p);
    /// The highlight datapath with the outcomes of all its stages.
    roughxel_highlight, roughxel_highlight_input_range: HighlightInput -> HighlightOutput,
        |inputs, effects, p| scalar_api::highlight(inputs, &effects.highlight(), p);
    /// The peak datapath with the outcomes of all its stages.
    roughxel_peak, roughxel_peak_input_range: PeakInput -> PeakOutput,
        |inputs, effects, p| scalar_api::lit_peak(inputs, &effects.peak(), p);
}

/// Defines a panic, as a library without the standard library has to. No function of the library has a path to it.
#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
