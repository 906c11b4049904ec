//! `MODULE_shell.v`: registers on AXI4-Lite around the streams.

use super::super::format::vector;
use super::super::text::{filled, header};
use super::super::value::literal;
use super::description::{Shell, padded, slice};
use super::register::{ADDRESS_BITS, Access, Register, TAKE};

/// Number of a register's word as an address in Verilog.
fn address(offset: u32) -> String {
    literal((offset / 4).into(), ADDRESS_BITS - 2)
}

/// Wire of a register's value.
fn value(register: &Register) -> String {
    format!("value_{}", register.name)
}

/// Declarations and writes of the constants, and of the take.
fn written(shell: &Shell) -> String {
    let constants: Vec<&Register> = shell.registers.iter().filter(|register| register.port.is_some()).collect();
    if constants.is_empty() {
        return String::new();
    }
    let mut declared = "\n  // ---- registers: written values wait for the take ----\n".to_owned();
    let (mut resets, mut writes) = (String::new(), String::new());
    for register in constants {
        let (name, width) = (value(register), register.width);
        declared += &format!("  reg {}{name};\n", vector(width, false));
        resets += &format!("      {name} <= {};\n", literal(register.reset.into(), width));
        let [mask, data] = ["mask", "data"].map(|vector| slice(vector, 0, width));
        let at = address(register.offset);
        writes += &format!("      if (address == {at}) {name} <= ({name} & ~{mask}) | ({data} & {mask});\n");
    }
    declared
        + &format!(
            "  reg pending;
  wire constants_taken;
  always @(posedge aclk) begin
    if (!aresetn) begin
{resets}    end else if (write) begin
{writes}    end
    if (!aresetn) pending <= 1'b0;
    else if (write & address == {} & mask[0] & data[0]) pending <= 1'b1;
    else if (constants_taken) pending <= 1'b0;
  end
",
            address(TAKE)
        )
}

/// Cases of a read.
fn reads(shell: &Shell) -> String {
    let mut text = String::new();
    for register in &shell.registers {
        let own = match (&register.port, register.offset) {
            (Some(_), _) => value(register),
            (None, TAKE) => "pending".to_owned(),
            (None, _) => literal(register.reset.into(), 32),
        };
        let extended = if register.signed && register.width < 32 {
            let sign = slice(&own, register.width - 1, 1);
            format!("{{{{{}{{{sign}}}}}, {own}}}", 32 - register.width)
        } else {
            padded(&own, register.width, 32)
        };
        text += &format!("        {}: r_data <= {extended};\n", address(register.offset));
    }
    text
}

/// Text of the module.
pub(super) fn text(shell: &Shell) -> String {
    let can_write: Vec<String> = shell
        .registers
        .iter()
        .filter(|register| register.access == Access::ReadWrite)
        .map(|register| format!("address == {}", address(register.offset)))
        .collect();
    let constants = shell.registers.iter().filter_map(|register| Some((register.port.as_ref()?, value(register))));
    let ports: String = constants.map(|(port, value)| format!(",\n    .{port}({value})")).collect();
    let take = ",\n    .constants_valid(pending), .constants_taken(constants_taken)";
    let values = [
        ("NAME", shell.module.clone()),
        ("AXIS", shell.axis.clone()),
        ("WIDTH", shell.stream_bits.to_string()),
        ("ADDRESS_BITS", ADDRESS_BITS.to_string()),
        ("CAN_WRITE", if can_write.is_empty() { "1'b0".to_owned() } else { can_write.join(" | ") }),
        ("REGISTERS", written(shell)),
        ("READS", reads(shell)),
        ("CONNECTIONS", if ports.is_empty() { ports } else { take.to_owned() + &ports }),
    ];
    let about = [
        format!("AXI4-Lite registers for the constants of {}, around its streams.", shell.design.module),
        shell.origin.clone(),
        format!("{}_registers.md lists the registers.", shell.design.module),
    ];
    header(&shell.module, &about) + &filled(include_str!("../templates/shell.v"), &values)
}
