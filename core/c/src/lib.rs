//! The scalar datapaths behind a C ABI: what C, C++ and, by DPI-C, a simulator compute expected values with.
//!
//! A structure of C is one number of 32 bits a field of a vector word, in the order of the declared bundle, so it is an array here;
//! `roughxel vectors c` writes the header with its names, and a SystemVerilog package. A field holds what the profile keeps, as in a
//! vector word: `vectors/FORMAT.md`. Nothing here allocates, panics or keeps state; every function can be called from any thread.
//!
//! Every function returns [`OK`] or an error: its kind in the lowest 8 bits, one of `ERROR_…`, and above them the place of the
//! number that is wrong, where there is one. With an error nothing is written. Pointers of arrays may be null, which is an error, and
//! otherwise have to hold as many numbers as the type says; what is written may not overlap what is read.

#![no_std]

mod numbers;

use core::ffi::{CStr, c_char};
use core::mem::MaybeUninit;

use roughxel_core::bundle::Bundle;
use roughxel_core::knob::Knob;
use roughxel_core::plan::{Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::ports::{HighlightInput, HighlightOutput, PeakInput, PeakOutput, ReflectionInput, ReflectionOutput};
use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use roughxel_core::soft_core;

use numbers::{Numbers, numbers_of, range, wires_of};

/// Version of the interface: it changes where a program would have to be compiled anew.
pub const VERSION: i32 = 1;

/// It is done.
pub const OK: i32 = 0;
/// A pointer is null.
pub const ERROR_NULL: i32 = 1;
/// No profile has that name.
pub const ERROR_PROFILE: i32 = 2;
/// A knob is out of its range; its place is in the upper bits.
pub const ERROR_KNOB: i32 = 3;
/// A bit of the effects is unknown, or two kinds of one effect are on.
pub const ERROR_EFFECTS: i32 = 4;
/// An input is out of the range of its field; its place is in the upper bits.
pub const ERROR_INPUT: i32 = 5;

/// The errors: name and text of each, in the order of their numbers.
pub const ERRORS: [(&str, &CStr); 6] = [
    ("OK", c"done"),
    ("ERROR_NULL", c"a pointer is null"),
    ("ERROR_PROFILE", c"no profile has that name: there are narrow, paper, compact, standard, precise"),
    ("ERROR_KNOB", c"a knob is out of its range"),
    ("ERROR_EFFECTS", c"an effect is unknown, or two kinds of one effect are on"),
    ("ERROR_INPUT", c"an input is out of the range of its field"),
];

/// Bits of an error below the place of what is wrong.
pub const ERROR_BITS: u32 = 8;

/// The effects: name, bit and what each does. Of the two kinds of one effect one may be on; of the frame none is the main direction.
pub const EFFECTS: [(&str, u32, &str); 10] = [
    ("BUMP", 1, "bump: reflection and highlight"),
    ("ROUGHNESS", 1 << 1, "anisotropic roughness: reflection and highlight"),
    ("ROUGHNESS_ISO", 1 << 2, "isotropic roughness, which reads roughness_1 alone"),
    ("CURVATURE", 1 << 3, "curvature: reflection"),
    ("FOOTPRINT", 1 << 4, "footprint on a face: reflection"),
    ("FOOTPRINT_SPHERE", 1 << 5, "footprint on the sphere, for wide lobes"),
    ("HORIZON", 1 << 6, "correlated horizons: peak"),
    ("HORIZON_PRODUCT", 1 << 7, "horizons as a product of shares"),
    ("FRAME_NATURAL", 1 << 8, "frame of p_u and p_v instead of the main direction"),
    ("FRAME_NATURAL_NORMALISED", 1 << 9, "the same, lengths dropped"),
];

/// Knobs of a profile, in the order of [`Knob::ALL`].
pub type Knobs = [i32; Knob::ALL.len()];

/// The knobs as C has them.
pub fn knobs_of(p: &Precision) -> Knobs {
    Knob::ALL.map(|knob| knob.of(p) as i32)
}

/// The accuracy of these knobs.
///
/// Errors: [`ERROR_KNOB`].
pub fn precision_of(knobs: &Knobs) -> Result<Precision, i32> {
    let mut p = Precision::STANDARD;
    for (place, (knob, &value)) in Knob::ALL.into_iter().zip(knobs).enumerate() {
        p = knob.with(value as u32, p);
        // A choice is the last one where the value is beyond it.
        if knob.of(&p) != value as u32 {
            return Err(at(ERROR_KNOB, place));
        }
    }
    p.checked().map_err(|knob| at(ERROR_KNOB, knob as usize))
}

/// The effects as C has them.
pub fn bits_of(effects: &Effects) -> u32 {
    let roughness = [0, 1 << 2, 1 << 1][effects.roughness as usize];
    let footprint = [0, 1 << 4, 1 << 5][effects.footprint as usize];
    let horizon = [0, 1 << 6, 1 << 7][effects.horizon as usize];
    let frame = [0, 1 << 8, 1 << 9][effects.frame as usize];
    u32::from(effects.bump) | roughness | u32::from(effects.curvature) << 3 | footprint | horizon | frame
}

/// The effects of these bits.
///
/// Errors: [`ERROR_EFFECTS`].
pub fn effects_of(bits: u32) -> Result<Effects, i32> {
    // Of a pair of bits neither, the lower one or the upper one.
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

/// An error with the place of what is wrong.
const fn at(error: i32, place: usize) -> i32 {
    error | (place as i32) << ERROR_BITS
}

/// A result as C sees it.
fn code(result: Result<(), i32>) -> i32 {
    result.err().unwrap_or(OK)
}

/// Places a result of several numbers, or an error.
fn put<T>(result: Result<T, i32>, into: Option<&mut MaybeUninit<T>>) -> i32 {
    code(into.ok_or(ERROR_NULL).and_then(|into| {
        into.write(result?);
        Ok(())
    }))
}

/// A datapath from numbers to numbers.
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

/// What the inputs of a datapath may be.
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

/// [`VERSION`] of the library.
// SAFETY (of all these names): nothing else is called so.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn roughxel_version() -> i32 {
    VERSION
}

/// The text of an error, one line without its end; of an unknown one an empty text. It is never freed.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn roughxel_error_text(error: i32) -> *const c_char {
    let kind = error & ((1 << ERROR_BITS) - 1);
    ERRORS.get(kind as usize).map_or(c"", |(_, text)| text).as_ptr()
}

/// The knobs of a named profile.
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
    // SAFETY: it is not null, and the caller promises the rest.
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

            /// The lowest and the highest number of each of its inputs under a profile.
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
        |inputs, effects, p| soft_core::fragment(inputs, &effects.reflection(), p);
    /// The highlight datapath with the outcomes of all its stages.
    roughxel_highlight, roughxel_highlight_input_range: HighlightInput -> HighlightOutput,
        |inputs, effects, p| soft_core::highlight(inputs, &effects.highlight(), p);
    /// The peak datapath with the outcomes of all its stages.
    roughxel_peak, roughxel_peak_input_range: PeakInput -> PeakOutput,
        |inputs, effects, p| soft_core::lit_peak(inputs, &effects.peak(), p);
}

/// A library without the standard one has to say what a panic does. None is called: no function of the library has a path to one.
#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
