//! A bound on the stack and the size of the code below a function, from the
//! disassembly of an image: frames from the instructions that lower the stack
//! pointer, the call graph from branches and calls.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::tools::{Trouble, llvm_tool, run};

/// Branches and calls to an address.
const BRANCHES: [&str; 18] = [
    "b", "bl", "beq", "bne", "bhs", "blo", "bmi", "bpl", "bvs", "bvc", "bhi", "bls", "bge", "blt",
    "bgt", "ble", "cbz", "cbnz",
];

/// The function whose indirect call leads to the law that a controller was made with, and the
/// laws there are.
const RUN_LAW: &str = "::stages::run_law::";
const LAWS: [&str; 2] = ["::stages::exact_law::", "::stages::law_within_limits::"];

/// An image taken apart.
#[derive(Clone)]
pub struct CallGraph {
    functions: BTreeMap<u64, Function>,
}

#[derive(Clone, Default)]
struct Function {
    name: String,
    /// Behind its last instruction or constant.
    end: u64,
    /// Everything that any of its instructions takes from the stack \[bytes\].
    frame: u64,
    callees: BTreeSet<u64>,
    /// Addresses of functions that it takes.
    taken: BTreeSet<u64>,
    /// Low halves of addresses in registers.
    halves: BTreeMap<String, u64>,
    /// An instruction that cannot be followed.
    opaque: Option<String>,
}

/// What is below a function, itself included.
#[derive(Clone, Debug)]
pub struct Below {
    /// Largest use of the stack \[bytes\]; or why there is no bound.
    pub stack: Result<u64, String>,
    /// The calls that use it, with the frame of each \[bytes\].
    pub deepest: Vec<(u64, String)>,
    /// Size of all code that can be reached \[bytes\], as far as calls can be followed.
    pub code: u64,
}

impl CallGraph {
    /// Takes an image apart.
    pub fn of(image: &Path) -> Result<Self, Trouble> {
        let mut objdump = llvm_tool("llvm-objdump")?;
        objdump.args(["--disassemble", "--demangle", "--no-show-raw-insn"]);
        Ok(Self::parse(&run(objdump
            .arg("--mcpu=cortex-m7")
            .arg(image))?))
    }

    fn parse(text: &str) -> Self {
        let mut functions: BTreeMap<u64, Function> = BTreeMap::new();
        let mut present = 0;
        for line in text.lines() {
            if let Some((address, name)) = header(line) {
                present = address;
                functions.entry(address).or_default().name = name.to_string();
            } else if let Some((address, mnemonic, operands)) = instruction(line)
                && let Some(function) = functions.get_mut(&present)
            {
                function.end = address + 4;
                function.read(mnemonic, operands);
            }
        }
        // The last instruction of a function may be a short one.
        let starts: Vec<u64> = functions.keys().copied().collect();
        for (function, &next) in functions.values_mut().zip(starts.iter().skip(1)) {
            function.end = function.end.min(next);
        }
        // Branches within a function are no calls.
        for (&start, function) in &mut functions {
            let own = start..function.end;
            function
                .callees
                .retain(|&callee| callee == start || !own.contains(&callee));
        }
        Self { functions }
    }

    /// The same where controllers are made by the function `constructor`: then it is known which
    /// laws they can have, those whose address is taken below it.
    pub fn with_laws_of(mut self, constructor: &str) -> Result<Self, Trouble> {
        let mut laws = BTreeSet::new();
        for address in self.reached(self.start(constructor)?) {
            laws.extend(self.functions.get(&address).iter().flat_map(|f| &f.taken));
        }
        let is_law = |address: &u64| {
            let function = self.functions.get(address);
            function.is_some_and(|f| LAWS.iter().any(|law| f.name.contains(law)))
        };
        laws.retain(is_law);
        if laws.is_empty() {
            let text = format!("{constructor} makes no controller with a law");
            return Err(Trouble::new(text));
        }
        let run = self.functions.values_mut();
        for function in run.filter(|function| function.name.contains(RUN_LAW)) {
            function.callees.extend(&laws);
            function.opaque = None;
        }
        Ok(self)
    }

    /// Where the one function begins whose path contains `name`.
    fn start(&self, name: &str) -> Result<u64, Trouble> {
        let pattern = format!("::{name}::");
        let mut found = (self.functions.iter()).filter(|(_, f)| f.name.contains(&pattern));
        match (found.next(), found.next()) {
            (Some((&start, _)), None) => Ok(start),
            _ => Err(Trouble::new(format!(
                "not one function {name} in the image"
            ))),
        }
    }

    /// Everything below the function whose path contains `name`.
    pub fn below(&self, name: &str) -> Result<Below, Trouble> {
        let start = self.start(name)?;
        let mut depths = BTreeMap::new();
        let stack = self.depth(start, &mut Vec::new(), &mut depths);
        let deepest = match stack {
            Ok(_) => self.deepest(start, &depths),
            Err(_) => Vec::new(),
        };
        Ok(Below {
            stack,
            deepest,
            code: self.code(start),
        })
    }

