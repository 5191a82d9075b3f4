//! Scripts as they are served. Comments are for readers of the source; a third of what the page's own scripts weigh,
//! compressed, is comments.

/// Returns a script without comments that begin a line, indentation and empty lines. A script with a text over several lines is
/// returned as it is, since a line of that text may look like a comment.
pub fn without_comments(script: &str) -> String {
    // Such a text has its backticks on different lines, or a backslash at the end of a line.
    let goes_on = |line: &str| line.matches('`').count() % 2 == 1 || line.ends_with('\\');
    if script.lines().any(goes_on) {
        return script.to_owned();
    }

    let mut bare = String::with_capacity(script.len());
    let mut is_comment = false;
    for line in script.lines() {
        let mut code = line.trim();

        // Several comments may begin a line, and code may stand behind them.
        loop {
            if !is_comment {
                let Some(comment) = code.strip_prefix("/*") else {
                    break;
                };
                code = comment;
            }

            let after = code.split_once("*/");
            is_comment = after.is_none();
            code = after.map_or("", |(_, after)| after.trim_start());
            if is_comment {
                break;
            }
        }

        if !code.is_empty() && !code.starts_with("//") {
            bare.push_str(code);
            bare.push('\n');
        }
    }
    bare
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_that_begin_a_line_go_and_code_stays() {
        let script = "// @ts-check\n/**\n * Two `words`.\n */\nfunction f() {\n\n  /** @type {any} */ (window).f = f;\n  \
                      // Why.\n  return \"// no comment\"; // stays\n}\n";
        let bare = "function f() {\n(window).f = f;\nreturn \"// no comment\"; // stays\n}\n";
        assert_eq!(without_comments(script), bare);
        assert_eq!(without_comments("/* a */ /* b\nc */ d();\n"), "d();\n");
        assert_eq!(without_comments("/*/ it\nnever ends"), "");
    }

    #[test]
    fn texts_over_several_lines_stay_whole() {
        for script in ["f(`a\n// b`);\n", "f(\"a\\\n// b\");\n"] {
            assert_eq!(without_comments(script), script);
        }
    }
}
