//! Writes every recording into the folder that is named, and says which file it has written.

use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

use stormpetrel_portable::recipe::recipes;
use stormpetrel_portable::record::recording;

fn main() -> ExitCode {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    match run(Path::new(&folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("record: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for recipe in recipes()? {
        let file = folder.join(&recipe.name);
        std::fs::write(&file, recording(&recipe)?)
            .map_err(|error| format!("{}: {error}", file.display()))?;
        writeln!(std::io::stdout(), "{}", file.display()).map_err(|error| error.to_string())?;
    }
    Ok(())
}
