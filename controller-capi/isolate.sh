#!/usr/bin/env bash
# Of a static library made by cargo, one that defines the named symbols and no others for the
# program around it: its memcpy, its sine, its panic handler, its copy of Rust's library serve
# itself alone. For ELF, by the linker and objcopy that come with Rust.
#   controller-capi/isolate.sh LIBRARY ISOLATED PATTERN...   such as 'stratum_*'
set -euo pipefail

[ $# -ge 3 ] || { echo "usage: controller-capi/isolate.sh LIBRARY ISOLATED PATTERN..." >&2; exit 2; }
library=$1 isolated=$2
shift 2
[ -f "$library" ] || { echo "isolate.sh: no file $library" >&2; exit 2; }

tools=$(rustc --print sysroot)/lib/rustlib/$(rustc --print host-tuple)/bin
for tool in rust-lld rust-objcopy; do
  [ -x "$tools/$tool" ] ||
    { echo "isolate.sh: no $tool in $tools; rustup's toolchains have it" >&2; exit 1; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# One object of all that the named functions need. Its sections stay apart, so that
# --gc-sections of the program still drops what it does not call. Groups are dissolved: of two
# groups with one name the program would keep one, and cut the references of the other.
"$tools/rust-lld" -flavor gnu -r --force-group-allocation "${@/#/--undefined-glob=}" \
  "$library" -o "$work/whole.o"
# Rust's library has bitcode beside its code; joined, it would be none.
"$tools/rust-objcopy" --remove-section=.llvmbc --remove-section=.llvmcmd \
  --wildcard "${@/#/--keep-global-symbol=}" "$work/whole.o" "$work/stratum.o"
mkdir -p "$(dirname "$isolated")"
rm -f "$isolated"
ar crs "$isolated" "$work/stratum.o"
