//! One line for each implementation: settings by name, the law itself, and the dispatch.

use crate::options::OptionVisitor;
use crate::record::VisitorMut;

/// A walk over everything that a file may set.
pub trait SettingsVisitor: VisitorMut<f64> + OptionVisitor {}
impl<V: VisitorMut<f64> + OptionVisitor> SettingsVisitor for V {}

/// The settings of one block of the control diagram: which law, its numbers, its options.
pub trait Settings: Copy + Sized + 'static {
    /// The key that names the law in a scenario file: `law`, `kind`, `shape` ...
    const KEY: &'static str;
    /// Names in scenario files.
    const NAMES: &'static [&'static str];
    /// Source text of each law: its module documentation holds equations and references.
    const SOURCES: &'static [&'static str];
    /// The law of that name with its default settings.
    fn named(name: &str) -> Option<Self>;
    /// The name of the law.
    fn name(&self) -> &'static str;
    /// Shows every number and option to the visitor, which may change them.
    fn settings(&mut self, v: &mut impl SettingsVisitor);
}

/// Declares the implementations of one trait.
///
/// `"name" => Type in module;` is the line to add for a new one. The module must offer `Gains<T>` (a
/// record), `Options`, and `Type::new(Gains<T>, Options, &Context<T>)`. The macro writes the module
/// declarations, the enum, its settings, the walk over its numbers, and hands the list of variants
/// to `dispatch`, a macro which implements the trait. A registry whose kinds are many and rarely asked says
/// `apart` behind it: its walks are functions of their own, which keeps the loop small.
#[macro_export]
macro_rules! registry {
    (
        $(#[$m:meta])* pub enum $name:ident / $settings:ident keyed $key:literal from $context:ident;
        dispatch $dispatch:ident ($($signature:tt)*) $($apart:ident)?;
        $( $tag:literal => $variant:ident in $module:ident; )+
    ) => {
        $( pub mod $module; )+

        $(#[$m])*
        #[derive(Clone, Copy, Debug)]
        #[allow(clippy::large_enum_variant)] // laws are plain values: no heap
        pub enum $name<T> { $(
            #[doc = concat!("`", $tag, "`")]
            $variant($module::$variant<T>),
        )+ }

        impl<T: $crate::real::Real> Default for $name<T> {
            fn default() -> Self {
                [$( Self::$variant(Default::default()) ),+][0]
            }
        }

        #[doc = concat!("Settings of [`", stringify!($name), "`] as a scenario file gives them.")]
        #[derive(Clone, Copy, Debug)]
        #[allow(clippy::large_enum_variant)]
        pub enum $settings { $(
            #[doc = concat!("`", $tag, "`")]
            $variant($module::Gains<f64>, $module::Options),
        )+ }

        impl $settings {
            /// The law with these settings.
            pub fn build(&self, context: &$context<f64>) -> $name<f64> {
                match *self { $( Self::$variant(gains, options) => {
                    $name::$variant($module::$variant::new(gains, options, context))
                } )+ }
            }
        }

        impl $crate::registry::Settings for $settings {
            const KEY: &'static str = $key;
            const NAMES: &'static [&'static str] = &[$($tag),+];
            const SOURCES: &'static [&'static str] =
                &[$(include_str!(concat!(stringify!($module), ".rs"))),+];
            fn named(name: &str) -> Option<Self> {
                match name {
                    $( $tag => Some(Self::$variant(Default::default(), Default::default())), )+
                    _ => None,
                }
            }
            fn name(&self) -> &'static str {
                match self { $( Self::$variant(..) => $tag, )+ }
            }
            fn settings(&mut self, v: &mut impl $crate::registry::SettingsVisitor) {
                use $crate::options::Options as _;
                use $crate::record::{Meta, Path, Record};
                match self { $( Self::$variant(gains, options) => {
                    options.visit(v);
                    Record::<f64>::visit_mut(gains, &Path::ROOT, &Meta::signal("", ""), v);
                } )+ }
            }
        }

        $crate::registry! { @inline [$($apart)?] $name [$($variant $module)+] }

        $dispatch! { $name [$($variant)+] ($($signature)*) }
    };
    (@inline [] $($rest:tt)*) => { $crate::registry! { @record inline(always) $($rest)* } };
    (@inline [apart] $($rest:tt)*) => { $crate::registry! { @record inline(never) $($rest)* } };
    (@record $inline:meta $name:ident [$($variant:ident $module:ident)+]) => {
        impl<T: $crate::real::Real> $crate::record::Record<T> for $name<T> {
            type With<U: $crate::real::Real> = $name<U>;
            #[$inline]
            fn visit(&self, path: &$crate::record::Path<'_>, meta: &$crate::record::Meta, v: &mut impl $crate::record::Visitor<T>) {
                match self { $( Self::$variant(law) => law.visit(path, meta, v), )+ }
            }
            #[$inline]
            fn visit_mut(&mut self, path: &$crate::record::Path<'_>, meta: &$crate::record::Meta, v: &mut impl $crate::record::VisitorMut<T>) {
                match self { $( Self::$variant(law) => law.visit_mut(path, meta, v), )+ }
            }
            #[$inline]
            fn zip<const M: usize, U: $crate::real::Real>(rows: [&Self; M], f: &mut impl FnMut([T; M]) -> U) -> $name<U> {
                match rows[0] { $( Self::$variant(first) => {
                    // A batch has one structure; a stray row counts as the first.
                    #[allow(irrefutable_let_patterns)]
                    let rows = $crate::record::each(rows, |row| if let Self::$variant(law) = row { law } else { first });
                    $name::$variant($crate::record::Record::zip(rows, f))
                } )+ }
            }
            #[$inline]
            fn pick_part(&self, i: usize) -> $name<T::Part> {
                match self { $( Self::$variant(law) => $name::$variant(law.pick_part(i)), )+ }
            }
            #[$inline]
            fn onto<U: $crate::real::Real>(&self, batch: &mut $name<U>, f: &mut impl FnMut(&mut U, T)) {
                match (self, batch) {
                    $( (Self::$variant(one), $name::$variant(batch)) => one.onto(batch, f), )+
                    // A batch has one structure; a stray row stays outside.
                    #[allow(unreachable_patterns)]
                    _ => {}
                }
            }
            #[$inline]
            fn each_variable(&self, f: &mut impl FnMut(T)) {
                match self { $( Self::$variant(law) => law.each_variable(f), )+ }
            }
            #[$inline]
            fn sum(&self, f: impl Fn(T::Part) -> T::Part) -> T {
                match self { $( Self::$variant(law) => law.sum(f), )+ }
            }
            #[$inline]
            fn finite(&self) -> T::Mask {
                match self { $( Self::$variant(law) => law.finite(), )+ }
            }
        }
    };
}
