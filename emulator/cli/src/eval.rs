//! `roughxel eval`.

mod rows;

use std::io::{self, BufWriter, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use roughxel_core::plan::Effects;
use roughxel_utilities::input::open_file;
use roughxel_utilities::output::OutputFile;

use super::{Failure, ProfileArg, effects, parse_profile};
use rows::{EvalOptions, evaluate};
pub(crate) use rows::{INPUT_COLUMNS, Value, visit};

pub(super) const LONG_HELP: &str = "\
Run fragments given in real numbers through the datapath.

Input: CSV with a header row, columns in any order, `#` starts a comment line.
  nx ny nz vx vy vz          required: normal n, view vector v (from the surface to the eye)
  hx hy hz                   main direction h (0,1,0 if all three are missing)
  b1 b2                      bump offset, -8 <= b < 8, relative to |n|
  d1 d2 d3                   roughness D = [[d1, d2], [0, d3]], -8 <= d < 8, relative to |n|
  dv_dx_x ... dv_dy_z        derivatives of v per pixel
  dn_dx_x ... dn_dy_z        derivatives of n per pixel
  size                       edge of a cube face in texels, 1 to 16384, whole (256)
Other missing columns are 0.

Output: one row per input row, in real units with block exponents applied, 17 significant digits (%.16e).
  q_nx ... q_dn_dy_z         quantised inputs
  e1_x ... e2_z              tangents E1, E2, scaled by |n|
  nmod_x ... nmod_z          perturbed normal; r_x ... r_z: reflected vector
  face s t                   cube face 0-5 (+x -x +y -y +z -z) and position on it, -1 to 1
  k_a k_b k_c                covariance of the footprint on the face, K = [[a, b], [b, c]]
  lambda1 lambda2            standard deviations along the axes; dir_s dir_t: direction of lambda1
  probes step_s step_t lod   probe count, step between probes, level of detail
  status                     sum of 1 normal_zero, 2 view_zero, 4 frame_pole, 8 view_below_surface, 16 face_tie,
                             32 footprint_zero, 64 footprint_saturated, 128 probes_capped
A value beyond the range of a double (|r| grows with |n|^2 |v|) is inf, in JSON null; --raw shows it.";

#[derive(Args)]
pub(super) struct EvalArgs {
    /// CSV file. The default, `-`, is stdin.
    file: Option<PathBuf>,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    #[arg(long, default_value = "all", value_parser = effects::parse, value_name = "LIST", help = effects::HELP)]
    effects: Effects,
    /// Print the integers of the ports: mantissas (I2F30), with a column NAME_e for the exponent of each block. b, d and step are
    /// I4F28, lod is I16F16.
    #[arg(long)]
    raw: bool,
    /// Print a JSON array with one object per line, with `status_names` added.
    #[arg(long)]
    json: bool,
    /// File to write to. It appears whole or not at all.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(super) fn run(args: &EvalArgs) -> Result<(), Failure> {
    let options = EvalOptions {
        precision: args.profile.open()?.precision,
        plan: args.effects.reflection(),
        raw: args.raw,
        json: args.json,
    };
    let (input, name): (Box<dyn Read>, String) = match &args.file {
        Some(path) if path != Path::new("-") => (open(path).map_err(Failure::Error)?, path.display().to_string()),
        _ => (Box::new(io::stdin().lock()), "stdin".into()),
    };
    match &args.output {
        None => {
            let mut output = BufWriter::with_capacity(1 << 16, io::stdout().lock());
            evaluate(input, &name, &mut output, &options)?;
        }
        Some(path) => {
            let refused = || format!("cannot write {}", path.display());
            let mut output =
                OutputFile::create(path).into_diagnostic().wrap_err_with(refused).map_err(Failure::Error)?;
            evaluate(input, &name, &mut output, &options)?;
            output.commit().into_diagnostic().wrap_err_with(refused).map_err(Failure::Error)?;
        }
    }
    Ok(())
}

fn open(path: &Path) -> miette::Result<Box<dyn Read>> {
    let refused = || format!("cannot read {} (name a file, or `-` for stdin)", path.display());
    let file = open_file(path).into_diagnostic().wrap_err_with(refused)?;
    Ok(Box::new(file))
}
