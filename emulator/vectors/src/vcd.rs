//! One vector as a value change dump (IEEE 1364-2005, clause 18), which waveform viewers read.
//!
//! A scope is a stage, a variable a field with its width. A stage gets its values one time step after the stage before it, inputs
//! at 0, and holds them; before that its variables are x. If a word was compared, its field is next to the expected one with the
//! suffix `_got`, without the bits above its width. The file depends on the explanation alone: it has no date.

use std::fmt::Write;

use super::explain::{Explained, Explanation};
use super::field::mask;

/// The first and the last character of identifiers, which use all printable characters of ASCII.
const FIRST: u8 = b'!';
const LAST: u8 = b'~';

/// A variable of the dump.
struct Variable<'a> {
    stage: &'a str,
    name: String,
    width: u32,
    /// The bits, at most as many as the width.
    bits: u32,
}

/// The dump of a vector. The time scale of 1 ns is that of the steps, not a property of a device.
pub fn vcd(explanation: &Explanation) -> String {
    let Explanation { set, profile, datapath, index, fields, .. } = explanation;
    let variables: Vec<Variable<'_>> = fields.iter().flat_map(variables).collect();
    // The fields of a stage are adjacent, in the order of the pipeline.
    let stages: Vec<&[Variable<'_>]> = variables.chunk_by(|a, b| a.stage == b.stage).collect();

    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "$version roughxel {} $end", env!("CARGO_PKG_VERSION"));
    let _ = writeln!(text, "$comment {set} #{index}: {datapath}, profile {profile}; a time step is a stage $end");
    let _ = writeln!(text, "$timescale 1 ns $end");
    let _ = writeln!(text, "$scope module {set}_{index} $end");
    let mut number = 0;
    for stage in &stages {
        let _ = writeln!(text, "$scope module {} $end", stage[0].stage);
        for Variable { name, width, .. } in *stage {
            let range = if *width > 1 { format!(" [{}:0]", width - 1) } else { String::new() };
            let _ = writeln!(text, "$var wire {width} {} {name}{range} $end", identifier(number));
            number += 1;
        }
        text.push_str("$upscope $end\n");
    }
    text.push_str("$upscope $end\n$enddefinitions $end\n");

    text.push_str("$dumpvars\n");
    for (number, variable) in variables.iter().enumerate() {
        change(&mut text, variable.width, "x", number);
    }
    text.push_str("$end\n");
    let mut number = 0;
    for (time, stage) in stages.iter().enumerate() {
        let _ = writeln!(text, "#{time}");
        for variable in *stage {
            change(&mut text, variable.width, &format!("{:b}", variable.bits), number);
            number += 1;
        }
    }
    // The last stage is visible for as long as the others.
    let _ = writeln!(text, "#{}", stages.len());
    text
}

/// A field, and its value in a compared word.
fn variables(field: &Explained) -> impl Iterator<Item = Variable<'_>> {
    let Explained { stage, field: name, width, .. } = field;
    let variable = |name: String, bits: i64| Variable { stage, name, width: *width, bits: bits as u32 & mask(*width) };
    let got = field.got.as_ref().map(|got| variable(format!("{name}_got"), got.integer));
    [variable(name.clone(), field.integer)].into_iter().chain(got)
}

/// A line that sets a variable. A value shorter than the width is extended on the left: with zeros, an x with further x.
fn change(text: &mut String, width: u32, value: &str, number: usize) {
    let (prefix, space) = if width > 1 { ("b", " ") } else { ("", "") };
    let _ = writeln!(text, "{prefix}{value}{space}{}", identifier(number));
}

/// The identifier of a variable, unique among those of other numbers.
fn identifier(mut number: usize) -> String {
    let base = usize::from(LAST - FIRST) + 1;
    let mut text = String::new();
    loop {
        text.push(char::from(FIRST + (number % base) as u8));
        number /= base;
        if number == 0 {
            return text;
        }
        number -= 1;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn identifiers_are_printable_and_unique() {
        let all: HashSet<String> = (0..20_000).map(identifier).collect();
        assert_eq!(all.len(), 20_000);
        assert!(all.iter().all(|id| id.len() <= 3 && id.bytes().all(|c| (FIRST..=LAST).contains(&c))));
    }
}
