//! Parse, dispatch, print the error chain, exit code; and before, what the driver's layers may print.

use std::process::ExitCode;

use rasterlab::cli::{self, Exit};

/// Mesa's layer that chooses a device asks Wayland for it, and where there is no `XDG_RUNTIME_DIR`
/// its library writes an error for each time: there the program begins again without that layer.
/// Devices are ordered here anyway.
#[cfg(target_os = "linux")]
fn leave_out_device_select() {
    use std::os::unix::process::CommandExt as _;
    let is_path =
        |name| std::env::var_os(name).is_some_and(|path| path.as_encoded_bytes().starts_with(b"/"));
    let is_chosen = |name| std::env::var_os(name).is_some();
    if is_path("XDG_RUNTIME_DIR")
        || is_path("WAYLAND_DISPLAY")
        || is_chosen("NODEVICE_SELECT")
        || is_chosen("MESA_VK_DEVICE_SELECT")
    {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        let mut again = std::process::Command::new(program);
        again.args(std::env::args_os().skip(1));
        // Returns only if it cannot: then the error is written, and nothing else is lost.
        let _ = again.env("NODEVICE_SELECT", "1").exec();
    }
}

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    leave_out_device_select();
    let cli = match cli::parse() {
        Ok(cli) => cli,
        Err(error) => match cli::mistyped_command(&error) {
            Some(sentence) => {
                eprintln!("error: {sentence}");
                return Exit::Usage.into();
            }
            None => error.exit(),
        },
    };
    match cli::run(&cli) {
        Ok(exit) => exit.into(),
        Err(error) => {
            cli::report_error(&cli, &error);
            error.exit.into()
        }
    }
}
