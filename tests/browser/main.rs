//! Report and index in a real browser: nothing leaves the page, nothing is complained of, tables sort, the slider moves, and all of it fits a phone.

#[path = "../desk/mod.rs"]
mod desk;

mod chromium;
mod contrast;
mod index;
mod report;

use chromium::{Browser, Screen};

/// A desk screen.
const DESK: Screen = Screen { width: 1280, height: 900, scheme: "light", still: false };
/// The narrowest phone in use.
const PHONE: Screen = Screen { width: 360, height: 740, scheme: "light", still: false };

/// A browser; none where it is not installed, which is told, and is an error where the test must not be left out.
fn browser() -> Option<Browser> {
    let Some(program) = Browser::installed() else {
        assert!(std::env::var_os("SNOWLAB_NEEDS_BROWSER").is_none(), "Chromium is not installed");
        println!(
            "SKIPPED: Chromium is not installed; `apt-get install --no-install-recommends chromium` has it"
        );
        return None;
    };
    Some(Browser::start(program))
}

/// Keeps what was seen in cargo's folder for tests, for who wants to look.
fn keep(name: &str, bytes: &[u8]) {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    std::fs::create_dir_all(&folder).expect("the target directory can be written");
    std::fs::write(folder.join(name), bytes).expect("the target directory can be written");
}

/// By how many pixels the page as a whole can be moved sideways. What the page takes for its width would not do: a phone zooms out of a page that is too wide.
fn sideways(browser: &mut Browser, screen: Screen) -> i64 {
    browser.value("document.documentElement.scrollWidth").as_i64().expect("a width") - i64::from(screen.width)
}
