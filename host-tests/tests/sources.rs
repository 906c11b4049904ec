//! Rules for the source of the datapath: integers only, no division, no panic path, stages that do not know each other, one file that names
//! `fixed`, an algebra that fits a screen. A frame leaves all arithmetic to the datapath.
//!
//! Two witnesses: the tokens of `core/src` (comments and strings do not count), and the machine code of the scalar backend, in which a panic, a
//! division or a float would show, whatever the source looks like.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use roughxel_host_tests::tokens::{Token, tokens};

fn core_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../core")
}

/// Every source file of the core by its path under `src`, with its tokens, in order of names.
fn core_files() -> Vec<(String, String, Vec<Token>)> {
    files_below(&core_root().join("src"))
}

/// Every source file below a folder by its path from that folder, with its tokens, in order of names.
fn files_below(root: &Path) -> Vec<(String, String, Vec<Token>)> {
    let mut names = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder has sources") {
            let path = entry.expect("a folder can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                names.push(path);
            }
        }
    }
    names.sort();
    let name = |path: &Path| path.strip_prefix(root).expect("below the folder").to_string_lossy().replace('\\', "/");
    names
        .iter()
        .map(|path| {
            let source = fs::read_to_string(path).expect("sources are text");
            let tokens = tokens(&source);
            (name(path), source, tokens)
        })
        .collect()
}

/// The datapath: everything except the floating-point set-up, which is a separate feature and never called by the datapath.
fn datapath_files() -> Vec<(String, String, Vec<Token>)> {
    core_files().into_iter().filter(|(name, _, _)| name != "setup.rs").collect()
}

/// The last `fn`, `static` or `const` item before a token: (`const fn`, name) and so on.
fn enclosing_item(tokens: &[Token], index: usize) -> (&'static str, &str) {
    let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
    // `const N` inside angle brackets is a parameter, `const fn` the function after it.
    let starts = |i: usize| match text(i) {
        "fn" if i > 0 && text(i - 1) == "const" => Some("const fn"),
        "fn" => Some("fn"),
        "static" if i == 0 || text(i - 1) != "'" => Some("static"),
        "const" if text(i + 1) != "fn" && !matches!(text(i.wrapping_sub(1)), "<" | ",") => Some("const"),
        _ => None,
    };
    (0..index).rev().find_map(|i| starts(i).map(|kind| (kind, text(i + 1)))).unwrap_or(("", ""))
}

#[test]
fn the_tokeniser_sees_code_and_nothing_else() {
    let source = "a / b // c / d\n/* e /* % */ f64 */ \"g / \\\" h\" 'x' '\\'' '/' &'a i 1.5 0..3 x.0";
    let texts: Vec<String> = tokens(source).into_iter().map(|token| token.text).collect();
    assert_eq!(texts, ["a", "/", "b", "&", "'", "a", "i", "1.5", "0", ".", ".", "3", "x", ".", "0"]);
    assert_eq!(tokens("a\n/* \n */ b")[1].line, 3);
    let items = tokens("const fn f<const N: usize>() { a } static T: &'static [i32] = b; fn g() { c }");
    let index = |name: &str| items.iter().position(|token| token.text == name).expect("the token exists");
    assert_eq!(enclosing_item(&items, index("a")), ("const fn", "f"));
    assert_eq!(enclosing_item(&items, index("b")), ("static", "T"));
    assert_eq!(enclosing_item(&items, index("c")), ("fn", "g"));
}

#[test]
fn datapath_names_no_float() {
    for (name, _, tokens) in datapath_files() {
        for token in tokens {
            let literal = token.text.starts_with(|c: char| c.is_ascii_digit()) && token.text.contains('.');
            let named = matches!(token.text.as_str(), "f32" | "f64" | "f16" | "f128" | "glam" | "libm");
            // lib.rs declares the set-up module, which contains glam.
            assert!(!literal && !named, "{name}:{}: {}", token.line, token.text);
        }
    }
}

