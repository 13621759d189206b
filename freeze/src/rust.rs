//! The file in Rust.

use crate::explore::Value;
use crate::frozen::Frozen;
use crate::layout::Body;
use crate::tape::Precision;
use crate::trace::Field;
use crate::write::{Function, Kind, Language, WrittenBody, lines};

/// Rust in one precision.
pub struct Rust {
    pub precision: Precision,
}

impl Language for Rust {
    fn constant(&self, value: f64) -> String {
        if value.is_nan() {
            return "Number::NAN".to_string();
        }
        if value.is_infinite() {
            return if value > 0.0 {
                "Number::INFINITY"
            } else {
                "Number::NEG_INFINITY"
            }
            .to_string();
        }
        match self.precision {
            Precision::F32 => format!("{:?}_f32", value as f32),
            Precision::F64 => format!("{value:?}_f64"),
        }
    }
    fn place(&self, path: &str) -> String {
        path.to_string()
    }
    fn declared(&self, names: &[String]) -> Vec<String> {
        // Many at once: each statement that declares is a scope within the one before.
        let declared = names.chunks(64);
        declared
            .map(|names| format!("let ({},);", names.join(", ")))
            .collect()
    }
    fn number(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }
    fn kept(&self, name: &str, value: &str, _: Kind) -> String {
        format!("let {name} = {value};")
    }
    fn function(&self, function: Function, given: &[String]) -> String {
        let name = match function {
            Function::SquareRoot => "Real::square_root",
            Function::Magnitude => "Real::magnitude",
            Function::WithSign => "Real::with_sign_of",
            Function::Most => "Real::most",
            Function::Least => "Real::least",
        };
        format!("{name}({})", given.join(", "))
    }
    fn choice(&self, condition: &str, yes: &str, no: &str) -> String {
        format!("if {condition} {{ {yes} }} else {{ {no} }}")
    }
    fn merged(&self, name: &str, value: Value) -> String {
        let kind = match value {
            Value::Number(_) => "Number",
            Value::Flag(_) => "bool",
            Value::Count(_) => "u8",
        };
        format!("let {name}: {kind};")
    }
    fn branch(&self, condition: &str) -> String {
        format!("if {condition} {{")
    }
    fn truth(&self, truth: bool) -> &'static str {
        if truth { "true" } else { "false" }
    }
    fn sines_cosines(&self, sines: &str, cosines: &str, angles: &[String]) -> Vec<String> {
        vec![format!(
            "let ({sines}, {cosines}) = sines_cosines([{}]);",
            angles.join(", ")
        )]
    }
    fn exponentials(&self, name: &str, given: &[String]) -> Vec<String> {
        vec![format!(
            "let {name} = exponentials([{}]);",
            given.join(", ")
        )]
    }
    fn search(&self, name: &str, given: &[String]) -> Vec<String> {
        vec![format!("let {name} = search(&[{}]);", given.join(", "))]
    }
    fn found_bit(&self, name: &str, bit: u32) -> String {
        format!("({name}.flags >> {bit}) & 1 != 0")
    }
    fn as_bit(&self, flag: &str, bit: u32) -> String {
        if flag == "true" {
            format!("{}", 1 << bit)
        } else {
            format!("u8::from({flag}) << {bit}")
        }
    }
}

/// `name: value` of each field, as they are in the text of a structure.
fn values(language: &Rust, fields: &[&Field]) -> String {
    let value = |field: &Field| {
        if field.is_flag {
            return language.truth(field.values[0] != 0.0).to_string();
        }
        let numbers = field.values.iter().map(|&value| language.constant(value));
        format!("[{}]", numbers.collect::<Vec<_>>().join(", "))
    };
    let lines = fields
        .iter()
        .map(|field| format!("        {}: {},\n", field.name, value(field)));
    lines.collect()
}

/// The fields with their types.
fn declared(fields: &[&Field]) -> String {
    let kind = |field: &Field| {
        if field.is_flag {
            "bool".to_string()
        } else {
            format!("[Number; {}]", field.values.len())
        }
    };
    let lines = fields
        .iter()
        .map(|field| format!("    pub {}: {},\n", field.name, kind(field)));
    lines.collect()
}

impl Frozen {
    /// The file in Rust: `no_std`, it needs the scalar of `controller-core` and nothing else of it.
    #[must_use]
    pub fn rust(&self) -> String {
        write(self)
    }
}

