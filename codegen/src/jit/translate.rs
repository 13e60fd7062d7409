//! Translates a checked tape to the compiler's intermediate representation.
//!
//! A tape has no branches, so the function is a single basic block. The compiler eliminates dead code and
//! schedules instructions; it neither fuses nor reorders floating-point arithmetic.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::types::F64;
use cranelift_codegen::ir::{
    self, AbiParam, InstBuilder, MemFlagsData, SigRef, Signature, StackSlot, StackSlotData,
    StackSlotKind, Type,
};
use cranelift_codegen::isa::{CallConv, TargetFrontendConfig};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use rustc_hash::FxHashMap;

use super::check::Checked;
use super::dense::Routines;
use super::elementary::{self, Elementary};
use crate::symbolic::{Function, Relation};
use crate::tape::{Argument, Arithmetic, Operation, ResultArray, Tape, Value};

/// Signature of compiled functions: `t`, then the addresses of states, inputs, parameters, weights
/// and of a list with the address of each result.
pub(super) fn signature(config: TargetFrontendConfig) -> Signature {
    let pointer = config.pointer_type();
    let parameters = [F64, pointer, pointer, pointer, pointer, pointer];
    signature_of(config.default_call_conv, &parameters, &[])
}

/// Translates the body of a function with [`signature`].
pub(super) fn translate(
    checked: &Checked<'_>,
    elementary: Elementary,
    config: TargetFrontendConfig,
    function: &mut ir::Function,
) {
    let mut context = FunctionBuilderContext::new();
    let mut translation = Translation::new(checked, elementary, config, function, &mut context);
    for value in (0..).map(Value).take(checked.tape.operations.len()) {
        translation.operation(value);
    }
    translation.leaves_of_results();
    translation.builder.ins().return_(&[]);
    translation.builder.finalize(config);
}

struct Translation<'a> {
    builder: FunctionBuilder<'a>,
    config: TargetFrontendConfig,
    elementary: elementary::Routines,
    received: Received,
    tape: &'a Tape,
    /// Values computed so far. Arguments and numbers are not among them; see [`Self::value`].
    values: Vec<ir::Value>,
    /// Signatures declared so far.
    signatures: FxHashMap<Shape, SigRef>,
    /// Sine and cosine.
    pair: StackSlot,
    /// Matrix passed to a factorisation.
    matrix: StackSlot,
    /// Right-hand side, overwritten by the solution.
    right: StackSlot,
    factorisations: FxHashMap<Value, Factorisation>,
    /// Where the parts of the latest operation with parts are.
    parts: StackSlot,
    results: Results<'a>,
}

/// The entries of the results. A value is stored as soon as it is defined, which shortens its live range.
struct Results<'a> {
    arrays: &'a [ResultArray],
    /// Addresses of the arrays loaded so far.
    addresses: Vec<Option<ir::Value>>,
    /// For values that are results: arrays and entries.
    places: FxHashMap<Value, Vec<(usize, usize)>>,
}

/// The arguments of the compiled function; see [`signature`].
struct Received {
    time: ir::Value,
    states: ir::Value,
    inputs: ir::Value,
    parameters: ir::Value,
    weights: ir::Value,
    results: ir::Value,
}

/// Shapes of the functions that the code calls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Shape {
    /// `f64 -> f64`
    Unary,
    /// `(f64, f64) -> f64`
    Binary,
    /// `(f64, address of two numbers)`
    Pair,
    /// `(address, address, length)`
    System,
}

#[derive(Debug, Clone, Copy)]
struct Factorisation {
    routines: Routines,
    rows: usize,
    slot: StackSlot,
}

impl<'a> Translation<'a> {
    fn new(
        checked: &Checked<'a>,
        elementary: Elementary,
        config: TargetFrontendConfig,
        function: &'a mut ir::Function,
        context: &'a mut FunctionBuilderContext,
    ) -> Self {
        let mut builder = FunctionBuilder::new(function, context);
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_block(block);
        let received = Received {
            time: builder.block_params(block)[0],
            states: builder.block_params(block)[1],
            inputs: builder.block_params(block)[2],
            parameters: builder.block_params(block)[3],
            weights: builder.block_params(block)[4],
            results: builder.block_params(block)[5],
        };
        // A checked tape defines values before their use; until then they are zero.
        let zero = builder.ins().f64const(0.0);
        let rows = checked.rows;
        let [pair, matrix, right] =
            [2, rows * rows, rows].map(|numbers| slot(&mut builder, numbers * size_of::<f64>()));
        Self {
            builder,
            config,
            elementary: elementary.routines(),
            received,
            tape: checked.tape,
            values: vec![zero; checked.tape.operations.len()],
            signatures: FxHashMap::default(),
            pair,
            matrix,
            right,
            factorisations: FxHashMap::default(),
            parts: pair,
            results: Results::new(&checked.tape.results),
        }
    }

