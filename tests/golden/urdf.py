"""Golden data of the URDFs in urdf/, computed by Pinocchio on the very files.

    pip install pin numpy
    python urdf.py                                # 20 states of each into urdf.json
    python urdf.py FILE.urdf BASE TIP             # 20 states of another file, to standard output

The one thing that is changed in a file is what the import changes: angles and axes within 2e-5 rad of
right ones are right. Joints that are not between base and tip stay at 0. Everything is in axes of the
base link, in which gravity points along -z.
"""

import json
import math
import pathlib
import re
import sys

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
SEED = 20240229
DOF = 7
STATES = 20
NEAR = 2e-5
# File, base, tip.
FILES = [("iiwa_14", "base_link", "tool0"), ("skew", "plate", "l7"), ("two_arms", "torso", "tcp")]


def right_angle(angle):
    right = round(angle / (math.pi / 2)) * math.pi / 2
    return right if abs(angle - right) <= NEAR else angle


def right_axis(axis):
    unit = np.array(axis) / np.linalg.norm(axis)
    nearest = np.round(unit)
    near = np.linalg.norm(nearest) == 1 and np.linalg.norm(np.cross(unit, nearest)) <= NEAR
    return nearest if near else unit


def snapped(text):
    """The text with exact right angles in its joints."""

    def three(change):
        return lambda match: match[1] + " ".join(repr(float(x)) for x in change(match[2].split())) + match[3]

    def joint(match):
        part = re.sub(r'(rpy=")([^"]*)(")', three(lambda words: [right_angle(float(w)) for w in words]), match[0])
        return re.sub(r'(<axis\s+xyz=")([^"]*)(")', three(lambda words: right_axis([float(w) for w in words])), part)

    return re.sub(r"<joint\b.*?</joint>", joint, text, flags=re.DOTALL)


def between(text, base, tip):
    """Names of the turning joints from base to tip."""
    import xml.etree.ElementTree as xml

    above = {joint.find("child").get("link"): joint for joint in xml.fromstring(text).findall("joint")}
    names = []
    while tip != base:
        joint = above[tip]
        if joint.get("type") != "fixed":
            names.append(joint.get("name"))
        tip = joint.find("parent").get("link")
    return names[::-1]


def configuration(model, q):
    """Continuous joints take cosine and sine."""
    out = []
    for joint in range(1, model.njoints):
        angle = q[joint - 1]
        out += [math.cos(angle), math.sin(angle)] if model.joints[joint].nq == 2 else [angle]
    return np.array(out)


def evaluate(text, base, tip, states=STATES):
    text = snapped(text)
    model = pin.buildModelFromXML(text)
    names = between(text, base, tip)
    keep = [model.getJointId(name) for name in names]
    lock = [joint for joint in range(1, model.njoints) if joint not in keep]
    model = pin.buildReducedModel(model, lock, pin.neutral(model))
    assert model.nv == DOF and list(model.names)[1:] == names, list(model.names)
    model.armature[:] = 0
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    to_base = data.oMf[model.getFrameId(base)].inverse()
    turn = to_base.rotation
    model.gravity = pin.Motion(turn.T @ np.array([0.0, 0.0, -9.81]), np.zeros(3))
    # Of a continuous joint there are cosine and sine, from -1 to 1.
    low, high = [], []
    for joint in range(1, model.njoints):
        start, turns = model.joints[joint].idx_q, model.joints[joint].nq == 2
        low.append(-2 * math.pi if turns else model.lowerPositionLimit[start])
        high.append(2 * math.pi if turns else model.upperPositionLimit[start])
    rng, frame = np.random.default_rng(SEED), model.getFrameId(tip)
    rows = []
    for _ in range(states):
        q, dq = rng.uniform(low, high), rng.uniform(-model.velocityLimit, model.velocityLimit)
        c = configuration(model, q)
        upper = np.triu(pin.crba(model, data, c))
        mass = upper + np.triu(upper, 1).T
        gravity = pin.computeGeneralizedGravity(model, data, c).copy()
        bias = pin.nonLinearEffects(model, data, c, dq)
        pin.computeJointJacobians(model, data, c)
        pin.framesForwardKinematics(model, data, c)
        place = to_base * data.oMf[frame]
        jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        out = {
            "q": q,
            "dq": dq,
            "mass_matrix": mass[np.tril_indices(DOF)],
            "coriolis": bias - gravity,
            "gravity": gravity,
            "position": place.translation,
            "rotation": place.rotation.reshape(-1),
            "jacobian": (turn @ jacobian[:3]).reshape(-1),
            "angular_jacobian": (turn @ jacobian[3:]).reshape(-1),
        }
        rows.append({key: [float(x) + 0.0 for x in value] for key, value in out.items()})
    return rows


def text_of(rows):
    return "[\n" + ",\n".join(json.dumps(row, separators=(",", ":")) for row in rows) + "\n]"


def main():
    if len(sys.argv) == 4:
        path, base, tip = sys.argv[1:]
        print(text_of(evaluate(pathlib.Path(path).read_text(), base, tip)))
        return
    files = []
    for name, base, tip in FILES:
        rows = evaluate((HERE / "urdf" / f"{name}.urdf").read_text(), base, tip)
        files.append(f'"{name}":' + text_of(rows))
    (HERE / "urdf.json").write_text("{" + ",\n".join(files) + "}\n")


if __name__ == "__main__":
    main()
