//! The dashboard as files inside the binary, with what an HTTP server needs to know to hand them out.

use rust_embed::RustEmbed;
use std::borrow::Cow;

#[derive(RustEmbed)]
#[folder = "$OUT_DIR/dist"]
struct Files;

/// What the pages need, and nothing else: no inline code, no foreign host.
pub const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// One file of the dashboard.
pub struct Asset {
    pub bytes: Cow<'static, [u8]>,
    pub mime: String,
    /// SHA-256 of the uncompressed bytes as hex, unquoted.
    pub sha256: String,
    /// The name carries a hash of the content, so that a browser may keep the file for ever.
    pub immutable: bool,
}

/// The file at `path` (without leading slash), if the dashboard has it.
pub fn asset(path: &str) -> Option<Asset> {
    let file = Files::get(path)?;
    let sha256 = file.metadata.sha256_hash().iter().map(|byte| format!("{byte:02x}")).collect();
    let immutable = path.starts_with("assets/");
    Some(Asset { bytes: file.data, mime: mime(path, file.metadata.mimetype()), sha256, immutable })
}

/// The page for every address that is neither a file nor the API: the dashboard finds its view from the address itself.
pub fn page() -> Asset {
    asset("index.html").expect("the build always writes index.html")
}

/// Why this build has no dashboard. `page` then explains the same to a person.
pub fn missing() -> Option<&'static str> {
    let why = env!("JB_WEB_MISSING");
    (!why.is_empty()).then_some(why)
}

fn mime(path: &str, guessed: &str) -> String {
    match path.rsplit('.').next() {
        Some("html" | "css" | "js") => format!("{guessed}; charset=utf-8"),
        _ => guessed.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_fits_the_policy() {
        let page = page();
        assert_eq!(page.mime, "text/html; charset=utf-8");
        let html = String::from_utf8(page.bytes.into_owned()).unwrap();
        assert!(!html.contains("<style") && !html.contains(" style="), "inline style would be refused: {html}");
        for script in html.split("<script").skip(1) {
            let (tag, body) = script.split_once('>').unwrap();
            assert!(tag.contains("src=\"/"), "script from elsewhere or inline: {tag}");
            assert!(body.starts_with("</script>"), "inline script would be refused");
        }
    }

    #[test]
    fn every_file_that_the_page_names_is_there() {
        let html = String::from_utf8(page().bytes.into_owned()).unwrap();
        if missing().is_some() {
            return println!("skipped: {}", missing().unwrap_or_default());
        }
        let named: Vec<&str> =
            html.split(['"', '\'']).filter(|part| part.starts_with('/') && part.contains('.')).collect();
        assert!(named.len() >= 3, "script, style and icon: {named:?}");
        for path in named {
            let file = asset(path.trim_start_matches('/')).unwrap_or_else(|| panic!("{path} is not embedded"));
            assert_eq!(file.sha256.len(), 64);
            assert_eq!(file.immutable, path.starts_with("/assets/"));
        }
    }
}
