//! Options: choices by name that change a law's structure, equal in all lanes of a batch.

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

/// Walks over choices; returns the position to take in place of `current`.
pub trait OptionVisitor {
    /// One choice: its name, meaning, alternatives with their meanings, and present position.
    fn choice(
        &mut self,
        name: &'static str,
        doc: &'static str,
        names: &'static [&'static str],
        docs: &'static [&'static str],
        current: usize,
    ) -> usize;
}

/// The choices of a law.
pub trait Options: Copy + Default {
    /// Shows every choice to the visitor and takes what it answers.
    fn visit(&mut self, v: &mut impl OptionVisitor);
}

/// A law without choices.
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
    };
}

/// Declares the choices of a law.
#[macro_export]
macro_rules! options {
    ($(#[$m:meta])* pub struct $name:ident { $( $(#[doc = $doc:literal])+ $f:ident : $ty:ty; )+ }) => {
        $(#[$m])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name { $( $(#[doc = $doc])+ pub $f: $ty, )+ }
        impl $crate::options::Options for $name {
            fn visit(&mut self, v: &mut impl $crate::options::OptionVisitor) {
                $( self.$f = <$ty as $crate::options::Choice>::at(v.choice(
                    stringify!($f), concat!($($doc),+),
                    <$ty as $crate::options::Choice>::NAMES, <$ty as $crate::options::Choice>::DOCS,
                    $crate::options::Choice::index(self.$f),
                )); )+
            }
        }
    };
}
