//! The report of a small study.

use std::path::PathBuf;

use serde_json::json;

use super::chromium::{Browser, Screen};
use super::desk::{ARMS, Desk, STOPPING_ARM, study};
use super::{DESK, PHONE, browser, contrast, keep, sideways};

/// A report with claims, figures, frames, tables and failures.
fn made() -> (Desk, PathBuf) {
    let text = study(&[ARMS, STOPPING_ARM].concat()).replace("frame_interval = 0.5", "frame_interval = 0.25");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(3, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    let page = desk.path("results/tiny/report.html");
    (desk, page)
}

/// The texts of a column of the summary, row by row.
fn column(browser: &mut Browser, number: usize) -> Vec<String> {
    let cells = format!(
        "Array.from(document.querySelectorAll('#tables table')[1].tBodies[0].rows, (row) => row.cells[{number}].textContent)"
    );
    let cells = browser.value(&cells);
    cells.as_array().expect("rows").iter().map(|cell| cell.as_str().unwrap().to_string()).collect()
}

/// What the slider says, and the images that are shown.
fn shown(browser: &mut Browser) -> (String, Vec<String>) {
    let told = browser.value("document.querySelector('#player output').textContent");
    let images = browser.value(
        "Array.from(document.querySelectorAll('.strip'), (strip) => \
         Array.from(strip.querySelectorAll('img')).filter((img) => img.checkVisibility()).map((img) => img.alt).join('|'))",
    );
    let images = images.as_array().expect("arms").iter().map(|alt| alt.as_str().unwrap().to_string());
    (told.as_str().expect("a time").into(), images.collect())
}

#[test]
fn a_report_works_in_a_browser() {
    let Some(mut browser) = browser() else { return };
    let browser = &mut browser;
    let (_desk, page) = made();
    browser.open(&page, DESK);

    hold_tables_sort(browser);
    hold_slider_moves(browser);
    hold_all_is_seen(browser);

    // Both schemes, on a desk and on a phone.
    for (screen, name) in [(DESK, "desk"), (PHONE, "phone")] {
        for scheme in ["light", "dark"] {
            browser.look(Screen { scheme, ..screen });
            contrast::hold(browser, &format!("{name}, {scheme}"));
            assert_eq!(sideways(browser, screen), 0, "{name}, {scheme}: the page moves sideways");
            let image = browser.screenshot(true);
            keep(&format!("report-{name}-{scheme}.png"), &image);
        }
    }
    let sheet = browser.print();
    assert!(sheet.starts_with(b"%PDF"));
    keep("report.pdf", &sheet);

    assert_eq!(browser.requests(), [format!("file://{}", page.display())], "only the page itself is fetched");
    assert_eq!(browser.complaints(), [""; 0]);
    hold_nothing_else_runs(browser);
}

/// A click sorts by numbers and again the other way round; Enter does what a click does.
fn hold_tables_sort(browser: &mut Browser) {
    let head = |number: usize| {
        format!("document.querySelectorAll('#tables table')[1].tHead.rows[0].cells[{number}]")
    };
    let as_written = column(browser, 0);
    assert_eq!(as_written.len(), 4, "an arm a row: {as_written:?}");
    browser.value(&format!("{}.querySelector('button').click()", head(0)));
    let mut sorted = as_written.clone();
    sorted.sort();
    assert_ne!(sorted, as_written, "the order of the study is another");
    assert_eq!(column(browser, 0), sorted);
    assert_eq!(browser.value(&format!("{}.getAttribute('aria-sort')", head(0))), json!("ascending"));

    // The arm that stopped has no values: it stays below.
    browser.value(&format!("{}.querySelector('button').focus()", head(2)));
    let number = |text: &String| text.split(' ').next().unwrap().parse::<f64>().ok();
    for (direction, sign) in [("ascending", 1.0), ("descending", -1.0)] {
        browser.press("Enter");
        assert_eq!(browser.value(&format!("{}.getAttribute('aria-sort')", head(2))), json!(direction));
        let cells = column(browser, 2);
        let values: Vec<f64> = cells.iter().filter_map(number).collect();
        assert_eq!(values.len(), 3, "{cells:?}");
        assert!(values.windows(2).all(|pair| sign * pair[0] <= sign * pair[1]), "{direction}: {cells:?}");
        assert_eq!(cells[3], "-", "{direction}: {cells:?}");
    }
    assert_eq!(browser.value(&format!("{}.getAttribute('aria-sort')", head(0))), json!(null));
}

/// Keys and buttons move the pictures of all arms at once, and what is said of them.
fn hold_slider_moves(browser: &mut Browser) {
    let (end, last) = shown(browser);
    assert!(end.ends_with("after contact"), "{end}");
    assert_eq!(last.len(), 3, "an arm that stopped is not shown: {last:?}");
    assert!(last.iter().all(|alt| !alt.is_empty() && !alt.contains('|')), "one picture an arm: {last:?}");
    let before = browser.screenshot(true);

    browser.value("document.querySelector('#player input').focus()");
    browser.press("ArrowLeft");
    let (earlier, pictures) = shown(browser);
    assert_ne!(earlier, end);
    assert!(pictures.iter().zip(&last).all(|(a, b)| a != b), "all arms move: {pictures:?}");
    assert_eq!(
        browser.value("document.querySelector('#player input').getAttribute('aria-valuetext')"),
        json!(earlier)
    );
    browser.press("Home");
    let (start, first) = shown(browser);
    assert!(
        start == "0.0 R/v after contact" && first.iter().all(|alt| alt.contains("1 fragment,")),
        "{start}: {first:?}"
    );
    assert_ne!(browser.screenshot(true), before, "what is seen is another");

    browser.value("document.querySelector('[data-act=previous]').click()");
    assert_eq!(shown(browser).0, start, "there is nothing before the start");
    browser.value("document.querySelector('[data-act=next]').click()");
    assert_ne!(shown(browser).0, start);

    // Played to the end it stops there.
    let play = "document.querySelector('[data-act=play]')";
    browser.value(&format!("{play}.click()"));
    assert_eq!(browser.value(&format!("{play}.textContent")), json!("Pause"));
    wait_until(browser, &format!("{play}.textContent === 'Play'"));
    assert_eq!(shown(browser), (end, last));

    // Who asks for little motion has no such button.
    assert_eq!(browser.value(&format!("{play}.checkVisibility()")), json!(true));
    browser.look(Screen { still: true, ..DESK });
    wait_until(browser, &format!("!{play}.checkVisibility()"));
    browser.look(DESK);
    wait_until(browser, &format!("{play}.checkVisibility()"));
}

/// Waits until a condition of the page holds; the browser's own limit ends the test where it never does.
fn wait_until(browser: &mut Browser, condition: &str) {
    browser.value(&format!(
        "new Promise((done) => {{ const look = () => ({condition} ? done() : setTimeout(look, 50)); look(); }})"
    ));
}

/// Words for every image, heads in order, one of each landmark, names for what is operated.
fn hold_all_is_seen(browser: &mut Browser) {
    assert_eq!(browser.value("Array.from(document.images).filter((img) => !img.alt.trim() || !img.complete || img.naturalWidth === 0).length"), json!(0));
    assert!(browser.value("document.images.length").as_u64() > Some(8));
    let levels =
        browser.value("Array.from(document.querySelectorAll('h1, h2, h3, h4'), (h) => Number(h.tagName[1]))");
    let levels: Vec<u64> = levels.as_array().unwrap().iter().map(|level| level.as_u64().unwrap()).collect();
    assert_eq!(levels[0], 1);
    assert!(levels.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{levels:?}");
    for landmark in ["main", "body > header", "nav", "h1", "html[lang=en]"] {
        assert_eq!(
            browser.value(&format!("document.querySelectorAll('{landmark}').length")),
            json!(1),
            "{landmark}"
        );
    }
    assert_eq!(browser.value("document.querySelector('#instant').labels.length"), json!(1));
    // The first stop of the Tab key leads past the head of the page.
    browser.value("document.activeElement.blur(), getSelection().removeAllRanges(), scrollTo(0, 0)");
    browser.value(
        "document.body.tabIndex = -1, document.body.focus(), document.body.removeAttribute('tabindex')",
    );
    browser.press("Tab");
    assert_eq!(browser.value("document.activeElement.className"), json!("skip"));
    assert_eq!(browser.value("document.querySelector(document.activeElement.hash) !== null"), json!(true));
}

/// What is put into the page does not run, and nothing can be fetched: the policy is of this very script.
fn hold_nothing_else_runs(browser: &mut Browser) {
    browser.value("{ const s = document.createElement('script'); s.textContent = 'window.ran = true'; document.body.append(s); }");
    assert_eq!(browser.value("window.ran === undefined"), json!(true));
    assert_eq!(
        browser.value("fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'refused')"),
        json!("refused")
    );
    let complaints = browser.complaints();
    assert!(complaints.iter().any(|line| line.contains("Content Security Policy")), "{complaints:?}");
}

/// Without a script the last frame of each arm is there, and no slider that does nothing.
#[test]
fn a_report_reads_without_a_script() {
    let Some(mut browser) = browser() else { return };
    let browser = &mut browser;
    let (_desk, page) = made();
    browser.ask("Emulation.setScriptExecutionDisabled", json!({ "value": true }));
    browser.open(&page, DESK);
    let count = "(selector) => Array.from(document.querySelectorAll(selector)).filter((e) => e.checkVisibility()).length";
    assert_eq!(browser.value(&format!("({count})('.strip img')")), json!(3));
    assert_eq!(browser.value(&format!("({count})('#player')")), json!(0));
    assert_eq!(browser.value(&format!("({count})('th button')")), json!(0));
    assert_eq!(browser.complaints(), [""; 0]);
}
