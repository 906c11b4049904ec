//! Benches: what it takes to compare a device with a set in Icarus, Verilator (SystemVerilog or C++), GHDL and cocotb.
//!
//! The texts are the files of `bench`, with `@NAMES@` in the places that depend on the set. All that is filled in comes from
//! the fields of the manifest; the order of the outputs is that in which the stages run.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use roughxel_core::design::Design;
use thiserror::Error;

use super::VectorError;
use super::c_library::{c_library_files, place_name};
use super::layout::{Direction, Field};
use super::lines::is_whole;
use super::manifest::Manifest;
use super::order::{misplaced, with_cause};
use roughxel_net::verilog::{Interface, Options, PortDescription, Stage, Verilog, VerilogError};
use roughxel_record as record;
use roughxel_scene::input::open_file;
use roughxel_scene::output::{OutputFile, WriteError, write_files};

/// The texts, with the name of each file.
const TEMPLATES: [(&str, &str); 11] = [
    ("@NAME@_pkg.sv", include_str!("bench/pkg.sv")),
    ("@NAME@_tb.sv", include_str!("bench/tb.sv")),
    (DEVICES[0], include_str!("bench/device.sv")),
    ("@NAME@_pkg.vhd", include_str!("bench/pkg.vhd")),
    ("@NAME@_tb.vhd", include_str!("bench/tb.vhd")),
    (DEVICES[1], include_str!("bench/device.vhd")),
    ("@NAME@_playback.vhd", include_str!("bench/playback.vhd")),
    ("@NAME@_main.cpp", include_str!("bench/main.cpp")),
    ("test_@NAME@.py", include_str!("bench/test.py")),
    ("roughxel_vectors.py", include_str!("bench/roughxel_vectors.py")),
    ("run.sh", include_str!("bench/run.sh")),
];

/// Those of whole datapaths alone: the C library has no stages.
const DPI: [(&str, &str); 1] = [("@NAME@_dpi.sv", include_str!("bench/dpi.sv"))];

/// Those that a user replaces.
const DEVICES: [&str; 2] = ["@NAME@_device.sv", "@NAME@_device.vhd"];

/// The page of a directory of benches.
pub const BENCH_README: &str = include_str!("bench/README.md");

/// What the bench in SystemVerilog drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Device {
    /// The generated Verilog of the set's datapath or stage, effects and profile, in `rtl`.
    Generated,
    /// A skeleton with a line a field.
    Blank,
}

