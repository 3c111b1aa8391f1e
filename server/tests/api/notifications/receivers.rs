//! Receivers of notifications on loopback ports: HTTP, SMTP and MQTT. Each runs until its test ends.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(60);

/// What a receiver got, oldest first.
pub struct Receiver<T> {
    pub address: SocketAddr,
    received: Arc<Mutex<Vec<T>>>,
}

impl<T: Clone + Send + 'static> Receiver<T> {
    /// Serves one connection at a time. `serve` returns what it got.
    fn start(mut serve: impl FnMut(TcpStream) -> std::io::Result<Option<T>> + Send + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let received = Arc::<Mutex<Vec<T>>>::default();
        let kept = received.clone();
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                // A client that closes its connection early sends nothing.
                kept.lock().unwrap().extend(serve(stream).ok().flatten());
            }
        });
        Self { address, received }
    }

    /// Waits for `count` of them.
    pub fn wait_for(&self, count: usize) -> Vec<T> {
        let began = Instant::now();
        loop {
            let received = self.received();
            if received.len() >= count {
                return received;
            }
            assert!(began.elapsed() < PATIENCE, "{} of {count} messages", received.len());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub fn received(&self) -> Vec<T> {
        self.received.lock().unwrap().clone()
    }
}

/// A request to a webhook.
#[derive(Clone, Debug)]
pub struct Hook {
    /// Request line and fields.
    pub head: Vec<String>,
    pub body: String,
}

impl Hook {
    pub fn header(&self, name: &str) -> Option<&str> {
        let found =
            self.head.iter().find_map(|line| line.split_once(": ").filter(|(key, _)| key.eq_ignore_ascii_case(name)));
        found.map(|(_, value)| value)
    }
}

/// Answers the first requests with these states, the others with 200.
pub fn webhook(states: &'static [u16]) -> Receiver<Hook> {
    let mut states = states.iter();
    Receiver::start(move |mut stream| {
        let mut reader = BufReader::new(stream.try_clone()?);
        let head: Vec<String> =
            reader.by_ref().lines().map_while(Result::ok).take_while(|line| !line.is_empty()).collect();
        let mut hook = Hook { head, body: String::new() };
        let length = hook.header("content-length").and_then(|length| length.parse().ok()).unwrap_or(0);
        let mut body = vec![0; length];
        reader.read_exact(&mut body)?;
        hook.body = String::from_utf8(body).unwrap();
        let state = states.next().unwrap_or(&200);
        write!(stream, "HTTP/1.1 {state} Status\r\ncontent-length: 0\r\nconnection: close\r\n\r\n")?;
        Ok(Some(hook))
    })
}

/// The text of each mail, with its header.
pub fn mail_server() -> Receiver<String> {
    Receiver::start(|mut stream| {
        let reader = BufReader::new(stream.try_clone()?);
        let mut mail = None;
        write!(stream, "220 sink\r\n")?;
        for line in reader.lines() {
            let line = line?;
            let text: &mut Option<String> = &mut mail;
            match (text.as_mut().filter(|text| !text.ends_with("\n.\n")), line.as_str()) {
                (Some(text), line) => {
                    text.push_str(&format!("{line}\n"));
                    if line == "." {
                        write!(stream, "250 kept\r\n")?;
                    }
                }
                (None, "DATA") => {
                    mail = Some(String::new());
                    write!(stream, "354 go\r\n")?;
                }
                (None, "QUIT") => {
                    write!(stream, "221 bye\r\n")?;
                    break;
                }
                (None, _) => write!(stream, "250 sink\r\n")?,
            }
        }
        Ok(mail)
    })
}

/// A broker of MQTT 3.1.1 that acknowledges messages of QoS 1: topic and payload of each.
pub fn broker() -> Receiver<(String, String)> {
    const CONNECT: u8 = 0x10;
    const PUBLISH_QOS_1: u8 = 0x32;
    Receiver::start(|mut stream| {
        let mut message = None;
        loop {
            let Ok((kind, body)) = packet(&mut stream) else { return Ok(message) };
            match kind {
                CONNECT => stream.write_all(&[0x20, 2, 0, 0])?,
                PUBLISH_QOS_1 => {
                    let end = 2 + usize::from(u16::from_be_bytes([body[0], body[1]]));
                    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
                    message = Some((text(&body[2..end]), text(&body[end + 2..])));
                    stream.write_all(&[0x40, 2, body[end], body[end + 1]])?;
                }
                _ => {}
            }
        }
    })
}

/// First byte and content of a packet.
fn packet(stream: &mut TcpStream) -> std::io::Result<(u8, Vec<u8>)> {
    let mut byte = [0];
    stream.read_exact(&mut byte)?;
    let kind = byte[0];
    let mut length = 0;
    for shift in (0..).step_by(7) {
        stream.read_exact(&mut byte)?;
        length |= usize::from(byte[0] & 0x7F) << shift;
        if byte[0] & 0x80 == 0 {
            break;
        }
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    Ok((kind, body))
}
