//! `MODULE.xml`: the shell as a component of IP-XACT (IEEE 1685-2014).

use std::io::{self, Write};

use quick_xml::events::{BytesDecl, BytesText, Event};
use quick_xml::writer::Writer;

use super::description::Shell;
use super::register::{ADDRESS_BITS, Access, Register};

/// Namespace of the standard.
const NAMESPACE: &str = "http://www.accellera.org/XMLSchema/IPXACT/1685-2014";

/// Owner and library of the buses, as Arm names them.
const ARM: [(&str, &str); 2] = [("vendor", "amba.com"), ("library", "AMBA4")];

type Xml = Writer<Vec<u8>>;

/// An element with what `inside` writes.
fn node(xml: &mut Xml, name: &str, inside: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    xml.create_element(format!("ipxact:{name}")).write_inner_content(inside).map(drop)
}

/// An element with a text.
fn leaf(xml: &mut Xml, name: &str, text: impl ToString) -> io::Result<()> {
    xml.create_element(format!("ipxact:{name}")).write_text_content(BytesText::new(&text.to_string())).map(drop)
}

/// A bus: name and version in Arm's library.
type Bus = (&'static str, &'static str);

const STREAM: Bus = ("AXI4Stream", "r0p0_1");
const LITE: Bus = ("AXI4-Lite", "r0p0_0");

/// A reference to a bus of Arm, or with an ending to its abstraction.
fn reference(xml: &mut Xml, element: &str, (bus, version): Bus, ending: &str) -> io::Result<()> {
    let name = format!("{bus}{ending}");
    let attributes = ARM.into_iter().chain([("name", name.as_str()), ("version", version)]);
    xml.create_element(format!("ipxact:{element}")).with_attributes(attributes).write_empty().map(drop)
}

