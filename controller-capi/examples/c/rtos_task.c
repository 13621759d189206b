/* The controller as a task of an operating system: a cycle of 2 ms above everything but
 * the emergency stop, a planner below that moves the reference. */
#include "robot.h"
#include "rtos.h"
#include "stratum.h"

#include <stddef.h>

#define CYCLE_US 2000u
#define PLANNER_US 20000u

/* Of the calls in the task stratum_reference_hold needs most, at most 10 KiB on a
 * Cortex-M7 (stack.c); the frames of this file and of an interrupt that stacks the FPU's
 * registers come on top. The system has to save d8 to d15 on a switch of tasks. The init
 * functions need more: they run before, on main's stack. */
#define CONTROL_STACK 12288u
#define PLANNER_STACK 2048u

enum { PLANNER_PRIORITY = 1, CONTROL_PRIORITY = 5 };

static StratumController controller;
static StratumState state;

/* From the planner to the cycle: the latest reference, and whether the operator asks. */
static struct {
    StratumReference target;
    int fresh;
    int start;
} mailbox;

/* From the interrupt to the cycle. */
static volatile int stop_pressed;

/* Whether the drives were asked for since the last stop. */
static int running;

/* Above the cycle: the outputs first, the rest is the cycle's. */
void emergency_stop_isr(void) {
    robot_drives(0);
    robot_heartbeat(0);
    stop_pressed = 1;
}

static void make_safe(void) {
    static const double nothing[7];
    running = 0;
    robot_drives(0);
    robot_heartbeat(0);
    robot_send(nothing);
    /* What the observer is to know: no torque acts. */
    stratum_applied(&state, nothing);
}

/* Takes what the planner has left; on a start the arm is held where it is. */
static void take_mail(const double q[7]) {
    rtos_lock();
    StratumReference target = mailbox.target;
    int fresh = mailbox.fresh, start = mailbox.start;
    mailbox.fresh = 0;
    mailbox.start = 0;
    rtos_unlock();
    if (start) {
        stop_pressed = 0;
        stratum_reset(&state);
        stratum_reference_hold(&state, &controller, q);
        running = 1;
    } else if (fresh && running) {
        stratum_reference_set(&state, 1, &target);
    }
}

static void control_task(void) {
    double q[7], dq[7], torque[7];
    uint32_t next = rtos_now_us(), taken, last = 0;
    int beat = 0, first = 1;
    for (;;) {
        rtos_wait_until(&next, CYCLE_US);
        if (!robot_measure(q, dq, &taken)) {
            make_safe();
            stratum_skip(&state);
            first = 1;
            continue;
        }
        /* The measured interval; the nominal one where there is none. */
        double interval_s = first ? CYCLE_US * 1e-6 : (double)(taken - last) * 1e-6;
        first = 0;
        last = taken;
        take_mail(q);
        StratumResult result = stratum_step(&controller, &state, q, dq, interval_s, torque);
        /* A fault or a mistake: off within this cycle, until the operator asks again. */
        if (result != STRATUM_OK || stop_pressed || !running) {
            make_safe();
            continue;
        }
        beat = !beat;
        robot_send(torque);
        robot_heartbeat(beat);
        rtos_lock();
        /* Not after an interrupt that has come in the meantime. */
        if (!stop_pressed) robot_drives(1);
        rtos_unlock();
    }
}

/* Raises the first level's target by 1 mm per second, from where the arm is. */
static void planner_task(void) {
    uint32_t next = rtos_now_us();
    StratumReference target;
    int was_pressed = 0;
    for (;;) {
        rtos_wait_until(&next, PLANNER_US);
        int pressed = robot_start_pressed();
        rtos_lock();
        if (pressed && !was_pressed) {
            mailbox.start = 1;
        } else if (running && stratum_reference_get(&state, 1, &target) == STRATUM_OK) {
            target.x[2] += 0.001 * PLANNER_US * 1e-6;
            mailbox.target = target;
            mailbox.fresh = 1;
        }
        rtos_unlock();
        was_pressed = pressed;
    }
}

/* 0 where the tasks can be started. */
static int prepare(void) {
    static StratumSettings settings;
    double q[7], dq[7];
    uint32_t taken;
    if (!robot_measure(q, dq, &taken)) return 1;
    if (stratum_settings_default(STRATUM_ABI_VERSION, &settings) != STRATUM_OK) return 1;
    if (stratum_controller_init(&controller, &settings) != STRATUM_OK) return 1;
    return stratum_state_init(&state, &controller, q) != STRATUM_OK;
}

int main(void) {
    robot_drives(0);
    robot_heartbeat(0);
    if (prepare() != 0) return 1;
    rtos_task(control_task, CONTROL_PRIORITY, CONTROL_STACK);
    rtos_task(planner_task, PLANNER_PRIORITY, PLANNER_STACK);
    rtos_start();
    return 0;
}
