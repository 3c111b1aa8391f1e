//! The texts of the dashboard: string literals of its scripts, and text and attributes of its markup.

use std::path::{Path, PathBuf};

/// Texts with more than one word (others are names), with their file.
pub fn under(root: &Path, folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for file in sources(&root.join(folder)) {
        let place = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        let source = std::fs::read_to_string(&file).expect("a source");
        let mut texts = Texts::default();
        match place.ends_with(".svelte") {
            true => texts.component(&source),
            false => texts.script(&source),
        }
        let is_said = |text: &String| text.trim().contains(' ');
        found.extend(texts.found.into_iter().filter(is_said).map(|text| (place.clone(), text)));
    }
    found
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|fault| panic!("{}: {fault}", folder.display()));
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if (name.ends_with(".svelte") || name.ends_with(".ts")) && !name.ends_with(".test.ts") {
            files.push(path);
        }
    }
    files.sort();
    files
}

#[derive(Default)]
struct Texts {
    found: Vec<String>,
}

impl Texts {
    fn component(&mut self, source: &str) {
        let (before, rest) = source.split_once("<script").unwrap_or(("", source));
        let (script, markup) = rest.split_once("</script>").unwrap_or(("", rest));
        self.script(script.split_once('>').map_or("", |(_, script)| script));
        let markup = markup.split("<style").next().unwrap_or_default();
        self.markup(&format!("{before}{markup}"));
    }

    /// Collects string literals; for a template, its text and the literals in its expressions.
    fn script(&mut self, source: &str) {
        let mut rest = source;
        while let Some(at) = rest.find(['\'', '"', '`', '/']) {
            let (mark, inside) = (&rest[at..=at], &rest[at + 1..]);
            rest = match mark {
                "/" => comment(inside),
                "`" => self.template(inside),
                _ => self.literal(inside, mark),
            };
        }
    }

    fn literal<'s>(&mut self, source: &'s str, mark: &str) -> &'s str {
        let mut is_escaped = false;
        let end = source.find(|c: char| {
            let is_end = !is_escaped && (c == '\n' || mark.contains(c));
            is_escaped = !is_escaped && c == '\\';
            is_end
        });
        let (text, rest) = source.split_at(end.unwrap_or(source.len()));
        self.found.push(text.to_owned());
        rest.get(1..).unwrap_or_default()
    }

    fn template<'s>(&mut self, source: &'s str) -> &'s str {
        let (mut text, mut rest) = (String::new(), source);
        while let Some(at) = rest.find(['`', '$', '\\']) {
            text.push_str(&rest[..at]);
            let (mark, inside) = (&rest[at..=at], &rest[at + 1..]);
            match (mark, inside.strip_prefix('{')) {
                ("`", _) => {
                    self.found.push(text);
                    return inside;
                }
                ("$", Some(held)) => {
                    text.push_str(" {} ");
                    rest = self.braces(held);
                }
                ("\\", _) => rest = inside.get(1..).unwrap_or_default(),
                _ => rest = inside,
            }
        }
        ""
    }

    /// Reads up to the closing brace.
    fn braces<'s>(&mut self, source: &'s str) -> &'s str {
        let mut rest = source;
        let mut open = 1;
        while let Some(at) = rest.find(['\'', '"', '`', '{', '}']) {
            let (mark, inside) = (&rest[at..=at], &rest[at + 1..]);
            rest = inside;
            match mark {
                "{" => open += 1,
                "}" if open == 1 => return rest,
                "}" => open -= 1,
                "`" => rest = self.template(inside),
                _ => rest = self.literal(inside, mark),
            }
        }
        ""
    }

    fn markup(&mut self, source: &str) {
        let (mut text, mut rest) = (String::new(), source);
        while let Some(at) = rest.find(['<', '{']) {
            text.push_str(&rest[..at]);
            let inside = &rest[at + 1..];
            rest = match (&rest[at..=at], inside.strip_prefix("!--")) {
                ("{", _) => {
                    text.push_str(" {} ");
                    self.braces(inside)
                }
                (_, Some(comment)) => comment.split_once("-->").map_or("", |(_, rest)| rest),
                _ => {
                    self.found.push(std::mem::take(&mut text));
                    self.tag(inside)
                }
            };
        }
        self.found.push(text + rest);
    }

    /// Collects the attributes that a person reads.
    fn tag<'s>(&mut self, source: &'s str) -> &'s str {
        const UNREAD: [&str; 4] = ["class=", "style=", "href=", "file="];
        let mut rest = source;
        while let Some(at) = rest.find(['"', '{', '>']) {
            let (before, mark, inside) = (&rest[..at], &rest[at..=at], &rest[at + 1..]);
            let known = self.found.len();
            rest = match mark {
                ">" => return inside,
                "{" => self.braces(inside),
                _ => self.quoted(inside),
            };
            if UNREAD.iter().any(|name| before.ends_with(name)) {
                self.found.truncate(known);
            }
        }
        ""
    }

    fn quoted<'s>(&mut self, source: &'s str) -> &'s str {
        let (mut text, mut rest) = (String::new(), source);
        while let Some(at) = rest.find(['"', '{']) {
            text.push_str(&rest[..at]);
            let inside = &rest[at + 1..];
            if &rest[at..=at] == "\"" {
                self.found.push(text);
                return inside;
            }
            text.push_str(" {} ");
            rest = self.braces(inside);
        }
        ""
    }
}

/// The source after a comment, or after a slash that starts none.
fn comment(source: &str) -> &str {
    match (source.strip_prefix('/'), source.strip_prefix('*')) {
        (Some(line), _) => line.split_once('\n').map_or("", |(_, rest)| rest),
        (_, Some(block)) => block.split_once("*/").map_or("", |(_, rest)| rest),
        _ => source,
    }
}

#[test]
fn texts_are_read_as_the_page_shows_them() {
    let mut texts = Texts::default();
    texts.component(
        "<script lang=\"ts\">\n\t// not 'this one'\n\tconst a = cond ? `two {words} ${b ? 'it is' : \"\"} more` : 'don\\'t';\n</script>\n\
         <p class=\"no text\" title=\"a title {x}\">Read <b>these words</b>{#if y}{'in braces'}{/if}</p>\n<style>\n\tp { a: b; }\n</style>",
    );
    let sentences: Vec<&str> = texts.found.iter().map(|text| text.trim()).filter(|text| text.contains(' ')).collect();
    assert_eq!(sentences[..5], ["it is", "two {words}  {}  more", "a title  {}", "these words", "in braces"]);
    assert!(sentences[5..].iter().all(|text| !text.contains(char::is_alphabetic)), "{sentences:?}");
}
