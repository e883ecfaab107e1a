//! Warnings of a description about parts that were left out or that do not mean what they seem to mean.

/// Greatest number of warnings that are kept.
const WARNING_LIMIT: usize = 1000;

/// Adds a warning, unless there are very many already.
pub(super) fn warn(warnings: &mut Vec<String>, message: String) {
    if warnings.len() < WARNING_LIMIT {
        warnings.push(message);
    } else if warnings.len() == WARNING_LIMIT {
        warnings.push("more warnings are left out".to_owned());
    }
}
