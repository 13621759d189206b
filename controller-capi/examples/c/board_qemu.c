/* The board of QEMU's mps2-an500 (Cortex-M7), all of it: vectors, start, and
 * printing through semihosting, which the emulator answers. */
#include "board.h"

#include <stdint.h>

extern uint32_t stack_top, data_start, data_end, data_load, bss_start, bss_end;
int main(void);

#define CPACR (*(volatile uint32_t *)0xe000ed88u)

static int semihosting(int operation, const void *argument) {
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void board_print(const char *text) { semihosting(0x04, text); } /* SYS_WRITE0 */

_Noreturn void board_exit(int status) {
    /* SYS_EXIT_EXTENDED with ADP_Stopped_ApplicationExit. */
    uint32_t block[2] = {0x20026u, (uint32_t)status};
    semihosting(0x20, block);
    for (;;) {
    }
}

static void on_fault(void) {
    board_print("processor fault\n");
    board_exit(3);
}

void reset(void) {
    /* The FPU, before any function that may use it. */
    CPACR |= 0xfu << 20;
    __asm__ volatile("dsb\n isb" ::: "memory");
    for (uint32_t *to = &data_start, *from = &data_load; to < &data_end;) *to++ = *from++;
    for (uint32_t *to = &bss_start; to < &bss_end;) *to++ = 0;
    board_exit(main());
}

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {&stack_top, {reset, on_fault, on_fault, on_fault, on_fault, on_fault}};