    fn code(&self, start: u64) -> u64 {
        let size = |address: &u64| self.functions.get(address).map(|f| f.end - address);
        self.reached(start).iter().filter_map(size).sum()
    }

    /// The functions that can be reached from one, itself included.
    fn reached(&self, start: u64) -> BTreeSet<u64> {
        let (mut reached, mut open) = (BTreeSet::new(), vec![start]);
        while let Some(address) = open.pop() {
            if let Some(function) = self.functions.get(&address)
                && reached.insert(address)
            {
                open.extend(&function.callees);
            }
        }
        reached
    }

    fn deepest(&self, start: u64, depths: &BTreeMap<u64, u64>) -> Vec<(u64, String)> {
        let (mut path, mut next) = (Vec::new(), Some(start));
        while let Some(function) = next.and_then(|address| self.functions.get(&address)) {
            path.push((function.frame, function.name.clone()));
            let depth = |callee: &&u64| depths.get(callee).copied();
            next = function.callees.iter().max_by_key(depth).copied();
        }
        path
    }

    fn depth(
        &self,
        start: u64,
        path: &mut Vec<u64>,
        depths: &mut BTreeMap<u64, u64>,
    ) -> Result<u64, String> {
        if let Some(&depth) = depths.get(&start) {
            return Ok(depth);
        }
        let Some(function) = self.functions.get(&start) else {
            return Err(format!("a call into nothing at {start:x}"));
        };
        let name = &function.name;
        if path.contains(&start) {
            return Err(format!("{name} calls itself: no bound"));
        }
        if let Some(line) = &function.opaque {
            return Err(format!("no bound through {name}: {line}"));
        }
        path.push(start);
        let mut deepest = 0;
        for &callee in &function.callees {
            deepest = deepest.max(self.depth(callee, path, depths)?);
        }
        path.pop();
        depths.insert(start, function.frame + deepest);
        Ok(function.frame + deepest)
    }
}

impl Function {
    fn read(&mut self, mnemonic: &str, operands: &str) {
        let base = mnemonic.split('.').next().unwrap_or_default();
        let to_stack_pointer = operands.starts_with("sp,") || operands.starts_with("sp!,");
        match base {
            "push" => self.frame += 4 * registers(operands),
            "stmdb" if to_stack_pointer => self.frame += 4 * registers(operands),
            "vpush" if operands.contains('d') => self.frame += 8 * registers(operands),
            "vpush" => self.frame += 4 * registers(operands),
            "sub" | "subw" if to_stack_pointer => match immediate(operands) {
                Some(bytes) => self.frame += bytes,
                None => self.opaque = Some(format!("{mnemonic} {operands}")),
            },
            // Frames that end: by the frame pointer or by what was taken.
            "add" | "addw" if to_stack_pointer => {}
            "mov" | "bic" | "and" if to_stack_pointer && !operands.starts_with("sp, r7") => {
                self.opaque = Some(format!("{mnemonic} {operands}"));
            }
            "str" | "strd" if operands.contains("[sp, #-") && operands.ends_with(']') => {}
            "str" | "strd" if operands.contains("[sp, #-") => {
                self.frame += immediate(operands.replace("#-", "#").as_str()).unwrap_or(8);
            }
            // An address, in two halves; its lowest bit says that Thumb code is there.
            "movw" | "movt" => {
                let (register, value) = (operands.split(',').next(), immediate(operands));
                if let (Some(register), Some(value)) = (register, value) {
                    if base == "movw" {
                        self.halves.insert(register.into(), value);
                    } else if let Some(low) = self.halves.get(register) {
                        self.taken.insert((value << 16 | low) & !1);
                    }
                }
            }
            "blx" => self.opaque = Some(format!("{mnemonic} {operands}")),
            "bx" if operands != "lr" => self.opaque = Some(format!("{mnemonic} {operands}")),
            // The linker fills gaps between functions with this one, d4d4.
            "bmi" if operands.ends_with("imm = #-0x58") => {}
            _ if BRANCHES.contains(&base) => self.callees.extend(target(operands)),
            _ => {}
        }
    }
}

/// `0002dea0 <bench::cycle_f64::h681b>:`
fn header(line: &str) -> Option<(u64, &str)> {
    let (address, name) = line.strip_suffix(">:")?.split_once(" <")?;
    Some((u64::from_str_radix(address, 16).ok()?, name))
}

/// Address, mnemonic and operands, the last two behind tabs.
fn instruction(line: &str) -> Option<(u64, &str, &str)> {
    let (address, rest) = line.split_once(':')?;
    let address = u64::from_str_radix(address.trim(), 16).ok()?;
    let rest = rest.trim();
    let (mnemonic, operands) = rest.split_once('\t').unwrap_or((rest, ""));
    Some((address, mnemonic.trim(), operands.trim()))
}

/// How many registers a list names.
fn registers(operands: &str) -> u64 {
    let list = operands.split(['{', '}']).nth(1).unwrap_or_default();
    list.split(',')
        .filter(|name| !name.trim().is_empty())
        .count() as u64
}

