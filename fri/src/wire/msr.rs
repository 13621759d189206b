//! A measurement as a value.

use super::measurement::{LEN, MeasurementPacket};
use super::{
    Cartesian, ControlScheme, Error, Frame, Header, JOINTS, Jacobian, Joints, Quality, State,
    UserData,
};

/// Where the interface stands and how it is configured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Interface {
    /// Controller time \[s\]. A binary32 resolves a millisecond for about 4.5 hours
    /// only: take intervals from counters and periods.
    pub timestamp_s: f32,
    /// State.
    pub state: State,
    /// Quality of the link, as the KRC rates it.
    pub quality: Quality,
    /// Configured period of measurements \[s\], 0.001 to 0.1.
    pub measurement_period_s: f32,
    /// Configured period of expected commands \[s\], one or more of the above.
    pub command_period_s: f32,
    /// Configured safety limits, one number; scale not documented.
    pub safety_limits: f32,
}

/// How the KRC sees the answers. Means are over the last 100 measurements; how they
/// map to [`Quality`] is not documented.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Statistics {
    /// Mean rate of answers, 0 to 1, ideal 1.
    pub answer_rate: f32,
    /// Mean latency, the PC's computing time included \[s\].
    pub latency_s: f32,
    /// Mean jitter \[s\].
    pub jitter_s: f32,
    /// Mean rate of missed answers, 0 to 1, ideal 0.
    pub miss_rate: f32,
    /// Missed answers in all.
    pub missed: u32,
}

/// The drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Drives {
    /// Power bits; see [`is_on`](Self::is_on).
    pub power: u16,
    /// The control law that is active.
    pub control: ControlScheme,
    /// Error bits; an error cuts power.
    pub error: u16,
    /// Warning bits.
    pub warning: u16,
    /// Temperature per drive; unit not documented.
    pub temperature: Joints,
}

impl Drives {
    /// Whether any power bit is set.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        self.power != 0
    }
}

/// The arm: what is measured, what is commanded, and the KRC's own model of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Arm {
    /// q: measured angles \[rad\]. Speeds are not sent.
    pub measured_position: Joints,
    /// Measured tool frame \[m\].
    pub measured_frame: Frame,
    /// What the KRC commands before FRI \[rad\].
    pub commanded_position: Joints,
    /// What FRI adds to it \[rad\].
    pub position_offset: Joints,
    /// Frame the KRC commands before FRI \[m\].
    pub commanded_frame: Frame,
    /// Frame part due to FRI \[m\]; how the two are composed is not documented.
    pub frame_offset: Frame,
    /// Torque of the joint sensors \[Nm\].
    pub measured_torque: Joints,
    /// The KRC's estimate of external joint torque \[Nm\]; sign not documented: push
    /// the arm and look.
    pub external_torque: Joints,
    /// The KRC's estimate of the external wrench at the tool \[N, Nm\].
    pub external_wrench: Cartesian,
    /// J of the tool.
    pub jacobian: Jacobian,
    /// M(q) \[kg m2\], row by row, symmetric.
    pub mass_matrix: [Joints; JOINTS],
    /// Gravity vector: joint torque \[Nm\] by the use that clients make of it,
    /// although it is labelled as an acceleration.
    pub gravity: Joints,
}

impl Arm {
    /// The angles that are commanded in all \[rad\]: the KRC's own and what FRI adds.
    /// A PC that wants nothing sends these.
    #[must_use]
    pub fn total_command(&self) -> Joints {
        let mut total = self.commanded_position;
        for (angle, offset) in total.iter_mut().zip(self.position_offset) {
            *angle += offset;
        }
        total
    }
}

/// A measurement: what the KRC sends every cycle.
///
/// The default is a KRC that is off, at zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Msr {
    /// Counters; `reflected` is that of the last command the KRC received.
    pub header: Header,
    /// Numbers from the KRL program (`$FRI_TO_REA`, `$FRI_TO_INT`, `$FRI_TO_BOOL`).
    pub user: UserData,
    /// Where the interface stands.
    pub interface: Interface,
    /// How the KRC sees the answers.
    pub statistics: Statistics,
    /// The drives.
    pub drives: Drives,
    /// The arm.
    pub arm: Arm,
}

impl Msr {
    /// Length on the wire \[byte\].
    pub const BUFFER_LEN: usize = LEN;

