//! Running other programs, with their name and time on the screen.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// The root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// One program run of a task.
pub struct Step {
    title: String,
    command: Command,
}

impl Step {
    /// A program with arguments, run in the root of the project.
    pub fn new(title: &str, program: &str, arguments: &[&str]) -> Self {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(root());
        Self { title: title.into(), command }
    }

    /// Cargo with arguments.
    pub fn cargo(title: &str, arguments: &[&str]) -> Self {
        Self::new(title, env!("CARGO"), arguments)
    }

    /// The same with an environment variable.
    pub fn env(mut self, name: &str, value: &str) -> Self {
        self.command.env(name, value);
        self
    }

    /// Runs it; what it prints goes to the screen.
    pub fn run(mut self) -> Result<(), String> {
        let begin = Instant::now();
        eprintln!("== {}", self.title);
        let status = self.command.status().map_err(|e| self.refused(&e))?;
        if !status.success() {
            return Err(format!("{} failed ({status})", self.title));
        }
        eprintln!("== {}: good, {:.0} s", self.title, begin.elapsed().as_secs_f64());
        Ok(())
    }

    /// Runs it and returns what it prints.
    pub fn output(mut self) -> Result<String, String> {
        let output = self.command.output().map_err(|e| self.refused(&e))?;
        if output.status.success() {
            return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
        }
        let said = String::from_utf8_lossy(&output.stderr);
        Err(format!("{} failed ({}): {said}", self.title, output.status))
    }

    fn refused(&self, error: &std::io::Error) -> String {
        let program = self.command.get_program().to_string_lossy();
        format!("{}: cannot start {program}: {error}", self.title)
    }
}
