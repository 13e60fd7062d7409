/// A set of candidates, fitted.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// Indices of the candidates; none for the nominal model.
    pub(super) members: Vec<usize>,
    /// Places of the values.
    pub(super) layout: Layout,
    pub(super) fit: Fit,
    pub(super) evidence: Evidence,
}

impl Fitted {
    /// Whether the recordings tell the sizes of all members from zero.
    pub(super) fn is_there(&self) -> bool {
        self.evidence.smallest > 1.0
    }
}
