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

programs="bare_loop replay errors"
# On the target the stack that they need is measured as well.
target_programs="$programs stack"
task="rtos_task.c rtos_host.c robot_host.c board.c board_host.c"
flags="-std=c11 -Wall -Wextra -Wpedantic -Werror -O2 -I$crate/include"
cd "$crate/examples/c"

# library PRECISION [cargo arguments]: builds libstratum.a and prints its path.
library() {
  local features=
  [ "$1" = f64 ] || features="--features single"
  # shellcheck disable=SC2086
  (cd "$crate/.." && cargo build -p controller-capi --lib --release --quiet \
    --target-dir "$build/capi-$1" $features "${@:2}")
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
    library "$precision"
    archive=$build/capi-$precision/release/libstratum.a
    for program in $programs; do
      # shellcheck disable=SC2086
      gcc $flags "$program.c" board.c board_host.c "$archive" -lpthread -ldl -lm \
        -o "$out/$program-$precision"
    done
    "$out/bare_loop-$precision"
    "$out/errors-$precision" > "$out/errors.txt" || { cat "$out/errors.txt"; exit 1; }
    tail -n 1 "$out/errors.txt"
    "$out/replay-$precision" > "$out/host-$precision"
    same "host-$precision" "$precision"
    # shellcheck disable=SC2086
    gcc $flags -D_POSIX_C_SOURCE=200809L $task "$archive" -lpthread -ldl -lm \
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
if have g++; then
  library f64
  for dialect in c++11 c++20; do
    g++ -fsyntax-only -std=$dialect -Wall -Wextra -Wpedantic -Wconversion -Werror \
      -I"$crate/include" header_twice.cpp
  done
  g++ -std=c++17 -Wall -Wextra -Werror -I"$crate/include" header_twice.cpp \
    "$build/capi-f64/release/libstratum.a" -lpthread -ldl -lm -o "$out/header_twice"
  "$out/header_twice"
else
  skipped "header in C++: no g++"
fi

# installed PREFIX [arguments of install.sh]: what is found under a prefix that has moved.
installed() {
  rm -rf "$1" "$1-before"
  (cd "$crate/.." && CARGO_TARGET_DIR=$build/capi-f64 "$crate/install.sh" "$1-before" "${@:2}")
  mv "$1-before" "$1"
}

step "host: installed, found by pkg-config and by CMake"
if ! have gcc; then
  skipped "installed library on the host: no gcc"
else
  installed "$out/prefix"
  if have pkg-config; then
    package=$(PKG_CONFIG_PATH=$out/prefix/lib/pkgconfig pkg-config --cflags --libs stratum)
    # shellcheck disable=SC2086
    gcc ${flags%-I*} bare_loop.c board.c board_host.c $package -o "$out/bare_loop-pkg-config"
    "$out/bare_loop-pkg-config"
  else
    skipped "installed library by pkg-config: no pkg-config"
  fi
  if have cmake; then
    rm -rf "$out/cmake"
    cmake -S . -B "$out/cmake" -DCMAKE_PREFIX_PATH="$out/prefix" > "$out/cmake.txt" &&
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
    library "$precision" --target "$target"
    archive=$build/capi-$precision/$target/release/libstratum.a
    for program in $target_programs; do
      image=$out/$program-$precision.elf
      # shellcheck disable=SC2086
      arm-none-eabi-gcc $flags -ffreestanding -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard \
        -nostdlib -T qemu.ld -Wl,--gc-sections,-z,noexecstack,--fatal-warnings \
        "$program.c" board.c board_qemu.c "$archive" -lgcc -o "$image"
      # Settings, references and cycles cannot panic: the handler is not even linked.
      # (Texts of numbers are made by Rust's formatting, which has checks of its own.)
      if [ "$program" != errors ] && [ "$program" != stack ] && arm-none-eabi-nm "$image" | grep -E 'panic|unwind'; then
        fail "$program: a panic can be reached"
      fi
    done
    # The task skeleton compiles; it runs with an operating system only.
    # shellcheck disable=SC2086
    arm-none-eabi-gcc $flags -ffreestanding -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard \
      -c rtos_task.c -o "$out/rtos_task.o"
    arm-none-eabi-size "$out/bare_loop-$precision.elf"
    if have qemu-system-arm; then
      for program in $target_programs; do
        timeout 120 qemu-system-arm -M mps2-an500 -display none -serial null -monitor none \
          -semihosting-config enable=on,target=native \
          -kernel "$out/$program-$precision.elf" > "$out/target-$program-$precision" 2>&1 ||
          { cat "$out/target-$program-$precision"; fail "$program failed on the target"; }
      done
      cat "$out/target-bare_loop-$precision"
      tail -n 1 "$out/target-errors-$precision"
      cat "$out/target-stack-$precision"
      same "target-replay-$precision" "$precision"
    else
      skipped "run on the target: no qemu-system-arm; linked only"
    fi
  done
  if have pkg-config; then
    installed "$out/prefix-m7" --target "$target"
    package=$(PKG_CONFIG_PATH=$out/prefix-m7/lib/pkgconfig pkg-config --cflags --libs stratum)
    # shellcheck disable=SC2086
    arm-none-eabi-gcc ${flags%-I*} -ffreestanding -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard \
      -nostdlib -T qemu.ld -Wl,--gc-sections,-z,noexecstack bare_loop.c board.c board_qemu.c \
      $package -lgcc -o "$out/bare_loop-pkg-config.elf"
    cmp "$out/bare_loop-pkg-config.elf" "$out/bare_loop-f64.elf" ||
      fail "bare_loop by pkg-config is another program"
  fi
fi
