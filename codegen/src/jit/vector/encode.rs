//! Encodes the subset of instructions that is used.
//!
//! The encodings are those of the *Intel 64 and IA-32 Architectures Software Developer's Manual*,
//! volume 2: EVEX for registers of 512 bits, VEX for 256.

#[cfg(test)]
mod tests;

/// A general-purpose register by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct General(pub(super) u8);

pub(super) const RAX: General = General(0);
pub(super) const RCX: General = General(1);
pub(super) const RDX: General = General(2);
pub(super) const RBX: General = General(3);
pub(super) const RSP: General = General(4);
pub(super) const RBP: General = General(5);
pub(super) const RSI: General = General(6);
pub(super) const RDI: General = General(7);
pub(super) const R8: General = General(8);
pub(super) const R9: General = General(9);
pub(super) const R10: General = General(10);
pub(super) const R11: General = General(11);
pub(super) const R12: General = General(12);
pub(super) const R13: General = General(13);
pub(super) const R14: General = General(14);
pub(super) const R15: General = General(15);

/// Width of the vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Width {
    /// 256 bits, four numbers, 16 registers.
    Ymm,
    /// 512 bits, eight numbers, 32 registers.
    Zmm,
}

/// A register or memory operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// A vector register.
    Vector(u8),
    /// Memory at a displacement from an address.
    At(General, i32),
    /// A constant after the code, by its index.
    Constant(u32),
}

/// Operations on vectors of doubles: the map of opcodes, the opcode, and the bit W.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Opcode(u8, u8, bool);

const MAP_0F: u8 = 1;
const MAP_0F38: u8 = 2;
const MAP_0F3A: u8 = 3;

impl Opcode {
    pub(super) const LOAD: Self = Self(MAP_0F, 0x10, true);
    pub(super) const STORE: Self = Self(MAP_0F, 0x11, true);
    pub(super) const SQRT: Self = Self(MAP_0F, 0x51, true);
    pub(super) const AND: Self = Self(MAP_0F, 0x54, true);
    pub(super) const XOR: Self = Self(MAP_0F, 0x57, true);
    pub(super) const ADD: Self = Self(MAP_0F, 0x58, true);
    pub(super) const MULTIPLY: Self = Self(MAP_0F, 0x59, true);
    pub(super) const SUBTRACT: Self = Self(MAP_0F, 0x5c, true);
    pub(super) const DIVIDE: Self = Self(MAP_0F, 0x5e, true);
    pub(super) const COMPARE: Self = Self(MAP_0F, 0xc2, true);
    /// Broadcasts one number to all lanes.
    pub(super) const SPREAD: Self = Self(MAP_0F38, 0x19, true);
    /// Blend by a mask register; AVX-512.
    pub(super) const BLEND: Self = Self(MAP_0F38, 0x65, true);
    /// Blend by the signs of a vector; AVX.
    pub(super) const BLEND_BY_SIGN: Self = Self(MAP_0F3A, 0x4b, false);
}

/// Optional operands of an instruction.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Options {
    /// The first source; 0 if there is none.
    pub(super) first: u8,
    /// The mask register; 0 for none.
    pub(super) mask: u8,
    /// The immediate byte.
    pub(super) immediate: Option<u8>,
}

/// Machine code under construction.
#[derive(Debug, Default)]
pub(super) struct Code {
    pub(super) bytes: Vec<u8>,
    /// Displacements of constants: offset of the field, end of the instruction, index of the constant.
    distances: Vec<(usize, usize, u32)>,
}

/// Scale of a displacement of one byte, in bytes.
type Unit = i32;

impl Code {
    /// An operation on vectors with destination `register`, the options, and operand `place`.
    pub(super) fn vector(
        &mut self,
        width: Width,
        opcode: Opcode,
        register: u8,
        place: Place,
        options: Options,
    ) {
        let unit = match width {
            Width::Ymm => self.vex(opcode, register, place, options),
            Width::Zmm => self.evex(opcode, register, place, options),
        };
        self.bytes.push(opcode.1);
        self.place(register, place, unit, options.immediate);
    }