/// Why there is no bench.
#[derive(Debug, Error)]
pub enum BenchError {
    /// The set cannot be read.
    #[error(transparent)]
    Set(#[from] VectorError),
    /// The words are not those that the manifest was written for.
    #[error(
        "{}: its SHA-256 is not the one in {}{order}; the file was changed: export the set again (`roughxel vectors verify` says which \
         words differ)",
        .words.display(), .manifest.display()
    )]
    Damaged {
        /// The hex file.
        words: PathBuf,
        /// The manifest.
        manifest: PathBuf,
        /// Words that are out of order; begins with a semicolon.
        order: String,
    },
    /// The generated Verilog has other ports than the set has fields.
    #[error("{}: {problem}; a bench with a device to be filled in is made with `--device blank`", .manifest.display())]
    Ports {
        /// The manifest.
        manifest: PathBuf,
        /// Which.
        problem: String,
    },
    /// The datapath cannot be written as Verilog under the set's profile.
    #[error("no Verilog for {}", .manifest.display())]
    Verilog {
        /// The manifest.
        manifest: PathBuf,
        /// Why.
        source: VerilogError,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The bench of one set.
#[derive(Clone, Debug)]
pub struct Bench {
    manifest: Manifest,
    manifest_path: PathBuf,
    words_path: PathBuf,
    /// In the word's order.
    inputs: Vec<Field>,
    /// Taps and what leaves, earliest stage first.
    outputs: Vec<Field>,
    /// The module of the stage, where the set is of one.
    stage: Option<Interface>,
}

impl Bench {
    /// Reads the manifest of a set and checks the hash of its words.
    ///
    /// Errors: the set cannot be read or its name is no file name, or its words are damaged. Nothing is written.
    pub fn new(manifest_path: &Path) -> Result<Self, BenchError> {
        let manifest = Manifest::read(manifest_path)?;
        let good = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
        if !(1..=64).contains(&manifest.set.len()) || !manifest.set.bytes().all(good) {
            return Err(VectorError::Name(manifest.set).into());
        }
        if let Some(part) = manifest.part {
            let problem = format!(
                "it is part {} of {} of a set; benches are of whole ones: join the parts with `roughxel vectors merge`",
                part.number, part.of
            );
            return Err(VectorError::Manifest { path: manifest_path.into(), problem }.into());
        }
        let missing = || VectorError::Manifest {
            path: manifest_path.into(),
            problem: "lists no file of words (NAME.hex), which simulators read; export the set again without --bin"
                .into(),
        };
        let entry = manifest.files.iter().find(|file| file.name.ends_with(".hex")).ok_or_else(missing)?;
        let words_path = manifest_path.with_file_name(&entry.name);
        let layout = manifest.layout(manifest_path)?;
        let is_whole = is_whole(manifest_path, &manifest, &layout);
        if !is_whole.map_err(|error| with_cause(error, manifest_path, &manifest, &layout))? {
            let order = misplaced(manifest_path, &manifest, &layout);
            return Err(BenchError::Damaged {
                words: words_path,
                manifest: manifest_path.into(),
                order: order.iter().map(|misplaced| format!("; {misplaced}")).collect(),
            });
        }

        let fields = |wanted: &[Direction]| -> Vec<(usize, Field)> {
            let of = manifest.fields.iter().enumerate().filter(|(_, field)| wanted.contains(&field.direction));
            of.map(|(index, field)| (layout.rank(index), field.clone())).collect()
        };
        let inputs = fields(&[Direction::In]);
        let mut outputs = fields(&[Direction::Tap, Direction::Out]);
        // A stage that is off hands its input on: its field counts as that of the stage behind it.
        for index in (1..outputs.len()).rev() {
            if outputs[index - 1].0 == usize::MAX {
                outputs[index - 1].0 = outputs[index].0;
            }
        }
        // Of a stage the fields stay in the word's order.
        outputs.sort_by_key(|(rank, _)| *rank);
        let [inputs, outputs] = [inputs, outputs].map(|fields| fields.into_iter().map(|(_, field)| field).collect());
        let stage = layout.stage().map(Stage::interface);
        Ok(Self { manifest, manifest_path: manifest_path.into(), words_path, inputs, outputs, stage })
    }

    /// Set and profile, as the set's files are named: the folder of the bench.
    pub fn stem(&self) -> String {
        format!("{}_{}", self.manifest.set, self.manifest.profile.name)
    }

    /// Vectors of the set.
    pub fn count(&self) -> u64 {
        self.manifest.count
    }

    /// Writes the bench into `directory`, which is made if it is not there. Devices that are there stay, unless `replace`;
    /// their names are returned.
    ///
    /// Errors: the Verilog cannot be made or has other ports than the set, of which nothing is written; or a file cannot be written.
    pub fn write(&self, directory: &Path, device: Device, replace: bool) -> Result<Vec<String>, BenchError> {
        let verilog = match device {
            Device::Generated => Some(self.verilog()?),
            Device::Blank => None,
        };
        let values = self.values(verilog.as_ref())?;
        let name = self.name();
        let devices = DEVICES.map(|file| file.replace("@NAME@", &name));
        let kept: Vec<String> = devices.into_iter().filter(|file| !replace && directory.join(file).exists()).collect();

        let rtl = verilog.iter().flat_map(Verilog::in_order);
        write_files(directory, rtl.map(|(file, text)| (format!("rtl/{file}"), text)))?;
        let dpi = if self.stage.is_none() { &DPI[..] } else { &[] };
        let texts =
            TEMPLATES.iter().chain(dpi).map(|(file, text)| (file.replace("@NAME@", &name), filled(text, &values)));
        write_files(directory, texts.filter(|(file, _)| !kept.contains(file)))?;
        if self.stage.is_none() {
            write_files(directory, c_library_files())?;
        }
        self.write_words(directory)?;
        Ok(kept)
    }

    /// Writes words and manifest alone, into a bench that was written for as many vectors of the same fields.
    ///
    /// Errors: a file cannot be read or written.
    pub(super) fn write_words(&self, directory: &Path) -> Result<(), BenchError> {
        let files = [(&self.words_path, "words.hex"), (&self.manifest_path, "set.json")];
        files.into_iter().try_for_each(|(from, to)| copy(from, &directory.join(to)))
    }

    /// The stem as a name in SystemVerilog, VHDL and Python.
    fn name(&self) -> String {
        identifier(&self.stem())
    }

    /// The datapath or the stage of the set with the set's effects and profile.
    fn verilog(&self) -> Result<Verilog, BenchError> {
        let Manifest { datapath, effects, profile, .. } = &self.manifest;
        let options = Options {
            profile: profile.name.clone(),
            precision: profile.knobs,
            effects: *effects,
            depth: None,
            stage: self.stage.as_ref().map(|stage| stage.module.clone()),
            prefix: String::new(),
        };
        let error = |source| BenchError::Verilog { manifest: self.manifest_path.clone(), source };
        record::verilog(Design::of(*datapath), &options).map_err(error)
    }

    /// What stands in the place of each `@NAME@`.
    fn values(&self, verilog: Option<&Verilog>) -> Result<Vec<(&'static str, String)>, BenchError> {
        let (stem, name, Self { manifest, inputs, outputs, .. }) = (self.stem(), self.name(), self);
        let bits = |fields: &[Field]| fields.iter().map(|field| field.width).sum::<u32>().to_string();
        let module = verilog.and_then(|verilog| self.stage.as_ref().or(verilog.top.as_ref()));
        let (purpose, body) = match module {
            Some(top) => {
                let purpose = "Here that is the generated Verilog in rtl; a device of your own takes its place.";
                (purpose, self.connected(top)?)
            }
            None => ("To be filled in; until then every output is zero.", self.blank()),
        };
        let sv_part = |field: &Field| format!("      word[{} +: {}]", field.lsb, field.width);
        let entry = manifest.files.iter().find(|file| file.name.ends_with(".hex"));
        let place = |direction, field: &Field| place_name(manifest.datapath, direction, &field.name);
        Ok(vec![
            ("NAME", name),
            ("SET", stem.clone()),
            ("DESCRIPTION", in_comment(&manifest.description)),
            ("COUNT", manifest.count.to_string()),
            ("WORD_BITS", manifest.word_bits.to_string()),
            ("INPUT_BITS", bits(inputs)),
            ("OUTPUT_BITS", bits(outputs)),
            ("SHA256", entry.map_or_else(String::new, |file| file.sha256.clone())),
            ("INPUT_MEMBERS", lines(inputs, sv_member)),
            ("OUTPUT_MEMBERS", lines(outputs, sv_member)),
            ("INPUT_PARTS", lines(inputs, sv_part).replace('\n', ",\n")),
            ("OUTPUT_PARTS", lines(outputs, sv_part).replace('\n', ",\n")),
            ("OUTPUT_PLACES", lines(outputs, sv_place)),
            ("COMPARISONS", lines(outputs, |field| sv_comparison(field, &stem))),
            ("PURPOSE", purpose.into()),
            ("BODY", body),
            ("VHDL_INPUT_MEMBERS", lines(inputs, vhdl_member)),
            ("VHDL_OUTPUT_MEMBERS", lines(outputs, vhdl_member)),
            ("VHDL_INPUT_PARTS", lines(inputs, vhdl_part)),
            ("VHDL_OUTPUT_PARTS", lines(outputs, vhdl_part)),
            ("VHDL_OUTPUT_PLACES", lines(outputs, vhdl_place)),
            ("VHDL_COMPARISONS", lines(outputs, vhdl_comparison)),
            ("VHDL_INPUT_LIST", lines(inputs, |field| format!("  --   inputs.{}: {}", column(field), note(field)))),
            (
                "VHDL_ASSIGNMENTS",
                lines(outputs, |field| format!("  outputs.{} <= (others => '0');  -- {}", column(field), note(field))),
            ),
            ("FIRST_OUTPUT", outputs.first().map_or_else(String::new, column)),
            ("CPP_INPUTS", lines(inputs, cpp_field)),
            ("CPP_OUTPUTS", lines(outputs, cpp_field)),
            ("PYTHON_OUTPUTS", lines(outputs, |field| field.name.clone())),
            ("INPUTS", inputs.len().to_string()),
            ("KNOBS", roughxel_c::knobs_of(&manifest.profile.knobs).map(|knob| knob.to_string()).join(", ")),
            ("EFFECTS", roughxel_c::bits_of(&manifest.effects).to_string()),
            ("DATAPATH", manifest.datapath.name().into()),
            ("DATAPATH_CAPITALS", manifest.datapath.name().to_ascii_uppercase()),
            ("DRAWN", numbered(inputs, |index, field| dpi_drawn(index, field, &place("in", field)))),
            ("GIVEN", lines(inputs, |field| dpi_given(field, &place("in", field)))),
            ("RESULTS", lines(outputs, |field| dpi_result(field, &place("out", field)))),
            ("SHOWN", lines(inputs, dpi_shown)),
        ])
    }

    /// The body of a device to be filled in.
    fn blank(&self) -> String {
        let inputs = lines(&self.inputs, |field| format!("  //   inputs.{}: {}", column(field), note(field)));
        let outputs =
            lines(&self.outputs, |field| format!("  assign outputs.{} = '0;  // {}", column(field), note(field)));
        format!("{PASSED_THROUGH}\n  // The inputs:\n{inputs}\n\n{outputs}")
    }

    /// The body that connects the generated top, or the module of a stage: a port for each field, and no other. Taps that the set does not
    /// have stay open.
    fn connected(&self, top: &Interface) -> Result<String, BenchError> {
        let inputs = self.paired(&self.inputs, &top.inputs)?;
        let (compared, open): (Vec<_>, Vec<_>) = top
            .outputs
            .iter()
            .cloned()
            .partition(|port| self.manifest.taps || self.outputs.iter().any(|field| field.port == port.name));
        let outputs = self.paired(&self.outputs, &compared)?;
        let wire = |port: &PortDescription| {
            let sign = if port.signed { "signed " } else { "" };
            format!("  wire {sign}[{}:0] {}", port.width - 1, port.port)
        };
        let mut text = String::new();
        for (field, port) in &inputs {
            let of_field = signed(field, &format!("inputs.{}", column(field)));
            let value = shifted(&of_field, field.width, port.width, scale(field, port));
            text += &format!("{} = {value};\n", wire(port));
        }
        for (_, port) in &outputs {
            text += &format!("{};\n", wire(port));
        }
        let ports = inputs.iter().chain(&outputs).map(|(_, port)| port.port.as_str());
        let (instance, handshake) = match self.stage {
            Some(_) => ("stage", &[][..]),
            None => ("datapath", &["clk", "rst", "in_valid", "in_ready", "out_valid", "out_ready"][..]),
        };
        if self.stage.is_some() {
            text += &format!("\n{PASSED_THROUGH}");
        }
        let connected = handshake.iter().copied().chain(ports).map(|name| format!(".{name}({name})"));
        let connections: Vec<String> = connected.chain(open.iter().map(|port| format!(".{}()", port.port))).collect();
        text += &format!("\n  {} {instance} (\n    {}\n  );\n", top.module, connections.join(",\n    "));
        for (field, port) in &outputs {
            let value = shifted(&port.port, port.width, field.width, -scale(field, port));
            text += &format!("\n  assign outputs.{} = {value};", column(field));
        }
        Ok(text)
    }

    /// Each port with its field.
    fn paired<'a>(
        &self,
        fields: &'a [Field],
        ports: &'a [PortDescription],
    ) -> Result<Vec<(&'a Field, &'a PortDescription)>, BenchError> {
        let error = |problem| BenchError::Ports { manifest: self.manifest_path.clone(), problem };
        if let Some(field) = fields.iter().find(|field| ports.iter().all(|port| port.name != field.port)) {
            let Field { name, port, .. } = field;
            return Err(error(format!(
                "field {name} is that of port {port}, which the generated Verilog does not have"
            )));
        }
        let of_port = |port: &'a PortDescription| {
            let field = fields.iter().find(|field| field.port == port.name);
            field
                .map(|field| (field, port))
                .ok_or_else(|| error(format!("port {} of the generated Verilog has no field in the set", port.name)))
        };
        ports.iter().map(of_port).collect()
    }
}

