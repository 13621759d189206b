//! Keys of a scenario that change the arm and what the law within limits may do with it: `law`,
//! `mount`, `tool`, `[joint_limits]`, `[level.limits]`.

#[path = "near_limits/partial.rs"]
mod partial;

use std::fmt::Write as _;

use cell::ranges::*;
use cell::scenario::{LawSpec, Scenario};
use controller_core::arm::ArmModel;
use proptest::prelude::*;
use proptest::{array, option};

/// A scenario of `robot` with keys before its tables, tables, and keys of its level.
fn scenario(robot: &str, keys: &str, tables: &str, level: &str) -> String {
    let table = arms::by_name(robot).expect("a name");
    let middle = table.links.map(|link| {
        let [least, greatest] = link.position_range;
        f64::midpoint(least, greatest).to_degrees()
    });
    format!(
        "name = 'near'\nrobot = '{robot}'\n{keys}duration_s = 1.0\ncycle_ms = 2.0\n\
         start_deg = {middle:?}\n{tables}[null_space]\nstiffness = {ones:?}\ndamping = {ones:?}\n\
         [observer]\ngain = 50.0\n[[level]]\npoint = 'flange'\naxes = 'xyz'\nstiffness = 400.0\n\
         damping = 40.0\nreference.kind = 'hold'\n{level}",
        ones = [1.0; 7]
    )
}

/// The keys as a file has them, each given or not.
#[derive(Clone, Debug, PartialEq)]
struct Keys {
    law: Option<LawSpec>,
    mount: Option<[f64; 3]>,
    tool: Option<Tool>,
    joint_limits: Option<JointKeys>,
    level_limits: Option<LevelKeys>,
}

#[derive(Clone, Debug, PartialEq)]
struct Tool {
    shift_m: [f64; 3],
    rpy_deg: [f64; 3],
    mass_kg: f64,
    center_of_mass_m: [f64; 3],
    inertia_kg_m2: [f64; 6],
}

/// Of the joints: acceleration, braking, `speed_gain`; `position_gain`, `margin_deg`, `speed_share`.
type JointKeys = ([Option<[f64; 7]>; 3], [Option<f64>; 3]);

/// In the order of [`LEVEL`].
type LevelKeys = [Option<f64>; 5];

const JOINTS: [(&str, Range<f64>); 3] = [
    ("acceleration", JOINT_ACCELERATION),
    ("braking", JOINT_ACCELERATION),
    ("speed_gain", JOINT_GAIN),
];

const ALL_JOINTS: [(&str, Range<f64>); 3] = [
    ("position_gain", JOINT_GAIN),
    ("margin_deg", MARGIN_DEG),
    ("speed_share", SPEED_SHARE),
];

/// Release stands behind drive, which it may not exceed.
const LEVEL: [(&str, Range<f64>); 5] = [
    ("drive_mobility", MOBILITY),
    ("release_mobility", MOBILITY),
    ("error_speed_m_s", LEVEL_SPEED_M_S),
    ("lost_speed_m_s", LEVEL_SPEED_M_S),
    ("stiff_mobility", MOBILITY),
];

impl Keys {
    fn text(&self) -> String {
        let (mut keys, mut tables, mut level) = (String::new(), String::new(), String::new());
        if let Some(law) = self.law {
            let law = match law {
                LawSpec::WithinLimits => "within-limits",
                LawSpec::Exact => "exact",
            };
            writeln!(keys, "law = '{law}'").expect("text");
        }
        if let Some(rpy) = self.mount {
            writeln!(keys, "mount = {{ rpy_deg = {rpy:?} }}").expect("text");
        }
        if let Some(tool) = &self.tool {
            writeln!(
                keys,
                "tool = {{ shift_m = {:?}, rpy_deg = {:?}, mass_kg = {:?}, center_of_mass_m = {:?}, \
                 inertia_kg_m2 = {:?} }}",
                tool.shift_m, tool.rpy_deg, tool.mass_kg, tool.center_of_mass_m, tool.inertia_kg_m2
            )
            .expect("text");
        }
        if let Some((joints, all)) = &self.joint_limits {
            tables += "[joint_limits]\n";
            for ((key, _), value) in JOINTS.iter().zip(joints) {
                value.map(|value| writeln!(tables, "{key} = {value:?}"));
            }
            for ((key, _), value) in ALL_JOINTS.iter().zip(all) {
                value.map(|value| writeln!(tables, "{key} = {value:?}"));
            }
        }
        if let Some(values) = &self.level_limits {
            level += "[level.limits]\n";
            for ((key, _), value) in LEVEL.iter().zip(values) {
                value.map(|value| writeln!(level, "{key} = {value:?}"));
            }
        }
        scenario("iiwa_14", &keys, &tables, &level)
    }

