//! Axes: places of values, drawn range, ticks and the notation of numbers.

/// Scale of the values on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equally long.
    Linear,
    /// Equal ratios are equally long, ticks at powers of two.
    Log2,
    /// Equal ratios are equally long, ticks at powers of ten, in short ranges also at 2 and 5 times them.
    Log10,
}

/// Largest drawn value: differences of larger values might not be finite.
const LARGEST: f64 = 1e100;

impl Scale {
    /// Place of a value: the value itself or its logarithm. `None` if it is not finite, too large or has no logarithm.
    pub(super) fn place(self, value: f64) -> Option<f64> {
        let place = match self {
            Scale::Linear => value,
            Scale::Log2 => value.log2(),
            Scale::Log10 => value.log10(),
        };
        (place.is_finite() && place.abs() <= LARGEST).then_some(place)
    }

    /// Ends of the axis: all places with a margin, at least two ticks, never of length zero.
    pub(super) fn range(self, places: impl IntoIterator<Item = f64>) -> [f64; 2] {
        let outer = places.into_iter().fold(None, |outer: Option<[f64; 2]>, place| match outer {
            None => Some([place; 2]),
            Some([low, high]) => Some([f64::min(low, place), f64::max(high, place)]),
        });
        let Some([low, high]) = outer else { return [0.0, 1.0] };
        let largest = low.abs().max(high.abs());
        let margin = match self {
            _ if high - low > 1e-9 * largest => 0.04 * (high - low),
            Scale::Linear if largest > 0.0 => 0.1 * largest,
            _ => 1.0,
        };
        let range = [low - margin, high + margin];
        if self == Scale::Linear || self.ticks(range, 64).len() > 1 {
            return range;
        }
        [range[0].floor(), range[1].ceil()]
    }

    /// Places and labels of the ticks of a range, at most `most` (four are always allowed).
    pub(super) fn ticks(self, range: [f64; 2], most: usize) -> Vec<(f64, String)> {
        let most = most.max(4);
        match self {
            Scale::Linear => linear_ticks(range, most),
            Scale::Log2 => {
                let steps = (0..12).map(|i| f64::from(1 << i));
                let exponents = coarsest_that_fits(range, most, steps);
                let is_plain = exponents.iter().all(|exponent| (-3.0..=9.0).contains(exponent));
                let label = |e: f64| if is_plain { e.exp2().to_string() } else { power(2, e) };
                exponents.into_iter().map(|exponent| (exponent, label(exponent))).collect()
            }
            Scale::Log10 => log10_ticks(range, most),
        }
    }

    /// Notation of the values of an axis: powers of two if all values on a [`Scale::Log2`] axis are powers of two.
    pub(super) fn numbers(self, values: impl IntoIterator<Item = f64>) -> impl Fn(f64) -> String {
        let is_power = |value: f64| value > 0.0 && value.log2().fract() == 0.0;
        let as_powers = self == Scale::Log2 && values.into_iter().all(is_power);
        move |value| if as_powers { power(2, value.log2()) } else { number(value) }
    }
}

/// A value with four significant digits.
fn number(value: f64) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if value.is_infinite() {
        return minus(if value > 0.0 { "∞" } else { "-∞" });
    }
    let written = format!("{value:.3e}");
    let (digits, exponent) = written.split_once('e').unwrap_or((&written, "0"));
    let exponent = exponent.parse().unwrap_or(0);
    if value == 0.0 || (-3..6).contains(&exponent) {
        let decimals = usize::try_from(3 - exponent).unwrap_or(0);
        return minus(shortened(&format!("{value:.decimals$}")));
    }
    format!("{}·{}", minus(shortened(digits)), power(10, f64::from(exponent)))
}

/// Multiples of the first step of which at most `most` lie in a range.
fn coarsest_that_fits([low, high]: [f64; 2], most: usize, steps: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut multiples = Vec::new();
    for step in steps {
        let (first, last) = ((low / step).ceil(), (high / step).floor());
        // Both ends are whole; a range shorter than a step may hold no multiple.
        let count = (last - first + 1.0).max(0.0) as usize;
        if count <= most {
            multiples = (0..count).map(|i| (first + i as f64) * step).collect();
            break;
        }
    }
    multiples
}

