//! Shell commands on the pages of `vectors`, run as they stand in a copy of the folder. The pages say what they print.

use std::fs;
use std::process::Command;

use crate::fixture::{Folder, Run, repository};

/// Returns true if all tools are installed, and prints a message if one is not.
///
/// Panics if one is missing and `ROUGHXEL_REQUIRE_TOOLS` is set.
fn have(tools: &[&str]) -> bool {
    let missing = tools.iter().find(|tool| Command::new(tool).arg("-V").output().is_err());
    if let Some(tool) = missing {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{tool} is not installed");
        eprintln!("SKIPPED: {tool} is not installed, so commands of the pages were not run");
    }
    missing.is_none()
}

fn page(name: &str) -> String {
    fs::read_to_string(repository().join(name)).unwrap()
}

/// Lines of the code block that begins with these words.
fn block(page: &str, first: &str) -> Vec<String> {
    let (_, rest) =
        page.split_once(&format!("```\n{first}")).unwrap_or_else(|| panic!("no block begins with `{first}`"));
    let (lines, _) = rest.split_once("```").expect("the block ends");
    format!("{first}{lines}").lines().map(str::to_owned).collect()
}

/// A folder with a copy of `vectors`, in which lines run. The program is on the path.
struct Copy(Folder);

impl Copy {
    fn new() -> Self {
        let folder = Folder::new();
        let copied = Command::new("cp").arg("-r").arg(repository().join("vectors")).arg(folder.path()).status();
        assert!(copied.unwrap().success());
        Self(folder)
    }

    /// Puts a text in the place of its first occurrence in a file.
    fn change(&self, file: &str, from: &str, to: &str) {
        let text = self.0.read(file);
        assert!(text.contains(from), "{file} has no `{from}`");
        self.0.write(file, text.replacen(from, to, 1));
    }

    /// Runs lines in one shell that ends at the first error.
    fn run(&self, lines: &[String]) -> Run {
        let program = std::path::Path::new(env!("CARGO_BIN_EXE_roughxel"));
        let path = std::env::var("PATH").unwrap();
        let path = format!("{}:{path}", program.parent().unwrap().display());
        Run::output(Command::new("sh").args(["-ec", &lines.join("\n")]).env("PATH", path).current_dir(self.0.path()))
    }
}

#[test]
fn first_steps_lead_to_the_first_mismatch_and_back() {
    if !have(&["python3", "iverilog"]) {
        return;
    }
    let (page, copy) = (page("vectors/README.md"), Copy::new());
    let mut steps = block(&page, "cd vectors\n");
    // The run of all modules takes a minute; `folder` in host-tests runs it.
    let whole = steps.iter().position(|line| line.starts_with("sh hdl/handwritten/run.sh  ")).expect("the whole run");
    steps.remove(whole);
    let (last, checks) = steps.split_last().expect("steps");
    copy.run(checks).ends(0).prints(&["all right"]);
    let [enter, again] = ["cd vectors", last].map(str::to_owned);
    copy.run(&[enter.clone(), again.clone()]).ends(1).prints(&["FAIL", "field", "expected", "got"]);
    let (_, undo) = page.split_once("`mv ").expect("a command that undoes the change");
    let (undo, _) = undo.split_once('`').expect("its end");
    copy.run(&[enter, format!("mv {undo}"), again]).ends(0).prints(&["PASS"]);
}

#[test]
fn a_stage_by_hand_passes_its_testbench_and_a_wrong_sign_prints_the_lines_of_the_page() {
    if !have(&["iverilog", "ghdl"]) {
        return;
    }
    let (page, copy) = (page("vectors/hdl/README.md"), Copy::new());
    let steps = block(&page, "roughxel vectors export random --stage reflect -o sets\n");
    let run = copy.run(&steps).ends(0);
    assert_eq!(run.out.matches("PASS random_reflect_standard").count(), 2, "{}", run.out);
    let wrong = [
        "cd benches/random_reflect_standard",
        "sed -i.bak 's/twice - back/twice + back/' rtl/reflect.v",
        "sh run.sh icarus --stop 1",
    ];
    let run = copy.run(&wrong.map(str::to_owned)).ends(3);
    run.prints(&block(&page, "random_reflect_standard #0").iter().map(String::as_str).collect::<Vec<_>>());
}

