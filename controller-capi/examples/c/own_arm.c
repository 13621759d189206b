/* An arm of one's own: its table is a constant that `hil-sim model import --c` made of a URDF. This one
 * has the numbers of a built-in arm, whose torques are therefore the same but for rounding. */
#include "board.h"
#include "iiwa_14.h"
#include "stratum.h"

static StratumController own, built_in;
static StratumState own_state, built_in_state;
static StratumSettings settings;

static int within(double x, double most) { return x >= -most && x <= most; }

static StratumResult start(StratumController *controller, StratumState *state, const double q[7]) {
    StratumResult result = stratum_controller_init(controller, &settings);
    return result != STRATUM_OK ? result : stratum_state_init(state, controller, q);
}

int main(void) {
    double q[7], dq[7], torque[7], other[7];
    board_read(q, dq);
    if (stratum_settings_default(STRATUM_ABI_VERSION, &settings) != STRATUM_OK) return 1;
    settings.damping = STRATUM_DAMPING_INERTIA; /* that of no other arm */
    settings.arm = iiwa_14;
    if (start(&own, &own_state, q) != STRATUM_OK ||
        stratum_arm_preset("iiwa_14", &settings.arm) != STRATUM_OK ||
        start(&built_in, &built_in_state, q) != STRATUM_OK) return 1;
    while (board_wait()) {
        board_read(q, dq);
        if (stratum_step(&own, &own_state, q, dq, 0.002, torque) != STRATUM_OK ||
            stratum_step(&built_in, &built_in_state, q, dq, 0.002, other) != STRATUM_OK) return 1;
        board_write(torque);
        for (int i = 0; i < 7; i++) /* of up to 100 Nm, in single precision as well */
            if (!within(torque[i] - other[i], 1e-3)) return 1;
    }
    return 0;
}