    /// Those of a scenario; the law is always given.
    fn of(scenario: &Scenario) -> Self {
        let tool = scenario.tool.as_ref().map(|tool| Tool {
            shift_m: tool.shift_m,
            rpy_deg: tool.rpy_deg,
            mass_kg: tool.mass_kg,
            center_of_mass_m: tool.center_of_mass_m,
            inertia_kg_m2: tool.inertia_kg_m2,
        });
        let joint_limits = scenario.joint_limits.map(|limits| {
            (
                [limits.acceleration, limits.braking, limits.speed_gain],
                [limits.position_gain, limits.margin_deg, limits.speed_share],
            )
        });
        let level_limits = scenario.levels[0].limits.map(|limits| {
            [
                limits.drive_mobility,
                limits.release_mobility,
                limits.error_speed_m_s,
                limits.lost_speed_m_s,
                limits.stiff_mobility,
            ]
        });
        Self {
            law: Some(scenario.law),
            mount: scenario.mount.as_ref().map(|mount| mount.rpy_deg),
            tool,
            joint_limits,
            level_limits,
        }
    }
}

/// Numbers of a range, its ends among them.
fn within(range: Range<f64>) -> impl Strategy<Value = f64> + Clone {
    let Range { min, max, .. } = range;
    prop_oneof![1 => Just(min), 1 => Just(max), 6 => min..=max]
}

/// A body of four points with masses of up to 1 kg, none in a plane with all others but by chance.
fn inertia() -> impl Strategy<Value = [f64; 6]> {
    array::uniform4((0.01..1.0f64, array::uniform3(-0.5..0.5f64))).prop_map(|points| {
        let mut inertia = [0.0; 6];
        for (mass, [x, y, z]) in points {
            let of_point = [
                y * y + z * z,
                -x * y,
                -x * z,
                x * x + z * z,
                -y * z,
                x * x + y * y,
            ];
            for (sum, entry) in inertia.iter_mut().zip(of_point) {
                *sum += mass * entry;
            }
        }
        inertia
    })
}

fn tool() -> impl Strategy<Value = Tool> {
    let length = || array::uniform3(within(OFFSET_M));
    (
        length(),
        array::uniform3(within(ANGLE_DEG)),
        within(TOOL_MASS_KG),
        length(),
        inertia(),
    )
        .prop_map(
            |(shift_m, rpy_deg, mass_kg, center_of_mass_m, inertia_kg_m2)| Tool {
                shift_m,
                rpy_deg,
                mass_kg,
                center_of_mass_m,
                inertia_kg_m2,
            },
        )
}

/// Of the first level: a release that is not given is 0.005, and no drive is below the release.
fn level_limits() -> impl Strategy<Value = LevelKeys> {
    LEVEL
        .map(|(_, range)| option::of(within(range)))
        .prop_map(|mut keys| {
            let release = keys[1].unwrap_or(0.005);
            match &mut keys[0] {
                Some(drive) => *drive = drive.max(release),
                None => keys[1] = keys[1].map(|release| release.min(0.05)),
            }
            keys
        })
}

