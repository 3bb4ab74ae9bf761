//! No panic and no heap in the control stack as a microcontroller has it.
//!
//! The program `bare` of the firmware reaches every registered law in both precisions and is linked
//! without unused code: what could panic or allocate would leave its symbol there. (An allocation would
//! not even link: no program of the firmware has an allocator.) The program `panics` may panic once,
//! by an index; that this is seen shows that the search is not blind.

use crate::binary::{Binary, Function};
use crate::firmware;

/// Parts of names that the control stack must not have.
const UNWANTED: [&str; 10] = [
    "core::panicking",
    "panic_",
    "rust_begin_unwind",
    "unwrap_failed",
    "expect_failed",
    "core::slice::index",
    "core::str::slice_error",
    "core::fmt::",
    "alloc::",
    "__rust_",
];

/// Parts of names that `bare` must have, or it does not hold the stack: the exercise in double and in
/// single precision, a guard, and the software's double precision.
const HELD: [(&str, usize); 3] = [("exercise::stack", 2), ("::mend", 2), ("__aeabi_dmul", 1)];

/// Fails where the control stack may panic, allocate or format text.
pub fn check() -> Result<(), String> {
    let [bare, panics] = firmware::bare(["bare", "panics"])?;
    let (bare, panics) = (Binary::read(&bare)?.functions, Binary::read(&panics)?.functions);
    if unwanted(&panics).is_empty() {
        return Err(
            "symbols: no panic found in the program that has one: the search is blind".into()
        );
    }
    for (part, times) in HELD {
        if bare.iter().filter(|function| function.name.contains(part)).count() < times {
            return Err(format!(
                "symbols: the program `bare` lacks {part}: it holds no control stack"
            ));
        }
    }
    let found = unwanted(&bare);
    if !found.is_empty() {
        return Err(format!("symbols: the control stack can reach\n  {}", found.join("\n  ")));
    }
    let bytes: u64 = bare.iter().map(|function| function.size).sum();
    eprintln!(
        "== symbols: {} functions, {} kB, every law in double and single precision: no panic, no heap, no \
         formatting; in the counter-check {}",
        bare.len(),
        bytes / 1000,
        unwanted(&panics).join(", ")
    );
    Ok(())
}

fn unwanted(functions: &[Function]) -> Vec<String> {
    let bad = |name: &str| UNWANTED.iter().any(|part| name.contains(part));
    functions.iter().filter(|function| bad(&function.name)).map(|f| f.name.clone()).collect()
}
