//! Placeholders in the page's own files: `{{asset:NAME}}`, `{{size:NAME}}`, `{{address}}`, `{{precache}}` and
//! `{{version}}`. Two opening braces always begin a placeholder there; an unknown one is an error.

use anyhow::{Context, Result, bail};

/// A placeholder of one of the page's files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placeholder<'a> {
    /// The name under which a file is served.
    Asset(&'a str),
    /// The number of bytes of a file, uncompressed.
    Size(&'a str),
    /// The folder's public address, or empty if it is not known.
    Address,
    /// The service worker's list of addresses, as JSON.
    Precache,
    /// The hash of everything in that list.
    Version,
}

impl<'a> Placeholder<'a> {
    fn parse(inner: &'a str) -> Option<Self> {
        match inner.split_once(':') {
            Some(("asset", name)) if !name.is_empty() => Some(Self::Asset(name)),
            Some(("size", name)) if !name.is_empty() => Some(Self::Size(name)),
            None if inner == "address" => Some(Self::Address),
            None if inner == "precache" => Some(Self::Precache),
            None if inner == "version" => Some(Self::Version),
            _ => None,
        }
    }
}

/// Returns `text` with each placeholder replaced by its `value`.
///
/// # Errors
/// A placeholder is not closed, not known, or has no value.
pub fn rewrite(
    text: &str,
    mut value: impl FnMut(Placeholder<'_>) -> Result<String>,
) -> Result<String> {
    let mut written = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once("{{") {
        written.push_str(before);
        // Braces that are not understood are an error, as a page with them would be served otherwise.
        let Some((inner, after)) = behind.split_once("}}") else {
            let line = behind.lines().next().unwrap_or_default();
            bail!("the placeholder {{{{{line} is not closed");
        };
        let Some(placeholder) = Placeholder::parse(inner) else {
            bail!("the placeholder {{{{{inner}}}}} is not known");
        };
        let replacement =
            value(placeholder).with_context(|| format!("the placeholder {{{{{inner}}}}}"))?;
        written.push_str(&replacement);
        rest = after;
    }

    written.push_str(rest);
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spelled(placeholder: Placeholder<'_>) -> Result<String> {
        match placeholder {
            Placeholder::Asset("missing.js") => bail!("there is no file missing.js"),
            Placeholder::Asset(name) => Ok(format!("<{name}>")),
            Placeholder::Size(name) => Ok(name.len().to_string()),
            Placeholder::Address => Ok("https://a.example/".to_owned()),
            Placeholder::Precache => Ok("[]".to_owned()),
            Placeholder::Version => Ok("v".to_owned()),
        }
    }

    #[test]
    fn placeholders_are_replaced_and_the_rest_stays() {
        let text = "a {b} ${c} {{asset:d.js}}{{size:abc}} {{precache}}\n{{version}} }}";
        let expected = "a {b} ${c} <d.js>3 []\nv }}";
        assert_eq!(rewrite(text, spelled).unwrap(), expected);
    }

    #[test]
    fn what_cannot_be_resolved_is_an_error_that_names_it() {
        for (text, part) in [
            ("x {{asset:missing.js}}", "{{asset:missing.js}}"),
            ("x {{colour:red}}", "{{colour:red}}"),
            ("x {{asset:}}", "{{asset:}}"),
            ("x {{}}", "{{}}"),
            ("x {{asset:a.js\nmore", "{{asset:a.js"),
        ] {
            let error = format!("{:#}", rewrite(text, spelled).unwrap_err());
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
