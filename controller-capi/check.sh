#!/usr/bin/env bash
# Everything about the C interface. What lacks a tool is SKIPPED, with the reason.
#   controller-capi/check.sh          all checks
#   controller-capi/check.sh header   rewrites include/stratum.h
set -euo pipefail
cd "$(dirname "$0")/.."
crate=$PWD/controller-capi
target=thumbv7em-none-eabihf
build=${CARGO_TARGET_DIR:-$PWD/target}
out=$build/capi
mkdir -p "$out"

have() { command -v "$1" > /dev/null; }
step() { printf -- '-- %s\n' "$*"; }
skipped() { echo "SKIPPED $*"; }
fail() { echo "$*"; exit 1; }

# The generated text depends on the version.
cbindgen_version=0.29.4
cbindgen=
for candidate in cbindgen "$build/tools/bin/cbindgen"; do
  if [ "$("$candidate" --version 2>/dev/null)" = "cbindgen $cbindgen_version" ]; then
    cbindgen=$candidate
  fi
done
if [ -z "$cbindgen" ]; then
  step "installing cbindgen $cbindgen_version, once: takes minutes"
  if cargo install cbindgen --version "$cbindgen_version" --locked --quiet \
    --root "$build/tools" --target-dir "$build/tools/build"; then
    cbindgen=$build/tools/bin/cbindgen
  fi
fi
# header FILE: types and functions by cbindgen, names for numbers by the crate itself.
header() {
  "$cbindgen" controller-capi --quiet --config "$crate/cbindgen.toml" --output "$out/types.h"
  cargo run -p controller-capi --example numbers --quiet > "$out/numbers.h"
  grep -qx '/\* names for numbers \*/' "$out/types.h" || fail "cbindgen.toml has lost the marker"
  sed -e "\\,^/\* names for numbers \*/\$,{r $out/numbers.h" -e 'd}' "$out/types.h" > "$1"
}

if [ "${1:-}" = header ]; then
  [ -n "$cbindgen" ] || fail "cbindgen $cbindgen_version is not installed and could not be"
  header "$crate/include/stratum.h"
  exit
fi

step "header as generated"
if [ -n "$cbindgen" ]; then
  header "$out/stratum.h"
  diff -u "$crate/include/stratum.h" "$out/stratum.h" ||
    fail "include/stratum.h is not what the crate says: controller-capi/check.sh header"
else
  skipped "header: cbindgen $cbindgen_version is not installed and could not be"
fi

programs="bare_loop tool own_arm replay errors"
# On the target the stack that they need is measured as well.
target_programs="$programs stack"
task="rtos_task.c rtos_host.c robot_host.c board.c board_host.c"
# Of the target: a board without a C library.
board="board.c board_qemu.c freestanding.c"
flags="-std=c11 -Wall -Wextra -Wpedantic -Werror -O2 -I$crate/include"
m7="-ffreestanding -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard"
bare="-nostdlib -T qemu.ld -Wl,--gc-sections,-z,noexecstack,--fatal-warnings"
system="-lpthread -ldl -lm"
cd "$crate/examples/c"

# library PREFIX PRECISION [arguments of install.sh]: the library under a prefix that has moved.
library() {
  local precision=
  [ "$2" = f64 ] || precision=--single
  rm -rf "$1" "$1-before"
  # shellcheck disable=SC2086
  CARGO_TARGET_DIR=$build/capi-$2 "$crate/install.sh" "$1-before" $precision "${@:3}"
  mv "$1-before" "$1"
}

# exports_only_its_functions ARCHIVE NM: what the header declares, and no other symbol.
exports_only_its_functions() {
  "$2" --extern-only --defined-only --format=posix "$1" | awk 'NF > 1 { print $1 }' | sort > "$out/exported"
  sed -n 's/^[A-Za-z].*\b\(stratum_[a-z_]*\)(.*/\1/p' "$crate/include/stratum.h" | sort > "$out/declared"
  diff "$out/declared" "$out/exported" || fail "$1: the global symbols (>) are not the header's functions (<)"
  echo "exported: the $(wc -l < "$out/exported") functions of the header and nothing else"
}

