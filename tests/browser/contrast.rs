//! Contrast of text with what lies behind it, as the browser has computed both.

use super::chromium::Browser;

/// The contrast that text must have (W3C, Web Content Accessibility Guidelines 2.2, 1.4.3, level AA).
const LEAST: f64 = 4.5;

/// Goes through all text that is shown: the contrast by the guidelines' formula for relative luminance. Returns the worst, and whose it is.
const WORST: &str = r#"(() => {
  const channels = (colour) => colour.match(/[\d.]+/g).map(Number);
  const linear = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
  const light = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = channels(getComputedStyle(e).backgroundColor);
      if (colour.length === 3 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let worst = { ratio: 99, text: "", count: 0 };
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    const text = walker.currentNode.textContent.trim();
    if (!text || !element.checkVisibility() || element.closest("script, style")) continue;
    const [a, b] = [light(channels(getComputedStyle(element).color)), light(behind(element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    worst.count += 1;
    if (ratio < worst.ratio) worst = { ratio, text, count: worst.count };
  }
  return worst;
})()"#;

/// Holds all text that is shown to the least contrast.
pub fn hold(browser: &mut Browser, where_: &str) {
    let worst = browser.value(WORST);
    let (ratio, count) = (worst["ratio"].as_f64().unwrap(), worst["count"].as_u64().unwrap());
    assert!(count > 20, "{where_}: only {count} texts were looked at");
    assert!(ratio >= LEAST, "{where_}: contrast {ratio:.2} of {:?}", worst["text"]);
}
