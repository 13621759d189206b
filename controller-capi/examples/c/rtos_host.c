/* The operating system on a PC, in virtual time: a thread per task, of which one runs
 * at a time, the one that wakes first or is more urgent. Every run is the same. */
#include "rtos.h"

#include <pthread.h>
#include <stdlib.h>

enum { TASKS = 4 };

static struct {
    RtosTask work;
    unsigned priority;
    uint32_t wakes_us;
    pthread_cond_t turn;
} tasks[TASKS];
static int count, present = -1;
static uint32_t now_us;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local int self;

void rtos_task(RtosTask task, unsigned priority, unsigned stack_bytes) {
    (void)stack_bytes;
    if (count == TASKS) abort();
    tasks[count].work = task;
    tasks[count].priority = priority;
    pthread_cond_init(&tasks[count].turn, NULL);
    count++;
}

/* Gives the turn to the next task. Times are compared by their difference: they wrap. */
static void pass_on(void) {
    int next = 0;
    for (int i = 1; i < count; i++) {
        int32_t later = (int32_t)(tasks[i].wakes_us - tasks[next].wakes_us);
        if (later < 0 || (later == 0 && tasks[i].priority > tasks[next].priority)) next = i;
    }
    if ((int32_t)(tasks[next].wakes_us - now_us) > 0) now_us = tasks[next].wakes_us;
    present = next;
    pthread_cond_signal(&tasks[next].turn);
}

static void wait_for_turn(void) {
    while (present != self) pthread_cond_wait(&tasks[self].turn, &lock);
}

static void *begin(void *index) {
    self = (int)(intptr_t)index;
    pthread_mutex_lock(&lock);
    wait_for_turn();
    tasks[self].work();
    return NULL;
}

void rtos_start(void) {
    pthread_t threads[TASKS];
    pthread_mutex_lock(&lock);
    for (int i = 0; i < count; i++) {
        if (pthread_create(&threads[i], NULL, begin, (void *)(intptr_t)i) != 0) abort();
    }
    pass_on();
    pthread_mutex_unlock(&lock);
    for (int i = 0; i < count; i++) pthread_join(threads[i], NULL);
}

uint32_t rtos_now_us(void) { return now_us; }

void rtos_wait_until(uint32_t *next_us, uint32_t period_us) {
    tasks[self].wakes_us = *next_us;
    *next_us += period_us;
    pass_on();
    wait_for_turn();
}

/* One task runs at a time. */
void rtos_lock(void) {}
void rtos_unlock(void) {}