    fn vex(
        &mut self,
        Opcode(map, _, wide): Opcode,
        register: u8,
        place: Place,
        o: Options,
    ) -> Unit {
        let base = match place {
            Place::Vector(number) | Place::At(General(number), _) => number,
            Place::Constant(_) => 0,
        };
        // Unless it selects an operation, W is ignored, and assemblers leave it 0.
        let wide = wide && !matches!(map, MAP_0F | MAP_0F38);
        let sources = bits(!o.first & 15, 3) | 1 << 2 | 1;
        if map == MAP_0F && base < 8 {
            self.bytes.extend([0xc5, inverse(register, 3, 7) | sources]);
        } else {
            let first = inverse(register, 3, 7) | 1 << 6 | inverse(base, 3, 5) | map;
            let second = u8::from(wide) << 7 | sources;
            self.bytes.extend([0xc4, first, second]);
        }
        1
    }

    fn evex(&mut self, opcode: Opcode, register: u8, place: Place, o: Options) -> Unit {
        let Opcode(map, _, wide) = opcode;
        // A register number has five bits; a base register has four.
        let base = match place {
            Place::Vector(number) => inverse(number, 4, 6) | inverse(number, 3, 5),
            Place::At(General(number), _) => 1 << 6 | inverse(number, 3, 5),
            Place::Constant(_) => 1 << 6 | 1 << 5,
        };
        // A constant is broadcast to all lanes.
        let spreads = matches!(place, Place::Constant(_)) && opcode != Opcode::SPREAD;
        let first = inverse(register, 3, 7) | base | inverse(register, 4, 4) | map;
        let second = u8::from(wide) << 7 | bits(!o.first & 15, 3) | 1 << 2 | 1;
        let third = 0b10 << 5 | u8::from(spreads) << 4 | inverse(o.first, 4, 3) | o.mask;
        self.bytes.extend([0x62, first, second, third]);
        if spreads || opcode == Opcode::SPREAD {
            8
        } else {
            64
        }
    }

    /// The `ModRM` byte with SIB and displacement.
    fn place(&mut self, register: u8, place: Place, unit: Unit, immediate: Option<u8>) {
        let register = bits(register & 7, 3);
        match place {
            Place::Vector(number) => self.bytes.push(0b11 << 6 | register | number & 7),
            Place::At(General(base), distance) => self.address(register, base, distance, unit),
            Place::Constant(constant) => {
                self.bytes.push(register | 0b101);
                let start = self.bytes.len();
                self.bytes.extend([0; 4]);
                let end = self.bytes.len() + usize::from(immediate.is_some());
                self.distances.push((start, end, constant));
            }
        }
        self.bytes.extend(immediate);
    }

    fn address(&mut self, register: u8, base: u8, distance: i32, unit: Unit) {
        // Without a displacement, base 5 would denote another addressing mode.
        let short = (distance % unit == 0)
            .then(|| i8::try_from(distance / unit).ok())
            .flatten();
        let mode = match short {
            Some(0) if base & 7 != 5 => 0b00,
            Some(_) => 0b01,
            None => 0b10,
        };
        self.bytes.push(mode << 6 | register | base & 7);
        if base & 7 == 4 {
            self.bytes.push(0x24);
        }
        match (mode, short) {
            (0b00, _) => {}
            (_, Some(short)) => self.bytes.extend(short.to_le_bytes()),
            (_, None) => self.bytes.extend(distance.to_le_bytes()),
        }
    }

    /// An instruction on a 64-bit general-purpose register and memory.
    fn general(&mut self, opcode: u8, register: General, base: General, distance: i32) {
        let prefix = 0x48 | (register.0 >> 3) << 2 | base.0 >> 3;
        self.bytes.extend([prefix, opcode]);
        self.address(bits(register.0 & 7, 3), base.0, distance, 1);
    }

