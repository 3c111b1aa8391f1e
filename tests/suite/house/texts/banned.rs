//! Words and phrases that the glossary replaces by standard terms.

/// In lower case. A phrase matches consecutive words.
const BANNED: [&str; 82] = [
    "any more",
    "asked for",
    "at hand",
    "beside",
    "both ways",
    "cannot be seen",
    "cannot tell",
    "come to its end",
    "comes to",
    "contract section",
    "each way",
    "errs",
    "felt",
    "goes",
    "gone",
    "halvings of",
    "held against",
    "held out",
    "largest swing",
    "late and moved",
    "leaves",
    "left out",
    "longest way",
    "look at it",
    "look for",
    "looked for",
    "looks for",
    "looks like this",
    "make it again",
    "make the rest",
    "make a demo run",
    "make the run",
    "makes of",
    "mend",
    "mends",
    "no part in",
    "nobody",
    "not with its defaults",
    "not known to be safe",
    "not seen",
    "not sure",
    "out and back",
    "pieces",
    "points of the encoder",
    "puma chapter",
    "repeats itself",
    "rival",
    "rivals",
    "run is on",
    "settled motion",
    "share of",
    "somebody",
    "take away",
    "take out",
    "take off",
    "taken away",
    "taken back",
    "taken off",
    "takes away",
    "takes off",
    "taken in",
    "tell",
    "telling",
    "tells",
    "the way down",
    "that would tell",
    "the way up",
    "thesis on",
    "told",
    "told apart",
    "too seldom",
    "towards standstill",
    "twin",
    "waves over",
    "what is missing",
    "whatever",
    "where it comes from",
    "whoever",
    "worked out",
    "would have been found",
    "would have been seen",
    "would have it",
];

/// Longer sentences of the program are hard to read.
pub const MOST_WORDS: usize = 25;

/// For documents, whose sentences have a context.
pub const MOST_WORDS_OF_DOCUMENTS: usize = 30;

/// The first banned phrase in a text.
pub fn banned(text: &str) -> Option<&'static str> {
    let spoken = format!(" {} ", words(text).join(" "));
    BANNED.into_iter().find(|phrase| spoken.contains(&format!(" {phrase} ")))
}

/// The sentences with more words than the limit.
pub fn long_sentences(text: &str, most_words: usize) -> Vec<String> {
    let ended = text.replace(": ", ". ").replace("; ", ". ");
    ended.split(". ").filter(|sentence| words(sentence).len() > most_words).map(str::to_owned).collect()
}

/// In lower case, without code in backticks and without argument names in braces, which a person does not see.
fn words(text: &str) -> Vec<String> {
    let mut spoken = String::new();
    let mut braces = 0;
    for (i, part) in text.split('`').enumerate() {
        if i % 2 == 1 {
            continue;
        }
        for letter in part.chars() {
            match letter {
                '{' => braces += 1,
                '}' => braces -= 1,
                _ if braces > 0 => {}
                _ => spoken.push(letter),
            }
        }
        spoken.push(' ');
    }
    let split = spoken.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '\'');
    split.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

#[test]
fn phrases_are_found_as_words_and_not_in_names_of_arguments_or_code() {
    assert_eq!(banned("The error held-out falls."), Some("held out"));
    assert_eq!(banned("Tells the error of a model"), Some("tells"));
    assert_eq!(banned("{told}; `--leaves` and a teller, {beside}"), None);
    assert_eq!(long_sentences(&"word ".repeat(26), 25).len(), 1);
    assert_eq!(long_sentences(&format!("{0}. {0}", "word ".repeat(25)), 25).len(), 0);
}
