/* A program with a C library of its own: check.sh looks where these functions come from. */
#include "board.h"
#include "stratum.h"

#include <math.h>
#include <string.h>

static StratumController controller;
static StratumState state;
static StratumSettings settings;
static volatile double x = 0.5, two = 2.0;
static volatile float y = 0.5f;
static volatile size_t size = 200;
static char from[256], to[256];

int main(void) {
    double q[7], dq[7], torque[7];
    board_read(q, dq);
    if (stratum_settings_default(STRATUM_ABI_VERSION, &settings) != STRATUM_OK ||
        stratum_controller_init(&controller, &settings) != STRATUM_OK ||
        stratum_state_init(&state, &controller, q) != STRATUM_OK ||
        stratum_step(&controller, &state, q, dq, 0.002, torque) != STRATUM_OK) return 1;
    board_write(torque); /* judges them */
    memset(from, 7, size);
    memcpy(to, from, size);
    memmove(to + 1, to, size);
    if (memcmp(to, from, size) != 0) return 2;
    const double identity = sin(x) * sin(x) + cos(x) * cos(x); /* 1 within rounding */
    if (!(fabs(identity - 1.0) < 1e-15)) return 3;
    if (pow(x, two) != 0.25 || fmod(x, 0.375) != 0.125 || fabsf(expf(y) * expf(-y) - 1.0f) > 1e-6f)
        return 4;
    return 0;
}
