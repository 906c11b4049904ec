//! Arrays of wires element by element, without a call.
//!
//! Code that runs in lanes has to be one function. It is compiled for an instruction set, and a closure that is not inlined does not inherit that
//! set. `core::array::map` and iterators leave inlining to the optimiser, with which lanes take twice the time.

use core::mem::ManuallyDrop;

/// `[f(a₀), f(a₁), …]`, the first six elements written out: a loop of a few turns costs five passes of the optimiser. The closure is not dropped. A
/// drop on unwinding would split the function at every operation.
#[inline(always)]
pub fn each<A: Copy, B: Copy, const N: usize>(array: [A; N], f: impl FnMut(A) -> B) -> [B; N] {
    const { assert!(N > 0, "an array of wires is not empty") }
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
        results[4] = f(array[4]);
    }
    if const { N > 5 } {
        results[5] = f(array[5]);
    }
    if const { N > 6 } {
        let mut i = 6;
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

/// [`each()`] of a fixed number of elements. `[b; N]`, with which an array of any length begins, would be a loop, too.
macro_rules! fixed {
    ($($name:ident of $count:literal: $($i:literal)*;)*) => {
        $(
            #[doc = concat!("[`each()`] of ", stringify!($count), ".")]
            #[inline(always)]
            pub fn $name<A: Copy, B>(array: [A; $count], f: impl FnMut(A) -> B) -> [B; $count] {
                let mut f = ManuallyDrop::new(f);
                [$(f(array[$i])),*]
            }
        )*
    };
}

fixed! {
    two of 2: 0 1;
    three of 3: 0 1 2;
    four of 4: 0 1 2 3;
    six of 6: 0 1 2 3 4 5;
    eight of 8: 0 1 2 3 4 5 6 7;
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

/// `each!(a in array => expression)`: array of the expression's values for the elements.
#[macro_export]
macro_rules! each {
    ($element:pat_param in [$a:expr, $b:expr] => $expression:expr) => {
        $crate::each!(@by two, $element, [$a, $b], $expression)
    };
    ($element:pat_param in [$a:expr, $b:expr, $c:expr] => $expression:expr) => {
        $crate::each!(@by three, $element, [$a, $b, $c], $expression)
    };
    ($element:pat_param in [$a:expr, $b:expr, $c:expr, $d:expr] => $expression:expr) => {
        $crate::each!(@by four, $element, [$a, $b, $c, $d], $expression)
    };
    ($element:pat_param in [$a:expr, $b:expr, $c:expr, $d:expr, $e:expr, $f:expr] => $expression:expr) => {
        $crate::each!(@by six, $element, [$a, $b, $c, $d, $e, $f], $expression)
    };
    ($element:pat_param in [$a:expr, $b:expr, $c:expr, $d:expr, $e:expr, $f:expr, $g:expr, $h:expr] => $expression:expr) => {
        $crate::each!(@by eight, $element, [$a, $b, $c, $d, $e, $f, $g, $h], $expression)
    };
    ($element:pat_param in $array:expr => $expression:expr) => {
        $crate::each!(@by each, $element, $array, $expression)
    };
    (@by $each:ident, $element:pat_param, $array:expr, $expression:expr) => {
        $crate::each::$each(
            $array,
            #[inline(always)]
            |$element| $expression,
        )
    };
}
pub use crate::each;
