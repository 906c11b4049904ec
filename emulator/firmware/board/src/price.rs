//! Price of every plan on every processor, as one table.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use indicatif::ProgressBar;

use crate::measure::{self, ALL_EFFECTS, Measured, Numbers};
use crate::target::{self, Target};
use crate::{Failure, clocks};

/// Plans, as [`Target::build`] reads them, with a description.
const PLANS: [(&str, &str); 18] = [
    ("reflection", "environment"),
    ("reflection+bump", "environment, bump"),
    ("reflection+footprint", "environment, footprint"),
    ("reflection+footprint+curvature", "environment, footprint, curvature"),
    ("reflection+footprint+isotropic", "environment, footprint, isotropic roughness"),
    ("reflection+footprint+anisotropic", "environment, footprint, anisotropic roughness"),
    (ALL_EFFECTS, "reflection, all effects"),
    (
        "small-code/reflection+bump+curvature+footprint+anisotropic",
        "reflection, all effects, with the feature `small-code`",
    ),
    ("ports+bump+curvature+footprint+anisotropic", "reflection, all effects, with the outcome of every stage"),
    ("pixel", "pixel of an environment: one probe, colour"),
    ("pixel+bump+curvature+footprint+anisotropic", "pixel, all effects: with probes and colour"),
    ("highlight", "highlight"),
    ("highlight+bump", "highlight, bump"),
    ("highlight+anisotropic", "highlight, anisotropic roughness"),
    ("highlight+bump+anisotropic", "highlight, all effects"),
    ("peak", "peak"),
    ("peak+horizon", "peak, horizon"),
    ("texture", "footprint in a wrapped map"),
];

/// Profiles with the bits that they keep, narrowest first.
const PROFILES: [(&str, f64); 5] =
    [("narrow", 14.0), ("paper", 16.0), ("compact", 16.0), ("standard", 20.0), ("precise", 26.0)];

/// Work around a plan: its name in the output of the program, with a description.
const AROUND: [(&str, &str); 7] = [
    ("probe", "a probe of an environment: its place and weight"),
    ("colour", "a probe with its eight texels and their filter"),
    ("fragment", "set-up of a fragment on a scanline"),
    ("textured", "set-up of a fragment with texture coordinates"),
    ("triangle", "set-up of a triangle"),
    ("float libm", "reflection, all effects, in f32 with libm"),
    ("float micromath", "reflection, all effects, in f32 with micromath"),
];

/// Plans whose prices show whether the kept table is still that of the datapath.
const HELD: [&str; 4] =
    [ALL_EFFECTS, "pixel+bump+curvature+footprint+anisotropic", "highlight+bump+anisotropic", "peak+horizon"];

/// Price of one plan.
#[derive(Clone, Copy, Debug)]
struct Cost {
    instructions: u64,
    stack: u64,
    bytes: u64,
}

/// Kept table, from the project's root.
const KEPT: &str = "emulator/firmware/PRICE.md";

/// Path of the kept table.
pub fn kept() -> PathBuf {
    target::root().join(KEPT)
}

/// Text of the kept table.
pub fn table() -> Result<String, Failure> {
    std::fs::read_to_string(kept()).map_err(|error| Failure::trouble(format!("{KEPT}: {error}")))
}

