//! The lower bound: blocking reads and writes on a pseudo-terminal, without deadline, checksum or parsing.

use rustix::fd::OwnedFd;
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};

const REPLY: &[u8] = b"1.077135 1.482737*42\r\n";

/// Answers every chunk with the same line. Runs until the process ends: its reads never fail while the slave is open.
pub fn responder() -> (String, OwnedFd) {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let slave = rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
    let mut attributes = tcgetattr(&slave).unwrap();
    attributes.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &attributes).unwrap();
    std::thread::spawn(move || {
        let mut master = File::from(master);
        let mut chunk = [0; 256];
        while let Ok(1..) = master.read(&mut chunk) {
            master.write_all(REPLY).unwrap();
        }
    });
    (path, slave)
}

pub struct Port(File);

impl Port {
    pub fn open(path: &str) -> io::Result<Self> {
        OpenOptions::new().read(true).write(true).open(path).map(Self)
    }

    pub fn exchange(&mut self) -> io::Result<usize> {
        self.0.write_all(b"f 0*118\n")?;
        self.0.read(&mut [0; 256])
    }
}
