//! What the system says of files, in words that tell what to do.

use std::io::{Error, ErrorKind};

/// An error of the disk without its number, and what may help.
pub fn said(error: &Error) -> String {
    let text = error.to_string();
    let plain = text.split(" (os error").next().unwrap_or(&text).to_lowercase();
    let help = match error.kind() {
        ErrorKind::NotFound => "; check the path",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "; choose another place, or ask for the right",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; make room, or choose another disk",
        _ => "",
    };
    plain + help
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_left_out_and_help_is_given() {
        let full = said(&Error::from_raw_os_error(28));
        assert!(!full.contains("os error") && full.ends_with("; make room, or choose another disk"), "{full}");
        assert_eq!(said(&Error::other("Strange")), "strange");
    }
}
