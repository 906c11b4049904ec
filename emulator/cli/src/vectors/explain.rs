//! `roughxel vectors explain`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_vectors::{
    DeviceWord, Explained, Explanation, Got, Mismatch, Vector, VectorError, Wrong, manifests_in, vcd,
};
use serde_json::json;

use crate::console::{complain, new_table};
use crate::{Failure, check_file, write_text};

pub(super) const LONG_HELP: &str = "\
Print every field of one vector, stage by stage in the order of the pipeline: hex digits in the word, integer, real value (with block
exponents applied and codes decoded), the float64 result for the same inputs, and the error in last places of the field. Then come the
decisions of the datapath and of float64, and the sticky bits by name.

  roughxel vectors explain 'vectors/smoke/random_standard#3'      # quoted: a shell reads # as a comment
  roughxel vectors explain vectors/smoke/random_standard --index 3
  roughxel vectors explain 'DIR/SET#3' --got 0d4f1a_..._91ca0c4d  # the word that a device has
  roughxel vectors explain 'DIR/SET#3' --got face=4 --got lod=1a0 # or some of its fields
  roughxel vectors explain 'DIR/SET#3' --vcd vector.vcd           # also for a waveform viewer

The word of a device is compared field by field. The first wrong stage, its field and its highest wrong bit are named, and every wrong field is
marked. The check value counts as right if it belongs to the device's word or equals that of the set.

Float64 has no value (`-`, in JSON null) for:
  - inputs, exponents and status; with footprint-sphere also columns, covariance, determinant, direction, sweep, share and level
  - fields on a face, if the datapath chose a different face
  - the step, if the probe count differs or lambda1 was clamped
  - f and amplitude, if root is not that of exponent
  - the light of a peak whose normal is not a unit vector, whose exponent is above 8192, or that was saturated
  - slopes along an axis that a direction does not have
  - what depends on derivatives or tangents whose exponents are more than 150 from those of v and n

A number that nearly cancelled has a large error in last places and is still right: the line `footprint` tells how much cancelled. A block of
zeros has no last place, so its error is `-` if float64 is not zero.

A set of one stage (`vectors export --stage`) has the inputs and outcomes of the stage's module: no float64, no decisions and no status.
Next to an exponent, the real value is that of the mantissa alone.

A real number beyond the range of a double is m*2^e, in JSON null.";

#[derive(Args)]
pub(crate) struct ExplainArgs {
    /// Set (NAME, NAME.json, NAME.hex or NAME.bin) and index of the vector, from 0. In a part of a set, the index is that in the
    /// whole set.
    #[arg(value_name = "SET#INDEX")]
    set: String,
    /// Index of the vector, if the first argument is the set alone.
    #[arg(long, value_name = "INDEX")]
    index: Option<u64>,
    /// Word of a device in the set's format, with or without underscores, or one of its fields. Repeat it for more fields.
    #[arg(long, value_name = "WORD|FIELD=HEX")]
    got: Vec<String>,
    /// Also write the vector as a value change dump: a scope and a time step for each stage, a variable for each field. Fields of
    /// --got appear as NAME_got.
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
    /// Print the explanation as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ExplainArgs) -> Result<(), Failure> {
    let (set, index) = split(&args.set, args.index)?;
    if let Some(path) = &args.vcd {
        check_file(path)?;
    }
    let vector = Vector::read(&manifest_of(Path::new(set))?, index).map_err(unreadable)?;
    let device = match args.got.is_empty() {
        true => None,
        false => Some(vector.device_word(&args.got).map_err(|error| Failure::Usage(format!("--got: {error}")))?),
    };
    // A damaged word of the set says nothing about a device.
    let compared = device.filter(|_| vector.mismatch().is_none());
    let explanation = vector.explain(compared.as_ref());

    if let Some(path) = &args.vcd {
        write_text(path, &vcd(&explanation))?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        let difference = vector.mismatch();
        writeln!(
            out,
            "{:#}",
            json!({ "explanation": explanation, "hash_matches": vector.hash_matches(), "mismatch": difference })
        )?;
    } else {
        describe(&mut out, &explanation, compared.as_ref(), vector.mismatch())?;
    }
    out.flush()?;

    if !vector.hash_matches() && vector.mismatch().is_none() {
        let order: String = vector.misplaced().iter().map(|misplaced| format!("; {misplaced}")).collect();
        complain(&format!(
            "note: this word is right, but the SHA-256 of its file is not the one in the manifest{order}"
        ));
    }
    if let Some(mismatch) = vector.mismatch() {
        let unused = if args.got.is_empty() { "" } else { "; --got was not compared with it" };
        return Err(Failure::Mismatch(format!("{mismatch}{unused}")));
    }
    match &explanation.wrong {
        Some(wrong) => Err(Failure::Mismatch(first_wrong(&explanation, wrong))),
        None => Ok(()),
    }
}

/// Makes the failure of a set that cannot be read. An index that the set does not have is an error of usage.
pub(super) fn unreadable(error: VectorError) -> Failure {
    match error {
        VectorError::Index { .. } => Failure::Usage(error.to_string()),
        error => error.into(),
    }
}

