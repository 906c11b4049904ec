//! Sets of hard cases.

/// A named set of hard cases and the plan they run under.
#[derive(Clone, Debug)]
pub struct CaseSet<C, P = ()> {
    /// Short name, also the file name of the exported set.
    pub name: &'static str,
    /// Contents of the set.
    pub description: &'static str,
    /// Cases: values of the ports.
    pub cases: Vec<C>,
    /// Stages that they pass; nothing if they pass all.
    pub plan: P,
}
