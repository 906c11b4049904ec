//! Statements that a tool breaks: the generated text has none of them.

use std::collections::BTreeSet;

use roughxel_core::design::Design;
use roughxel_record as record;

use super::rtl::FULL;
use super::shell::shell_options;

/// Statements between `begin` and `end`, and the registers that they have assigned so far.
#[derive(Default)]
struct Block<'a> {
    indent: usize,
    is_conditional: bool,
    /// Registers of statements of the block itself.
    own: BTreeSet<&'a str>,
    /// Registers of statements within those.
    within: BTreeSet<&'a str>,
}

/// Registers that a conditional block assigns after one of its inner conditions has, and not before it.
fn later_assignments(text: &str) -> Vec<&str> {
    let (mut blocks, mut found) = (vec![Block::default()], Vec::new());
    for line in text.lines() {
        let (code, indent) = (line.trim(), line.len() - line.trim_start().len());
        while let Some(block) = blocks.pop_if(|block| block.indent >= indent && indent > 0) {
            if let Some(outer) = blocks.last_mut() {
                outer.within.extend(block.own.into_iter().chain(block.within));
            }
        }
        if let (Some((left, _)), Some(block)) = (code.split_once(" <= "), blocks.last_mut()) {
            let assigned = left.rsplit(' ').next().unwrap_or_default();
            let register = assigned.split('[').next().unwrap_or_default();
            if left.contains(' ') {
                block.within.insert(register);
            } else {
                if block.is_conditional && block.within.contains(register) && !block.own.contains(register) {
                    found.push(register);
                }
                block.own.insert(register);
            }
        }
        if code.ends_with("begin") || code.starts_with("case") {
            blocks.push(Block { indent, is_conditional: !code.starts_with("always"), ..Block::default() });
        }
    }
    found
}

/// Yosys 0.64 to 0.70 loses the second assignment of `if (a) begin if (b) r <= x; r <= y; end` (`findings/yosys_later_assignment_lost.sh`).
#[test]
fn no_assignment_follows_a_condition_on_its_register_inside_another_condition() {
    let nested =
        "  always @(posedge clk) begin\n    if (a) begin\n      if (b) r[3:0] <= x;\n      r <= y;\n    end\n  end\n";
    assert_eq!(later_assignments(nested), ["r"]);
    assert_eq!(later_assignments(&nested.replace("if (a) begin", "case (a)\n      2'd1: begin")), ["r"]);
    assert!(later_assignments(&nested.replace("if (a) begin", "begin : always_").replace("if (b) r", "s")).is_empty());
    assert!(later_assignments("  always @(posedge clk) begin\n    if (b) r <= x;\n    r <= y;\n  end\n").is_empty());
    let options = [Some(8), None].map(|multipliers| shell_options("narrow", FULL, multipliers, 32));
    for options in options {
        let verilog = record::verilog(Design::Reflection, &options).expect("the design is proven");
        let mut assignments = 0;
        for (name, text) in verilog.in_order() {
            assert_eq!(later_assignments(text), Vec::<&str>::new(), "{name}");
            assignments += text.matches(" <= ").count();
        }
        assert!(assignments > 150, "{assignments}");
    }
}
