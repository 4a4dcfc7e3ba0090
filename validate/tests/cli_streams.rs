//! The command among others: closed pipes, full disks, no terminal, Ctrl-C, other folders.

#![cfg(unix)]

mod command;

use command::{Folder, TRIANGLE};
use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::process::Stdio;

const RUN: &str = "run --scenes ./tiny.json --resolution 8 --repeats 1";

/// `dacrt run | head -1` gets its line, and the result file is written all the same.
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::new();
    for line in [
        &format!("{RUN} --out out.json"),
        "scenes",
        "env",
        "run --help",
    ] {
        let mut child = (folder
            .command(line)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped()))
        .spawn()
        .unwrap();
        let mut first = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut first)
            .unwrap();
        assert!(!first.is_empty());
        let output = child.wait_with_output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            (output.status.code(), error.as_str()),
            (Some(0), ""),
            "{line}"
        );
    }
    assert_eq!(
        folder.json("out.json")["cells"].as_array().unwrap().len(),
        5 + 5 + 4
    );
}

/// Once a panic: `eprintln!` does if nobody takes its words.
#[test]
fn standard_error_that_takes_nothing_is_no_panic() {
    let folder = Folder::new();
    // The warnings of scenes left out, and an error.
    let warns = "run --resolution 4 --repeats 1 --rays primary --meshes nowhere --out out.json";
    for (line, code) in [(warns, 0), ("run --scenes hal", 2)] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = folder.command(line).stderr(writer).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full() {
    let folder = Folder::new();
    for line in ["scenes", "env", &format!("{RUN} --out out.json")] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = folder.command(line).stdout(full).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {error}");
        assert!(
            error.contains("standard output: No space left"),
            "{line}: {error}"
        );
    }
}

#[test]
fn there_is_no_progress_bar_without_a_terminal() {
    let folder = Folder::new();
    let run = folder.dacrt(&format!("{RUN} --out out.json"));
    assert_eq!(run.exits(0).stderr(), "");
    assert!(!run.stdout().contains('\x1b'));
}

/// Ctrl-C in the middle leaves a whole file with what was finished, and nothing beside it.
#[test]
fn an_interrupted_run_leaves_a_whole_file() {
    let folder = Folder::new();
    let line = "run --scenes ./tiny.json --resolution 64 --repeats 1000 --out out.json \
                --rays primary,random,diffuse-1,diffuse-2,diffuse-3,diffuse-4,diffuse-5";
    let mut command = folder.command(line);
    // Tests that run in the background of a script have been told to ignore it, and so would the child.
    let heed = || {
        // SAFETY: the default action needs no handler.
        unsafe { libc::signal(libc::SIGINT, libc::SIG_DFL) };
        Ok(())
    };
    // SAFETY: signal may be called between fork and exec.
    unsafe { command.pre_exec(heed) };
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    // The first batch is in the table, so it is in the file.
    assert!(lines.any(|line| line.unwrap().starts_with("tiny ")));
    let id = child.id().try_into().unwrap();
    // SAFETY: a signal to a child that was not waited for, so its number is not another's.
    assert_eq!(unsafe { libc::kill(id, libc::SIGINT) }, 0);
    assert!(!child.wait().unwrap().success());
    let count = |document: serde_json::Value| document["cells"].as_array().unwrap().len();
    let finished = count(folder.json("out.json"));
    assert!((4..4 + 6 * 3).contains(&finished), "{finished}");
    // The file, the scene of every test, and nothing else: no temporary file.
    assert_eq!(std::fs::read_dir(folder.path("")).unwrap().count(), 2);
}

#[test]
fn paths_are_those_of_the_caller() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    std::fs::create_dir(folder.path("inner")).unwrap();
    let mesh = "\"file\": \"m.obj\"";
    let generator = "\"generator\": \"soup\", \"triangles\": 500, \"seed\": 1";
    folder.write("inner/mesh.json", command::SCENE.replace(generator, mesh));
    let line = "run --scenes ./mesh.json --meshes .. --resolution 4 --repeats 1 --out ../out.json";
    let run = folder
        .command(line)
        .current_dir(folder.path("inner"))
        .output()
        .unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    assert_eq!(folder.json("out.json")["cells"][0]["triangles"], 1);
}
