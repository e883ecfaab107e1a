//! What a description says beside errors: what was left out, or does not mean what it seems to.

/// Most warnings that are kept.
const WARNING_LIMIT: usize = 1000;

/// Keeps a warning, unless there are very many already.
pub(super) fn warn(warnings: &mut Vec<String>, message: String) {
    if warnings.len() < WARNING_LIMIT {
        warnings.push(message);
    } else if warnings.len() == WARNING_LIMIT {
        warnings.push("more warnings are left out".to_owned());
    }
}
