//! A scenario and an arm file in which every key stands, and how one key of them is changed.

use std::path::Path;

use cell::arm;
use cell::document::{self, Table};
use cell::scenario::Scenario;
use toml::Value;

/// A kind of files.
pub struct Files {
    /// The tables that they have.
    pub tables: Vec<Table>,
    /// One that is valid.
    base: &'static str,
    /// What the reader makes of a text.
    pub read: fn(&str) -> Result<String, String>,
}

/// Scenario files and arm files.
pub fn all() -> [Files; 2] {
    [
        Files {
            tables: document::of_scenarios(),
            base: SCENARIO,
            read: |text| {
                let scenario = Scenario::parse_in(text, Path::new(""));
                let shown = scenario.map(|scenario| format!("{scenario:?}"));
                shown.map_err(|error| error.to_string())
            },
        },
        Files {
            tables: document::of_arms(),
            base: ARM,
            read: |text| {
                let arm = arm::file::parse(text).map(|arm| format!("{arm:?}"));
                arm.map_err(|error| error.to_string())
            },
        },
    ]
}

impl Files {
    /// The valid file, in which `table` has the shape that it is of.
    pub fn base(&self, table: &Table) -> toml::Table {
        let mut file: toml::Table = self.base.parse().expect("TOML");
        if table.path.starts_with("level") {
            // What a limit names depends on the task of the level.
            file.remove("limit");
        }
        let Some(kind) = table.kind else {
            return file;
        };
        if table.path == "event" {
            let event = toml_of(&EVENTS, kind);
            file.insert("event".into(), vec![Value::Table(event)].into());
            return file;
        }
        let reference = toml_of(&REFERENCES, kind);
        let level = entered(&mut file, "level");
        level.insert("reference".into(), Value::Table(reference));
        if table.about == "For positions." {
            level.insert("task".into(), "position".into());
        }
        file
    }

    /// What the reader makes of the file with `key` of `table` changed; of none removed.
    pub fn with(&self, table: &Table, key: &str, value: Option<Value>) -> Result<String, String> {
        let mut file = self.base(table);
        if key == "level" && table.path.is_empty() {
            // What an event names depends on the levels.
            file.remove("event");
        }
        let place = entered(&mut file, table.path);
        match value {
            Some(value) => place.insert(key.into(), value),
            None => place.remove(key),
        };
        (self.read)(&file.to_string())
    }

    /// The value of a key in the valid file.
    pub fn value(&self, table: &Table, key: &str) -> Value {
        let mut file = self.base(table);
        let place = entered(&mut file, table.path);
        let value = place.get(key).cloned();
        value.unwrap_or_else(|| panic!("the valid file lacks {key} of [{}]", table.path))
    }
}

/// The table of a kind in a list of them.
fn toml_of(list: &[(&str, &str)], kind: &str) -> toml::Table {
    let found = list.iter().find(|(known, _)| *known == kind);
    let (_, text) = found.unwrap_or_else(|| panic!("nothing of the kind {kind}"));
    text.parse().expect("TOML")
}

/// The table at the end of a path; of lists the first entry.
fn entered<'a>(file: &'a mut toml::Table, path: &str) -> &'a mut toml::Table {
    let steps = path.split('.').filter(|step| !step.is_empty());
    steps.fold(file, |table, step| {
        match table.get_mut(step).unwrap_or_else(|| panic!("no {step}")) {
            Value::Table(table) => table,
            Value::Array(list) => list[0].as_table_mut().expect("a table"),
            other => panic!("{step} is {other}"),
        }
    })
}

const SCENARIO: &str = r#"
name = "all-keys"
robot = "lwr_iv"
law = "exact"
duration_s = 20.0
cycle_ms = 2.0
start_deg = [0, 35, 0, -80, 20, 60, 0]
mount = { rpy_deg = [0, 90, 0] }
tool = { shift_m = [0, 0, 0.1], rpy_deg = [0, 0, 90], mass_kg = 1, center_of_mass_m = [0, 0, 0.1], inertia_kg_m2 = [1, 0, 0, 1, 0, 1] }
null_space = { stiffness = [20, 20, 15, 15, 3, 2, 0.2], damping = [4, 4, 3, 3, 0.4, 0.3, 0.03], damping_rate = 5, posture = "integral-coupled", rate_gain = 5 }
observer = { gain = 50 }

[joint_limits]
acceleration = [20, 20, 20, 20, 20, 20, 20]
braking = [8, 8, 8, 8, 8, 8, 8]
speed_gain = [25, 25, 25, 25, 25, 25, 25]
position_gain = 10
margin_deg = 1
speed_share = 0.9

[[level]]
task = "orientation"
point = { link = 7, offset_m = [0, 0, 0.1] }
axes = "x"
stiffness = 400
damping = [40]
limits = { drive_mobility = 0.05, release_mobility = 0.005, error_speed_m_s = 0.3, lost_speed_m_s = 0.15, stiff_mobility = 0.04 }
reference = { kind = "hold" }
absent = true
stale = { after_s = 0.2, then = "release" }

