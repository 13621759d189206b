/* An FR3 that hangs from the ceiling with a gripper, and takes a part of 0.2 kg on the way: a
 * controller for each load, one state. */
#include "board.h"
#include "stratum.h"

static StratumController empty, loaded;
static StratumState state;
static StratumSettings settings;

/* The gripper's frame is between its fingers; the part has its centre there. */
static const StratumTool gripper = {
    .pose = {.rotation = {{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
             .shift = {0.0, 0.0, 0.1}},
    .mass = 0.7,
    .com = {0.0, 0.0, -0.05},
    .inertia = {0.001, 0.0, 0.0, 0.002, 0.0, 0.0015},
};
static const StratumPose ceiling = {
    .rotation = {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.0, 0.0, -1.0}},
    .shift = {0.0, 0.0, 2.0},
};

/* The level is on the tool already: STRATUM_ON_TOOL is what settings start with. */
static StratumResult configure(void) {
    StratumResult result = stratum_settings_of_arm(STRATUM_ABI_VERSION, "fr3", &settings);
    if (result != STRATUM_OK) return result;
    settings.arm.base = ceiling;
    settings.tool = gripper;
    if ((result = stratum_controller_init(&empty, &settings)) != STRATUM_OK) return result;
    settings.tool.mass += 0.2;
    settings.tool.com[2] *= gripper.mass / settings.tool.mass;
    return stratum_controller_init(&loaded, &settings);
}

static int within(double x, double most) { return x >= -most && x <= most; }

int main(void) {
    double q[7], dq[7], torque[7] = {0.0}, residual[7], carried = 0.0;
    const StratumController *controller = &empty;
    board_read(q, dq);
    if (configure() != STRATUM_OK ||
        stratum_state_init(&state, controller, q) != STRATUM_OK) return 1;
    for (int cycle = 1; board_wait(); cycle++) {
        board_read(q, dq);
        if (cycle == 500) { /* the fingers close */
            carried = torque[1];
            controller = &loaded;
            stratum_skip(&state);
        }
        if (stratum_step(controller, &state, q, dq, 0.002, torque) != STRATUM_OK) return 1;
        board_write(torque);
        stratum_residual(&state, residual); /* the part is no push */
        for (int i = 0; i < 7; i++)
            if (!within(residual[i], 0.01)) return 1;
    }
    return within(torque[1] - carried, 0.5); /* the part has a weight */
}
