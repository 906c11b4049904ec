//! The test for cocotb, and a reader of sets for any testbench in Python.

use super::fields::{Fields, lines};

/// The texts, with the name of each file.
pub(super) const TEMPLATES: [(&str, &str); 2] = [
    ("test_@NAME@.py", include_str!("../../../../vectors/templates/cocotb/test.py")),
    ("roughxel_vectors.py", include_str!("../../../../vectors/templates/cocotb/roughxel_vectors.py")),
];

/// Values for the places in the templates.
pub(super) fn values(Fields { outputs, .. }: &Fields) -> Vec<(&'static str, String)> {
    vec![("PYTHON_OUTPUTS", lines(outputs, |field| field.name.clone()))]
}
