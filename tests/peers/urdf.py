"""Arms of others, imported and laid open by hil-sim, against Pinocchio on the same files.

    python urdf.py HIL_SIM FOLDER      # a folder with the wheel of example-robot-data
"""

import json
import pathlib
import subprocess
import sys
import zipfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "golden"))
import urdf  # noqa: E402

# File, base, tip. Of the Panda the fingers stay at 0.
FILES = [("panda.urdf", "panda_link0", "panda_hand"), ("xarm7.urdf", "world", "link_eef")]
# As a share of the largest entry.
ALLOWED = 1e-9
DOF = 7


def run(program, *arguments, text=None):
    done = subprocess.run([program, *arguments], input=text, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(arguments)}: {done.stderr}{done.stdout}"
    return done.stdout


def level(task, coordinates):
    zero, one = [0.0] * 3, [1.0] * 3
    return {"task": task, "point": "flange", "axes": "xyz", "x": coordinates, "dx": zero, "ddx": zero, "kp": one, "kd": one}


def laid_open(program, arm, seen):
    """What hil-sim has for a state of Pinocchio's."""
    even = [1.0] * DOF
    state = {
        "robot": str(arm),
        "q": seen["q"],
        "dq": seen["dq"],
        "levels": [level("position", [0.3, 0.0, 0.5]), level("orientation", [1.0, 0.0, 0.0, 0.0])],
        "null_space": {"q_d": seen["q"], "stiffness": even, "damping": even},
    }
    out = json.loads(run(program, "explain", "-", text=json.dumps(state)))
    position, orientation = out["levels"]
    mass = np.array(out["mass_matrix"])
    return {
        "mass_matrix": mass[np.tril_indices(DOF)],
        "coriolis": out["coriolis"],
        "gravity": out["gravity"],
        "position": position["x"],
        "jacobian": np.array(position["jacobian"]).ravel(),
        "angular_jacobian": np.array(orientation["jacobian"]).ravel(),
    }


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    (wheel,) = folder.glob("example_robot_data-*.whl")
    worst = 0.0
    with zipfile.ZipFile(wheel) as archive:
        for name, base, tip in FILES:
            (member,) = [entry for entry in archive.namelist() if entry.endswith("/" + name)]
            path = folder / name
            path.write_bytes(archive.read(member))
            ends = ["--base", base, "--tip", tip]
            arm = path.with_suffix(".toml")
            arm.write_text(run(program, "model", "import", str(path), *ends))
            run(program, "model", "check", str(arm), "--against", str(path), *ends)
            rows = urdf.evaluate(path.read_text(), base, tip)
            most = {}
            for seen in rows:
                for key, ours in laid_open(program, arm, seen).items():
                    theirs = np.array(seen[key])
                    share = np.abs(np.array(ours) - theirs).max() / max(1.0, np.abs(theirs).max())
                    most[key] = max(most.get(key, 0.0), float(share))
            shown = ", ".join(f"{key} {share:.0e}" for key, share in most.items())
            print(f"{name}, {len(rows)} states: {shown}")
            worst = max(worst, *most.values())
    if not worst <= ALLOWED:
        sys.exit(f"largest difference {worst:.1e} of the largest entry; allowed: {ALLOWED:.0e}")


if __name__ == "__main__":
    main()
