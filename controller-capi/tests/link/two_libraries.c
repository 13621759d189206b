/* The controller beside somebody else's Rust library (other.rs): each does its work. */
#include "board.h"
#include "stratum.h"

uint32_t other_digit_sum(uint64_t number);
uint32_t other_entry(size_t index);

static StratumController controller;
static StratumState state;
static StratumSettings settings;

int main(void) {
    double q[7], dq[7], torque[7];
    board_read(q, dq);
    if (stratum_settings_default(STRATUM_ABI_VERSION, &settings) != STRATUM_OK ||
        stratum_controller_init(&controller, &settings) != STRATUM_OK ||
        stratum_state_init(&state, &controller, q) != STRATUM_OK ||
        stratum_step(&controller, &state, q, dq, 0.002, torque) != STRATUM_OK) return 1;
    board_write(torque); /* judges them */
    if (other_digit_sum(12345678901234567890u) != 90) return 2;
    if (other_entry(7) != 18 || other_entry(8) != 0) return 3;
    return 0;
}
