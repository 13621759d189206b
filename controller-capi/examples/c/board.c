/* An arm that stands still for 1,000 cycles; its torques are judged. */
#include "board.h"

static int cycles;

int board_wait(void) {
    if (++cycles <= 1000) return 1;
    board_print("1000 cycles, every torque within limits\n");
    return 0;
}

void board_read(double q[7], double dq[7]) {
    static const double posture[7] = {0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0};
    for (int i = 0; i < 7; i++) {
        q[i] = posture[i];
        dq[i] = 0.0;
    }
}

void board_write(const double torque[7]) {
    int lifts = 0; /* gravity loads at least one joint */
    for (int i = 0; i < 7; i++) {
        if (!(torque[i] >= -176.0 && torque[i] <= 176.0)) {
            board_print("a torque is beyond all limits\n");
            board_exit(1);
        }
        if (torque[i] > 1.0 || torque[i] < -1.0) lifts = 1;
    }
    if (!lifts) {
        board_print("nothing carries the arm\n");
        board_exit(1);
    }
}
