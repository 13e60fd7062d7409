//! Registers for the values of a line.
//!
//! In a straight line the next use of every value is known. Where registers run out, the value
//! whose next use is furthest away leaves (Belady, *A study of replacement algorithms for a
//! virtual-storage computer*, 1966). What lies in memory already, such as arguments and constants,
//! is read there again; other values are written to the frame once.

#[cfg(test)]
mod tests;

use super::instruction::{Instruction, Memory, Operand, Register};
use super::line::{Action, Binary, Id, Line, Node, Routine};
use super::slots::Slots;
use crate::symbolic::Relation;

/// Instructions, and what they need.
#[derive(Debug)]
pub(super) struct Allocated {
    pub(super) instructions: Vec<Instruction>,
    /// Blocks of the frame.
    pub(super) slots: u32,
}

/// How much further away the next use of a value that is not in memory has to be than that of one
/// that is, before it leaves a register first.
const COST_OF_KEEPING: usize = 3;

/// Instructions for a line, with so many registers.
pub(super) fn allocate(line: &Line, registers: u8) -> Allocated {
    let mut allocator = Allocator {
        line,
        uses: Uses::new(line),
        held: vec![None; registers.into()],
        register: vec![None; line.nodes.len()],
        home: line.nodes.iter().map(|&node| home(node)).collect(),
        slots: Slots::new(staged(line)),
        dead: Vec::new(),
        mask: None,
        instructions: Vec::with_capacity(line.actions.len() * 3 / 2),
    };
    for &action in &line.actions {
        allocator.action(action);
    }
    Allocated {
        instructions: allocator.instructions,
        slots: allocator.slots.len(),
    }
}

/// Where a value lies from the start.
fn home(node: Node) -> Option<Memory> {
    match node {
        Node::Argument(array, index) => Some(Memory::Argument(array, index)),
        Node::Constant(bits) => Some(Memory::Constant(bits)),
        _ => None,
    }
}

/// Blocks at the start of the frame on which systems are laid out.
fn staged(line: &Line) -> u32 {
    let systems = line.actions.iter().filter_map(|action| match action {
        Action::Call(call) => match line.calls[*call as usize].routine {
            Routine::System(rows) => Some(rows * (rows + 1)),
            _ => None,
        },
        _ => None,
    });
    systems.max().unwrap_or(0)
}

struct Allocator<'a> {
    line: &'a Line,
    uses: Uses,
    /// The value that a register holds.
    held: Vec<Option<Id>>,
    /// The register that holds a value.
    register: Vec<Option<Register>>,
    /// Where a value lies in memory.
    home: Vec<Option<Memory>>,
    slots: Slots,
    /// Slots that are free once the present instruction is written.
    dead: Vec<u32>,
    /// What the mask holds.
    mask: Option<(Relation, [Id; 2])>,
    instructions: Vec<Instruction>,
}

