//! Register allocation for straight-line code.
//!
//! In straight-line code the next use of every value is known. On register pressure, the value with the
//! furthest next use is evicted (Belady, *A study of replacement algorithms for a virtual-storage computer*,
//! 1966). Values in memory, such as arguments and constants, are reloaded from there; other values are spilled
//! once.

#[cfg(test)]
mod tests;

use super::instruction::{Instruction, Memory, Operand, Register};
use super::line::{Action, Binary, Id, Line, Node, Routine};
use super::slots::Slots;
use crate::symbolic::Relation;

/// Instructions, and the size of their frame.
#[derive(Debug)]
pub(super) struct Allocated {
    pub(super) instructions: Vec<Instruction>,
    /// Blocks of the frame.
    pub(super) slots: u32,
}

/// Factor by which the next use of a value not in memory must be further away than that of a value in memory to
/// be evicted first.
const COST_OF_KEEPING: usize = 3;

/// Allocates a given number of registers.
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

/// The initial memory location of a value.
fn home(node: Node) -> Option<Memory> {
    match node {
        Node::Argument(array, index) => Some(Memory::Argument(array, index)),
        Node::Constant(bits) => Some(Memory::Constant(bits)),
        _ => None,
    }
}

/// Blocks at the start of the frame reserved for the data of systems.
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
    /// The value in each register.
    held: Vec<Option<Id>>,
    /// The register of each value.
    register: Vec<Option<Register>>,
    /// The memory location of each value.
    home: Vec<Option<Memory>>,
    slots: Slots,
    /// Slots to be freed after the current instruction.
    dead: Vec<u32>,
    /// The comparison whose result is in the mask.
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
            // Not computed by an instruction.
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

    /// Whether the second of two commutative operands should be loaded into a register.
    fn prefers_right(&self, a: Id, b: Id) -> bool {
        match (self.register[a.index()], self.register[b.index()]) {
            (Some(_), _) => false,
            (None, Some(_)) => true,
            // The one with the sooner next use.
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

    /// The address of a block with a value in all lanes.
    fn address(&mut self, id: Id) -> Memory {
        match self.home[id.index()] {
            Some(memory @ (Memory::Argument(..) | Memory::Slot(_))) => memory,
            // Constants are stored once for all lanes.
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

    /// The last operand of an instruction, in memory if available there and not worth a register.
    fn operand(&mut self, id: Id, pinned: &[Id]) -> Operand {
        if let Some(register) = self.register[id.index()] {
            return Operand::Register(register);
        }
        match self.home[id.index()] {
            Some(memory) if !self.is_worth_a_register(id) => Operand::Memory(memory),
            _ => Operand::Register(self.load(id, pinned)),
        }
    }

    /// Whether a value in memory is used again and a register is free.
    fn is_worth_a_register(&self, id: Id) -> bool {
        self.uses.after(id) != NEVER && self.held.contains(&None)
    }

    fn load(&mut self, id: Id, pinned: &[Id]) -> Register {
        if let Some(register) = self.register[id.index()] {
            return register;
        }
        let to = self.new_register(id, pinned);
        // A value without a register is in memory, where eviction has stored it.
        if let Some(from) = self.home[id.index()] {
            self.instructions.push(Instruction::Load { to, from });
        }
        to
    }

    /// Allocates a register for a value, evicting another one if necessary; not one of `pinned`.
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

    /// Removes a value from its register, spilling it if it is live and not in memory.
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

    /// Ends one use of a value.
    fn used(&mut self, id: Id) {
        self.uses.over(id);
        if self.uses.is_alive(id) {
            return;
        }
        if let Some(register) = self.register[id.index()].take() {
            self.held[usize::from(register.0)] = None;
        }
        // The current instruction may still read the slot.
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

/// Next-use information: the positions of uses in the code.
struct Uses {
    /// Positions of all uses, grouped by value and sorted.
    times: Vec<u32>,
    /// End of a value's uses in `times`.
    ends: Vec<u32>,
    /// The next use of a value in `times`.
    cursors: Vec<u32>,
    /// The number of finished uses.
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
