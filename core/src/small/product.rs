//! Products on a processor without a multiplier: of narrow words by a table, of wide words by adds.

/// Table of ⌊n²/4⌋ at the place n + 1024: x·y is the difference between the entries for x + y and x − y.
static QUARTERS_OF_SQUARES: [u32; 2048] = {
    let mut table = [0; 2048];
    let mut place = 0;
    while place < 2048 {
        let n = place as i32 - 1024;
        table[place] = ((n * n) >> 2) as u32;
        place += 1;
    }
    table
};

/// Product of two signed 16-bit numbers: three products of their halves by a table of quarter squares (Karatsuba).
#[inline(never)]
pub fn product_by_table(a: i32, b: i32) -> i32 {
    // Both factors within ±383: their sum and difference are inside the table.
    let product = |x: i32, y: i32| {
        let quarter = |n: i32| QUARTERS_OF_SQUARES[((n + 1024) & 2047) as usize];
        quarter(x + y).wrapping_sub(quarter(x - y)) as i32
    };
    let (a_high, a_low) = (i32::from((a >> 8) as i8), i32::from(a as u8));
    let (b_high, b_low) = (i32::from((b >> 8) as i8), i32::from(b as u8));
    let (highs, lows) = (product(a_high, b_high), product(a_low, b_low));
    let across = highs + lows - product(a_high - a_low, b_high - b_low);
    (highs << 16).wrapping_add(across << 8).wrapping_add(lows)
}

/// Product of two 32-bit numbers, by as many adds as half of one of them has bits.
///
/// Cores without a multiplier often shift one place a clock, too. So signs take branches instead of shifts by 31, and loops shift by one place.
#[inline(never)]
pub fn product_by_adds(a: i32, b: i32) -> i64 {
    // A call in each arm is a jump at its end. With one call after the arms, compilers make magnitudes by shifts.
    let (x, y) = (a.wrapping_neg() as u32, b.wrapping_neg() as u32);
    match (a < 0, b < 0) {
        (false, false) => product_of_magnitudes(a as u32, b as u32, a ^ b),
        (true, false) => product_of_magnitudes(x, b as u32, a ^ b),
        (false, true) => product_of_magnitudes(a as u32, y, a ^ b),
        (true, true) => product_of_magnitudes(x, y, a ^ b),
    }
}

/// Implements [`product_by_adds`] for magnitudes, at most 2^31, and a number that has the sign of the product.
#[inline(never)]
fn product_of_magnitudes(x: u32, y: u32, sign: i32) -> i64 {
    let ends_in_zeros = (x | y) & 0x3ff == 0;
    let product = if ends_in_zeros { product_of_tops(x, y) } else { product_of_halves(x, y) } as i64;
    if sign < 0 { product.wrapping_neg() } else { product }
}

/// Product of two magnitudes that end in ten zeros, as most mantissas do.
///
/// The other 22 bits of y are two parts of 11 bits. The product of a part and the 22 bits of x fits a register, so nothing carries. An arm for each
/// pair of bits keeps branches, which skip adds; compilers make masks of two conditions.
#[inline(always)]
fn product_of_tops(x: u32, y: u32) -> u64 {
    let mut x = x >> 10;
    let (y_high, y_low) = (y >> 11, y & 0x1f_ffff);
    let (mut highs, mut lows, mut both) = (0_u32, 0_u32, 0_u32);
    let bits = y_high | y_low;
    let mut bit = 1 << 10;
    loop {
        match (y_low & bit != 0, y_high & bit != 0) {
            (false, false) => {}
            (true, false) => lows = lows.wrapping_add(x),
            (false, true) => highs = highs.wrapping_add(x),
            (true, true) => both = both.wrapping_add(x),
        }
        x = x.wrapping_add(x);
        bit += bit;
        if bit > bits {
            break;
        }
    }
    (u64::from(highs.wrapping_add(both)) << 31).wrapping_add(u64::from(lows.wrapping_add(both)) << 20)
}

/// Product of any two magnitudes from products of their halves, which fit a register.
#[inline(always)]
fn product_of_halves(x: u32, y: u32) -> u64 {
    let (mut high, mut low) = (x >> 16, x & 0xffff);
    let (y_high, y_low) = (y >> 16, y & 0xffff);
    let (mut highs, mut across, mut lows) = (0_u32, 0_u32, 0_u32);
    let bits = y_high | y_low;
    let mut bit = 1;
    loop {
        match (y_low & bit != 0, y_high & bit != 0) {
            (false, false) => {}
            (true, false) => {
                lows = lows.wrapping_add(low);
                across = across.wrapping_add(high);
            }
            (false, true) => {
                across = across.wrapping_add(low);
                highs = highs.wrapping_add(high);
            }
            (true, true) => {
                lows = lows.wrapping_add(low);
                across = across.wrapping_add(low).wrapping_add(high);
                highs = highs.wrapping_add(high);
            }
        }
        high = high.wrapping_add(high);
        low = low.wrapping_add(low);
        bit += bit;
        if bit > bits {
            break;
        }
    }
    (u64::from(highs) << 32).wrapping_add(u64::from(across) << 16).wrapping_add(u64::from(lows))
}
