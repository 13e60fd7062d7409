//! Assembles machine code.
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

use appell_codegen::jit::Elementary;
use appell_codegen::symbolic::Relation;
use appell_codegen::tape::{Argument, Operation};
use iced_x86::Register::{
    R8, R9, R10, R11, R12, R13, R14, R15, RAX, RBP, RBX, RCX, RDI, RDX, RIP, RSI, RSP,
};
use iced_x86::{Code, Encoder, IcedError, Instruction, OpKind, Register};
use rustc_hash::FxHashMap;

use super::instruction_set::InstructionSet;
use super::routines;

/// Bytes of a number.
const NUMBER: i64 = 8;
/// Bytes of eight numbers: the stride of arguments and results, and the alignment of code and frame.
const BLOCK: i64 = 64;
/// Page size of the processor.
const PAGE: i64 = 4096;
/// Offset of the callee-saved registers from the frame pointer.
const SAVED: i64 = -40;
/// Offset of the saved address of the list of results from the frame pointer.
const RESULTS: i64 = -48;
/// Callee-saved registers.
const KEPT: [Register; 5] = [RBX, R12, R13, R14, R15];
/// Registers that cache the addresses of results.
const HOLDERS: [Register; 3] = [RAX, R10, R11];

/// A block in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Memory {
    /// An argument.
    Argument(Argument),
    /// A constant, by its bits.
    Constant(u64),
    /// A block of the frame.
    Slot(u32),
}

/// The last source operand of a vector instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operand {
    /// A vector register by its number.
    Register(u8),
    Memory(Memory),
}

/// Machine code, which may lie at any multiple of 64 bytes.
#[derive(Debug, Clone)]
pub struct MachineCode {
    /// Constants, then one function.
    pub bytes: Vec<u8>,
    /// Offset of the function.
    pub entry: usize,
    /// Numbers of a block that one call evaluates.
    pub lanes: usize,
}

/// An operand of a machine instruction.
#[derive(Debug, Clone, Copy)]
enum Place {
    Register(Register),
    /// Memory at a displacement from an address; for RIP, from the start of the code.
    At(Register, i64),
    /// A constant, broadcast to all lanes.
    Broadcast(i64),
    Immediate(OpKind, u64),
}

/// Machine code under construction.
#[derive(Debug)]
pub(crate) struct Assembler {
    set: InstructionSet,
    elementary: Elementary,
    /// Whether it has calls.
    calls: bool,
    instructions: Vec<Instruction>,
    constants: Vec<u64>,
    /// Indices of the constants by their bits.
    known: FxHashMap<u64, u32>,
    /// The results whose addresses are in [`HOLDERS`].
    holders: [Option<u32>; HOLDERS.len()],
}

impl Assembler {
    pub(crate) fn new(set: InstructionSet, elementary: Elementary, calls: bool) -> Self {
        Self {
            set,
            elementary,
            calls,
            instructions: Vec::new(),
            constants: Vec::new(),
            known: FxHashMap::default(),
            holders: [None; HOLDERS.len()],
        }
    }

    /// The code with a frame of so many blocks.
    pub(crate) fn finish(mut self, slots: u32) -> Result<MachineCode, IcedError> {
        let body = std::mem::take(&mut self.instructions);
        self.start(slots);
        self.instructions.extend(body);
        self.end(slots);

        let mut bytes = Vec::new();
        for constant in &self.constants {
            bytes.extend(constant.to_le_bytes().repeat(self.set.copies.into()));
        }
        let entry = bytes.len().next_multiple_of(64);
        bytes.resize(entry, 0);
        let mut encoder = Encoder::try_new(64)?;
        encoder.set_buffer(bytes);
        let mut position = entry as u64;
        for instruction in &self.instructions {
            position += encoder.encode(instruction, position)? as u64;
        }
        Ok(MachineCode {
            bytes: encoder.take_buffer(),
            entry,
            lanes: self.set.lanes.into(),
        })
    }

