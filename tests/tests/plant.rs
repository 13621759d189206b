//! The plant against golden data of an independent library, against closed
//! forms, and against what a mechanical system must do.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::arm::ArmParameters;
use controller_core::joint::{DOF, JointState, JointVector, Matrix3, Vector3};
use hil_sim::plant::{Plant, PlantModel, Rng, mismatched, noise};
use std::f64::consts::{PI, TAU};

use stratum_tests::golden::{Golden, Tables, Worst, file};

fn none() -> JointVector<f64> {
    JointVector::zeros()
}

#[test]
fn the_golden_tables_are_those_of_the_product() {
    // The JSON reader may round by a unit in the last place. So it checks the
    // layout, and Rust's exact parser the numbers, in the order of the file.
    let text = file("arm.json");
    let tables: Tables = serde_json::from_str(&text).expect("layout of arm.json");
    let mass = tables.parameters().links[6].mass;
    assert!((mass - LWR_IV.links[6].mass).abs() < 1e-15);
    let numbers: Vec<f64> = text
        .split(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)))
        .filter_map(|token| token.parse().ok())
        .collect();
    let mut expected = vec![LWR_IV.base.shift[2], LWR_IV.flange.shift[2]];
    expected.extend(LWR_IV.gravity);
    for link in &LWR_IV.links {
        expected.extend([link.a, link.alpha, link.d, link.mass]);
        expected.extend(link.com);
        expected.extend(link.inertia);
        expected.extend([link.position_range[1], link.speed_limit, link.torque_limit]);
    }
    assert_eq!(numbers, expected);
}

#[test]
fn forward_dynamics_agrees_with_pinocchio() {
    let golden = Golden::read();
    // Two ways to say how near. The forces left over are a matter of rounding
    // only: a hundred additions of terms of the size of the torques. The
    // accelerations are those forces through M^-1, with a condition number of
    // 1.6e4 (1e-16 * 1.6e4 * a few).
    let mut force = Worst::new("forces left over / largest force");
    let mut acceleration = Worst::new("ddq / largest ddq");
    let mut inverse = Worst::new("ddq from inverse dynamics [rad/s2]");
    for arm in [&golden.nominal, &golden.mismatched] {
        assert_eq!(arm.states.len(), 200);
        let model = PlantModel::new(&arm.arm.parameters());
        for golden in &arm.states {
            let JointState { q, dq } = golden.state();
            let bias = JointVector::from(golden.coriolis) + JointVector::from(golden.gravity);
            let torque = JointVector::from(golden.torque);
            let scale = torque.amax() + bias.amax() + 1.0;
            let expected = JointVector::from(golden.ddq);
            for way in [PlantModel::forward_dynamics, PlantModel::articulated_bodies] {
                let ddq = way(&model, &q, &dq, &torque, &none());
                force.add((golden.mass_matrix() * ddq + bias - torque).amax() / scale);
                acceleration.add((ddq - expected).amax() / (1.0 + expected.amax()));

                // Inverse dynamics and back: of 100 Nm the last digit, 1.4e-14,
                // moves joint 7 by 1e-10 rad/s2.
                let back = way(&model, &q, &dq, &golden.rnea.into(), &none());
                inverse.add((back - JointVector::from(golden.ddq_in)).amax());
            }
        }
    }
    force.within(1e-13);
    acceleration.within(1e-12);
    inverse.within(1e-10);
}

#[test]
fn points_and_jacobians_agree_with_pinocchio() {
    let golden = Golden::read();
    let model = PlantModel::new(&LWR_IV);
    // Lengths of 1 m through seven rotations: some units in the last place.
    let mut position = Worst::new("point position [m]");
    let mut jacobian = Worst::new("point Jacobian [m]");
    let mut speed = Worst::new("point velocity [m/s]");
    for golden in &golden.nominal.states {
        let state = golden.state();
        for (name, link, offset) in [
            ("flange", 7, Vector3::from(LWR_IV.flange.shift)),
            ("elbow", 3, Vector3::zeros()),
            ("upper", 3, Vector3::new(0.0, 0.15, 0.0)),
            ("wrist", 5, Vector3::zeros()),
            ("forearm", 5, Vector3::new(0.0, -0.19, 0.0)),
        ] {
            let expected = &golden.points[name];
            let (point, velocity) = model.point(&state, link, &offset);
            position.add((point - Vector3::from(expected.position)).amax());
            for axis in 0..3 {
                let mut force = Vector3::zeros();
                force[axis] = 1.0;
                let row = model.point_torque(&state.q, link, &offset, &force);
                let golden_row = JointVector::from(expected.jacobian[axis]);
                jacobian.add((row - golden_row).amax());
                speed.add((golden_row.dot(&state.dq) - velocity[axis]).abs());
            }
        }
    }
    position.within(2e-15);
    jacobian.within(2e-15);
    speed.within(1e-14);
}

