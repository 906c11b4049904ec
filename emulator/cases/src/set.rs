//! What hard cases come in.

/// A named set of hard cases and the plan they run under.
#[derive(Clone, Debug)]
pub struct CaseSet<C, P = ()> {
    /// Short name, also the file name of the exported set.
    pub name: &'static str,
    /// What the set holds.
    pub description: &'static str,
    /// The cases: what goes into the ports.
    pub cases: Vec<C>,
    /// Stages they go through; nothing where all of them do.
    pub plan: P,
}
