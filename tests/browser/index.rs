//! The index over studies.

use serde_json::json;

use super::desk::{ARMS, Desk, study};
use super::{DESK, PHONE, Screen, browser, contrast, keep, sideways};

#[test]
fn the_index_leads_to_the_reports() {
    let Some(mut browser) = browser() else { return };
    let browser = &mut browser;
    let other = study(ARMS).replace("\"tiny\"", "\"other\"");
    let desk = Desk::with(&[("study.toml", &study(ARMS)), ("other.toml", &other)]);
    for file in ["study.toml", "other.toml"] {
        desk.expect(0, &format!("run {file} --jobs 2"));
        desk.expect(0, &format!("report {file}"));
    }
    desk.expect(0, "index study.toml other.toml");
    let page = desk.path("results/index.html");
    browser.open(&page, DESK);
    assert_eq!(browser.value("document.querySelectorAll('.entry').length"), json!(2));
    let unseen =
        "Array.from(document.images).filter((img) => !img.alt.trim() || img.naturalWidth === 0).length";
    assert_eq!(browser.value("document.images.length"), json!(2));
    assert_eq!(browser.value(unseen), json!(0), "the policy lets the figures be seen");
    for (screen, name) in [(DESK, "desk"), (PHONE, "phone")] {
        for scheme in ["light", "dark"] {
            browser.look(Screen { scheme, ..screen });
            contrast::hold(browser, &format!("{name}, {scheme}"));
            assert_eq!(sideways(browser, screen), 0, "{name}, {scheme}: the page moves sideways");
            let image = browser.screenshot(true);
            keep(&format!("index-{name}-{scheme}.png"), &image);
        }
    }
    let folder = format!("file://{}/", desk.path("results").display());
    let requests = browser.requests();
    assert!(requests.iter().all(|url| url.starts_with(&folder)), "{requests:?}");
    assert_eq!(browser.complaints(), [""; 0]);
    let links = browser.value("Array.from(document.querySelectorAll('.entry a'), (a) => a.href)");
    for link in links.as_array().expect("links") {
        let path = link.as_str().unwrap().strip_prefix("file://").expect("a file");
        assert!(std::path::Path::new(path).exists(), "{path}");
    }
}