/// The handshake of a device without registers.
const PASSED_THROUGH: &str = "  \
  // A device without registers; one with registers delays valid and stops where out_ready is low.
  assign in_ready  = out_ready;
  assign out_valid = in_valid;
";

/// Copies a file; the copy appears whole or not at all.
fn copy(from: &Path, to: &Path) -> Result<(), BenchError> {
    let mut source = open_file(from).map_err(|source| VectorError::Io { action: "read", path: from.into(), source })?;
    let write = |source: &mut File| {
        let mut file = OutputFile::create(to)?;
        io::copy(source, &mut file)?;
        file.commit()
    };
    Ok(write(&mut source).map_err(|source| WriteError { path: to.into(), source })?)
}

/// A text with every `@NAME@` replaced.
fn filled(text: &str, values: &[(&str, String)]) -> String {
    values.iter().fold(text.to_owned(), |text, (name, value)| text.replace(&format!("@{name}@"), value))
}

/// A line a field.
fn lines(fields: &[Field], line: impl Fn(&Field) -> String) -> String {
    fields.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// A line a field, with its number from 0.
fn numbered(fields: &[Field], line: impl Fn(usize, &Field) -> String) -> String {
    fields.iter().enumerate().map(|(index, field)| line(index, field)).collect::<Vec<_>>().join("\n")
}

/// A text for a comment: one line of ASCII, which every tool reads.
fn in_comment(text: &str) -> String {
    text.chars().map(|c| if c == ' ' || c.is_ascii_graphic() { c } else { '?' }).collect()
}

/// Words that SystemVerilog or VHDL keep for themselves and that are as plain as the name of a field.
const RESERVED: [&str; 120] = [
    "abs",
    "access",
    "after",
    "alias",
    "all",
    "always",
    "and",
    "architecture",
    "array",
    "assert",
    "assign",
    "assume",
    "attribute",
    "begin",
    "bind",
    "bit",
    "block",
    "body",
    "break",
    "buf",
    "buffer",
    "bus",
    "byte",
    "case",
    "cell",
    "checker",
    "class",
    "component",
    "config",
    "configuration",
    "constant",
    "context",
    "continue",
    "cover",
    "cross",
    "default",
    "design",
    "disable",
    "do",
    "edge",
    "else",
    "end",
    "entity",
    "enum",
    "event",
    "exit",
    "export",
    "extern",
    "file",
    "final",
    "first_match",
    "for",
    "force",
    "fork",
    "function",
    "generate",
    "generic",
    "global",
    "group",
    "guarded",
    "if",
    "impure",
    "in",
    "inertial",
    "initial",
    "inout",
    "input",
    "inside",
    "instance",
    "int",
    "integer",
    "interface",
    "is",
    "label",
    "large",
    "let",
    "library",
    "linkage",
    "literal",
    "local",
    "logic",
    "loop",
    "map",
    "matches",
    "medium",
    "mod",
    "new",
    "next",
    "not",
    "null",
    "of",
    "on",
    "open",
    "or",
    "others",
    "out",
    "output",
    "package",
    "parameter",
    "port",
    "priority",
    "process",
    "property",
    "pure",
    "range",
    "record",
    "register",
    "release",
    "rem",
    "report",
    "return",
    "select",
    "sequence",
    "signal",
    "small",
    "strong",
    "table",
    "type",
    "weak",
    "wire",
];

/// A name in SystemVerilog, VHDL and Python: begins with a letter, has single underscores between others, and is no word of these
/// languages.
fn identifier(name: &str) -> String {
    let parts: Vec<&str> = name.split('_').filter(|part| !part.is_empty()).collect();
    let joined = parts.join("_");
    if joined.starts_with(|c: char| c.is_ascii_lowercase()) && !RESERVED.contains(&joined.as_str()) {
        joined
    } else {
        format!("the_{joined}")
    }
}

/// The name of a field in a structure.
fn column(field: &Field) -> String {
    identifier(&field.name)
}

/// Format, port and whether it is a tap, for a comment.
fn note(field: &Field) -> String {
    let Field { signed, width, fraction_bits, port, direction, .. } = field;
    let letter = if *signed { 'I' } else { 'U' };
    let whole = i64::from(*width) - i64::from(*fraction_bits);
    let fraction = if *fraction_bits == 0 { String::new() } else { format!("F{fraction_bits}") };
    let tap = if *direction == Direction::Tap { " (tap)" } else { "" };
    format!("{letter}{whole}{fraction}, {port}{tap}")
}

/// Zeros that the port has below the field; less than 0 where the field has some that the port lacks.
fn scale(field: &Field, port: &PortDescription) -> i64 {
    i64::from(port.fraction_bits) - i64::from(field.fraction_bits) - i64::from(port.dropped_zeros)
}

/// An expression of SystemVerilog times 2^`places`, of `to` bits instead of `from`, with its sign.
fn shifted(expression: &str, from: u32, to: u32, places: i64) -> String {
    // Upwards bits are needed first, downwards they are dropped last.
    let sized = |text: String| if from == to { text } else { format!("{to}'({text})") };
    match places {
        0 => sized(expression.into()),
        up @ 1.. => format!("{} <<< {up}", sized(expression.into())),
        down => sized(format!("{expression} >>> {}", -down)),
    }
}

/// An expression of SystemVerilog with the sign of its field; not every tool knows that of a member.
fn signed(field: &Field, expression: &str) -> String {
    if field.signed { format!("$signed({expression})") } else { expression.into() }
}

fn sv_member(field: &Field) -> String {
    let sign = if field.signed { "signed " } else { "" };
    format!("    logic {sign}[{}:0] {};  // {}", field.width - 1, column(field), note(field))
}

fn sv_place(field: &Field) -> String {
    format!("    with_outputs[{} +: {}] = outputs.{};", field.lsb, field.width, column(field))
}

fn sv_comparison(field: &Field, stem: &str) -> String {
    let (Field { name, stage, fraction_bits, .. }, column) = (field, column(field));
    let compared = if field.direction == Direction::Tap { "!outputs_only && " } else { "" };
    let [expected, got] = ["expected", "got"].map(|word| {
        let member = format!("{word}.{column}");
        format!("{member}, number(64'({}), {fraction_bits})", signed(field, &member))
    });
    format!(
        "      if ({compared}expected.{column} !== got.{column}) begin\n        compare = compare + 1;\n        if (!silent) \
         $display(\"{stem} #%0d: stage {stage}, field {name}: expected %h = %.10g, got %h = %.10g\", index,\n                 \
         {expected}, {got});\n      end"
    )
}

/// Every other time all of them, else one.
fn dpi_drawn(index: usize, field: &Field, place: &str) -> String {
    format!(
        "    if (which == {index} || which >= INPUTS) drawn.{} = {}'(random_input({place}));",
        column(field),
        field.width
    )
}

fn dpi_given(field: &Field, place: &str) -> String {
    format!("    given[{place}] = 32'({});", signed(field, &format!("inputs.{}", column(field))))
}

fn dpi_result(field: &Field, place: &str) -> String {
    format!("    computed.{} = {}'(results[{place}]);", column(field), field.width)
}

fn dpi_shown(field: &Field) -> String {
    format!("    $write(\" {}=%h\", inputs.{});", field.name, column(field))
}

fn vhdl_type(field: &Field) -> &'static str {
    if field.signed { "signed" } else { "unsigned" }
}