[[level]]
point = "wrist"
axes = "xy"
stiffness = 400
damping = 40
reference = { kind = "hold" }

[[event]]
kind = "remove"
at_s = 2
level = 2

[[contact]]
point = "elbow"
from_s = 3
to_s = 6
ramp_s = 0.3
force_n = [0, 35, 0]

[[hand]]
point = "elbow"
from_s = 3
to_s = 6
direction = "y"
stiffness_n_m = 500
damping_ns_m = 20
travel_m = 0.1
approach_s = 0.5

[[limit]]
plant = "ideal"
contacts = true
measurement = "fri"
dead_cycles = 2
metric = "level1_rms_mrad"
below = 1
"#;

/// An event of every kind.
const EVENTS: [(&str, &str); 5] = [
    (
        "add",
        "kind = 'add'\nat_s = 1\nduration_s = 1\nlevel = 1\nplace = 1",
    ),
    (
        "remove",
        "kind = 'remove'\nat_s = 1\nduration_s = 1\nlevel = 2",
    ),
    (
        "gains",
        "kind = 'gains'\nat_s = 1\nduration_s = 1\nlevel = 2\nstiffness = 100\ndamping = 20",
    ),
    (
        "reorder",
        "kind = 'reorder'\nat_s = 1\nduration_s = 1\norder = [2]",
    ),
    (
        "null-space",
        "kind = 'null-space'\nat_s = 1\nduration_s = 1\nstiffness = [9, 9, 9, 9, 1, 1, 0.1]\n\
         damping = [4, 4, 3, 3, 0.4, 0.3, 0.03]\ndamping_rate = 5",
    ),
];

/// A table of every kind of reference.
const REFERENCES: [(&str, &str); 6] = [
    ("hold", "kind = 'hold'"),
    ("move", "kind = 'move'\nby_m = [0, 0, 0.1]\nduration_s = 2"),
    (
        "there-and-back",
        "kind = 'there-and-back'\nby_m = [0, 0, 0.1]\nfrom_s = 1\nduration_s = 2\nramp_s = 0.5\nhold_s = 1",
    ),
    (
        "circle",
        "kind = 'circle'\nplane = 'yz'\nradius_m = 0.1\nperiod_s = 6\ngrowth_s = 2",
    ),
    (
        "spiral",
        "kind = 'spiral'\nplane = 'yz'\nradius_m = 0.1\nperiod_s = 6\ngrowth_s = 20",
    ),
    (
        "swing",
        "kind = 'swing'\naxis = [0, 0, 1]\naxis_of = 'own'\nangle_deg = 20\nperiod_s = 4\ngrowth_s = 2",
    ),
];

const ARM: &str = r#"
name = "all-keys"
gravity_m_s2 = [0, 0, -9]
base = { shift_m = [0, 0, 0.3], rpy_deg = [0, 0, 90] }
flange = { shift_m = [0, 0, 0.1], rpy_deg = [0, 0, 90] }
damping_postures_deg = [[0, 30, 0, -80, 0, 60, 0]]
joint = [
  { name = "J1", a_m = 0.01, alpha_deg = 90, d_m = 0.01, angle_offset_deg = 10, mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], rotor_inertia_kg_m2 = 0.1, friction = { coulomb_nm = 1, viscous_nms_rad = 1, smoothing_rad_s = 0.1 }, position_range_deg = [-120, 120], speed_limit_deg_s = 100, end_approach = { margin_rad_s = 0.1, deceleration_rad_s2 = 5, ends_deg = [-125, 125] }, torque_limit_nm = 100, torque_rate_limit_nm_s = 500, brake_rate_limit_nm_s = 5000 },
  { name = "J2", alpha_deg = -90, mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], position_range_deg = [-120, 120], speed_limit_deg_s = 100, torque_limit_nm = 100 },
  { name = "J3", alpha_deg = -90, d_m = 0.4, mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], position_range_deg = [-120, 120], speed_limit_deg_s = 100, torque_limit_nm = 100 },
  { name = "J4", alpha_deg = 90, mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], position_range_deg = [-120, 120], speed_limit_deg_s = 100, torque_limit_nm = 100 },
  { name = "J5", alpha_deg = 90, d_m = 0.4, mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], position_range_deg = [-120, 120], speed_limit_deg_s = 100, torque_limit_nm = 100 },
  { name = "J6", alpha_deg = -90, mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], position_range_deg = [-120, 120], speed_limit_deg_s = 100, torque_limit_nm = 100 },
  { name = "J7", mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 0, 0, 1, 0, 1], position_range_deg = [-120, 120], speed_limit_deg_s = 100, torque_limit_nm = 100 },
]

[joint_limits]
acceleration = [20, 20, 20, 20, 20, 20, 20]
braking = [8, 8, 8, 8, 8, 8, 8]
speed_gain = [25, 25, 25, 25, 25, 25, 25]
position_gain = 10
margin_deg = 1
speed_share = 0.9

[[point]]
name = "elbow"
link = 3
offset_m = [0, 0, 0.1]
"#;
