//! Tables of the datapath, computed at compile time in integers. They are part of the specification.
//!
//! Every entry is the exact value rounded to nearest in the stated format; the series below run in 2^−60 units
//! and are good to better than 2^−50.

/// Upper `bits` of a 32-bit entry, rounded to nearest, ties up: the same number with fewer fraction bits. Range: `bits` from 2 to 32; no entry below
/// is so large that it would round up beyond the word.
pub const fn upper(entry: i32, bits: u32) -> i32 {
    if bits >= 32 { entry } else { ((entry >> (31 - bits)) + 1) >> 1 }
}

/// One in the fixed point of the generators.
const ONE: i128 = 1 << 60;
/// π · 2^60.
const PI: i128 = 3_622_009_729_038_561_421;
/// ln 2 · 2^60.
const LN2: i128 = 799_144_290_325_165_979;

const fn mul(a: i128, b: i128) -> i128 {
    (a * b) >> 60
}

/// Rounds a 2^−60 number to `bits` fraction bits.
const fn round(x: i128, bits: u32) -> i32 {
    ((x + (1 << (59 - bits))) >> (60 - bits)) as i32
}

/// Integer square root, rounded down.
const fn isqrt(n: i128) -> i128 {
    let mut root = 0_i128;
    let mut bit = 1_i128 << 62;
    while bit > 0 {
        let trial = root | bit;
        if trial * trial <= n {
            root = trial;
        }
        bit >>= 1;
    }
    root
}

/// (sin x, cos x) for 0 ≤ x ≤ π/2 by their series.
const fn sin_cos(x: i128) -> (i128, i128) {
    let (mut sin, mut cos, mut term) = (0, 0, ONE);
    let mut k = 0;
    while k < 28 {
        match k % 4 {
            0 => cos += term,
            1 => sin += term,
            2 => cos -= term,
            _ => sin -= term,
        }
        k += 1;
        term = mul(term, x) / k;
    }
    (sin, cos)
}

/// e^x for −8 ≤ x ≤ 1 by its series.
const fn exp(x: i128) -> i128 {
    let (mut sum, mut term) = (0, ONE);
    let mut k = 0;
    while k < 60 {
        sum += term;
        k += 1;
        term = mul(term, x) / k;
    }
    sum
}

/// ln x for 1 ≤ x ≤ 2: 2·artanh((x − 1)/(x + 1)).
const fn ln(x: i128) -> i128 {
    let y = ((x - ONE) << 60) / (x + ONE);
    let square = mul(y, y);
    let (mut sum, mut power) = (0, y);
    let mut k = 1;
    while k < 50 {
        sum += power / k;
        power = mul(power, square);
        k += 2;
    }
    2 * sum
}

/// log₂ x for x ≥ 1.
const fn log2(x: i128) -> i128 {
    let shift = (x >> 60).ilog2();
    (ln(x >> shift) << 60) / LN2 + ONE * shift as i128
}

/// Reciprocal seeds: entry i is 1/(2x) for the middle x of the i-th of `N` equal intervals of [½, 1), I2F30 with
/// log₂N + 2 kept fraction bits.
const fn reciprocal_seeds<const N: usize>() -> [i32; N] {
    let bits = N.trailing_zeros();
    let mut table = [0; N];
    let mut i = 0;
    while i < N {
        let middle = (ONE >> 1) + (2 * i as i128 + 1) * ONE / (4 * N as i128);
        let half_reciprocal = ((ONE >> 1) << 60) / middle;
        table[i] = round(half_reciprocal, bits + 2) << (28 - bits);
        i += 1;
    }
    table
}

