//! The documents and the comments in the built-in scenarios say the declared ranges.

use cell::arm::joint::{BRAKE_RATE, TORQUE_RATE};
use cell::ranges::*;
use cell::scenario::BUILT_IN;

/// Ranges by how the first cell of their row below `heading` begins, in the order of the row.
fn rows(path: &str, heading: &str, rows: &[(&str, &[String])]) {
    let path = format!("{}/../docs/{path}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the document");
    for (key, ranges) in rows {
        let mut lines = text.lines().skip_while(|line| *line != heading);
        let row = lines.find(|line| line.starts_with(&format!("| {key}")));
        let mut rest = row.unwrap_or_else(|| panic!("{path}: no row {key}"));
        for range in *ranges {
            let found = rest.split_once(range.as_str());
            (_, rest) = found.unwrap_or_else(|| panic!("{path}: {key} has to say {range}"));
        }
    }
}

/// The names of all arms.
fn arms() -> Vec<String> {
    arms::ALL
        .iter()
        .map(|arm| format!("`{}`", arm.name))
        .collect()
}

fn text(range: Range<f64>) -> String {
    range.to_string()
}

#[test]
fn the_tables_say_the_ranges() {
    rows(
        "files.md",
        "## Scenario files",
        &[
            ("`duration_s` |", &[text(DURATION_S)]),
            ("`cycle_ms` |", &[text(CYCLE_MS)]),
            (
                "`[[level]]` |",
                &[LEVELS.to_string(), format!("at most {}", ROWS.max)],
            ),
            ("`robot` |", &arms()),
            ("`mount.rpy_deg` |", &[text(ANGLE_DEG)]),
            ("`tool.shift_m` |", &[text(OFFSET_M)]),
            ("`tool.rpy_deg` |", &[text(ANGLE_DEG)]),
            ("`tool.mass_kg` |", &[text(TOOL_MASS_KG)]),
            ("`tool.center_of_mass_m` |", &[text(OFFSET_M)]),
            ("`tool.inertia_kg_m2` |", &[text(INERTIA_KG_M2)]),
            ("`level.point` |", &[text(OFFSET_M)]),
            ("`level.stiffness`, `level.damping` |", &[text(GAIN)]),
            (
                "`by_m`, `duration_s` (move) |",
                &[text(OFFSET_M), text(DURATION_S)],
            ),
            (
                "`radius_m`, `period_s`, `growth_s` |",
                &[text(RADIUS_M), text(PERIOD_S), text(PERIOD_S)],
            ),
            (
                "`axis`, `angle_deg` (swing) |",
                &[text(AXIS_LENGTH), text(SWING_DEG)],
            ),
            ("`null_space.stiffness`, `.damping` |", &[text(GAIN)]),
            ("`null_space.damping_rate` |", &[text(GAIN)]),
            ("`null_space.rate_gain` |", &[text(RATE_GAIN)]),
            ("`observer.gain` |", &[text(GAIN)]),
            ("`contact.from_s`, `.to_s` |", &[text(TIME_S)]),
            ("`contact.force_n` |", &[text(FORCE_N)]),
            (
                "`hand.stiffness_n_m`, `.damping_ns_m` |",
                &[text(HAND_STIFFNESS_N_M), text(HAND_DAMPING_NS_M)],
            ),
            ("`hand.travel_m` |", &[text(HAND_TRAVEL_M)]),
            (
                "`limit.plant`",
                &[format!("0 (default) to {}", DEAD_CYCLES.max)],
            ),
            ("`limit.below` |", &[text(LIMIT)]),
        ],
    );
    rows(
        "arms.md",
        "## Arm files",
        &[
            ("`name` |", &[NAME_LETTERS.to_string()]),
            ("`gravity_m_s2` |", &[text(GRAVITY_M_S2)]),
            (
                "`base.shift_m`, `.rpy_deg` |",
                &[text(LENGTH_M), text(ANGLE_DEG)],
            ),
            (
                "`flange.shift_m`, `.rpy_deg` |",
                &[text(LENGTH_M), text(ANGLE_DEG)],
            ),
            ("`joint.a_m`, `.d_m` |", &[text(LENGTH_M)]),
            (
                "`joint.alpha_deg`, `.angle_offset_deg` |",
                &[text(ANGLE_DEG)],
            ),
            ("`joint.mass_kg` |", &[text(LINK_MASS_KG)]),
            ("`joint.center_of_mass_m` |", &[text(LENGTH_M)]),
            ("`joint.inertia_kg_m2` |", &[text(INERTIA_KG_M2)]),
            ("`joint.rotor_inertia_kg_m2` |", &[text(ROTOR_KG_M2)]),
            (
                "`joint.friction.coulomb_nm`, `.viscous_nms_rad` |",
                &[text(COULOMB_NM), text(VISCOUS_NMS)],
            ),
            (
                "`joint.friction.smoothing_rad_s` |",
                &[text(SMOOTHING_RAD_S)],
            ),
            ("`joint.position_range_deg` |", &[text(POSITION_DEG)]),
            ("`joint.speed_limit_deg_s` |", &[text(JOINT_SPEED_DEG_S)]),
            (
                "`joint.end_approach` |",
                &[
                    text(APPROACH_MARGIN_RAD_S),
                    text(DECELERATION_RAD_S2),
                    text(POSITION_DEG),
                ],
            ),
            ("`joint.torque_limit_nm` |", &[text(TORQUE_NM)]),
            (
                "`joint.torque_rate_limit_nm_s`, `.brake_rate_limit_nm_s` |",
                &[
                    text(TORQUE_RATE_NM_S),
                    TORQUE_RATE.to_string(),
                    BRAKE_RATE.to_string(),
                ],
            ),
            ("`[[point]]` |", &[POINTS.to_string()]),
            (
                "`point.name`, `.link`, `.offset_m` |",
                &[LINK.to_string(), text(LENGTH_M)],
            ),
            (
                "`damping_postures_deg` |",
                &[DAMPING_POSTURES.to_string(), text(POSITION_DEG)],
            ),
        ],
    );
    rows(
        "explain.md",
        "## Input",
        &[
            (
                "`levels` |",
                &[LEVELS.to_string(), format!("at most {}", ROWS.max)],
            ),
            ("`robot` |", &arms()),
            ("`point` |", &[text(OFFSET_M)]),
            ("`x`, `dx`, `ddx` |", &[text(QUATERNION_NORM)]),
        ],
    );
    rows(
        "architecture.md",
        "### Options of the plant",
        &[("`--dead-cycles N` |", &[DEAD_CYCLES.to_string()])],
    );
}

#[test]
fn the_built_in_scenarios_say_the_ranges() {
    for (name, scenario) in BUILT_IN {
        for (key, range) in [("duration_s", DURATION_S), ("cycle_ms", CYCLE_MS)] {
            let line = scenario.lines().find(|line| line.starts_with(key));
            let line = line.expect("the key");
            assert!(
                line.ends_with(&format!("# {range}")),
                "{name}: {line}: {range}"
            );
        }
    }
}
