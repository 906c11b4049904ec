//! Common parts of Verilog files: names, a head, an end; and the text of a template.

/// Path of a bundle as part of a Verilog name: `e1.m[0]` is `e1_m_0`.
pub(super) fn identifier(path: &str) -> String {
    path.replace(['.', '['], "_").replace(']', "").trim_start_matches('_').to_owned()
}

/// Comment at the head of a file, and the directive that every wire is declared.
pub(super) fn header(name: &str, about: &[String]) -> String {
    let mut text = format!("// {name}\n//\n");
    for line in about {
        text += format!("// {line}").trim_end();
        text.push('\n');
    }
    text + "\n`default_nettype none\n\n"
}

/// The end of a module and its file.
pub(super) const END: &str = "\nendmodule\n\n`default_nettype wire\n";

/// Template with each `@NAME@` in it replaced by its value.
pub fn filled(template: &str, values: &[(&str, String)]) -> String {
    values.iter().fold(template.to_owned(), |text, (name, value)| text.replace(&format!("@{name}@"), value))
}
