#!/usr/bin/env bash
# Instructions of whole programs of the simulator, counted by callgrind in the release build as
# everyone makes it: runs of the two-level experiment of 2 s on both plants without files, one
# with them, and all runs of the paper cut to half a second. Compares with instructions.json
# beside this script; --update rewrites that file.
#
#   hil-sim/benches/instructions.sh [--update] [--paper]
#
# --paper counts the whole of `hil-sim paper` besides, which takes five minutes; with --update
# alone its figure stays.
#
# It fails where a count is more than 2 % above the committed figure, or above its limit below,
# whatever is committed. The counts belong to one compiler: a new one may move them.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Most instructions, in millions.
limit() {
  case "$1" in
    run-ideal) echo 90 ;;
    paper) echo 112982 ;;
  esac
}

update=no paper=no
for option in "$@"; do
  case "$option" in
    --update) update=yes ;;
    --paper) paper=yes ;;
    *) echo "$option: unknown; allowed: --update, --paper" >&2; exit 2 ;;
  esac
done

committed="$PWD/hil-sim/benches/instructions.json"
target="${CARGO_TARGET_DIR:-$PWD/target}"
cargo build --quiet --release -p hil-sim --target-dir "$target" --bins --example count_paper

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"

# count NAME PROGRAM ARGUMENTS...
count() {
  local name="$1" total
  shift
  valgrind --tool=callgrind --callgrind-out-file="$work/out" "$@" > "$work/stdout" 2> "$work/log" ||
    { cat "$work/log" >&2; exit 1; }
  total=$(awk '/^(summary|totals):/ { print $2 }' "$work/out" | tail -n 1)
  echo "$name $total" >> "$work/counts"
}
simulator="$target/release/hil-sim"
run=("$simulator" run two-level --duration 2)
count run-ideal "${run[@]}" --plant ideal --out none
count run-realistic "${run[@]}" --out none
count run-with-files "${run[@]}" --out files
count paper-in-short "$target/release/examples/count_paper" 0.5
[ $paper = no ] || count paper "$simulator" paper --out paper

# Of the committed file: the figure of a name.
before() { sed -n "s/^ *\"$1\": \([0-9]*\),\{0,1\}$/\1/p" "$committed"; }

failed=0
fails() { echo "  $*"; failed=1; }
printf '%-16s %15s %15s\n' program instructions committed
while read -r name total; do
  was=$(before "$name")
  printf '%-16s %15d %15s\n' "$name" "$total" "${was:--}"
  most=$(limit "$name")
  if [ -n "$most" ] && [ "$total" -gt $((most * 1000000)) ]; then
    fails "$name: $total instructions, limit $most million"
  fi
  [ $update = no ] || continue
  if [ -z "$was" ]; then
    fails "$name: $total instructions, not in $committed"
  elif [ $((100 * total)) -gt $((102 * was)) ]; then
    fails "$name: $total instructions, committed $was; allowed +2 %"
  fi
done < "$work/counts"

if [ $update = yes ]; then
  if [ $paper = no ] && was=$(before paper) && [ -n "$was" ]; then
    echo "paper $was" >> "$work/counts"
  fi
  {
    printf '{\n  "rustc": "%s",\n' "$(rustc --version)"
    printf '  "valgrind": "%s",\n  "instructions": {\n' "$(valgrind --version)"
    sed 's/\(.*\) \(.*\)/    "\1": \2/; $!s/$/,/' "$work/counts"
    printf '  }\n}\n'
  } > "$work/json"
  mv "$work/json" "$committed"
fi
exit "$failed"
