//! Powers in printed form.

use std::fmt::Display;

/// A number in superscript digits, with a raised dot as its point.
pub(crate) fn superscript(number: impl Display) -> String {
    let raised = |digit| match digit {
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        '-' => '⁻',
        _ => '·',
    };
    number.to_string().chars().map(raised).collect()
}
