//! Skeleton of a co-processor on an STM32H743: the controller in a timer's interrupt,
//! its code in ITCM, its data and the stack in DTCM. It compiles, and nobody has run it
//! on silicon.
//!
//! Bare cortex-m instead of a framework: there is one cycle and one stop, and their
//! priorities are two lines.
//!
//! What is yours: [`joints::Joints`], the way to encoders and drives; the pins; the
//! tasks, here those of the scenario `two-level`. Until there is a bus nothing is
//! measured and the drives stay off.
//!
//! | pin | direction | meaning |
//! |---|---|---|
//! | PC13 | in | start: high while the operator asks for the drives |
//! | PC0 | in | emergency stop: low is pressed, or a broken wire |
//! | PE1 | out | drive enable: high lets the drives run |
//! | PB0 | out | heartbeat: an external watchdog takes the power away when it stops |

#![no_std]
#![no_main]

mod cycle;
mod itcm;
mod joints;
mod pins;

use core::cell::RefCell;

use controller_core::Controller;
use cortex_m::interrupt::Mutex;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::entry;
use firmware::interlock::Interlock;
use firmware::interlocked_controller::InterlockedController;
use firmware::scenario::{CYCLE_S, FixedScenario, controller};
use stm32h7xx_hal::gpio::{Edge, ExtiPin, Input, Output, PB0, PC0, PC13, PE1, PushPull};
use stm32h7xx_hal::pac::{self, interrupt};
use stm32h7xx_hal::prelude::*;
use stm32h7xx_hal::timer::{Event, Timer};

use cycle::Loop;
use joints::NotConnected;
use pins::Pin;

/// Processor clock \[MHz\], from a crystal of 8 MHz; 480 needs silicon of revision V.
const CLOCK_MHZ: u32 = 480;

/// Cycles per second: [`CYCLE_S`] is 2 ms.
const CYCLES_HZ: u32 = 500;
const _: () = assert!(CYCLES_HZ as f64 * CYCLE_S == 1.0);

/// Priorities, smaller is more urgent; the four high bits count. Nothing else may be
/// above the cycle.
const STOP_PRIORITY: u8 = 0x10;
/// See [`STOP_PRIORITY`].
const CYCLE_PRIORITY: u8 = 0x20;

type Control = Loop<
    NotConnected,
    Pin<PC0<Input>>,
    Pin<PE1<Output<PushPull>>>,
    Pin<PB0<Output<PushPull>>>,
    Pin<PC13<Input>>,
>;

/// What the interrupt works with.
type Mine = (&'static mut Control, Timer<pac::TIM2>);

/// From `main` to the interrupt, once.
static HANDOVER: Mutex<RefCell<Option<Mine>>> = Mutex::new(RefCell::new(None));

#[entry]
fn main() -> ! {
    // `entry` hands the static out once, as a reference.
    static mut CONTROL: Option<Control> = None;
    let taken = cortex_m::Peripherals::take().zip(pac::Peripherals::take());
    // `entry` runs once, so that both are there.
    let Some((mut core, device)) = taken else {
        stop()
    };

    let power = device.PWR.constrain().vos0(&device.SYSCFG).freeze();
    let reset = device.RCC.constrain();
    let clocks = reset
        .use_hse(8.MHz())
        .sys_ck(CLOCK_MHZ.MHz())
        .freeze(power, &device.SYSCFG);
    // For what is left in flash: start-up and the constructor.
    core.SCB.enable_icache();
    core.SCB.enable_dcache(&mut core.CPUID);
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();

    let b = device.GPIOB.split(clocks.peripheral.GPIOB);
    let c = device.GPIOC.split(clocks.peripheral.GPIOC);
    let e = device.GPIOE.split(clocks.peripheral.GPIOE);
    let mut emergency_stop = c.pc0.into_pull_down_input();
    let (mut syscfg, mut exti) = (device.SYSCFG, device.EXTI);
    emergency_stop.make_interrupt_source(&mut syscfg);
    emergency_stop.trigger_on_edge(&mut exti, Edge::Falling);
    emergency_stop.enable_interrupt(&mut exti);
    let interlock = Interlock::new(
        Pin(emergency_stop),
        Pin(e.pe1.into_push_pull_output()),
        Pin(b.pb0.into_push_pull_output()),
    );

    let Ok(controller): Result<Controller<f64>, _> = controller(FixedScenario::TwoLevel) else {
        stop()
    };
    let hz = f64::from(clocks.clocks.c_ck().raw());
    let start = Pin(c.pc13.into_pull_down_input());
    let control = CONTROL.insert(Loop::new(
        InterlockedController::new(controller, interlock),
        NotConnected,
        start,
        hz,
        CYCLE_S,
    ));
    let mut timer = device
        .TIM2
        .timer(CYCLES_HZ.Hz(), clocks.peripheral.TIM2, &clocks.clocks);
    timer.listen(Event::TimeOut);
    cortex_m::interrupt::free(|section| {
        HANDOVER.borrow(section).replace(Some((control, timer)));
    });

    enable(&mut core.NVIC);
    loop {
        // Room for what has no deadline: references, links, reports.
        cortex_m::asm::wfi();
    }
}

#[allow(unsafe_code)] // priorities
fn enable(nvic: &mut NVIC) {
    // SAFETY: no critical section depends on priorities: they mask all interrupts.
    unsafe {
        nvic.set_priority(pac::Interrupt::EXTI0, STOP_PRIORITY);
        nvic.set_priority(pac::Interrupt::TIM2, CYCLE_PRIORITY);
        NVIC::unmask(pac::Interrupt::EXTI0);
        NVIC::unmask(pac::Interrupt::TIM2);
    }
}

/// The cycle.
#[interrupt]
fn TIM2() {
    static mut MINE: Option<Mine> = None;
    if MINE.is_none() {
        *MINE = cortex_m::interrupt::free(|section| HANDOVER.borrow(section).take());
    }
    if let Some((control, timer)) = MINE {
        timer.clear_irq();
        control.run();
    }
}

/// The emergency stop, above the cycle: drives off at once, by a register that needs
/// no reading before. The interlock notices the stop in the next cycle and stays off.
#[interrupt]
fn EXTI0() {
    drives_off();
    #[allow(unsafe_code)]
    // SAFETY: writing a one acknowledges this line and leaves the others.
    unsafe {
        (*pac::EXTI::ptr()).cpupr1.write(|w| w.pr0().set_bit());
    }
}

/// PE1 low.
#[allow(unsafe_code)]
fn drives_off() {
    // SAFETY: the register sets and resets bits without reading; ones act, zeros do not.
    unsafe {
        (*pac::GPIOE::ptr()).bsrr.write(|w| w.br1().set_bit());
    }
}

/// Nothing to do any more: drives off, heart still.
fn stop() -> ! {
    cortex_m::interrupt::disable();
    drives_off();
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    stop()
}