/// Inverse root seeds: entry i is 1/(2√x) for the middle x of the i-th of the intervals of width 1/`N` from ¼ on,
/// I2F30 with log₂N + 2 kept fraction bits. The last quarter of the table is never addressed.
const fn inverse_root_seeds<const N: usize>() -> [i32; N] {
    let bits = N.trailing_zeros();
    let mut table = [1 << 29; N];
    let mut i = 0;
    while i < N * 3 / 4 {
        let middle = (ONE >> 2) + (2 * i as i128 + 1) * ONE / (2 * N as i128);
        let half_inverse = ((ONE >> 1) << 60) / isqrt(middle << 60);
        table[i] = round(half_inverse, bits + 2) << (28 - bits);
        i += 1;
    }
    table
}

macro_rules! seeds {
    ($name:ident, $generator:ident, $doc:literal) => {
        #[doc = $doc]
        pub fn $name(bits: u32) -> &'static [i32] {
            static T6: [i32; 64] = $generator();
            static T7: [i32; 128] = $generator();
            static T8: [i32; 256] = $generator();
            static T9: [i32; 512] = $generator();
            static T10: [i32; 1024] = $generator();
            match bits {
                0..=6 => &T6,
                7 => &T7,
                8 => &T8,
                9 => &T9,
                _ => &T10,
            }
        }
    };
}

seeds!(reciprocal, reciprocal_seeds, "Seeds of 1/(2x), x in [½, 1); 2^bits entries, bits 6…10.");
seeds!(inverse_root, inverse_root_seeds, "Seeds of 1/(2√x), x in [¼, 1); 2^bits entries, bits 6…10.");

/// Index bits of the logarithm and exponential tables. Linear interpolation between 2^8 knots errs by at most
/// h²/8 · max|f″| = 2^−18.4 (log₂) and 2^−20 (exp₂), below every LOD bar.
pub const LOG_BITS: u32 = 8;

/// log₂(1 + i/256), i = 0…256, 24 fraction bits.
pub static LOG2: [i32; 257] = {
    let mut table = [0; 257];
    let mut i = 0;
    while i < 257 {
        let x = ONE + (ONE >> LOG_BITS) * i as i128;
        table[i] = round((ln(x) << 60) / LN2, 24);
        i += 1;
    }
    table
};

/// 2^(i/256)/2, i = 0…256, I2F30.
pub static EXP2: [i32; 257] = {
    let mut table = [0; 257];
    let mut i = 0;
    while i < 257 {
        table[i] = round(exp(mul(LN2, (ONE >> LOG_BITS) * i as i128)) >> 1, 30);
        i += 1;
    }
    table
};

/// −log₂(1 − y)/(2y) at y = i/512, i = 0…256, from 1/(2 ln 2) to 1, 26 fraction bits: a rise between knots has 17. Linear
/// interpolation errs by at most h²/8 · max|f″| = 2^−19.8, plus 2^−28 a knot.
pub static HALF_LOG2_ONE_MINUS_RATIO: [i32; 257] = {
    let mut table = [round((ONE << 59) / LN2, 26); 257];
    let mut i = 1;
    while i < 257 {
        let one_minus_y = ONE - (ONE >> (LOG_BITS + 1)) * i as i128;
        let log = (ln((ONE << 60) / one_minus_y) << 60) / LN2;
        table[i] = round((log << LOG_BITS) / i as i128, 26);
        i += 1;
    }
    table
};

/// log₂(1 + x)/(2x) at x = i/256, i = 0…256 (1/(2 ln 2) at 0), 26 fraction bits: a fall between knots has 17. Linear
/// interpolation errs by at most h²/8 · max|f″| = 2^−20.05 of values in [½, 0.7214], plus 2^−28 a knot.
pub static HALF_LOG2_ONE_PLUS_RATIO: [i32; 257] = {
    let mut table = [round((ONE << 59) / LN2, 26); 257];
    let mut i = 1;
    while i < 257 {
        let x = (ONE >> LOG_BITS) * i as i128;
        let log2 = (ln(ONE + x) << 60) / LN2;
        table[i] = round((log2 << 59) / x, 26);
        i += 1;
    }
    table
};

