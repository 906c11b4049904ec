#!/usr/bin/env bash
# micromath's trunc changes whole numbers from 2^32 on.
#
# Expected: F32::trunc "returns the integer part"; every f32 from 2^23 on is
#   whole, so trunc returns it unchanged and fract is 0. The crate is known for
#   approximations of sqrt or sin, but trunc is done on bits and is exact below.
# Seen: the shift that isolates the fraction wraps round at 32. From 2^32 on the
#   mantissa is taken for a fraction: trunc(6442450944) is 4294967296, one third
#   too small, and fract of that whole number is 0.5. The error comes and goes
#   with the exponent. floor, ceil and round of the same crate fail otherwise:
#   they stop at 2147483648. Each of the four gives a finite number, in debug
#   and release builds alike.
# Versions: micromath 2.1.0.
# Why it matters: soft cores without an FPU use it for set-up mathematics.
#   Products of two 16.16 numbers that are held as raw f32 pass 2^32 easily.
# Source: the crate's documentation of F32::trunc and F32::fract names no range;
#   its own test of trunc goes to 10^8.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
mkdir -p "$T/src"
cd "$T"
cat > Cargo.toml <<'TOML'
[package]
name = "trunc"
version = "0.1.0"
edition = "2021"
[dependencies]
micromath = "=2.1.0"
[workspace]
TOML
cat > src/main.rs <<'RS'
use micromath::F32;

fn main() {
    let mut changed = Vec::new();
    for x in [3e9f32, 4294967296.0, 6442450944.0, 1e10, 1e12, 1e20] {
        let m = F32(x);
        println!(
            "{:>21}: trunc {:>21}, fract {:<10}, floor {:>10} (std: trunc {:>21}, fract {})",
            x as f64, m.trunc().0 as f64, m.fract().0, m.floor().0 as f64, x.trunc() as f64, x.fract()
        );
    }
    // Share of changed values for each exponent, over 1024 mantissas.
    for e in 23..64u32 {
        let n = (0..1024u32).filter(|k| {
            let x = f32::from_bits((e + 127) << 23 | k << 13 | 1);
            F32(x).trunc().0 != x
        }).count();
        changed.push(n);
    }
    println!("changed of 1024, exponents 23 to 63: {changed:?}");
    let below = changed[..9].iter().all(|&n| n == 0);
    let above = changed[9..].iter().filter(|&&n| n > 0).count();
    let ok = F32(6442450944.0).trunc().0 == 4294967296.0
        && F32(6442450944.0).fract().0 == 0.5
        && F32(3e9).floor().0 == 2147483648.0
        && below && above >= 20;
    if !ok {
        eprintln!("behaviour changed: trunc, fract or floor of large numbers differ from what was seen");
        std::process::exit(1);
    }
}
RS
export CARGO_TARGET_DIR="$T/target"
nice cargo run -q
nice cargo run -q --release
echo "as described"
