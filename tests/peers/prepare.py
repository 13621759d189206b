"""Inputs of the peers from the golden data, and the same law as generated C.

    python prepare.py OUT      # arm.txt, states of each experiment, CasADi's C code

The symbolic terms are written out here in homogeneous coordinates, so that zeros of
the arm's tables vanish from the code; nothing is taken from the workspace but the
tables. Every line of a state file is an input as `layout` orders it, then the torque
that `tests/golden/laws.json` expects.
"""

import json
import math
import pathlib
import sys

import casadi as ca
import numpy as np

GOLDEN = pathlib.Path(__file__).resolve().parent.parent / "golden"
DOF = 7
# Experiment: its cases in the golden data; link, offset and rows of each level.
JOBS = {
    "two-level": ("two levels", [(7, "flange", 3)]),
    "case-1": ("three levels", [(7, "flange", 3), (5, "wrist", 2)]),
}


def layout(levels):
    """Names and shapes of an input, in the order of the state files."""
    square = (DOF, DOF)
    yield from [("q", DOF), ("dq", DOF), ("q_d", DOF), ("stiffness", square), ("damping", square)]
    yield from [("momentum", DOF), ("input", DOF), ("residual", DOF), ("gain", DOF), ("h", 1)]
    for level, (_, _, rows) in enumerate(levels):
        yield from [(f"{name}{level}", rows) for name in ("x", "dx", "ddx")]
        yield from [(f"{name}{level}", (rows, rows)) for name in ("kp", "kd")]


def size(shape):
    return math.prod(shape) if isinstance(shape, tuple) else shape


def flat(state):
    """A golden state in that order; matrices are symmetric, their layout does not matter."""
    space, step = state["null_space"], state["observer"]
    values = [state["q"], state["dq"], space["q_d"]]
    values += [np.diag(space["stiffness"]).ravel(), np.diag(space["damping"]).ravel()]
    values += [step["momentum_prev"], step["input_prev"], step["residual_prev"], step["gain"]]
    values += [[step["h"]]]
    for level in state["levels"]:
        values += [level["x"], level["dx"], level["ddx"]]
        values += [np.diag(level["kp"]).ravel(), np.diag(level["kd"]).ravel()]
    return np.concatenate(values)


def link_tables(link):
    """Constant transform behind the joint's turn, and the second moments P in the
    frame of the joint: the integral of (p, 1) (p, 1)^T dm."""
    c, s = (0.0 if abs(v) < 1e-15 else v for v in (math.cos(link["alpha"]), math.sin(link["alpha"])))
    place = np.array([[1, 0, 0, link["a"]], [0, c, -s, 0], [0, s, c, link["d"]], [0, 0, 0, 1]])
    xx, xy, xz, yy, yz, zz = link["inertia"]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    com = np.array([*link["com"], 1.0])
    second = link["mass"] * np.outer(com, com)
    second[:3, :3] += np.trace(tensor) / 2.0 * np.eye(3) - tensor
    return place, place @ second @ place.T


def hat(w, v):
    """Homogeneous matrix of the twist with angular velocity w, and v at the base."""
    return ca.vertcat(
        ca.horzcat(0, -w[2], w[1], v[0]),
        ca.horzcat(w[2], 0, -w[0], v[1]),
        ca.horzcat(-w[1], w[0], 0, v[2]),
        ca.SX(1, 4),
    )


def trace(a, b):
    """tr(a b^T)"""
    return ca.dot(a, b)


def terms(arm, q, dq):
    """M, C (Christoffel), g, transforms and twists of the links, axes and their rates."""
    base = np.eye(4)
    base[2, 3] = arm["base_height"]
    here, twist = ca.SX(base), ca.SX(4, 4)
    axes, rates, frames, twists, moments = [], [], [], [], []
    for i, link in enumerate(arm["links"]):
        place, second = link_tables(link)
        z, o = here[:3, 2], here[:3, 3]
        axis = hat(z, ca.cross(o, z))
        # d(axis)/dt = [V, axis] of the twist before the joint.
        rates.append(twist @ axis - axis @ twist)
        axes.append(axis)
        twist = twist + axis * dq[i]
        c, s = ca.cos(q[i]), ca.sin(q[i])
        turn = ca.SX(4, 4)
        turn[0, 0], turn[0, 1], turn[1, 0], turn[1, 1] = c, -s, s, c
        turn[2, 2] = turn[3, 3] = 1
        joint = here @ turn
        moments.append(joint @ ca.SX(ca.sparsify(ca.DM(second))) @ joint.T)
        here = joint @ ca.SX(ca.sparsify(ca.DM(place)))
        frames.append(here)
        twists.append(twist)
    mass, coriolis, gravity = ca.SX(DOF, DOF), ca.SX(DOF, DOF), ca.SX(DOF, 1)
    group, flow = ca.SX(4, 4), ca.SX(4, 4)
    field = ca.DM([*arm["gravity"], 0.0])
    for j in reversed(range(DOF)):
        group = group + moments[j]
        flow = flow + twists[j] @ moments[j]
        gravity[j] = -ca.dot(field, axes[j] @ group[:, 3])
        for i in range(j + 1):
            # The sum over the links behind the farther joint, both ways.
            mass[i, j] = mass[j, i] = trace(axes[i] @ group, axes[j])
            coriolis[i, j] = trace(axes[i], rates[j] @ group + axes[j] @ flow)
            coriolis[j, i] = trace(axes[j], rates[i] @ group + axes[i] @ flow)
    return mass, coriolis, gravity, frames, twists, axes, rates


