//! The derivation on paper.

mod support;

use std::fs;
use std::process::Command;

use support::Folder;

/// Browsers that print, in the order in which they are tried.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

#[test]
fn the_derivations_of_the_papers_mechanisms_are_one_page_of_paper_each() {
    let folder = Folder::new();
    for mechanism in ["unicycle", "euc_3dof", "rolling_wheel"] {
        let page = format!("{mechanism}.html");
        let out = folder.run(&["derive", mechanism, "--format", "html"]);
        assert_eq!(out.status, 0, "{}", out.stderr);
        folder.write(&page, &out.stdout);
        let Some(pdf) = printed(&folder, &page) else {
            println!("skipped: no browser prints here");
            return;
        };
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.contains("/Count 1"), "{mechanism}: not one page");
    }
}

/// A page as PDF; `None` where no browser can be started.
fn printed(folder: &Folder, page: &str) -> Option<Vec<u8>> {
    let (page, pdf) = (folder.path(page), folder.path("page.pdf"));
    let data = folder.path("browser");
    BROWSERS.iter().find_map(|browser| {
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
            .output();
        done.is_ok_and(|done| done.status.success())
            .then(|| fs::read(&pdf).ok())
            .flatten()
    })
}
