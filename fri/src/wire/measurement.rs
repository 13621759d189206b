//! The measurement (MSR), KRC to PC: 916 bytes, once per cycle.
//!
//! What the quantities mean is said at the parts of [`Msr`](super::Msr).

use super::bytes;
use super::field::{check_len, check_values};
use super::{Cartesian, ControlScheme, Error, Frame, JOINTS, Jacobian, Joints, Quality, State};

pub mod field;

/// Length of a measurement \[byte\].
pub const LEN: usize = 916;
/// The same as its size field says it.
pub const SIZE: u16 = 916;
/// Id of a measurement of interface version 1.0.
pub const ID: u16 = 0x2006;

/// View of a measurement over a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeasurementPacket<T> {
    buffer: T,
}

impl<T: AsRef<[u8]>> MeasurementPacket<T> {
    /// A view without any check: to write a datagram, or to look at a bad one.
    pub const fn new_unchecked(buffer: T) -> Self {
        Self { buffer }
    }

    /// A view of a datagram that [`check`](Self::check) accepts.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong.
    pub fn new_checked(buffer: T) -> Result<Self, Error> {
        let packet = Self::new_unchecked(buffer);
        packet.check()?;
        Ok(packet)
    }

    /// All checks: length, header, values.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), Error> {
        self.check_len()?;
        self.check_header()?;
        self.check_values()
    }

    /// The buffer has exactly [`LEN`] bytes.
    ///
    /// # Errors
    ///
    /// [`Error::Length`]
    pub fn check_len(&self) -> Result<(), Error> {
        check_len(self.buffer.as_ref(), LEN)
    }

    /// The header has the size [`SIZE`] and the id [`ID`].
    ///
    /// # Errors
    ///
    /// [`Error::Size`], [`Error::Id`]
    pub fn check_header(&self) -> Result<(), Error> {
        let (size, id) = (self.packet_size(), self.datagram_id());
        if size != SIZE {
            return Err(Error::Size {
                value: size,
                expected: SIZE,
            });
        }
        if id != ID {
            return Err(Error::Id {
                value: id,
                expected: ID,
            });
        }
        Ok(())
    }

    /// Every code has a meaning and every real is finite.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`], [`Error::NonFinite`]
    pub fn check_values(&self) -> Result<(), Error> {
        check_values(self.buffer.as_ref(), &field::ALL)
    }

    /// Gives the buffer back.
    pub fn into_inner(self) -> T {
        self.buffer
    }

    /// The sender's own counter.
    #[must_use]
    pub fn sequence(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::SEND_SEQ)
    }

    /// The counter of the peer's datagram this one reflects, 0 before the first.
    #[must_use]
    pub fn reflected(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::REFL_SEQ)
    }

    /// The size field \[byte\].
    #[must_use]
    pub fn packet_size(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::PACKET_SIZE)
    }

    /// The id field.
    #[must_use]
    pub fn datagram_id(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::DATAGRAM_ID)
    }

    /// Reals of the user data.
    #[must_use]
    pub fn reals(&self) -> [f32; 16] {
        bytes::f32s(self.buffer.as_ref(), field::REAL)
    }

    /// Integers of the user data.
    #[must_use]
    pub fn ints(&self) -> [i32; 16] {
        bytes::i32s(self.buffer.as_ref(), field::INT)
    }

    /// Booleans of the user data, bit i is index i.
    #[must_use]
    pub fn bools(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::BOOL)
    }

    /// Controller time \[s\].
    #[must_use]
    pub fn timestamp_s(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::TIMESTAMP)
    }

    /// State of the interface.
    #[must_use]
    pub fn state(&self) -> State {
        State::from_raw(bytes::u16(self.buffer.as_ref(), field::STATE)).unwrap_or_default()
    }

    /// Quality of the link.
    #[must_use]
    pub fn quality(&self) -> Quality {
        Quality::from_raw(bytes::u16(self.buffer.as_ref(), field::QUALITY)).unwrap_or_default()
    }

    /// Configured period of measurements \[s\].
    #[must_use]
    pub fn measurement_period_s(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::MSR_PERIOD)
    }

    /// Configured period of expected commands \[s\].
    #[must_use]
    pub fn command_period_s(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::CMD_PERIOD)
    }

    /// Configured safety limits; scale not documented.
    #[must_use]
    pub fn safety_limits(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::SAFETY_LIMITS)
    }

    /// Mean rate of answers, ideal 1.
    #[must_use]
    pub fn answer_rate(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::ANSWER_RATE)
    }

    /// Mean latency of answers \[s\].
    #[must_use]
    pub fn latency_s(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::LATENCY)
    }

    /// Mean jitter of answers \[s\].
    #[must_use]
    pub fn jitter_s(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::JITTER)
    }

    /// Mean rate of missed answers, ideal 0.
    #[must_use]
    pub fn miss_rate(&self) -> f32 {
        bytes::f32(self.buffer.as_ref(), field::MISS_RATE)
    }

    /// Answers missed in all.
    #[must_use]
    pub fn missed(&self) -> u32 {
        bytes::u32(self.buffer.as_ref(), field::MISSED)
    }

    /// Drive power bits; any bit set reads as on.
    #[must_use]
    pub fn power(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::POWER)
    }

    /// Control scheme that is active.
    #[must_use]
    pub fn control(&self) -> ControlScheme {
        ControlScheme::from_raw(bytes::u16(self.buffer.as_ref(), field::CONTROL))
            .unwrap_or_default()
    }

    /// Drive error bits.
    #[must_use]
    pub fn error(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::ERROR)
    }

    /// Drive warning bits.
    #[must_use]
    pub fn warning(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::WARNING)
    }

    /// Drive temperatures.
    #[must_use]
    pub fn temperature(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::TEMPERATURE)
    }

    /// Measured joint angles \[rad\].
    #[must_use]
    pub fn measured_position(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::MSR_JNT_POS)
    }

    /// Measured tool frame \[m\].
    #[must_use]
    pub fn measured_frame(&self) -> Frame {
        Frame(bytes::rows(self.buffer.as_ref(), field::MSR_CART_POS))
    }

    /// Joint angles the KRC commands before FRI \[rad\].
    #[must_use]
    pub fn commanded_position(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::CMD_JNT_POS)
    }

    /// What FRI adds to the commanded angles \[rad\].
    #[must_use]
    pub fn position_offset(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::CMD_JNT_POS_FRI_OFFSET)
    }

    /// Frame the KRC commands before FRI \[m\].
    #[must_use]
    pub fn commanded_frame(&self) -> Frame {
        Frame(bytes::rows(self.buffer.as_ref(), field::CMD_CART_POS))
    }

    /// Frame part due to FRI \[m\].
    #[must_use]
    pub fn frame_offset(&self) -> Frame {
        Frame(bytes::rows(
            self.buffer.as_ref(),
            field::CMD_CART_POS_FRI_OFFSET,
        ))
    }

    /// Torque of the joint sensors \[Nm\].
    #[must_use]
    pub fn measured_torque(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::MSR_JNT_TRQ)
    }

    /// Estimated external joint torque \[Nm\].
    #[must_use]
    pub fn external_torque(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::EST_EXT_JNT_TRQ)
    }

    /// Estimated external wrench at the tool \[N, Nm\].
    #[must_use]
    pub fn external_wrench(&self) -> Cartesian {
        Cartesian(bytes::f32s(self.buffer.as_ref(), field::EST_EXT_TCP_FT))
    }

    /// Geometric Jacobian of the tool.
    #[must_use]
    pub fn jacobian(&self) -> Jacobian {
        Jacobian(bytes::rows(self.buffer.as_ref(), field::JACOBIAN))
    }

    /// Mass matrix \[kg m2\].
    #[must_use]
    pub fn mass_matrix(&self) -> [Joints; JOINTS] {
        bytes::rows(self.buffer.as_ref(), field::MASS_MATRIX)
    }

    /// Gravity vector.
    #[must_use]
    pub fn gravity(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::GRAVITY)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> MeasurementPacket<T> {
    /// Writes what makes the bytes a measurement: size, id and a fill of zero.
    pub fn set_format(&mut self) {
        bytes::set_u16(self.buffer.as_mut(), field::PACKET_SIZE, SIZE);
        bytes::set_u16(self.buffer.as_mut(), field::DATAGRAM_ID, ID);
        bytes::set_u16(self.buffer.as_mut(), field::FILL, 0);
    }

    /// The sender's own counter.
    pub fn set_sequence(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::SEND_SEQ, value);
    }

    /// The counter of the peer's datagram this one reflects, 0 before the first.
    pub fn set_reflected(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::REFL_SEQ, value);
    }

    /// Reals of the user data.
    pub fn set_reals(&mut self, value: &[f32; 16]) {
        bytes::set_f32s(self.buffer.as_mut(), field::REAL, value);
    }

    /// Integers of the user data.
    pub fn set_ints(&mut self, value: &[i32; 16]) {
        bytes::set_i32s(self.buffer.as_mut(), field::INT, value);
    }

    /// Booleans of the user data, bit i is index i.
    pub fn set_bools(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::BOOL, value);
    }

    /// Controller time \[s\].
    pub fn set_timestamp_s(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::TIMESTAMP, value);
    }

    /// State of the interface.
    pub fn set_state(&mut self, value: State) {
        bytes::set_u16(self.buffer.as_mut(), field::STATE, value.raw());
    }

    /// Quality of the link.
    pub fn set_quality(&mut self, value: Quality) {
        bytes::set_u16(self.buffer.as_mut(), field::QUALITY, value.raw());
    }

    /// Configured period of measurements \[s\].
    pub fn set_measurement_period_s(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::MSR_PERIOD, value);
    }

    /// Configured period of expected commands \[s\].
    pub fn set_command_period_s(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::CMD_PERIOD, value);
    }

    /// Configured safety limits; scale not documented.
    pub fn set_safety_limits(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::SAFETY_LIMITS, value);
    }

    /// Mean rate of answers, ideal 1.
    pub fn set_answer_rate(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::ANSWER_RATE, value);
    }

    /// Mean latency of answers \[s\].
    pub fn set_latency_s(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::LATENCY, value);
    }

    /// Mean jitter of answers \[s\].
    pub fn set_jitter_s(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::JITTER, value);
    }

    /// Mean rate of missed answers, ideal 0.
    pub fn set_miss_rate(&mut self, value: f32) {
        bytes::set_f32(self.buffer.as_mut(), field::MISS_RATE, value);
    }

    /// Answers missed in all.
    pub fn set_missed(&mut self, value: u32) {
        bytes::set_u32(self.buffer.as_mut(), field::MISSED, value);
    }

    /// Drive power bits; any bit set reads as on.
    pub fn set_power(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::POWER, value);
    }

    /// Control scheme that is active.
    pub fn set_control(&mut self, value: ControlScheme) {
        bytes::set_u16(self.buffer.as_mut(), field::CONTROL, value.raw());
    }

    /// Drive error bits.
    pub fn set_error(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::ERROR, value);
    }

    /// Drive warning bits.
    pub fn set_warning(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::WARNING, value);
    }

    /// Drive temperatures.
    pub fn set_temperature(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::TEMPERATURE, value);
    }

    /// Measured joint angles \[rad\].
    pub fn set_measured_position(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::MSR_JNT_POS, value);
    }

    /// Measured tool frame \[m\].
    pub fn set_measured_frame(&mut self, value: &Frame) {
        bytes::set_f32s(
            self.buffer.as_mut(),
            field::MSR_CART_POS,
            value.0.as_flattened(),
        );
    }

    /// Joint angles the KRC commands before FRI \[rad\].
    pub fn set_commanded_position(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::CMD_JNT_POS, value);
    }

    /// What FRI adds to the commanded angles \[rad\].
    pub fn set_position_offset(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::CMD_JNT_POS_FRI_OFFSET, value);
    }

    /// Frame the KRC commands before FRI \[m\].
    pub fn set_commanded_frame(&mut self, value: &Frame) {
        bytes::set_f32s(
            self.buffer.as_mut(),
            field::CMD_CART_POS,
            value.0.as_flattened(),
        );
    }

    /// Frame part due to FRI \[m\].
    pub fn set_frame_offset(&mut self, value: &Frame) {
        bytes::set_f32s(
            self.buffer.as_mut(),
            field::CMD_CART_POS_FRI_OFFSET,
            value.0.as_flattened(),
        );
    }

    /// Torque of the joint sensors \[Nm\].
    pub fn set_measured_torque(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::MSR_JNT_TRQ, value);
    }

    /// Estimated external joint torque \[Nm\].
    pub fn set_external_torque(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::EST_EXT_JNT_TRQ, value);
    }

    /// Estimated external wrench at the tool \[N, Nm\].
    pub fn set_external_wrench(&mut self, value: &Cartesian) {
        bytes::set_f32s(self.buffer.as_mut(), field::EST_EXT_TCP_FT, &value.0);
    }

    /// Geometric Jacobian of the tool.
    pub fn set_jacobian(&mut self, value: &Jacobian) {
        bytes::set_f32s(
            self.buffer.as_mut(),
            field::JACOBIAN,
            value.0.as_flattened(),
        );
    }

    /// Mass matrix \[kg m2\].
    pub fn set_mass_matrix(&mut self, value: &[Joints; JOINTS]) {
        bytes::set_f32s(
            self.buffer.as_mut(),
            field::MASS_MATRIX,
            value.as_flattened(),
        );
    }

    /// Gravity vector.
    pub fn set_gravity(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::GRAVITY, value);
    }
}
