//! Limits of joints that an arm does not bring itself.

use arms::{ALL, FR3, LWR_IV};
use controller_core::arm::{ArmModel, ArmParameters, JointLimits, LinkParameters};
use controller_core::joint::{DOF, JointState, JointVector};
use controller_core::law::limits::joint_limits;
use hil_sim::plant::PlantModel;
use stratum_tests::random::States;

/// In cycles of 2 ms.
fn limits(arm: &ArmParameters, dead_cycles: u8) -> JointLimits {
    let model = ArmModel::<f64>::new(arm).expect("a table");
    joint_limits(arm, &model, 0.002, dead_cycles)
}

/// The arms whose limits are made by the rule; the LWR as if it had none.
fn by_rule() -> Vec<ArmParameters> {
    let bare = |arm: &&ArmParameters| ArmParameters {
        limits: None,
        ..**arm
    };
    ALL.iter().map(bare).collect()
}

/// M \[kg m2\] by the kinetic energy of the plant.
fn mass_matrix(plant: &PlantModel, q: &JointVector<f64>) -> [[f64; DOF]; DOF] {
    let energy = |i: usize, j: usize| {
        let mut dq = JointVector::zeros();
        dq[i] += 1.0;
        dq[j] += 1.0;
        plant.kinetic_energy(&JointState { q: *q, dq })
    };
    let own: [f64; DOF] = core::array::from_fn(|i| energy(i, i) / 2.0);
    core::array::from_fn(|i| core::array::from_fn(|j| energy(i, j) - (own[i] + own[j]) / 2.0))
}

/// Postures within the ranges.
fn postures(arm: &ArmParameters, count: usize) -> Vec<JointVector<f64>> {
    let mut states = States::new(11);
    let posture = |_| {
        let shares = states.vector();
        JointVector::from_fn(|i, _| {
            let [min, max] = arm.links[i].position_range;
            f64::midpoint(min, max) + shares[i].clamp(-1.0, 1.0) * (max - min) / 2.0
        })
    };
    (0..count).map(posture).collect()
}

/// Where every joint swings by itself as fast as its bounds let it the torques follow.
#[test]
fn bounds_ask_for_no_more_torque_rate_than_there_is() {
    for arm in by_rule() {
        let (limits, plant) = (limits(&arm, 0), PlantModel::new(&arm));
        let mut most: f64 = 0.0;
        for q in postures(&arm, 300) {
            for (row, link) in mass_matrix(&plant, &q).iter().zip(&arm.links) {
                let swings = (0..DOF).map(|j| {
                    let change = limits.speed_gain[j] * limits.acceleration[j];
                    (row[j] * change).powi(2)
                });
                let rate = swings.sum::<f64>().sqrt();
                most = most.max(rate / link.torque_rate_limit);
            }
        }
        println!("{}: {most:.2} of the torque rate", arm.name);
        assert!(most <= 0.9, "{}: {most}", arm.name);
    }
}

/// s of a joint with more than the least kv against the largest of the others, with the M_jj
/// of random postures; the rule knows larger ones.
#[test]
fn light_joints_do_not_shake_heavy_ones() {
    for arm in by_rule() {
        let (limits, plant) = (limits(&arm, 0), PlantModel::new(&arm));
        let mut shaking = [0.0f64; DOF];
        for q in postures(&arm, 300) {
            let matrix = mass_matrix(&plant, &q);
            for (j, most) in shaking.iter_mut().enumerate() {
                let change = limits.speed_gain[j] * limits.acceleration[j];
                *most = most.max(change * matrix[j][j].sqrt());
            }
        }
        let of = |light: bool| {
            let joints = (0..DOF).filter(|&j| (limits.speed_gain[j] > 25.0) == light);
            joints.map(|j| shaking[j]).fold(0.0, f64::max)
        };
        let share = of(true) / of(false);
        println!("{}: {share:.2}", arm.name);
        // Of 300 random postures none may have the largest M_jj of the heavy joint; 5 % is more
        // than they miss of it.
        assert!(share < 0.5 * 1.05, "{}: {share}", arm.name);
    }
}

/// v_p at a way `d` \[rad\] to the end less the margin.
fn allowed(limits: &JointLimits, joint: usize, d: f64) -> f64 {
    let (k, a) = (limits.position_gain, limits.braking[joint]);
    let turn = a / (2.0 * k * k);
    match d < 2.0 * turn {
        true => k * d,
        false => (2.0 * a * (d - turn)).sqrt(),
    }
}

/// Largest v_p of any place, as a share of what `link` may have there.
fn most_of_the_speed_limit(limits: &JointLimits, joint: usize, link: &LinkParameters) -> f64 {
    let [min, max] = link.position_range;
    let most = limits.speed_share * link.speed_limit;
    let mut share: f64 = 0.0;
    for place in 1..4000 {
        let d = (max - min) * f64::from(place) / 4000.0;
        let speed = allowed(limits, joint, d).min(most);
        let [_, up] = link.speed_range(max - limits.margin - d);
        let [down, _] = link.speed_range(min + limits.margin + d);
        share = share.max(speed / up).max(-speed / down);
    }
    share
}

#[test]
fn a_speed_limit_that_depends_on_the_way_to_the_end_is_kept() {
    let own = ArmParameters {
        limits: LWR_IV.limits,
        ..FR3
    };
    for arm in [FR3, own] {
        let limits = limits(&arm, 0);
        for (joint, link) in arm.links.iter().enumerate() {
            let share = most_of_the_speed_limit(&limits, joint, link);
            println!("{}: {share:.4}", link.name);
            // The ways are compared at 32 speeds: 0.1 % may be between.
            assert!(
                share <= limits.speed_share * 1.001,
                "{}: {share}",
                link.name
            );
        }
    }
    // Not slower than needed: the bound is touched where it decides.
    let limits = limits(&FR3, 0);
    let share = most_of_the_speed_limit(&limits, 1, &FR3.links[1]);
    assert!(share > 0.999 * limits.speed_share, "{share}");
}

/// The rule gives nearly what the LWR says of itself.
#[test]
fn the_rule_is_near_the_lwr() {
    let bare = ArmParameters {
        limits: None,
        ..LWR_IV
    };
    let (own, rule) = (limits(&LWR_IV, 0), limits(&bare, 0));
    assert_eq!(Some(own), LWR_IV.limits);
    for (own, rule) in [
        (own.acceleration, rule.acceleration),
        (own.braking, rule.braking),
        (own.speed_gain, rule.speed_gain),
    ] {
        println!("{own:.1?} {rule:.1?}");
        for (own, rule) in own.iter().zip(rule) {
            assert!((0.75..1.25).contains(&(rule / own)), "{own} {rule}");
        }
    }
}

/// Loops that answer later are slower: h kv is at most 0.4 over all cycles until a torque acts.
#[test]
fn dead_cycles_slow_the_bounds_down() {
    for arm in by_rule() {
        for dead_cycles in 0..4 {
            let limits = limits(&arm, dead_cycles);
            for j in 0..DOF {
                let turn = limits.speed_gain[j] * 0.002 * f64::from(dead_cycles + 1);
                assert!(turn <= 0.4 + 1e-12, "{} {turn}", arm.name);
                assert!(limits.braking[j] <= 0.4 * limits.acceleration[j]);
            }
        }
    }
}
