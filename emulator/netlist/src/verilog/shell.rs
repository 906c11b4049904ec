//! The shell: a design of hundreds of ports behind two AXI4-Streams and AXI4-Lite registers, and the files by which tools take it.
//!
//! A fragment is a packet of words, its lowest bits first, with its ports packed in their order, the first one most significant. Constants of an
//! object ([`PortDescription::constant`](super::PortDescription::constant)) are no part of it: they are in registers, and a fragment takes them with its last word.

mod axis;
mod bfm;
mod description;
mod ip_xact;
mod litex;
mod project;
mod register;
mod registers;
mod tables;

use std::collections::BTreeMap;

pub use description::{STREAM_BITS, Shell};
pub use register::{Access, Register};

/// Python module that packs ports into words of any shell, from its manifest.
const PYTHON: (&str, &str) =
    ("roughxel_shell.py", include_str!("../../../../vectors/templates/shell/roughxel_shell.py"));

/// Modules of the shell, name and text, without their tools' files.
pub(super) fn modules(shell: &Shell) -> [(String, String); 3] {
    [
        (format!("{}.v", shell.axis), axis::text(shell)),
        (format!("{}.v", shell.module), registers::text(shell)),
        (format!("{}.v", shell.bfm), bfm::text(shell)),
    ]
}

/// Files by which tools take the shell, name and text. `verilog` are the files of the design and the modules of the shell.
pub(super) fn tool_files(shell: &Shell, verilog: &BTreeMap<String, String>) -> Vec<(String, String)> {
    let is_source = |file: &&str| file.ends_with(".v") && !file.ends_with("_bfm.v");
    let sources: Vec<&str> = verilog.keys().map(String::as_str).filter(is_source).collect();
    let design = &shell.design.module;
    let mut files = vec![
        (format!("{design}_registers.h"), tables::c_header(shell)),
        (format!("{design}_registers.md"), tables::markdown(shell)),
        (format!("{design}_litex.py"), litex::text(shell, &sources)),
        (format!("{design}.core"), project::core(shell, &sources)),
        (format!("{design}.xml"), ip_xact::text(shell, &sources)),
        (PYTHON.0.to_owned(), PYTHON.1.to_owned()),
    ];
    files.extend(project::constraints(shell));
    files
}
