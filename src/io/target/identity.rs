//! Tables as they are.

use crate::io::target::Target;

/// The table as it was baked, in whichever formats are asked for.
pub static IDENTITY: Target = Target {
    name: "table",
    summary: "the table as it was baked, in any format",
    axes: None,
    channels: None,
    storage: None,
    container: None,
};
