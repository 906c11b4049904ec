//! Library functions that the datapath uses, and the libraries.

/// Operations of the datapath beyond sums and products. The default methods are those of a careful user whose library has a square root. They are
/// exact but for rounding, except the logarithm.
pub trait Math {
    /// √x, x ≥ 0.
    fn sqrt(x: f32) -> f32;

    /// a/b, b ≥ 0.
    #[inline(always)]
    fn quotient(a: f32, b: f32) -> f32 {
        a / b
    }

    /// 1/√x, x ≥ 0.
    #[inline(always)]
    fn inverse_sqrt(x: f32) -> f32 {
        Self::quotient(1.0, Self::sqrt(x))
    }

    /// log₂ of a positive normal number; 0 gives −127. Error below 2^−13: degree 4 in the fraction, exact at powers of two. A level of detail needs
    /// no more, and a library's logarithm costs a multiple.
    #[inline(always)]
    fn log2(x: f32) -> f32 {
        let bits = x.to_bits();
        let exponent = (bits >> 23) as i32 - 127;
        let f = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000) - 1.0;
        exponent as f32 + f + f * (1.0 - f) * (0.438_725_74 + f * (-0.239_058_23 + f * 0.082_130_685))
    }

    /// log₂ of a positive number by the library.
    fn library_log2(x: f32) -> f32;

    /// xⁿ, x > 0.
    fn power(x: f32, n: f32) -> f32;

    /// (1 − x)ⁿ, 0 ≤ x < 1; no digit of a small x is lost if the library has a logarithm of 1 + x.
    fn power_of_one_minus(x: f32, n: f32) -> f32;
}

/// The standard library: an instruction for each operation, and vectors of them.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug)]
pub struct Std;

#[cfg(feature = "std")]
impl Math for Std {
    #[inline(always)]
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    #[inline(always)]
    fn library_log2(x: f32) -> f32 {
        x.log2()
    }

    #[inline(always)]
    fn power(x: f32, n: f32) -> f32 {
        x.powf(n)
    }

    #[inline(always)]
    fn power_of_one_minus(x: f32, n: f32) -> f32 {
        (n * (-x).ln_1p()).exp()
    }
}

/// `libm`, whose square root is rounded correctly: the same bits as `Std`.
#[cfg(feature = "libm")]
#[derive(Clone, Copy, Debug)]
pub struct Libm;

#[cfg(feature = "libm")]
impl Math for Libm {
    #[inline(always)]
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    #[inline(always)]
    fn library_log2(x: f32) -> f32 {
        libm::log2f(x)
    }

    #[inline(always)]
    fn power(x: f32, n: f32) -> f32 {
        libm::powf(x, n)
    }

    #[inline(always)]
    fn power_of_one_minus(x: f32, n: f32) -> f32 {
        libm::expf(n * libm::log1pf(-x))
    }
}

/// `micromath`, whose approximations are an integer addition or two. The only division left is that in its logarithm.
///
/// Largest relative errors: √x 6.1 %, 1/x 12.5 %, 1/√x 3.4 %. √0 is 1.5·2^−64, so a fragment without a footprint is not found to be empty.
#[cfg(feature = "micromath")]
#[derive(Clone, Copy, Debug)]
pub struct Micromath;

#[cfg(feature = "micromath")]
impl Math for Micromath {
    #[inline(always)]
    fn sqrt(x: f32) -> f32 {
        micromath::F32Ext::sqrt(x)
    }

    #[inline(always)]
    fn quotient(a: f32, b: f32) -> f32 {
        a * micromath::F32Ext::inv(b)
    }

    #[inline(always)]
    fn inverse_sqrt(x: f32) -> f32 {
        micromath::F32Ext::invsqrt(x)
    }

    #[inline(always)]
    fn log2(x: f32) -> f32 {
        Self::library_log2(x)
    }

    #[inline(always)]
    fn library_log2(x: f32) -> f32 {
        micromath::F32Ext::log2(x)
    }

    #[inline(always)]
    fn power(x: f32, n: f32) -> f32 {
        micromath::F32Ext::powf(x, n)
    }

    #[inline(always)]
    fn power_of_one_minus(x: f32, n: f32) -> f32 {
        Self::power(1.0 - x, n)
    }
}
