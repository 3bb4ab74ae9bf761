//! What a program file says of itself: its functions, and where calls through its tables go.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs;
use std::path::Path;

use object::{
    File, Object as _, ObjectSymbol as _, ObjectSymbolTable as _, Relocation, RelocationTarget,
    SymbolKind,
};

/// A function of a program.
pub struct Function {
    /// Readable name, without the hash of the compiler.
    pub name: String,
    /// First address.
    pub address: u64,
    /// Bytes of code.
    pub size: u64,
}

/// A program file.
pub struct Binary {
    /// Its functions.
    pub functions: Vec<Function>,
    /// Names of the functions whose addresses the loader writes into a table, by the place in it.
    pub slots: BTreeMap<u64, String>,
}

impl Binary {
    /// Reads the symbol table and the relocations of a program.
    pub fn read(path: &Path) -> Result<Self, String> {
        let explain = |error: &dyn Display| format!("{}: {error}", path.display());
        let data = fs::read(path).map_err(|error| explain(&error))?;
        let file = File::parse(data.as_slice()).map_err(|error| explain(&error))?;
        let functions = functions(&file);
        let slots = slots(&file, &functions);
        Ok(Self { functions, slots })
    }

    /// The function that begins at this address.
    pub fn at(&self, address: u64) -> Option<&Function> {
        self.functions.iter().find(|function| function.address == address)
    }
}

/// The name as it stands in the source; that of a function outside Rust as it is.
pub fn readable(symbol: &str) -> String {
    let bare = symbol.split('@').next().unwrap_or(symbol);
    format!("{:#}", rustc_demangle::demangle(bare))
}

fn functions(file: &File<'_>) -> Vec<Function> {
    let code = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text);
    code.filter(object::ObjectSymbol::is_definition)
        .map(|symbol| Function {
            name: readable(symbol.name().unwrap_or_default()),
            address: symbol.address(),
            size: symbol.size(),
        })
        .collect()
}

fn slots(file: &File<'_>, functions: &[Function]) -> BTreeMap<u64, String> {
    let by_address: BTreeMap<u64, &str> =
        functions.iter().map(|function| (function.address, function.name.as_str())).collect();
    let imported = file.dynamic_symbol_table();
    let name = |entry: &Relocation| match entry.target() {
        RelocationTarget::Symbol(index) => {
            imported.as_ref()?.symbol_by_index(index).ok()?.name().ok().map(readable)
        }
        _ => by_address.get(&entry.addend().cast_unsigned()).map(|&name| name.to_owned()),
    };
    file.dynamic_relocations()
        .into_iter()
        .flatten()
        .filter_map(|(place, entry)| Some((place, name(&entry)?)))
        .collect()
}
