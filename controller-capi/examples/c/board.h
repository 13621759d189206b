/* What the examples want of a board. board.c is an arm that stands still;
 * board_host.c and board_qemu.c print and end the program. */
#ifndef BOARD_H
#define BOARD_H

/* Waits for the next cycle; 0 when the work is over. */
int board_wait(void);
/* Joint positions in rad and speeds in rad/s. */
void board_read(double q[7], double dq[7]);
/* Joint torques in Nm. */
void board_write(const double torque[7]);

void board_print(const char *text);
/* Ends the program: 0 is success. */
_Noreturn void board_exit(int status);

#endif