/// Allowed divisions outside of the datapath's arithmetic: file, item, reason.
const DIVISIONS: [(&str, &str, &str); 2] = [
    ("rom.rs", "", "generators of tables, evaluated at compile time"),
    ("scalar_api.rs", "texture_scale", "set-up once per map, by a number that cannot be zero"),
];

#[test]
fn datapath_divides_nowhere() {
    let mut used = [false; DIVISIONS.len()];
    for (name, _, tokens) in datapath_files() {
        for (index, token) in tokens.iter().enumerate() {
            let operator = matches!(token.text.as_str(), "/" | "%");
            let method = ["div_", "rem_", "checked_div", "checked_rem", "wrapping_div", "wrapping_rem"]
                .iter()
                .any(|prefix| token.text.starts_with(prefix));
            if !operator && !method {
                continue;
            }
            let (kind, item) = enclosing_item(&tokens, index);
            let allowed = DIVISIONS
                .iter()
                .position(|(file, allowed, _)| *file == name && (allowed.is_empty() || *allowed == item));
            let Some(allowed) = allowed else { panic!("{name}:{}: {} in {item}", token.line, token.text) };
            used[allowed] = true;
            assert!(name != "rom.rs" || kind != "fn", "{name}:{}: {item} divides at run time", token.line);
        }
    }
    for (used, (file, item, reason)) in used.into_iter().zip(DIVISIONS) {
        assert!(used, "{file} {item} ({reason}) no longer divides: remove it from the list");
    }
}

#[test]
fn datapath_has_no_panicking_call() {
    for (name, _, tokens) in datapath_files() {
        for (index, token) in tokens.iter().enumerate() {
            let before = |n: usize| index.checked_sub(n).map_or("", |i| tokens[i].text.as_str());
            let after = tokens.get(index + 1).map_or("", |token| token.text.as_str());
            let method = before(1) == "." && matches!(token.text.as_str(), "unwrap" | "expect" | "unwrap_err");
            let panics = matches!(
                token.text.as_str(),
                "panic"
                    | "assert"
                    | "assert_eq"
                    | "assert_ne"
                    | "debug_assert"
                    | "todo"
                    | "unimplemented"
                    | "unreachable"
            ) && after == "!";
            // `const { assert!(…) }` fails to compile rather than to run.
            let compile_time = before(1) == "{" && before(2) == "const";
            assert!(!method && (!panics || compile_time), "{name}:{}: {}", token.line, token.text);
        }
    }
}

#[test]
fn stages_do_not_import_each_other() {
    for (name, _, tokens) in core_files() {
        if !name.starts_with("stage/") {
            continue;
        }
        for window in tokens.windows(2) {
            let named = |text: &str| window[0].text == text && window[1].text == ":";
            assert!(!named("super"), "{name}:{}: a stage uses a different stage", window[0].line);
            assert!(!named("stage"), "{name}:{}: a stage imports a different stage", window[0].line);
            // Ports are declarations, which stages may use; the functions that run a datapath on ports are in a higher layer.
            for above in ["datapath", "design", "scalar_api", "probe_list", "staged"] {
                assert!(!named(above), "{name}:{}: a stage imports {above}", window[0].line);
            }
            assert!(!named("scalar"), "{name}:{}: a stage knows its backend", window[0].line);
        }
    }
}

