//! `MODULE_litex.py`: the streams in LiteX, with a CSR for each constant.

use std::fmt::Write as _;

use super::super::interface::PortDescription;
use super::super::text::filled;
use super::description::Shell;
use super::register::Register;

/// Name of a class: `roughxel_fragment` is `RoughxelFragment`.
fn class(module: &str) -> String {
    let capital = |part: &str| part[..1].to_ascii_uppercase() + &part[1..];
    module.split('_').filter(|part| !part.is_empty()).map(capital).collect()
}

/// Lines of a Python list of strings.
fn list(files: &[&str]) -> String {
    files.iter().map(|file| format!("    \"{file}\",\n")).collect()
}

/// Text of the module. `sources` are its Verilog files.
pub(super) fn text(shell: &Shell, sources: &[&str]) -> String {
    let constants: Vec<(&Register, &PortDescription)> = shell
        .registers
        .iter()
        .filter_map(|register| {
            let port = register.port.as_ref()?;
            Some((register, shell.design.inputs.iter().find(|input| input.port == *port)?))
        })
        .collect();
    let (mut csrs, mut ports) = (String::new(), String::new());
    for (register, port) in &constants {
        let Register { name, width, reset, description, .. } = register;
        // Writing to a string cannot fail.
        let _ = writeln!(
            csrs,
            "        self.{name} = CSRStorage({width}, reset=0x{reset:x}, description={:?})",
            format!("{description}, {}.", port.format)
        );
        let _ = writeln!(ports, "            i_{}=self.{name}.storage,", port.port);
    }
    if !constants.is_empty() {
        csrs += include_str!("../templates/litex_take.py");
        ports += "            i_constants_valid=self.pending.status,\n            o_constants_taken=taken,\n";
    }
    let values = [
        ("MODULE", shell.design.module.clone()),
        ("ORIGIN", shell.origin.clone()),
        ("CLASS", class(&shell.design.module)),
        ("WIDTH", shell.stream_bits.to_string()),
        ("PACKETS", shell.packets()),
        ("AXIS", shell.axis.clone()),
        ("CSRS", csrs),
        ("PORTS", ports),
        ("SOURCES", list(sources)),
    ];
    filled(include_str!("../templates/litex.py"), &values)
}