#[test]
fn energies_agree_with_pinocchio() {
    let golden = Golden::read();
    // Sums of 20 J (kinetic) and 150 J (potential).
    let mut kinetic = Worst::new("kinetic energy [J]");
    let mut potential = Worst::new("potential energy [J]");
    for arm in [&golden.nominal, &golden.mismatched] {
        let model = PlantModel::new(&arm.arm.parameters());
        for golden in &arm.states {
            let state = golden.state();
            kinetic.add((model.kinetic_energy(&state) - golden.kinetic_energy).abs());
            potential.add((model.potential_energy(&state.q) - golden.potential_energy).abs());
        }
    }
    kinetic.within(1e-13);
    potential.within(1e-12);
}

/// Gravity torque g(q), as the J^T of every link's weight.
fn gravity(model: &PlantModel, arm: &ArmParameters, q: &JointVector<f64>) -> JointVector<f64> {
    (1..).zip(&arm.links).fold(none(), |sum, (number, link)| {
        let weight = Vector3::from(arm.gravity) * link.mass;
        sum - model.point_torque(q, number, &Vector3::from(link.com), &weight)
    })
}

const POSTURE: [f64; DOF] = [0.0, 0.61, 0.0, -1.4, 0.35, 1.05, 0.0];

#[test]
fn energy_changes_by_the_work_done() {
    // Torque is constant over a cycle and the force is constant in space, so
    // their work is torque * dq and force * dx, without a quadrature. What is
    // left is the integrator's error.
    let (cycle, offset) = (0.002, Vector3::new(0.0, -0.19, 0.0));
    let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, POSTURE.into(), cycle, 0);
    let stiffness = JointVector::from([60.0, 60.0, 40.0, 40.0, 4.0, 2.0, 0.05]);
    let damping = JointVector::from([8.0, 8.0, 5.0, 5.0, 0.4, 0.2, 0.01]);
    let energy = |plant: &Plant| {
        plant.model().kinetic_energy(plant.state())
            + plant.model().potential_energy(&plant.state().q)
    };
    let start = energy(&plant);
    let (mut work, mut turnover, mut fastest) = (0.0, 0.0, 0.0f64);
    for n in 0..5000 {
        let t = f64::from(n) * cycle;
        let before = *plant.state();
        let wanted =
            JointVector::from_fn(|i, _| POSTURE[i] + 0.6 * libm::sin((0.8 + 0.3 * i as f64) * t));
        let torque = (wanted - before.q).component_mul(&stiffness)
            - before.dq.component_mul(&damping)
            + gravity(plant.model(), &LWR_IV, &before.q);
        let turn = 2.0 * t;
        let force = Vector3::new(20.0 * libm::cos(turn), 25.0 * libm::sin(turn), -15.0);
        plant.advance(t, &torque, |_, model, state| {
            model.point_torque(&state.q, 5, &offset, &force)
        });
        let after = *plant.state();
        let at = |state| plant.model().point(&state, 5, &offset).0;
        let done = torque.dot(&(after.q - before.q)) + force.dot(&(at(after) - at(before)));
        work += done;
        turnover += done.abs();
        fastest = fastest.max(after.dq.amax());
    }
    println!("turnover {turnover:.1} J, up to {fastest:.1} rad/s");
    assert!(turnover > 50.0 && fastest > 1.0);
    let mut error = Worst::new("work of torque and contact [J]");
    error.add((energy(&plant) - start - work).abs());
    error.within(1e-10);
}

