//! Records the compiler's version for the description of a machine.

use std::env;
use std::process::Command;

fn main() {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version = Command::new(rustc).arg("--version").output();
    let version = version.ok().and_then(|output| String::from_utf8(output.stdout).ok()).unwrap_or_default();
    println!("cargo:rustc-env=ROUGHXEL_RUSTC={}", version.trim());
    println!("cargo:rerun-if-changed=build.rs");
}