/// The last `#0x..` or `#..`.
fn immediate(operands: &str) -> Option<u64> {
    let digits = operands.rsplit_once('#')?.1.trim_end_matches(['!', ']']);
    let digits = digits.split_whitespace().next()?;
    match digits.strip_prefix("0x") {
        Some(hex) => u64::from_str_radix(hex, 16).ok(),
        None => digits.parse().ok(),
    }
}

/// The address that a branch goes to.
fn target(operands: &str) -> Option<u64> {
    let (_, hex) = operands.split_once("0x")?;
    let digits = hex.split(|c: char| !c.is_ascii_hexdigit()).next()?;
    u64::from_str_radix(digits, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMAGE: &str = "
00000100 <a::outer::h1>:
     100:      \tpush\t{r4, r5, r7, lr}
     102:      \tvpush\t{d8, d9}
     104:      \tsub.w\tsp, sp, #0x108
     108:      \tbl\t0x200 <a::inner::h2> @ imm = #0xf4
     10c:      \tbne\t0x104 <a::outer::h1+0x4> @ imm = #-8
     10e:      \tb.w\t0x300 <leaf> @ imm = #0x200

00000200 <a::inner::h2>:
     200:      \tstr\tlr, [sp, #-0x8]!
     204:      \tbx\tlr
     206:      \tbmi\t0x1b2 <a::outer::h1+0xb2> @ imm = #-0x58

00000300 <leaf>:
     300:      \tbx\tlr

00000400 <a::open::h3>:
     400:      \tblx\tr3
";

    #[test]
    fn frames_add_up_along_the_deepest_path() {
        let graph = CallGraph::parse(IMAGE);
        let below = graph.below("outer").expect("a function");
        assert_eq!(below.stack, Ok(16 + 16 + 0x108 + 8));
        assert_eq!(below.code, 0x12 + 10 + 4);
        let names: Vec<&str> = below.deepest.iter().map(|(_, name)| &name[..]).collect();
        assert_eq!(names, ["a::outer::h1", "a::inner::h2"]);
    }

    #[test]
    fn the_neighbour_behind_a_short_instruction_is_called() {
        let text = "
00000100 <a::first::h1>:
     100:      \tpush\t{r7, lr}
     102:      \tbl\t0x108 <a::second::h2> @ imm = #0x2
     106:      \tpop\t{r7, pc}
00000108 <a::second::h2>:
     108:      \tsub\tsp, #0x10
     10a:      \tbx\tlr
";
        let below = CallGraph::parse(text).below("first").expect("a function");
        assert_eq!(below.stack, Ok(8 + 16));
        assert_eq!(below.code, 8 + 6);
    }

    #[test]
    fn what_cannot_be_followed_has_no_bound() {
        let graph = CallGraph::parse(IMAGE);
        let open = graph.below("open").expect("a function");
        assert!(open.stack.is_err());
        assert_eq!(open.code, 4);
        assert!(graph.below("missing").is_err());
    }

    const LAW: &str = "
00000100 <a::make_wide::h1>:
     100:      \tmovw\tr0, #0x301
     104:      \tmovt\tr0, #0x1
     108:      \tbx\tlr
0000010a <a::make_none::h1>:
     10a:      \tmovw\tr0, #0x501
     10e:      \tmovt\tr0, #0x1
     112:      \tbx\tlr
00000200 <a::cycle::h2>:
     200:      \tpush\t{r7, lr}
     202:      \tbl\t0x20a <c::stages::run_law::h3> @ imm = #0x4
     206:      \tpop\t{r7, pc}
0000020a <c::stages::run_law::h3>:
     20a:      \tldr\tr3, [r0]
     20c:      \tbx\tr3
00010300 <c::stages::law_within_limits::h4>:
   10300:      \tsub\tsp, #0x40
   10302:      \tbx\tlr
00010400 <c::stages::exact_law::h5>:
   10400:      \tsub\tsp, #0x80
   10402:      \tbx\tlr
00010500 <c::other::h6>:
   10500:      \tbx\tlr
";

    #[test]
    fn a_law_is_called_that_the_constructor_takes_the_address_of() {
        let graph = CallGraph::parse(LAW);
        assert!(graph.below("cycle").expect("a function").stack.is_err());
        let wide = graph.clone().with_laws_of("make_wide").expect("a law");
        let below = wide.below("cycle").expect("a function");
        assert_eq!(below.stack, Ok(8 + 0x40));
        assert_eq!(below.code, 10 + 6 + 6);
        // The address of a function that is no law leads nowhere.
        assert!(graph.with_laws_of("make_none").is_err());
    }

    #[test]
    fn recursion_has_no_bound() {
        let text = "
00000100 <a::round::h1>:
     100:      \tpush\t{r7, lr}
     102:      \tbl\t0x100 <a::round::h1> @ imm = #-4
";
        let below = CallGraph::parse(text).below("round").expect("a function");
        assert!(below.stack.is_err());
    }
}