#[test]
fn energy_stays_without_torque() {
    // The limp arm tumbles for 10 s. The error is the integrator's, of order
    // four: it must be small with the reference step and vanish with a fine one.
    for (cycle, tolerance) in [(0.0005, 1e-4), (0.0001, 1e-6)] {
        let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, POSTURE.into(), cycle, 0);
        let energy = |plant: &Plant| {
            let model = plant.model();
            model.kinetic_energy(plant.state()) + model.potential_energy(&plant.state().q)
        };
        let start = energy(&plant);
        let mut error = Worst::new("energy of the limp arm [J]");
        let mut kinetic = 0.0f64;
        for n in 0..(10.0 / cycle) as u32 {
            plant.advance(f64::from(n) * cycle, &none(), |_, _, _| none());
            error.add((energy(&plant) - start).abs());
            kinetic = kinetic.max(plant.model().kinetic_energy(plant.state()));
        }
        assert!(kinetic > 30.0, "{kinetic}");
        error.within(tolerance);
    }
}

/// Joint 2 as the only joint that moves: moment of inertia about its axis, and
/// the gravity moment `weight * sin(q2)` that tips it over, from the tables.
fn compound_pendulum(arm: &ArmParameters) -> (f64, f64) {
    let (mut inertia, mut moment) = (0.0, 0.0);
    // At q = 0 every frame's axes lie along the base's, up to signs, and the
    // axis of joint 2 is the base's -y through the shoulder.
    let mut rotation = Matrix3::<f64>::identity();
    let mut origin = Vector3::zeros();
    for (number, link) in (1..).zip(&arm.links) {
        let (s, c) = (libm::sin(link.alpha), libm::cos(link.alpha));
        origin += rotation * Vector3::new(link.a, 0.0, link.d);
        rotation *= Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
        if number < 2 {
            continue;
        }
        let com = origin + rotation * Vector3::from(link.com);
        let [xx, xy, xz, yy, yz, zz] = link.inertia;
        let central = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let turned = rotation * central * rotation.transpose();
        inertia += turned[(1, 1)] + link.mass * (com.x * com.x + com.z * com.z);
        moment += link.mass * 9.81 * com.z;
    }
    (inertia, moment)
}

