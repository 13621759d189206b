/* 5,000 cycles of up to four levels from a sequence of integers, with moving positions and
 * orientations, a hold, a fault and a reset, levels that come, go and change places, other gains. Prints the bits of some torques and a hash of all. The same
 * lines come from `cargo run -p controller-capi --example replay`, which calls
 * the core in Rust. */
#include "board.h"
#include "stratum.h"

#include <stdint.h>

#define CYCLES 5000u

static StratumController controller;
static StratumState state;
static StratumSettings settings;

/* Triangle wave between -0x4000 and 0x3fff. */
static int32_t wave(uint32_t phase) {
    phase &= 0xffffu;
    return (int32_t)(phase < 0x8000u ? phase : 0xffffu - phase) - 0x4000;
}

static const double centre[7] = {0.0, 0.625, 0.0, -1.375, 0.375, 1.0, 0.0};

static void measure(uint32_t cycle, double q[7], double dq[7]) {
    for (uint32_t i = 0; i < 7; i++) {
        uint32_t step = i + 2, phase = cycle * step + 0x1357u * i;
        double speed = step / 64.0; /* step / 2^15 rad in 2^-9 s */
        q[i] = centre[i] + wave(phase) / 32768.0;
        dq[i] = (phase & 0xffffu) < 0x8000u ? speed : -speed;
    }
}

static uint64_t bits_of(double value) {
    union { double value; uint64_t bits; } both = {value};
    return both.bits;
}

static uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a over bytes, lowest first */

static void hash_bits(uint64_t bits) {
    for (int i = 0; i < 8; i++) hash = (hash ^ (bits >> 8 * i & 0xffu)) * 0x100000001b3u;
}

static void print_number(uint64_t number, uint32_t base, int digits) {
    char text[21];
    int end = 20;
    text[end] = 0;
    do {
        text[--end] = "0123456789abcdef"[number % base];
        number /= base;
    } while (end > 0 && (number > 0 || 20 - end < digits));
    board_print(text + end);
}

static const uint32_t order[4] = {3, 1, 4, 2};

static void must(StratumResult result) {
    if (result == STRATUM_OK) return;
    board_print(stratum_error_text(result));
    board_print("\n");
    board_exit(1);
}

/* Begins what changes at a cycle. */
static void change(uint32_t cycle) {
    static const double stiffness[9] = {100.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 100.0};
    static const double damping[9] = {20.0, 0.0, 0.0, 0.0, 20.0, 0.0, 0.0, 0.0, 20.0};
    if (cycle == 600) must(stratum_level_add(&controller, &state, &settings, 4, 2, 0.5));
    if (cycle == 700) must(stratum_level_gains(&controller, &state, 1, stiffness, damping, 0.5));
    if (cycle == 1000) must(stratum_level_order(&controller, &state, order, 4, 0.5));
    if (cycle == 1700) must(stratum_level_remove(&controller, &state, 1, 0.5));
    if (cycle == 2600) must(stratum_level_add(&controller, &state, &settings, 1, 1, 0.5));
    if (cycle == 2800) must(stratum_level_remove(&controller, &state, 4, 1.0));
    if (cycle == 3600) {
        for (int i = 0; i < 7; i++) settings.null_stiffness[i][i] *= 0.5;
        must(stratum_null_space(&controller, &state, &settings, 0.5));
    }
    if (cycle >= 4000) must(stratum_reference_age(&state, 2, (cycle - 4000) / 512.0));
}

int main(void) {
    double q[7], dq[7], torque[7], residual[7], gravity[7];
    StratumReference reference;
    const StratumReference hold = {0};
    StratumStatus status;
    uint32_t saturated = 0;

    must(stratum_settings_default(STRATUM_ABI_VERSION, &settings));
    settings.level_count = 4;
    settings.levels[1].link = 3; /* the elbow */
    settings.levels[1].offset[2] = 0.0;
    settings.levels[1].axes = STRATUM_AXIS_X | STRATUM_AXIS_Y;
    settings.levels[1].stale_after_s = 0.25;
    settings.levels[1].stale = STRATUM_STALE_RELEASE;
    settings.levels[2].task = STRATUM_TASK_ORIENTATION; /* of the flange */
    settings.levels[2].axes = STRATUM_AXIS_Z;
    settings.levels[3].link = 5; /* the wrist */
    settings.levels[3].axes = STRATUM_AXIS_Z;
    settings.levels[3].offset[2] = 0.0;
    settings.levels[3].absent = 1;
    must(stratum_controller_init(&controller, &settings));
    measure(0, q, dq);
    must(stratum_state_init(&state, &controller, q));

    board_print("stratum ");
    board_print(stratum_version());
    board_print(stratum_precision() == 64 ? " f64\n" : " f32\n");
    for (uint32_t cycle = 0; cycle < CYCLES; cycle++) {
        measure(cycle, q, dq);
        must(stratum_reference_hold(&state, &controller, q));
        must(stratum_reference_get(&state, 1, &reference));
        reference.x[2] += wave(64 * cycle) / 2097152.0;
        must(stratum_reference_set(&state, 1, &reference));
        if (cycle >= 2000 && cycle < 2500) must(stratum_reference_set(&state, 2, &hold));
        must(stratum_reference_get(&state, 3, &reference));
        reference.orientation[1] += wave(32 * cycle) / 1048576.0;
        reference.dx[2] = wave(64 * cycle) / 1048576.0;
        must(stratum_reference_set(&state, 3, &reference));
        must(stratum_posture_set(&state, centre));
        if (cycle == 3010) must(stratum_reset(&state));
        change(cycle);
        double interval_s = cycle == 3000 ? -1.0 : 1.0 / 512.0;
        hash_bits((uint64_t)stratum_step(&controller, &state, q, dq, interval_s, torque));
        must(stratum_residual(&state, residual));
        must(stratum_gravity(&state, gravity)); /* what moved the arm, the observer is told */
        must(stratum_applied(&state, gravity));
        must(stratum_status(&state, &status));
        saturated += status.saturated != 0;
        for (int i = 0; i < 7; i++) hash_bits(bits_of(torque[i]));
        for (int i = 0; i < 7; i++) hash_bits(bits_of(residual[i]));
        if (cycle % 500 < 2) {
            board_print("cycle ");
            print_number(cycle, 10, 1);
            for (int i = 0; i < 7; i++) {
                board_print(" ");
                print_number(bits_of(torque[i]), 16, 16);
            }
            board_print("\n");
        }
    }
    board_print("saturated cycles ");
    print_number(saturated, 10, 1);
    board_print("\nhash ");
    print_number(hash, 16, 16);
    board_print("\n");
    return 0;
}
