//! Jumps and kinks of the equations that time alone decides, such as those of `if(t < t_brake, …)`.
//! An integrator has to end a step at each.

use super::symbols::{Symbols, ids};
use crate::symbolic::{Expr, Function, Graph, Node};

/// The relations and signs inside `roots` that depend on time and, at most, on parameters. A
/// relation is 1 where it holds and 0 elsewhere; each value is constant between its jumps.
pub fn switches(graph: &mut Graph, symbols: &Symbols, roots: &[Expr]) -> Vec<Expr> {
    let time = ids(graph, &[symbols.time]);
    let known = ids(
        graph,
        &[symbols.parameters.as_slice(), &[symbols.time, symbols.pi]].concat(),
    );
    let by_time = |graph: &Graph, operands: &[Expr]| {
        let all = graph.in_order(operands);
        let mut symbols = all.into_iter().filter_map(|e| graph.as_symbol(e));
        operands.iter().any(|&e| graph.mentions(e, &time)) && symbols.all(|s| known.contains(&s))
    };
    let mut switches = Vec::new();
    for expr in graph.in_order(roots) {
        let switch = match *graph.node(expr) {
            Node::Choice {
                relation, compared, ..
            } if by_time(graph, &compared) => {
                graph.choice(relation, compared, [Graph::ONE, Graph::ZERO])
            }
            Node::Function(Function::Abs | Function::Sign, argument)
                if by_time(graph, &[argument]) =>
            {
                graph.function(Function::Sign, argument)
            }
            _ => continue,
        };
        if graph.as_number(switch).is_none() && !switches.contains(&switch) {
            switches.push(switch);
        }
    }
    switches
}