    pub(super) fn load(&mut self, to: General, base: General, distance: i32) {
        self.general(0x8b, to, base, distance);
    }

    pub(super) fn store(&mut self, from: General, base: General, distance: i32) {
        self.general(0x89, from, base, distance);
    }

    /// Loads an address.
    pub(super) fn address_of(&mut self, to: General, base: General, distance: i32) {
        self.general(0x8d, to, base, distance);
    }

    /// Loads the address of a constant.
    pub(super) fn address_of_constant(&mut self, to: General, constant: u32) {
        self.bytes.extend([0x48 | (to.0 >> 3) << 2, 0x8d]);
        self.place(to.0, Place::Constant(constant), 1, None);
    }

    pub(super) fn copy(&mut self, to: General, from: General) {
        let prefix = 0x48 | (from.0 >> 3) << 2 | to.0 >> 3;
        let registers = 0b11 << 6 | bits(from.0 & 7, 3) | to.0 & 7;
        self.bytes.extend([prefix, 0x89, registers]);
    }

    pub(super) fn push(&mut self, register: General) {
        if register.0 > 7 {
            self.bytes.push(0x41);
        }
        self.bytes.push(0x50 | register.0 & 7);
    }

    pub(super) fn pop(&mut self, register: General) {
        if register.0 > 7 {
            self.bytes.push(0x41);
        }
        self.bytes.push(0x58 | register.0 & 7);
    }

    /// Loads a number into a register.
    pub(super) fn number(&mut self, to: General, number: u64) {
        self.bytes.extend([0x48 | to.0 >> 3, 0xb8 | to.0 & 7]);
        self.bytes.extend(number.to_le_bytes());
    }

    pub(super) fn call(&mut self, address: General) {
        if address.0 > 7 {
            self.bytes.push(0x41);
        }
        self.bytes.extend([0xff, 0xd0 | address.0 & 7]);
    }

    /// Lowers the stack pointer by a number of bytes, aligned to 64.
    pub(super) fn frame(&mut self, bytes: i32) {
        // sub rsp, bytes
        self.bytes.extend([0x48, 0x81, 0xec]);
        self.bytes.extend(bytes.to_le_bytes());
        // and rsp, -64
        self.bytes.extend([0x48, 0x83, 0xe4, 0xc0]);
    }

    /// Marks the upper halves of the registers as unused (`vzeroupper`), without which other code may run
    /// slower.
    pub(super) fn clear_upper_halves(&mut self) {
        self.bytes.extend([0xc5, 0xf8, 0x77]);
    }

    pub(super) fn leave(&mut self) {
        self.bytes.push(0xc9);
    }

    pub(super) fn end(&mut self) {
        self.bytes.push(0xc3);
    }

    /// Appends the constants, each repeated `repeated` times; this completes the code.
    pub(super) fn constants(&mut self, constants: &[u64], repeated: usize) {
        let stride = repeated * size_of::<u64>();
        self.bytes
            .resize(self.bytes.len().next_multiple_of(64), 0xcc);
        let start = self.bytes.len();
        for constant in constants {
            self.bytes.extend(constant.to_le_bytes().repeat(repeated));
        }
        for (place, end, constant) in self.distances.drain(..) {
            let distance = start + constant as usize * stride - end;
            // The checked limits keep the code far below two gibibytes.
            let distance = i32::try_from(distance).unwrap_or(i32::MAX);
            self.bytes[place..place + 4].copy_from_slice(&distance.to_le_bytes());
        }
    }
}

/// A number shifted to a bit position.
fn bits(number: u8, place: u8) -> u8 {
    number << place
}

/// One bit of a number, inverted, at another position.
fn inverse(number: u8, bit: u8, place: u8) -> u8 {
    (!number >> bit & 1) << place
}