/// Prices some plans in `standard` again and compares them with the kept table, which must be right within a thirtieth. A change of a few
/// instructions is no reason for a new table, which takes ten minutes. A missed update is: it can be wrong by a third (a probe with eight texels).
///
/// Numbers of another compiler are not compared.
pub fn hold(target: Target) -> Result<(), Failure> {
    let table = table()?;
    let name = target.name();
    let part =
        Part::for_target(&table, target).ok_or_else(|| Failure::trouble(format!("{KEPT} has no part for {name}")))?;
    if !part.has_line(&format!("{}.", target.compiler())) {
        println!("{name:12} {KEPT} was made by another compiler: not compared");
        return Ok(());
    }
    let mut now: Vec<(&str, u64)> = Vec::new();
    for (plan, what) in PLANS.into_iter().filter(|(plan, _)| HELD.contains(plan)) {
        now.push((what, measure::measure(target, "plan", plan, "standard")?.numbers["instructions"]));
    }
    let around = measure::measure(target, "around", "empty", "standard")?.numbers;
    now.extend(AROUND.map(|(program, what)| (what, around[program])));
    let mut most = 0.0_f64;
    for (what, now) in now {
        let Some(before) = part.number(what, "standard") else {
            return Err(Failure::trouble(format!("{KEPT} has no `{what}` for {name} in standard")));
        };
        let moved = (now as f64 / before as f64 - 1.0).abs();
        if moved > 1.0 / 30.0 {
            return Err(Failure::broken(format!(
                "{KEPT}: `{what}` of {name} takes {now} instructions, not {before}; `cargo firmware price` and `price --knobs` make both \
                 tables again, `roughxel study --full -o emulator/study/results` what is read from them"
            )));
        }
        most = most.max(moved);
    }
    println!("{name:12} prices within {:.1} % of {KEPT}", 100.0 * most);
    Ok(())
}

/// Part of a table for one processor.
struct Part<'a>(&'a str);

impl<'a> Part<'a> {
    fn for_target(table: &'a str, target: Target) -> Option<Self> {
        let (_, part) = table.split_once(&format!("\n## {}\n", target.name()))?;
        Some(Self(part.split_once("\n## ").map_or(part, |(part, _)| part)))
    }

    fn has_line(&self, line: &str) -> bool {
        self.0.lines().any(|of| of == line)
    }

    /// First number in a row and the column of a profile.
    fn number(&self, row: &str, profile: &str) -> Option<u64> {
        let cells = |line: &'a str| line.trim_matches('|').split('|').map(str::trim);
        let column = cells(self.0.lines().find(|line| line.starts_with('|'))?).position(|name| name == profile)?;
        let row = self.0.lines().find(|line| cells(line).next() == Some(row))?;
        cells(row).nth(column)?.split(' ').next()?.parse().ok()
    }
}

/// Writes the table.
pub fn run(quick: bool, file: Option<PathBuf>) -> Result<(), Failure> {
    let all = ["narrow", "paper", "compact", "standard", "precise"];
    let some = ["narrow", "standard"];
    let targets: &[(Target, &[&str])] = if quick {
        &[(Target::Riscv32Imac, &some)]
    } else {
        &[(Target::Riscv32Imac, &all), (Target::Riscv32I, &some), (Target::ThumbV7M, &some)]
    };
    let points: usize = targets.iter().map(|(_, profiles)| profiles.len() * (PLANS.len() + 2) + 1).sum();
    let progress = measure::progress(points)?;
    let mut text = String::from(
        "# What the datapath costs on small processors\n\n\
         Made by `cargo firmware price`; the same numbers every time with one compiler. Instructions are means over 64 fragments of the tile \
         that `cargo firmware check` draws, counted by QEMU; with caches and waits they are no cycles. Bytes are code, constants and \
         tables beyond a program that does nothing; stack is that of the call.\n",
    );
    for &(target, profiles) in targets {
        tabulate(target, profiles, &progress, &mut text)?;
    }
    progress.finish_and_clear();
    if !quick {
        text += &clocks::part()?;
    }
    let file = match (file, quick) {
        (Some(file), _) => file,
        (None, true) => {
            print!("{text}");
            return Ok(());
        }
        (None, false) => kept(),
    };
    measure::write_whole(&file, &text)
}