/// A named closure and the closure of a fold are separate functions. They are compiled for the lanes' instruction set only if they are inlined.
#[test]
fn stages_name_no_closures_and_fold_no_iterators() {
    let mut found = Vec::new();
    for (name, _, tokens) in datapath_files().iter().filter(|(name, ..)| name.starts_with("stage/")) {
        let text = |i: usize| tokens.get(i).map_or("", |token: &Token| token.text.as_str());
        for (i, token) in tokens.iter().enumerate() {
            let closure = token.text == "let" && text(i + 2) == "=" && matches!(text(i + 3), "|" | "||" | "move");
            if closure || (token.text == "fold" && text(i.wrapping_sub(1)) == ".") {
                found.push(format!("core/src/{name}:{}: {} {}", token.line, token.text, text(i + 1)));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn every_stage_is_listed_and_every_listed_stage_exists() {
    let files = core_files();
    let (_, _, list) = files.iter().find(|(name, _, _)| name == "stage.rs").expect("the list of stages");
    let mut listed: Vec<String> =
        list.windows(2).filter(|pair| pair[0].text == "mod").map(|pair| format!("stage/{}.rs", pair[1].text)).collect();
    listed.sort();
    let present: Vec<&String> =
        files.iter().map(|(name, _, _)| name).filter(|name| name.starts_with("stage/")).collect();
    assert_eq!(listed.iter().collect::<Vec<_>>(), present);
}

#[test]
fn ports_alone_name_the_fixed_crate() {
    for (name, _, tokens) in datapath_files() {
        let names = tokens.windows(2).any(|pair| pair[0].text == "fixed" && pair[1].text == ":");
        assert_eq!(names, name.starts_with("ports"), "{name}");
    }
}

#[test]
fn the_algebra_fits_a_screen() {
    let files = core_files();
    let (_, source, tokens) = files.iter().find(|(name, _, _)| name == "word.rs").expect("the algebra");
    let operations = tokens.iter().filter(|token| token.text == "fn").count();
    // 17 operations, a claim, a rounding made of three of them, two ways between mantissas and control wires, two between wide and control wires,
    // and two steps made of operations for which a processor has shorter ways (a branch, one shift for two). The lines are those of three traits:
    // only words multiply and look up, and a step that takes a wide wire names its word.
    assert!(operations <= 25, "{operations} operations");
    assert!(source.lines().count() <= 105, "{} lines", source.lines().count());
}

#[test]
fn every_way_into_the_core_has_an_example_of_less_than_40_lines() {
    // `cargo test` compiles the examples.
    for name in ["fragment", "pixel", "scanline", "texture_footprint"] {
        let path = core_root().join(format!("examples/{name}.rs"));
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(text.lines().count() < 40 && text.starts_with("//!"), "{name}: {} lines", text.lines().count());
    }
}

#[test]
fn core_is_no_std_and_safe() {
    let source = fs::read_to_string(core_root().join("src/lib.rs")).expect("the core has a root");
    assert!(source.contains("#![no_std]") && source.contains("#![forbid(unsafe_code)]"));
    for (name, _, tokens) in core_files() {
        for pair in tokens.windows(2) {
            let outside = matches!(pair[0].text.as_str(), "std" | "alloc") && pair[1].text == ":";
            assert!(!outside, "{name}:{}: {}", pair[0].line, pair[0].text);
        }
    }
}

/// Files of the shader that are memory: places of texels, rows and peaks.
const MEMORY: [&str; 6] = ["batch.rs", "batch/append.rs", "order.rs", "peaks.rs", "peaks_read.rs", "texels.rs"];

/// Files through which a value passes from texel to pixel, besides the rest of the shader.
const SHADING: [&str; 6] = [
    "core/src/sampler.rs",
    "core/src/wrapped.rs",
    "emulator/frame/src/environment.rs",
    "emulator/frame/src/lighting.rs",
    "emulator/frame/src/texture.rs",
    "emulator/frame/src/tile.rs",
];

/// Arithmetic outside of the datapath: file, item, reason.
const FRAME_ARITHMETIC: [(&str, &str, &str); 15] = [
    ("core/src/sampler.rs", "level_edge", "memory: the edge of a level"),
    ("core/src/sampler.rs", "edge_of", "memory: the same of every fragment"),
    ("core/src/sampler.rs", "patches", "memory: the channels of four texels"),
    ("core/src/wrapped.rs", "neighbours", "memory: the place of a row in a level"),
    ("emulator/frame/src/environment.rs", "bytes", "bytes of what is stored"),
    ("emulator/frame/src/lighting.rs", "bytes", "bytes of what is stored"),
    ("emulator/frame/src/lighting.rs", "shown", "set-up from floats: the colour of a light"),
    ("emulator/shader/src/pass.rs", "new", "memory: vectors of a row"),
    ("emulator/shader/src/pass.rs", "wide", "memory: a wide wire is two words"),
    ("emulator/shader/src/peak_passes.rs", "group", "memory: a peak is two words of 64 bits"),
    ("emulator/shader/src/peak_passes.rs", "above_horizon", "memory: a horizon is four"),
    ("emulator/frame/src/texture.rs", "new", "bytes of what is stored"),
    ("emulator/frame/src/tile.rs", "render_counted", "memory: room for the pixels"),
    (
        "emulator/frame/src/tile.rs",
        "shade_tile",
        "the mean of samples: what the datapath is compared with, and the edges of the front end",
    ),
    ("emulator/frame/src/tile.rs", "background", "set-up from floats: a ramp of colours"),
];

/// Returns the reason why a token of a frame is arithmetic, if it is: an operator between operands, or a call that shifts, multiplies, rounds or
/// divides.
fn arithmetic(tokens: &[Token], index: usize) -> bool {
    let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
    let spaced = |i: usize| tokens.get(i).is_some_and(|token| token.spaced);
    match text(index) {
        "/" | "%" => true,
        "*" => text(index + 1) == "=" || spaced(index) && spaced(index + 1),
        shift @ ("<" | ">") => text(index + 1) == shift && spaced(index) && !spaced(index + 1) && spaced(index + 2),
        name => {
            let calls =
                ["wrapping_", "rounding", "round", "div_", "rem_", "mul", "shl", "shr", "sar", "floor_", "keep"];
            index > 0 && text(index - 1) == "." && calls.iter().any(|start| name.starts_with(start))
        }
    }
}

/// Names of `stage` in a source, other than types and constants by their own names: functions, modules, globs.
fn stage_functions(tokens: &[Token]) -> Vec<&Token> {
    let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
    let starts_large = |token: &&Token| token.text.starts_with(char::is_uppercase);
    let mut found = Vec::new();
    for index in 0..tokens.len() {
        if text(index) != "stage" || text(index + 1) != ":" {
            continue;
        }
        // stage :: module :: Name, or a list of names.
        let names = &tokens[(index + 6).min(tokens.len())..];
        if text(index + 5) != ":" {
            found.push(&tokens[index]);
        } else if names.first().is_some_and(|token| token.text == "{") {
            let list = names[1..].iter().take_while(|token| token.text != "}");
            found.extend(list.filter(|token| token.text != "," && !starts_large(token)));
        } else {
            found.extend(names.first().filter(|token| !starts_large(token)));
        }
    }
    found
}

#[test]
fn arithmetic_and_functions_of_stages_are_found() {
    let source = "use a::stage::b::{C, D, e}; use a::stage::f; a::stage::g::H::i(); stage::j::k(*l); m * n; o::<P<Q>>(r) >> s;\
                  t.round(u) << (*v); w(x / y); z *= 2";
    let tokens = tokens(source);
    let named: Vec<&str> = stage_functions(&tokens).into_iter().map(|token| token.text.as_str()).collect();
    assert_eq!(named, ["e", "stage", "k"]);
    let found = (0..tokens.len()).filter(|&index| arithmetic(&tokens, index)).map(|index| tokens[index].text.as_str());
    assert_eq!(found.collect::<Vec<_>>(), ["*", ">", "round", "<", "/", "*"]);
}

#[test]
fn a_frame_calls_no_arithmetic_of_its_own() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let shader = files_below(&root.join("emulator/shader/src"));
    let shader = shader.into_iter().filter(|(name, ..)| !MEMORY.contains(&name.as_str()));
    let shader = shader.map(|(name, _, tokens)| (format!("emulator/shader/src/{name}"), tokens));
    let beside = SHADING.map(|name| {
        let text = fs::read_to_string(root.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        (name.to_owned(), tokens(&text))
    });
    let (mut used, mut found) = ([false; FRAME_ARITHMETIC.len()], Vec::new());
    for (name, tokens) in shader.chain(beside) {
        if let Some(token) = stage_functions(&tokens).first() {
            panic!("{name}:{}: {} of a stage: the composer calls stages", token.line, token.text);
        }
        for index in (0..tokens.len()).filter(|&index| arithmetic(&tokens, index)) {
            let (_, item) = enclosing_item(&tokens, index);
            let allowed = FRAME_ARITHMETIC.iter().position(|(file, allowed, _)| (*file, *allowed) == (&*name, item));
            match allowed {
                Some(allowed) => used[allowed] = true,
                None => found.push(format!("{name}:{}: {} in {item}", tokens[index].line, tokens[index].text)),
            }
        }
    }
    assert!(found.is_empty(), "the datapath has the arithmetic: {found:#?}");
    for (used, (file, item, reason)) in used.into_iter().zip(FRAME_ARITHMETIC) {
        assert!(used, "{file} {item} ({reason}) no longer computes: remove it from the list");
    }
}

/// Regression: `row(7)` as the probe count of a footprint, known in five files. Declarations name the rows (`row_of`, `rows_of`, `Appended`).
#[test]
fn rows_of_batches_have_names_and_no_numbers() {
    let emulator = Path::new(env!("CARGO_MANIFEST_DIR")).join("../emulator");
    for package in ["shader", "frame", "cases", "study"] {
        for (name, _, tokens) in files_below(&emulator.join(package).join("src")) {
            for call in tokens.windows(3) {
                let is_number = call[2].text.starts_with(|first: char| first.is_ascii_digit());
                let is_row = call[0].text == "row" && call[1].text == "(" && is_number;
                assert!(!is_row, "{package}/src/{name}:{}: a row by its number", call[0].line);
            }
        }
    }
}

/// Files that may use the platform's own functions, whose last bit differs between platforms: file, reason.
const PLATFORM_FUNCTIONS: [(&str, &str); 2] = [
    ("assets/src/picture/compare.rs", "figures of likeness, of which a few digits are printed"),
    ("frame/src/frame.rs", "the same"),
];

/// Inputs of sets and hard cases use no sines and powers of the platform's library. With them, vectors of one name differ by a last place between
/// machines.
#[test]
fn vectors_scenes_and_frames_ask_no_platform_for_a_sine() {
    const FUNCTIONS: [&str; 23] = [
        "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "cbrt", "hypot", "mul_add", "sin",
        "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh",
    ];
    let emulator = Path::new(env!("CARGO_MANIFEST_DIR")).join("../emulator");
    let mut used = [false; PLATFORM_FUNCTIONS.len()];
    for package in ["assets", "cases", "scene", "maps", "peaks", "frame", "shader", "simd", "utilities"] {
        for (name, _, tokens) in files_below(&emulator.join(package).join("src")) {
            let name = format!("{package}/src/{name}");
            if name.ends_with("/tests.rs") || name.contains("/tests/") {
                continue;
            }
            let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
            // Tests are the last module of a file; a test module in its own file is left out above.
            let begins_tests = |&i: &usize| text(i) == "cfg" && text(i + 2) == "test" && text(i + 7) == "{";
            let end = (0..tokens.len()).find(begins_tests).unwrap_or(tokens.len());
            // As a method, or by the path of its type.
            let is_named = |i: usize| {
                let of_float = text(i - 1) == ":" && matches!(text(i.wrapping_sub(3)), "f32" | "f64");
                FUNCTIONS.contains(&text(i)) && (of_float || text(i - 1) == "." && text(i + 1) == "(")
            };
            for i in (1..end).filter(|&i| is_named(i)) {
                let allowed = PLATFORM_FUNCTIONS.iter().position(|(file, _)| *file == name);
                let Some(allowed) = allowed else { panic!("{name}:{}: {} of the platform", tokens[i].line, text(i)) };
                used[allowed] = true;
            }
        }
    }
    for (used, (file, reason)) in used.into_iter().zip(PLATFORM_FUNCTIONS) {
        assert!(used, "{file} ({reason}) no longer has any: remove it from the list");
    }
}

/// Assembly of the core as a release build makes it, without debug information.
fn release_assembly() -> String {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("assembly");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let arguments = ["rustc", "--quiet", "--offline", "--release", "--lib", "--package", "roughxel-core"];
    let output = Command::new(cargo)
        .args(arguments)
        .arg("--target-dir")
        .arg(&target)
        .args(["--", "--emit=asm", "-Ccodegen-units=1", "-Cdebuginfo=0"])
        .current_dir(core_root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let newest = fs::read_dir(target.join("release/deps"))
        .expect("the build has a folder of results")
        .map(|entry| entry.expect("a folder can be read").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "s"))
        .filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("roughxel_core")))
        .max_by_key(|path| fs::metadata(path).and_then(|data| data.modified()).expect("files have a time"))
        .expect("the build left assembly");
    fs::read_to_string(newest).expect("assembly is text")
}

/// The lines of each function of an assembly listing, by its symbol.
fn functions(assembly: &str) -> Vec<(&str, Vec<&str>)> {
    let mut functions: Vec<(&str, Vec<&str>)> = Vec::new();
    for line in assembly.lines() {
        match line.strip_suffix(':').filter(|label| !label.starts_with(['.', ' ', '\t'])) {
            Some(symbol) => functions.push((symbol, Vec::new())),
            None => functions.last_mut().into_iter().for_each(|(_, lines)| lines.push(line)),
        }
    }
    functions
}

#[test]
fn machine_code_of_the_datapath_holds_no_panic_no_division_and_no_float() {
    let assembly = release_assembly();
    // The listing contains the scalar datapath: these entry points are not generic.
    let scalar_api = [
        "surface",
        "reflection_of",
        "fragment",
        "texture_footprint",
        "highlight",
        "lit_peak",
        "map_scale",
        "texture_scale",
    ];
    let probe_list = ["environment_probes", "sphere_probes", "texture_probes"];
    for (file, entries) in [("scalar_api", &scalar_api[..]), ("probe_list", &probe_list)] {
        for entry in entries {
            let is_entry = |symbol: &str| symbol.contains(file) && symbol.contains(entry);
            let present = functions(&assembly).iter().any(|(symbol, lines)| is_entry(symbol) && lines.len() > 20);
            assert!(present, "{file}::{entry} is missing from the listing");
        }
    }
    // A panic needs a reference to a function of core::panicking, core::option, core::result, core::slice …
    for word in ["panic", "unwrap_failed", "expect_failed", "slice_index", "bounds_check", "str_index"] {
        let line = assembly.lines().find(|line| line.contains(word));
        assert_eq!(line, None, "a path that panics");
    }
    // 128-bit division and soft floats are calls into the compiler's library.
    for call in ["divti3", "modti3", "divdi3", "divsf3", "divdf3", "mulsf3", "muldf3", "addsf3", "adddf3"] {
        let line = assembly.lines().find(|line| line.contains(call));
        assert_eq!(line, None, "the compiler's library has to help");
    }
    if !cfg!(target_arch = "x86_64") {
        println!("SKIPPED: mnemonics are known for x86_64 only; symbols were checked");
        return;
    }
    for (symbol, lines) in functions(&assembly) {
        for line in lines {
            let mnemonic = line.split_whitespace().next().unwrap_or("");
            let division =
                ["div", "idiv"].iter().any(|name| mnemonic.strip_prefix(name).is_some_and(|rest| rest.len() <= 1));
            assert!(!division || symbol.contains("texture_scale"), "{symbol}: {line}");
            let float = ["ss", "sd", "ps", "pd"].iter().any(|end| {
                let arithmetic = ["add", "sub", "mul", "div", "sqrt", "cvt", "vadd", "vsub", "vmul", "vdiv", "vcvt"];
                mnemonic.ends_with(end) && arithmetic.iter().any(|start| mnemonic.starts_with(start))
            });
            assert!(!float, "{symbol}: {line}");
        }
    }
}
