#!/usr/bin/env bash
# Two arms of others from their URDFs, as PyPI's example-robot-data has them: imported, and M, C dq, g,
# the Jacobian and the pose of the flange held against Pinocchio on the same file.
#
#     tests/peers/urdf.sh
#
# Needs python3 with venv and PyPI once, 600 MB on the disk; a minute. Where it cannot have them it is SKIPPED,
# with the reason.
set -euo pipefail
cd "$(dirname "$0")"
here=$PWD
work="${CARGO_TARGET_DIR:-$here/../../target}/peers-urdf"
mkdir -p "$work"

pinocchio=4.1.0 data=6.0.0
skipped() { echo "SKIPPED imported arms against Pinocchio: $*"; exit 0; }
command -v python3 > /dev/null || skipped "no python3"
if [ ! -x "$work/venv/bin/python" ]; then
  python3 -m venv "$work/venv" 2> "$work/log" || { rm -rf "$work/venv"; skipped "no venv of python3"; }
fi
"$work/venv/bin/pip" install --quiet "pin==$pinocchio" > "$work/log" 2>&1 ||
  skipped "pin $pinocchio could not be installed from PyPI"
# The wheel alone: of its meshes nothing is needed, and nothing of what it depends on.
"$work/venv/bin/pip" download --quiet --no-deps --dest "$work" "example-robot-data==$data" > "$work/log" 2>&1 ||
  skipped "example-robot-data $data could not be had from PyPI"

cd "$here/../.."
cargo build --quiet -p hil-sim
program=${CARGO_TARGET_DIR:-$here/../../target}/debug/hil-sim
"$work/venv/bin/python" "$here/urdf.py" "$program" "$work"