/// Largest number of steps over 90° of an angle table.
const MAX_ANGLE_STEPS: usize = 64;

/// sin and cos of `column/(2·row)` · 90°, I2F30; a row holds as many columns as it has steps.
static SIN_COS: [[(i32, i32); MAX_ANGLE_STEPS + 1]; MAX_ANGLE_STEPS / 2 + 1] = {
    let mut table = [[(0, 1 << 30); MAX_ANGLE_STEPS + 1]; MAX_ANGLE_STEPS / 2 + 1];
    let mut row = 1;
    while row <= MAX_ANGLE_STEPS / 2 {
        let mut column = 0;
        while column <= 2 * row {
            let (sin, cos) = sin_cos(PI / 2 * column as i128 / (2 * row) as i128);
            table[row][column] = (round(sin, 30), round(cos, 30));
            column += 1;
        }
        row += 1;
    }
    table
};

/// sin and cos of `numerator/denominator` · 90°, I2F30. The denominator is even, at most 64. Both numbers are known when the datapath is built, so
/// the result is a constant there.
pub fn sin_cos_of_right_angle(numerator: u32, denominator: u32) -> (i32, i32) {
    let row = SIN_COS.get(denominator as usize >> 1);
    row.and_then(|row| row.get(numerator as usize)).copied().unwrap_or((0, 1 << 30))
}

/// Largest probe count of any profile.
pub const MAX_PROBES: usize = 16;

/// 2√3/N · 2^28 for N probes at index N: the step along the major axis in units of λ₁. Entry 0 repeats entry 1.
pub static STEP_PER_SIGMA: [i32; MAX_PROBES + 1] = {
    let two_root_three = isqrt((12 * ONE) << 60);
    let mut table = [round(two_root_three, 28); MAX_PROBES + 1];
    let mut n = 2;
    while n <= MAX_PROBES {
        table[n] = round(two_root_three / n as i128, 28);
        n += 1;
    }
    table
};

/// √(1 − 1/N²) · 2^30 at index N: the spread of N probes of standard deviation λ₁/N, in units of λ₁. Entry 0 repeats entry 1.
pub static SPREAD_LIMIT: [i32; MAX_PROBES + 1] = {
    let mut table = [0; MAX_PROBES + 1];
    let mut n = 2;
    while n <= MAX_PROBES {
        table[n] = round(isqrt((ONE - ONE / (n * n) as i128) << 60), 30);
        n += 1;
    }
    table
};

/// 1/√(2π).
const NORMAL_DENSITY_AT_ZERO: i128 = isqrt(((ONE << 59) / PI) << 60);

/// Density of the normal distribution.
const fn normal_density(x: i128) -> i128 {
    mul(NORMAL_DENSITY_AT_ZERO, exp(-mul(x, x) / 2))
}

/// Point with the share `numerator/denominator` (at least ½) of the normal distribution below it, by Newton's method from 0.
const fn normal_quantile(numerator: usize, denominator: usize) -> i128 {
    let above_half = ONE * numerator as i128 / denominator as i128 - ONE / 2;
    let mut x = 0;
    let mut step = 0;
    while step < 8 {
        // ∫₀ˣ of the density: its value at 0 times Σ (−1)ᵏ·x^(2k + 1)/(2ᵏ·k!·(2k + 1)).
        let (mut power, mut sum, mut k) = (x, x, 1);
        while k < 28 {
            power = -mul(mul(power, x), x) / (2 * k);
            sum += power / (2 * k + 1);
            k += 1;
        }
        x += ((above_half - mul(NORMAL_DENSITY_AT_ZERO, sum)) << 60) / normal_density(x);
        step += 1;
    }
    x
}

