/* What the task skeleton wants of an operating system, and what it is called there:
 *
 *   here               FreeRTOS                       CMSIS-RTOS2
 *   rtos_task          xTaskCreateStatic              osThreadNew
 *   rtos_start         vTaskStartScheduler            osKernelStart
 *   rtos_now_us        a free-running timer of 1 MHz  the same
 *   rtos_wait_until    vTaskDelayUntil                osDelayUntil
 *   rtos_lock/unlock   taskENTER/EXIT_CRITICAL        osKernelLock/osKernelUnlock
 *
 * rtos_host.c is a stand-in in virtual time, to see the skeleton run on a PC.
 */
#ifndef RTOS_H
#define RTOS_H

#include <stdint.h>

typedef void (*RtosTask)(void);

/* A task; a larger number is more urgent. Tasks are made before the start. */
void rtos_task(RtosTask task, unsigned priority, unsigned stack_bytes);
/* Runs the tasks; comes back on a PC only. */
void rtos_start(void);
/* Time in microseconds, wrapping around. */
uint32_t rtos_now_us(void);
/* Sleeps until *next, then moves it on by the period: no drift. */
void rtos_wait_until(uint32_t *next_us, uint32_t period_us);
/* Nobody else runs in between: for a few copies. */
void rtos_lock(void);
void rtos_unlock(void);

#endif