    fn start(&mut self, slots: u32) {
        if !self.calls && slots == 0 {
            return;
        }
        self.general(Code::Push_r64, &[Place::Register(RBP)]);
        self.copy(RBP, RSP);
        if self.calls {
            for register in KEPT {
                self.general(Code::Push_r64, &[Place::Register(register)]);
            }
            self.general(Code::Push_r64, &[Place::Register(R9)]);
            for (kept, received) in KEPT.into_iter().zip([RDI, RSI, RDX, RCX, R8]) {
                self.copy(kept, received);
            }
        }
        let bytes = i64::from(slots) * self.slot_bytes();
        let stack = Place::Register(RSP);
        let lowered = Place::Immediate(OpKind::Immediate32to64, bytes.cast_unsigned());
        self.general(Code::Sub_rm64_imm32, &[stack, lowered]);
        let aligned = Place::Immediate(OpKind::Immediate8to64, (-BLOCK).cast_unsigned());
        self.general(Code::And_rm64_imm8, &[stack, aligned]);
        // The stack has to be touched page by page.
        for page in (0..bytes / PAGE).rev() {
            let page = Place::At(RSP, page * PAGE);
            self.general(Code::Mov_rm64_r64, &[page, Place::Register(RAX)]);
        }
    }

    fn end(&mut self, slots: u32) {
        self.general(Code::VEX_Vzeroupper, &[]);
        if self.calls {
            let saved = Place::At(RBP, SAVED);
            self.general(Code::Lea_r64_m, &[Place::Register(RSP), saved]);
            for register in KEPT.into_iter().rev().chain([RBP]) {
                self.general(Code::Pop_r64, &[Place::Register(register)]);
            }
        } else if slots > 0 {
            self.general(Code::Leaveq, &[]);
        }
        self.general(Code::Retnq, &[]);
    }

    pub(crate) fn load(&mut self, to: u8, from: Memory) {
        let code = match from {
            Memory::Constant(_) => self.set.load_constant,
            _ => self.set.load,
        };
        // The instruction is itself a broadcast.
        let from = match self.memory(from) {
            Place::Broadcast(displacement) => Place::At(RIP, displacement),
            place => place,
        };
        self.general(code, &[self.vector(to), from]);
    }

    /// Stores a register to a block of the frame.
    pub(crate) fn keep(&mut self, slot: u32, from: u8) {
        let to = self.memory(Memory::Slot(slot));
        self.general(self.set.store, &[to, self.vector(from)]);
    }

    /// Stores a register to an entry of a result.
    pub(crate) fn store(&mut self, result: u32, entry: u32, from: u8) {
        let to = Place::At(self.result(result), i64::from(entry) * BLOCK);
        self.general(self.set.store, &[to, self.vector(from)]);
    }

    pub(crate) fn binary(&mut self, code: Code, to: u8, left: u8, right: Operand) {
        let right = self.operand(right);
        self.general(code, &[self.vector(to), self.vector(left), right]);
    }

    pub(crate) fn square_root(&mut self, to: u8, of: Operand) {
        let of = self.operand(of);
        self.general(self.set.square_root, &[self.vector(to), of]);
    }

    /// Compares into the mask; `right` is the left side of the relation if `swapped`.
    pub(crate) fn compare(&mut self, relation: Relation, swapped: bool, left: u8, right: Operand) {
        // False for NaN, quiet.
        let predicate = match (relation, swapped) {
            (Relation::Less, false) => 0x11,
            (Relation::LessOrEqual, false) => 0x12,
            (Relation::Less, true) => 0x1e,
            (Relation::LessOrEqual, true) => 0x1d,
        };
        let right = self.operand(right);
        let operands = [
            Place::Register(self.set.mask),
            self.vector(left),
            right,
            Place::Immediate(OpKind::Immediate8, predicate),
        ];
        self.general(self.set.compare, &operands);
    }

    /// `then` where the mask is set.
    pub(crate) fn select(&mut self, to: u8, then: Operand, otherwise: u8) {
        let then = self.operand(then);
        let operands = [
            self.vector(to),
            self.vector(otherwise),
            then,
            Place::Register(self.set.mask),
        ];
        if self.set.mask == Register::K1 {
            let mut instruction = instruction(self.set.select, &operands[..3]);
            instruction.set_op_mask(self.set.mask);
            self.instructions.push(instruction);
        } else {
            self.general(self.set.select, &operands);
        }
    }

    /// Calls a routine with the addresses of its operands and of its results. All vector registers are
    /// clobbered.
    pub(crate) fn call(&mut self, call: &Operation, given: &[Memory], results: u32) {
        let operands = [RDI, RSI].into_iter().zip(given.iter().copied());
        for (register, memory) in operands.chain([(RDX, Memory::Slot(results))]) {
            let address = self.memory(memory);
            self.general(Code::Lea_r64_m, &[Place::Register(register), address]);
        }
        if let Operation::Solve { right, .. } = call {
            self.number(RCX, right.len() as u64);
        }
        let address = routines::address(call, self.elementary, self.set.lanes);
        self.number(RAX, address as u64);
        self.general(Code::VEX_Vzeroupper, &[]);
        self.general(Code::Call_rm64, &[Place::Register(RAX)]);
        self.holders = [None; HOLDERS.len()];
    }

