//! Checks the specs named on the command line.

fn main() -> std::io::Result<()> {
    for file in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&file)?;
        match appell_spec::load(&file, &text) {
            Ok(checked) => {
                println!("{file}: {}", checked.mechanism.title);
                let warnings = appell_spec::Report::new(file.as_str(), text, checked.warnings);
                println!("{}", warnings.plain());
            }
            Err(report) => println!("{}", report.plain()),
        }
    }
    Ok(())
}
