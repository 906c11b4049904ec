//! Linked programs: their size in bytes and the tables that they hold.

use std::collections::BTreeMap;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionFlags, SymbolKind, elf};

use crate::Failure;

/// Instructions of a function of the core in a program whose instructions have four bytes each.
pub fn instructions(path: &Path, function: &str) -> Result<Vec<u32>, Failure> {
    let trouble = |error: &dyn std::fmt::Display| Failure::trouble(format!("{}: {error}", path.display()));
    let file = std::fs::read(path).map_err(|error| trouble(&error))?;
    let elf = object::File::parse(&*file).map_err(|error| trouble(&error))?;
    let is_named = |name: &str| format!("{:#}", rustc_demangle::demangle(name)) == format!("roughxel_core::{function}");
    let symbol = elf.symbols().find(|symbol| symbol.name().is_ok_and(is_named));
    let code = symbol.and_then(|symbol| {
        let section = elf.section_by_index(symbol.section_index()?).ok()?;
        section.data_range(symbol.address(), symbol.size()).ok()?
    });
    let code = code.ok_or_else(|| trouble(&format!("no code of {function}")))?;
    Ok(code.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect())
}

/// Memory of a program from its first address on.
pub fn memory(path: &Path) -> Result<Vec<u8>, Failure> {
    let trouble = |error: &dyn std::fmt::Display| Failure::trouble(format!("{}: {error}", path.display()));
    let file = std::fs::read(path).map_err(|error| trouble(&error))?;
    let elf = object::File::parse(&*file).map_err(|error| trouble(&error))?;
    let mut memory = Vec::new();
    let first = elf.segments().map(|segment| segment.address()).min().ok_or_else(|| trouble(&"nothing to load"))?;
    for segment in elf.segments() {
        let (place, data) = ((segment.address() - first) as usize, segment.data().map_err(|error| trouble(&error))?);
        memory.resize(memory.len().max((place + data.len()).next_multiple_of(4)), 0);
        memory[place..place + data.len()].copy_from_slice(data);
    }
    Ok(memory)
}

/// Memory as the simulations read it: a word a line in hexadecimal digits.
pub fn words(memory: &[u8]) -> String {
    memory.as_chunks().0.iter().map(|bytes| format!("{:08x}\n", u32::from_le_bytes(*bytes))).collect()
}

/// Measures of a linked program.
#[derive(Clone, Debug)]
pub struct Image {
    /// Bytes of code, constants and initial data.
    pub bytes: u64,
    /// Tables of the datapath by their names, with their place in the file and their bytes.
    pub tables: BTreeMap<String, (u64, u64)>,
}

impl Image {
    /// Reads a program.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let trouble = |error: &dyn std::fmt::Display| Failure::trouble(format!("{}: {error}", path.display()));
        let file = std::fs::read(path).map_err(|error| trouble(&error))?;
        let elf = object::File::parse(&*file).map_err(|error| trouble(&error))?;
        let loaded = elf.sections().filter(|section| {
            matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & u64::from(elf::SHF_ALLOC) != 0)
                && section.file_range().is_some()
        });
        let bytes = loaded.map(|section| section.size()).sum();
        let mut tables = BTreeMap::new();
        for symbol in elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data && symbol.size() > 0) {
            let name = symbol.name().map_err(|error| trouble(&error))?;
            let name = format!("{:#}", rustc_demangle::demangle(name));
            let Some(table) =
                ["roughxel_core::rom::", "roughxel_core::small::"].iter().find_map(|module| name.strip_prefix(module))
            else {
                continue;
            };
            let section = symbol.section_index().and_then(|index| elf.section_by_index(index).ok());
            let place =
                section.and_then(|section| Some(section.file_range()?.0 + symbol.address() - section.address()));
            if let Some(place) = place {
                tables.insert(table.to_string(), (place, symbol.size()));
            }
        }
        Ok(Self { bytes, tables })
    }
}
