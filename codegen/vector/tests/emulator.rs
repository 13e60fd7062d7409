//! Executes machine code instruction by instruction, also that of vector units which this processor lacks,
//! and compares its results with those of the interpreter.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
// Machine code has addresses of memory and of routines.
#![allow(unsafe_code)]

use std::mem::transmute;
use std::ops::Range;

use appell_codegen::jit::{Elementary, Sizes, check};
use appell_codegen::symbolic::{Function, Rational, Relation};
use appell_codegen::tape::{
    Argument, Arithmetic, Operation, ResultArray, Tape, interpret_weighted,
};
use appell_runtime::model::At;
use appell_test_kit::Random;
use appell_vector::{Instructions, Target, machine_code};
use iced_x86::{Decoder, DecoderOptions, Instruction, Mnemonic, OpKind, Register};

use crate::jit_support::{SIZES, same};

const WEIGHTS: usize = 2;
/// Words of the stack.
const STACK: usize = 1 << 17;

type Vector = [f64; 8];

type Routine = unsafe extern "C" fn(*const f64, *const f64, *mut f64, usize);

struct Processor {
    lanes: usize,
    /// The first vector register.
    first: Register,
    /// The register with the result of a comparison.
    selector: Register,
    general: [u64; 16],
    vectors: [Vector; 32],
    mask: [bool; 8],
    /// Addresses that the code may read.
    readable: Vec<Range<u64>>,
    /// Addresses that it may read and write.
    writable: Vec<Range<u64>>,
}

/// The addresses of a slice that the code reads.
fn addresses<T>(slice: &[T]) -> Range<u64> {
    let Range { start, end } = slice.as_ptr_range();
    start.expose_provenance() as u64..end.addr() as u64
}

/// The addresses of a slice that the code writes.
fn writable_addresses<T>(slice: &mut [T]) -> Range<u64> {
    let Range { start, end } = slice.as_mut_ptr_range();
    start.expose_provenance() as u64..end.addr() as u64
}

impl Processor {
    fn general(&mut self, register: Register) -> &mut u64 {
        &mut self.general[register as usize - Register::RAX as usize]
    }

    fn set(&mut self, register: Register, vector: Vector) {
        self.vectors[register as usize - self.first as usize] = vector;
    }

    fn address(&mut self, instruction: &Instruction) -> u64 {
        let displacement = instruction.memory_displacement64();
        match instruction.memory_base() {
            Register::RIP => displacement,
            base => self.general(base).wrapping_add(displacement),
        }
    }

    fn read(&self, address: u64) -> u64 {
        let ranges = self.readable.iter().chain(&self.writable);
        let mut ranges = ranges.filter(|range| range.start <= address && address + 8 <= range.end);
        assert!(ranges.next().is_some(), "read from {address:#x}");
        // SAFETY: the slices of the ranges exist as long as the processor.
        unsafe { (address as *const u64).read_unaligned() }
    }

    fn write(&self, address: u64, word: u64) {
        let mut ranges = self.writable.iter();
        let is_writable = ranges.any(|range| range.start <= address && address + 8 <= range.end);
        assert!(is_writable, "written to {address:#x}");
        // SAFETY: the slices of the ranges exist as long as the processor, which alone uses them.
        unsafe { (address as *mut u64).write_unaligned(word) }
    }

    /// An integer operand.
    fn word(&mut self, instruction: &Instruction, operand: u32) -> u64 {
        match instruction.op_kind(operand) {
            OpKind::Register => *self.general(instruction.op_register(operand)),
            OpKind::Memory => {
                let address = self.address(instruction);
                self.read(address)
            }
            _ => instruction.immediate(operand),
        }
    }

    /// A vector operand.
    fn vector(&mut self, instruction: &Instruction, operand: u32) -> Vector {
        if instruction.op_kind(operand) == OpKind::Register {
            let register = instruction.op_register(operand);
            return self.vectors[register as usize - self.first as usize];
        }
        let address = self.address(instruction);
        let is_broadcast =
            instruction.is_broadcast() || instruction.mnemonic() == Mnemonic::Vbroadcastsd;
        let stride = if is_broadcast { 0 } else { 8 };
        let mut vector = [f64::NAN; 8];
        for (number, lane) in vector.iter_mut().zip((0..8).take(self.lanes)) {
            *number = f64::from_bits(self.read(address + stride * lane));
        }
        vector
    }

