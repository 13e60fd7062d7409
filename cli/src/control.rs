//! Designs of controllers: what is asked for, what comes out, and how it is told.

pub(crate) mod ask;
pub(crate) mod attraction;
pub(crate) mod design;
pub(crate) mod explain;
pub(crate) mod law_file;
pub(crate) mod report;
