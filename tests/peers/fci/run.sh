#!/usr/bin/env bash
# Clients of others, as their registries have them, against the robot's end of the crate `fci`:
# fields and errors of the state by name, requests, motions and how they end. Then both ends of it.
#
#     tests/peers/fci/run.sh        # the vendor's: pylibfranka (version 10), panda-python (5)
#     tests/peers/fci/run.sh all    # and franka-rs (both), two minutes more to build; and the other
#                                   # way round the simulator franky-sim (10) against the client's end
#
# Needs python3 with venv and PyPI once, 150 MB on the disk, 1 GB for all; a minute. What cannot
# be had is SKIPPED, with the reason.
set -euo pipefail
cd "$(dirname "$0")"
here=$PWD
target="${CARGO_TARGET_DIR:-$here/../../../target}"
work="$target/peers-fci"
mkdir -p "$work"

case "$*" in
  "" | all) ;;
  *) echo "arguments: '$*'; allowed: nothing, or all" >&2; exit 2 ;;
esac

cargo build --quiet --manifest-path "$here/../../../Cargo.toml" -p fci --examples
robot="$target/debug/examples/robot"

skipped() { echo "SKIPPED clients of the FCI: $*"; }

# client PACKAGE MODULE VERSION ADDRESS: the port is always 1337, addresses are free.
client() {
  "$work/venv/bin/pip" install --quiet "$1" > "$work/log" 2>&1 ||
    { skipped "$1 could not be installed from PyPI"; return; }
  "$work/venv/bin/python" -c "import $2" > "$work/log" 2>&1 ||
    { skipped "$1 cannot be loaded here: $(tail -n 1 "$work/log")"; return; }
  timeout 120 "$work/venv/bin/python" "$here/clients.py" "$robot" "$2" "$3" "$4"
}

if ! command -v python3 > /dev/null; then
  skipped "no python3"
elif [ ! -x "$work/venv/bin/python" ] && ! python3 -m venv "$work/venv" 2> "$work/log"; then
  rm -rf "$work/venv"
  skipped "no venv of python3"
else
  client pylibfranka==0.21.3 pylibfranka 10 127.0.0.41
  client panda-python==1.1.1 panda_py.libfranka 5 127.0.0.42
fi

# Both ends of the crate, in every version: those that no client of others has, too.
for version in 5 6 7 8 9 10; do
  address="127.0.1.$version:1337" log="$work/robot-$version"
  "$robot" "$address" "$version" 1 > "$log" &
  process=$!
  for _ in $(seq 100); do
    grep -q shown "$log" && break
    sleep 0.1
  done
  echo "both ends of the crate"
  timeout 60 "$target/debug/examples/client" "$address" "$version"
  wait $process
  grep -q "^motion .* 0 lost: success" "$log"
done

if [ "$*" = all ]; then
  manifest=(--manifest-path "$here/franka-rs/Cargo.toml")
  if cargo fetch --quiet "${manifest[@]}"; then
    cargo build --quiet "${manifest[@]}" --target-dir "$work/franka-rs"
    for version in 10 5; do
      timeout 120 "$work/franka-rs/debug/fci-franka-rs" "$robot" "$version" 127.0.0.43
    done
  else
    skipped "franka-rs could not be had from crates.io"
  fi

  # In a venv of its own: it brings versions of what others bring.
  simulator="$work/simulator" address=127.0.0.44
  if [ -x "$simulator/bin/python" ] || python3 -m venv "$simulator" 2> "$work/log" &&
    "$simulator/bin/pip" install --quiet franky-sim==1.0.4 > "$work/log" 2>&1; then
    "$simulator/bin/franky-sim" --simulator mujoco --hostname "$address" > "$work/log" 2>&1 &
    process=$!
    trap 'kill $process' EXIT
    for _ in $(seq 60); do
      grep -q "Connect to the server" "$work/log" && break
      sleep 1
    done
    echo "franky-sim, version 10"
    timeout 60 "$target/debug/examples/client" "$address:1337" 10
  else
    skipped "franky-sim could not be installed from PyPI"
  fi
fi
