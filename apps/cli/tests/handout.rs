//! The derivation on paper.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::browser::program;
use crate::support::Folder;

#[test]
fn the_derivations_of_the_papers_mechanisms_are_one_page_of_paper_each() {
    let Some(browser) = program() else { return };
    let folder = Folder::new();
    for mechanism in ["unicycle", "euc_3dof", "rolling_wheel"] {
        let page = format!("{mechanism}.html");
        let out = folder.run(&["derive", mechanism, "--format", "html"]);
        assert_eq!(out.status, 0, "{}", out.stderr);
        folder.write(&page, &out.stdout);
        let pdf = printed(&browser, &folder, &page);
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.contains("/Count 1"), "{mechanism}: not one page");
    }
}

/// A page as PDF.
fn printed(browser: &Path, folder: &Folder, page: &str) -> Vec<u8> {
    let (page, pdf) = (folder.path(page), folder.path("page.pdf"));
    let data = folder.path("browser");
    let done = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
        ])
        .args(["--disable-background-networking", "--disable-sync"])
        .arg(format!("--user-data-dir={}", data.display()))
        .arg("--no-pdf-header-footer")
        .arg(format!("--print-to-pdf={}", pdf.display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .expect("the browser starts");
    assert!(done.status.success(), "{done:?}");
    fs::read(&pdf).expect("a PDF")
}