/// A port of the shell: name, direction, bits.
type Port = (String, &'static str, u32);

/// Ports of a stream whose data enter or leave.
fn stream(prefix: &str, to: &'static str, from: &'static str, bits: u32) -> Vec<Port> {
    let port = |name: &str, direction, bits| (format!("{prefix}_{name}"), direction, bits);
    vec![port("tvalid", to, 1), port("tready", from, 1), port("tdata", to, bits), port("tlast", to, 1)]
}

/// Ports of the registers.
fn lite() -> Vec<Port> {
    let channel =
        |name: &str, to, from| [(format!("s_axi_{name}valid"), to, 1), (format!("s_axi_{name}ready"), from, 1)];
    let data = |name: &str, direction, bits| [(format!("s_axi_{name}"), direction, bits)];
    [
        channel("aw", "in", "out").to_vec(),
        data("awaddr", "in", ADDRESS_BITS).to_vec(),
        channel("w", "in", "out").to_vec(),
        data("wdata", "in", 32).to_vec(),
        data("wstrb", "in", 4).to_vec(),
        channel("b", "out", "in").to_vec(),
        data("bresp", "out", 2).to_vec(),
        channel("ar", "in", "out").to_vec(),
        data("araddr", "in", ADDRESS_BITS).to_vec(),
        channel("r", "out", "in").to_vec(),
        data("rdata", "out", 32).to_vec(),
        data("rresp", "out", 2).to_vec(),
    ]
    .concat()
}

/// A bus interface of clock, reset and some ports; `mode` writes its role.
fn interface(
    xml: &mut Xml,
    name: &str,
    bus: Bus,
    ports: &[Port],
    mode: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    node(xml, "busInterface", |xml| {
        leaf(xml, "name", name)?;
        reference(xml, "busType", bus, "")?;
        node(xml, "abstractionTypes", |xml| {
            node(xml, "abstractionType", |xml| {
                reference(xml, "abstractionRef", bus, "_rtl")?;
                node(xml, "portMaps", |xml| {
                    let logical =
                        |port: &str| port.trim_start_matches(name).trim_start_matches('_').to_ascii_uppercase();
                    let clock = [("ACLK".to_owned(), "aclk"), ("ARESETn".to_owned(), "aresetn")];
                    let own = ports.iter().map(|(port, ..)| (logical(port), port.as_str()));
                    clock.into_iter().chain(own).try_for_each(|(logical, physical)| {
                        node(xml, "portMap", |xml| {
                            node(xml, "logicalPort", |xml| leaf(xml, "name", logical))?;
                            node(xml, "physicalPort", |xml| leaf(xml, "name", physical))
                        })
                    })
                })
            })
        })?;
        mode(xml)
    })
}

/// A register with one field.
fn register(xml: &mut Xml, of: &Register) -> io::Result<()> {
    let access = if of.access == Access::ReadOnly { "read-only" } else { "read-write" };
    node(xml, "register", |xml| {
        leaf(xml, "name", &of.name)?;
        leaf(xml, "description", &of.description)?;
        leaf(xml, "addressOffset", format!("'h{:x}", of.offset))?;
        leaf(xml, "size", 32)?;
        leaf(xml, "volatile", of.port.is_none() && of.access == Access::ReadWrite)?;
        leaf(xml, "access", access)?;
        node(xml, "field", |xml| {
            leaf(xml, "name", &of.name)?;
            leaf(xml, "bitOffset", 0)?;
            node(xml, "resets", |xml| node(xml, "reset", |xml| leaf(xml, "value", format!("'h{:x}", of.reset))))?;
            leaf(xml, "bitWidth", of.width)?;
            leaf(xml, "access", access)
        })
    })
}

/// A file set with files of one kind.
fn file_set(xml: &mut Xml, name: &str, kind: &str, files: &[&str]) -> io::Result<()> {
    node(xml, "fileSet", |xml| {
        leaf(xml, "name", name)?;
        files.iter().try_for_each(|file| {
            node(xml, "file", |xml| {
                leaf(xml, "name", file)?;
                leaf(xml, "fileType", kind)
            })
        })
    })
}

/// Views of the component, the module and the ports.
fn model(xml: &mut Xml, shell: &Shell, ports: &[Port]) -> io::Result<()> {
    node(xml, "views", |xml| {
        node(xml, "view", |xml| {
            leaf(xml, "name", "rtl")?;
            leaf(xml, "envIdentifier", "::")?;
            leaf(xml, "componentInstantiationRef", "verilog")
        })
    })?;
    node(xml, "instantiations", |xml| {
        node(xml, "componentInstantiation", |xml| {
            leaf(xml, "name", "verilog")?;
            leaf(xml, "language", "verilog")?;
            leaf(xml, "moduleName", &shell.module)?;
            let sets = ["rtl", "constraints"];
            sets.iter().try_for_each(|set| node(xml, "fileSetRef", |xml| leaf(xml, "localName", set)))
        })
    })?;
    node(xml, "ports", |xml| {
        ports.iter().try_for_each(|(name, direction, bits)| {
            node(xml, "port", |xml| {
                leaf(xml, "name", name)?;
                node(xml, "wire", |xml| {
                    leaf(xml, "direction", direction)?;
                    if *bits == 1 {
                        return Ok(());
                    }
                    node(xml, "vectors", |xml| {
                        node(xml, "vector", |xml| {
                            leaf(xml, "left", bits - 1)?;
                            leaf(xml, "right", 0)
                        })
                    })
                })
            })
        })
    })
}

/// The component.
fn component(xml: &mut Xml, shell: &Shell, sources: &[&str]) -> io::Result<()> {
    let (bits, design) = (shell.stream_bits, &shell.design.module);
    let [taken, given] = [stream("s_axis", "in", "out", bits), stream("m_axis", "out", "in", bits)];
    let lite = lite();
    let clock = ["aclk", "aresetn"].map(|name| (name.to_owned(), "in", 1));
    let ports = [&clock[..], &taken, &given, &lite].concat();
    let identity =
        [("vendor", "roughxel"), ("library", "generated"), ("name", &shell.module), ("version", shell.version)];
    identity.iter().try_for_each(|(name, text)| leaf(xml, name, text))?;
    let empty = |xml: &mut Xml, name: &str| xml.create_element(format!("ipxact:{name}")).write_empty().map(drop);
    node(xml, "busInterfaces", |xml| {
        interface(xml, "s_axis", STREAM, &taken, |xml| empty(xml, "slave"))?;
        interface(xml, "m_axis", STREAM, &given, |xml| empty(xml, "master"))?;
        interface(xml, "s_axi", LITE, &lite, |xml| {
            node(xml, "slave", |xml| {
                let map = xml.create_element("ipxact:memoryMapRef").with_attribute(("memoryMapRef", "registers"));
                map.write_empty().map(drop)
            })
        })
    })?;
    node(xml, "memoryMaps", |xml| {
        node(xml, "memoryMap", |xml| {
            leaf(xml, "name", "registers")?;
            node(xml, "addressBlock", |xml| {
                leaf(xml, "name", "constants")?;
                leaf(xml, "baseAddress", "'h0")?;
                leaf(xml, "range", format!("'h{:x}", 1 << ADDRESS_BITS))?;
                leaf(xml, "width", 32)?;
                leaf(xml, "usage", "register")?;
                shell.registers.iter().try_for_each(|of| register(xml, of))
            })?;
            leaf(xml, "addressUnitBits", 8)
        })
    })?;
    node(xml, "model", |xml| model(xml, shell, &ports))?;
    node(xml, "fileSets", |xml| {
        file_set(xml, "rtl", "verilogSource-2001", sources)?;
        file_set(xml, "constraints", "SDC", &[&format!("{design}.sdc")])
    })?;
    leaf(xml, "description", &shell.origin)
}

/// Text of the component.
pub(super) fn text(shell: &Shell, sources: &[&str]) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    let root = |xml: &mut Xml| {
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        let element = xml.create_element("ipxact:component").with_attribute(("xmlns:ipxact", NAMESPACE));
        element.write_inner_content(|xml| component(xml, shell, sources))?;
        xml.get_mut().write_all(b"\n")
    };
    // Writing to memory cannot fail, and all text is UTF-8.
    let _ = root(&mut xml);
    String::from_utf8(xml.into_inner()).unwrap_or_default()
}
