//! Files for tools: they name files that exist and ports that the module has, and say the same of each register.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use roughxel_core::design::Design;
use roughxel_host_tests::simulators::run;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::Options;

use super::super::rtl::FULL;
use super::{Folder, files_of_core, shell_options};

fn folder() -> Folder {
    let options = shell_options("narrow", FULL, Some(8), 32);
    Folder::new(Design::Reflection, &Options { target: Target::Ecp5, clock: Some(62.5), ..options })
}

/// Ports of a module from its text: direction and bits by name.
fn ports(text: &str) -> BTreeMap<String, (String, u32)> {
    let (_, list) = text.split_once("\nmodule ").expect("a module");
    let (list, _) = list.split_once("\n);").expect("the end of the ports");
    let port = |line: &str| {
        let declared = line.split("//").next()?.trim().trim_end_matches(',').replace("signed ", "");
        let (direction, rest) = declared.split_once(" wire ")?;
        let direction = if direction.trim() == "input" { "in" } else { "out" };
        let (bits, name) = match rest.trim().strip_prefix('[') {
            Some(vector) => {
                let (high, name) = vector.split_once(":0] ")?;
                let high: u32 = high.split_once("-1").map_or(high, |(width, _)| width).parse().ok()?;
                (if vector.contains("-1:0") { high } else { high + 1 }, name)
            }
            None => (1, rest.trim()),
        };
        Some((name.trim().to_owned(), (direction.to_owned(), bits)))
    };
    list.lines().filter_map(port).collect()
}

/// Text of an element below another, by the names on the way.
fn child<'a>(node: roxmltree::Node<'a, 'a>, path: &[&str]) -> &'a str {
    let end = path.iter().fold(node, |node, name| {
        node.children()
            .find(|child| child.tag_name().name() == *name)
            .unwrap_or_else(|| panic!("no {name} of {path:?}"))
    });
    end.text().expect("a text")
}

#[test]
fn ip_xact_has_the_ports_the_registers_and_the_files_of_the_shell() {
    let folder = folder();
    let text = folder.text("roughxel_reflection.xml");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let nodes = |name: &'static str| document.descendants().filter(move |node| node.tag_name().name() == name);

    let of_module = ports(&folder.text("roughxel_reflection_shell.v"));
    let model = nodes("ports").next().expect("ports");
    let of_component: BTreeMap<String, (String, u32)> = model
        .children()
        .filter(roxmltree::Node::is_element)
        .map(|port| {
            let left = port.descendants().find(|node| node.tag_name().name() == "left");
            let bits = left.map_or(1, |left| left.text().and_then(|text| text.parse::<u32>().ok()).expect("a bit") + 1);
            (child(port, &["name"]).to_owned(), (child(port, &["wire", "direction"]).to_owned(), bits))
        })
        .collect();
    assert!(of_module.len() > 20);
    assert_eq!(of_module, of_component);
    for physical in nodes("physicalPort") {
        assert!(of_module.contains_key(child(physical, &["name"])), "{}", child(physical, &["name"]));
    }
    let interfaces: Vec<&str> = nodes("busInterface").map(|node| child(node, &["name"])).collect();
    assert_eq!(interfaces, ["s_axis", "m_axis", "s_axi"]);

    let registers: Vec<[String; 3]> = nodes("register")
        .map(|node| {
            [&["name"][..], &["addressOffset"], &["field", "bitWidth"]].map(|path| child(node, path).to_owned())
        })
        .collect();
    let expected = folder.shell().registers.iter();
    let expected = expected.map(|of| [of.name.clone(), format!("'h{:x}", of.offset), of.width.to_string()]);
    assert!(registers.into_iter().eq(expected));
    for file in nodes("file") {
        assert!(folder.path(child(file, &["name"])).exists(), "{}", child(file, &["name"]));
    }
    assert_eq!(nodes("moduleName").next().and_then(|node| node.text()), Some("roughxel_reflection_shell"));
}

