//! Options: choices by name and tables that change a law's structure, equal in all lanes of a batch.

use core::marker::PhantomData;

/// A choice between named alternatives.
pub trait Choice: Copy + Default {
    /// Names in scenario files, in the order of declaration.
    const NAMES: &'static [&'static str];
    /// One sentence of meaning each.
    const DOCS: &'static [&'static str];
    /// The alternative at this position; the default where there is none.
    fn at(index: usize) -> Self;
    /// Its position among the names.
    fn index(self) -> usize;
}

/// A column of a table.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name in the head of a CSV file.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Smallest and largest value.
    pub range: (f64, f64),
}

/// The columns of a table.
pub trait Columns: Copy + core::fmt::Debug + 'static {
    /// From left to right.
    const COLUMNS: &'static [Column];
    /// Fewest rows that make sense.
    const FEWEST: usize;
    /// Most rows that are taken.
    const MOST: usize;
    /// Whether the first column must grow from row to row.
    const GROWS: bool;
}

/// A table of numbers that a block brings along, such as waypoints, a curve or a recording: where it is
/// kept, and the file that it came from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cells {
    /// The numbers, row by row.
    pub cells: &'static [f64],
    /// The file; empty where the rows stand in the scenario.
    pub file: &'static str,
}

/// [`Cells`] with these columns.
#[derive(Clone, Copy, Debug)]
pub struct Rows<C> {
    /// The numbers.
    pub table: Cells,
    columns: PhantomData<C>,
}

impl<C> Default for Rows<C> {
    fn default() -> Self {
        Cells::default().into()
    }
}

impl<C> From<Cells> for Rows<C> {
    fn from(table: Cells) -> Self {
        Self { table, columns: PhantomData }
    }
}

impl<C> PartialEq for Rows<C> {
    fn eq(&self, other: &Self) -> bool {
        self.table == other.table
    }
}

impl<C: Columns> Rows<C> {
    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.table.cells.len() / C::COLUMNS.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A cell; zero outside.
    pub fn cell(&self, row: usize, column: usize) -> f64 {
        let at = row * C::COLUMNS.len() + column;
        self.table.cells.get(at).copied().unwrap_or_default()
    }
}

/// What a table may hold.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Its columns.
    pub columns: &'static [Column],
    /// Fewest and most rows.
    pub rows: (usize, usize),
    /// Whether the first column must grow from row to row.
    pub grows: bool,
}

/// Walks over options; returns what to take in place of `current`.
pub trait OptionVisitor {
    /// One choice: its name, meaning, alternatives with their meanings, and present position.
    fn choice(
        &mut self,
        _name: &'static str,
        _doc: &'static str,
        _names: &'static [&'static str],
        _docs: &'static [&'static str],
        current: usize,
    ) -> usize {
        current
    }

    /// One table: its name, meaning, shape, and present content.
    fn rows(
        &mut self,
        _name: &'static str,
        _doc: &'static str,
        _shape: &Shape,
        current: Cells,
    ) -> Cells {
        current
    }
}

/// A field of a law's options.
pub trait Field: Copy + Default {
    /// Shows itself to the visitor and takes what it answers.
    fn show(&mut self, name: &'static str, doc: &'static str, v: &mut impl OptionVisitor);
}

impl<C: Columns> Field for Rows<C> {
    fn show(&mut self, name: &'static str, doc: &'static str, v: &mut impl OptionVisitor) {
        let shape = Shape { columns: C::COLUMNS, rows: (C::FEWEST, C::MOST), grows: C::GROWS };
        *self = v.rows(name, doc, &shape, self.table).into();
    }
}

/// The options of a law.
pub trait Options: Copy + Default {
    /// Shows every option to the visitor and takes what it answers.
    fn visit(&mut self, v: &mut impl OptionVisitor);
}

/// A law without options.
impl Options for () {
    fn visit(&mut self, _: &mut impl OptionVisitor) {}
}

/// Declares a choice; the first alternative is the default.
#[macro_export]
macro_rules! choice {
    ($(#[$m:meta])* pub enum $name:ident { $( $(#[doc = $doc:literal])+ $tag:literal => $variant:ident, )+ }) => {
        $(#[$m])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $( $(#[doc = $doc])+ $variant, )+ }
        impl $name {
            const ALL: &'static [Self] = &[$(Self::$variant),+];
        }
        impl Default for $name {
            fn default() -> Self { Self::ALL[0] }
        }
        impl $crate::options::Choice for $name {
            const NAMES: &'static [&'static str] = &[$($tag),+];
            const DOCS: &'static [&'static str] = &[$(concat!($($doc),+)),+];
            fn at(index: usize) -> Self { Self::ALL.get(index).copied().unwrap_or_default() }
            fn index(self) -> usize { self as usize }
        }
        impl $crate::options::Field for $name {
            fn show(&mut self, name: &'static str, doc: &'static str, v: &mut impl $crate::options::OptionVisitor) {
                use $crate::options::Choice;
                *self = Self::at(v.choice(name, doc, Self::NAMES, Self::DOCS, self.index()));
            }
        }
    };
}

/// Declares the options of a law.
#[macro_export]
macro_rules! options {
    ($(#[$m:meta])* pub struct $name:ident { $( $(#[doc = $doc:literal])+ $f:ident : $ty:ty; )+ }) => {
        $(#[$m])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name { $( $(#[doc = $doc])+ pub $f: $ty, )+ }
        impl $crate::options::Options for $name {
            fn visit(&mut self, v: &mut impl $crate::options::OptionVisitor) {
                $( $crate::options::Field::show(&mut self.$f, stringify!($f), concat!($($doc),+), v); )+
            }
        }
    };
}

/// Declares the columns of a table.
///
/// ```
/// use stormpetrel_control::columns;
/// columns! {
///     /// Points to fly through.
///     pub struct Waypoints, 2 => 100 rows {
///         x [m] in -1e6 => 1e6;
///         y [m] in -1e6 => 1e6;
///     }
/// }
/// ```
///
/// `rows, first grows` asks that the first column grow from row to row.
#[macro_export]
macro_rules! columns {
    ($(#[$m:meta])* pub struct $name:ident, $fewest:literal => $most:literal rows $(, first $grows:ident)? {
        $( $f:ident [$($unit:tt)*] in $lo:literal => $hi:literal; )+
    }) => {
        $(#[$m])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl $crate::options::Columns for $name {
            const COLUMNS: &'static [$crate::options::Column] = &[$(
                $crate::options::Column { name: stringify!($f), unit: stringify!($($unit)*), range: ($lo, $hi) }
            ),+];
            const FEWEST: usize = $fewest;
            const MOST: usize = $most;
            const GROWS: bool = $crate::columns!(@grows $($grows)?);
        }
    };
    (@grows) => { false };
    (@grows grows) => { true };
}
