//! Frames and points: ordered so that each comes after its parent.

use std::collections::BTreeMap;

use crate::ast::{ItemAst, ValueAst};
use crate::diagnostic::Code;
use crate::expr::Expr;
use crate::language::{Sense, Target};
use crate::mechanism::{Axis, Frame, GROUND, Point, Turn};
use crate::units::Dimension;

use super::dimensions::Dim;
use super::place::Place;
use super::resolver::Resolver;

const ANGLE: Place = Place::geometry("the angle of a frame");
const POSITION: Place = Place::geometry("the position of a point");

impl<'a> Resolver<'a> {
    pub(super) fn frames(&mut self) -> Vec<Frame> {
        let ordered = self.ordered("frames", "parent", Target::Frame);
        let mut frames = vec![Frame {
            name: "ground".to_owned(),
            about: "inertial frame".to_owned(),
            parent: None,
            turns: Vec::new(),
            quaternion: None,
            line: 0,
            span: 0..0,
        }];
        for item in ordered {
            let parent = self.reference(item, "parent");
            let quaternion = self.quaternion(item);
            let turns = match item.entry("turns").map(|e| &e.value) {
                Some(ValueAst::Tables(turns)) => turns.iter().map(|t| self.turn(t)).collect(),
                _ if item.entry("quaternion").is_some() => Vec::new(),
                _ => vec![self.turn(item)],
            };
            frames.push(Frame {
                name: item.name.value.clone(),
                about: Self::about(item),
                parent: Some(parent),
                turns,
                quaternion,
                line: self.line(&item.name.span),
                span: item.name.span.clone(),
            });
        }
        frames
    }

    fn turn(&mut self, item: &ItemAst) -> Turn {
        let (axis, negative) = axis(item, "about_axis");
        Turn {
            axis,
            negative,
            angle: self.expression_of(item, "by", &ANGLE, Dim::NONE),
        }
    }

    pub(super) fn points(&mut self) -> Vec<Point> {
        let ordered = self.ordered("points", "from", Target::Point);
        let nowhere = Expr::integer(0, 0..0);
        let mut points = vec![Point {
            name: "O".to_owned(),
            about: "origin of the ground".to_owned(),
            from: None,
            frame: GROUND,
            at: [nowhere.clone(), nowhere.clone(), nowhere],
            line: 0,
            span: 0..0,
        }];
        for item in ordered {
            let from = self.reference(item, "from");
            points.push(Point {
                name: item.name.value.clone(),
                about: Self::about(item),
                from: Some(from),
                frame: self.reference(item, "in"),
                at: self.components_of(item, "at", &POSITION, Dim::Known(Dimension::LENGTH)),
                line: self.line(&item.name.span),
                span: item.name.span.clone(),
            });
        }
        points
    }

    /// Items of a section, each after the one that it refers to under `key`; among themselves
    /// they keep the order of the text. Their names get the indices of the result, from 1.
    fn ordered(&mut self, section: &str, key: &str, target: Target) -> Vec<&'a ItemAst> {
        let ast = self.ast;
        let mut waiting: Vec<&ItemAst> = Vec::new();
        for item in ast.items(section) {
            if matches!(item.name.value.as_str(), "ground" | "O")
                && self.registry(target).contains_key(item.name.value.as_str())
            {
                self.given(item);
            } else {
                waiting.push(item);
            }
        }
        let own: BTreeMap<&str, &ItemAst> = waiting
            .iter()
            .map(|item| (item.name.value.as_str(), *item))
            .collect();
        let mut ordered: Vec<&ItemAst> = Vec::new();
        loop {
            let before = ordered.len();
            let registry = self.registry(target);
            waiting.retain(|item| {
                let parent = item.text(key).map_or("", |p| p.value);
                // A parent that does not exist is reported when it is looked up.
                let ready = registry.contains_key(parent) || !own.contains_key(parent);
                if ready {
                    ordered.push(item);
                    registry.insert(item.name.value.as_str(), ordered.len());
                }
                !ready
            });
            if ordered.len() == before {
                break;
            }
        }
        // The remaining items depend on a cycle.
        self.circles(&waiting, key, target);
        for item in &waiting {
            ordered.push(item);
            let index = ordered.len();
            self.registry(target)
                .insert(item.name.value.as_str(), index);
        }
        ordered
    }

    fn registry(&mut self, target: Target) -> &mut BTreeMap<&'a str, usize> {
        match target {
            Target::Frame => &mut self.frames,
            Target::Body => &mut self.bodies,
            Target::Constraint => &mut self.constraints,
            Target::Load => &mut self.loads,
            Target::Point | Target::Coordinate | Target::PseudoVelocity => &mut self.points,
        }
    }

    fn given(&mut self, item: &ItemAst) {
        let name = &item.name.value;
        let message = format!("`{name}` is predefined and cannot be defined again");
        let help = "choose another name";
        self.error(Code::ReservedName, item.name.span.clone(), message, help);
    }

    /// Reports each circular definition once.
    fn circles(&mut self, waiting: &[&ItemAst], key: &str, target: Target) {
        let parents: BTreeMap<&str, &str> = waiting
            .iter()
            .filter_map(|item| Some((item.name.value.as_str(), item.text(key)?.value)))
            .collect();
        let mut seen: Vec<&str> = Vec::new();
        for item in waiting {
            let start = item.name.value.as_str();
            let mut path: Vec<&str> = Vec::new();
            let mut name = start;
            while !seen.contains(&name) {
                seen.push(name);
                path.push(name);
                name = parents.get(name).copied().unwrap_or(name);
            }
            let Some(first) = path.iter().position(|n| *n == name) else {
                continue;
            };
            let mut circle: Vec<&str> = path[first..].to_vec();
            circle.push(name);
            let circle: Vec<String> = circle.iter().map(|n| format!("`{n}`")).collect();
            let at = waiting
                .iter()
                .find(|i| i.name.value == name)
                .map_or(0..0, |i| i.name.span.clone());
            let message = format!(
                "circular definition of {}s: {}",
                target.word(),
                circle.join(" from ")
            );
            let help = match target {
                Target::Frame => "rotate one of them from `ground`",
                _ => "place one of them from `O`",
            };
            self.error(Code::ReferenceCycle, at, message, help);
        }
    }
}

/// The axis under a key, and whether it is the negative one; z where the word could not be read.
pub(super) fn axis(item: &ItemAst, key: &str) -> (Axis, bool) {
    match item.word(key) {
        Some(Sense::Axis { axis, negative }) => (axis, negative),
        _ => (Axis::Z, false),
    }
}