/// Normal distribution in N parts of equal weight: the means of the parts, and three fifths of the variance that an outer part has more than the
/// middle one. Probes are wider by that much. (A larger share is better for the plane and worse for the sphere in
/// `host-tests/tests/pictures/lobes.rs`.) Means are stretched until both together have the variance 1. Entries start from the middle, for N ≥ 2.
const fn normal_parts(n: usize) -> [[i128; MAX_PROBES]; 2] {
    let (mut means, mut variances) = ([0; MAX_PROBES], [0; MAX_PROBES]);
    let count = n as i128;
    let mut i = n / 2;
    while i < n {
        let [above, above_density] = if i + 1 < n {
            let above = normal_quantile(i + 1, n);
            [above, normal_density(above)]
        } else {
            [0; 2]
        };
        let below = if 2 * i + 1 == n { -above } else { normal_quantile(i, n) };
        let below_density = normal_density(below);
        means[i] = (below_density - above_density) * count;
        let rest = mul(below, below_density) - mul(above, above_density);
        variances[i] = ONE + rest * count - mul(means[i], means[i]);
        i += 1;
    }
    let least = variances[n / 2];
    let (mut squares, mut missing) = (0, count * ONE);
    i = n / 2;
    while i < n {
        variances[i] = (variances[i] - least) * 3 / 5;
        squares += 2 * mul(means[i], means[i]);
        missing -= 2 * variances[i];
        i += 1;
    }
    let stretch = isqrt(((missing << 60) / squares) << 60);
    i = n / 2;
    while i < n {
        means[i] = mul(means[i], stretch);
        i += 1;
    }
    [means, variances]
}

/// Table of the probes of a sweep, at index 16·(N − 1) + i: their places in standard deviations, or by how many levels they are wider than its λ₂.
pub type SweepTable = [i32; MAX_PROBES * MAX_PROBES];

/// Normal distribution in N points of equal weight, 28 fraction bits: the means of its N equally likely parts. They are stretched until they and the
/// widths of [`NORMAL_WIDENINGS`] have standard deviation 1; a single point, which has no extent, stays at 0.
pub static NORMAL_PLACES: SweepTable = {
    let mut table = [0; MAX_PROBES * MAX_PROBES];
    let mut n = 2;
    while n <= MAX_PROBES {
        let [means, _] = normal_parts(n);
        let mut i = n.div_ceil(2);
        while i < n {
            let place = round(means[i], 28);
            table[MAX_PROBES * (n - 1) + i] = place;
            table[MAX_PROBES * (n - 1) + n - 1 - i] = -place;
            i += 1;
        }
        n += 1;
    }
    table
};

/// Number of levels by which a probe is coarser because its part of the distribution is wider than the middle part, 16 fraction bits: log₂√(1 +
/// R²·v). v is the variance of the part. N − 5/4 stands for R = √(λ₁² − λ₂²)/λ₂, which is between N − 2 and N − 1.
pub static NORMAL_WIDENINGS: SweepTable = {
    let mut table = [0; MAX_PROBES * MAX_PROBES];
    let mut n = 3;
    while n <= MAX_PROBES {
        let [_, variances] = normal_parts(n);
        let mut i = n.div_ceil(2);
        while i < n {
            let quarters = 4 * n as i128 - 5;
            let widening = round(log2(ONE + variances[i] * quarters * quarters / 16) / 2, 16);
            table[MAX_PROBES * (n - 1) + i] = widening;
            table[MAX_PROBES * (n - 1) + n - 1 - i] = widening;
            i += 1;
        }
        n += 1;
    }
    table
};

/// Entries from which the probes of a table start as their number grows from N − 1, at the same index. These are the entries of N − 1, and for the
/// new probe the middle, which is 0 in a table. A count of two starts from its own entries.
const fn of_one_less(of: &SweepTable) -> SweepTable {
    let mut table = *of;
    let mut n = 3;
    while n <= MAX_PROBES {
        let mut i = 0;
        while i < n {
            let from = if 2 * i + 1 < n { i } else { i - 1 };
            let is_middle = 2 * i + 1 == n || 2 * i + 2 == n || 2 * i == n;
            table[MAX_PROBES * (n - 1) + i] = if is_middle { 0 } else { of[MAX_PROBES * (n - 2) + from] };
            i += 1;
        }
        n += 1;
    }
    table
}

