//! Symbols with printed indices.

use maud::{Markup, html};

/// `τ_c⁺ − τ_c⁻` with each index as subscript.
pub fn printed(symbol: &str) -> Markup {
    let mut parts = symbol.split('_');
    let first = parts.next().unwrap_or_default();
    let is_index = |letter: char| letter.is_alphabetic() || letter.is_ascii_digit();
    let indexed = parts.map(|part| part.split_at(part.find(|letter| !is_index(letter)).unwrap_or(part.len())));
    html! {
        (first)
        @for (index, rest) in indexed { sub { (index) } (rest) }
    }
}

#[cfg(test)]
mod tests {
    use super::printed;

    #[test]
    fn an_index_is_a_subscript() {
        for (symbol, shown) in [
            ("τ_c⁺ − τ_c⁻", "τ<sub>c</sub>⁺ − τ<sub>c</sub>⁻"),
            ("c_Tτ", "c<sub>Tτ</sub>"),
            ("r²⁺", "r²⁺"),
            ("ξ_2", "ξ<sub>2</sub>"),
        ] {
            assert_eq!(printed(symbol).into_string(), shown);
        }
    }
}
