//! TLS, with certificate and key files that can be replaced while the daemon runs.

use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, SystemTime};
use tokio::net::TcpStream;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::rustls::{self, ServerConfig};
use tokio_rustls::server::TlsStream;

/// Interval of the check for changed files.
const POLL_INTERVAL: Duration = Duration::from_secs(60);

/// PEM files: the certificate with its intermediate certificates, and its key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TlsFiles {
    pub certificate: PathBuf,
    pub key: PathBuf,
}

/// TLS configuration of the daemon. Cheap to clone.
#[derive(Clone)]
pub struct Tls {
    files: TlsFiles,
    now: Arc<RwLock<Loaded>>,
}

struct Loaded {
    config: Arc<ServerConfig>,
    written: Written,
}

/// Modification times of the files, if known.
type Written = [Option<SystemTime>; 2];

impl Tls {
    /// Reads the files; an error names the file and the problem.
    pub fn open(files: TlsFiles) -> Result<Self, String> {
        let loaded = load(&files)?;
        Ok(Self { files, now: Arc::new(RwLock::new(loaded)) })
    }

    pub async fn accept(&self, stream: TcpStream) -> std::io::Result<TlsStream<TcpStream>> {
        let config = self.now.read().unwrap_or_else(PoisonError::into_inner).config.clone();
        TlsAcceptor::from(config).accept(stream).await
    }

    /// Loads replaced files for new connections, until it is dropped.
    pub async fn follow(&self) {
        loop {
            tokio::time::sleep(POLL_INTERVAL).await;
            self.reload_if_changed();
        }
    }

    fn reload_if_changed(&self) {
        let before = self.now.read().unwrap_or_else(PoisonError::into_inner).written;
        if written(&self.files) == before {
            return;
        }
        match load(&self.files) {
            Ok(loaded) => {
                *self.now.write().unwrap_or_else(PoisonError::into_inner) = loaded;
                tracing::info!(certificate = %self.files.certificate.display(), "new certificate loaded");
            }
            // Certificate and key are rarely replaced at the same time: the next check may find a pair.
            Err(fault) => tracing::warn!(fault, "the new certificate is not used; the old one still is"),
        }
    }
}

fn load(files: &TlsFiles) -> Result<Loaded, String> {
    let written = written(files);
    let unreadable =
        |path: &Path, what: &str, fault: String| format!("{}: contains no {what} ({fault})", path.display());
    let chain: Result<Vec<_>, _> =
        CertificateDer::pem_file_iter(&files.certificate).and_then(|certificates| certificates.collect());
    let chain = chain.map_err(|fault| unreadable(&files.certificate, "PEM certificate", fault.to_string()))?;
    if chain.is_empty() {
        return Err(unreadable(&files.certificate, "PEM certificate", "it has none".into()));
    }
    let key = PrivateKeyDer::from_pem_file(&files.key)
        .map_err(|fault| unreadable(&files.key, "PEM private key", fault.to_string()))?;
    let unusable = |fault: rustls::Error| {
        format!("{} and {} cannot be used together ({fault})", files.certificate.display(), files.key.display())
    };
    let mut config = ServerConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_safe_default_protocol_versions()
        .and_then(|builder| builder.with_no_client_auth().with_single_cert(chain, key))
        .map_err(unusable)?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(Loaded { config: Arc::new(config), written })
}

fn written(files: &TlsFiles) -> Written {
    [&files.certificate, &files.key].map(|file| file.metadata().and_then(|file| file.modified()).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(files: &TlsFiles, name: &str) {
        let made = rcgen::generate_simple_self_signed([name.to_owned()]).unwrap();
        std::fs::write(&files.certificate, made.cert.pem()).unwrap();
        std::fs::write(&files.key, made.signing_key.serialize_pem()).unwrap();
    }

    #[test]
    fn exchanged_files_are_taken_and_broken_ones_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let files = TlsFiles { certificate: folder.path().join("cert.pem"), key: folder.path().join("key.pem") };
        write(&files, "first.lab");
        let tls = Tls::open(files.clone()).unwrap();
        let config = || tls.now.read().unwrap().config.clone();
        let first = config();
        tls.reload_if_changed();
        assert!(Arc::ptr_eq(&first, &config()), "nothing has changed");
        let later = |file: &Path| {
            let file = std::fs::File::options().append(true).open(file).unwrap();
            file.set_modified(SystemTime::now() + Duration::from_secs(5)).unwrap();
        };
        std::fs::write(&files.key, "no key").unwrap();
        later(&files.key);
        tls.reload_if_changed();
        assert!(Arc::ptr_eq(&first, &config()), "the old one is still used");
        write(&files, "second.lab");
        later(&files.certificate);
        tls.reload_if_changed();
        assert!(!Arc::ptr_eq(&first, &config()));
    }

    #[test]
    fn a_file_that_cannot_be_used_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let files = TlsFiles { certificate: folder.path().join("cert.pem"), key: folder.path().join("key.pem") };
        write(&files, "bench.lab");
        let other = TlsFiles { key: files.certificate.clone(), ..files.clone() };
        assert!(Tls::open(other).err().unwrap().contains("no PEM private key"));
        let other = TlsFiles { certificate: files.key.clone(), ..files.clone() };
        assert!(Tls::open(other).err().unwrap().contains("no PEM certificate"));
        let mixed = TlsFiles { certificate: folder.path().join("other.pem"), ..files };
        let made = rcgen::generate_simple_self_signed(["other.lab".to_owned()]).unwrap();
        std::fs::write(&mixed.certificate, made.cert.pem()).unwrap();
        assert!(Tls::open(mixed).err().unwrap().contains("cannot be used together"));
    }
}