    fn binary(&mut self, instruction: &Instruction, f: impl Fn(f64, f64) -> f64) {
        let [a, b] = [1, 2].map(|operand| self.vector(instruction, operand));
        let result = std::array::from_fn(|lane| f(a[lane], b[lane]));
        self.set(instruction.op0_register(), result);
    }

    fn bitwise(&mut self, instruction: &Instruction, f: impl Fn(u64, u64) -> u64) {
        self.binary(instruction, |a, b| {
            f64::from_bits(f(a.to_bits(), b.to_bits()))
        });
    }

    fn move_vector(&mut self, instruction: &Instruction) {
        let vector = self.vector(instruction, 1);
        if instruction.op0_kind() == OpKind::Register {
            return self.set(instruction.op0_register(), vector);
        }
        let address = self.address(instruction);
        for (number, lane) in vector.iter().zip((0..8).take(self.lanes)) {
            self.write(address + 8 * lane, number.to_bits());
        }
    }

    fn compare(&mut self, instruction: &Instruction) {
        let [a, b] = [1, 2].map(|operand| self.vector(instruction, operand));
        let holds = |a: f64, b: f64| match instruction.immediate8() {
            0x11 => a < b,
            0x12 => a <= b,
            0x1e => a > b,
            0x1d => a >= b,
            other => panic!("predicate {other:#x}"),
        };
        self.mask = std::array::from_fn(|lane| holds(a[lane], b[lane]));
        assert_eq!(instruction.op0_register(), self.selector);
    }

    fn select(&mut self, instruction: &Instruction) {
        let by = match instruction.mnemonic() {
            Mnemonic::Vblendvpd => instruction.op3_register(),
            _ => instruction.op_mask(),
        };
        assert_eq!(by, self.selector);
        let [otherwise, then] = [1, 2].map(|operand| self.vector(instruction, operand));
        let mask = self.mask;
        let selected = |lane| if mask[lane] { then } else { otherwise }[lane];
        self.set(instruction.op0_register(), std::array::from_fn(selected));
    }

    fn call(&mut self, address: u64) {
        let [first, second, to, rows] = [7, 6, 2, 1].map(|register| self.general[register]);
        assert_eq!(*self.general(Register::RSP) % 16, 0);
        // SAFETY: the code passes addresses of its arguments and of its frame to routines of this type.
        unsafe {
            let routine = transmute::<*const (), Routine>(address as *const ());
            routine(
                first as *const f64,
                second as *const f64,
                to as *mut f64,
                usize::try_from(rows).unwrap(),
            );
        }
        // Only memory and callee-saved registers survive.
        self.vectors = [[f64::NAN; 8]; 32];
        self.mask = self.mask.map(|lane| !lane);
        for register in [0, 1, 2, 6, 7, 8, 9, 10, 11] {
            self.general[register] = 7;
        }
    }

    fn push(&mut self, word: u64) {
        *self.general(Register::RSP) -= 8;
        let address = *self.general(Register::RSP);
        self.write(address, word);
    }

    fn pop(&mut self) -> u64 {
        let address = *self.general(Register::RSP);
        *self.general(Register::RSP) += 8;
        self.read(address)
    }

