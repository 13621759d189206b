//! The plant against golden data of an independent library, against closed
//! forms, and against what a mechanical system must do.

use controller_core::joint::{DOF, JointMatrix, JointState, JointVector, Matrix3, Vector3};
use controller_core::model::{ArmParameters, LWR_IV, LinkParameters};
use hil_sim::plant::{Plant, PlantKind, PlantModel, Rng, mismatched, noise};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

#[derive(Deserialize)]
struct Golden {
    nominal: GoldenArm,
    mismatched: GoldenArm,
}

#[derive(Deserialize)]
struct GoldenArm {
    arm: Tables,
    states: Vec<GoldenState>,
}

#[derive(Deserialize)]
struct Tables {
    base_height: f64,
    flange: f64,
    gravity: [f64; 3],
    links: [LinkTables; DOF],
}

#[derive(Deserialize)]
struct LinkTables {
    a: f64,
    alpha: f64,
    d: f64,
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
    position_limit: f64,
    speed_limit: f64,
    torque_limit: f64,
}

#[derive(Deserialize)]
struct GoldenState {
    q: [f64; DOF],
    dq: [f64; DOF],
    torque: [f64; DOF],
    mass_matrix: [[f64; DOF]; DOF],
    coriolis: [f64; DOF],
    gravity: [f64; DOF],
    ddq: [f64; DOF],
    ddq_in: [f64; DOF],
    rnea: [f64; DOF],
    kinetic_energy: f64,
    potential_energy: f64,
    #[serde(default)]
    points: BTreeMap<String, GoldenPoint>,
}

#[derive(Deserialize)]
struct GoldenPoint {
    position: [f64; 3],
    jacobian: [[f64; DOF]; 3],
}

impl Tables {
    fn parameters(&self) -> ArmParameters {
        ArmParameters {
            name: "golden",
            base_height: self.base_height,
            flange: self.flange,
            gravity: self.gravity,
            links: self.links.each_ref().map(|link| LinkParameters {
                a: link.a,
                alpha: link.alpha,
                d: link.d,
                mass: link.mass,
                com: link.com,
                inertia: link.inertia,
                position_limit: link.position_limit,
                speed_limit: link.speed_limit,
                torque_limit: link.torque_limit,
            }),
        }
    }
}

impl GoldenState {
    fn state(&self) -> JointState<f64> {
        JointState {
            q: self.q.into(),
            dq: self.dq.into(),
        }
    }
}

fn file(name: &str) -> String {
    let path = format!("{}/golden/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn golden() -> Golden {
    serde_json::from_str(&file("dynamics.json")).expect("layout of dynamics.json")
}

fn none() -> JointVector<f64> {
    JointVector::zeros()
}

/// Keeps the largest error seen, and says it when the test ends.
struct Worst(&'static str, f64);

impl Worst {
    fn add(&mut self, error: f64) {
        // A NaN must not hide behind max().
        self.1 = if error <= self.1 { self.1 } else { error };
    }

    fn within(self, tolerance: f64) {
        println!("{}: {:.1e} of {tolerance:.0e}", self.0, self.1);
        assert!(
            self.1 <= tolerance,
            "{}: {:e} > {tolerance:e}",
            self.0,
            self.1
        );
    }
}

#[test]
fn the_golden_tables_are_those_of_the_product() {
    // The JSON reader rounds to within one unit, so the layout is read by it and
    // the numbers, in the order of the file, by Rust's own exact parser.
    let text = file("arm.json");
    let tables: Tables = serde_json::from_str(&text).expect("layout of arm.json");
    assert!((tables.links[6].mass - LWR_IV.links[6].mass).abs() < 1e-15);
    let numbers: Vec<f64> = text
        .split(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)))
        .filter_map(|token| token.parse().ok())
        .collect();
    let mut expected = vec![LWR_IV.base_height, LWR_IV.flange];
    expected.extend(LWR_IV.gravity);
    for link in &LWR_IV.links {
        expected.extend([link.a, link.alpha, link.d, link.mass]);
        expected.extend(link.com);
        expected.extend(link.inertia);
        expected.extend([link.position_limit, link.speed_limit, link.torque_limit]);
    }
    assert_eq!(numbers, expected);
}

