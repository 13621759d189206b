#!/usr/bin/env bash
# Robots of others, as PyPI has them, against our controller's end: the two-level motion on a
# simulated FR3 through the Franka Control Interface, in wall-clock time.
#
#     tests/peers/fci/robots.sh [FOLDER]    # venvs go there; target/peers-fci if not given
#
# franky-sim 1.0.4 and franka-sim 1.1.7, the latter with its limits of motion and communication
# enforced. Each has a venv of its own: they bring versions of what others bring. The model of
# franka-sim is the one inside franky-sim, with its meshes. A run that the PC could not keep is tried
# again, twice at most; tries are counted. What cannot be had is SKIPPED, with the reason.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../../.. && pwd)
target="${CARGO_TARGET_DIR:-$root/target}"
work="${1:-$target/peers-fci}"
mkdir -p "$work"
work=$(cd "$work" && pwd)

cargo build --quiet --release --manifest-path "$root/Cargo.toml" -p firmware-host
program="$target/release/firmware-host"

skipped() { echo "SKIPPED robots of the FCI: $*"; }

server=
stop() {
  [ -z "$server" ] && return
  kill "$server" 2> /dev/null || true
  wait "$server" 2> /dev/null || true
  server=
}
trap stop EXIT

# venv NAME PACKAGE: installs it, or says why not.
venv() {
  if [ ! -x "$work/$1/bin/python" ] && ! python3 -m venv "$work/$1" > "$work/log" 2>&1; then
    rm -rf "${work:?}/$1"
    skipped "no venv of python3"
    return 1
  fi
  "$work/$1/bin/pip" install --quiet "$2" > "$work/log" 2>&1 && return
  skipped "$2 could not be installed from PyPI"
  return 1
}

# started LOG WORDS COMMAND...: the server, until it says these words.
started() {
  local log=$1 words=$2
  shift 2
  "$@" > "$log" 2>&1 &
  server=$!
  for _ in $(seq 120); do
    grep -q "$words" "$log" && return
    kill -0 "$server" 2> /dev/null || break
    sleep 0.5
  done
  tail -n 3 "$log" >&2
  return 1
}

# motion NAME ADDRESS WORDS COMMAND...: a server and the motion, up to three times.
motion() {
  local name=$1 address=$2 words=$3 try
  shift 3
  for try in 1 2 3; do
    if ! started "$work/$name.log" "$words" "$@"; then
      stop
      skipped "$name does not start here: $(tail -n 1 "$work/$name.log")"
      return
    fi
    if timeout 120 "$program" run two-level-fr3 --robot fci --address "$address" --wait 5 \
      --summary "$work/$name.json" --flight-record "$work/$name-flight.csv" \
      > "$work/$name.out" 2>&1; then
      stop
      python3 - "$work/$name.json" "$name" "$try" << 'END'
import json
import sys

path, name, tries = sys.argv[1:]
with open(path) as file:
    run = json.load(file)
level, fci = run["levels"][0], run["fci"]
if run["exit_code"] or fci["event"] != "finished" or not fci["urdf"]:
    sys.exit(f"{name}: {run['reason']}, URDF {fci['urdf']}")
print(
    f"{name}: {run['reason']}, version {fci['version']}, {run['answered']} commands, "
    f"rms {level['rms']:.3f} mm, max {level['max']:.3f} mm, {run['link']['lost']} states lost, "
    f"{fci['limited_cycles']} commands limited, tries {tries}"
)
END
      return
    fi
    stop
    echo "$name, try $try: $(grep -m 1 answers "$work/$name.out" || tail -n 1 "$work/$name.out")"
  done
  echo "$name: no motion without a reflex in three tries" >&2
  return 1
}

if ! command -v python3 > /dev/null; then
  skipped "no python3"
elif venv simulator franky-sim==1.0.4; then
  motion franky-sim 127.0.0.46 "Connect to the server" \
    "$work/simulator/bin/franky-sim" --simulator mujoco --hostname 127.0.0.46
  if venv franka-sim franka-sim==1.1.7; then
    assets=$("$work/simulator/bin/python" -c \
      'import franky_sim, pathlib; print(pathlib.Path(franky_sim.__file__).parent / "assets")')
    mkdir -p "$work/model"
    cp "$assets/fr3.xml" "$work/model/"
    ln -sfn "$assets/meshes" "$work/model/assets"
    # It takes port 1337 of every address: nothing else may serve there.
    FR3_MJCF="$work/model/fr3.xml" motion franka-sim 127.0.0.1 "Server ready" \
      "$work/franka-sim/bin/run-franka-sim-server" --no-gripper \
      --enforce-comm-constraints --enforce-motion-limits
  fi
fi
