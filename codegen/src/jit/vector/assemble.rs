//! Assembles instructions to machine code.
//!
//! The function receives the addresses of time, states, inputs, parameters, weights and of a list with the
//! address of each result, in the System V convention. A function with calls keeps them in callee-saved
//! registers:
//!
//! ```text
//! rbp        saved rbp
//! rbp - 40   rbx, r12 .. r15
//! rbp - 48   address of the list of results
//! rsp        blocks, at a multiple of 64
//! ```

use rustc_hash::FxHashMap;

use super::super::elementary::Elementary;
use super::encode::{
    Code, General, Opcode, Options, Place, R8, R9, R10, R11, R12, R13, R14, R15, RAX, RBP, RBX,
    RCX, RDI, RDX, RSI, RSP, Width,
};
use super::instruction::{Instruction, Memory, Operand, Register};
use super::line::{Array, Binary, Routine};
use super::registers::Allocated;
use super::routines;
use crate::symbolic::Relation;
use crate::tape::Arithmetic;

/// Bytes of eight numbers: the stride of arguments and results.
const BLOCK: i32 = 64;
/// Page size of the processor.
const PAGE: i32 = 4096;
/// Offset of the saved address of the list of results from the frame pointer.
const RESULTS: i32 = -48;
/// Callee-saved registers.
const KEPT: [General; 5] = [RBX, R12, R13, R14, R15];
/// Registers that cache the addresses of results.
const HOLDERS: [General; 3] = [RAX, R10, R11];
/// The mask register for vectors of 256 bits.
const MASK: u8 = 15;

impl Width {
    /// Registers for values.
    pub(super) fn registers(self) -> u8 {
        match self {
            Self::Ymm => MASK,
            Self::Zmm => 32,
        }
    }

    /// Numbers in a register.
    pub(super) fn lanes(self) -> usize {
        match self {
            Self::Ymm => 4,
            Self::Zmm => 8,
        }
    }

    fn bytes(self) -> i32 {
        match self {
            Self::Ymm => 32,
            Self::Zmm => 64,
        }
    }
}

/// The machine code of a function.
pub(super) fn assemble(allocated: &Allocated, width: Width, elementary: Elementary) -> Vec<u8> {
    let is_call = |instruction: &Instruction| matches!(instruction, Instruction::Call { .. });
    let mut assembler = Assembler {
        code: Code::default(),
        width,
        elementary,
        calls: allocated.instructions.iter().any(is_call),
        slots: allocated.slots,
        constants: Vec::new(),
        known: FxHashMap::default(),
        holders: [None; HOLDERS.len()],
    };
    assembler.start();
    for instruction in &allocated.instructions {
        assembler.instruction(instruction);
    }
    assembler.end();
    let Assembler {
        mut code,
        constants,
        ..
    } = assembler;
    // Only wide instructions can broadcast a number to all lanes.
    let repeated = match width {
        Width::Ymm => 4,
        Width::Zmm => 1,
    };
    code.constants(&constants, repeated);
    code.bytes
}

struct Assembler {
    code: Code,
    width: Width,
    elementary: Elementary,
    /// Whether it has calls.
    calls: bool,
    /// Blocks of the frame.
    slots: u32,
    constants: Vec<u64>,
    /// Indices of the constants by their bits.
    known: FxHashMap<u64, u32>,
    /// The results whose addresses are in [`HOLDERS`].
    holders: [Option<u32>; HOLDERS.len()],
}

impl Assembler {
    fn has_frame(&self) -> bool {
        self.calls || self.slots > 0
    }

    fn start(&mut self) {
        if !self.has_frame() {
            return;
        }
        self.code.push(RBP);
        self.code.copy(RBP, RSP);
        if self.calls {
            for register in KEPT {
                self.code.push(register);
            }
            self.code.push(R9);
            let received = [RDI, RSI, RDX, RCX, R8];
            for (kept, received) in KEPT.into_iter().zip(received) {
                self.code.copy(kept, received);
            }
        }
        let bytes = distance(self.slots, self.width.bytes());
        self.code.frame(bytes);
        // The stack has to be touched page by page.
        for page in (0..bytes / PAGE).rev() {
            self.code.store(RAX, RSP, page * PAGE);
        }
    }

    fn end(&mut self) {
        self.code.clear_upper_halves();
        if self.calls {
            let saved = i32::try_from(KEPT.len() * 8).unwrap_or(0);
            self.code.address_of(RSP, RBP, -saved);
            for register in KEPT.into_iter().rev() {
                self.code.pop(register);
            }
            self.code.pop(RBP);
        } else if self.has_frame() {
            self.code.leave();
        }
        self.code.end();
    }

    fn instruction(&mut self, instruction: &Instruction) {
        match instruction {
            Instruction::Load { to, from } => self.load(*to, *from),
            Instruction::Keep { slot, from } => {
                let to = self.slot(*slot);
                self.vector(Opcode::STORE, *from, to, Options::default());
            }
            Instruction::Store {
                result,
                entry,
                from,
            } => {
                let to = Place::At(self.result(*result), distance(*entry, BLOCK));
                self.vector(Opcode::STORE, *from, to, Options::default());
            }
            Instruction::Binary {
                operation,
                to,
                left,
                right,
            } => {
                let right = self.operand(*right);
                let first = left.0;
                let options = Options {
                    first,
                    ..Options::default()
                };
                self.vector(opcode(*operation), *to, right, options);
            }
            Instruction::Sqrt { to, of } => {
                let of = self.operand(*of);
                self.vector(Opcode::SQRT, *to, of, Options::default());
            }
            Instruction::Compare {
                relation,
                swapped,
                left,
                right,
            } => self.compare(predicate(*relation, *swapped), *left, *right),
            Instruction::Select {
                to,
                then,
                otherwise,
            } => self.select(*to, *then, *otherwise),
            Instruction::Call {
                routine,
                given,
                results,
            } => self.call(*routine, given, *results),
        }
    }