#[test]
fn forward_dynamics_agrees_with_pinocchio() {
    let golden = golden();
    // Two ways to say how near. The forces left over are a matter of rounding
    // only: a hundred additions of terms of the size of the torques. The
    // accelerations are those forces through M^-1, with a condition number of
    // 1.6e4 (1e-16 * 1.6e4 * a few).
    let mut force = Worst("forces left over / largest force", 0.0);
    let mut acceleration = Worst("ddq / largest ddq", 0.0);
    let mut inverse = Worst("ddq from inverse dynamics [rad/s2]", 0.0);
    for arm in [&golden.nominal, &golden.mismatched] {
        assert_eq!(arm.states.len(), 200);
        let model = PlantModel::new(&arm.arm.parameters());
        for golden in &arm.states {
            let JointState { q, dq } = golden.state();
            let m = JointMatrix::from_fn(|i, j| golden.mass_matrix[i][j]);
            let bias = JointVector::from(golden.coriolis) + JointVector::from(golden.gravity);
            let torque = JointVector::from(golden.torque);
            let ddq = model.forward_dynamics(&q, &dq, &torque, &none());
            let scale = torque.amax() + bias.amax() + 1.0;
            force.add((m * ddq + bias - torque).amax() / scale);
            let expected = JointVector::from(golden.ddq);
            acceleration.add((ddq - expected).amax() / (1.0 + expected.amax()));

            // Inverse dynamics and back: of 100 Nm the last digit, 1.4e-14,
            // moves joint 7 by 1e-10 rad/s2.
            let back = model.forward_dynamics(&q, &dq, &golden.rnea.into(), &none());
            inverse.add((back - JointVector::from(golden.ddq_in)).amax());
        }
    }
    force.within(1e-13);
    acceleration.within(1e-12);
    inverse.within(1e-10);
}

#[test]
fn points_and_jacobians_agree_with_pinocchio() {
    let golden = golden();
    let model = PlantModel::new(&LWR_IV);
    // Lengths of 1 m through seven rotations: some units in the last place.
    let mut position = Worst("point position [m]", 0.0);
    let mut jacobian = Worst("point Jacobian [m]", 0.0);
    let mut speed = Worst("point velocity [m/s]", 0.0);
    for golden in &golden.nominal.states {
        let state = golden.state();
        for (name, link, offset) in [
            ("flange", 7, Vector3::new(0.0, 0.0, LWR_IV.flange)),
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
    let golden = golden();
    // Sums of 20 J (kinetic) and 150 J (potential).
    let mut kinetic = Worst("kinetic energy [J]", 0.0);
    let mut potential = Worst("potential energy [J]", 0.0);
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
    let mut error = Worst("work of torque and contact [J]", 0.0);
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
        let mut error = Worst("energy of the limp arm [J]", 0.0);
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
    let mut error = Worst("pendulum acceleration [rad/s2]", 0.0);
    for n in -1000..=1000 {
        let angle = f64::from(n) * TAU / 1000.0;
        error.add((acceleration(angle, 0.7) - moment / inertia * libm::sin(angle)).abs());
    }
    error.within(1e-9);

    // Large swings: period 2 pi sqrt(I / mgl) / agm(1, cos(amplitude / 2)).
    let mut error = Worst("pendulum period, relative", 0.0);
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
    error.within(1e-9);
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
    for golden in golden().nominal.states {
        let JointState { q, dq } = golden.state();
        let torque = golden.torque.into();
        let first = model.forward_dynamics(&q, &dq, &torque, &none());
        assert_eq!(first, model.forward_dynamics(&q, &dq, &torque, &none()));
        assert_eq!(first, twin.forward_dynamics(&q, &dq, &torque, &none()));
    }
}

/// `cargo test --release -p stratum-tests --test plant -- --ignored --nocapture`
#[test]
#[ignore = "a measurement of this machine"]
fn time_of_one_evaluation() {
    const COUNT: u32 = 160_000;
    let model = PlantModel::new(&LWR_IV);
    let mut q = JointVector::from(POSTURE);
    let begin = std::time::Instant::now();
    for _ in 0..COUNT {
        let ddq = model.forward_dynamics(&q, &q, &q, &none());
        q += ddq * 1e-12;
    }
    let elapsed = begin.elapsed();
    println!(
        "{:.0} ns each ({q:?})",
        elapsed.as_nanos() as f64 / f64::from(COUNT)
    );
    assert!(elapsed.as_secs_f64() < 0.4);
}
