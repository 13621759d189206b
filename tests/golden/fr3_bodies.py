"""Bodies of a true FR3 for the realistic plant: as far from the maker's table as the identified
Panda is from the closed form of the Panda.

    pip install numpy scipy
    python fr3_bodies.py               # prints what arms/src/fr3.rs has

Single bodies are not identifiable, M and g are; FR3 and Panda have the same geometry. Wanted are
bodies of the FR3 whose M' has, at every posture, the relative error of the Panda,

    L^-1 M' L^-T = E = Lc^-1 Mi Lc^-T,   M = L L^T, closed form Mc = Lc Lc^T, identified Mi,

and whose g' differs from g by as much as gi from gc. The search is over Cholesky factors of
pseudo-inertias, which every possible body has and no other; what M and g leave open stays near
the table.
"""

import json
import pathlib

import numpy as np
from scipy.optimize import least_squares

HERE = pathlib.Path(__file__).resolve().parent
DOF = 7
SEED = 20240229
POSTURES = 40
# Weights: relative error of M, its error over the norm of M, g [1/Nm], distance from the table.
RELATIVE, NORM, GRAVITY, TABLE = 0.3, 30.0, 5.0, 0.02
UPPER = [(i, j) for i in range(DOF) for j in range(i, DOF)]
LOWER = np.tril_indices(4)
QUARTERS = [(1, 0), (0, 1), (-1, 0), (0, -1)]


def pseudo_inertia(link):
    """Integral of (x, 1)(x, 1)^T over the body."""
    mass, com = link["mass"], np.array(link["com"])
    xx, xy, xz, yy, yz, zz = link["inertia"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    full = np.empty((4, 4))
    full[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia + mass * np.outer(com, com)
    full[:3, 3] = full[3, :3] = mass * com
    full[3, 3] = mass
    return full


def body(full):
    mass = full[3, 3]
    com = full[:3, 3] / mass
    second = full[:3, :3] - mass * np.outer(com, com)
    inertia = np.trace(second) * np.eye(3) - second
    return mass, com, inertia[np.triu_indices(3)]


def maps(table, q):
    """M (upper triangle) and g as linear maps of the pseudo-inertias."""
    frame = np.eye(4)
    frame[:3, :3] = np.array(table["base"]["rotation"], float).reshape(3, 3)
    frame[:3, 3] = table["base"]["xyz"]
    gravity = np.array(table["gravity"], float)
    axes, origins = [], []
    of_m, of_g = np.zeros((len(UPPER), DOF, 4, 4)), np.zeros((DOF, DOF, 4, 4))
    for k in range(DOF):
        axes.append(frame[:3, 2])
        origins.append(frame[:3, 3])
        turn = q[k] + table["offset_quarters"][k] * np.pi / 2
        c, s = np.cos(turn), np.sin(turn)
        ca, sa = QUARTERS[table["alpha_quarters"][k] % 4]
        a, d = table["a"][k], table["d"][k]
        frame = frame @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
        # Velocity of the point x of link k per speed of joint j: rate[j] (x, 1).
        rate = np.zeros((DOF, 3, 4))
        for j in range(k + 1):
            rate[j, :, :3] = np.cross(axes[j], frame[:3, :3], axisb=0, axisc=0)
            rate[j, :, 3] = np.cross(axes[j], frame[:3, 3] - origins[j])
            of_g[j, k, :, 3] = -gravity @ rate[j]
        for n, (i, j) in enumerate(UPPER):
            of_m[n, k] = rate[i].T @ rate[j]
    return of_m.reshape(len(UPPER), -1), of_g.reshape(DOF, -1)


def symmetric(values):
    full = np.zeros((DOF, DOF))
    for value, (i, j) in zip(values, UPPER):
        full[i, j] = full[j, i] = value
    return full


def to_factors(full):
    factor = np.linalg.cholesky(full)
    factor[np.diag_indices(4)] = np.log(np.diag(factor))
    return factor[LOWER]


def from_factors(values):
    factor = np.zeros((4, 4))
    factor[LOWER] = values
    factor[np.diag_indices(4)] = np.exp(np.diag(factor))
    return factor @ factor.T


def main():
    tables = {table["name"]: table for table in json.load(open(HERE / "arm_tables.json"))}
    fr3 = tables["fr3"]
    of = {
        name: np.array([pseudo_inertia(link) for link in tables[name]["links"]])
        for name in ("panda", "panda_identified", "fr3")
    }
    rng = np.random.default_rng(SEED)
    low, high = np.array(fr3["q_min"]), np.array(fr3["q_max"])
    wanted = []
    for q in low + (high - low) * rng.random((POSTURES, DOF)):
        of_m, of_g = maps(fr3, q)
        closed, identified, own = (
            (symmetric(of_m @ bodies.ravel()), of_g @ bodies.ravel())
            for bodies in (of["panda"], of["panda_identified"], of["fr3"])
        )
        lower = np.linalg.inv(np.linalg.cholesky(closed[0]))
        root = np.linalg.cholesky(own[0])
        relative = lower @ identified[0] @ lower.T
        gravity = own[1] + identified[1] - closed[1]
        wanted.append((of_m, of_g, np.linalg.inv(root), relative, root @ relative @ root.T, np.linalg.norm(own[0]), gravity))

    start = np.concatenate([to_factors(full) for full in of["fr3"]])
    on_diagonal = np.eye(4)[LOWER] > 0
    scale = np.concatenate(
        [np.where(on_diagonal, 1.0, np.sqrt(np.trace(full[:3, :3])) + 0.05) for full in of["fr3"]]
    )
    triangle = np.tril_indices(DOF)

    def residuals(values):
        bodies = np.concatenate([from_factors(part).ravel() for part in values.reshape(DOF, -1)])
        rest = [TABLE * np.sqrt(POSTURES) * (values - start) / scale]
        for of_m, of_g, whiten, relative, target, norm, gravity in wanted:
            mass = symmetric(of_m @ bodies)
            rest.append(RELATIVE * (whiten @ mass @ whiten.T - relative)[triangle])
            rest.append(NORM * ((mass - target) / norm)[triangle])
            rest.append(GRAVITY * (of_g @ bodies - gravity))
        return np.concatenate(rest)

    found = least_squares(residuals, start, max_nfev=40).x
    for part in found.reshape(DOF, -1):
        mass, com, inertia = body(from_factors(part))
        print(f"mass: {mass:.7f}, com: {[round(float(x), 7) for x in com]}, inertia: {[float(f'{x:.8g}') for x in inertia]}")


if __name__ == "__main__":
    main()
