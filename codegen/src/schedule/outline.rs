//! Layout of a function's text: which nodes are bound, their consumers and their paragraphs.

use rustc_hash::FxHashMap;

use super::dag::{Dag, Id, Item, Op};
use super::lower::definition;
use crate::program::Function;
use crate::symbolic::Function as Elementary;
use crate::tape::Argument;

/// Decisions about every node.
pub(super) struct Outline<'a> {
    dag: &'a Dag,
    /// The nodes, operands before users.
    pub(super) order: Vec<Id>,
    uses: Vec<u32>,
    /// Nodes that must not be written inside other expressions.
    pub(super) bound: Vec<bool>,
    /// Sine and cosine of the same angle: the partner.
    pub(super) partner: Vec<Option<Id>>,
    /// The result's name if the node is a result, and whether it denotes minus the node.
    pub(super) labels: Vec<Option<(String, bool)>>,
    /// Nodes named after a matrix entry.
    entries: Vec<bool>,
    /// The first named value or result that depends on the node.
    pub(super) feeds: Vec<Option<Id>>,
    /// The immediate user of the node on the path to that consumer.
    pub(super) wholes: Vec<Option<Id>>,
    /// Headings with the intermediate values that are computed under them before the results.
    stages: Vec<(String, Vec<Id>)>,
    /// The group in which a node is computed.
    groups: Vec<Option<usize>>,
}

impl<'a> Outline<'a> {
    /// The layout of a function.
    pub(super) fn new(function: &Function, dag: &'a Dag) -> Self {
        let order = dag.order();
        let mut outline = Self {
            dag,
            uses: dag.uses(&order),
            bound: vec![false; dag.len()],
            partner: vec![None; dag.len()],
            labels: vec![None; dag.len()],
            entries: vec![false; dag.len()],
            feeds: vec![None; dag.len()],
            wholes: vec![None; dag.len()],
            stages: Vec::new(),
            groups: vec![None; dag.len()],
            order,
        };
        outline.label_results(function);
        outline.stages(function);
        outline.pair_sines();
        outline.choose_bound();
        outline.find_feeds();
        outline.find_groups(function);
        outline
    }

    /// Binds the results, named after their entries.
    fn label_results(&mut self, function: &Function) {
        let texts = function.results.iter().flat_map(|array| {
            let entry = array.layout.has_columns();
            array.labels.iter().map(move |text| (text, entry))
        });
        for (result, (text, entry)) in self.dag.results.iter().zip(texts) {
            let label = &mut self.labels[result.id.index()];
            if label.is_none() {
                *label = Some((text.clone(), result.flip));
                self.entries[result.id.index()] = entry;
            }
            self.bound[result.id.index()] = true;
        }
    }

    /// Binds the displayed intermediate values.
    fn stages(&mut self, function: &Function) {
        let mut kept = FxHashMap::default();
        for &id in &self.order {
            if let Op::Kept(inner) = self.dag.op(id) {
                self.bound[inner.index()] = !self.dag.is_leaf(*inner);
                let label = self.labels[id.index()].clone();
                self.labels[inner.index()] = self.labels[inner.index()].take().or(label);
                if let Some(name) = self.dag.names[inner.index()] {
                    kept.insert(name.definition, *inner);
                }
            }
        }
        for stage in &function.stages {
            let definitions = stage
                .values
                .iter()
                .filter_map(|&value| definition(&function.graph, value));
            let ids = definitions.filter_map(|definition| kept.get(&definition).copied());
            self.stages.push((stage.title.clone(), ids.collect()));
        }
    }

    /// Sine and cosine of the same angle are computed together.
    fn pair_sines(&mut self) {
        let mut sines: Vec<(Item, Elementary, Id)> = self
            .order
            .iter()
            .filter_map(|&id| match self.dag.op(id) {
                Op::Function(kind @ (Elementary::Sin | Elementary::Cos), angle) => {
                    Some((*angle, *kind, id))
                }
                _ => None,
            })
            .collect();
        sines.sort_unstable();
        for pair in sines.windows(2) {
            if pair[0].0 == pair[1].0 {
                let (sin, cos) = (pair[0].2, pair[1].2);
                self.partner[sin.index()] = Some(cos);
                self.partner[cos.index()] = Some(sin);
            }
        }
    }

    /// Binds values with several uses, reciprocals, and named values of more than one operation.
    fn choose_bound(&mut self) {
        for &id in &self.order {
            let i = id.index();
            let parts = match self.dag.op(id) {
                Op::Number(_) | Op::Argument(_) => {
                    self.bound[i] = false;
                    continue;
                }
                Op::Sum(items) | Op::Product(items) => items.len(),
                Op::Solution { system, .. } => {
                    let system = &self.dag.systems[*system as usize];
                    for item in system.matrix.iter().chain(&system.right) {
                        self.bound[item.id.index()] |= !self.dag.is_leaf(item.id);
                    }
                    usize::MAX
                }
                _ => 1,
            };
            let sum = matches!(self.dag.op(id), Op::Sum(_));
            let reciprocal = matches!(self.dag.op(id), Op::Product(_)) && parts == 1;
            let worth_reading = match self.dag.names[i] {
                Some(name) => parts > 2 || sum && !name.automatic,
                None => false,
            };
            self.bound[i] |= self.uses[i] >= 2
                || worth_reading
                || reciprocal
                || parts == usize::MAX
                || self.partner[i].is_some();
        }
    }

