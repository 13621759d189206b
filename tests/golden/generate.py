"""Golden data of the arm's kinematics and dynamics, computed by Pinocchio.

    pip install pin numpy
    python generate.py            # writes dynamics.json beside this file
    python generate.py --check    # only runs the checks of Pinocchio's own output

Reads arm.json, the tables of the arm, and writes dynamics.json; README.md says
what is in it. Nothing is random from run to run.

Two things that implementations disagree about are checked here before anything
is written, at every state:
- the Coriolis matrix must be the Christoffel factorisation;
- the derivative of a Jacobian must be the derivative of its entries.
"""

import argparse
import json
import math
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
STATES = 200
SEED = 20180927
DOF = 7

# Points of the arm: link that carries them, and offset in its DH frame [m].
POINTS = {
    "flange": (7, None),  # (0, 0, flange) of the tables
    "elbow": (3, (0.0, 0.0, 0.0)),
    "upper": (3, (0.0, 0.15, 0.0)),
    "wrist": (5, (0.0, 0.0, 0.0)),
    "forearm": (5, (0.0, -0.19, 0.0)),
}


def rotation_x(angle):
    # The tables mean right angles; cos(pi/2) is 6e-17 in floating point.
    c, s = (0.0 if abs(v) < 1e-15 else v for v in (math.cos(angle), math.sin(angle)))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def build(arm):
    """Pinocchio model of the arm.

    Pinocchio's joint frame i is DH frame i - 1 turned by q_i; DH frame i is
    fixed in it. Inertias and points are moved from the one to the other.
    """
    model = pin.Model()
    model.gravity = pin.Motion(np.array(arm["gravity"]), np.zeros(3))
    placement = pin.SE3(np.eye(3), np.array([0.0, 0.0, arm["base_height"]]))
    parent = 0
    for number, link in enumerate(arm["links"], 1):
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint{number}")
        dh = pin.SE3(rotation_x(link["alpha"]), np.array([link["a"], 0.0, link["d"]]))
        xx, xy, xz, yy, yz, zz = link["inertia"]
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        inertia = pin.Inertia(link["mass"], np.array(link["com"]), tensor)
        model.appendBodyToJoint(parent, inertia, dh)
        for name, (carrier, offset) in POINTS.items():
            if carrier == number:
                at = np.array(offset or (0.0, 0.0, arm["flange"]))
                frame = dh * pin.SE3(np.eye(3), at)
                model.addFrame(pin.Frame(name, parent, frame, pin.FrameType.OP_FRAME))
        placement = dh
    return model


def mismatched(arm, rng):
    """The arm with masses and inertias 5-10 % off and centres of mass 3 mm off."""
    other = json.loads(json.dumps(arm))
    other["name"] = "mismatched"
    for link in other["links"]:
        factor = 1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.10)
        link["mass"] *= factor
        link["inertia"] = [factor * moment for moment in link["inertia"]]
        link["com"] = [c + 0.003 * rng.standard_normal() for c in link["com"]]
    return other


def column(arm, key):
    return np.array([link[key] for link in arm["links"]])


def states(arm, rng):
    """Postures, speeds, torques and accelerations to evaluate at."""
    q_max, dq_max = column(arm, "position_limit"), column(arm, "speed_limit")
    torque_max = column(arm, "torque_limit")
    zero = np.zeros(DOF)
    alternating = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0])
    bent = np.radians([0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0])
    special = [
        (zero, zero, zero, zero),  # stretched upwards, at rest
        (zero, dq_max, zero, zero),
        (np.radians([0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0]), zero, zero, zero),
        (np.radians([0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0]), -dq_max, torque_max, zero),
        (q_max, zero, zero, zero),
        (-q_max, dq_max, -torque_max, zero),
        (q_max * alternating, dq_max * alternating, torque_max * alternating, zero),
        (bent, zero, zero, zero),
        (bent, dq_max, torque_max, zero),
        (bent, -dq_max * alternating, torque_max * alternating, zero),
    ]
    yield from special
    for _ in range(STATES - len(special)):
        yield (
            rng.uniform(-1.0, 1.0, DOF) * q_max,
            rng.uniform(-1.0, 1.0, DOF) * dq_max,
            rng.uniform(-1.0, 1.0, DOF) * torque_max,
            rng.uniform(-10.0, 10.0, DOF),
        )


def mass_matrix(model, data, q):
    upper = np.triu(pin.crba(model, data, q))
    return upper + np.triu(upper, 1).T


def frame_jacobian(model, data, q, frame):
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    return pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED).copy()


def jacobian_derivative(model, data, q, dq, frame):
    """Entry-wise time derivative of the LOCAL_WORLD_ALIGNED Jacobian."""
    pin.computeJointJacobiansTimeVariation(model, data, q, dq)
    pin.updateFramePlacements(model, data)
    return pin.getFrameJacobianTimeVariation(
        model, data, frame, pin.LOCAL_WORLD_ALIGNED
    ).copy()


