//! States of new joints and new filters in keyframes, which list all states of a robot.

use crate::model::Motion;
use crate::xml::{Element, children};

use super::bytes::numbers;
use super::change::Refused;
use super::sheet::{Sheet, read};

/// One coordinate of a list.
struct State {
    /// How many numbers it has before the changes.
    before: usize,
    /// The numbers that follow them afterwards.
    new: Vec<f64>,
    /// Whether its own numbers are removed.
    removed: bool,
}

impl State {
    fn kept(before: usize, new: Vec<f64>) -> Self {
        Self {
            before,
            new,
            removed: false,
        }
    }
}

impl<'x> Sheet<'x, '_> {
    /// Adds the states of new joints and filters to all keyframes.
    pub(super) fn write_keyframes(&mut self) -> Result<(), Refused> {
        let keys = children(self.root, "keyframe").flat_map(|all| children(all, "key"));
        let keys: Vec<Element<'x>> = keys.collect();
        if keys.is_empty() {
            return Ok(());
        }
        let activations = self.activations();
        for key in keys {
            if !self.plays.is_empty() {
                let positions = self.joint_states(|motion| match motion {
                    Motion::Ball => 4,
                    Motion::Free => 7,
                    _ => 1,
                });
                self.lengthen(key, "qpos", &positions)?;
                let rates = self.joint_states(Motion::freedoms);
                self.lengthen(key, "qvel", &rates)?;
            }
            if activations.iter().any(|[before, after]| before != after) {
                let commands = self.numbers(key, "", "ctrl")?.unwrap_or_default();
                let states = activations.iter().enumerate();
                let states = states.map(|(index, [before, after])| {
                    let new = (*after && !before)
                        .then(|| commands.get(index).copied().unwrap_or_default());
                    State {
                        before: usize::from(*before),
                        new: new.into_iter().collect(),
                        removed: *before && !after,
                    }
                });
                let states: Vec<State> = states.collect();
                self.lengthen(key, "act", &states)?;
            }
        }
        Ok(())
    }

    /// The joints, with a zero after those that get a second one.
    fn joint_states(&self, size: impl Fn(Motion) -> usize) -> Vec<State> {
        let joints = (self.robot.links.iter()).filter_map(|link| link.joint.as_ref());
        let states = joints.map(|joint| {
            let has_play = self.plays.iter().any(|(name, _)| *name == joint.name);
            State::kept(size(joint.motion), vec![0.0; usize::from(has_play)])
        });
        states.collect()
    }

    /// Writes a list of a keyframe anew; one of another length stays as it is.
    fn lengthen(
        &mut self,
        key: Element<'x>,
        list: &'static str,
        states: &[State],
    ) -> Result<(), Refused> {
        let Some(given) = key.attribute(list) else {
            return Ok(());
        };
        let all = read(given, key, list)?;
        if all.len() != states.iter().map(|state| state.before).sum::<usize>() {
            return Ok(());
        }
        let mut longer = Vec::new();
        let mut rest = all.as_slice();
        for state in states {
            let (own, next) = rest.split_at(state.before);
            if !state.removed {
                longer.extend_from_slice(own);
            }
            longer.extend_from_slice(&state.new);
            rest = next;
        }
        self.set(key, list, numbers(&longer))
    }
}
