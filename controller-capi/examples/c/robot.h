/* What the task skeleton wants of encoders, drives and operator. robot_host.c is an arm
 * that stands still, with an operator who does what the test wants. */
#ifndef ROBOT_H
#define ROBOT_H

#include <stdint.h>

/* Positions in rad and speeds in rad/s with the time they were taken, in microseconds;
 * 0 where the bus has brought nothing new. */
int robot_measure(double q[7], double dq[7], uint32_t *taken_us);
/* Torque in Nm to apply until the next cycle. */
void robot_send(const double torque[7]);
/* Drive enable: 0 is safe. To be called from interrupts as well. */
void robot_drives(int on);
/* Changes with every good cycle; an external watchdog takes the power away when it stops. */
void robot_heartbeat(int level);
/* Whether the operator asks for the drives: a button, pressed anew after every stop. */
int robot_start_pressed(void);

/* The application's interrupt handler of the emergency stop. */
void emergency_stop_isr(void);

#endif
