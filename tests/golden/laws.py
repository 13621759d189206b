"""Golden data of the control laws: the paper's formulas on Pinocchio's terms.

    pip install pin numpy
    python laws.py                # writes laws.json beside this file

Every case is a state as `hil-sim explain` reads it and what must come out. The
formulas are the explicit ones, with projectors and inverses, one level after
the other; nothing here factors the stacked tasks.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

from generate import DOF, POINTS, build, column, frame_jacobian, jacobian_derivative, mass_matrix

HERE = pathlib.Path(__file__).resolve().parent
SEED = 20181030
AXES = "xyz"

# Levels of the cases: points and axes, two and three levels and other splits.
LEVELS = {
    "two levels": [("flange", "xyz")],
    "three levels": [("flange", "xyz"), ("wrist", "xy")],
    # Positions resolve six rows: the last joint moves no point of its axis.
    "six rows": [("flange", "xyz"), ("elbow", "x"), ("wrist", "yz")],
    "orientation": [("flange", "xyz"), ("flange", "about yz")],
    "single rows": [("wrist", "z"), ("flange", "y"), ("elbow", "x"), ("forearm", "z")],
}
CONTROLLERS = [
    "hierarchical",
    "no-observer",
    "literal",
    "as-printed",
    "acceleration-level",
    "acceleration-level-estimate",
]
CASES_EACH = 4
STEP = 1e-3  # s, for derivatives along the motion; errors are of order STEP^4


def null_basis(rows):
    """Orthonormal rows that span the null space of `rows`."""
    _, _, vt = np.linalg.svd(rows, full_matrices=True)
    return vt[rows.shape[0] :]


def terms(model, data, arm, state):
    """M, C, g and the rows of every level."""
    q, dq = np.array(state["q"]), np.array(state["dq"])
    m = mass_matrix(model, data, q)
    c = pin.computeCoriolisMatrix(model, data, q, dq).copy()
    g = pin.computeGeneralizedGravity(model, data, q).copy()
    levels = []
    for level in state["levels"]:
        frame = model.getFrameId(level["point"])
        axes = [AXES.index(axis) for axis in level["axes"]]
        turns = level.get("task") == "orientation"
        pick = [3 + axis for axis in axes] if turns else axes
        jacobian = frame_jacobian(model, data, q, frame)[pick]
        derivative = jacobian_derivative(model, data, q, dq, frame)[pick]
        desired = {key: np.array(level[key]) for key in ("x", "dx", "ddx", "kp", "kd")}
        if turns:
            x, error = orientation_error(desired["x"], data.oMf[frame].rotation)
            error = error[axes]
        else:
            x = data.oMf[frame].translation.copy()[pick]
            error = desired["x"] - x
        command = (
            desired["ddx"]
            + desired["kd"] * (desired["dx"] - jacobian @ dq)
            + desired["kp"] * error
        )
        levels.append({"x": x, "j": jacobian, "jdot": derivative, "command": command})
    return m, c, g, levels


def orientation_error(desired, rotation):
    """The actual quaternion (w, x, y, z) and 2 sin(theta / 2) times the axis of
    the shortest rotation from it to the desired one."""
    x, y, z, w = pin.Quaternion(rotation).coeffs()
    wd, xd, yd, zd = desired / np.linalg.norm(desired)
    turn = pin.Quaternion(wd, xd, yd, zd).toRotationMatrix() @ rotation.T
    angle_axis = pin.log3(turn)
    angle = np.linalg.norm(angle_axis)
    return np.array([w, x, y, z]), 2.0 * np.sin(angle / 2.0) * angle_axis / angle


def projected(m, levels):
    """Jbar_i, Jbar_i^# and Lambda_i (17)-(21): J_i cut to what the levels above
    leave free, weighted by the inertia."""
    above = np.zeros((0, DOF))
    for level in levels:
        z = null_basis(above) if len(above) else np.eye(DOF)
        free = z.T @ np.linalg.inv(z @ m @ z.T) @ z @ m
        jbar = level["j"] @ free
        lam = np.linalg.inv(jbar @ np.linalg.inv(m) @ jbar.T)
        level.update(jbar=jbar, lam=lam, pinv=np.linalg.inv(m) @ jbar.T @ lam)
        above = np.vstack([above, level["j"]])
    return above


def observer_step(step, momentum):
    """Exact discrete form of (30)."""
    h, gain = step["h"], np.array(step["gain"])
    rate = (momentum - np.array(step["momentum_prev"])) / h - np.array(step["input_prev"])
    decay = np.exp(-gain * h)
    return decay * np.array(step["residual_prev"]) + (1.0 - decay) * rate


def jbar_rates(model, data, arm, state):
    """dJbar_i/dt of every level, by differences along the motion."""

    def jbars(shift):
        moved = dict(state, q=np.array(state["q"]) + shift * np.array(state["dq"]))
        m, _, _, levels = terms(model, data, arm, moved)
        projected(m, levels)
        return [level["jbar"] for level in levels]

    ahead, behind, far_ahead, far_behind = (jbars(k * STEP) for k in (1, -1, 2, -2))
    return [
        (8.0 * (a - b) - (fa - fb)) / (12.0 * STEP)
        for a, b, fa, fb in zip(ahead, behind, far_ahead, far_behind)
    ]


def hierarchical(m, c, g, levels, state, residual, rates=None, stiffness_sign=1.0):
    """(34) on joint level: exact, or as printed where dJbar_i/dt are given."""
    dq, space = np.array(state["dq"]), state["null_space"]
    minv = np.linalg.inv(m)
    stack = projected(m, levels)
    derivative = np.vstack([level["jdot"] for level in levels])
    ddq, w, free = np.zeros(DOF), np.zeros(DOF), np.eye(DOF)
    compensation = np.zeros(DOF)
    for number, level in enumerate(levels):
        if rates is None:
            wanted = level["command"] - level["jdot"] @ dq
            ddq = ddq + level["pinv"] @ (wanted - level["j"] @ ddq)
        else:
            ddq = ddq + level["pinv"] @ (level["command"] - rates[number] @ dq)
        w = w + level["pinv"] @ level["jbar"] @ dq
        free = free - level["pinv"] @ level["jbar"]
        compensation -= level["jbar"].T @ level["lam"] @ level["jbar"] @ minv @ residual
    momentum = np.linalg.inv(stack @ minv @ stack.T) @ stack @ dq
    force = (
        -c @ dq
        - c.T @ w
        + derivative.T @ momentum
        + stiffness_sign
        * np.array(space["stiffness"])
        * (np.array(space["q_d"]) - np.array(state["q"]))
        - np.array(space["damping"]) * (dq - w)
    )
    return m @ ddq + compensation + free.T @ force + c @ dq + g, compensation, free


def projector_rate(model, data, arm, state):
    """dP/dt of the stack of all levels, P = 1 - J^# J, by differences along the motion."""

    def projector(shift):
        moved = dict(state, q=np.array(state["q"]) + shift * np.array(state["dq"]))
        _, _, _, levels = terms(model, data, arm, moved)
        stack = np.vstack([level["j"] for level in levels])
        return np.eye(DOF) - np.linalg.pinv(stack) @ stack

    ahead, behind, far_ahead, far_behind = (projector(k * STEP) for k in (1, -1, 2, -2))
    return (8.0 * (ahead - behind) - (far_ahead - far_behind)) / (12.0 * STEP)


