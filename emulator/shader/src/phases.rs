//! Phases of a frame, and their times.

use std::time::{Duration, Instant};

/// A part of the work on a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Set-up of triangles (as long as the frame waits for it), visibility, attributes of the fragments and of rays that hit nothing, means of
    /// samples.
    FrontEnd,
    /// Datapath from ports to footprints and surfaces, of maps and of reflections.
    Footprints,
    /// Fetches and filters of an object's own maps, and the ports made from them.
    Maps,
    /// Lights, with the peaks that they read.
    Lights,
    /// Probes, fetches and filters of the environment, and its blend with the surface: one function, sixteen or 32 fragments at a time.
    Environment,
}

impl Phase {
    /// Every phase, in the order of a fragment.
    pub const ALL: [Self; 5] = [Self::FrontEnd, Self::Footprints, Self::Maps, Self::Lights, Self::Environment];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::FrontEnd => "front end",
            Self::Footprints => "footprints",
            Self::Maps => "maps",
            Self::Lights => "lights",
            Self::Environment => "environment",
        }
    }
}

/// Time of each phase, summed over all threads.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhaseTimes([Duration; Phase::ALL.len()]);

impl PhaseTimes {
    /// Time of one phase.
    pub fn time(&self, phase: Phase) -> Duration {
        self.0[phase as usize]
    }

    /// Time of all phases.
    pub fn sum(&self) -> Duration {
        self.0.iter().sum()
    }

    /// Adds the times of another piece of the frame.
    pub fn add(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            *own += *other;
        }
    }
}

/// Clock of the phase that a thread is in. It is read a few times a batch: 20 ns each, for some 128 fragments.
pub struct PhaseClock {
    times: PhaseTimes,
    phase: Phase,
    since: Instant,
}

impl PhaseClock {
    /// Starts the clock in the front end.
    pub fn start() -> Self {
        Self { times: PhaseTimes::default(), phase: Phase::FrontEnd, since: Instant::now() }
    }

    /// Enters a phase and returns the phase that it leaves.
    pub fn enter(&mut self, phase: Phase) -> Phase {
        let now = Instant::now();
        self.times.0[self.phase as usize] += now - self.since;
        self.since = now;
        std::mem::replace(&mut self.phase, phase)
    }

    /// Stops the clock and returns the time of each phase.
    pub fn stop(mut self) -> PhaseTimes {
        self.enter(Phase::FrontEnd);
        self.times
    }
}
