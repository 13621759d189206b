"""Golden data of all arms of the crate `arms`, computed by Pinocchio.

    pip install pin numpy
    python arms.py                     # 20 states of each arm into arms.json
    python arms.py --states 200        # more: the test takes what it finds
    python arms.py --printed           # what right angles of 1.5708 would make; writes nothing

Reads arm_tables.json: the public descriptions (source, commit and licence stand in
arms/src) as standard DH tables with exact right angles. Every joint is a line in the
base-plate frame at q = 0; the model has all its frames there in base-plate axes, so
that it shares no frame with the tables. The other side of a pair of arms is made by
reflecting those lines and bodies, not by tables.

Odd states have the arm mounted in another pose and 2 kg at its flange.
"""

import argparse
import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
SEED = 20240229
DOF = 7
POINTS = {"elbow": 3, "wrist": 5, "flange": 7}
MIRROR = np.diag([1.0, -1.0, 1.0])
# The joint that both sides turn the same way.
KEEPS_SENSE = 4

# Another mounting: turned, then shifted.
TURN = np.array([[0.6, 0.0, 0.8], [0.64, 0.6, -0.48], [-0.48, 0.8, 0.36]])
SHIFT = np.array([0.3, -0.2, 0.7])
# At the flange: pose, mass, centre of mass, inertia about it, in the tool's frame.
TOOL = (
    pin.SE3(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), np.array([0.01, -0.02, 0.05])),
    pin.Inertia(2.0, np.array([0.02, 0.01, 0.06]), np.diag([0.004, 0.005, 0.003])),
)


def quarter(n, axis):
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][n % 4]
    turn = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}
    return pin.SE3(np.array(turn[axis], float), np.zeros(3))


def printed_quarter(n, axis):
    """As descriptions print it: 3.7e-6 rad more than a right angle."""
    turn = pin.utils.rotate(axis, 1.5708 * (n if abs(n) < 3 else n - 4 * np.sign(n)))
    return pin.SE3(turn, np.zeros(3))


def shift(x, y, z):
    return pin.SE3(np.eye(3), np.array([x, y, z], float))


def pose(table):
    return pin.SE3(np.array(table["rotation"], float).reshape(3, 3), np.array(table["xyz"], float))


class Arm:
    """Lines, bodies and points at q = 0 in base-plate axes."""

    def __init__(self, table, quarter=quarter):
        self.gravity = np.array(table["gravity"], float)
        self.axes, self.origins, self.bodies, self.points = [], [], [], {}
        self.rotor = np.array(table["rotor_inertia"], float)
        self.limits = [np.array(table[key], float) for key in ("q_min", "q_max", "speed")]
        frame = pose(table["base"])
        for i in range(DOF):
            self.axes.append(frame.rotation[:, 2].copy())
            self.origins.append(frame.translation.copy())
            frame = frame * quarter(table["offset_quarters"][i], "z")
            frame = frame * shift(table["a"][i], 0, table["d"][i]) * quarter(table["alpha_quarters"][i], "x")
            link = table["links"][i]
            xx, xy, xz, yy, yz, zz = link["inertia"]
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            turned = frame.rotation @ tensor @ frame.rotation.T
            self.bodies.append((link["mass"], frame.act(np.array(link["com"])), turned, frame.translation.copy()))
            for name, carrier in POINTS.items():
                if carrier == i + 1:
                    self.points[name] = frame
        self.points["flange"] = self.points["flange"] * pose(table["flange"])

    def mirrored(self, same_parts):
        other = object.__new__(Arm)
        other.gravity = MIRROR @ self.gravity
        senses = [1.0 if i + 1 == KEEPS_SENSE else -1.0 for i in range(DOF)]
        # A turn is mirrored to the opposite turn about the mirrored line.
        other.axes = [-sense * (MIRROR @ axis) for sense, axis in zip(senses, self.axes)]
        other.origins = [MIRROR @ origin for origin in self.origins]
        other.bodies = []
        for number, (mass, com, tensor, near) in enumerate(self.bodies, 1):
            image = np.eye(3) if number in same_parts else MIRROR
            com = MIRROR @ near + image @ (com - near)
            other.bodies.append((mass, com, image @ tensor @ image, MIRROR @ near))
        other.points = {
            name: pin.SE3(MIRROR @ frame.rotation @ MIRROR, MIRROR @ frame.translation)
            for name, frame in self.points.items()
        }
        other.rotor = self.rotor
        low, high, speed = self.limits
        flip = np.array(senses) < 0
        other.limits = [np.where(flip, -high, low), np.where(flip, -low, high), speed]
        return other

    def model(self, mounted):
        model = pin.Model()
        stand = pin.SE3(TURN, SHIFT) if mounted else pin.SE3.Identity()
        model.gravity = pin.Motion(self.gravity, np.zeros(3))
        parent, place = 0, np.zeros(3)
        for i in range(DOF):
            step = pin.SE3(np.eye(3), self.origins[i] - place)
            joint = pin.JointModelRevoluteUnaligned(self.axes[i])
            parent = model.addJoint(parent, joint, (stand * step) if i == 0 else step, f"joint{i + 1}")
            place = self.origins[i]
            mass, com, tensor, _ = self.bodies[i]
            model.appendBodyToJoint(parent, pin.Inertia(mass, com - place, tensor), pin.SE3.Identity())
            for name, carrier in POINTS.items():
                if carrier == i + 1:
                    at = self.points[name]
                    frame = pin.SE3(at.rotation, at.translation - place)
                    model.addFrame(pin.Frame(name, parent, frame, pin.FrameType.OP_FRAME))
                    if mounted and name == "flange":
                        model.appendBodyToJoint(parent, TOOL[1], frame * TOOL[0])
        model.armature[:] = self.rotor
        return model


