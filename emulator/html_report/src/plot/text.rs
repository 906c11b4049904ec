//! Text of a plot: characters allowed in XML, widths, line breaks.

/// Ems of a character in a wide face (DejaVu Sans, Verdana): no label is wider in the reader's face.
fn character(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' | '·' => 0.34,
        'f' | 'r' | 't' | '(' | ')' | '[' | ']' | '/' | '-' | '"' => 0.42,
        '⁰'..='⁾' | '²' | '³' | '¹' => 0.44,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '–' | '—' | '…' | '→' | '←' => 1.0,
        '+' | '−' | '=' | '<' | '>' | '×' | '~' | '#' => 0.84,
        'A'..='Z' | '&' => 0.74,
        '0'..='\u{2fff}' => 0.64,
        '\u{3000}'.. => 1.0,
        _ => 0.64,
    }
}

/// Ems of a text.
pub(super) fn width(text: &str) -> f64 {
    text.chars().map(character).sum()
}

/// A text in one line, without characters that XML cannot represent.
pub(super) fn clean(text: &str) -> String {
    let allowed = |c: char| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c };
    text.chars().map(allowed).collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A clean text of at most `most` ems; a longer text ends in an ellipsis.
pub(super) fn fit(text: &str, most: f64) -> String {
    let text = clean(text);
    if width(&text) <= most {
        return text;
    }
    let mut left = most - character('…');
    let kept = text.chars().take_while(|c| {
        left -= character(*c);
        left >= 0.0
    });
    kept.chain(['…']).collect()
}

/// Lines of a clean text, of at most `most` ems each; an empty text has none.
pub(super) fn wrap(text: &str, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in clean(text).split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if width(line) + character(' ') + width(word) <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(fit(word, most)),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_labels_are_no_wider_than_asked() {
        let text = "error of the reflected radiance,\nrelative to its peak \u{0}and averybigwordthatfitsnowhere";
        for most in [6.0, 12.0, 40.0] {
            assert!(wrap(text, most).iter().all(|line| width(line) <= most));
            assert!(width(&fit(text, most)) <= most);
        }
        assert_eq!(wrap("a b", 40.0), ["a b"]);
        assert!(wrap(" \n", 40.0).is_empty());
    }
}