    fn execute(&mut self, instruction: &Instruction) {
        let to = instruction.op0_register();
        match instruction.mnemonic() {
            Mnemonic::Vmovupd | Mnemonic::Vbroadcastsd => self.move_vector(instruction),
            Mnemonic::Vaddpd => self.binary(instruction, |a, b| a + b),
            Mnemonic::Vsubpd => self.binary(instruction, |a, b| a - b),
            Mnemonic::Vmulpd => self.binary(instruction, |a, b| a * b),
            Mnemonic::Vdivpd => self.binary(instruction, |a, b| a / b),
            Mnemonic::Vandpd => self.bitwise(instruction, |a, b| a & b),
            Mnemonic::Vxorpd => self.bitwise(instruction, |a, b| a ^ b),
            Mnemonic::Vsqrtpd => {
                let of = self.vector(instruction, 1);
                self.set(to, of.map(f64::sqrt));
            }
            Mnemonic::Vcmppd => self.compare(instruction),
            Mnemonic::Vblendmpd | Mnemonic::Vblendvpd => self.select(instruction),
            Mnemonic::Vzeroupper => self.vectors = [[f64::NAN; 8]; 32],
            Mnemonic::Push => {
                let word = self.word(instruction, 0);
                self.push(word);
            }
            Mnemonic::Pop => *self.general(to) = self.pop(),
            Mnemonic::Leave => {
                *self.general(Register::RSP) = *self.general(Register::RBP);
                *self.general(Register::RBP) = self.pop();
            }
            Mnemonic::Mov if instruction.op0_kind() == OpKind::Memory => {
                let (address, word) = (self.address(instruction), self.word(instruction, 1));
                self.write(address, word);
            }
            Mnemonic::Mov => *self.general(to) = self.word(instruction, 1),
            Mnemonic::Lea => *self.general(to) = self.address(instruction),
            Mnemonic::Sub => *self.general(to) -= self.word(instruction, 1),
            Mnemonic::And => *self.general(to) &= self.word(instruction, 1),
            Mnemonic::Call => {
                let address = self.word(instruction, 0);
                self.call(address);
            }
            other => panic!("{other:?}"),
        }
    }
}

/// Arguments: time, states, inputs, parameters, weights.
struct Arguments([Vec<Vector>; 5]);

impl Arguments {
    fn random(random: &mut Random) -> Self {
        let lens = [1, SIZES.states, SIZES.inputs, SIZES.parameters, WEIGHTS];
        let mut block = |_| std::array::from_fn(|_| random.between(-2.0, 2.0));
        Self(lens.map(|len| (0..len).map(&mut block).collect()))
    }

    /// The results of the interpreter in one lane.
    fn interpreted(&self, tape: &Tape, lane: usize) -> Vec<f64> {
        let of_lane = |blocks: &Vec<Vector>| blocks.iter().map(|block| block[lane]).collect();
        let [t, x, u, p, weights]: [Vec<f64>; 5] = self.0.each_ref().map(of_lane);
        let at = At {
            t: t[0],
            x: &x,
            u: &u,
            p: &p,
        };
        interpret_weighted(tape, at, &weights).concat()
    }
}

/// The results of machine code, given time, states, inputs, parameters and weights.
pub(crate) fn emulated(
    tape: &Tape,
    sizes: Sizes,
    target: Target,
    arguments: [&[Vector]; 5],
) -> Vec<Vector> {
    let checked = check(tape, sizes).unwrap();
    let code = machine_code(&checked, target).unwrap().unwrap();
    let (first, selector) = match target.instructions {
        Instructions::Avx512 => (Register::ZMM0, Register::K1),
        _ => (Register::YMM0, Register::YMM15),
    };
    let mut results: Vec<Vec<Vector>> = tape
        .lengths()
        .into_iter()
        .map(|len| vec![[7.0; 8]; len])
        .collect();
    let mut stack = vec![0_u64; STACK];
    for lane in (0..8).step_by(code.lanes) {
        let offset = 8 * lane;
        let mut writable: Vec<_> = results
            .iter_mut()
            .map(|result| writable_addresses(result))
            .collect();
        let list: Vec<u64> = writable.iter().map(|range| range.start + offset).collect();
        let mut readable = arguments.map(addresses).to_vec();
        readable.extend([addresses(&list), addresses(&code.bytes)]);
        let stack = writable_addresses(&mut stack);
        writable.push(stack.clone());

        let mut general = [7; 16];
        let [t, x, u, p, weights] = arguments.map(|of| addresses(of).start + offset);
        for (register, address) in [(7, t), (6, x), (2, u), (1, p), (8, weights)] {
            general[register] = address;
        }
        general[9] = addresses(&list).start;
        // As after a call of the function.
        general[4] = stack.end / 16 * 16 - 8;
        let mut processor = Processor {
            lanes: code.lanes,
            first,
            selector,
            general,
            vectors: [[f64::NAN; 8]; 32],
            mask: [false; 8],
            readable,
            writable,
        };
        let start = addresses(&code.bytes).start + code.entry as u64;
        let bytes = &code.bytes[code.entry..];
        let decoder = Decoder::with_ip(64, bytes, start, DecoderOptions::NONE);
        for instruction in decoder {
            if instruction.mnemonic() == Mnemonic::Ret {
                break;
            }
            processor.execute(&instruction);
        }
        for callee_saved in [3, 4, 5, 12, 13, 14, 15] {
            assert_eq!(processor.general[callee_saved], general[callee_saved]);
        }
    }
    results.concat()
}

