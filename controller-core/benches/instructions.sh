#!/usr/bin/env bash
# Instructions of a control cycle on the host, counted by callgrind: whole cycles in
# 2,000 random and 240 adversarial states, those of the FR3 in a tenth of them, cycles in which
# the references of all levels and the posture jump ("joining") in 16, those of 7, 9 and 12 rows
# ("rows", and "changing" where all levels come or go) in 16, then each stage alone in
# 16, then cycles of the velocity-level resolver in the former; at last codec and session of each
# robot link ("link"). Compares the largest counts with
# instructions.txt beside this script; --update rewrites that file.
#
#   controller-core/benches/instructions.sh [--update|--quick|--arms|--link]
#
# --quick takes 20 states and compares nothing; --arms shows the cycles of every arm of the
# crate arms in 23; --link counts and compares codecs and sessions only. Valgrind 3.19 does not know one
# encoding of vmovq between registers (C5 79 D6); should the compiler come to use it,
# the run ends with an illegal instruction, and a newer Valgrind is needed.
#
# The counts are those of the machine code, so they belong to one compiler: a new one
# may move them. It fails where
# - a cycle or a stage is more than 2 % above the committed figure,
# - a cycle is above its limit below, whatever is committed,
# - a cycle of the FR3, whose links have lengths a, is more than 4 % above that of the LWR,
# - the counts of a cycle differ by 0.5 % or more between the states of a path, by 3 % or more where
#   directions get lost: of which levels, and whether one is stuck, is within the path.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Most instructions of a cycle.
limit() {
  case "$1" in
    idle) echo 14100 ;;
    step) echo 23500 ;;
  esac
}

mode="${1:-}"
committed=controller-core/benches/instructions.txt
target="${CARGO_TARGET_DIR:-target}/count"
export RUSTFLAGS="-C target-cpu=x86-64-v3"
[ "$mode" = --link ] ||
  cargo build --quiet --release -p controller-core --example count_step --target-dir "$target"
cargo build --quiet --release -p bridge --example count_link --target-dir "$target"

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# One part of the dump per call of the counted function of an example.
count() {
  local example="$1" what="$2" name="$3"
  valgrind --tool=callgrind --callgrind-out-file="$work/out" --combine-dumps=yes \
    --dump-line=no --toggle-collect="$example::$name" --dump-after="$example::$name" \
    "$target/release/examples/$example" "$what" > "$work/names" 2> "$work/log" || { cat "$work/log" >&2; exit 1; }
  awk '/^desc: Trigger: --dump-after/ { wanted = 1 } /^(totals|summary):/ && wanted { print $2; wanted = 0 }' \
    "$work/out" > "$work/counts"
  if [ "$(wc -l < "$work/names")" != "$(wc -l < "$work/counts")" ]; then
    echo "callgrind gave $(wc -l < "$work/counts") counts for $(wc -l < "$work/names") calls" >&2
    exit 1
  fi
  paste -d' ' "$work/names" "$work/counts"
  rm "$work/out"
}
link() {
  local name
  for name in measurement answer fri_session state command fci_session; do
    count count_link "$name" "calls::$name"
  done
}
case "$mode" in
  --arms) count count_step arms cases::stages::step ;;
  --link) link ;;
  *)
    count count_step "$([ "$mode" = --quick ] && echo quick || echo step)" cases::stages::step
    count count_step stages cases::stages::stage
    count count_step resolver cases::stages::resolve
    [ "$mode" = --quick ] || link
    ;;
esac > "$work/all"

awk '
  # A fault is another path, and none of the inputs should be one.
  $2 == "fault" { faults++; next }
  {
    add($1 " " $2)
    if ($2 ~ /^(idle|limited|released|bent|pivots)/) add($1 " step")
  }
  function add(key) {
    if (!(key in min)) { order[++n] = key; min[key] = max[key] = $3 }
    if ($3 < min[key]) min[key] = $3
    if ($3 > max[key]) max[key] = $3
    count[key]++
  }
  END {
    for (i = 1; i <= n; i++) {
      key = order[i]
      print key, max[key], min[key], count[key]
    }
    if (faults) print "faults", faults, faults, faults
  }' "$work/all" > "$work/table"

printf '%-30s %-15s %8s %8s %8s %7s\n' cycle stage max min 'spread %' inputs
failed=0
declare -A lwr
fails() { echo "  $*"; failed=1; }
while read -r case stage max min count; do
  if [ "$case" = faults ]; then
    fails "$stage inputs ended in a fault"
    continue
  fi
  spread=$(awk "BEGIN { printf \"%.2f\", 100 * ($max - $min) / $min }")
  printf '%-30s %-15s %8d %8d %8s %7d\n' "$case" "$stage" "$max" "$min" "$spread" "$count"
  allowed=
  [[ ! "$stage" =~ ^(idle|pivots|resolver) ]] || allowed=0.5
  [[ ! "$stage" =~ ^(limited|released|bent) ]] || allowed=3
  if [ -n "$allowed" ] && awk "BEGIN { exit !($spread >= $allowed) }"; then
    fails "$case $stage: spread $spread %, must be below $allowed %: the count depends on the data"
  fi
  most=$(limit "$stage")
  if [ -n "$most" ] && [ "$max" -gt "$most" ]; then
    fails "$case $stage: $max instructions, limit $most"
  fi
  if [ "$stage" = step ]; then
    levels=${case#"${case%%[23]-levels-*}"}
    [ "$case" != "$levels" ] || lwr[$levels]=$max
    if [[ $case = fr3-* ]] && [ $((100 * max)) -gt $((104 * lwr[$levels])) ]; then
      fails "$case step: $max instructions, LWR ${lwr[$levels]}; allowed +4 %"
    fi
  fi
  [ -z "$mode" ] || [ "$mode" = --link ] || continue
  before=$(awk -v case="$case" -v stage="$stage" '$1 == case && $2 == stage { print $3 }' "$committed")
  if [ -z "$before" ]; then
    fails "$case $stage: $max instructions, not in $committed"
  elif [ $((100 * max)) -gt $((102 * before)) ]; then
    fails "$case $stage: $max instructions, committed $before; allowed +2 %"
  fi
done < "$work/table"
if [ "$mode" = --update ]; then
  awk '$1 != "faults" { print $1, $2, $3 }' "$work/table" > "$committed"
fi
exit "$failed"
