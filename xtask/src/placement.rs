//! The skeleton for the STM32H743 builds, and its linker puts code and data where the
//! cycle needs them.

use std::ops::Range;

use crate::tools::{LLVM, Outcome, TARGET, Trouble, cargo, find, llvm_tool, root};
use crate::tools::{run as output_of, work};

const PACKAGE: &str = "firmware/boards/stm32h743";

/// A memory by its name and addresses.
type Memory = (&'static str, Range<u64>);

const ITCM: Memory = ("ITCM", 0x40..0x1_0000);
const DTCM: Memory = ("DTCM", 0x2000_0000..0x2002_0000);

/// What has to be in the image: parts of its name, and where it belongs. Stages are
/// entries of a list, so that a call of one need not be direct.
const REQUIRED: [(&[&str], &Memory); 6] = [
    (&["stm32h743::cycle::Loop", "::run::"], &ITCM),
    (&["controller_core::cycle::stages::"], &ITCM),
    (&["controller_core::cycle::stages::run_law"], &ITCM),
    (&["controller_core::law::limits::projection::"], &ITCM),
    (&["stm32h743", "::CONTROL"], &DTCM),
    (&["_stack_start"], &DTCM),
];

/// In the name of what the linker puts where a call cannot reach: flash is too far from
/// ITCM, so that every direct call out of it has one.
const THUNK: &str = "LongThunk_";

/// Called from ITCM and in flash all the same: what bends a straight arm, and what changes tasks and
/// gains. They run while a level is released and off its target, and while something changes, and
/// would take a tenth of ITCM.
const IN_FLASH: [&str; 3] = ["way_out", "ActiveTasks", "forget_levels"];

/// Builds it and checks the addresses.
pub fn run() -> Outcome {
    find(&[LLVM])?;
    let build = work()?.join("stm32h743");
    // In the workspace, where the configuration with the target's CPU is found.
    let mut cargo = cargo("build");
    cargo.args([
        "--locked",
        "--release",
        "--target",
        TARGET,
        "--manifest-path",
    ]);
    cargo.arg(root().join(PACKAGE).join("Cargo.toml"));
    output_of(cargo.arg("--target-dir").arg(&build))?;
    let image = build.join(TARGET).join("release/stm32h743");
    let mut nm = llvm_tool("llvm-nm")?;
    nm.args(["--demangle", "--defined-only"]).arg(&image);
    let symbols = symbols(&output_of(&mut nm)?);
    let misplaced = misplaced(&symbols);
    for line in &misplaced {
        println!("{line}");
    }
    for (parts, (memory, _)) in REQUIRED {
        for (address, name) in symbols.iter().filter(|(_, name)| has(name, parts)) {
            println!("{address:#010x} {memory}: {}", short(name));
        }
    }
    let size = |from: &str, to: &str| -> Result<u64, Trouble> {
        let address = |wanted: &str| symbols.iter().find(|(_, name)| name == wanted);
        match (address(from), address(to)) {
            (Some((from, _)), Some((to, _))) => Ok(to - from),
            _ => Err(Trouble::new(format!("no {from} or {to} in the image"))),
        }
    };
    let code = size("__itcm_start", "__itcm_end")?;
    let data = size("__sdata", "__ebss")?;
    println!("code of the cycle: {code} bytes of 65472; data besides the stack: {data} of 131072");
    Ok(misplaced.is_empty())
}

/// Addresses and names of functions, variables and the linker's thunks.
fn symbols(text: &str) -> Vec<(u64, String)> {
    let line = |line: &str| {
        let (address, rest) = line.split_once(' ')?;
        let (_, name) = rest.split_once(' ')?;
        let address = u64::from_str_radix(address, 16).ok()?;
        Some((address, name.to_string()))
    };
    text.lines().filter_map(line).collect()
}

fn has(name: &str, parts: &[&str]) -> bool {
    parts.iter().all(|part| name.contains(part))
}

/// The path without its hash.
fn short(name: &str) -> &str {
    name.rsplit_once("::h").map_or(name, |(path, _)| path)
}

/// One line per symbol that is missing or lies elsewhere, and per call out of ITCM: with
/// none of these everything below the loop and the stages lies in it.
fn misplaced(symbols: &[(u64, String)]) -> Vec<String> {
    let mut lines = Vec::new();
    for (parts, (memory, range)) in REQUIRED {
        let found: Vec<_> = symbols
            .iter()
            .filter(|(_, name)| has(name, parts))
            .collect();
        if found.is_empty() {
            lines.push(format!("{}: not in the image", parts.concat()));
        }
        for (address, name) in found {
            // The stack begins behind the last address.
            if !range.contains(address) && *address != range.end {
                let (name, std::ops::Range { start, end }) = (short(name), range);
                lines.push(format!(
                    "{name}: at {address:#x}; allowed {start:#x} to {end:#x}, {memory}"
                ));
            }
        }
    }
    let (memory, range) = &ITCM;
    for (_, name) in symbols
        .iter()
        .filter(|(address, _)| range.contains(address))
    {
        let callee = name.split_once(THUNK).map(|(_, callee)| callee);
        if let Some(callee) =
            callee.filter(|callee| !IN_FLASH.iter().any(|part| callee.contains(part)))
        {
            lines.push(format!("{callee}: not in {memory}, called from it"));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "\
00000050 t stm32h743::cycle::Loop$LT$J$GT$::run::h8b38
00000580 t controller_core::cycle::stages::run_law::h2800
00000600 t controller_core::law::limits::projection::Projection$LT$T$GT$::project::h2800
00007e28 t controller_core::cycle::stages::hierarchy::h3ade
0800f4c0 t controller_core::task::set::TaskSet::new::h6c88
080056c4 t __Thumbv7ABSLongThunk___aeabi_memcpy8
20000008 d stm32h743::__cortex_m_rt_main_trampoline::CONTROL::hc773
20020000 A _stack_start";

    #[test]
    fn what_lies_elsewhere_is_named_with_its_address() {
        assert!(misplaced(&symbols(GOOD)).is_empty());
        let slow = GOOD.replace("00007e28", "08007e28");
        assert_eq!(
            misplaced(&symbols(&slow)),
            [
                "controller_core::cycle::stages::hierarchy: at 0x8007e28; allowed 0x40 to 0x10000, ITCM"
            ]
        );
        let gone = GOOD.replace("::run_law::", "::observer::");
        assert_eq!(misplaced(&symbols(&gone)).len(), 1);
        assert_eq!(
            misplaced(&symbols(&GOOD.replace("20000008", "24000008"))).len(),
            1
        );
    }

    #[test]
    fn a_call_out_of_itcm_is_named() {
        let far = GOOD.replace("080056c4", "000056c4");
        assert_eq!(
            misplaced(&symbols(&far)),
            ["__aeabi_memcpy8: not in ITCM, called from it"]
        );
    }
}