fn tabulate(target: Target, profiles: &[&str], progress: &ProgressBar, text: &mut String) -> Result<(), Failure> {
    let write = |text: &mut String, line: String| {
        text.push_str(&line);
        text.push('\n');
    };
    let measure = |program: &str, plan: &str, profile: &str| {
        progress.set_message(format!("{} {plan} {profile}", target.name()));
        let measured = measure::measure(target, program, plan, profile)?;
        progress.inc(1);
        Ok(measured)
    };
    let empty = measure("plan", "empty", "standard")?.image;
    let mut costs: BTreeMap<(&str, &str), Cost> = BTreeMap::new();
    let mut stages: BTreeMap<&str, Numbers> = BTreeMap::new();
    let mut tables: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for &profile in profiles {
        for (plan, _) in PLANS {
            let Measured { numbers, image } = measure("plan", plan, profile)?;
            let cost = Cost {
                instructions: numbers["instructions"],
                stack: numbers["stack"],
                bytes: image.bytes - empty.bytes,
            };
            costs.insert((plan, profile), cost);
            if profile == "standard" {
                tables.insert(plan, image.tables.keys().cloned().collect());
            }
        }
        let mut all = measure("stages", "empty", profile)?.numbers;
        all.extend(measure("around", "empty", profile)?.numbers);
        stages.insert(profile, all);
    }

    let heading = |text: &mut String, first: &str| {
        write(text, format!("\n| {first} | {} |", profiles.join(" | ")));
        write(text, format!("|---|{}", "---:|".repeat(profiles.len())));
    };
    write(text, format!("\n## {}\n\n{}.", target.name(), target.compiler()));
    heading(text, "plan: instructions a fragment (bytes, stack)");
    for (plan, name) in PLANS {
        let cells = profiles.iter().map(|profile| {
            let Cost { instructions, stack, bytes } = costs[&(plan, *profile)];
            format!("{instructions} ({bytes}, {stack})")
        });
        write(text, format!("| {name} | {} |", cells.collect::<Vec<_>>().join(" | ")));
    }
    heading(text, "stage, all effects: instructions");
    let first = &stages[profiles[0]];
    for name in first.keys().filter(|name| name.starts_with("stage ")) {
        let cells = profiles.iter().map(|profile| stages[profile].get(name).map_or("–".into(), u64::to_string));
        let shown = name.trim_start_matches("stage ").replacen(' ', ": ", 1);
        write(text, format!("| {shown} | {} |", cells.collect::<Vec<_>>().join(" | ")));
    }
    heading(text, "around the datapath: instructions");
    for (name, what) in AROUND {
        let cells = profiles.iter().map(|profile| stages[profile].get(name).map_or("–".into(), u64::to_string));
        write(text, format!("| {what} | {} |", cells.collect::<Vec<_>>().join(" | ")));
    }

    let price = |profile: &str| costs[&(ALL_EFFECTS, profile)].instructions as f64;
    let float = |library: &str| stages[profiles[0]][&format!("float {library}")] as f64;
    let mut say = String::new();
    if let (Some(narrow), Some(standard)) = (profiles.first(), profiles.iter().find(|profile| **profile == "standard"))
    {
        let kept = |name: &str| PROFILES.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, bits)| *bits);
        let bits = kept(standard) - kept(narrow);
        let _ = write!(
            say,
            "\nAll effects: `narrow` takes {:.2} of `standard`, a bit of accuracy between them {:.0} instructions",
            price(narrow) / price(standard),
            (price(standard) - price(narrow)) / bits,
        );
        if profiles.contains(&"precise") {
            let _ = write!(
                say,
                ", from there to `precise` {:.0}",
                (price("precise") - price(standard)) / (kept("precise") - kept(standard))
            );
        }
        let _ = write!(
            say,
            ". f32 takes {:.1} (libm) and {:.1} (micromath) times as many as `standard`, {:.1} and {:.1} times as many as `narrow`. \
             Set-up of a fragment is {:.2} of shading it in `standard`, {:.2} in `narrow`.",
            float("libm") / price(standard),
            float("micromath") / price(standard),
            float("libm") / price(narrow),
            float("micromath") / price(narrow),
            stages["standard"]["fragment"] as f64 / price(standard),
            stages[narrow]["fragment"] as f64 / price(narrow),
        );
    }
    write(text, say);
    if let Some(tables) = tables.get("reflection") {
        write(text, format!("\nTables in the smallest plan in `standard`: {}.", tables.join(", ")));
    }
    Ok(())
}
