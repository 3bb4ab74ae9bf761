//! Running other programs, with their name and time on the screen.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// The root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Where cargo puts what it builds.
pub fn target_dir() -> PathBuf {
    let named = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
    root().join(named)
}

/// Adds a compilation target where it is missing.
pub fn install(target: &str) -> Result<(), String> {
    Step::new(&format!("target {target}"), "rustup", &["target", "add", target]).run()
}

/// One program run of a task.
pub struct Step {
    title: String,
    command: Command,
    limit: Option<Duration>,
}

impl Step {
    /// A program with arguments, run in the root of the project.
    pub fn new(title: &str, program: &str, arguments: &[&str]) -> Self {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(root());
        Self { title: title.into(), command, limit: None }
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

    /// The same without input, ended by force after so many seconds.
    pub fn within(mut self, seconds: u64) -> Self {
        self.command.stdin(Stdio::null());
        self.limit = Some(Duration::from_secs(seconds));
        self
    }

    /// Runs it; what it prints goes to the screen.
    pub fn run(mut self) -> Result<(), String> {
        let begin = Instant::now();
        eprintln!("== {}", self.title);
        let status = self.status(begin)?;
        if !status.success() {
            return Err(format!("{} failed ({status})", self.title));
        }
        eprintln!("== {}: good, {:.0} s", self.title, begin.elapsed().as_secs_f64());
        Ok(())
    }

    fn status(&mut self, begin: Instant) -> Result<ExitStatus, String> {
        let mut child = self.command.spawn().map_err(|e| self.refused(&e))?;
        let Some(limit) = self.limit else {
            return child.wait().map_err(|e| self.refused(&e));
        };
        loop {
            if let Some(status) = child.try_wait().map_err(|e| self.refused(&e))? {
                return Ok(status);
            }
            if begin.elapsed() > limit {
                let ended = child.kill().and_then(|()| child.wait());
                ended.map_err(|e| self.refused(&e))?;
                return Err(format!("{}: no end after {} s", self.title, limit.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(20));
        }
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
