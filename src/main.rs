//! The program: words in, exit status out. Everything else is in the library.

use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    // One line, whatever happens; the location is what a report needs.
    std::panic::set_hook(Box::new(|info| {
        let what = info.payload_as_str().unwrap_or("no reason given").replace(['\n', '\r'], " ");
        let place = info.location().map(|l| format!("{}:{}", l.file(), l.line())).unwrap_or_default();
        let _ = writeln!(
            std::io::stderr(),
            "error: internal: {what} ({place})\nhelp: this is a fault of cullscope; please report it with \
             the call that led to it"
        );
    }));
    match std::panic::catch_unwind(|| cullscope::cli::run(std::env::args_os())) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            if error.status() != 0 {
                let _ = std::io::stderr().write_all(error.message().as_bytes());
            }
            ExitCode::from(error.status())
        }
        Err(_) => ExitCode::from(1),
    }
}
