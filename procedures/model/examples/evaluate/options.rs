//! What is asked for on the command line.

use std::path::PathBuf;

pub struct Asked {
    parts: Vec<String>,
    /// Rounds over all effects of all families.
    pub rounds: u64,
    /// Null runs, and runs for each weak effect: a tenth of it.
    pub count: u64,
    /// Number of the first round, null run or weak effect: other numbers are other machines and other noise.
    pub first: u64,
    family: String,
    only: String,
    /// Tables only.
    pub quiet: bool,
    pub folder: Option<PathBuf>,
}

const PARTS: [&str; 7] = ["hidden", "removed", "practice", "measured", "null", "power", "speed"];

impl Asked {
    pub fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut asked = Self {
            parts: PARTS.map(String::from).into(),
            rounds: 3,
            count: 400,
            first: 0,
            family: String::new(),
            only: String::new(),
            quiet: false,
            folder: None,
        };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            let number = |text: String| text.parse().map_err(|_| format!("{text} is not a whole number"));
            match word.as_str() {
                "--part" => asked.parts = value()?.split(',').map(String::from).collect(),
                "--rounds" => asked.rounds = number(value()?)?,
                "--count" => asked.count = number(value()?)?,
                "--first" => asked.first = number(value()?)?,
                "--family" => asked.family = value()?,
                "--only" => asked.only = value()?,
                "--quiet" => asked.quiet = true,
                _ if !word.starts_with("--") => asked.folder = Some(word.into()),
                _ => return Err(format!("{word} is not an option; see the first lines of examples/evaluate/main.rs")),
            }
        }
        match asked.parts.iter().find(|p| !PARTS.contains(&p.as_str())) {
            Some(part) => Err(format!("{part} is not a part; there are {}", PARTS.join(", "))),
            None => Ok(asked),
        }
    }

    pub fn wants(&self, part: &str) -> bool {
        self.parts.iter().any(|p| p == part)
    }

    pub fn takes(&self, family: &str, name: &str) -> bool {
        family.contains(&self.family) && name.contains(&self.only)
    }
}