impl Allocator<'_> {
    fn action(&mut self, action: Action) {
        match action {
            Action::Compute(id) => self.compute(id),
            Action::Call(call) => self.call(call),
            Action::Store(id, result, entry) => {
                let from = self.load(id, &[]);
                self.used(id);
                let store = Instruction::Store {
                    result,
                    entry,
                    from,
                };
                self.write(store);
            }
        }
    }

    fn compute(&mut self, id: Id) {
        match self.line.nodes[id.index()] {
            Node::Binary(operation, a, b) => self.binary(id, operation, a, b),
            Node::Sqrt(a) => {
                let of = self.operand(a, &[]);
                self.used(a);
                let to = self.new_register(id, &[]);
                self.write(Instruction::Sqrt { to, of });
            }
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                self.compare(relation, compared);
                self.select(id, branches);
            }
            // Computed by nothing.
            Node::Argument(..) | Node::Constant(_) | Node::Result(..) => {}
        }
    }

    fn binary(&mut self, id: Id, operation: Binary, a: Id, b: Id) {
        let swap = operation.is_commutative() && self.prefers_right(a, b);
        let (left, right) = if swap { (b, a) } else { (a, b) };
        let (left_register, right_operand) = self.pair(left, right);
        self.used(a);
        self.used(b);
        let to = self.new_register(id, &[]);
        self.write(Instruction::Binary {
            operation,
            to,
            left: left_register,
            right: right_operand,
        });
    }

    /// Whether of two values that may change places the second should be read into a register.
    fn prefers_right(&self, a: Id, b: Id) -> bool {
        match (self.register[a.index()], self.register[b.index()]) {
            (Some(_), _) => false,
            (None, Some(_)) => true,
            // The one that is used again sooner.
            (None, None) => self.uses.after(b) < self.uses.after(a),
        }
    }

    fn pair(&mut self, left: Id, right: Id) -> (Register, Operand) {
        let left_register = self.load(left, &[right]);
        (left_register, self.operand(right, &[left]))
    }

    fn compare(&mut self, relation: Relation, compared: [Id; 2]) {
        let [a, b] = compared;
        if self.mask == Some((relation, compared)) {
            self.used(a);
            self.used(b);
            return self.clean();
        }
        let swapped = self.prefers_right(a, b);
        let (left, right) = if swapped { (b, a) } else { (a, b) };
        let (left, right) = self.pair(left, right);
        self.used(a);
        self.used(b);
        self.write(Instruction::Compare {
            relation,
            swapped,
            left,
            right,
        });
        self.mask = Some((relation, compared));
    }

    fn select(&mut self, id: Id, [then, otherwise]: [Id; 2]) {
        let (otherwise_register, then_operand) = self.pair(otherwise, then);
        self.used(then);
        self.used(otherwise);
        let to = self.new_register(id, &[]);
        self.write(Instruction::Select {
            to,
            then: then_operand,
            otherwise: otherwise_register,
        });
    }

    fn call(&mut self, call: u32) {
        let call = &self.line.calls[call as usize];
        let given = if let Routine::System(_) = call.routine {
            for (slot, &id) in (0..).zip(&call.given) {
                let from = self.load(id, &[]);
                self.write(Instruction::Keep { slot, from });
            }
            vec![Memory::Slot(0)]
        } else {
            call.given.iter().map(|&id| self.address(id)).collect()
        };
        for &id in &call.given {
            self.used(id);
        }
        for register in 0..self.held.len() {
            if let Some(id) = self.held[register] {
                self.evict(id);
            }
        }
        self.mask = None;
        let count = u32::try_from(call.results.len()).unwrap_or(u32::MAX);
        let results = self.slots.take(count);
        for (slot, &id) in (results..).zip(&call.results) {
            self.home[id.index()] = Some(Memory::Slot(slot));
            if !self.uses.is_alive(id) {
                self.dead.push(slot);
            }
        }
        self.write(Instruction::Call {
            routine: call.routine,
            given,
            results,
        });
    }

    /// A block in memory that holds a value in every lane.
    fn address(&mut self, id: Id) -> Memory {
        match self.home[id.index()] {
            Some(memory @ (Memory::Argument(..) | Memory::Slot(_))) => memory,
            // Constants lie there once for all lanes.
            Some(Memory::Constant(_)) => {
                let from = self.load(id, &[]);
                let slot = self.slots.take(1);
                self.dead.push(slot);
                self.instructions.push(Instruction::Keep { slot, from });
                Memory::Slot(slot)
            }
            None => {
                let from = self.load(id, &[]);
                Memory::Slot(self.keep(id, from))
            }
        }
    }

    /// The last operand of an instruction, in memory where it is there and not worth a register.
    fn operand(&mut self, id: Id, pinned: &[Id]) -> Operand {
        if let Some(register) = self.register[id.index()] {
            return Operand::Register(register);
        }
        match self.home[id.index()] {
            Some(memory) if !self.is_worth_a_register(id) => Operand::Memory(memory),
            _ => Operand::Register(self.load(id, pinned)),
        }
    }

    /// Whether a value in memory is used again, and a register is free for it.
    fn is_worth_a_register(&self, id: Id) -> bool {
        self.uses.after(id) != NEVER && self.held.contains(&None)
    }

    fn load(&mut self, id: Id, pinned: &[Id]) -> Register {
        if let Some(register) = self.register[id.index()] {
            return register;
        }
        let to = self.new_register(id, pinned);
        // What is in no register is in memory: it was written there when it left.
        if let Some(from) = self.home[id.index()] {
            self.instructions.push(Instruction::Load { to, from });
        }
        to
    }

    /// A register for a value, which some other value may have to leave; not one of `pinned`.
    fn new_register(&mut self, id: Id, pinned: &[Id]) -> Register {
        let free = self.held.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| {
            let place = self.least_wanted(pinned);
            if let Some(leaving) = self.held[place] {
                self.evict(leaving);
            }
            place
        });
        let register = Register(u8::try_from(place).unwrap_or(u8::MAX));
        self.held[place] = Some(id);
        self.register[id.index()] = Some(register);
        register
    }

    fn least_wanted(&self, pinned: &[Id]) -> usize {
        let now = self.uses.now;
        let distance = |id: Id| {
            let next = self.uses.next(id) as usize - now as usize;
            match self.home[id.index()] {
                Some(_) => next.saturating_mul(COST_OF_KEEPING),
                None => next,
            }
        };
        let held = self.held.iter().enumerate();
        let held = held.filter_map(|(place, id)| Some((place, (*id)?)));
        let free_to_leave = held.filter(|(_, id)| !pinned.contains(id));
        let furthest = free_to_leave.max_by_key(|&(_, id)| distance(id));
        furthest.map_or(0, |(place, _)| place)
    }

    /// Takes a value out of its register and writes it to memory if it is needed there.
    fn evict(&mut self, id: Id) {
        if let Some(from) = self.register[id.index()].take() {
            self.held[usize::from(from.0)] = None;
            if self.home[id.index()].is_none() {
                self.keep(id, from);
            }
        }
    }

    fn keep(&mut self, id: Id, from: Register) -> u32 {
        let slot = self.slots.take(1);
        self.home[id.index()] = Some(Memory::Slot(slot));
        self.instructions.push(Instruction::Keep { slot, from });
        slot
    }

    /// One use of a value is over.
    fn used(&mut self, id: Id) {
        self.uses.over(id);
        if self.uses.is_alive(id) {
            return;
        }
        if let Some(register) = self.register[id.index()].take() {
            self.held[usize::from(register.0)] = None;
        }
        // The present instruction may still read it.
        if let Some(Memory::Slot(slot)) = self.home[id.index()].take() {
            self.dead.push(slot);
        }
    }

    fn write(&mut self, instruction: Instruction) {
        self.instructions.push(instruction);
        self.clean();
    }

    fn clean(&mut self) {
        for slot in self.dead.drain(..) {
            self.slots.release(slot);
        }
    }
}

