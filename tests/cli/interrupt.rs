//! Stopping a run, and readers that stop listening.

use std::{io::Read, process::Stdio, time::Duration};

use super::Place;

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing() {
    let place = Place::new();
    // A stage of thousands of draws on a large map: minutes, unless stopped.
    let arguments = ["grow", "rmp-peak", "--size", "3000", "--set", "rmp_peak.iterations=5000", "--out", "w"];
    let mut child = place.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    // Wait until the run has begun, which the folder beside shows.
    while place.files().is_empty() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be stopped");
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let status = child.wait().unwrap();
    let mut err = String::new();
    child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
    assert_eq!(status.code(), Some(130), "{err}");
    assert_eq!(err.lines().last(), Some("stopped; nothing was written"));
    assert!(place.files().is_empty(), "{:?}", place.files());
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let place = Place::new();
    let mut child =
        place.command(&["params", "--markdown"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}
