#!/usr/bin/env bash
# Both programs against each other through the Franka Control Interface, in lock-step: the two-level
# motion of the FR3 is, byte by byte, the one in one process, also on a link that loses 3 % each way
# it ends in good order, and 20 commands lost in a row are exit code 3.
#
#     tests/peers/fci/pair.sh [FOLDER]    # files go there; target/pair-fci if not given
set -euo pipefail
cd "$(dirname "$0")/../../.."
target="${CARGO_TARGET_DIR:-$PWD/target}"
work="${1:-$target/pair-fci}"
rm -rf "$work"
mkdir -p "$work"
cargo build --quiet --release -p hil-sim -p firmware-host
robot=
trap '[ -z "$robot" ] || kill "$robot" 2> /dev/null || true' EXIT

# pair NAME ADDRESS CODE ROBOT'S CONTROLLER'S: both with these options; the controller's exit code
# must be this.
pair() {
  local name=$1 address=$2 expected=$3 code=0
  # shellcheck disable=SC2086 # options are several words
  "$target/release/hil-sim" serve two-level-fr3 --robot fci --lockstep --address "$address" \
    --out "$work/$name" $4 > "$work/$name.robot" 2>&1 < /dev/null &
  robot=$!
  for _ in $(seq 100); do
    grep -q "listening on" "$work/$name.robot" && break
    sleep 0.1
  done
  # shellcheck disable=SC2086
  "$target/release/firmware-host" run two-level-fr3 --robot fci --address "$address" \
    --summary "$work/$name.json" --flight-record "$work/$name.csv" $5 \
    > "$work/$name.controller" 2>&1 < /dev/null || code=$?
  wait "$robot" || true
  robot=
  if [ "$code" != "$expected" ]; then
    cat "$work/$name.robot" "$work/$name.controller" >&2
    echo "$name: exit code $code, expected $expected" >&2
    return 1
  fi
  grep "^FCI version" "$work/$name.robot" | sed "s/^/$name: /"
}

"$target/release/hil-sim" run two-level-fr3 --measurement link --out "$work/here" > /dev/null
pair sound 127.0.0.61 0 "" ""
cmp "$work/here/trace.csv" "$work/sound/trace.csv"
pair lossy 127.0.0.62 0 "--fault both:drop=0.03" ""
pair broken 127.0.0.63 3 "--fault to-robot:drop=1@4-4.02" ""
pair recovered 127.0.0.64 3 "--fault to-robot:drop=1@4-4.02" "--recover"
grep -q '"recovery": "success"' "$work/recovered.json"
echo "both programs by the FCI: the same bytes as in one process"