def acceleration_level(m, c, g, levels, state, rate):
    """(7)-(9), (12)-(14): Moore-Penrose inverses, level by level; `rate` is dP/dt of
    (13), dq_d = 0."""
    dq = np.array(state["dq"])
    ddq, free = np.zeros(DOF), np.eye(DOF)
    for level in levels:
        inverse = np.linalg.pinv(level["j"] @ free)
        ddq = ddq + inverse @ (level["command"] - level["jdot"] @ dq - level["j"] @ ddq)
        free = free - inverse @ (level["j"] @ free)
    ddq = ddq - free @ (np.array(state["null_space"]["rate_gain"]) * dq + rate @ dq)
    return m @ ddq + c @ dq + g


def expected(model, data, arm, state):
    m, c, g, levels = terms(model, data, arm, state)
    dq = np.array(state["dq"])
    residual = np.array(state["residual"])
    if "observer" in state:
        residual = observer_step(state["observer"], m @ dq)
    law = state["controller"]
    printed = law in ("literal", "as-printed")
    torque, compensation, free = hierarchical(
        m,
        c,
        g,
        levels,
        state,
        np.zeros(DOF) if law == "no-observer" else residual,
        jbar_rates(model, data, arm, state) if printed else None,
        -1.0 if law == "as-printed" else 1.0,
    )
    if law.startswith("acceleration-level"):
        compensation = -residual if law.endswith("estimate") else np.zeros(DOF)
        rate = projector_rate(model, data, arm, state)
        torque = acceleration_level(m, c, g, levels, state, rate) + compensation
    limit = column(arm, "torque_limit")
    return {
        "mass_matrix": m,
        "coriolis_matrix": c,
        "coriolis": c @ dq,
        "gravity": g,
        "levels": [
            {
                "x": level["x"],
                "jacobian": level["j"],
                "jacobian_dot": level["jdot"],
                "jacobian_dot_dq": level["jdot"] @ dq,
                "jbar": level["jbar"],
                "jbar_pinv": level["pinv"],
                "lambda": level["lam"],
                "command": level["command"],
            }
            for level in levels
        ],
        "null_space": {"projector": free},
        "residual": residual,
        "residual_compensation": compensation,
        "torque_demand": torque,
        "torque": np.clip(torque, -limit, limit),
    }