fn vhdl_member(field: &Field) -> String {
    format!("    {} : {}({} downto 0);  -- {}", column(field), vhdl_type(field), field.width - 1, note(field))
}

fn vhdl_part(field: &Field) -> String {
    let (high, low) = (field.lsb + field.width - 1, field.lsb);
    format!("    result.{} := {}(word({high} downto {low}));", column(field), vhdl_type(field))
}

fn vhdl_place(field: &Field) -> String {
    let (high, low) = (field.lsb + field.width - 1, field.lsb);
    format!("    result({high} downto {low}) := std_ulogic_vector(outputs.{});", column(field))
}

fn vhdl_comparison(field: &Field) -> String {
    let (Field { name, stage, signed, fraction_bits, .. }, column) = (field, column(field));
    let is_tap = field.direction == Direction::Tap;
    format!(
        "    field(\"{stage}\", \"{name}\", {is_tap}, {signed}, {fraction_bits},\n          \
         std_ulogic_vector(expected.{column}), std_ulogic_vector(got.{column}));"
    )
}

fn cpp_field(field: &Field) -> String {
    let Field { stage, name, lsb, width, signed, fraction_bits, .. } = field;
    let is_tap = field.direction == Direction::Tap;
    format!("    {{\"{stage}\", \"{name}\", {lsb}, {width}, {signed}, {fraction_bits}, {is_tap}}},")
}