/// A random tape of about so many operations, whose values stay finite.
fn random_tape(random: &mut Random, len: usize) -> Tape {
    let mut tape = Tape::default();
    let mut values = vec![tape.argument(Argument::State(0))];
    while values.len() < len {
        let known = values.clone();
        // Mostly recent operands.
        let any = |random: &mut Random| {
            let reach = if random.below(3) == 0 { len } else { 40 };
            known[known.len() - 1 - random.below(known.len().min(reach))]
        };
        let index = u32::try_from(random.below(2)).unwrap();
        let operation = match random.below(24) {
            0 => Operation::Argument(Argument::Input(index)),
            1 => Operation::Argument(Argument::Parameter(index)),
            2 => Operation::Argument(Argument::Weight(index)),
            3 => Operation::Argument(Argument::Time),
            4 => Operation::Constant(Rational::new(i64::from(index) + 1, 3)),
            5 => {
                let magnitude = tape.push(Operation::Function(Function::Abs, any(random)));
                Operation::Function(Function::Sqrt, magnitude)
            }
            6 => Operation::Function(Function::Sign, any(random)),
            7 => Operation::Negate(any(random)),
            8..=10 => Operation::Choice {
                relation: [Relation::Less, Relation::LessOrEqual][index as usize],
                compared: [known[known.len() / 10], known[known.len() / 20]],
                branches: [any(random), any(random)],
            },
            11 => match random.below(8) {
                0 => Operation::SinCos(any(random)),
                1 => Operation::Atan2(any(random), any(random)),
                2 => Operation::Function(Function::Tanh, any(random)),
                3 => {
                    let rows = [3, 13][index as usize];
                    let matrix = (0..rows * rows).map(|_| any(random)).collect();
                    let factorisation = tape.push(Operation::Factorise(matrix));
                    let right = (0..rows).map(|_| any(random)).collect();
                    Operation::Solve {
                        factorisation,
                        right,
                    }
                }
                _ => continue,
            },
            kind => {
                let scale = i64::try_from(random.below(9)).unwrap() + 1;
                let scale = tape.constant(Rational::new(scale, 10));
                let scaled = tape.binary(Arithmetic::Multiply, any(random), scale);
                let operation = match kind % 3 {
                    0 => Arithmetic::Add,
                    _ => Arithmetic::Subtract,
                };
                Operation::Binary(operation, scaled, any(random))
            }
        };
        let parts = operation.parts();
        let value = tape.push(operation);
        match parts {
            0 => values.push(value),
            _ => values.extend((0..).take(parts).map(|index| value.part(index))),
        }
    }
    let mut entries = (0..len / 4).map(|_| values[values.len() - 1 - random.below(len / 2)]);
    tape.results = ["a", "b", "c", "d"]
        .map(|name| ResultArray {
            name: name.to_owned(),
            entries: entries.by_ref().take(len / 16).collect(),
        })
        .into();
    tape
}

#[test]
fn machine_code_of_both_vector_units_has_the_results_of_the_interpreter() {
    for (seed, len) in (0..100).zip((40..840).step_by(20).cycle()) {
        let mut random = Random::new(seed);
        let tape = random_tape(&mut random, len);
        let arguments = Arguments::random(&mut random);
        for instructions in [Instructions::Avx2, Instructions::Avx512] {
            let target = Target {
                instructions,
                elementary: Elementary::Standard,
            };
            let blocks = arguments.0.each_ref().map(Vec::as_slice);
            let results = emulated(&tape, SIZES, target, blocks);
            for lane in 0..8 {
                let expected = arguments.interpreted(&tape, lane);
                let found: Vec<f64> = results.iter().map(|block| block[lane]).collect();
                assert!(
                    same(&found, &expected),
                    "{found:?} {expected:?}, seed {seed}, {instructions:?}"
                );
                let finite = expected.iter().filter(|number| number.is_finite());
                assert!(2 * finite.count() > expected.len(), "seed {seed}");
            }
        }
    }
}