def evaluate(model, data, state, points):
    q, dq, torque, ddq_in = state
    m = mass_matrix(model, data, q)
    c = pin.computeCoriolisMatrix(model, data, q, dq).copy()
    out = {
        "q": q,
        "dq": dq,
        "torque": torque,
        "mass_matrix": m,
        "coriolis_matrix": c,
        "coriolis": pin.nonLinearEffects(model, data, q, dq)
        - pin.computeGeneralizedGravity(model, data, q),
        "gravity": pin.computeGeneralizedGravity(model, data, q).copy(),
        "ddq": pin.aba(model, data, q, dq, torque).copy(),
        "ddq_in": ddq_in,
        "rnea": pin.rnea(model, data, q, dq, ddq_in).copy(),
        "kinetic_energy": pin.computeKineticEnergy(model, data, q, dq),
        "potential_energy": pin.computePotentialEnergy(model, data, q),
    }
    if not points:
        del out["coriolis_matrix"]
        return out
    out["points"] = {}
    for name in POINTS:
        frame = model.getFrameId(name)
        jacobian = frame_jacobian(model, data, q, frame)
        derivative = jacobian_derivative(model, data, q, dq, frame)
        point = {
            "position": data.oMf[frame].translation.copy(),
            "jacobian": jacobian[:3],
            "jacobian_dot": derivative[:3],
        }
        if name == "flange":
            point["angular_jacobian"] = jacobian[3:]
            point["angular_jacobian_dot"] = derivative[3:]
        out["points"][name] = point
    return out


def central(function, q, step):
    """Derivatives of a matrix function along each coordinate, error O(step^4)."""
    slopes = []
    for k in range(DOF):
        e = np.zeros(DOF)
        e[k] = step
        near = function(q + e) - function(q - e)
        far = function(q + 2 * e) - function(q - 2 * e)
        slopes.append((8.0 * near - far) / (12.0 * step))
    return np.array(slopes)


def check(model, data, state):
    """Largest errors of the definitions that must hold, see the head."""
    q, dq, torque, ddq_in = state
    slopes = central(lambda x: mass_matrix(model, data, x), q, 1e-3)
    c = pin.computeCoriolisMatrix(model, data, q, dq).copy()
    m_dot = np.einsum("kij,k->ij", slopes, dq)
    # C_ij = sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) dq_k / 2
    christoffel = 0.5 * (
        m_dot + np.einsum("jik,k->ij", slopes, dq) - np.einsum("ijk,k->ij", slopes, dq)
    )
    jacobian_error = 0.0
    for name in POINTS:
        frame = model.getFrameId(name)
        along = central(lambda x: frame_jacobian(model, data, x, frame), q, 1e-3)
        numeric = np.einsum("kij,k->ij", along, dq)
        exact = jacobian_derivative(model, data, q, dq, frame)
        jacobian_error = max(jacobian_error, np.abs(numeric - exact).max())
    m = mass_matrix(model, data, q)
    bias = pin.nonLinearEffects(model, data, q, dq)
    forward = m @ pin.aba(model, data, q, dq, torque) + bias - torque
    return {
        "dM/dt = C + C^T": np.abs(m_dot - c - c.T).max(),
        "C of Christoffel symbols": np.abs(christoffel - c).max(),
        "dJ/dt entry by entry": jacobian_error,
        "M ddq + C dq + g = torque": np.abs(forward).max(),
    }


def plain(value):
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return (value + 0.0).tolist()  # no negative zeros
    return float(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--arm", type=pathlib.Path, default=HERE / "arm.json")
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "dynamics.json")
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args()

    nominal = json.loads(options.arm.read_text())
    rng = np.random.default_rng(SEED)
    arms = {"nominal": nominal, "mismatched": mismatched(nominal, rng)}
    lines = []
    for label, arm in arms.items():
        model = build(arm)
        data = model.createData()
        worst = {}
        rows = []
        for state in states(arm, rng):
            for name, error in check(model, data, state).items():
                worst[name] = max(worst.get(name, 0.0), error)
            values = plain(evaluate(model, data, state, label == "nominal"))
            rows.append(json.dumps(values, separators=(",", ":")))
        for name, error in worst.items():
            print(f"{label}: {name}: {error:.1e}")
        if max(worst.values()) > 1e-8:
            raise SystemExit("Pinocchio's output is not what README.md says")
        tables = json.dumps(arm, separators=(",", ":"))
        body = ",\n".join(rows)
        lines.append(f'"{label}":{{"arm":{tables},"states":[\n{body}\n]}}')
    if not options.check:
        generator = json.dumps(f"pinocchio {pin.__version__}, seed {SEED}")
        text = f'{{"generator":{generator},\n' + ",\n".join(lines) + "}\n"
        options.out.write_text(text)


if __name__ == "__main__":
    main()
