//! What many motions share whose functions of time are the same.

use std::cell::RefCell;
use std::rc::Rc;

use super::pace::Pace;

/// Most entries of each kind: motions that switch at times of their own share nothing.
const MOST: usize = 32;

/// Limits of steps, and times at which functions of time change, for motions of one system.
#[derive(Debug, Clone, Default)]
pub struct SharedTimes(Rc<RefCell<Known>>);

#[derive(Debug, Default)]
struct Known {
    /// By start and end of a motion.
    paces: Vec<([f64; 2], Rc<Pace>)>,
    /// By the start of a search and the end of the motion.
    ahead: Vec<([f64; 2], Ahead)>,
}

/// A look ahead: up to a time nothing changes, where something may.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ahead {
    pub(super) until: f64,
    pub(super) is_change: bool,
}

impl SharedTimes {
    /// The limits of steps in a span, found once.
    pub(super) fn pace(&self, span: [f64; 2], find: impl FnOnce() -> Pace) -> Rc<Pace> {
        once(self, |known| &mut known.paces, span, || Rc::new(find()))
    }

    /// A look ahead, found once.
    pub(super) fn ahead(&self, span: [f64; 2], find: impl FnOnce() -> Ahead) -> Ahead {
        once(self, |known| &mut known.ahead, span, find)
    }
}

/// The entry of a span, or a new one.
fn once<T: Clone>(
    shared: &SharedTimes,
    of: impl Fn(&mut Known) -> &mut Vec<([f64; 2], T)>,
    span: [f64; 2],
    find: impl FnOnce() -> T,
) -> T {
    let bits = |span: [f64; 2]| span.map(f64::to_bits);
    let is_own = |(own, _): &&([f64; 2], T)| bits(*own) == bits(span);
    if let Some((_, known)) = of(&mut shared.0.borrow_mut()).iter().find(is_own) {
        return known.clone();
    }
    let found = find();
    let mut known = shared.0.borrow_mut();
    let entries = of(&mut known);
    if entries.len() < MOST {
        entries.push((span, found.clone()));
    }
    found
}