/// The whole file.
fn write(frozen: &Frozen) -> String {
    let language = Rust {
        precision: frozen.precision,
    };
    let number = match frozen.precision {
        Precision::F32 => "f32",
        Precision::F64 => "f64",
    };
    let program = &frozen.program;
    let header: String = frozen
        .header()
        .iter()
        .map(|line| format!("// {line}\n"))
        .collect();
    let parameters = frozen.parameters();
    let state = frozen.state();
    let targets: String = (1..)
        .zip(&program.orientations)
        .map(|(number, &is_orientation)| {
            let kind = if is_orientation {
                "Orientation"
            } else {
                "Position"
            };
            format!("    /// Of level {number}.\n    pub target_{number}: {kind},\n")
        })
        .collect();
    let admit: String = (0..frozen.bodies.admit.len())
        .map(|part| {
            format!(
                "    let found = admit_{part}(p, m, r);\n    if found.kind != 0 {{\n        return found;\n    }}\n"
            )
        })
        .collect();
    let types = include_str!("parts/types.rs.txt")
        .replace("@TARGETS@", &targets)
        .replace("@ADMIT@", &admit);
    let mut functions = String::new();
    for (part, body) in frozen.bodies.admit.iter().enumerate() {
        functions.push_str(&format!(
            "#[inline(always)]\nfn admit_{part}(p: &Parameters, m: &Measurement, r: &Reference) -> Found {{\n    \
             let mut fault = Found::NONE;\n{}    let _ = (p, m, r);\n    fault\n}}\n\n",
            text_of(frozen, body, &language)
        ));
    }
    functions.push_str(&cycle(frozen, &language));
    let brake = text_of(frozen, &frozen.bodies.brake, &language).replace("step.is_", "is_");
    functions.push_str(&format!(
        "#[cold]\n#[inline(never)]\nfn brake(p: &Parameters, s: &mut Memory, m: &Measurement, step: &mut Step) {{\n    \
         let (sees, is_still, is_unseen): (bool, bool, bool);\n    let mut gravity: [Number; 7] = [0.0; 7];\n{brake}    \
         step.mode = 2 + u8::from(is_still) + 2 * u8::from(is_unseen);\n    \
         step.gravity = if sees {{ gravity }} else {{ step.torque }};\n}}\n\n"
    ));
    let search = if program.searches.is_empty() {
        String::new()
    } else {
        let pivots = controller_core::ranges::PIVOTS.to_string();
        include_str!("parts/search.rs.txt").replace("@PIVOTS@", &pivots)
    };
    format!(
        "{header}
use controller_core::real::Real;

const _: () = assert!(
    controller_core::SOURCE == {source:#018x},
    \"frozen from another controller-core: freeze again\"
);

/// The scalar.
pub type Number = {number};

/// Gains, limits and the last link. Entries that were zero when this was written are not read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {{
{parameters_declared}}}

impl Parameters {{
    /// Of the controller that was frozen.
    pub const FROZEN: Self = Self {{
{parameters_values}    }};
}}

/// What is remembered from cycle to cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory {{
    pub fault: Fault,
{state_declared}}}

impl Memory {{
    /// Nothing yet.
    pub const NEW: Self = Self {{
        fault: Fault::NONE,
{state_values}    }};
}}

/// The part that changes from cycle to cycle, in the caller's storage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {{
    pub memory: Memory,
    work: Work,
}}

impl State {{
    /// Before the first cycle.
    pub const NEW: Self = Self {{
        memory: Memory::NEW,
        work: Work::NEW,
    }};

{methods}}}

{types}{functions}{search}",
        source = controller_core::SOURCE,
        parameters_declared = declared(&parameters),
        parameters_values = values(&language, &parameters),
        state_declared = declared(&state),
        state_values = values(&language, &state),
        methods = include_str!("parts/state.rs.txt"),
    )
}

/// The cycle in its pieces.
fn cycle(frozen: &Frozen, language: &Rust) -> String {
    let written = written(frozen, &frozen.bodies.cycle, language);
    let [numbers, flags, counts] = written.room;
    let mut text = format!(
        "/// What goes from one piece of a cycle to others.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Work {{
    numbers: [Number; {numbers}],
    flags: [bool; {flags}],
    counts: [u8; {counts}],
}}

impl Work {{
    const NEW: Self = Self {{
        numbers: [0.0; {numbers}],
        flags: [false; {flags}],
        counts: [0; {counts}],
    }};
}}

"
    );
    let mut calls = String::new();
    let count = written.pieces.len();
    for (number, piece) in (1..).zip(&written.pieces) {
        let name = format!("{}_{number}", piece.stage.replace(' ', "_"));
        let lines = joined(&piece.lines);
        if number < count {
            text.push_str(&format!(
                "/// Of the stage \"{}\".\n#[inline(never)]\nfn {name}(p: &Parameters, s: &Memory, m: &Measurement, r: &Reference, w: &mut Work) {{\n{lines}    let _ = (p, s, m, r);\n}}\n\n",
                piece.stage
            ));
            calls.push_str(&format!("    {name}(p, s, m, r, w);\n"));
        } else {
            text.push_str(&format!(
                "/// Of the stage \"{}\", and what a cycle leaves.\n#[inline(never)]\nfn {name}(\n    p: &Parameters,\n    s: &mut Memory,\n    m: &Measurement,\n    r: &Reference,\n    step: &mut Step,\n    w: &mut Work,\n) -> Found {{\n    let mut fault = Found::NONE;\n{lines}    let _ = (p, m, r);\n    fault\n}}\n\n",
                piece.stage
            ));
            calls.push_str(&format!("    {name}(p, s, m, r, step, w)\n"));
        }
    }
    text.push_str(&format!(
        "fn cycle(\n    p: &Parameters,\n    state: &mut State,\n    m: &Measurement,\n    r: &Reference,\n    step: &mut Step,\n) -> Found {{\n    let (s, w) = (&mut state.memory, &mut state.work);\n{calls}}}\n\n"
    ));
    text
}

fn written(frozen: &Frozen, body: &Body, language: &Rust) -> WrittenBody {
    lines(&frozen.tape, &frozen.program.searches, body, language)
}

fn joined(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

/// A function of one piece.
fn text_of(frozen: &Frozen, body: &Body, language: &Rust) -> String {
    let written = written(frozen, body, language);
    let lines: Vec<String> = written
        .pieces
        .iter()
        .map(|piece| joined(&piece.lines))
        .collect();
    lines.concat()
}