def random_state(arm, rng, levels, controller, with_observer):
    q = rng.uniform(-1, 1, DOF) * column(arm, "position_limit")
    dq = rng.uniform(-0.5, 0.5, DOF) * column(arm, "speed_limit")
    signed = lambda n, scale: rng.uniform(-scale, scale, n)
    rows = lambda axes: len(axes.removeprefix("about "))
    state = {
        "robot": "lwr_iv",
        "q": q,
        "dq": dq,
        "residual": signed(DOF, 10.0),
        "levels": [
            {
                "task": "orientation" if axes.startswith("about ") else "position",
                "point": point,
                "axes": axes.removeprefix("about "),
                "x": signed(4, 0.5) + [1.0, 0.0, 0.0, 0.0]
                if axes.startswith("about ")
                else signed(len(axes), 0.5),
                "dx": signed(rows(axes), 0.5),
                "ddx": signed(rows(axes), 2.0),
                "kp": rng.uniform(10, 400, rows(axes)),
                "kd": rng.uniform(1, 40, rows(axes)),
            }
            for point, axes in levels
        ],
        "null_space": {
            "q_d": q + signed(DOF, 0.3),
            "stiffness": rng.uniform(1, 40, DOF),
            "damping": rng.uniform(0.01, 5, DOF),
            "rate_gain": rng.uniform(1, 20, DOF),
        },
        "controller": controller,
    }
    if with_observer:
        state["observer"] = {
            "momentum_prev": signed(DOF, 1.0),
            "input_prev": signed(DOF, 50.0),
            "residual_prev": signed(DOF, 10.0),
            "gain": rng.uniform(20, 200, DOF),
            "h": 0.002,
        }
    return state


def plain(value):
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [plain(entry) for entry in value]
    return value.tolist() if isinstance(value, np.ndarray) else value


def main():
    arm = json.loads((HERE / "arm.json").read_text())
    model = build(arm)
    data = model.createData()
    rng = np.random.default_rng(SEED)
    cases = []
    for name, levels in LEVELS.items():
        for controller in CONTROLLERS:
            accepted = 0
            while accepted < CASES_EACH:
                state = plain(random_state(arm, rng, levels, controller, accepted % 2 == 1))
                out = expected(model, data, arm, state)
                # Explicit inverses lose as many digits as the levels' inertias
                # are badly conditioned: such states cannot be judged by them.
                worst = max(np.linalg.cond(level["lambda"]) for level in out["levels"])
                largest = max(np.abs(level["lambda"]).max() for level in out["levels"])
                if worst < 1e3 and largest < 1e3:
                    cases.append({"name": name, "input": state, "expected": plain(out)})
                    accepted += 1
    text = json.dumps({"cases": cases}, separators=(",", ":"))
    (HERE / "laws.json").write_text(text.replace('{"name"', '\n{"name"') + "\n")
    print(f"{len(cases)} cases")


if __name__ == "__main__":
    main()
