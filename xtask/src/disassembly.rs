//! Is the loop over several vehicles one function for each register width?
//!
//! A function that is not inlined is compiled for the smallest width, with its arguments through memory.
//! No result shows that, only the time. So the machine code of the loop is read: where it calls, how wide
//! it computes, and that no multiplication is fused with an addition, which would round once instead of
//! twice.

use crate::binary::{Binary, Function};
use crate::code::Code;
use crate::run::{Step, target_dir};

/// A compilation of the loop: name, parts of its function's name, registers it must compute in.
const WIDTHS: [(&str, [&str; 2], &str); 3] = [
    ("baseline", ["dispatch::Ordinary", "run"], "%xmm"),
    ("avx2", ["V3", "vectorize::imp"], "%ymm"),
    ("avx512", ["V4", "vectorize::imp"], "%zmm"),
];

/// What the loop may call: names of C in full, of Rust in part.
const ALLOWED: [&str; 12] = [
    // Copies of whole records.
    "memcpy",
    "memmove",
    "memset",
    // Only where an input, a law or a state is not finite, or a lane is empty.
    "::settle",
    "::mend",
    "::restart",
    "Record::finite",
    // Only where a reference lies on its side or upside down, or has no direction.
    "attitude_reference::Pointing<T>::",
    // Only where the loop is left by a panic.
    "_Unwind_Resume",
    "core::panicking::panic_in_cleanup",
    // The choice of the width stands in the function of the baseline.
    "__detect_is_available",
    "vectorize::imp",
];

/// Blocks with a boundary of their own, which a plain flight never calls at a tick: the whole world, sensors,
/// delays, and what a change of the step asks for.
const APART: [&str; 7] = [
    "dispatch::rarely",
    "flight::Flight<T>::late",
    "flight::Flight<T>>::prepare",
    "flight::Flight<T>>::sense",
    "flight::Flight<T>>::unexplained",
    "world::advance",
    "world::look",
];

/// Packed operations that the closed loop has at least: a function with fewer is something else.
const LOOP: usize = 1000;

/// Fails where the loop over lanes calls what it should contain, computes in narrow registers, or fuses.
pub fn check() -> Result<(), String> {
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        eprintln!("== disassembly: left out, only x86-64 has several widths");
        return Ok(());
    }
    // As the release tests build it: nothing is left to do after them.
    let build = ["test", "--release", "--workspace", "--test", "commands", "--no-run"];
    Step::cargo("program", &build).run()?;
    let path = target_dir().join("release/stormpetrel");
    let binary = Binary::read(&path)?;
    let mut faults = Vec::new();
    for (width, parts, registers) in WIDTHS {
        let holds = |f: &&Function| parts.iter().all(|part| f.name.contains(part));
        let mut largest = 0;
        for function in binary.functions.iter().filter(holds) {
            let code = Code::read(&disassembled(&path.to_string_lossy(), function)?, &binary);
            eprintln!("== {width}: {}", describe(&code, registers));
            let found = if is_loop(&code) {
                largest = largest.max(code.all_packed());
                faults_of(&code, registers)
            } else {
                fused(&code).into_iter().collect()
            };
            faults.extend(found.iter().map(|fault| format!("{width}: {fault}")));
        }
        if largest < LOOP {
            faults.push(format!("{width}: no function {} holds the loop", parts.join(" ... ")));
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(format!("disassembly\n  {}", faults.join("\n  "))) }
}

/// The machine code of a function, a line an instruction.
fn disassembled(program: &str, function: &Function) -> Result<String, String> {
    let from = format!("--start-address={}", function.address);
    let to = format!("--stop-address={}", function.address + function.size);
    let arguments = ["--disassemble", "--no-show-raw-insn", &from, &to, program];
    Step::new("objdump, which comes with gcc", "objdump", &arguments).output()
}

fn describe(code: &Code, registers: &str) -> String {
    let calls: Vec<String> =
        code.calls.iter().map(|(name, count)| format!("\n     {count:3} {name}")).collect();
    format!(
        "{} packed operations on doubles, {} of them in {registers}, {} on one double, {} fused; calls{}",
        code.all_packed(),
        code.packed_in(registers),
        code.single,
        code.fused.len(),
        calls.concat()
    )
}

fn faults_of(code: &Code, registers: &str) -> Vec<String> {
    let strangers = code.calls.iter().filter(|(name, _)| !allowed(name));
    let mut faults: Vec<String> = strangers
        .map(|(name, count)| {
            format!("{name} is called {count} times: `#[inline(always)]` is missing")
        })
        .collect();
    // What surrounds the loop may be packed in narrower registers.
    if code.packed_in(registers) * 10 < code.all_packed() * 9 {
        faults.push(format!("too few operations in {registers}"));
    }
    faults.extend(fused(code));
    faults
}

/// Whether it is the loop, and not one of the blocks apart.
fn is_loop(code: &Code) -> bool {
    code.calls.iter().any(|(name, _)| APART.iter().any(|part| name.contains(part)))
}

fn fused(code: &Code) -> Option<String> {
    code.fused.first().map(|fused| format!("{fused} rounds once instead of twice"))
}

fn allowed(name: &str) -> bool {
    let known = |known: &&str| name == *known || name.contains("::") && name.contains(known);
    ALLOWED.iter().chain(&APART).any(known)
}