def step(arm, levels, value):
    """docs/hierarchy.md: the exact law behind the observer, limited."""
    q, dq = value["q"], value["dq"]
    mass, coriolis, gravity, frames, twists, axes, rates = terms(arm, q, dq)
    rows, rates_of_rows, wanted = [], [], []
    for level, (link, name, count) in enumerate(levels):
        offset = [0.0, 0.0, arm["flange"] if name == "flange" else 0.0, 1.0]
        point = frames[link - 1] @ ca.DM(offset)
        speed = twists[link - 1] @ point
        zero = ca.SX(4, 1)
        j = ca.horzcat(*[axes[i] @ point if i < link else zero for i in range(DOF)])[:count, :]
        jdot = [rates[i] @ point + axes[i] @ speed if i < link else zero for i in range(DOF)]
        jdot = ca.horzcat(*jdot)[:count, :]
        error = value[f"x{level}"] - point[:count]
        rate = value[f"dx{level}"] - speed[:count]
        command = value[f"ddx{level}"] + value[f"kd{level}"] @ rate + value[f"kp{level}"] @ error
        rows.append(j)
        rates_of_rows.append(jdot)
        wanted.append(command - jdot @ dq)
    j, jdot, b = ca.vertcat(*rows), ca.vertcat(*rates_of_rows), ca.vertcat(*wanted)

    lower = cholesky(mass)
    whitened = [forward(lower, j[k, :].T) for k in range(j.shape[0])]
    r, q_t = gram_schmidt(whitened)

    momentum = mass @ dq
    rate = (momentum - value["momentum"]) / value["h"] - value["input"]
    decay = ca.exp(-value["gain"] * value["h"])
    residual = decay * value["residual"] + (1 - decay) * rate

    s = q_t @ (lower.T @ dq)
    w = backward(lower, q_t.T @ s)
    f = jdot.T @ backward(r, s) - coriolis @ dq - coriolis.T @ w
    f += value["stiffness"] @ (value["q_d"] - q) - value["damping"] @ (dq - w)
    f = forward(lower, f)
    y = forward(r, b) - q_t @ (forward(lower, residual) + f)
    torque = lower @ (q_t.T @ y + f) + coriolis @ dq + gravity
    limit = np.array([link["torque_limit"] for link in arm["links"]])
    torque = ca.fmin(ca.fmax(torque, -limit), limit)
    return [torque, residual, momentum, torque + coriolis.T @ dq - gravity]


def cholesky(a):
    n = a.shape[0]
    lower = ca.SX(n, n)
    for j in range(n):
        for i in range(j, n):
            rest = a[i, j] - sum(lower[i, k] * lower[j, k] for k in range(j))
            lower[i, j] = ca.sqrt(rest) if i == j else rest / lower[j, j]
    return lower


def forward(lower, b):
    x = []
    for i in range(lower.shape[0]):
        x.append((b[i] - sum(lower[i, k] * x[k] for k in range(i))) / lower[i, i])
    return ca.vertcat(*x)


def backward(lower, b):
    n = lower.shape[0]
    x = [None] * n
    for i in reversed(range(n)):
        x[i] = (b[i] - sum(lower[k, i] * x[k] for k in range(i + 1, n))) / lower[i, i]
    return ca.vertcat(*x)


def gram_schmidt(rows):
    """Rows = R Q_t with R lower triangular."""
    m = len(rows)
    r, q_t = ca.SX(m, m), []
    for k, row in enumerate(rows):
        for i, unit in enumerate(q_t):
            r[k, i] = ca.dot(row, unit)
            row = row - unit * r[k, i]
        r[k, k] = ca.sqrt(ca.dot(row, row))
        q_t.append(row / r[k, k])
    return r, ca.horzcat(*q_t).T


def main():
    out = pathlib.Path(sys.argv[1])
    arm = json.loads((GOLDEN / "arm.json").read_text())
    cases = json.loads((GOLDEN / "laws.json").read_text())["cases"]
    numbers = [*arm["gravity"], arm["base_height"], arm["flange"]]
    for link in arm["links"]:
        numbers += [link["alpha"], link["a"], link["d"], link["mass"], *link["com"]]
        numbers += [*link["inertia"], link["torque_limit"]]
    (out / "arm.txt").write_text("\n".join(repr(float(number)) for number in numbers))
    for job, (name, levels) in JOBS.items():
        lines = []
        for case in cases:
            state = case["input"]
            law = state["controller"] == "hierarchical" and "observer" in state
            if case["name"] == name and law:
                row = np.concatenate([flat(state), case["expected"]["torque"]])
                lines.append(" ".join(repr(float(number)) for number in row))
        (out / f"{job}.txt").write_text("\n".join(lines) + "\n")

        total = sum(size(shape) for _, shape in layout(levels))
        inputs, value, start = ca.SX.sym("inputs", total), {}, 0
        for key, shape in layout(levels):
            part = inputs[start : start + size(shape)]
            value[key] = ca.reshape(part, *shape) if isinstance(shape, tuple) else part
            start += size(shape)
        outputs = ca.cse(ca.vertcat(*step(arm, levels, value)))
        function = ca.Function("generated", [inputs], [ca.densify(outputs)])
        print(f"{job}: {function.n_instructions()} operations, {len(lines)} states")
        code = ca.CodeGenerator(job.replace("-", "_"))
        code.add(function)
        code.generate(f"{out}/")


if __name__ == "__main__":
    main()
