#!/usr/bin/env bash
# Builds libstratum.a, which exports stratum_... and nothing else, and puts it under a prefix
# with its header, and with what pkg-config and CMake want of it. The prefix may be moved
# afterwards.
#   controller-capi/install.sh PREFIX [--target TRIPLE] [--single]
set -euo pipefail

usage() { echo "usage: controller-capi/install.sh PREFIX [--target TRIPLE] [--single]" >&2; exit 2; }
prefix= target= features=panic-handler options=() precision=f64
while [ $# -gt 0 ]; do
  case $1 in
    --single) precision=f32; features+=,single ;;
    --target) [ $# -gt 1 ] || usage; target=$2; options+=(--target "$2"); shift ;;
    -*) usage ;;
    *) [ -z "$prefix" ] || usage; prefix=$1 ;;
  esac
  shift
done
[ -n "$prefix" ] || usage
mkdir -p "$prefix"
prefix=$(cd "$prefix" && pwd)

cd "$(dirname "$0")/.."
cargo rustc -p controller-capi --lib --crate-type staticlib --release --quiet \
  --features "$features" "${options[@]}"
version=$(cargo pkgid -p controller-capi)
version=${version##*[#@]}
cfg=$(rustc --print cfg ${target:+--target "$target"})
pointer_bits=$(sed -n 's/^target_pointer_width="\(.*\)"$/\1/p' <<< "$cfg")
# On a system Rust's library calls these; on bare metal there is nothing to call.
libraries="-lpthread -ldl -lm"
if grep -qx 'target_os="none"' <<< "$cfg"; then libraries=; fi

# place TEMPLATE DIRECTORY
place() {
  mkdir -p "$2"
  sed -e "s,@VERSION@,$version,g" -e "s,@PRECISION@,$precision,g" \
    -e "s,@TARGET@,${target:-$(rustc --print host-tuple)},g" \
    -e "s,@POINTER_BYTES@,$((pointer_bits / 8)),g" -e "s,@LIBRARIES@,$libraries,g" -e 's/ *$//' \
    "controller-capi/package/$1.in" > "$2/$1"
}
place stratum.pc "$prefix/lib/pkgconfig"
place stratum-config.cmake "$prefix/lib/cmake/stratum"
place stratum-config-version.cmake "$prefix/lib/cmake/stratum"
mkdir -p "$prefix/include"
cp controller-capi/include/stratum.h "$prefix/include/"
# Wherever cargo is told to build.
built=$(cargo metadata --format-version 1 --no-deps | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p')
controller-capi/isolate.sh "$built/${target:+$target/}release/libstratum.a" \
  "$prefix/lib/libstratum.a" 'stratum_*'
echo "stratum $version, $precision, in $prefix"
