//! Order of declarations in Verilog. A name that is used above its declaration is an error in Icarus 13 and in slang; Icarus 11, Verilator and Yosys
//! accept it.

use std::collections::HashMap;

use crate::tokens::{Token, tokens};

/// Words that begin a declaration of names.
const KINDS: [&str; 18] = [
    "wire",
    "reg",
    "logic",
    "bit",
    "byte",
    "shortint",
    "int",
    "longint",
    "integer",
    "genvar",
    "real",
    "time",
    "localparam",
    "parameter",
    "input",
    "output",
    "inout",
    "string",
];
/// Words between the first one and the name.
const QUALIFIERS: [&str; 4] = ["signed", "unsigned", "automatic", "var"];

/// Uses of a name above its declaration in the same module, as line and name; of each name the first.
pub fn used_before_declared(verilog: &str) -> Vec<(usize, String)> {
    let tokens = tokens(verilog);
    tokens.split(|token| token.text == "endmodule").flat_map(of_module).collect()
}

fn of_module(tokens: &[Token]) -> Vec<(usize, String)> {
    let declared = declared(tokens);
    let mut seen = HashMap::new();
    for (index, token) in tokens.iter().enumerate() {
        // Behind a point it is a port or a part of something, behind an apostrophe the digits of a number, behind `@` a place of a template.
        let before = index.checked_sub(1).map_or("", |before| &tokens[before].text);
        if !matches!(before, "." | "'" | "`" | "@") {
            seen.entry(token.text.as_str()).or_insert(index);
        }
    }
    let mut early: Vec<usize> =
        declared.iter().filter_map(|(name, at)| seen.get(name).copied().filter(|first| first < at)).collect();
    early.sort_unstable();
    early.into_iter().map(|index| (tokens[index].line, tokens[index].text.clone())).collect()
}

/// True for a word that begins a declaration. Types of testbenches end with `_t`.
fn is_kind(word: &str) -> bool {
    KINDS.contains(&word) || word.ends_with("_t")
}

/// True for a word that is not part of a declaration's kind.
fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_') && !is_kind(word) && !QUALIFIERS.contains(&word)
}

/// Names with the token of their first declaration.
fn declared(tokens: &[Token]) -> HashMap<&str, usize> {
    let text = |index: usize| tokens.get(index).map_or("", |token| token.text.as_str());
    let mut declared = HashMap::new();
    let mut index = 0;
    while index < tokens.len() {
        if !is_kind(text(index)) {
            index += 1;
            continue;
        }
        // Names stand at depth 0, the first one behind the kind and its range, the next ones behind commas.
        let (mut depth, mut is_next) = (0, true);
        index += 1;
        while index < tokens.len() {
            match text(index) {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" if depth > 0 => depth -= 1,
                ";" | ")" => break,
                "," if depth == 0 => is_next = true,
                // In front of another word, or of a part of its package, a word is a type.
                word if depth == 0
                    && is_next
                    && is_name(word)
                    && text(index + 1) != ":"
                    && !is_name(text(index + 1)) =>
                {
                    declared.entry(word).or_insert(index);
                    is_next = false;
                }
                _ => {}
            }
            index += 1;
        }
    }
    declared
}