fn linear_ticks(range: [f64; 2], most: usize) -> Vec<(f64, String)> {
    // A first step of at most a hundredth of the needed one.
    let exponent = ((range[1] - range[0]) / most as f64).log10().floor() as i32;
    let steps = (exponent..).flat_map(|e| [1.0, 2.0, 5.0].map(|factor| factor * 10_f64.powi(e)));
    let places = coarsest_that_fits(range, most, steps);
    let step = places.windows(2).map(|pair| pair[1] - pair[0]).next().unwrap_or(1.0);
    let decimals_of = |step: f64| (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    let largest = places.iter().fold(0.0, |largest: f64, place| largest.max(place.abs()));
    let label = |place: f64| {
        if place == 0.0 {
            return "0".to_owned();
        }
        if step >= 1e-4 && largest < 1e6 {
            return minus(&format!("{place:.*}", decimals_of(step)));
        }
        let exponent = largest.log10().floor();
        let digits = place / 10_f64.powf(exponent);
        format!("{}·{}", minus(&format!("{digits:.*}", decimals_of(step / 10_f64.powf(exponent)))), power(10, exponent))
    };
    places.iter().map(|place| (*place, label(*place))).collect()
}

fn log10_ticks(range: [f64; 2], most: usize) -> Vec<(f64, String)> {
    let decades = range[0].floor() as i32..=range[1].floor() as i32;
    let factors = if decades.clone().count() <= most { &[1, 2, 5][..] } else { &[] };
    let fine: Vec<(i32, i32)> = decades
        .flat_map(|decade| factors.iter().map(move |factor| (*factor, decade)))
        .filter(|(factor, decade)| {
            let place = f64::from(*factor).log10() + f64::from(*decade);
            (range[0]..=range[1]).contains(&place)
        })
        .collect();
    let ticks = if fine.is_empty() || fine.len() > most {
        let steps = (0..).flat_map(|e| [1.0, 2.0, 5.0].map(|factor| factor * 10_f64.powi(e)));
        coarsest_that_fits(range, most, steps).into_iter().map(|exponent| (1, exponent as i32)).collect()
    } else {
        fine
    };
    let is_plain = ticks.iter().all(|(_, decade)| (-3..=3).contains(decade));
    let label = |factor: i32, decade: i32| match factor {
        _ if is_plain => {
            let decimals = usize::try_from(-decade).unwrap_or(0);
            format!("{:.decimals$}", f64::from(factor) * 10_f64.powi(decade))
        }
        1 => power(10, decade.into()),
        _ => format!("{factor}·{}", power(10, decade.into())),
    };
    ticks.into_iter().map(|(f, d)| (f64::from(f).log10() + f64::from(d), label(f, d))).collect()
}

/// A power with its integer exponent in superscripts.
fn power(base: u32, exponent: f64) -> String {
    let digits = format!("{exponent:.0}");
    let superscript = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    };
    format!("{base}{}", digits.chars().map(superscript).collect::<String>())
}

/// The number without trailing zeros.
fn shortened(decimal: &str) -> &str {
    if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { decimal }
}

/// The number with a minus sign as wide as a digit; zero has no sign.
fn minus(number: &str) -> String {
    let is_zero = number.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { number.replace('-', "") } else { number.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, range: [f64; 2], most: usize) -> Vec<String> {
        scale.ticks(range, most).into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_few_and_legible() {
        assert_eq!(labels(Scale::Log2, [-28.5, 0.5], 8), ["2⁻²⁸", "2⁻²⁴", "2⁻²⁰", "2⁻¹⁶", "2⁻¹²", "2⁻⁸", "2⁻⁴", "2⁰"]);
        assert_eq!(labels(Scale::Log2, [-2.5, 3.5], 8), ["0.25", "0.5", "1", "2", "4", "8"]);
        assert_eq!(labels(Scale::Log10, [-0.5, 1.8], 7), ["0.5", "1", "2", "5", "10", "20", "50"]);
        assert_eq!(labels(Scale::Log10, [-6.2, 0.1], 4), ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]);
        assert_eq!(labels(Scale::Linear, [-0.3, 1.1], 5), ["0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::Linear, [-2.1e7, 2.1e7], 5), ["−2·10⁷", "−1·10⁷", "0", "1·10⁷", "2·10⁷"]);
    }

    #[test]
    fn every_range_has_a_length_and_two_ticks() {
        for scale in [Scale::Linear, Scale::Log2, Scale::Log10] {
            for values in [&[][..], &[0.0], &[1.0], &[3.3, 3.4], &[1e99, 1e100], &[-7.0, 1e-300], &[5.0, 5.0 + 1e-15]] {
                let [low, high] = scale.range(values.iter().filter_map(|value| scale.place(*value)));
                assert!(low < high, "{scale:?} {values:?}");
                let ticks = scale.ticks([low, high], 6);
                assert!((2..=6).contains(&ticks.len()), "{scale:?} {values:?}: {ticks:?}");
                assert!(ticks.iter().all(|(place, _)| (low..=high).contains(place)));
            }
        }
    }

    #[test]
    fn a_table_has_four_digits_or_powers_of_two() {
        let small = 2_f64.powi(-28);
        let numbers = [0.0, -0.0, 1.0, -33.123_45, 123_456.7, 1.5e-7, 0.25, small, f64::NAN, f64::NEG_INFINITY];
        let written = ["0", "0", "1", "−33.12", "123457", "1.5·10⁻⁷", "0.25", "3.725·10⁻⁹", "NaN", "−∞"];
        assert_eq!(numbers.map(Scale::Log2.numbers(numbers)), written);
        assert_eq!([1.0, small].map(Scale::Log2.numbers([1.0, small])), ["2⁰", "2⁻²⁸"]);
        assert_eq!(Scale::Linear.numbers([small])(small), "3.725·10⁻⁹");
    }
}
