//! The licences that other people's code may have.

/// A licence by its SPDX identifier, and why it may be.
pub struct Allowed {
    pub licence: &'static str,
    pub why: &'static str,
}

/// None of them asks for more than that its text and the names of the authors go along.
pub const ALLOWED: [Allowed; 9] = [
    Allowed { licence: "Apache-2.0", why: "one of our own two" },
    Allowed {
        licence: "Apache-2.0 WITH LLVM-exception",
        why: "Apache-2.0, and compiled programs need not carry its text",
    },
    Allowed { licence: "BSD-3-Clause", why: "as MIT, and the authors' names must not be used to advertise" },
    Allowed { licence: "BSL-1.0", why: "as MIT, and compiled programs need not carry its text" },
    Allowed { licence: "CC0-1.0", why: "asks for nothing; of a crate that runs while another is compiled" },
    Allowed { licence: "ISC", why: "as MIT, in fewer words" },
    Allowed { licence: "MIT", why: "one of our own two" },
    Allowed { licence: "Unicode-3.0", why: "as MIT, of tables made from Unicode's data" },
    Allowed { licence: "Zlib", why: "as MIT, and changed sources must say that they are" },
];

/// Whether a licence, with its exception, is one of them.
pub fn is_allowed(licence: &str) -> bool {
    ALLOWED.iter().any(|allowed| allowed.licence == licence)
}