/// No further use.
const NEVER: u32 = u32::MAX;

/// When values are used: the number of the use in the order of the line.
struct Uses {
    /// Uses of all values, those of a value together and in order.
    times: Vec<u32>,
    /// Where the uses of a value end in `times`.
    ends: Vec<u32>,
    /// The next use of a value in `times`.
    cursors: Vec<u32>,
    /// Uses that are over.
    now: u32,
}

impl Uses {
    fn new(line: &Line) -> Self {
        let operands = || {
            let actions = line.actions.iter();
            actions.flat_map(|&action| line.operands(action))
        };
        let mut ends = vec![0; line.nodes.len()];
        for id in operands() {
            ends[id.index()] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        let mut cursors: Vec<u32> = std::iter::once(0)
            .chain(ends.iter().copied())
            .take(ends.len())
            .collect();
        let starts = cursors.clone();
        let mut times = vec![0; sum as usize];
        for (time, id) in (0..).zip(operands()) {
            let cursor = &mut cursors[id.index()];
            times[*cursor as usize] = time;
            *cursor += 1;
        }
        Self {
            times,
            ends,
            cursors: starts,
            now: 0,
        }
    }

    fn at(&self, id: Id, further: u32) -> u32 {
        let place = self.cursors[id.index()] + further;
        if place < self.ends[id.index()] {
            self.times[place as usize]
        } else {
            NEVER
        }
    }

    /// The next use.
    fn next(&self, id: Id) -> u32 {
        self.at(id, 0)
    }

    /// The use after the next one.
    fn after(&self, id: Id) -> u32 {
        self.at(id, 1)
    }

    fn is_alive(&self, id: Id) -> bool {
        self.next(id) != NEVER
    }

    fn over(&mut self, id: Id) {
        self.now += 1;
        self.cursors[id.index()] += 1;
    }
}
