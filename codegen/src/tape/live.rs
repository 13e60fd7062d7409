//! Dead-code elimination, and the order of the emitted text.

use super::{Tape, Value};

impl Tape {
    /// The live operations, in their order.
    #[must_use]
    pub fn live(&self) -> Self {
        let live = self.liveness();
        let mut moved = Reordered::new(self);
        for value in (0..).map(Value).take(self.operations.len()) {
            if live[value.index()] {
                moved.push(value);
            }
        }
        moved.finish()
    }

    /// The live operations in the order in which text evaluates them: those of a value without a name come where it
    /// is used. Its expressions must be small.
    #[must_use]
    pub(crate) fn in_order_of_text(&self) -> Self {
        let live = self.liveness();
        let mut moved = Reordered::new(self);
        for value in (0..).map(Value).take(self.operations.len()) {
            let is_statement = !self.operation(value).is_number() || self.name(value).is_some();
            if live[value.index()] && is_statement {
                moved.push_with_operands(value);
            }
        }
        for result in &self.results {
            for &entry in &result.entries {
                moved.push_with_operands(entry);
            }
        }
        moved.finish()
    }

    /// By value: whether a result depends on it. All parts of a live operation are live.
    fn liveness(&self) -> Vec<bool> {
        let mut live = vec![false; self.operations.len()];
        for &entry in self.results.iter().flat_map(|result| &result.entries) {
            live[entry.index()] = true;
        }
        // Users come after their operands.
        for (index, operation) in self.operations.iter().enumerate().rev() {
            if live[index] {
                for operand in operation.operands() {
                    live[operand.index()] = true;
                }
            }
        }
        for (index, operation) in self.operations.iter().enumerate() {
            if live[index] {
                live[index + 1..=index + operation.parts()].fill(true);
            }
        }
        live
    }
}

/// A tape with the operations of another in a new order.
struct Reordered<'a> {
    from: &'a Tape,
    to: Tape,
    /// The new values.
    places: Vec<Option<Value>>,
}

impl<'a> Reordered<'a> {
    fn new(from: &'a Tape) -> Self {
        Self {
            from,
            to: Tape::default(),
            places: vec![None; from.operations.len()],
        }
    }

    fn place(&self, value: Value) -> Value {
        // Operands are pushed before their users.
        self.places[value.index()].unwrap_or(Value(u32::MAX))
    }

    /// Adds an operation whose operands are there.
    fn push(&mut self, value: Value) {
        let operation = self
            .from
            .operation(value)
            .map_operands(|operand| self.place(operand));
        let place = self.to.push_alone(operation);
        self.to.names[place.index()].clone_from(&self.from.names[value.index()]);
        self.places[value.index()] = Some(place);
    }

    /// Adds an operation after its operands, and its parts after it.
    fn push_with_operands(&mut self, value: Value) {
        if self.places[value.index()].is_some() {
            return;
        }
        let operation = self.from.operation(value);
        for operand in operation.operands() {
            self.push_with_operands(operand);
        }
        if self.places[value.index()].is_some() {
            return;
        }
        self.push(value);
        for part in (0..).take(operation.parts()) {
            self.push(value.part(part));
        }
    }

    fn finish(mut self) -> Tape {
        let results = self.from.results.iter();
        self.to.results = results
            .map(|result| result.map(|entry| self.place(entry)))
            .collect();
        self.to.headings = (self.from.headings.iter())
            .filter_map(|(value, title)| Some((self.places[value.index()]?, title.clone())))
            .collect();
        self.to
    }
}