    fn operation(&mut self, value: Value) {
        let computed = match self.tape.operation(value) {
            // Loaded at each use: reloading is cheaper than a spilled register.
            Operation::Argument(_) | Operation::Constant(_) => return,
            Operation::Negate(a) => {
                let a = self.value(*a);
                self.builder.ins().fneg(a)
            }
            Operation::Binary(operation, a, b) => {
                let (a, b) = (self.value(*a), self.value(*b));
                let instruction = self.builder.ins();
                match operation {
                    Arithmetic::Add => instruction.fadd(a, b),
                    Arithmetic::Subtract => instruction.fsub(a, b),
                    Arithmetic::Multiply => instruction.fmul(a, b),
                    Arithmetic::Divide => instruction.fdiv(a, b),
                }
            }
            Operation::Function(function, a) => {
                let a = self.value(*a);
                self.function(*function, a)
            }
            Operation::Atan2(y, x) => {
                let arguments = [self.value(*y), self.value(*x)];
                let routine = self.elementary.atan2 as *const ();
                self.call(Shape::Binary, routine, &arguments)[0]
            }
            Operation::Power(base, exponent) => {
                let arguments = [self.value(*base), self.value(*exponent)];
                let routine = self.elementary.powf as *const ();
                self.call(Shape::Binary, routine, &arguments)[0]
            }
            Operation::Choice {
                relation,
                compared,
                branches,
            } => {
                let compared = compared.map(|value| self.value(value));
                let branches = branches.map(|value| self.value(value));
                let condition = match relation {
                    Relation::Less => FloatCC::LessThan,
                    Relation::LessOrEqual => FloatCC::LessThanOrEqual,
                };
                self.choose(condition, compared, branches)
            }
            Operation::SinCos(angle) => return self.sin_cos(*angle),
            Operation::Factorise(matrix) => return self.factor(value, matrix),
            Operation::Solve {
                factorisation,
                right,
            } => return self.solve(*factorisation, right),
            Operation::Part(_, index) => {
                let (pointer, parts) = (self.config.pointer_type(), self.parts);
                let place = offset(*index as usize);
                self.builder.ins().stack_load(pointer, F64, parts, place)
            }
        };
        self.define(value, computed);
    }

    /// A value that an operation uses.
    fn value(&mut self, value: Value) -> ir::Value {
        match self.tape.operation(value) {
            Operation::Argument(argument) => self.argument(*argument),
            Operation::Constant(number) => self.builder.ins().f64const(number.to_f64()),
            _ => self.values[value.index()],
        }
    }

    fn define(&mut self, value: Value, computed: ir::Value) {
        self.values[value.index()] = computed;
        for (array, entry) in self.results.places.remove(&value).unwrap_or_default() {
            self.store_result(array, entry, computed);
        }
    }

    fn sin_cos(&mut self, angle: Value) {
        // By memory: as fast as two result registers, and the same on every platform.
        let angle = self.value(angle);
        let pointer = self.config.pointer_type();
        let to = self.builder.ins().stack_addr(pointer, self.pair, 0);
        let routine = self.elementary.sin_cos as *const ();
        self.call(Shape::Pair, routine, &[angle, to]);
        self.parts = self.pair;
    }

    fn factor(&mut self, factorisation: Value, matrix: &[Value]) {
        let (from, rows) = (self.matrix, matrix.len().isqrt());
        let routines = Routines::new(rows);
        let slot = slot(&mut self.builder, routines.bytes);
        self.store_all(from, matrix);
        let arguments = self.system_arguments(from, slot, rows);
        self.call(Shape::System, routines.factor as *const (), &arguments);
        let factored = Factorisation {
            routines,
            rows,
            slot,
        };
        self.factorisations.insert(factorisation, factored);
    }

    fn solve(&mut self, factorisation: Value, right: &[Value]) {
        let Factorisation {
            routines,
            rows,
            slot,
        } = self.factorisations[&factorisation];
        self.store_all(self.right, right);
        let arguments = self.system_arguments(slot, self.right, rows);
        self.call(Shape::System, routines.solve as *const (), &arguments);
        self.parts = self.right;
    }

    fn store_all(&mut self, slot: StackSlot, values: &[Value]) {
        // Leaves are loaded before the first store: they may stay in registers.
        let pointer = self.config.pointer_type();
        let entries: Vec<_> = values.iter().map(|&value| self.value(value)).collect();
        for (index, entry) in entries.into_iter().enumerate() {
            self.builder
                .ins()
                .stack_store(pointer, entry, slot, offset(index));
        }
    }

    fn system_arguments(&mut self, from: StackSlot, to: StackSlot, rows: usize) -> [ir::Value; 3] {
        let pointer = self.config.pointer_type();
        let from = self.builder.ins().stack_addr(pointer, from, 0);
        let to = self.builder.ins().stack_addr(pointer, to, 0);
        let rows = self.address(rows);
        [from, to, rows]
    }

    /// Stores the entries that no operation computes: arguments and numbers.
    fn leaves_of_results(&mut self) {
        let arrays = self.results.arrays;
        for (array, result) in arrays.iter().enumerate() {
            for (entry, &value) in result.entries.iter().enumerate() {
                if self.tape.operation(value).is_leaf() {
                    let computed = self.value(value);
                    self.store_result(array, entry, computed);
                }
            }
        }
    }

