//! Source of Rust or Verilog as tokens, for the tests that read it.

/// One token: an identifier, a number, or a single character of punctuation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// The characters.
    pub text: String,
    /// The line it starts in, from 1.
    pub line: usize,
    /// True after white space or a comment: rustfmt puts operators with two operands between spaces.
    pub spaced: bool,
}

/// Splits source into tokens without comments, strings and character literals.
pub fn tokens(source: &str) -> Vec<Token> {
    let characters: Vec<char> = source.chars().collect();
    let at = |i: usize| characters.get(i).copied().unwrap_or('\0');
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut i, mut line, mut spaced, mut found) = (0, 1, false, Vec::new());
    while i < characters.len() {
        let start = i;
        match at(i) {
            '/' if at(i + 1) == '/' => {
                while i < characters.len() && at(i) != '\n' {
                    i += 1;
                }
            }
            '/' if at(i + 1) == '*' => {
                let mut depth = 0;
                loop {
                    match (at(i), at(i + 1)) {
                        ('/', '*') => (depth, i) = (depth + 1, i + 2),
                        ('*', '/') => (depth, i) = (depth - 1, i + 2),
                        _ => i += 1,
                    }
                    if depth == 0 || i >= characters.len() {
                        break;
                    }
                }
            }
            '"' => {
                i += 1;
                while i < characters.len() && at(i) != '"' {
                    i += if at(i) == '\\' { 2 } else { 1 };
                }
                i += 1;
            }
            // 'a' and '\n' are literals, 'a without a closing quote is a lifetime.
            '\'' if at(i + 1) == '\\' || at(i + 2) == '\'' => {
                i += if at(i + 1) == '\\' { 3 } else { 2 };
                while at(i) != '\'' {
                    i += 1;
                }
                i += 1;
            }
            c if word(c) => {
                while word(at(i)) || (at(i) == '.' && c.is_ascii_digit() && at(i + 1).is_ascii_digit()) {
                    i += 1;
                }
                found.push(Token { text: characters[start..i].iter().collect(), line, spaced });
            }
            c => {
                i += 1;
                if !c.is_whitespace() {
                    found.push(Token { text: c.to_string(), line, spaced });
                }
            }
        }
        spaced = at(start).is_whitespace() || at(start) == '/' && matches!(at(start + 1), '/' | '*');
        line += characters[start..i.min(characters.len())].iter().filter(|c| **c == '\n').count();
    }
    found
}