#[test]
fn header_page_and_manifest_say_the_same_of_each_register() {
    let folder = folder();
    let [header, page] = ["h", "md"].map(|ending| folder.text(&format!("roughxel_reflection_registers.{ending}")));
    let manifest: serde_json::Value = serde_json::from_str(&folder.text("roughxel_reflection.json")).expect("JSON");
    let listed = manifest["shell"]["registers"].as_array().expect("registers");
    assert_eq!(listed.len(), folder.shell().registers.len());
    for (register, entry) in folder.shell().registers.iter().zip(listed) {
        assert_eq!(
            (entry["name"].as_str(), entry["offset"].as_u64()),
            (Some(&*register.name), Some(register.offset.into()))
        );
        let name = format!("ROUGHXEL_REFLECTION_{}", register.name.to_ascii_uppercase());
        assert!(
            header.contains(&format!(
                "#define {name} 0x{:03x}u\n#define {name}_BITS {}\n",
                register.offset, register.width
            ))
        );
        assert!(page.contains(&format!("| 0x{:03x} | `{}` |", register.offset, register.name)), "{page}");
        assert!(!register.description.is_empty());
    }
    let streamed = manifest["shell"]["inputs"].as_array().expect("inputs").len();
    let constant = |port: &serde_json::Value| port["constant"] == true;
    let constants = manifest["top"]["inputs"].as_array().expect("inputs").iter().filter(|port| constant(port)).count();
    assert_eq!(constants, 2);
    assert_eq!(streamed + constants, manifest["top"]["inputs"].as_array().expect("inputs").len());
    // The compiler that links Rust programs reads the header.
    let mut command = Command::new("cc");
    run(command
        .args(["-std=c99", "-Wall", "-Werror", "-fsyntax-only", "-x", "c"])
        .arg(folder.path("roughxel_reflection_registers.h")));
}

#[test]
fn project_files_name_files_that_exist_and_the_clock() {
    let folder = folder();
    let core = folder.text("roughxel_reflection.core");
    assert!(core.starts_with("CAPI=2:\n"), "{core}");
    let files = files_of_core(&core);
    assert!(files.len() > 10);
    for file in &files {
        assert!(folder.path(file).exists(), "{file}");
    }
    // Each module is in the core once.
    for name in folder.verilog.files.keys().filter(|name| name.ends_with(".v")) {
        assert_eq!(files.iter().filter(|file| *file == name).count(), 1, "{name}");
    }
    for (ending, clock) in
        [("lpf", "FREQUENCY PORT \"aclk\" 62.5 MHZ;"), ("sdc", "-period 16.000 "), ("xdc", "-period 16.000 ")]
    {
        let text = folder.text(&format!("roughxel_reflection.{ending}"));
        assert!(text.contains(clock) && text.lines().count() == 2, "{text}");
    }
}

#[test]
fn the_clock_follows_from_the_levels_between_registers() {
    let clock = |target: Target, depth| target.clock_mhz(depth);
    assert_eq!(clock(Target::Ecp5, Some(7)), 71.0);
    assert_eq!(clock(Target::Xc7, Some(10)), 100.0);
    assert_eq!(clock(Target::Ecp5, Some(14)), 35.0);
    assert_eq!(clock(Target::Asic, None), 50.0);
    let options = Options { depth: Some(14), target: Target::Ecp5, ..shell_options("narrow", FULL, Some(8), 32) };
    assert_eq!(Folder::new(Design::Colour, &options).shell().clock_mhz, 35.0);
}

#[test]
fn python_compiles_the_modules_of_a_shell_and_the_litex_bench() {
    if !roughxel_host_tests::simulators::have("python3") {
        return;
    }
    let folder = folder();
    let bench = Path::new(env!("CARGO_MANIFEST_DIR")).join("litex/simulate.py");
    let generated = ["roughxel_reflection_litex.py", "roughxel_shell.py", "bench/test_shell.py"];
    let compile = "import sys\nfor path in sys.argv[1:]: compile(open(path, encoding='utf-8').read(), path, 'exec')";
    let mut command = Command::new("python3");
    run(command.args(["-c", compile]).arg(bench).args(generated.map(|file| folder.path(file))));
    let litex = folder.text(generated[0]);
    // The instance has every port of the module with the streams.
    for (port, (direction, _)) in ports(&folder.text("roughxel_reflection_axis.v")) {
        let prefix = if direction == "in" { 'i' } else { 'o' };
        assert!(litex.contains(&format!("            {prefix}_{port}=")), "{port}: {litex}");
    }
}

#[test]
fn texts_of_a_shell_say_what_a_packet_is_and_what_a_register_holds_once() {
    let of = |design, stream| Folder::new(design, &shell_options("narrow", FULL, None, stream));
    let highlight = of(Design::Highlight, 32).text("roughxel_highlight_registers.md");
    assert!(highlight.contains("| exponent m, saturated to 1…8192 |"), "{highlight}");
    let probe = of(Design::TextureProbe, 128).text("roughxel_texture_probe_stepper_registers.md");
    assert!(probe.contains("each of its probes a packet of 1 word. Output `last` is 1 in the last probe."), "{probe}");
    // A packet of one word is not shifted by a whole word, of which slang warns.
    let pixel = of(Design::Pixel, 128);
    assert!(
        pixel.text("roughxel_pixel_registers.md").contains("A fragment is 1 word of 128 bits, its outcome 1 word.")
    );
    for module in ["axis", "bfm"] {
        assert!(!pixel.text(&format!("roughxel_pixel_{module}.v")).contains(">> WIDTH"), "{module}");
    }
}