/// Splits `SET#INDEX` into set and index, or takes the index of `--index`.
pub(super) fn split(set: &str, index: Option<u64>) -> Result<(&str, u64), Failure> {
    if let Some(index) = index {
        return Ok((set, index));
    }
    let usage = |problem: String| {
        Failure::Usage(format!("{problem}; write 'SET#INDEX' in quotes, INDEX from 0, or SET --index INDEX"))
    };
    let Some((set, index)) = set.rsplit_once('#') else {
        return Err(usage(format!("`{set}` names no vector")));
    };
    // `parse` also accepts a sign, which an index does not have.
    match index.parse() {
        Ok(number) if index.bytes().all(|c| c.is_ascii_digit()) => Ok((set, number)),
        _ => Err(usage(format!("`{index}` is no index of a vector"))),
    }
}

/// Finds the manifest of a set. For a directory, the error lists its sets.
pub(super) fn manifest_of(set: &Path) -> Result<PathBuf, Failure> {
    if set.is_dir() {
        let manifests = manifests_in(set)?;
        let stems: Vec<_> =
            manifests.iter().filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
        return Err(Failure::Usage(format!(
            "{} is a directory; name one of its sets, as {}: {}",
            set.display(),
            set.join(&stems[0]).display(),
            stems.join(", ")
        )));
    }
    Ok(match set.extension() {
        Some(extension) if extension == "json" => set.into(),
        Some(extension) if extension == "hex" || extension == "bin" => set.with_extension("json"),
        _ => {
            let mut name = set.as_os_str().to_owned();
            name.push(".json");
            name.into()
        }
    })
}

pub(super) fn describe(
    out: &mut impl Write,
    explanation: &Explanation,
    device: Option<&DeviceWord>,
    mismatch: Option<&Mismatch>,
) -> io::Result<()> {
    let Explanation { set, profile, datapath, index, line, fields, stage, status, decisions, wrong } = explanation;
    let of = stage.as_ref().map_or_else(String::new, |stage| format!("stage {stage} of "));
    writeln!(out, "{set} #{index} (line {line}): {of}{datapath}, profile {profile}")?;
    let what = match (device, mismatch) {
        (Some(_), _) => Some("got"),
        (None, Some(_)) => Some("in the file"),
        (None, None) => None,
    };
    let header = ["stage", "field", "hex", "integer", "real", "float64", "error, last places"];
    let mut table = match what {
        Some(what) => {
            let [a, b, c, d, e, f, g] = header;
            new_table([a, b, c, d, e, f, g, what, "wrong"])
        }
        None => new_table(header),
    };
    for field in fields {
        let Explained { stage, field, raw, integer, real, float64, error, got, .. } = field;
        let or_none = |text: Option<String>| text.unwrap_or_else(|| "-".into());
        let mut row = vec![
            stage.clone(),
            field.clone(),
            raw.clone(),
            integer.to_string(),
            real.to_string(),
            or_none(float64.map(|real| real.to_string())),
            or_none(error.map(shown_error)),
        ];
        if what.is_some() {
            row.push(or_none(got.as_ref().map(|got| got.raw.clone())));
            row.push(match got {
                Some(Got { wrong_bit: Some(bit), .. }) => format!("bit {bit}"),
                _ => String::new(),
            });
        }
        table.add_row(row);
    }
    writeln!(out, "{table}")?;
    for decision in decisions {
        let float64 = decision.float64.as_ref().filter(|float64| **float64 != decision.taken);
        let float64 = float64.map_or_else(String::new, |float64| format!(" (float64: {float64})"));
        let note = if decision.note.is_empty() { String::new() } else { format!("; {}", decision.note) };
        writeln!(out, "{}: {}{float64}{note}", decision.what, decision.taken)?;
    }
    if stage.is_none() {
        let status = if status.is_empty() { "nothing".into() } else { status.join(", ") };
        writeln!(out, "status: {status}")?;
    }
    match (wrong, mismatch) {
        (Some(wrong), None) => writeln!(out, "wrong: {}", first_wrong(explanation, wrong)),
        (None, None) if device.is_some() => writeln!(out, "every field that was given is right"),
        _ => Ok(()),
    }
}

/// Formats an error with two digits after the point, or with an exponent if it is 10⁶ or more.
fn shown_error(error: f64) -> String {
    if error == 0.0 {
        "0".into()
    } else if error.abs() < 1e6 {
        format!("{error:+.2}")
    } else {
        format!("{error:+.2e}")
    }
}

fn first_wrong(explanation: &Explanation, wrong: &Wrong) -> String {
    let Explanation { set, index, .. } = explanation;
    let Wrong { stage, field, bit, found, expected, width, fields_differing } = wrong;
    let padding =
        if bit >= width { format!(" (above the field's {width} bits, where all are zero)") } else { String::new() };
    format!(
        "{set} #{index}: stage {stage}, field {field}, bit {bit}{padding}: got {found:x}, expected {expected:x}; \
         {fields_differing} fields differ"
    )
}
