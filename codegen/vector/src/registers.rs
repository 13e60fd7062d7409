//! Register allocation for straight-line code.
//!
//! In straight-line code the next use of every value is known. On register pressure, the value with the
//! furthest next use is evicted (Belady, *A study of replacement algorithms for a virtual-storage computer*,
//! 1966). Values in memory, such as arguments and constants, are reloaded from there; other values are spilled
//! once.

use appell_codegen::jit::Elementary;
use appell_codegen::symbolic::{Function, Relation};
use appell_codegen::tape::{Arithmetic, Operation, Tape, Value};
use iced_x86::Code;

use super::assemble::{Assembler, Memory, Operand};
use super::instruction_set::InstructionSet;
use super::order::{Action, Store, is_call, ordered};
use super::slots::Slots;
use super::unroll::is_commutative;
use super::uses::{NEVER, Uses, for_each_operand};

/// Factor by which the next use of a value not in memory must be further away than that of a value in memory to
/// be evicted first.
const COST_OF_KEEPING: usize = 3;
/// All bits except the sign.
const MAGNITUDE: u64 = u64::MAX >> 1;
/// The sign.
const SIGN: u64 = !MAGNITUDE;

/// The instructions of an unrolled tape, and the number of blocks of their frame.
pub(crate) fn allocate(
    tape: &Tape,
    set: InstructionSet,
    elementary: Elementary,
) -> (Assembler, u32) {
    let actions = ordered(tape);
    let calls = calls(tape, &actions);
    let mut allocator = Allocator {
        tape,
        set,
        uses: Uses::new(tape, &actions),
        held: vec![None; set.registers.into()],
        register: vec![None; tape.operations.len()],
        home: tape.operations.iter().map(home).collect(),
        slots: Slots::new(staged(&calls)),
        dead: Vec::new(),
        mask: None,
        code: Assembler::new(set, elementary, !calls.is_empty()),
    };
    for action in actions {
        allocator.action(action);
        allocator.release();
    }
    (allocator.code, allocator.slots.len())
}

fn calls<'a>(tape: &'a Tape, actions: &[Action]) -> Vec<&'a Operation> {
    let computed = actions.iter().filter_map(|action| match action {
        Action::Compute(value) => Some(tape.operation(*value)),
        Action::Store(_) => None,
    });
    computed.filter(|operation| is_call(operation)).collect()
}

/// The initial memory location of a value.
fn home(operation: &Operation) -> Option<Memory> {
    match operation {
        Operation::Argument(argument) => Some(Memory::Argument(*argument)),
        Operation::Constant(number) => Some(Memory::Constant(number.to_f64().to_bits())),
        _ => None,
    }
}

/// Blocks at the start of the frame reserved for the data of systems.
fn staged(calls: &[&Operation]) -> u32 {
    let systems = calls.iter().map(|call| match call {
        Operation::Solve { right, .. } => right.len() * (right.len() + 1),
        _ => 0,
    });
    u32::try_from(systems.max().unwrap_or(0)).unwrap_or(u32::MAX)
}

struct Allocator<'a> {
    tape: &'a Tape,
    set: InstructionSet,
    uses: Uses,
    /// The value in each register.
    held: Vec<Option<Value>>,
    /// The register of each value.
    register: Vec<Option<u8>>,
    /// The memory location of each value.
    home: Vec<Option<Memory>>,
    slots: Slots,
    /// Slots to be freed after the current action.
    dead: Vec<u32>,
    /// The comparison whose result is in the mask.
    mask: Option<(Relation, [Value; 2])>,
    code: Assembler,
}

