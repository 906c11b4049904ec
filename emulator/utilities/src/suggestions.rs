//! Suggestions for misspelt words.

/// Known word that is most like another, if one is like it.
pub fn closest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = |known: &&str| strsim::jaro_winkler(word, known);
    known.into_iter().filter(|known| likeness(known) > 0.8).max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
}

/// Start of a remedy that names [`closest`]; empty if no word is like it.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    closest(word, known).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_understood_and_another_word_is_not() {
        let known = ["lake", "zebra", "denim-plane"];
        assert_eq!(closest("laek", known), Some("lake"));
        assert_eq!(closest("denim_plane", known), Some("denim-plane"));
        assert_eq!(closest("corrugated", known), None);
        assert_eq!(did_you_mean("zebar", known), "did you mean `zebra`? ");
        assert_eq!(did_you_mean("x", known), "");
    }
}
