//! Block of signatures at the end of the first page.

use maud::{Markup, html};

/// Known fields of the block. A missing one becomes a line to fill in by hand.
#[derive(Debug, Default)]
pub struct SignOff<'a> {
    /// Part of the unit under test.
    pub unit: Option<&'a str>,
    pub serial: Option<&'a str>,
    pub operator: Option<&'a str>,
    pub date: Option<&'a str>,
}

pub fn block(known: &SignOff) -> Markup {
    html! {
        section.sign-off {
            h2 { "Sign-off" }
            div.fields {
                (field("Unit under test", known.unit))
                (field("Serial number", known.serial))
                (field("Operator", known.operator))
                (field("Date", known.date))
                (field("Signature of the operator", None))
                (field("Approved by (name, date, signature)", None))
            }
        }
    }
}

fn field(label: &str, value: Option<&str>) -> Markup {
    html! { div.field { div.line { (value.unwrap_or_default()) } div.quiet { (label) } } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_field_is_a_line_to_fill_in() {
        let page = block(&SignOff { serial: Some("SN <7>"), ..SignOff::default() }).into_string();
        assert!(
            page.contains(r#"<div class="line">SN &lt;7&gt;</div><div class="quiet">Serial number</div>"#),
            "{page}"
        );
        assert!(page.contains(r#"<div class="line"></div><div class="quiet">Unit under test</div>"#), "{page}");
        assert_eq!(page.matches("class=\"line\"").count(), 6);
    }
}
