//! The number formats of C's `sscanf`.

/// `%u` after optional spaces: the number and the rest. A negative number is accepted too, and wraps.
pub fn unsigned(text: &str) -> Option<(u32, &str)> {
    let text = text.trim_start();
    if let Some(size) = text.strip_prefix('-') {
        let (size, rest) = digits(size)?;
        return Some((size.wrapping_neg(), rest));
    }
    digits(text.strip_prefix('+').unwrap_or(text))
}

fn digits(text: &str) -> Option<(u32, &str)> {
    let count = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (number, rest) = text.split_at(count);
    // Too many digits wrap in C. Here they saturate, which is not a valid motor number either.
    (count > 0).then(|| (number.parse().unwrap_or(u32::MAX), rest))
}

/// `%f` after optional spaces: `nan` and `inf` are numbers; text after the number is not consumed.
pub fn float(text: &str) -> Option<(f32, &str)> {
    let text = text.trim_start();
    let bytes = text.as_bytes();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let word = text.get(sign..sign + 3).map(str::to_ascii_lowercase);
    if let Some(value) = word.and_then(|word| match word.as_str() {
        "nan" => Some(f32::NAN),
        "inf" => Some(f32::INFINITY),
        _ => None,
    }) {
        return Some((if bytes[0] == b'-' { -value } else { value }, &text[sign + 3..]));
    }
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut decimals = 0;
    if bytes.get(end) == Some(&b'.') {
        decimals = digits(end + 1);
        end += 1 + decimals;
    }
    if whole + decimals == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let from = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(from.min(bytes.len()));
        end = if exponent > 0 { from + exponent } else { end };
    }
    text[..end].parse().ok().map(|value| (value, &text[end..]))
}

/// `printf("%f")` of a float.
pub fn print_float(value: f32) -> String {
    if value.is_nan() { "nan".into() } else { format!("{:.6}", f64::from(value)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_where_c_ends_them() {
        assert_eq!(float(" 1e-3 rest"), Some((1e-3, " rest")));
        assert_eq!(float("-.5junk"), Some((-0.5, "junk")));
        assert_eq!(float("2e"), Some((2.0, "e")));
        assert_eq!(float("-inf"), Some((f32::NEG_INFINITY, "")));
        assert!(float("nan").unwrap().0.is_nan());
        assert_eq!(float("."), None);
        assert_eq!(float("el"), None);
        assert_eq!(unsigned("  0 1"), Some((0, " 1")));
        assert_eq!(unsigned("x"), None);
        assert_eq!(unsigned("-5 rest"), Some((4_294_967_291, " rest")));
        assert_eq!((unsigned("+7"), unsigned("- 7"), unsigned("+-7")), (Some((7, "")), None, None));
        assert_eq!(print_float(-123.456), "-123.456001");
    }
}
