//! Simulates allocated instructions and compares the values with those of the straight-line code.

use appell_test_kit::Random;

use super::super::line::{Array, Call};
use super::super::order::order;
use super::*;
use crate::tape::Arithmetic;

/// A hash of all arguments in order.
fn mixed(parts: &[u64]) -> u64 {
    let mix = |sum: u64, &part: &u64| {
        (sum.rotate_left(9) ^ part).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1
    };
    parts.iter().fold(1, mix)
}

fn binary(operation: Binary, a: u64, b: u64) -> u64 {
    let (a, b) = if operation.is_commutative() && b < a {
        (b, a)
    } else {
        (a, b)
    };
    let number = match operation {
        Binary::Arithmetic(operation) => operation as u64,
        Binary::And => 10,
        Binary::Xor => 11,
    };
    mixed(&[2, number, a, b])
}

fn holds(relation: Relation, a: u64, b: u64) -> bool {
    match relation {
        Relation::Less => a < b,
        Relation::LessOrEqual => a <= b,
    }
}

fn routine(given: &[u64], result: u64) -> u64 {
    mixed(&[&[3, result], given].concat())
}

fn leaf(memory: Memory) -> u64 {
    match memory {
        Memory::Argument(array, index) => mixed(&[4, array as u64, index.into()]),
        Memory::Constant(bits) => mixed(&[5, bits]),
        Memory::Slot(_) => 0,
    }
}

/// The values of straight-line code, in order.
fn values(line: &Line) -> Vec<u64> {
    let mut values: Vec<u64> = Vec::new();
    for &node in &line.nodes {
        let of = |id: Id| values[id.index()];
        let value = match node {
            Node::Argument(array, index) => leaf(Memory::Argument(array, index)),
            Node::Constant(bits) => leaf(Memory::Constant(bits)),
            Node::Binary(operation, a, b) => binary(operation, of(a), of(b)),
            Node::Sqrt(a) => mixed(&[6, of(a)]),
            Node::Choice {
                relation,
                compared: [a, b],
                branches: [then, otherwise],
            } => {
                if holds(relation, of(a), of(b)) {
                    of(then)
                } else {
                    of(otherwise)
                }
            }
            Node::Result(call, result) => {
                let given = line.calls[call as usize].given.iter();
                let given: Vec<u64> = given.map(|&id| of(id)).collect();
                routine(&given, result.into())
            }
        };
        values.push(value);
    }
    values
}

/// A processor.
struct Processor {
    registers: Vec<u64>,
    slots: Vec<u64>,
    mask: bool,
    stored: Vec<(u32, u32, u64)>,
}

impl Processor {
    fn memory(&self, memory: Memory) -> u64 {
        match memory {
            Memory::Slot(slot) => self.slots[slot as usize],
            _ => leaf(memory),
        }
    }

    fn register(&self, register: Register) -> u64 {
        self.registers[usize::from(register.0)]
    }

    fn operand(&self, operand: Operand) -> u64 {
        match operand {
            Operand::Register(register) => self.register(register),
            Operand::Memory(memory) => self.memory(memory),
        }
    }

    fn set(&mut self, to: Register, value: u64) {
        self.registers[usize::from(to.0)] = value;
    }

    fn run(&mut self, instruction: &Instruction) {
        match instruction {
            Instruction::Load { to, from } => self.set(*to, self.memory(*from)),
            Instruction::Keep { slot, from } => {
                self.slots[*slot as usize] = self.register(*from);
            }
            Instruction::Store {
                result,
                entry,
                from,
            } => {
                let value = self.register(*from);
                self.stored.push((*result, *entry, value));
            }
            Instruction::Binary {
                operation,
                to,
                left,
                right,
            } => {
                let value = binary(*operation, self.register(*left), self.operand(*right));
                self.set(*to, value);
            }
            Instruction::Sqrt { to, of } => self.set(*to, mixed(&[6, self.operand(*of)])),
            Instruction::Compare {
                relation,
                swapped,
                left,
                right,
            } => {
                let (left, right) = (self.register(*left), self.operand(*right));
                self.mask = if *swapped {
                    holds(*relation, right, left)
                } else {
                    holds(*relation, left, right)
                };
            }
            Instruction::Select {
                to,
                then,
                otherwise,
            } => {
                let (then, otherwise) = (self.operand(*then), self.register(*otherwise));
                self.set(*to, if self.mask { then } else { otherwise });
            }
            Instruction::Call {
                routine: called,
                given,
                results,
            } => {
                let (given, count): (Vec<u64>, u32) = match called {
                    Routine::System(rows) => {
                        let given = &self.slots[..(rows * (rows + 1)) as usize];
                        (given.to_vec(), *rows)
                    }
                    Routine::SinCos => (given.iter().map(|&m| self.memory(m)).collect(), 2),
                    _ => (given.iter().map(|&m| self.memory(m)).collect(), 1),
                };
                for result in 0..count {
                    let value = routine(&given, result.into());
                    self.slots[(results + result) as usize] = value;
                }
                // Only memory survives a call.
                self.registers.fill(7);
                self.mask = !self.mask;
            }
        }
    }
}

