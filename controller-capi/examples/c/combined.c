/* Both parts of the library that examples/combined is: torques of the controller, filtered. */
#include "board.h"
#include "stratum.h"

double low_pass(double filtered, double input, double share);

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
    for (int i = 0; i < 7; i++) {
        /* From rest half way, exactly: halving a double does not round. */
        if (low_pass(0.0, torque[i], 0.5) != torque[i] / 2.0) return 2;
    }
    board_print("one library of two crates: torques within limits, filtered\n");
    return 0;
}
