//! Copies the cycle's code from flash to ITCM, before data are initialised and before
//! any Rust may run: cortex-m-rt calls this first.

#![allow(unsafe_code)] // assembly

use core::arch::global_asm;

global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =__itcm_start",
    "ldr r1, =__itcm_end",
    "ldr r2, =__itcm_load",
    "1: cmp r0, r1",
    "bhs 2f",
    "ldr r3, [r2], #4",
    "str r3, [r0], #4",
    "b 1b",
    "2: dsb",
    "isb",
    "bx lr",
);
