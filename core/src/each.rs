//! Arrays of wires element by element, without a call.
//!
//! What runs in lanes has to be one function: it is compiled for an instruction set, which a closure that is not
//! inlined does not inherit. `core::array::map` and iterators leave that to the optimiser: lanes took twice the time.

/// `[f(a₀), f(a₁), …]`.
#[inline(always)]
pub fn each<A: Copy, B: Copy, const N: usize>(array: [A; N], mut f: impl FnMut(A) -> B) -> [B; N] {
    const { assert!(N > 0, "an array of wires has wires") }
    let mut results = [f(array[0]); N];
    // Asked at its end whether it goes on: inlined some ten thousand times before anything is optimised, a loop that asks at its beginning
    // is turned round first, which was a fifth of the time that lanes take to be built.
    if const { N > 1 } {
        let mut i = 1;
        loop {
            results[i] = f(array[i]);
            i += 1;
            if i == N {
                break;
            }
        }
    }
    results
}

/// `[0, 1, …]`.
#[inline(always)]
pub fn places<const N: usize>() -> [usize; N] {
    let mut places = [0; N];
    if const { N > 1 } {
        let mut i = 1;
        loop {
            places[i] = i;
            i += 1;
            if i == N {
                break;
            }
        }
    }
    places
}

/// `[f(0), f(1), …]` with an `f` for each of the first six places: one that is large would stay a loop otherwise, and what it picks by its place would go
/// through memory. Filtered bumps took a quarter more time in lanes.
#[inline(always)]
pub fn unrolled<B: Copy, const N: usize>(mut f: impl FnMut(usize) -> B) -> [B; N] {
    const { assert!(N > 0, "an array of wires has wires") }
    let mut results = [f(0); N];
    if let Some(result) = results.get_mut(1) {
        *result = f(1);
    }
    if let Some(result) = results.get_mut(2) {
        *result = f(2);
    }
    if let Some(result) = results.get_mut(3) {
        *result = f(3);
    }
    if let Some(result) = results.get_mut(4) {
        *result = f(4);
    }
    if let Some(result) = results.get_mut(5) {
        *result = f(5);
    }
    for (i, result) in results.iter_mut().enumerate().skip(6) {
        *result = f(i);
    }
    results
}

/// `each!(a in array => expression)`: the array of what the expression is for each element.
#[macro_export]
macro_rules! each {
    ($element:pat_param in $array:expr => $expression:expr) => {
        $crate::each::each(
            $array,
            #[inline(always)]
            |$element| $expression,
        )
    };
}
pub use crate::each;