    /// Propagates the consumers from the results to their operands.
    fn find_feeds(&mut self) {
        for &id in self.order.iter().rev() {
            let telling = self.dag.names[id.index()].is_some_and(|name| !name.automatic);
            let named = self.bound[id.index()] && (telling || self.labels[id.index()].is_some());
            if named {
                self.feeds[id.index()] = Some(id);
            }
            let feed = self.feeds[id.index()];
            self.dag.for_each_part(id, |part| {
                self.feeds[part.id.index()] = feed;
                self.wholes[part.id.index()] = Some(id);
            });
        }
    }

    /// Assigns nodes to the groups of the function.
    fn find_groups(&mut self, function: &Function) {
        for &id in &self.order {
            let Some(name) = self.dag.names[id.index()] else {
                continue;
            };
            let name = &function.graph.definition(name.definition).name;
            if self.bound[id.index()] {
                self.groups[id.index()] = function.groups.iter().position(|g| g.holds(name));
            }
        }
    }

    /// The paragraphs, each preceded by the groups that it is the first to use; `first` precedes
    /// all.
    fn with_groups(
        &self,
        function: &Function,
        first: Vec<(String, Vec<Id>)>,
        paragraphs: Vec<(String, Vec<Id>)>,
    ) -> Vec<(String, Vec<Id>)> {
        let mut seen = vec![false; self.dag.len()];
        let mut all = first;
        for (_, roots) in &all {
            self.dag.visit_from(roots, &mut seen, |_| {});
        }
        for (title, roots) in paragraphs {
            let mut together = vec![Vec::new(); function.groups.len()];
            self.dag.visit_from(&roots, &mut seen, |id| {
                if let Some(group) = self.groups[id.index()] {
                    together[group].push(id);
                }
            });
            let groups = function.groups.iter().zip(together);
            all.extend(groups.map(|(group, ids)| (group.title.clone(), ids)));
            all.push((title, roots));
        }
        all
    }

    /// Whether a node has several users or results.
    pub(super) fn is_shared(&self, id: Id) -> bool {
        self.uses[id.index()] > 1
    }

    /// Whether the node is named after a matrix entry.
    pub(super) fn is_entry(&self, id: Id) -> bool {
        self.entries[id.index()] || self.labels[id.index()].is_none()
    }

    /// Whether a node has users in addition to being a result.
    pub(super) fn feeds_others(&self, id: Id) -> bool {
        let results = self.dag.results.iter().filter(|result| result.id == id);
        self.uses[id.index()] as usize > results.count()
    }

    /// Titles and the root nodes of their paragraphs.
    pub(super) fn paragraphs(&self, function: &Function) -> Vec<(String, Vec<Id>)> {
        let order = &self.order;
        let mut only_parameters = vec![false; self.dag.len()];
        for &id in order {
            let mut all =
                !matches!(self.dag.op(id), Op::Argument(a) if !matches!(a, Argument::Parameter(_)));
            self.dag
                .for_each_part(id, |part| all &= only_parameters[part.id.index()]);
            only_parameters[id.index()] = all;
        }
        let sines = order.iter().copied().filter(|id| match self.dag.op(*id) {
            Op::Function(Elementary::Sin | Elementary::Cos, angle) => {
                self.bound[id.index()] && matches!(self.dag.op(angle.id), Op::Argument(_))
            }
            _ => false,
        });
        let parameters = order
            .iter()
            .copied()
            .filter(|id| only_parameters[id.index()] && self.bound[id.index()]);
        let first = vec![
            ("Sines and cosines.".to_owned(), sines.collect()),
            (
                "Combinations of parameters.".to_owned(),
                parameters.collect(),
            ),
        ];
        let mut paragraphs = self.stages.clone();
        let mut untitled = Vec::new();
        let mut results = self.dag.results.as_slice();
        for array in &function.results {
            let (own, rest) = results.split_at(array.entries.len().min(results.len()));
            for paragraph in &array.paragraphs {
                let entries = paragraph.entries.iter().filter_map(|&entry| own.get(entry));
                let ids = entries.map(|item| item.id).collect();
                paragraphs.push((paragraph.title.clone(), ids));
            }
            untitled.extend(own.iter().map(|item| item.id));
            results = rest;
        }
        paragraphs.push((String::new(), untitled));
        self.with_groups(function, first, paragraphs)
    }
}