    fn vector(&mut self, opcode: Opcode, register: Register, place: Place, options: Options) {
        self.code
            .vector(self.width, opcode, register.0, place, options);
    }

    fn load(&mut self, to: Register, from: Memory) {
        let opcode = match (self.width, from) {
            (Width::Zmm, Memory::Constant(_)) => Opcode::SPREAD,
            _ => Opcode::LOAD,
        };
        let from = self.memory(from);
        self.vector(opcode, to, from, Options::default());
    }

    fn compare(&mut self, predicate: u8, left: Register, right: Operand) {
        let right = self.operand(right);
        let options = Options {
            first: left.0,
            immediate: Some(predicate),
            ..Options::default()
        };
        let mask = match self.width {
            Width::Ymm => MASK,
            Width::Zmm => 1,
        };
        self.vector(Opcode::COMPARE, Register(mask), right, options);
    }

    fn select(&mut self, to: Register, then: Operand, otherwise: Register) {
        let then = self.operand(then);
        let first = otherwise.0;
        let (opcode, mask, immediate) = match self.width {
            Width::Ymm => (Opcode::BLEND_BY_SIGN, 0, Some(MASK << 4)),
            Width::Zmm => (Opcode::BLEND, 1, None),
        };
        let options = Options {
            first,
            mask,
            immediate,
        };
        self.vector(opcode, to, then, options);
    }

    fn call(&mut self, routine: Routine, given: &[Memory], results: u32) {
        let results = Memory::Slot(results);
        let addresses = given.iter().copied().chain([results]);
        for (register, memory) in [RDI, RSI, RDX].into_iter().zip(addresses) {
            match self.memory(memory) {
                Place::At(base, distance) => self.code.address_of(register, base, distance),
                Place::Constant(constant) => self.code.address_of_constant(register, constant),
                Place::Vector(_) => {}
            }
        }
        if let Routine::System(rows) = routine {
            self.code.number(RDX, rows.into());
        }
        let address = routines::address(routine, self.elementary, self.width);
        self.code.number(RAX, address as u64);
        self.code.clear_upper_halves();
        self.code.call(RAX);
        self.holders = [None; HOLDERS.len()];
    }

    fn operand(&mut self, operand: Operand) -> Place {
        match operand {
            Operand::Register(Register(number)) => Place::Vector(number),
            Operand::Memory(memory) => self.memory(memory),
        }
    }

    fn memory(&mut self, memory: Memory) -> Place {
        match memory {
            Memory::Argument(array, index) => Place::At(self.base(array), distance(index, BLOCK)),
            Memory::Constant(bits) => {
                let next = u32::try_from(self.constants.len()).unwrap_or(u32::MAX);
                let number = *self.known.entry(bits).or_insert(next);
                if number == next {
                    self.constants.push(bits);
                }
                Place::Constant(number)
            }
            Memory::Slot(slot) => self.slot(slot),
        }
    }

    fn slot(&self, slot: u32) -> Place {
        Place::At(RSP, distance(slot, self.width.bytes()))
    }

    /// The register with the address of an argument.
    fn base(&self, array: Array) -> General {
        let (received, kept) = match array {
            Array::Time => (RDI, RBX),
            Array::States => (RSI, R12),
            Array::Inputs => (RDX, R13),
            Array::Parameters => (RCX, R14),
            Array::Weights => (R8, R15),
        };
        if self.calls { kept } else { received }
    }

    /// A register with the address of a result.
    fn result(&mut self, result: u32) -> General {
        let place = result as usize % HOLDERS.len();
        let holder = HOLDERS[place];
        if self.holders[place] != Some(result) {
            self.holders[place] = Some(result);
            let list = if self.calls {
                self.code.load(holder, RBP, RESULTS);
                holder
            } else {
                R9
            };
            self.code.load(holder, list, distance(result, 8));
        }
        holder
    }
}

fn opcode(operation: Binary) -> Opcode {
    match operation {
        Binary::And => Opcode::AND,
        Binary::Xor => Opcode::XOR,
        Binary::Arithmetic(Arithmetic::Add) => Opcode::ADD,
        Binary::Arithmetic(Arithmetic::Subtract) => Opcode::SUBTRACT,
        Binary::Arithmetic(Arithmetic::Multiply) => Opcode::MULTIPLY,
        Binary::Arithmetic(Arithmetic::Divide) => Opcode::DIVIDE,
    }
}

/// The predicate of a relation: false for NaN, quiet.
fn predicate(relation: Relation, swapped: bool) -> u8 {
    match (relation, swapped) {
        (Relation::Less, false) => 0x11,
        (Relation::LessOrEqual, false) => 0x12,
        (Relation::Less, true) => 0x1e,
        (Relation::LessOrEqual, true) => 0x1d,
    }
}

/// Bytes up to an entry; the checked limits keep them within 32 bits.
fn distance(index: u32, bytes: i32) -> i32 {
    i32::try_from(index).map_or(i32::MAX, |index| index.saturating_mul(bytes))
}
