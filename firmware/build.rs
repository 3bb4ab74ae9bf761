//! Tells the linker the memory layout and the start-up code.

use std::env;
use std::path::Path;

fn main() {
    let here = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo::rustc-link-search={here}");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rerun-if-env-changed=STORMPETREL_RECORDING");
    if env::var_os("STORMPETREL_RECORDING").is_none() {
        // Without a recording there is nothing to replay; the other programs need none.
        let empty = Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join("empty");
        let _ = std::fs::write(&empty, []);
        println!("cargo::rustc-env=STORMPETREL_RECORDING={}", empty.display());
    }
}