/// Starts of the probes of [`NORMAL_PLACES`] as their number grows.
pub static NORMAL_PLACES_OF_ONE_LESS: SweepTable = of_one_less(&NORMAL_PLACES);

/// Starts of the widths of [`NORMAL_WIDENINGS`] as their number grows.
pub static NORMAL_WIDENINGS_OF_ONE_LESS: SweepTable = of_one_less(&NORMAL_WIDENINGS);

/// 1/N · 2^16 at index N. Entry 0 repeats entry 1.
pub static ONE_OVER_COUNT: [i32; MAX_PROBES + 1] = {
    let mut table = [1 << 16; MAX_PROBES + 1];
    let mut n = 2;
    while n <= MAX_PROBES {
        table[n] = round(ONE / n as i128, 16);
        n += 1;
    }
    table
};

/// log₂(1.8·√3) · 2^16: a texel on the sphere in units of λ₂, √3 for the bias of rough reflections. A trilinear probe on texels of size t that are
/// means by a kernel of deviation 0.35 t has the deviation 0.54 t, and between two levels a little more: 0.55 t.
pub const LOG2_TEXEL_ON_SPHERE: i32 = round(((ln(243 * ONE / 200) << 60) / LN2 + 3 * ONE) / 2, 16);

/// 1/√12 · 2^30: the standard deviation of a box of width one (errata 4 and 5).
pub const BOX_SIGMA: i32 = round(isqrt((ONE / 12) << 60), 30);

/// 1/√3 · 2^30: two standard deviations over the diameter of a footprint.
pub const INVERSE_ROOT_THREE: i32 = round(isqrt((ONE / 3) << 60), 30);

/// log₂(2√3) · 2^16: the minor diameter in units of λ₂.
pub const LOG2_DIAMETER: i32 = round(((ln(3 * ONE / 2) + LN2) << 60) / LN2 / 2 + ONE, 16);

/// log₂N · 2^16 at index N.
pub static LOG2_OF_COUNT: [i32; MAX_PROBES + 1] = {
    let mut table = [0; MAX_PROBES + 1];
    let mut n = 1;
    while n <= MAX_PROBES {
        table[n] = round(log2(ONE * n as i128), 16);
        n += 1;
    }
    table
};

/// Probe weights in 2^−16 units at index 16·(N − 1) + i. The weights of one N sum to exactly 2^16, so a constant map stays constant.
pub type ProbeWeightTable = [i32; MAX_PROBES * MAX_PROBES];

const fn probe_weights(gaussian: bool) -> ProbeWeightTable {
    let mut table = [0; MAX_PROBES * MAX_PROBES];
    let mut n = 1;
    while n <= MAX_PROBES {
        let mut raw = [ONE; MAX_PROBES];
        let mut sum = 0;
        let mut i = 0;
        while i < n {
            if gaussian {
                // Probe i lies (2i − N + 1)·√3/N standard deviations from the centre.
                let offset = 2 * i as i128 - n as i128 + 1;
                raw[i] = exp(-3 * offset * offset * ONE / (2 * (n * n) as i128));
            }
            sum += raw[i];
            i += 1;
        }
        // Rounding the running sum, not each weight, makes the total exact.
        let (mut running, mut given) = (0, 0);
        i = 0;
        while i < n {
            running += raw[i];
            let upto = ((running << 16) + sum / 2) / sum;
            table[MAX_PROBES * (n - 1) + i] = (upto - given) as i32;
            given = upto;
            i += 1;
        }
        n += 1;
    }
    table
}

/// Equal weights.
pub static BOX_WEIGHTS: ProbeWeightTable = probe_weights(false);
/// Samples of the normal distribution.
pub static GAUSSIAN_WEIGHTS: ProbeWeightTable = probe_weights(true);
