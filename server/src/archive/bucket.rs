//! Object storage: a bucket with the protocol of S3. Keys and endpoint are set in the environment.

use crate::error::LabError;
use object_store::ObjectStore;

#[cfg(feature = "s3")]
pub fn open(address: &str) -> Result<Box<dyn ObjectStore>, LabError> {
    use super::fault::unavailable;
    use object_store::aws::{AmazonS3Builder, S3CopyIfNotExists};
    use object_store::{RetryConfig, prefix::PrefixStore};
    use std::time::Duration;

    // The daemon repeats failed attempts: a person soon sees the error.
    let retry = RetryConfig { max_retries: 2, retry_timeout: Duration::from_secs(30), ..RetryConfig::default() };
    let (bucket, prefix) = address.split_once('/').unwrap_or((address, ""));
    let builder = AmazonS3Builder::from_env().with_bucket_name(bucket).with_retry(retry);
    let bucket = builder.with_copy_if_not_exists(S3CopyIfNotExists::Multipart).build();
    let bucket = bucket.map_err(|fault| unavailable(&format!("s3://{address}"), &fault))?;
    Ok(Box::new(PrefixStore::new(bucket, prefix)))
}

/// Files of a store that another build has archived.
#[cfg(not(feature = "s3"))]
pub fn open(address: &str) -> Result<Box<dyn ObjectStore>, LabError> {
    Err(LabError::Busy(format!("the archive s3://{address} is not available: {}", crate::config::NO_S3)))
}