impl Allocator<'_> {
    fn action(&mut self, action: Action) {
        match action {
            Action::Compute(value) => self.compute(value),
            Action::Store(Store {
                value,
                result,
                entry,
            }) => {
                let from = self.load(value);
                self.used(value);
                self.code.store(result, entry, from);
            }
        }
    }

    fn compute(&mut self, value: Value) {
        let set = self.set;
        match self.tape.operation(value) {
            Operation::Binary(operation, a, b) => self.binary(value, *operation, *a, *b),
            Operation::Negate(a) => self.bitwise(value, set.xor, *a, SIGN),
            Operation::Function(Function::Abs, a) => self.bitwise(value, set.and, *a, MAGNITUDE),
            Operation::Function(Function::Sqrt, a) => {
                let of = self.operand(*a);
                self.used(*a);
                let to = self.new_register(value);
                self.code.square_root(to, of);
            }
            Operation::Choice {
                relation,
                compared,
                branches,
            } => {
                self.compare(*relation, *compared);
                self.select(value, *branches);
            }
            call => self.call(value, call),
        }
    }

    fn binary(&mut self, value: Value, operation: Arithmetic, a: Value, b: Value) {
        let swap = is_commutative(operation) && self.prefers_right(a, b);
        let (left, right) = if swap { (b, a) } else { (a, b) };
        let (left, right) = self.pair(left, right);
        self.used(a);
        self.used(b);
        let to = self.new_register(value);
        let code = match operation {
            Arithmetic::Add => self.set.add,
            Arithmetic::Subtract => self.set.subtract,
            Arithmetic::Multiply => self.set.multiply,
            Arithmetic::Divide => self.set.divide,
        };
        self.code.binary(code, to, left, right);
    }

    /// An operation on the bits of a value and of a constant.
    fn bitwise(&mut self, value: Value, code: Code, a: Value, bits: u64) {
        let left = self.load(a);
        self.used(a);
        let to = self.new_register(value);
        let right = Operand::Memory(Memory::Constant(bits));
        self.code.binary(code, to, left, right);
    }

    /// Whether the second of two commutative operands should be loaded into a register.
    fn prefers_right(&self, a: Value, b: Value) -> bool {
        match (self.register[a.index()], self.register[b.index()]) {
            (Some(_), _) => false,
            (None, Some(_)) => true,
            // The one with the sooner next use.
            (None, None) => self.uses.after(b) < self.uses.after(a),
        }
    }

    fn pair(&mut self, left: Value, right: Value) -> (u8, Operand) {
        let register = self.load(left);
        (register, self.operand(right))
    }

    fn compare(&mut self, relation: Relation, compared: [Value; 2]) {
        let [a, b] = compared;
        let is_known = self.mask == Some((relation, compared));
        if !is_known {
            let swapped = self.prefers_right(a, b);
            let (left, right) = if swapped { (b, a) } else { (a, b) };
            let (left, right) = self.pair(left, right);
            self.code.compare(relation, swapped, left, right);
            self.mask = Some((relation, compared));
        }
        self.used(a);
        self.used(b);
        self.release();
    }

    fn select(&mut self, value: Value, [then, otherwise]: [Value; 2]) {
        let (register, operand) = self.pair(otherwise, then);
        self.used(then);
        self.used(otherwise);
        let to = self.new_register(value);
        self.code.select(to, operand, register);
    }

    fn call(&mut self, value: Value, call: &Operation) {
        let mut given = Vec::new();
        for_each_operand(self.tape, call, |operand| given.push(operand));
        let addresses = if let Operation::Solve { .. } = call {
            for (slot, &operand) in (0..).zip(&given) {
                let from = self.load(operand);
                self.code.keep(slot, from);
            }
            vec![Memory::Slot(0)]
        } else {
            given.iter().map(|&operand| self.address(operand)).collect()
        };
        for &operand in &given {
            self.used(operand);
        }
        for register in 0..self.held.len() {
            if let Some(value) = self.held[register] {
                self.evict(value);
            }
        }
        self.mask = None;
        let results: Vec<Value> = match call.parts() {
            0 => vec![value],
            parts => (0..).take(parts).map(|index| value.part(index)).collect(),
        };
        let count = u32::try_from(results.len()).unwrap_or(u32::MAX);
        let first = self.slots.take(count);
        for (slot, result) in (first..).zip(results) {
            self.home[result.index()] = Some(Memory::Slot(slot));
            if !self.uses.is_alive(result) {
                self.dead.push(slot);
            }
        }
        self.code.call(call, &addresses, first);
    }

    /// The address of a block with a value in all lanes.
    fn address(&mut self, value: Value) -> Memory {
        match self.home[value.index()] {
            Some(memory @ (Memory::Argument(..) | Memory::Slot(_))) => memory,
            // Constants are not stored for all lanes.
            Some(Memory::Constant(_)) => {
                let from = self.load(value);
                let slot = self.slots.take(1);
                self.dead.push(slot);
                self.code.keep(slot, from);
                Memory::Slot(slot)
            }
            None => {
                let from = self.load(value);
                self.keep(value, from)
            }
        }
    }

    /// The last operand of an instruction, in memory if available there and not worth a register.
    fn operand(&mut self, value: Value) -> Operand {
        if let Some(register) = self.register[value.index()] {
            return Operand::Register(register);
        }
        match self.home[value.index()] {
            Some(memory) if !self.is_worth_a_register(value) => Operand::Memory(memory),
            _ => Operand::Register(self.load(value)),
        }
    }

    /// Whether a value in memory is used again and a register is free.
    fn is_worth_a_register(&self, value: Value) -> bool {
        self.uses.after(value) != NEVER && self.held.contains(&None)
    }

    fn load(&mut self, value: Value) -> u8 {
        if let Some(register) = self.register[value.index()] {
            return register;
        }
        let to = self.new_register(value);
        // A value without a register is in memory, where eviction has stored it.
        if let Some(from) = self.home[value.index()] {
            self.code.load(to, from);
        }
        to
    }

    /// Allocates a register for a value, evicting another one if necessary.
    fn new_register(&mut self, value: Value) -> u8 {
        let free = self.held.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| {
            let place = self.least_wanted();
            if let Some(leaving) = self.held[place] {
                self.evict(leaving);
            }
            place
        });
        let register = u8::try_from(place).unwrap_or(u8::MAX);
        self.held[place] = Some(value);
        self.register[value.index()] = Some(register);
        register
    }

    /// The register to be evicted. Operands of the current instruction have the soonest next uses and stay.
    fn least_wanted(&self) -> usize {
        let now = self.uses.now;
        let distance = |value: Value| {
            let next = self.uses.next(value) as usize - now as usize;
            match self.home[value.index()] {
                Some(_) => next.saturating_mul(COST_OF_KEEPING),
                None => next,
            }
        };
        let held = self.held.iter().enumerate();
        let held = held.filter_map(|(place, value)| Some((place, (*value)?)));
        let furthest = held.max_by_key(|&(_, value)| distance(value));
        furthest.map_or(0, |(place, _)| place)
    }

    /// Removes a value from its register, spilling it if it is not in memory.
    fn evict(&mut self, value: Value) {
        if let Some(from) = self.register[value.index()].take() {
            self.held[usize::from(from)] = None;
            if self.home[value.index()].is_none() {
                self.keep(value, from);
            }
        }
    }

    /// Spills a register to a block of the frame.
    fn keep(&mut self, value: Value, from: u8) -> Memory {
        let slot = self.slots.take(1);
        let memory = Memory::Slot(slot);
        self.home[value.index()] = Some(memory);
        self.code.keep(slot, from);
        memory
    }

    /// Ends one use of a value.
    fn used(&mut self, value: Value) {
        self.uses.over(value);
        if self.uses.is_alive(value) {
            return;
        }
        if let Some(register) = self.register[value.index()].take() {
            self.held[usize::from(register)] = None;
        }
        // The current instruction may still read the slot.
        if let Some(Memory::Slot(slot)) = self.home[value.index()].take() {
            self.dead.push(slot);
        }
    }

    fn release(&mut self) {
        for slot in self.dead.drain(..) {
            self.slots.release(slot);
        }
    }
}