    fn store_result(&mut self, array: usize, entry: usize, computed: ir::Value) {
        let (pointer, results) = (self.config.pointer_type(), self.received.results);
        let builder = &mut self.builder;
        let address = *self.results.addresses[array].get_or_insert_with(|| {
            let flags = MemFlagsData::trusted().with_readonly();
            builder.ins().load(pointer, flags, results, offset(array))
        });
        let flags = MemFlagsData::trusted();
        self.builder
            .ins()
            .store(flags, computed, address, offset(entry));
    }

    /// `branches[0]` where the relation of `compared` holds, `branches[1]` otherwise and for NaN.
    fn choose(
        &mut self,
        condition: FloatCC,
        [left, right]: [ir::Value; 2],
        [then, otherwise]: [ir::Value; 2],
    ) -> ir::Value {
        let holds = self.builder.ins().fcmp(condition, left, right);
        self.builder.ins().select(holds, then, otherwise)
    }

    fn function(&mut self, function: Function, a: ir::Value) -> ir::Value {
        if let Some(routine) = (self.elementary.unary)(function) {
            return self.call(Shape::Unary, routine as *const (), &[a])[0];
        }
        match function {
            Function::Sqrt => self.builder.ins().sqrt(a),
            Function::Abs => self.builder.ins().fabs(a),
            // The sign, as all others are routines. Zero and NaN are preserved, as in the runtime.
            _ => {
                let [zero, one, minus_one] =
                    [0.0, 1.0, -1.0].map(|number| self.builder.ins().f64const(number));
                let below = self.choose(FloatCC::LessThan, [a, zero], [minus_one, a]);
                self.choose(FloatCC::GreaterThan, [a, zero], [one, below])
            }
        }
    }

    fn argument(&mut self, argument: Argument) -> ir::Value {
        let (array, index) = match argument {
            Argument::Time => return self.received.time,
            Argument::State(index) => (self.received.states, index),
            Argument::Input(index) => (self.received.inputs, index),
            Argument::Parameter(index) => (self.received.parameters, index),
            Argument::Weight(index)
            | Argument::OutputWeight(index)
            | Argument::Acceleration(index) => (self.received.weights, index),
        };
        let (flags, place) = (MemFlagsData::trusted(), offset(index as usize));
        self.builder.ins().load(F64, flags, array, place)
    }

    /// Calls a function of this process by its address.
    fn call(&mut self, shape: Shape, routine: *const (), arguments: &[ir::Value]) -> &[ir::Value] {
        let config = self.config;
        let builder = &mut self.builder;
        let signature = *self
            .signatures
            .entry(shape)
            .or_insert_with(|| builder.import_signature(shape.signature(config)));
        let routine = self.address(routine.addr());
        let call = self
            .builder
            .ins()
            .call_indirect(signature, routine, arguments);
        self.builder.inst_results(call)
    }

    fn address(&mut self, address: usize) -> ir::Value {
        let pointer = self.config.pointer_type();
        self.builder
            .ins()
            .iconst(pointer, address.cast_signed() as i64)
    }
}

impl<'a> Results<'a> {
    fn new(arrays: &'a [ResultArray]) -> Self {
        let mut places: FxHashMap<Value, Vec<(usize, usize)>> = FxHashMap::default();
        for (array, result) in arrays.iter().enumerate() {
            for (entry, &value) in result.entries.iter().enumerate() {
                places.entry(value).or_default().push((array, entry));
            }
        }
        Self {
            arrays,
            addresses: vec![None; arrays.len()],
            places,
        }
    }
}

impl Shape {
    fn signature(self, config: TargetFrontendConfig) -> Signature {
        let pointer = config.pointer_type();
        let convention = config.default_call_conv;
        match self {
            Self::Unary => signature_of(convention, &[F64], &[F64]),
            Self::Binary => signature_of(convention, &[F64, F64], &[F64]),
            Self::Pair => signature_of(convention, &[F64, pointer], &[]),
            Self::System => signature_of(convention, &[pointer; 3], &[]),
        }
    }
}

fn signature_of(convention: CallConv, parameters: &[Type], results: &[Type]) -> Signature {
    let mut signature = Signature::new(convention);
    signature.params = parameters.iter().copied().map(AbiParam::new).collect();
    signature.returns = results.iter().copied().map(AbiParam::new).collect();
    signature
}

/// Offset of an entry; the checked limits keep it within 32 bits.
fn offset(index: usize) -> i32 {
    i32::try_from(index * size_of::<f64>()).unwrap_or(i32::MAX)
}

fn slot(builder: &mut FunctionBuilder<'_>, bytes: usize) -> StackSlot {
    // The checked limits keep every slot below a mebibyte.
    let bytes = u32::try_from(bytes).unwrap_or(u32::MAX);
    let kind = StackSlotKind::ExplicitSlot;
    builder.create_sized_stack_slot(StackSlotData::new(kind, bytes, 3))
}
