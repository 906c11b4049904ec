//! C library: every committed vector through it, in C and in C++, and its errors.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use roughxel_host_tests::simulators::have;
use roughxel_vectors::{Device, Direction, Field, Manifest, Testbench, c_library_files, manifests_in};

use super::benches::run_bench;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The line of vectors/README.md that begins with this word.
fn line_of_the_page(word: &str) -> String {
    let page = fs::read_to_string(root().join("vectors/README.md")).expect("the page");
    let line = page.lines().find_map(|line| line.strip_prefix(word));
    line.unwrap_or_else(|| panic!("the page has a line with {word}")).to_owned()
}

/// The static library, built once by the command of vectors/README.md.
static LIBRARY: LazyLock<PathBuf> = LazyLock::new(|| {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let line = line_of_the_page("cargo ");
    let built = Command::new(cargo).args(line.split_whitespace()).current_dir(root()).output().expect("cargo runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    root().join("target/c-library/c-library/libroughxel_c.a")
});

/// The compiled harness.
fn harness(compiler: &str, standard: &str, directory: &Path) -> PathBuf {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hardware/c_library/harness.c");
    compiled(&source, compiler, standard, &directory.join(format!("harness_{compiler}")))
}

/// A source compiled with the library.
fn compiled(source: &Path, compiler: &str, standard: &str, program: &Path) -> PathBuf {
    let language = if compiler == "cc" { "c" } else { "c++" };
    let output = Command::new(compiler)
        .args([standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-x", language])
        .arg(source)
        .args(["-x", "none", "-I"])
        .arg(root().join("vectors/c"))
        .arg(&*LIBRARY)
        .arg("-o")
        .arg(program)
        .output()
        .expect("the compiler runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    program.into()
}

/// Output of the harness for these lines.
fn run(program: &Path, arguments: &[&str], lines: &str) -> Vec<String> {
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the harness runs");
    let mut input = child.stdin.take().expect("the harness has an input");
    let lines = lines.to_owned();
    let feeding = std::thread::spawn(move || input.write_all(lines.as_bytes()));
    let output = child.wait_with_output().expect("the harness ends");
    feeding.join().expect("no panic").expect("the harness reads");
    assert!(output.status.success());
    String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect()
}

/// The number of a field in a word's digits.
fn number(field: &Field, digits: &str) -> i64 {
    let end = digits.len() - field.lsb as usize / 4;
    let bits = i64::from_str_radix(&digits[end - field.width.div_ceil(4) as usize..end], 16).expect("hex digits");
    let spare = 64 - field.width;
    if field.signed { bits << spare >> spare } else { bits }
}

/// The bits of the effects of a manifest.
fn effects(manifest: &Manifest) -> String {
    roughxel_c::bits_of(&manifest.effects).to_string()
}

#[test]
fn every_committed_vector_is_what_the_library_computes() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let compilers = [("cc", "-std=c99"), ("c++", "-std=c++11")];
    let programs: Vec<PathBuf> = compilers
        .into_iter()
        .filter(|(compiler, _)| have(compiler))
        .map(|(compiler, standard)| harness(compiler, standard, directory.path()))
        .collect();
    let Some(program) = programs.first() else { return };
    for path in manifests_in(&root().join("vectors/smoke")).expect("the committed sets") {
        let manifest = Manifest::read(&path).expect("a manifest");
        let names = run(program, &["--names", manifest.datapath.name()], "");
        let (inputs, outputs) = names.split_at(names.iter().position(|name| name == "-").expect("both structures"));
        let of = |name: &str| manifest.fields.iter().find(|field| field.name == name);
        let text = fs::read_to_string(path.with_extension("hex")).expect("the words");
        let words: Vec<String> =
            text.lines().filter(|line| !line.starts_with("//")).map(|line| line.replace('_', "")).collect();
        let given = |word: &String| -> String {
            let numbers = inputs.iter().map(|name| of(name).map_or(0, |field| number(field, word)).to_string());
            numbers.collect::<Vec<_>>().join(" ") + "\n"
        };
        let lines: String = words.iter().map(given).collect();
        // The structures contain every field of the set.
        let unknown =
            manifest.fields.iter().find(|field| field.direction != Direction::Check && !names.contains(&field.name));
        assert!(unknown.is_none(), "{unknown:?}");
        for program in &programs {
            let made = run(program, &[manifest.datapath.name(), &manifest.profile.name, &effects(&manifest)], &lines);
            assert_eq!(made.len(), words.len(), "{}", path.display());
            for (index, (made, word)) in made.iter().zip(&words).enumerate() {
                for (name, made) in outputs[1..].iter().zip(made.split_whitespace()) {
                    let Some(field) = of(name) else { continue };
                    assert_eq!(made, number(field, word).to_string(), "{} #{index}: {name}", path.display());
                }
            }
        }
    }
}

#[test]
fn what_is_out_of_its_range_is_an_error_with_its_place() {
    if !have("cc") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let program = harness("cc", "-std=c99", directory.path());
    let names = run(&program, &["--names", "peak"], "");
    let inputs = names.iter().position(|name| name == "-").expect("both structures");
    // The last field, a weight, may be any number.
    for wrong in [0, 3, inputs - 2] {
        let line: Vec<String> =
            (0..inputs).map(|place| if place == wrong { i32::MAX } else { 0 }.to_string()).collect();
        let made = run(&program, &["peak", "compact", "0"], &(line.join(" ") + "\n"));
        assert_eq!(made, [format!("error {} {wrong}", roughxel_c::ERROR_INPUT)]);
    }
    let zeros = vec!["0"; inputs].join(" ") + "\n";
    assert_eq!(run(&program, &["peak", "compact", "192"], &zeros), [format!("error {} 0", roughxel_c::ERROR_EFFECTS)]);
}

#[test]
fn the_example_computes_a_reflection() {
    if !have("cc") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let program = compiled(&root().join("vectors/c/example.c"), "cc", "-std=c99", &directory.path().join("example"));
    let lines = run(&program, &["1"], "");
    assert_eq!(lines[0], "reflected (-262144, 0, 524288) * 2^1 / 2^20");

    // The command of the page, with its program in the temporary directory.
    let program = directory.path().join("by_the_page");
    let line = line_of_the_page("cc ").replace("-o example && ./example", "-o \"$0\" && \"$0\" 1");
    let output = Command::new("sh").arg("-c").arg(format!("cc {line}")).arg(&program).current_dir(root()).output();
    let output = output.expect("a shell runs");
    assert!(output.status.success() && program.is_file(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).starts_with(&lines[0]), "{output:?}");
}

/// The archive's own part, without the compiler's run-time library: a library that is linked into firmware cannot end the program.
#[test]
fn no_path_of_the_library_leads_to_a_panic() {
    if !have("nm") {
        return;
    }
    let output = Command::new("nm").arg("--undefined-only").arg(&*LIBRARY).output().expect("nm runs");
    let symbols = String::from_utf8_lossy(&output.stdout);
    let own: Vec<&str> = symbols.split("\n\n").filter(|part| part.contains("roughxel_c")).collect();
    assert!(!own.is_empty(), "{symbols}");
    assert!(own.iter().all(|part| !part.contains("panic")), "{own:?}");
}

/// A testbench of a small peak, and its run with the C library: exit code and output.
fn random_inputs(directory: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    run_bench(directory, &[&["dpi"], arguments].concat())
}

#[test]
fn the_generated_verilog_is_the_library_on_random_inputs_and_a_broken_device_is_named() {
    if !have("verilator") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let bench = Testbench::new(&root().join("vectors/smoke/random_peak_compact.json")).expect("a set");
    bench.write(directory.path(), Device::Generated, false).expect("a testbench");
    let (code, text) = random_inputs(directory.path(), &[]);
    assert!(code == Some(1) && text.contains("libroughxel_c.a is not there"), "{text}");
    let library = LIBRARY.to_str().expect("a path");
    let (code, text) = random_inputs(directory.path(), &["--library", library, "--count", "20000", "--stalls"]);
    assert!(code == Some(0) && text.contains("PASS random_peak_compact: 20000 random inputs of seed 1"), "{text}");
    let (code, text) =
        random_inputs(directory.path(), &["--library", library, "--count", "20000", "--seed", "7", "--built"]);
    assert!(code == Some(0) && text.contains("of seed 7"), "{text}");

    let path = directory.path().join("rtl/horizon_slopes.v");
    let good = fs::read_to_string(&path).expect("the module");
    let broken = good.replacen(" + 19'd1", " + 19'd2", 1);
    assert_ne!(broken, good);
    fs::write(&path, broken).expect("the module can be written");
    let (code, text) = random_inputs(directory.path(), &["--library", library, "--stop", "2"]);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.contains(": stage horizon, field slopes_") && text.contains(" of seed 1: inputs normal_x="), "{text}");
    assert!(text.contains("FAIL random_peak_compact: 2 of ") && text.contains("stopped there"), "{text}");
}

#[test]
fn the_header_and_the_package_are_what_the_declarations_say() {
    for (name, text) in c_library_files() {
        let committed = fs::read(root().join("vectors/c").join(name)).expect("the committed file");
        assert!(committed == text.as_bytes(), "{name}: run `roughxel vectors c -o vectors/c`");
    }
}
