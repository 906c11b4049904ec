//! Broken devices: one operator of the generated Verilog at a time is replaced, and the committed smoke set finds it and names the stage.

use std::fs;
use std::path::Path;
use std::process::Command;

use rayon::prelude::*;
use roughxel_host_tests::simulators::have;
use roughxel_host_tests::space::whole_or;
use roughxel_vectors::{Device, Testbench};

/// Fault of an operator.
#[derive(Clone, Copy, Debug)]
enum OperatorFault {
    /// A sum instead of a difference, or a 1 subtracted that rounding adds.
    Less,
    /// A difference instead of a sum.
    More,
    /// Swapped choices.
    Swapped,
    /// Zeros shifted into negative numbers.
    Logical,
    /// Equal counts as less.
    OrEqual,
    /// And instead of or: bits of both instead of those of either.
    Both,
}

impl OperatorFault {
    /// The operator and its replacement.
    const fn texts(self) -> (&'static str, &'static str) {
        match self {
            Self::Less => (" + ", " - "),
            Self::More => (" - ", " + "),
            Self::Swapped => (" ? ", " ? "),
            Self::Logical => (">>>", ">>"),
            Self::OrEqual => (" < ", " <= "),
            Self::Both => (" | ", " & "),
        }
    }

    /// The module with its operator `place` (from 0, below the ports) broken.
    fn applied_to(self, module: &str, place: usize) -> Option<String> {
        let (operator, instead) = self.texts();
        let ports = module.find(");\n")?;
        let (at, _) = module[ports..].match_indices(operator).nth(place)?;
        let (before, after) = module.split_at(ports + at);
        let after = after.strip_prefix(operator)?;
        if !matches!(self, Self::Swapped) {
            return Some(format!("{before}{instead}{after}"));
        }
        let (choice, rest) = after.split_once(";\n")?;
        let (first, second) = choice.split_once(" : ")?;
        Some(format!("{before}{instead}{second} : {first};\n{rest}"))
    }
}

/// Module, operator with its place, and the first later stage with a tap. A change of the Verilog may move a place to an operator that makes no
/// difference (a sign that is known, a limit that nothing reaches); choose a different place then.
const BROKEN: [(&str, OperatorFault, usize, &str); 42] = [
    ("enter_normal", OperatorFault::Less, 3, "frame"),
    ("enter_normal", OperatorFault::Both, 2, "frame"),
    ("enter_normal", OperatorFault::Swapped, 2, "frame"),
    ("enter_offset", OperatorFault::Less, 0, "perturb"),
    ("enter_offset", OperatorFault::Less, 1, "perturb"),
    ("frame", OperatorFault::Less, 49, "frame"),
    ("frame", OperatorFault::More, 11, "frame"),
    ("perturb", OperatorFault::Swapped, 4, "perturb"),
    ("perturb", OperatorFault::Logical, 2, "perturb"),
    ("perturb", OperatorFault::More, 3, "perturb"),
    ("roughness", OperatorFault::Both, 0, "columns"),
    ("roughness", OperatorFault::More, 1, "columns"),
    ("roughness", OperatorFault::Swapped, 2, "columns"),
    ("roughness", OperatorFault::Less, 4, "columns"),
    ("reflect", OperatorFault::Less, 4, "reflect"),
    ("reflect", OperatorFault::Swapped, 1, "reflect"),
    ("reflect", OperatorFault::More, 3, "reflect"),
    ("cube_face", OperatorFault::Less, 3, "cube_face"),
    ("cube_face", OperatorFault::Swapped, 8, "cube_face"),
    ("cube_face", OperatorFault::More, 1, "cube_face"),
    ("columns_pixel", OperatorFault::Swapped, 8, "columns"),
    ("columns_pixel", OperatorFault::More, 11, "columns"),
    ("columns_pixel", OperatorFault::Less, 5, "columns"),
    ("columns_roughness", OperatorFault::Both, 2, "columns"),
    ("columns_roughness", OperatorFault::Less, 15, "columns"),
    ("columns_roughness", OperatorFault::Swapped, 4, "columns"),
    ("ellipse", OperatorFault::Logical, 0, "ellipse"),
    ("ellipse", OperatorFault::Less, 3, "ellipse"),
    ("ellipse", OperatorFault::Swapped, 2, "ellipse"),
    ("ellipse", OperatorFault::Both, 6, "ellipse"),
    ("axes", OperatorFault::Swapped, 46, "axes"),
    ("axes", OperatorFault::Less, 5, "axes"),
    ("axes", OperatorFault::More, 20, "axes"),
    ("map_scale", OperatorFault::Swapped, 4, "probes"),
    ("probes", OperatorFault::Swapped, 18, "probes"),
    ("probes", OperatorFault::OrEqual, 6, "probes"),
    ("probes", OperatorFault::More, 0, "probes"),
    ("leave", OperatorFault::Swapped, 26, "ellipse"),
    ("leave", OperatorFault::Less, 1, "frame"),
    ("status", OperatorFault::Swapped, 1, "status"),
    ("status", OperatorFault::Both, 5, "status"),
    ("status", OperatorFault::Swapped, 2, "status"),
];

#[test]
fn the_smoke_set_finds_every_broken_copy_and_names_its_stage() {
    if !have("iverilog") {
        return;
    }
    let set = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/smoke/random_standard.json");
    let bench = Testbench::new(&set).expect("the committed set");
    let broken: Vec<_> = BROKEN.iter().step_by(whole_or(1, 6)).collect();
    broken.into_par_iter().for_each(|&(module, slip, place, stage)| {
        let directory = tempfile::tempdir().expect("a temporary directory");
        bench.write(directory.path(), Device::Generated, false).expect("the testbench can be written");
        let path = directory.path().join(format!("rtl/{module}.v"));
        let text = fs::read_to_string(&path).expect("the module");
        let copy = slip.applied_to(&text, place).unwrap_or_else(|| panic!("{module} has no operator {slip:?} {place}"));
        assert_ne!(copy, text);
        fs::write(&path, copy).expect("the module can be written");

        let run = Command::new("sh").arg(directory.path().join("run.sh")).args(["icarus", "--stop", "1"]).output();
        let output = run.expect("a shell");
        let text = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(3), "{module}, {slip:?} {place}: {text}");
        let first = text.lines().find(|line| line.starts_with("random_standard #")).unwrap_or_default();
        assert!(first.contains(&format!(": stage {stage}, field ")), "{module}, {slip:?} {place}: {first}");
    });
}
