/* An arm that stands still, an operator, and a judge of the outputs, for 1,000 cycles:
 *
 *   cycle 100          the operator asks for the drives
 *   cycle 300          emergency stop, pressed between measurement and torque
 *   cycle 500          asks again
 *   cycle 700 to 702   the bus brings nothing
 */
#include "board.h"
#include "robot.h"
#include "rtos.h"

static int cycle, drives, beats, heartbeat;

static void require(int good, const char *otherwise) {
    if (good) return;
    board_print(otherwise);
    board_exit(1);
}

/* How the cycle before has left the outputs. */
static void judge(void) {
    int moves = (cycle > 110 && cycle < 300) || (cycle > 510 && cycle < 700);
    int still = cycle < 100 || (cycle >= 300 && cycle < 500) || cycle >= 700;
    if (moves) require(drives, "the drives do not run\n");
    if (still) require(!drives && !heartbeat, "the outputs are not safe\n");
}

int robot_measure(double q[7], double dq[7], uint32_t *taken_us) {
    if (cycle > 0) judge();
    if (cycle == 1000) {
        require(beats > 300, "the heart does not beat\n");
        board_print("1000 cycles as a task; outputs safe in the cycle of the stop and of the silence\n");
        board_exit(0);
    }
    cycle++;
    board_read(q, dq);
    *taken_us = rtos_now_us();
    if (cycle == 300) emergency_stop_isr();
    return cycle < 700 || cycle > 702;
}

void robot_send(const double torque[7]) {
    for (int i = 0; i < 7; i++) {
        require(torque[i] >= -176.0 && torque[i] <= 176.0, "a torque is beyond all limits\n");
    }
}

void robot_drives(int on) { drives = on; }

void robot_heartbeat(int level) {
    beats += level != heartbeat;
    heartbeat = level;
}

int robot_start_pressed(void) { return (cycle >= 100 && cycle < 200) || (cycle >= 500 && cycle < 600); }
