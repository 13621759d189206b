/* One controller, one arm, no operating system. */
#include "board.h"
#include "stratum.h"

static StratumController controller;
static StratumState state;
static StratumSettings settings;

int main(void) {
    double q[7], dq[7], torque[7];
    board_read(q, dq);
    if (stratum_settings_default(STRATUM_ABI_VERSION, &settings) != STRATUM_OK ||
        stratum_controller_init(&controller, &settings) != STRATUM_OK ||
        stratum_state_init(&state, &controller, q) != STRATUM_OK) return 1;
    while (board_wait()) {
        board_read(q, dq);
        stratum_step(&controller, &state, q, dq, 0.002, torque); /* on a fault: holds the arm */
        board_write(torque);
    }
    return 0;
}
