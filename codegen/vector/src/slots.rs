//! Blocks of the frame.

use std::collections::BTreeSet;

/// Allocation of the blocks of the frame.
#[derive(Debug)]
pub(crate) struct Slots {
    free: BTreeSet<u32>,
    len: u32,
}

impl Slots {
    /// The first blocks are permanently allocated.
    pub(crate) fn new(fixed: u32) -> Self {
        Self {
            free: BTreeSet::new(),
            len: fixed,
        }
    }

    /// Allocates adjacent blocks at the lowest free position; returns the first.
    pub(crate) fn take(&mut self, count: u32) -> u32 {
        let first = self.free_run(count).unwrap_or(self.len);
        for slot in first..first + count {
            self.free.remove(&slot);
        }
        self.len = self.len.max(first + count);
        first
    }

    fn free_run(&self, count: u32) -> Option<u32> {
        let mut run = 0;
        let mut last = None;
        for &slot in &self.free {
            run = if last == slot.checked_sub(1) {
                run + 1
            } else {
                1
            };
            last = Some(slot);
            if run == count {
                return Some(slot + 1 - count);
            }
        }
        None
    }

    pub(crate) fn release(&mut self, slot: u32) {
        self.free.insert(slot);
    }

    /// Number of blocks ever allocated.
    pub(crate) fn len(&self) -> u32 {
        self.len
    }
}