#[test]
fn a_different_root_is_faithful_and_a_wrong_exponent_is_named_as_the_pages_say() {
    if !have(&["iverilog"]) {
        return;
    }
    let (page_of_tiers, copy) = (page("vectors/TOLERANCES.md"), Copy::new());
    let steps = block(&page_of_tiers, "roughxel vectors export random --count 30 --profile narrow -o sets\n");
    copy.run(&steps).ends(0).prints(&["PASS random_narrow: 30 vectors", "exact    30 of 30", "faithful 30 of 30"]);
    let (root, exponent) = ("benches/random_narrow/rtl/frame.v", "benches/random_narrow/rtl/reflect.v");
    let sum = ["_add + 16'd1", "_add - 16'd1"];
    copy.change(root, sum[0], sum[1]);
    let [.., simulation, check] = &steps[..] else { panic!("a simulation and a check") };
    copy.run(std::slice::from_ref(simulation)).ends(3);
    let printed = block(&page_of_tiers, "random (narrow): 30 vectors\n");
    copy.run(std::slice::from_ref(check)).ends(0).prints(&printed.iter().map(String::as_str).collect::<Vec<_>>());

    copy.change(root, sum[1], sum[0]);
    copy.change(exponent, "+ 19'd4", "+ 19'd3");
    let run = copy.run(&["sh benches/random_narrow/run.sh icarus --stop 1".to_owned()]).ends(3);
    let printed = block(&page("vectors/hdl/README.md"), "random_narrow #0");
    run.prints(&printed.iter().map(String::as_str).filter(|line| *line != "…").collect::<Vec<_>>());
}

#[test]
fn the_shell_is_written_and_runs_as_its_page_says() {
    if !have(&["iverilog", "python3"]) {
        return;
    }
    let (page, copy) = (page("docs/shell.md"), Copy::new());
    copy.run(&block(&page, "roughxel verilog --profile narrow --multipliers 8 --target ecp5")).ends(0);
    // The page lists every file that is not Verilog of the design.
    let listed: Vec<&str> = page.split('`').skip(1).step_by(2).collect();
    let is_listed = |name: &str| {
        let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
        listed.contains(&name)
            || listed.contains(&&*format!(".{ending}")) && listed.iter().any(|it| it.starts_with(stem))
    };
    for entry in fs::read_dir(copy.0.join("ecp5")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(name.ends_with(".v") || name.ends_with(".txt") || name == "rom" || is_listed(&name), "{name}");
    }
    let [enter, icarus, run, cocotb] = &block(&page, "cd ecp5\n")[..] else { panic!("four lines") };
    copy.run(&[enter, icarus, run].map(String::clone)).ends(0).prints(&["PASS"]);
    let installed = repository().join("target/cocotb");
    let python = format!("export PYTHONPATH={}:$PYTHONPATH", installed.display());
    let found = Command::new("sh").args(["-c", &format!("{python}; python3 -c 'import cocotb_tools.runner'")]).output();
    if !found.unwrap().status.success() {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "cocotb is not installed");
        eprintln!("SKIPPED: cocotb 2 is not installed, so the shell was not run in it");
        return;
    }
    copy.run(&[&python, enter, cocotb].map(String::clone)).ends(0).prints(&["PASS roughxel_fragment_shell: 0 of "]);
    let (_, code) = page.split_once("```python\nimport roughxel_shell\n").expect("code that packs words");
    let (code, _) = code.split_once("```").expect("its end");
    copy.0.write("ecp5/words.py", format!("import roughxel_shell\n{code}print(len(words), writes[-1], 'words')\n"));
    copy.run(&[enter.clone(), "python3 words.py".to_owned()]).ends(0).prints(&["(4, 1) words"]);
    let benches = block(&page, "roughxel vectors export random --count 100 --profile narrow -o sets\n");
    copy.run(&benches).ends(0).prints(&["PASS random_narrow: 100 vectors"]);
}
