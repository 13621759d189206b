//! Bit-for-bit self-test. On the target it replays the log `selftest.log` of the
//! host and counts the torque bits that differ: exit code 0 if there are none.
//! On the host it writes that log: `selftest FILE [CYCLES]`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    use std::io::Write;

    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or_else(|| "selftest.log".into());
    let cycles = match arguments.next().map(|text| text.parse::<u16>()) {
        None => 5000,
        Some(Ok(cycles)) if cycles > 0 => cycles,
        Some(_) => {
            eprintln!("usage: selftest FILE [CYCLES]; cycles from 1 to 65535");
            return 2.into();
        }
    };
    let written = std::fs::File::create(&path).and_then(|file| {
        let mut out = std::io::BufWriter::new(file);
        let met = firmware::recording::write_log(&mut out, cycles)?;
        out.flush()?;
        Ok(met)
    });
    match written {
        Ok(met) => {
            println!("{path}: two scenarios, two precisions, {cycles} cycles each");
            println!(
                "        {} with joints at their bounds, by up to {} pivots, {} with a level released",
                met.projected, met.pivots, met.released
            );
            0.into()
        }
        Err(error) => {
            eprintln!("{path}: {error}");
            1.into()
        }
    }
}

#[cfg(target_os = "none")]
mod target {
    use cortex_m_rt::entry;
    use cortex_m_semihosting::hprintln;
    use firmware::log::{CYCLE_BYTES, Comparison, HEADER_BYTES, Header, NUMBERS, Number, replay};
    use firmware::mps2::{self, HostFile};
    use firmware::scenario::ReadyScenario;

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        mps2::panicked(info)
    }

    #[entry]
    fn main() -> ! {
        let Some(mut file) = HostFile::open(c"selftest.log") else {
            hprintln!("selftest.log cannot be opened");
            mps2::exit(false)
        };
        let (mut runs, mut clean) = (0, true);
        let mut header = [0; HEADER_BYTES];
        while file.read(&mut header) {
            let Some(header) = Header::decode(header) else {
                hprintln!("selftest.log: not a header of a run");
                mps2::exit(false)
            };
            clean &= match header.bytes {
                8 => run::<f64>(&mut file, header),
                _ => run::<f32>(&mut file, header),
            };
            runs += 1;
        }
        mps2::exit(clean && runs > 0)
    }

    fn run<T: Number>(file: &mut HostFile, header: Header) -> bool {
        let Ok(ready) = ReadyScenario::<T>::new(header.scenario) else {
            hprintln!("{} {}: refused", header.scenario.name(), T::NAME);
            return false;
        };
        let found = replay(&ready, header.cycles, || {
            let mut bytes = [0; CYCLE_BYTES];
            file.read(bytes.get_mut(..NUMBERS * T::BYTES)?)
                .then_some(bytes)
        });
        report(&header, T::NAME, &found);
        found.bits == 0 && found.faults == 0 && found.cycles == header.cycles
    }

    fn report(header: &Header, precision: &str, found: &Comparison) {
        hprintln!(
            "{:<9} {}: {} of {} cycles x 7 torques, {} differing bits, {} faults",
            header.scenario.name(),
            precision,
            found.cycles,
            header.cycles,
            found.bits,
            found.faults
        );
        if let Some(first) = found.first {
            hprintln!(
                "  first: cycle {} joint {}, {:016x} in the log, {:016x} here",
                first.cycle,
                first.joint,
                first.expected,
                first.found
            );
        }
    }
}
