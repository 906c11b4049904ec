//! Bytes of a model: the file, its binary chunk, the files and `data:` texts that it names.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use percent_encoding::percent_decode_str;
use roughxel_utilities::input::open_file;

/// Largest file in bytes.
const MAX_BYTES: u64 = 1 << 29;

/// Most bytes of all buffers together.
const MAX_ALL_BYTES: usize = 1 << 30;

/// Reads a whole file of at most 512 MiB.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    let unreadable = |source| format!("cannot be read: {source}; check the path and its permissions");
    let file = open_file(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("is longer than {MAX_BYTES} bytes; simplify the model"));
    }
    Ok(bytes)
}

/// Buffers of a model.
pub(super) struct Buffers {
    folder: PathBuf,
    buffers: Vec<Vec<u8>>,
}

impl Buffers {
    pub(super) fn read(path: &Path, file: &gltf::Gltf) -> Result<Self, String> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let mut all = Self { folder, buffers: Vec::new() };
        for buffer in file.buffers() {
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => file.blob.clone().ok_or("has no binary chunk for its first buffer")?,
                gltf::buffer::Source::Uri(uri) => all.resolve(uri)?,
            };
            let (there, said) = (bytes.len(), buffer.length());
            if there < said {
                return Err(format!("buffer {} has {there} bytes and should have {said}", buffer.index()));
            }
            all.buffers.push(bytes);
            if all.buffers.iter().map(Vec::len).sum::<usize>() > MAX_ALL_BYTES {
                return Err(format!("has buffers of more than {MAX_ALL_BYTES} bytes; simplify the model"));
            }
        }
        Ok(all)
    }

    /// Bytes of a `data:` text or of a file next to the model.
    pub(super) fn resolve(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (_, text) = data.split_once(";base64,").ok_or("has a `data:` text that is not base64")?;
            return STANDARD.decode(text).map_err(|reason| format!("has damaged base64 text: {reason}"));
        }
        if uri.contains("://") {
            return Err(format!("names `{uri}`; only files next to the model are read"));
        }
        let name = percent_decode_str(uri).decode_utf8().map_err(|_| format!("names `{uri}`, which is not UTF-8"))?;
        read_file(&self.folder.join(&*name)).map_err(|message| format!("names `{name}`, which {message}"))
    }

    /// Bytes of buffer `index`.
    pub(super) fn bytes(&self, index: usize) -> Option<&[u8]> {
        self.buffers.get(index).map(Vec::as_slice)
    }

    /// Bytes of a buffer view; `None` if it reaches beyond its buffer.
    pub(super) fn view(&self, view: &gltf::buffer::View<'_>) -> Option<&[u8]> {
        self.bytes(view.buffer().index())?.get(view.offset()..view.offset().checked_add(view.length())?)
    }

    /// Checks that the accessors of a primitive lie inside their views, and the views inside their buffers.
    pub(super) fn check(&self, primitive: &gltf::Primitive<'_>) -> Result<(), String> {
        let accessors = primitive.attributes().map(|(_, accessor)| accessor).chain(primitive.indices());
        for accessor in accessors {
            let index = accessor.index();
            let inside = |view: gltf::buffer::View<'_>, offset: usize, count: usize, size: usize| {
                let stride = view.stride().unwrap_or(size);
                let end = count
                    .checked_sub(1)
                    .and_then(|last| last.checked_mul(stride)?.checked_add(size)?.checked_add(offset));
                stride >= size && end.is_some_and(|end| self.view(&view).is_some_and(|bytes| end <= bytes.len()))
            };
            let views =
                accessor.view().is_none_or(|view| inside(view, accessor.offset(), accessor.count(), accessor.size()));
            let sparse = accessor.sparse().is_none_or(|sparse| {
                let (indices, values) = (sparse.indices(), sparse.values());
                let bytes = match indices.index_type() {
                    gltf::accessor::sparse::IndexType::U8 => 1,
                    gltf::accessor::sparse::IndexType::U16 => 2,
                    gltf::accessor::sparse::IndexType::U32 => 4,
                };
                inside(indices.view(), indices.offset(), sparse.count(), bytes)
                    && inside(values.view(), values.offset(), sparse.count(), accessor.size())
            });
            // An accessor without bytes would be as long as it says.
            let backed = accessor.view().is_some() || accessor.count() <= crate::mesh::triangles::MAX_TRIANGLES;
            if !(views && sparse && backed) {
                return Err(format!("accessor {index} reaches beyond its buffer; the file is damaged"));
            }
        }
        Ok(())
    }
}
