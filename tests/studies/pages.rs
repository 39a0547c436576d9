//! Pages whose numbers come from tables: what is committed is what their sources make of the committed tables.

use std::path::Path;

use snowlab_study::template;

#[test]
fn pages_are_those_of_their_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut pages = 0;
    for source in std::fs::read_dir(root.join("docs/sources")).unwrap().map(|entry| entry.unwrap().path()) {
        let name = source
            .file_name()
            .unwrap()
            .to_str()
            .unwrap()
            .strip_suffix(".jinja")
            .expect("a source ends in .jinja")
            .to_string();
        let made = template::page(&std::fs::read_to_string(&source).unwrap(), &root)
            .unwrap_or_else(|error| panic!("{name}: {error:#}"));
        let page = std::fs::read_to_string(root.join("docs").join(&name)).unwrap();
        assert!(
            made == page,
            "docs/{name} is not what docs/sources/{name}.jinja makes; run `snowlab page docs/sources/{name}.jinja -o docs/{name}`"
        );
        pages += 1;
    }
    assert!(pages > 0, "there are pages");
}
