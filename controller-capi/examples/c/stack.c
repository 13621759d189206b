/* The stack that functions of the library need on the target, against limits. Runs with
 * board_qemu.c: no interrupt, so what lies below the stack pointer stays as it is. */
#include "board.h"
#include "stratum.h"

#include <stdint.h>

#define PAINT 0x57a7157au
#define WORDS 8192

static StratumController controller;
static StratumState state;
static StratumSettings settings;
static StratumReference reference;
static char text[STRATUM_TEXT_SIZE];
static double q[STRATUM_JOINTS], dq[STRATUM_JOINTS], torque[STRATUM_JOINTS];

static void settings_default(void) { stratum_settings_default(STRATUM_ABI_VERSION, &settings); }
static void settings_of_arm(void) { stratum_settings_of_arm(STRATUM_ABI_VERSION, "fr3", &settings); }
static void settings_text(void) { stratum_settings_text(&settings, text, sizeof text); }
static void controller_init(void) { stratum_controller_init(&controller, &settings); }
static void state_init(void) { stratum_state_init(&state, &controller, q); }
static void hold(void) { stratum_reference_hold(&state, &controller, q); }
static void get(void) { stratum_reference_get(&state, 1, &reference); }
static void set(void) { stratum_reference_set(&state, 1, &reference); }
static void step(void) { stratum_step(&controller, &state, q, dq, 0.002, torque); }
static void fault(void) { stratum_step(&controller, &state, q, dq, -1.0, torque); }
static void fault_text(void) { stratum_fault_text(&state, text, sizeof text); }

/* In this order: one makes what the next one needs. */
static const struct {
    const char *name;
    void (*call)(void);
    uint32_t limit;
} functions[] = {
    {"settings_of_arm", settings_of_arm, 6144},
    {"settings_default", settings_default, 6144},
    {"settings_text", settings_text, 30720},
    {"controller_init", controller_init, 23552},
    {"state_init", state_init, 17408},
    {"reference_hold", hold, 10240},
    {"reference_get", get, 1024},
    {"reference_set", set, 1024},
    {"step", step, 2560},
    {"step on a fault", fault, 2560},
    {"fault_text", fault_text, 4096},
};

/* Bytes below the frame of this function that `call` has changed. */
static uint32_t used(void (*call)(void)) {
    volatile uint32_t *const top = __builtin_frame_address(0), *word = top - WORDS;
    for (; word < top - 32; word++) *word = PAINT; /* not in the frame itself */
    call();
    for (word = top - WORDS; *word == PAINT; word++) {}
    return (uint32_t)(top - word) * 4u;
}

static void print_number(uint32_t number) {
    char digits[11];
    int end = 10;
    digits[end] = 0;
    do digits[--end] = (char)('0' + number % 10u);
    while ((number /= 10u) > 0);
    board_print(digits + end);
}

int main(void) {
    int too_much = 0;
    board_read(q, dq);
    for (uint32_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        uint32_t bytes = used(functions[i].call);
        board_print("stack of ");
        board_print(functions[i].name);
        board_print(": ");
        print_number(bytes);
        board_print(" bytes");
        if (bytes > functions[i].limit) {
            board_print(", more than the limit of ");
            print_number(functions[i].limit);
            too_much = 1;
        }
        board_print("\n");
    }
    return too_much;
}