/// Random straight-line code with a given number of values, some of them results.
fn random_line(random: &mut Random, len: usize) -> (Line, Vec<Action>) {
    let number = |n: usize| u32::try_from(n).unwrap_or(0);
    let mut nodes = vec![Node::Argument(Array::States, 0), Node::Constant(1)];
    let mut calls = Vec::new();
    while nodes.len() < len {
        let known = nodes.len();
        // Mostly nearby operands, sometimes distant ones.
        let any = |random: &mut Random| {
            let reach = if random.below(3) == 0 {
                known
            } else {
                known.min(40)
            };
            Id(number(known - 1 - random.below(reach)))
        };
        let node = match random.below(20) {
            0 => Node::Argument(Array::Inputs, number(random.below(5))),
            1 => Node::Constant(random.below(5) as u64),
            2 => Node::Sqrt(any(random)),
            3..=5 => Node::Choice {
                relation: Relation::LessOrEqual,
                compared: [Id(number(known / 10)), Id(number(known / 20))],
                branches: [any(random), any(random)],
            },
            6 if random.below(8) == 0 => {
                let (routine, given, results) = match random.below(4) {
                    0 => (Routine::SinCos, 1, 2),
                    1 => (Routine::Atan2, 2, 1),
                    2 => (Routine::Unary(crate::symbolic::Function::Exp), 1, 1),
                    _ => (Routine::System(3), 12, 3),
                };
                let given = (0..given).map(|_| any(random)).collect();
                let call = number(calls.len());
                nodes.extend((0..).take(results).map(|result| Node::Result(call, result)));
                let results = (known..known + results).map(|id| Id(number(id))).collect();
                calls.push(Call {
                    routine,
                    given,
                    results,
                });
                continue;
            }
            kind => {
                let operation = match kind % 3 {
                    0 => Arithmetic::Add,
                    1 => Arithmetic::Subtract,
                    _ => Arithmetic::Divide,
                };
                Node::Binary(Binary::Arithmetic(operation), any(random), any(random))
            }
        };
        nodes.push(node);
    }
    let stores = (0..len / 4).map(|entry| {
        let id = Id(number(nodes.len() - 1 - random.below(nodes.len() / 2)));
        Action::Store(id, number(entry % 3), number(entry))
    });
    let stores: Vec<Action> = stores.collect();
    (order(nodes, calls, stores.clone()), stores)
}

#[test]
fn instructions_give_the_values_of_the_line() {
    for (seed, len) in (0..300).zip((40..440).step_by(10).cycle()) {
        let mut random = Random::new(seed);
        let (line, mut stores) = random_line(&mut random, len);
        let values = values(&line);
        for registers in [3, 4, 15, 32] {
            let allocated = allocate(&line, registers);
            let mut processor = Processor {
                registers: vec![7; registers.into()],
                slots: vec![7; allocated.slots as usize],
                mask: false,
                stored: Vec::new(),
            };
            for instruction in &allocated.instructions {
                processor.run(instruction);
            }
            stores.sort_by_key(|store| match store {
                Action::Store(_, result, entry) => (*result, *entry),
                _ => (0, 0),
            });
            let expected = stores.iter().filter_map(|store| match *store {
                Action::Store(id, result, entry) => Some((result, entry, values[id.index()])),
                _ => None,
            });
            processor
                .stored
                .sort_by_key(|&(result, entry, _)| (result, entry));
            let expected: Vec<_> = expected.collect();
            assert_eq!(
                processor.stored, expected,
                "seed {seed}, {registers} registers"
            );
        }
    }
}