# other_library OUT [arguments of rustc]: somebody else's library in Rust.
other_library() {
  rustc --edition 2024 --crate-type staticlib -O "${@:2}" "$crate/tests/link/other.rs" -o "$1"
}

# combined OUT [arguments of cargo]: the library of several crates.
combined() {
  local of=$build/capi-f64/release/libcombined.a
  [ $# = 1 ] || of=$build/capi-f64/$3/release/libcombined.a
  (cd "$crate/.." && cargo build -p combined --release --quiet --target-dir "$build/capi-f64" "${@:2}")
  "$crate/isolate.sh" "$of" "$1" 'stratum_*' low_pass
}

# on_target IMAGE: runs it on the emulated board.
on_target() {
  timeout 120 qemu-system-arm -M mps2-an500 -display none -serial null -monitor none \
    -semihosting-config enable=on,target=native -kernel "$1"
}

# expected PRECISION: the replay in Rust.
expected() {
  local features=
  [ "$1" = f64 ] || features="--features single"
  # shellcheck disable=SC2086
  (cd "$crate/.." && cargo run -p controller-capi --example replay --release --quiet \
    --target-dir "$build/capi-$1" $features)
}

for precision in f64 f32; do
  expected "$precision" > "$out/rust-$precision"
done
echo "replay in Rust: $(tail -n 1 "$out/rust-f64") (f64), $(tail -n 1 "$out/rust-f32") (f32)"

# same NAME PRECISION: what a C program printed against the replay in Rust.
same() {
  diff "$out/rust-$2" "$out/$1" || fail "$1: torques are not those of Rust"
  echo "$1: equal to Rust in every bit"
}

step "host: C programs, both precisions"
if have gcc; then
  for precision in f64 f32; do
    library "$out/prefix-$precision" "$precision"
    archive=$out/prefix-$precision/lib/libstratum.a
    exports_only_its_functions "$archive" nm
    for program in $programs; do
      # shellcheck disable=SC2086
      gcc $flags "$program.c" board.c board_host.c "$archive" $system -o "$out/$program-$precision"
    done
    "$out/bare_loop-$precision"
    "$out/tool-$precision"
    "$out/own_arm-$precision"
    "$out/errors-$precision" > "$out/errors.txt" || { cat "$out/errors.txt"; exit 1; }
    tail -n 1 "$out/errors.txt"
    "$out/replay-$precision" > "$out/host-$precision"
    same "host-$precision" "$precision"
    # shellcheck disable=SC2086
    gcc $flags -D_POSIX_C_SOURCE=200809L $task "$archive" $system \
      -o "$out/rtos_task-$precision"
    "$out/rtos_task-$precision"
  done
else
  skipped "C programs on the host: no gcc"
fi

step "host: the header in other dialects"
if have gcc; then
  # Sizes are held by assertions in the header.
  for dialect in "-std=c11 -fshort-enums" "-std=c17" "-std=c2x -fshort-enums"; do
    # shellcheck disable=SC2086
    gcc -fsyntax-only -x c $dialect -Wall -Wextra -Wpedantic -Wconversion -Werror \
      "$crate/include/stratum.h"
  done
else
  skipped "header in other dialects of C: no gcc"
fi
if have g++ && have gcc; then
  for dialect in c++11 c++20; do
    g++ -fsyntax-only -std=$dialect -Wall -Wextra -Wpedantic -Wconversion -Werror \
      -I"$crate/include" header_twice.cpp
  done
  # shellcheck disable=SC2086
  g++ -std=c++17 -Wall -Wextra -Werror -I"$crate/include" header_twice.cpp \
    "$out/prefix-f64/lib/libstratum.a" $system -o "$out/header_twice"
  "$out/header_twice"
else
  skipped "header in C++: no g++ or no gcc"
fi

step "host: beside another Rust library, and in one library with another crate"
if have gcc; then
  archive=$out/prefix-f64/lib/libstratum.a
  other_library "$out/libother.a"
  other_library "$out/libother-lto.a" -C lto=fat
  for other in "$out/libother.a" "$out/libother-lto.a"; do
    for lto in "" -flto; do
      for libraries in "$archive $other" "$other $archive"; do
        # shellcheck disable=SC2086
        gcc $flags $lto -I. "$crate/tests/link/two_libraries.c" board.c board_host.c \
          $libraries $system -o "$out/two_libraries"
        "$out/two_libraries" || fail "two_libraries with '$lto $libraries': $?"
      done
    done
  done
  echo "two libraries: in either order, with and without link-time optimisation of either side"
  combined "$out/libcombined.a"
  # shellcheck disable=SC2086
  gcc $flags combined.c board.c board_host.c "$out/libcombined.a" $system -o "$out/combined"
  "$out/combined"
  # shellcheck disable=SC2086
  gcc $flags replay.c board.c board_host.c "$out/libcombined.a" $system -o "$out/combined-replay"
  "$out/combined-replay" > "$out/host-combined"
  same host-combined f64
else
  skipped "other Rust libraries on the host: no gcc"
fi

step "host: installed, found by pkg-config and by CMake"
if ! have gcc; then
  skipped "installed library on the host: no gcc"
else
  if have pkg-config; then
    package=$(PKG_CONFIG_PATH=$out/prefix-f64/lib/pkgconfig pkg-config --cflags --libs stratum)
    # shellcheck disable=SC2086
    gcc ${flags%-I*} bare_loop.c board.c board_host.c $package -o "$out/bare_loop-pkg-config"
    "$out/bare_loop-pkg-config"
  else
    skipped "installed library by pkg-config: no pkg-config"
  fi
  if have cmake; then
    rm -rf "$out/cmake"
    cmake -S . -B "$out/cmake" -DCMAKE_PREFIX_PATH="$out/prefix-f64" > "$out/cmake.txt" &&
      cmake --build "$out/cmake" >> "$out/cmake.txt" || { cat "$out/cmake.txt"; exit 1; }
    "$out/cmake/bare_loop"
  else
    skipped "installed library by CMake: no cmake"
  fi
fi

step "host: memory, by valgrind"
if have valgrind && have gcc; then
  for program in $programs; do
    valgrind --error-exitcode=9 --leak-check=full --log-file="$out/valgrind.txt" \
      "$out/$program-f64" > /dev/null || { cat "$out/valgrind.txt"; exit 1; }
    # The programs allocate nothing themselves.
    grep -q "total heap usage: 0 allocs" "$out/valgrind.txt" ||
      { cat "$out/valgrind.txt"; fail "$program: allocates"; }
  done
  # Threads are allocated by the stand-in for the operating system.
  valgrind --error-exitcode=9 --log-file="$out/valgrind.txt" "$out/rtos_task-f64" > /dev/null ||
    { cat "$out/valgrind.txt"; exit 1; }
  echo "no error, no allocation"
else
  skipped "valgrind of the C programs: no valgrind or no gcc"
fi

step "target: C programs on an emulated Cortex-M7, both precisions"
if ! have arm-none-eabi-gcc; then
  skipped "C programs on the target: no arm-none-eabi-gcc"
elif ! rustup target list --installed 2> /dev/null | grep -qx "$target" &&
  ! rustup target add "$target"; then
  skipped "C programs on the target: $target could not be installed"
else
  for precision in f64 f32; do
    library "$out/prefix-m7-$precision" "$precision" --target "$target"
    archive=$out/prefix-m7-$precision/lib/libstratum.a
    exports_only_its_functions "$archive" arm-none-eabi-nm
    for program in $target_programs; do
      image=$out/$program-$precision.elf
      # shellcheck disable=SC2086
      arm-none-eabi-gcc $flags $m7 $bare "$program.c" $board "$archive" -lgcc -o "$image"
      # Settings, references and cycles cannot panic: the handler is not even linked.
      # (Texts of numbers are made by Rust's formatting, which has checks of its own.)
      if [ "$program" != errors ] && [ "$program" != stack ] && arm-none-eabi-nm "$image" | grep -E 'panic|unwind'; then
        fail "$program: a panic can be reached"
      fi
    done
    # The task skeleton compiles; it runs with an operating system only.
    # shellcheck disable=SC2086
    arm-none-eabi-gcc $flags $m7 -c rtos_task.c -o "$out/rtos_task.o"
    arm-none-eabi-size "$out/bare_loop-$precision.elf"
    if have qemu-system-arm; then
      for program in $target_programs; do
        on_target "$out/$program-$precision.elf" > "$out/target-$program-$precision" 2>&1 ||
          { cat "$out/target-$program-$precision"; fail "$program failed on the target"; }
      done
      cat "$out/target-bare_loop-$precision" "$out/target-tool-$precision"
      tail -n 1 "$out/target-errors-$precision"
      cat "$out/target-stack-$precision"
      same "target-replay-$precision" "$precision"
    else
      skipped "run on the target: no qemu-system-arm; linked only"
    fi
  done
  if have pkg-config; then
    package=$(PKG_CONFIG_PATH=$out/prefix-m7-f64/lib/pkgconfig pkg-config --cflags --libs stratum)
    # shellcheck disable=SC2086
    arm-none-eabi-gcc ${flags%-I*} $m7 $bare bare_loop.c $board $package -lgcc \
      -o "$out/bare_loop-pkg-config.elf"
    cmp "$out/bare_loop-pkg-config.elf" "$out/bare_loop-f64.elf" ||
      fail "bare_loop by pkg-config is another program"
  fi

  step "target: beside another Rust library, in one with another crate, with a C library"
  archive=$out/prefix-m7-f64/lib/libstratum.a
  other_library "$out/libother-m7.a" --target "$target" -C target-cpu=cortex-m7
  other_library "$out/libother-m7-lto.a" --target "$target" -C target-cpu=cortex-m7 -C lto=fat
  images=()
  for other in "$out/libother-m7.a" "$out/libother-m7-lto.a"; do
    for libraries in "$archive $other" "$other $archive"; do
      image=$out/two_libraries-${#images[@]}.elf
      # shellcheck disable=SC2086
      arm-none-eabi-gcc $flags $m7 $bare -I. "$crate/tests/link/two_libraries.c" $board \
        $libraries -lgcc -o "$image"
      images+=("$image")
    done
  done
  combined "$out/libcombined-m7.a" --target "$target"
  for program in combined replay; do
    # shellcheck disable=SC2086
    arm-none-eabi-gcc $flags $m7 $bare "$program.c" $board "$out/libcombined-m7.a" -lgcc \
      -o "$out/combined-$program.elf"
  done
  images+=("$out/combined-combined.elf")
  if [ -e "$(arm-none-eabi-gcc -print-file-name=libm.a)" ]; then
    image=$out/own_functions.elf
    # shellcheck disable=SC2086
    arm-none-eabi-gcc $flags ${m7#-ffreestanding} $bare -I. -Wl,-Map="$out/own_functions.map",--cref \
      "$crate/tests/link/own_functions.c" board.c board_qemu.c "$archive" -lm -lc -lgcc -o "$image"
    images+=("$image")
    # In the cross reference a function stands beside the file that defines it.
    for function in sin cos pow fmod expf memcpy memmove memset memcmp; do
      file=$(awk -v name=$function '/^Cross Reference/ { on = 1 } on && $1 == name { print $2 }' \
        "$out/own_functions.map")
      case $file in
        */lib[cm].a\(*) ;;
        *) fail "$function is not the C library's: '$file'" ;;
      esac
    done
    echo "functions of the C library are its own"
  else
    skipped "a program with a C library on the target: no newlib"
  fi
  if have qemu-system-arm; then
    for image in "${images[@]}"; do
      on_target "$image" || fail "$image failed on the target: $?"
    done
    on_target "$out/combined-replay.elf" > "$out/target-combined" 2>&1
    same target-combined f64
  else
    skipped "run beside other libraries on the target: no qemu-system-arm; linked only"
  fi
fi