    /// The value of a view, which is checked for it.
    ///
    /// # Errors
    ///
    /// What [`MeasurementPacket::check`] refuses.
    pub fn parse<T: AsRef<[u8]>>(packet: &MeasurementPacket<T>) -> Result<Self, Error> {
        packet.check()?;
        Ok(Self {
            header: Header {
                sequence: packet.sequence(),
                reflected: packet.reflected(),
            },
            user: UserData {
                reals: packet.reals(),
                ints: packet.ints(),
                bools: packet.bools(),
            },
            interface: Interface {
                timestamp_s: packet.timestamp_s(),
                state: packet.state(),
                quality: packet.quality(),
                measurement_period_s: packet.measurement_period_s(),
                command_period_s: packet.command_period_s(),
                safety_limits: packet.safety_limits(),
            },
            statistics: Statistics {
                answer_rate: packet.answer_rate(),
                latency_s: packet.latency_s(),
                jitter_s: packet.jitter_s(),
                miss_rate: packet.miss_rate(),
                missed: packet.missed(),
            },
            drives: Drives {
                power: packet.power(),
                control: packet.control(),
                error: packet.error(),
                warning: packet.warning(),
                temperature: packet.temperature(),
            },
            arm: Arm {
                measured_position: packet.measured_position(),
                measured_frame: packet.measured_frame(),
                commanded_position: packet.commanded_position(),
                position_offset: packet.position_offset(),
                commanded_frame: packet.commanded_frame(),
                frame_offset: packet.frame_offset(),
                measured_torque: packet.measured_torque(),
                external_torque: packet.external_torque(),
                external_wrench: packet.external_wrench(),
                jacobian: packet.jacobian(),
                mass_matrix: packet.mass_matrix(),
                gravity: packet.gravity(),
            },
        })
    }

    /// The value of a datagram.
    ///
    /// # Errors
    ///
    /// What [`MeasurementPacket::check`] refuses.
    pub fn from_bytes(datagram: &[u8]) -> Result<Self, Error> {
        Self::parse(&MeasurementPacket::new_unchecked(datagram))
    }

    /// Writes every byte of the buffer. Reals go as they are, finite or not:
    /// senders use [`to_bytes`](Self::to_bytes).
    pub fn emit(&self, buffer: &mut [u8; LEN]) {
        let mut packet = MeasurementPacket::new_unchecked(buffer);
        packet.set_format();
        packet.set_sequence(self.header.sequence);
        packet.set_reflected(self.header.reflected);
        packet.set_reals(&self.user.reals);
        packet.set_ints(&self.user.ints);
        packet.set_bools(self.user.bools);
        packet.set_timestamp_s(self.interface.timestamp_s);
        packet.set_state(self.interface.state);
        packet.set_quality(self.interface.quality);
        packet.set_measurement_period_s(self.interface.measurement_period_s);
        packet.set_command_period_s(self.interface.command_period_s);
        packet.set_safety_limits(self.interface.safety_limits);
        packet.set_answer_rate(self.statistics.answer_rate);
        packet.set_latency_s(self.statistics.latency_s);
        packet.set_jitter_s(self.statistics.jitter_s);
        packet.set_miss_rate(self.statistics.miss_rate);
        packet.set_missed(self.statistics.missed);
        packet.set_power(self.drives.power);
        packet.set_control(self.drives.control);
        packet.set_error(self.drives.error);
        packet.set_warning(self.drives.warning);
        packet.set_temperature(&self.drives.temperature);
        packet.set_measured_position(&self.arm.measured_position);
        packet.set_measured_frame(&self.arm.measured_frame);
        packet.set_commanded_position(&self.arm.commanded_position);
        packet.set_position_offset(&self.arm.position_offset);
        packet.set_commanded_frame(&self.arm.commanded_frame);
        packet.set_frame_offset(&self.arm.frame_offset);
        packet.set_measured_torque(&self.arm.measured_torque);
        packet.set_external_torque(&self.arm.external_torque);
        packet.set_external_wrench(&self.arm.external_wrench);
        packet.set_jacobian(&self.arm.jacobian);
        packet.set_mass_matrix(&self.arm.mass_matrix);
        packet.set_gravity(&self.arm.gravity);
    }

    /// The datagram to send.
    ///
    /// # Errors
    ///
    /// [`Error::NonFinite`]: not every peer looks.
    pub fn to_bytes(&self) -> Result<[u8; LEN], Error> {
        let mut buffer = [0; LEN];
        self.emit(&mut buffer);
        MeasurementPacket::new_checked(&buffer)?;
        Ok(buffer)
    }
}
