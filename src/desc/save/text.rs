//! The text of a scene file for people: what fits is on one line, and keys without a value are left out.

use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use crate::{Error, ErrorKind, Result};

/// Length of the longest line that holds more than one value.
const LINE: usize = 120;

/// A value as compact JSON.
pub(in crate::desc) fn raw(value: &impl Serialize) -> Result<Box<RawValue>> {
    to_raw_value(value).map_err(|error| {
        Error::new(ErrorKind::Internal, format!("a part of the scene cannot be written: {error}")).because(error)
    })
}

/// Lays out compact JSON that begins at a column which is indented by `indent`.
pub(super) fn laid_out(compact: &str, indent: usize) -> String {
    let mut out = String::new();
    Node::read(compact, &mut 0).write(indent, &mut out);
    out
}

/// A part of a JSON text.
enum Node<'a> {
    /// A string, a number, a boolean or null.
    Leaf(&'a str),
    List(Vec<Node<'a>>),
    /// Members with their keys in quotes.
    Object(Vec<(&'a str, Node<'a>)>),
}

impl<'a> Node<'a> {
    /// Reads the value at `at` of a compact JSON text, which a serializer has made.
    fn read(text: &'a str, at: &mut usize) -> Self {
        let byte = |at: usize| text.as_bytes().get(at).copied();
        match byte(*at) {
            Some(b'[') => {
                let mut list = Vec::new();
                *at += 1;
                while byte(*at).is_some_and(|byte| byte != b']') {
                    list.push(Self::read(text, at));
                    *at += usize::from(byte(*at) == Some(b','));
                }
                *at += 1;
                Self::List(list)
            }
            Some(b'{') => {
                let mut members = Vec::new();
                *at += 1;
                while byte(*at).is_some_and(|byte| byte != b'}') {
                    let key = leaf(text, at);
                    // The colon.
                    *at += 1;
                    let value = Self::read(text, at);
                    if !matches!(value, Self::Leaf("null")) {
                        members.push((key, value));
                    }
                    *at += usize::from(byte(*at) == Some(b','));
                }
                *at += 1;
                Self::Object(members)
            }
            _ => {
                let leaf = leaf(text, at);
                // A whole number needs no fraction, but for the sign of -0.
                let whole = leaf.strip_suffix(".0").filter(|whole| *whole != "-0");
                Self::Leaf(whole.unwrap_or(leaf))
            }
        }
    }

    fn write(&self, indent: usize, out: &mut String) {
        let line = self.line();
        let inner = indent + 2;
        let begin = |out: &mut String| {
            out.push('\n');
            out.extend(std::iter::repeat_n(' ', inner));
        };
        match self {
            _ if indent + line.len() <= LINE => out.push_str(&line),
            Self::Leaf(text) => out.push_str(text),
            Self::Object(members) => {
                out.push('{');
                for (i, (key, value)) in members.iter().enumerate() {
                    out.push_str(if i > 0 { "," } else { "" });
                    begin(out);
                    out.push_str(key);
                    out.push_str(": ");
                    value.write(inner, out);
                }
                out.push('\n');
                out.extend(std::iter::repeat_n(' ', indent));
                out.push('}');
            }
            Self::List(list) => {
                out.push('[');
                let mut column = LINE;
                for (i, value) in list.iter().enumerate() {
                    out.push_str(if i > 0 { "," } else { "" });
                    let next = value.line().len() + 2;
                    if column + next > LINE {
                        begin(out);
                        column = inner;
                    } else {
                        out.push(' ');
                    }
                    value.write(inner, out);
                    column += next;
                }
                out.push('\n');
                out.extend(std::iter::repeat_n(' ', indent));
                out.push(']');
            }
        }
    }

    /// The value on one line.
    fn line(&self) -> String {
        match self {
            Self::Leaf(text) => (*text).to_owned(),
            Self::List(list) => format!("[{}]", list.iter().map(Self::line).collect::<Vec<_>>().join(", ")),
            Self::Object(members) => {
                let member = |(key, value): &(&str, Self)| format!("{key}: {}", value.line());
                format!("{{{}}}", members.iter().map(member).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

/// The string, number or word at `at`.
fn leaf<'a>(text: &'a str, at: &mut usize) -> &'a str {
    let bytes = &text.as_bytes()[*at..];
    let length = if bytes.first() == Some(&b'"') {
        let mut escaped = false;
        let end = bytes[1..].iter().position(|byte| {
            let ends = *byte == b'"' && !escaped;
            escaped = *byte == b'\\' && !escaped;
            ends
        });
        end.map_or(bytes.len(), |end| end + 2)
    } else {
        bytes.iter().position(|byte| b",:]}".contains(byte)).unwrap_or(bytes.len())
    };
    let start = *at;
    *at += length;
    &text[start..*at]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_is_on_one_line_and_nulls_are_left_out() {
        let compact = r#"{"name":"a \"b\", {c}: \\.0","none":null,"list":[1,-2.5,4.0,-0.0,[true,{}]],"empty":[]}"#;
        assert_eq!(
            laid_out(compact, 2),
            r#"{"name": "a \"b\", {c}: \\.0", "list": [1, -2.5, 4, -0.0, [true, {}]], "empty": []}"#
        );
    }

    #[test]
    fn long_values_are_broken_and_stay_the_same() {
        let numbers: Vec<f64> = (0..60).map(|i| (f64::from(i) + 0.5) / 7.0).collect();
        let value =
            serde_json::json!({"numbers": numbers, "text": "x".repeat(200), "rows": [[1, 2], ["y".repeat(150)]]});
        let text = laid_out(&value.to_string(), 4);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
        let long = text.lines().filter(|line| line.len() > LINE).count();
        assert_eq!(long, 2, "the two long strings alone: {text}");
        assert!(text.lines().count() > 8 && text.lines().count() < 30, "{text}");
    }
}