    fn general(&mut self, code: Code, operands: &[Place]) {
        self.instructions.push(instruction(code, operands));
    }

    fn copy(&mut self, to: Register, from: Register) {
        let operands = [to, from].map(Place::Register);
        self.general(Code::Mov_r64_rm64, &operands);
    }

    fn number(&mut self, to: Register, number: u64) {
        let number = Place::Immediate(OpKind::Immediate64, number);
        self.general(Code::Mov_r64_imm64, &[Place::Register(to), number]);
    }

    fn vector(&self, number: u8) -> Place {
        Place::Register(self.set.first + u32::from(number))
    }

    fn operand(&mut self, operand: Operand) -> Place {
        match operand {
            Operand::Register(number) => self.vector(number),
            Operand::Memory(memory) => self.memory(memory),
        }
    }

    fn memory(&mut self, memory: Memory) -> Place {
        match memory {
            Memory::Argument(argument) => self.argument(argument),
            Memory::Constant(bits) => {
                let copies = i64::from(self.set.copies);
                let next = u32::try_from(self.constants.len()).unwrap_or(u32::MAX);
                let index = *self.known.entry(bits).or_insert(next);
                if index == next {
                    self.constants.push(bits);
                }
                let displacement = i64::from(index) * copies * NUMBER;
                if copies == 1 {
                    Place::Broadcast(displacement)
                } else {
                    Place::At(RIP, displacement)
                }
            }
            Memory::Slot(slot) => Place::At(RSP, i64::from(slot) * self.slot_bytes()),
        }
    }

    fn slot_bytes(&self) -> i64 {
        i64::from(self.set.lanes) * NUMBER
    }

    fn argument(&self, argument: Argument) -> Place {
        let (received, kept, index) = match argument {
            Argument::Time => (RDI, RBX, 0),
            Argument::State(index) => (RSI, R12, index),
            Argument::Input(index) => (RDX, R13, index),
            Argument::Parameter(index) => (RCX, R14, index),
            Argument::Weight(index)
            | Argument::OutputWeight(index)
            | Argument::Acceleration(index) => (R8, R15, index),
        };
        let base = if self.calls { kept } else { received };
        Place::At(base, i64::from(index) * BLOCK)
    }

    /// A register with the address of a result.
    fn result(&mut self, result: u32) -> Register {
        let place = result as usize % HOLDERS.len();
        let holder = HOLDERS[place];
        if self.holders[place] != Some(result) {
            self.holders[place] = Some(result);
            let list = if self.calls {
                let saved = [Place::Register(holder), Place::At(RBP, RESULTS)];
                self.general(Code::Mov_r64_rm64, &saved);
                holder
            } else {
                R9
            };
            let address = Place::At(list, i64::from(result) * NUMBER);
            self.general(Code::Mov_r64_rm64, &[Place::Register(holder), address]);
        }
        holder
    }
}

fn instruction(code: Code, operands: &[Place]) -> Instruction {
    let mut instruction = Instruction::default();
    instruction.set_code(code);
    for (position, operand) in (0..).zip(operands) {
        match *operand {
            Place::Register(register) => {
                instruction.set_op_kind(position, OpKind::Register);
                instruction.set_op_register(position, register);
            }
            Place::At(base, displacement) => {
                instruction.set_op_kind(position, OpKind::Memory);
                instruction.set_memory_base(base);
                instruction.set_memory_displacement64(displacement.cast_unsigned());
                // As short as possible.
                instruction.set_memory_displ_size(u32::from(displacement != 0));
            }
            Place::Broadcast(displacement) => {
                instruction.set_op_kind(position, OpKind::Memory);
                instruction.set_memory_base(RIP);
                instruction.set_memory_displacement64(displacement.cast_unsigned());
                instruction.set_is_broadcast(true);
            }
            Place::Immediate(kind, number) => {
                instruction.set_op_kind(position, kind);
                instruction.set_immediate_u64(position, number);
            }
        }
    }
    instruction
}
