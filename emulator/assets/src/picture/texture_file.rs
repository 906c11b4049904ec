//! Pictures in KTX2 and DDS files.

use std::io::Read;
use std::path::Path;

use super::codes::{decode_table, name_channels};
use super::decoded::Decoded;
use super::statement::{Purpose, Statement, Wishes};
use super::texels::TexelFormat;
use super::texture::Texture;
use super::{Picture, PictureError, check_finite, check_size};

/// Reads the first level of a texture. Codes are as the format says, or sRGB; floats are linear.
///
/// # Errors
/// A file that is truncated or damaged; a cube map, an array or a volume; supercompression, Basis Universal and other texel formats; a picture
/// larger than [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`](super::MAX_PIXELS); a value that is not finite.
pub(super) fn read(path: &Path, file: impl Read, purpose: Purpose, wishes: &Wishes) -> Result<Decoded, PictureError> {
    let Some(texture) = Texture::read(path, file)? else {
        return Err(PictureError::damaged(path, "KTX2", "it has no header"));
    };
    let [width, height] = texture.size();
    let (width, height) = check_size(path, width.into(), height.into())?;
    match texture.images() {
        1 if width > 0 && height > 0 => {}
        6 => {
            let message = format!("`{}` holds a cube map", path.display());
            return Err(PictureError::new(message, "name it with `cube` in [environment]"));
        }
        _ => return Err(PictureError::unsupported(path, "is no single picture", "a texture of one picture")),
    }
    let content = texture.content(path)?;
    let mut statement = Statement { kind: content.name.clone(), ..Statement::default() };
    let channels = content.format.channels();
    match channels {
        2 => statement.channels = ["R", "G"].map(str::to_owned).to_vec(),
        channels => name_channels(channels, &mut statement),
    }
    content.alpha.name(&mut statement);
    let colours = content.words().decide(purpose, wishes, &mut statement);
    let table = decode_table(255, colours.transfer);
    let mut pixels = content.format.pixels(content.images[0], content.size, &table);
    if content.format.is_codes() {
        colours.convert(&mut pixels);
    } else {
        check_finite(path, &pixels, width)?;
        colours.decode_floats(&mut pixels);
    }
    if purpose == Purpose::Normals
        && content.format == TexelFormat::Bc3
        && pixels.iter().all(|pixel| pixel[0] == pixels[0][0])
    {
        let what = "red is the same everywhere: normals of BC3 may have x in alpha (DXT5nm), which is not read";
        statement.warnings.push(format!("{what}; export them as BC5 or PNG"));
    }
    let picture = content.orientation.apply(Picture { width, height, pixels });
    let largest_code = content.format.is_codes().then_some(255);
    Ok(Decoded { picture, statement, largest_code, channels })
}