#[test]
fn one_swinging_joint_is_the_closed_form_pendulum() {
    // The other joints are held by an armature so large that what they yield
    // (torque / 1e12) is nothing.
    let mut arm = LWR_IV;
    // Balanced fore and aft, so that the closed form has a sine alone.
    for link in &mut arm.links {
        link.com[0] = 0.0;
    }
    let model = PlantModel::new(&arm);
    let mut held = JointVector::from_element(1e12);
    held[1] = 0.0;
    let (inertia, moment) = compound_pendulum(&arm);
    let at = |angle: f64| JointVector::from([0.0, angle, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let acceleration =
        |angle: f64, speed: f64| model.forward_dynamics(&at(angle), &at(speed), &none(), &held)[1];
    println!("inertia {inertia} moment {moment}");
    let mut error = Worst::new("pendulum acceleration [rad/s2]");
    for n in -1000..=1000 {
        let angle = f64::from(n) * TAU / 1000.0;
        error.add((acceleration(angle, 0.7) - moment / inertia * libm::sin(angle)).abs());
    }
    error.within(1e-10);

    // Large swings: period 2 pi sqrt(I / mgl) / agm(1, cos(amplitude / 2)).
    let mut error = Worst::new("pendulum period, relative");
    for amplitude in [0.2, 1.0, 2.0, 2.9] {
        let (mut a, mut b) = (1.0, libm::cos(amplitude / 2.0));
        for _ in 0..8 {
            (a, b) = ((a + b) / 2.0, (a * b).sqrt());
        }
        let expected = TAU * (inertia / moment).sqrt() / a;
        // From rest at one side, a quarter of a period to the lowest point.
        let (mut angle, mut speed, mut t) = (PI - amplitude, 0.0, 0.0);
        let step = |angle: f64, speed: f64, h: f64| {
            let k1 = acceleration(angle, speed);
            let k2 = acceleration(angle + 0.5 * h * speed, speed + 0.5 * h * k1);
            let s3 = speed + 0.5 * h * k2;
            let k3 = acceleration(angle + 0.5 * h * (speed + 0.5 * h * k1), s3);
            let k4 = acceleration(angle + h * s3, speed + h * k3);
            (
                angle + h * (speed + h / 6.0 * (k1 + k2 + k3)),
                speed + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4),
            )
        };
        let h = 0.5e-3;
        loop {
            let next = step(angle, speed, h);
            if next.0 >= PI {
                break;
            }
            (angle, speed, t) = (next.0, next.1, t + h);
        }
        // Newton's method for the rest of the last step.
        let mut rest = 0.0;
        for _ in 0..4 {
            let (reached, speed) = step(angle, speed, rest);
            rest += (PI - reached) / speed;
        }
        error.add((4.0 * (t + rest) / expected - 1.0).abs());
    }
    error.within(1e-10);
}

#[test]
fn the_realistic_plant_repeats_itself_and_depends_on_the_seed() {
    let run = |seed| {
        let mut plant = Plant::new(PlantKind::Realistic, &LWR_IV, POSTURE.into(), 0.002, seed);
        let mut bits = Vec::new();
        for n in 0..500 {
            let t = f64::from(n) * 0.002;
            let measured = plant.measure();
            let torque = gravity(plant.model(), &LWR_IV, &measured.q) - measured.dq * 0.1;
            plant.advance(t, &torque, |_, _, _| none());
            let state = plant.state();
            let values = [state.q, state.dq, measured.q, measured.dq];
            bits.extend(values.iter().flat_map(|v| v.iter().map(|x| x.to_bits())));
        }
        bits
    };
    assert_eq!(run(3), run(3));
    assert_ne!(run(3), run(4));
}

#[test]
fn the_realistic_plant_moves_as_its_mismatched_tables_say() {
    for seed in 0..20 {
        let plant = Plant::new(PlantKind::Realistic, &LWR_IV, POSTURE.into(), 0.002, seed);
        let arm = mismatched(&LWR_IV, &mut Rng::new(seed, noise::stream::MISMATCH));
        assert_eq!(*plant.model(), PlantModel::new(&arm));
        for (link, nominal) in arm.links.iter().zip(&LWR_IV.links) {
            let error = (link.mass / nominal.mass - 1.0).abs();
            assert!((0.05 - 1e-12..=0.10 + 1e-12).contains(&error));
            let moved = Vector3::from(link.com) - Vector3::from(nominal.com);
            assert!(moved.amax() > 0.0 && moved.amax() < 5.0 * 3e-3);
        }
    }
}

#[test]
fn friction_brings_the_hanging_arm_to_rest() {
    // Let go 0.5 rad beside hanging straight down. Gravity brings it back,
    // friction ends the swing. The rest posture differs from pi by the moved
    // centres of mass; torque noise keeps a trace of speed.
    let mut q0 = none();
    q0[1] = PI - 0.5;
    let mut plant = Plant::new(PlantKind::Realistic, &LWR_IV, q0, 0.002, 1);
    let energy = |plant: &Plant| {
        let model = plant.model();
        model.kinetic_energy(plant.state()) + model.potential_energy(&plant.state().q)
    };
    let (start, mut fastest) = (energy(&plant), 0.0f64);
    for n in 0..10_000 {
        plant.advance(f64::from(n) * 0.002, &none(), |_, _, _| none());
        fastest = fastest.max(plant.state().dq.amax());
        // The noise may feed in a little while everything still stands still.
        assert!(energy(&plant) < start + 1e-2);
    }
    let JointState { q, dq } = plant.state();
    assert!(fastest > 0.3, "{fastest}");
    assert!(dq.amax() < 0.02, "{dq}");
    assert!((q[1] - PI).abs() < 0.05 && (q[3]).abs() < 0.1, "{q}");
}

#[test]
fn dynamics_depend_on_nothing_but_their_arguments() {
    let model = PlantModel::new(&LWR_IV);
    let twin = PlantModel::new(&LWR_IV);
    for golden in Golden::read().nominal.states {
        let JointState { q, dq } = golden.state();
        let torque = golden.torque.into();
        let first = model.forward_dynamics(&q, &dq, &torque, &none());
        assert_eq!(first, model.forward_dynamics(&q, &dq, &torque, &none()));
        assert_eq!(first, twin.forward_dynamics(&q, &dq, &torque, &none()));
    }
}
