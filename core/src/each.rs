//! Arrays of wires element by element, without a call.
//!
//! What runs in lanes has to be one function: it is compiled for an instruction set, which a closure that is not
//! inlined does not inherit. `core::array::map` and iterators leave that to the optimiser: lanes took twice the time.

use core::mem::ManuallyDrop;

/// `[f(a₀), f(a₁), …]`, the first four written out: a loop of a few turns is work for five passes of the optimiser. The closure is not
/// dropped, which it would be where a call unwinds: that splits the function at every operation.
#[inline(always)]
pub fn each<A: Copy, B: Copy, const N: usize>(array: [A; N], f: impl FnMut(A) -> B) -> [B; N] {
    const { assert!(N > 0, "an array of wires has wires") }
    let mut f = ManuallyDrop::new(f);
    let mut results = [f(array[0]); N];
    if const { N > 1 } {
        results[1] = f(array[1]);
    }
    if const { N > 2 } {
        results[2] = f(array[2]);
    }
    if const { N > 3 } {
        results[3] = f(array[3]);
    }
    if const { N > 4 } {
        let mut i = 4;
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
pub const fn places<const N: usize>() -> [usize; N] {
    const { numbers() }
}

/// The first natural numbers.
const fn numbers<const N: usize>() -> [usize; N] {
    let mut numbers = [0; N];
    let mut i = 1;
    while i < N {
        numbers[i] = i;
        i += 1;
    }
    numbers
}

/// `[f(0), f(1), …]` with an `f` for each of the first six places: one that is large would stay a loop otherwise, and what it picks by its place would go
/// through memory. Filtered bumps took a quarter more time in lanes.
#[inline(always)]
pub fn unrolled<B: Copy, const N: usize>(f: impl Fn(usize) -> B + Copy) -> [B; N] {
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
