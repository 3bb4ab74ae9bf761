//! Counts calls and arithmetic in the machine code of one function, as objdump prints it for x86-64.

use std::collections::BTreeMap;

use crate::binary::{Binary, readable};

/// Arithmetic, before the `sd` of one double and the `pd` of several.
const ARITHMETIC: [&str; 5] = ["add", "sub", "mul", "div", "sqrt"];

/// What stands in a function.
#[derive(Default)]
pub struct Code {
    /// Which functions it calls or takes the address of, and how often.
    pub calls: BTreeMap<String, usize>,
    /// Arithmetic on one double.
    pub single: usize,
    /// Fused multiplications and additions.
    pub fused: Vec<String>,
    packed: BTreeMap<&'static str, usize>,
}

impl Code {
    /// Reads lines like `  2f9db8:<tab>call   284530 <name>`.
    pub fn read(text: &str, binary: &Binary) -> Self {
        let (mut code, mut loaded) = (Self::default(), BTreeMap::new());
        for (_, instruction) in text.lines().filter_map(|line| line.split_once('\t')) {
            let (name, operands) = instruction.split_once(' ').unwrap_or((instruction, ""));
            let operands = operands.trim();
            code.arithmetic(name, operands);
            let called = called(name, operands, binary);
            if let Some(called) = called.or_else(|| method(name, operands, &loaded)) {
                *code.calls.entry(called).or_default() += 1;
            }
            let written = operands.split(" #").next().unwrap_or(operands).trim_end();
            if let Some((from, register)) = written.rsplit_once(',') {
                loaded.insert(register, if name == "mov" { from } else { "" });
            }
        }
        code
    }

    /// Arithmetic on several doubles.
    pub fn all_packed(&self) -> usize {
        self.packed.values().sum()
    }

    /// Arithmetic on several doubles in these registers: `%xmm`, `%ymm` or `%zmm`.
    pub fn packed_in(&self, registers: &str) -> usize {
        self.packed.get(registers).copied().unwrap_or_default()
    }

    fn arithmetic(&mut self, name: &str, operands: &str) {
        let plain = name.strip_prefix('v').unwrap_or(name);
        let is = |kind| plain.strip_suffix(kind).is_some_and(|what| ARITHMETIC.contains(&what));
        if name.starts_with("vfm") || name.starts_with("vfnm") {
            self.fused.push(name.to_owned());
        } else if is("sd") {
            self.single += 1;
        } else if is("pd") {
            let wide = ["%zmm", "%ymm"].into_iter().find(|kind| operands.contains(kind));
            *self.packed.entry(wide.unwrap_or("%xmm")).or_default() += 1;
        }
    }
}

/// The method of a trait object that a call through a register goes to: the address was `loaded` from
/// memory other than the stack. Every other address was taken by an instruction that [`called`] counts.
fn method(name: &str, operands: &str, loaded: &BTreeMap<&str, &str>) -> Option<String> {
    let register = operands.strip_prefix('*').filter(|_| name.starts_with("call"))?;
    let from = loaded.get(register)?;
    let near = ["(%rsp", "(%rbp", "(%rip"].iter().any(|base| from.contains(base));
    (from.contains('(') && !near).then(|| format!("a method at {from}"))
}

/// The function that the instruction calls, jumps to or takes the address of.
fn called(name: &str, operands: &str, binary: &Binary) -> Option<String> {
    let call = name.starts_with("call");
    if let Some((_, place)) = operands.split_once("# ") {
        let address = u64::from_str_radix(place.split(' ').next()?, 16).ok()?;
        let taken = || binary.at(address).filter(|_| name == "lea").map(|f| f.name.clone());
        let unknown = || call.then(|| format!("a function without a name at {place}"));
        return binary.slots.get(&address).cloned().or_else(taken).or_else(unknown);
    }
    if operands.starts_with('*') {
        // `*%rax` or `*0x18(%rax)`: the latter is a method of a trait object.
        return (call && operands.contains('(')).then(|| format!("a method at {}", &operands[1..]));
    }
    // Jumps within the function aim behind its beginning, `<name+0x10>`.
    let (_, target) = operands.strip_suffix('>')?.rsplit_once('<')?;
    (call || name.starts_with('j') && !target.contains("+0x")).then(|| readable(target))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binary::Function;

    fn read(instructions: &[&str]) -> Code {
        let known = Function { name: "known".into(), address: 0x30, size: 8 };
        let binary = Binary {
            functions: vec![known],
            slots: BTreeMap::from([(0x681_440, "memcpy".to_owned())]),
        };
        let lines: Vec<String> = instructions.iter().map(|i| format!("  10:\t{i}")).collect();
        Code::read(&lines.join("\n"), &binary)
    }

    fn calls(instruction: &str) -> Vec<String> {
        read(&[instruction]).calls.into_keys().collect()
    }

    #[test]
    fn every_way_to_another_function_is_seen() {
        assert_eq!(calls("call   284530 <_ZN3lab4push17h0123456789abcdefE>"), ["lab::push"]);
        assert_eq!(calls("jmp    284530 <outside>"), ["outside"]);
        assert_eq!(calls("call   2f9 <_Unwind_Resume@plt>"), ["_Unwind_Resume"]);
        assert_eq!(calls("call   *0x4(%rip)        # 681440 <_DYNAMIC+0x240>"), ["memcpy"]);
        assert_eq!(calls("mov    0x4(%rip),%r15        # 681440 <memcpy@GLIBC>"), ["memcpy"]);
        assert_eq!(calls("lea    0x4(%rip),%r15        # 30 <known>"), ["known"]);
        assert_eq!(calls("call   *0x18(%rax)"), ["a method at 0x18(%rax)"]);
        let method = read(&["mov    0x18(%rbx),%r14", "add    $0x8,%rax", "call   *%r14"]);
        assert_eq!(method.calls.into_keys().collect::<Vec<_>>(), ["a method at 0x18(%rbx)"]);
        let unknown = calls("call   *0x4(%rip)        # 77 <_DYNAMIC+0x4>");
        assert_eq!(unknown, ["a function without a name at 77 <_DYNAMIC+0x4>"]);
    }

    #[test]
    fn what_stays_within_is_no_call() {
        for instruction in [
            "jne    3064f0 <imp+0xc810>",
            "call   *%r15",
            "jmp    *%rax",
            "lea    0x4(%rip),%r15        # 34 <known+0x4>",
            "vmovapd 0x4(%rip),%zmm0        # 7ca10 <table+0x1280>",
            "ret",
        ] {
            assert_eq!(calls(instruction), [""; 0], "{instruction}");
        }
        assert!(read(&["mov    0x7c8(%rsp),%r15", "call   *%r15"]).calls.is_empty());
    }

    #[test]
    fn arithmetic_is_counted_by_width() {
        let code = read(&[
            "vaddpd %zmm0,%zmm1,%zmm2",
            "vdivpd 0x64c0(%rsp),%ymm0,%ymm0",
            "mulpd  %xmm0,%xmm1",
            "vsqrtsd %xmm0,%xmm1,%xmm1",
            "vmovapd %zmm0,%zmm1",
            "vfnmadd213pd %zmm0,%zmm1,%zmm2",
        ]);
        let packed = ["%zmm", "%ymm", "%xmm"].map(|registers| code.packed_in(registers));
        assert_eq!((packed, code.all_packed(), code.single), ([1, 1, 1], 3, 1));
        assert_eq!(code.fused, ["vfnmadd213pd"]);
    }
}