fn keys() -> impl Strategy<Value = Keys> {
    let joint_limits = (
        JOINTS.map(|(_, range)| option::of(array::uniform7(within(range)))),
        ALL_JOINTS.map(|(_, range)| option::of(within(range))),
    );
    (
        prop_oneof![Just(LawSpec::WithinLimits), Just(LawSpec::Exact)],
        option::of(array::uniform3(within(ANGLE_DEG))),
        option::of(tool()),
        option::of(joint_limits),
        option::of(level_limits()),
    )
        .prop_map(|(law, mount, tool, joint_limits, level_limits)| Keys {
            law: Some(law),
            mount,
            tool,
            joint_limits,
            level_limits,
        })
}

/// A key, how it stands in a file with a value, the range.
type OneKey = (&'static str, fn(&str, &str) -> [String; 3], Range<f64>);

/// With a value in the first, the second and so on place of an array.
fn array_with(key: &str, value: &str, others: &[&str]) -> String {
    let mut values = others.to_vec();
    values[others.len() / 2] = value;
    format!("{key} = [{}]", values.join(", "))
}

fn in_tool(changed: &str, line: String) -> [String; 3] {
    let own = [
        ("shift_m", "shift_m = [0, 0, 0.1]"),
        ("rpy_deg", "rpy_deg = [0, 0, 0]"),
        ("mass_kg", "mass_kg = 1"),
        ("center_of_mass_m", "center_of_mass_m = [0, 0, 0]"),
        ("inertia_kg_m2", "inertia_kg_m2 = [1, 0, 0, 1, 0, 1]"),
    ];
    let lines = own.map(|(key, own)| {
        if key == changed {
            line.clone()
        } else {
            own.into()
        }
    });
    [
        format!("tool = {{ {} }}\n", lines.join(", ")),
        String::new(),
        String::new(),
    ]
}

fn in_joints(line: &str) -> [String; 3] {
    [
        String::new(),
        format!("[joint_limits]\n{line}\n"),
        String::new(),
    ]
}

const KEYS: [OneKey; 17] = [
    (
        "rpy_deg",
        |k, v| {
            [
                format!("mount = {{ {} }}\n", array_with(k, v, &["0"; 3])),
                String::new(),
                String::new(),
            ]
        },
        ANGLE_DEG,
    ),
    (
        "shift_m",
        |k, v| in_tool(k, array_with(k, v, &["0"; 3])),
        OFFSET_M,
    ),
    (
        "rpy_deg",
        |k, v| in_tool(k, array_with(k, v, &["0"; 3])),
        ANGLE_DEG,
    ),
    (
        "mass_kg",
        |k, v| in_tool(k, format!("{k} = {v}")),
        TOOL_MASS_KG,
    ),
    (
        "center_of_mass_m",
        |k, v| in_tool(k, array_with(k, v, &["0"; 3])),
        OFFSET_M,
    ),
    (
        "inertia_kg_m2",
        |k, v| in_tool(k, array_with(k, v, &["1"; 6])),
        INERTIA_KG_M2,
    ),
    (
        "acceleration",
        |k, v| in_joints(&array_with(k, v, &["9"; 7])),
        JOINT_ACCELERATION,
    ),
    (
        "braking",
        |k, v| in_joints(&array_with(k, v, &["9"; 7])),
        JOINT_ACCELERATION,
    ),
    (
        "speed_gain",
        |k, v| in_joints(&array_with(k, v, &["9"; 7])),
        JOINT_GAIN,
    ),
    (
        "position_gain",
        |k, v| in_joints(&format!("{k} = {v}")),
        JOINT_GAIN,
    ),
    (
        "margin_deg",
        |k, v| in_joints(&format!("{k} = {v}")),
        MARGIN_DEG,
    ),
    (
        "speed_share",
        |k, v| in_joints(&format!("{k} = {v}")),
        SPEED_SHARE,
    ),
    ("drive_mobility", in_level, MOBILITY),
    ("release_mobility", in_level, MOBILITY),
    ("error_speed_m_s", in_level, LEVEL_SPEED_M_S),
    ("lost_speed_m_s", in_level, LEVEL_SPEED_M_S),
    ("stiff_mobility", in_level, MOBILITY),
];

fn in_level(key: &str, value: &str) -> [String; 3] {
    [
        String::new(),
        String::new(),
        format!("[level.limits]\n{key} = {value}\n"),
    ]
}

fn parse_with([keys, tables, level]: &[String; 3]) -> Result<Scenario, String> {
    let text = scenario("iiwa_14", keys, tables, level);
    Scenario::parse(&text).map_err(|error| error.to_string())
}

/// Below or above a range, by as little as there is or by much, or no number.
fn outside(range: Range<f64>) -> impl Strategy<Value = f64> {
    let Range { min, max, .. } = range;
    prop_oneof![
        Just(min.next_down()),
        Just(max.next_up()),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(f64::NAN),
        (1e-9..1e12f64).prop_map(move |by| min - by),
        (1e-9..1e12f64).prop_map(move |by| max + by),
    ]
}

/// A value as errors say it: not with hundreds of zeros.
fn shown(value: f64) -> String {
    let full = value.to_string();
    if full.len() > 20 {
        format!("{value:e}")
    } else {
        full
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn keys_in_range_load_and_are_read_as_they_were_written(keys in keys()) {
        let text = keys.text();
        let scenario = Scenario::parse(&text).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let read = Keys::of(&scenario);
        prop_assert_eq!(&read, &keys);
        prop_assert_eq!(read.text(), text);
        prop_assert!(ArmModel::<f64>::new(&scenario.arm().parameters).is_ok());
    }

    #[test]
    fn a_number_out_of_range_is_refused_by_name_value_and_range(
        (key, value) in (0..KEYS.len()).prop_flat_map(|key| (Just(key), outside(KEYS[key].2)))
    ) {
        let (name, file, range) = KEYS[key];
        // The least number above one of its range may round to it.
        prop_assume!(!range.contains(value));
        let value_text = format!("{value:?}").to_lowercase();
        let error = parse_with(&file(name, &value_text)).expect_err("out of range");
        prop_assert!(error.contains(name), "{}", error);
        prop_assert!(error.contains(&shown(value)), "{}", error);
        prop_assert!(error.contains(&range.to_string()), "{}", error);
    }

    #[test]
    fn a_release_above_the_drive_is_refused(drive in within(MOBILITY), release in within(MOBILITY)) {
        let lines = format!("[level.limits]\ndrive_mobility = {drive:?}\nrelease_mobility = {release:?}\n");
        let parsed = parse_with(&[String::new(), String::new(), lines]);
        match parsed {
            Ok(_) => prop_assert!(release <= drive),
            Err(error) => {
                prop_assert!(release > drive);
                let shown = shown(release);
                let said = format!("release_mobility: {shown}; allowed: 0.0001 to {drive}");
                prop_assert!(error.contains(&said), "{}", error);
            }
        }
    }

    /// Whatever stands there in the place of a number.
    #[test]
    fn what_is_no_number_is_an_error_with_a_line(key in 0..KEYS.len(), junk in "[ -~]{0,12}") {
        let (name, file, _) = KEYS[key];
        let quoted = format!("'{}'", junk.replace('\'', ""));
        let error = parse_with(&file(name, &quoted)).expect_err("text");
        prop_assert!(error.starts_with("line "), "{}", error);
        // As it is: a number by chance, or an error.
        let _ = parse_with(&file(name, &junk));
    }
}

/// A drive below the release that nobody gave is what is wrong.
#[test]
fn of_a_release_by_default_the_drive_is_to_blame() {
    let line = in_level("drive_mobility", "0.004");
    let error = parse_with(&line).expect_err("below the release");
    assert!(
        error.ends_with("limits: drive_mobility: 0.004; allowed: 0.005 to 1"),
        "{error}"
    );
}

#[test]
fn laws_have_two_names() {
    let error = parse_with(&["law = 'exakt'\n".into(), String::new(), String::new()]);
    let error = error.expect_err("no law");
    assert!(
        error.contains("law: unknown 'exakt', did you mean 'exact'?"),
        "{error}"
    );
}