def evaluate(model, q, dq):
    data = model.createData()
    upper = np.triu(pin.crba(model, data, q))
    mass = upper + np.triu(upper, 1).T
    gravity = pin.computeGeneralizedGravity(model, data, q).copy()
    bias = pin.nonLinearEffects(model, data, q, dq)
    pin.computeJointJacobiansTimeVariation(model, data, q, dq)
    pin.updateFramePlacements(model, data)
    out = {"q": q, "dq": dq, "mass_matrix": mass[np.tril_indices(DOF)], "coriolis": bias - gravity, "gravity": gravity}
    for name in POINTS:
        frame = model.getFrameId(name)
        out[name] = data.oMf[frame].translation.copy()
        if name == "flange":
            axes = pin.LOCAL_WORLD_ALIGNED
            out["jacobian"] = pin.getFrameJacobian(model, data, frame, axes)[:3].copy().reshape(-1)
            rate = pin.getFrameJacobianTimeVariation(model, data, frame, axes)[:3]
            out["jacobian_dot_dq"] = rate @ dq
    return {key: [float(x) + 0.0 for x in value] for key, value in out.items()}


def show_printed(tables, states):
    """Largest difference of the flange and of M over random states."""
    rng = np.random.default_rng(SEED)
    for table in tables:
        if "mirror_of" in table:
            continue
        arms = [Arm(table), Arm(table, printed_quarter)]
        low, high, _ = arms[0].limits
        worst = np.zeros(2)
        for _ in range(states):
            q = rng.uniform(low, high)
            exact, printed = [evaluate(arm.model(False), q, np.zeros(DOF)) for arm in arms]
            way = np.subtract(exact["flange"], printed["flange"])
            mass = np.array([exact["mass_matrix"], printed["mass_matrix"]])
            worst = np.maximum(worst, [np.abs(way).max(), np.abs(mass[0] - mass[1]).max() / np.abs(mass[0]).max()])
        print(f"{table['name']}: flange {1e6 * worst[0]:.1f} um, M {worst[1]:.1e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--states", type=int, default=20)
    parser.add_argument("--printed", action="store_true")
    options = parser.parse_args()
    tables = json.loads((HERE / "arm_tables.json").read_text())
    if options.printed:
        show_printed(tables, options.states)
        return
    arms = {table["name"]: Arm(table) for table in tables if "mirror_of" not in table}
    rng = np.random.default_rng(SEED)
    lines = []
    for table in tables:
        arm = arms.get(table["name"]) or arms[table["mirror_of"]].mirrored(table["same_parts"])
        models = [arm.model(mounted) for mounted in (False, True)]
        low, high, speed = arm.limits
        rows = []
        for k in range(options.states):
            q, dq = rng.uniform(low, high), rng.uniform(-speed, speed)
            rows.append(json.dumps(evaluate(models[k % 2], q, dq), separators=(",", ":")))
        lines.append(f'"{table["name"]}":[\n' + ",\n".join(rows) + "\n]")
    (HERE / "arms.json").write_text("{" + ",\n".join(lines) + "}\n")


if __name__ == "__main__":
    main()
