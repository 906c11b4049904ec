//! Curves of ICC profiles: powers, parameters or tables, compared with the known transfer functions.

use super::colour::Transfer;

/// Curve of a profile.
pub(super) enum Curve {
    Known(Transfer),
    Other,
}

/// The four bytes at `at` as a number with 16 fraction bits.
pub(super) fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    let bits = i32::from_be_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?);
    Some(f64::from(bits) / 65536.0)
}

/// Curves that are looked for before a power.
const KNOWN: [Transfer; 3] = [Transfer::Linear, Transfer::Srgb, Transfer::Bt709];

/// Codes at which curves are compared.
const SAMPLES: u32 = 64;

/// Largest difference of equal curves: half an 8-bit code of linear light. Tables have 16 bits, parameters four decimals.
const SAME: f64 = 0.002;

/// The curve of a tag (ICC.1:2022 §10.6, §10.18); `None` for another type, or for a damaged one.
pub(super) fn curve(tag: &[u8]) -> Option<Curve> {
    let decode = decoder(tag)?;
    if !(0..=SAMPLES).all(|code| decode(f64::from(code) / f64::from(SAMPLES)).is_finite()) {
        return None;
    }
    let is_near = |transfer: &Transfer| {
        (0..=SAMPLES)
            .map(|code| f64::from(code) / f64::from(SAMPLES))
            .all(|x| (transfer.decode(x) - decode(x)).abs() <= SAME)
    };
    // The power that has the curve's value in the middle.
    let power = Transfer::Gamma(-libm::log2(decode(0.5)));
    let found = KNOWN.into_iter().chain([power]).find(is_near);
    Some(found.map_or(Curve::Other, Curve::Known))
}

/// Light of a code, 0 to 1 each.
fn decoder(tag: &[u8]) -> Option<Box<dyn Fn(f64) -> f64>> {
    let short = |at: usize| Some(u16::from_be_bytes(tag.get(at..at + 2)?.try_into().ok()?));
    match tag.get(..4)? {
        b"curv" => {
            let count = u32::from_be_bytes(tag.get(8..12)?.try_into().ok()?) as usize;
            match count {
                0 => Some(Box::new(|x| x)),
                1 => {
                    let gamma = f64::from(short(12)?) / 256.0;
                    Some(Box::new(move |x| libm::pow(x, gamma)))
                }
                _ => {
                    let table = tag.get(12..count.checked_mul(2)?.checked_add(12)?)?;
                    let table: Vec<f64> = table
                        .chunks_exact(2)
                        .map(|pair| f64::from(u16::from_be_bytes([pair[0], pair[1]])) / 65535.0)
                        .collect();
                    Some(Box::new(move |x| {
                        let place = x * (table.len() - 1) as f64;
                        let below = (place as usize).min(table.len() - 2);
                        let share = place - below as f64;
                        table[below] * (1.0 - share) + table[below + 1] * share
                    }))
                }
            }
        }
        b"para" => {
            // Parameters in the order g a b c d e f; a form has 1, 3, 4, 5 or 7 of them.
            let count = *[1, 3, 4, 5, 7].get(usize::from(short(8)?))?;
            let mut own = [0.0; 7];
            for (index, number) in own.iter_mut().enumerate().take(count) {
                *number = fixed(tag, 12 + 4 * index)?;
            }
            let [g, a, b, c, d, e, f] = own;
            let power = move |x: f64| libm::pow((a * x + b).max(0.0), g);
            Some(match count {
                1 => Box::new(move |x| libm::pow(x, g)),
                3 => Box::new(move |x| if a * x + b >= 0.0 { power(x) } else { 0.0 }),
                4 => Box::new(move |x| if a * x + b >= 0.0 { power(x) + c } else { c }),
                5 => Box::new(move |x| if x >= d { power(x) } else { c * x }),
                _ => Box::new(move |x| if x >= d { power(x) + e } else { c * x + f }),
            })
        }
        _ => None,
    }
}
