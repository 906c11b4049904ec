//! Self-contained HTML files without network or script.
//!
//! Pictures are embedded as data URIs (RFC 2397, base64 of RFC 4648), so that the file can be sent alone. Colours follow the
//! reader's light or dark preference. Wide tables scroll by themselves, so that a phone shows the rest unscaled.

use std::fmt::{self, Display, Write as _};

const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1c1e21; --paper: #fbfaf7; --soft: #63666b; --line: #d5d2ca; --good: #0b6b3a; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e2dd; --paper: #17181a; --soft: #9c9fa4; --line: #3a3c40; --good: #6fd39b; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 84rem; font: 1rem/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); }
h1, h2 { line-height: 1.2; }
section { border-top: 1px solid var(--line); margin-top: 2.5rem; }
p { max-width: 48rem; }
.soft, figcaption { color: var(--soft); }
.figures { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; flex: 0 1 20rem; }
img { display: block; width: 100%; height: auto; background: #000; }
figcaption { font-size: .9rem; margin-top: .25rem; }
figcaption b { color: var(--ink); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(25rem, 100%), 1fr)); gap: 2rem 1.5rem; align-items: start; }
figure.plot { min-width: 0; max-width: 34rem; margin: 1rem 0; }
.plots figure.plot { margin: 0; }
figure.plot svg { display: block; width: 100%; height: auto; }
figure.plot .scroll { max-height: 24rem; overflow-y: auto; }
figure.plot th { white-space: normal; vertical-align: bottom; }
figure.plot summary { margin: .5rem 0; font-size: .9rem; }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
tr.filtered { color: var(--good); font-weight: 600; }
a { color: inherit; }
pre { overflow-x: auto; padding: .75rem; border: 1px solid var(--line); font-size: .85rem; }
summary { cursor: pointer; margin: 1rem 0; }
";

/// A page under construction.
#[derive(Debug, Default)]
pub struct Page {
    text: String,
    /// Numbers given so far.
    numbers: usize,
}

impl Page {
    /// Begins a page of this title: its head, up to the body.
    pub fn new(title: &str) -> Self {
        let mut page = Self::default();
        page.add(format_args!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n",
            Text(title)
        ));
        page
    }

    /// The whole text.
    pub fn finish(mut self) -> String {
        self.add(format_args!("</body>\n</html>\n"));
        self.text
    }

    /// Adds markup as it is; external strings go through [`Text`].
    pub fn add(&mut self, part: fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(part);
    }

    /// A number that is unique on this page, for ids.
    pub(crate) fn next_number(&mut self) -> usize {
        self.numbers += 1;
        self.numbers
    }

    /// Begins a section; links to it name `id`.
    pub fn section(&mut self, id: &str, title: &str) {
        self.add(format_args!("<section id=\"{}\">\n<h2>{}</h2>\n", Text(id), Text(title)));
    }

    /// Ends a section.
    pub fn end_section(&mut self) {
        self.add(format_args!("</section>\n"));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.add(format_args!("<p>{}</p>\n", Text(text)));
    }

    /// A table cell; a dash if there is no value.
    pub fn cell(&mut self, value: Option<impl Display>) {
        match value {
            Some(value) => self.add(format_args!("<td>{}</td>", Text(&value.to_string()))),
            None => self.add(format_args!("<td>–</td>")),
        }
    }

    /// A table in its own scrolling box; the first column names the rows.
    pub fn table<Row: AsRef<[String]>>(&mut self, headings: &[&str], rows: impl IntoIterator<Item = Row>) {
        self.add(format_args!("<div class=\"scroll\">\n<table>\n<thead>\n<tr>"));
        for heading in headings {
            self.add(format_args!("<th scope=\"col\">{}</th>", Text(heading)));
        }
        self.add(format_args!("</tr>\n</thead>\n<tbody>\n"));
        for row in rows {
            self.add(format_args!("<tr>"));
            for cell in row.as_ref() {
                self.cell(Some(cell));
            }
            self.add(format_args!("</tr>\n"));
        }
        self.add(format_args!("</tbody>\n</table>\n</div>\n"));
    }

    /// A picture with its caption: bytes of a PNG file, size in pixels, alternative text, label and description.
    pub fn figure(&mut self, png: &[u8], [width, height]: [u32; 2], shows: &str, label: &str, caption: &str) {
        let (shows, label, caption) = (Text(shows), Text(label), Text(caption));
        self.add(format_args!(
            "<figure>\n<img src=\"data:image/png;base64,{}\" alt=\"{shows}\" width=\"{width}\" height=\"{height}\">\n\
             <figcaption><b>{label}</b> {caption}</figcaption>\n</figure>\n",
            base64(png)
        ));
    }
}

/// Text of an element or attribute.
#[derive(Clone, Copy, Debug)]
pub struct Text<'a>(pub &'a str);

impl Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|character| match character {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '"' => f.write_str("&quot;"),
            _ => f.write_char(character),
        })
    }
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0, |word, i| word << 8 | group.get(i).map_or(0, |byte| u32::from(*byte)));
        for digit in 0..4 {
            let is_data = digit <= group.len();
            text.push(if is_data { DIGITS[(word >> (18 - 6 * digit)) as usize & 63].into() } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_vectors_of_rfc_4648() {
        let vectors =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (bytes, text) in vectors {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xef, 0xff]), "++//");
    }

    #[test]
    fn text_cannot_become_a_tag_or_end_an_attribute() {
        assert_eq!(Text("a<b> & \"c\"").to_string(), "a&lt;b&gt; &amp; &quot;c&quot;");
    }
}
