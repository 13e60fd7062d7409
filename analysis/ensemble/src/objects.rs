//! Chunks in an object store, by its address.

use bytes::Bytes;
use futures_util::TryStreamExt as _;
use object_store::path::Path;
use object_store::{ObjectStore, ObjectStoreExt as _, parse_url_opts};
use tokio::runtime::{Builder, Runtime};
use url::Url;

use crate::store::{Store, StoreError, check};

/// Objects below a prefix of an object store with atomic writes.
#[derive(Debug)]
pub struct Objects {
    store: Box<dyn ObjectStore>,
    prefix: Path,
    runtime: Runtime,
}

impl Objects {
    /// The objects below an address such as `s3://bucket/study`. Keys and regions come from the environment. Features of
    /// the crate `object_store` enable further schemes; `file` is always available.
    pub fn at(address: &str) -> Result<Self, StoreError> {
        let told =
            |cause: Box<dyn std::error::Error + Send + Sync>| StoreError::new(address, cause);
        let url = Url::parse(address).map_err(|cause| told(cause.into()))?;
        let found = parse_url_opts(&url, std::env::vars());
        let (store, prefix) = found.map_err(|cause| told(cause.into()))?;
        Self::new(store, prefix).map_err(|cause| told(cause.into()))
    }

    /// The objects below a prefix of a store.
    pub fn new(store: Box<dyn ObjectStore>, prefix: Path) -> std::io::Result<Self> {
        Ok(Self {
            store,
            prefix,
            runtime: Builder::new_current_thread().enable_all().build()?,
        })
    }

    fn place(&self, name: &str) -> Path {
        self.prefix.clone().join(name)
    }

    fn error(&self, name: &str, cause: object_store::Error) -> StoreError {
        StoreError::new(self.place(name).to_string(), cause)
    }
}

impl Store for Objects {
    fn names(&self) -> Result<Vec<String>, StoreError> {
        let listed = self.store.list(Some(&self.prefix)).try_collect::<Vec<_>>();
        let objects = self.runtime.block_on(listed);
        let objects = objects.map_err(|cause| self.error("", cause))?;
        let mut names: Vec<String> = objects
            .iter()
            .filter_map(|object| object.location.filename().map(str::to_owned))
            .collect();
        names.sort();
        Ok(names)
    }

    fn read(&self, name: &str) -> Result<Bytes, StoreError> {
        let place = self.place(name);
        let read = async { self.store.get(&place).await?.bytes().await };
        let read = self.runtime.block_on(read);
        read.map_err(|cause| self.error(name, cause))
    }

    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<(), StoreError> {
        check(name)?;
        let place = self.place(name);
        let written = self.runtime.block_on(self.store.put(&place, bytes.into()));
        written.map(|_| ()).map_err(|cause| self.error(name, cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_come_back_as_they_were_written() {
        let store = Box::new(object_store::memory::InMemory::new());
        let objects = Objects::new(store, Path::from("studies/one")).expect("a runtime");
        assert_eq!(objects.names().expect("names"), [""; 0]);
        objects.write("b.parquet", vec![1, 2]).expect("written");
        objects.write("a.parquet", vec![3]).expect("written");
        objects.write("a.parquet", vec![4]).expect("replaced");
        assert_eq!(objects.names().expect("names"), ["a.parquet", "b.parquet"]);
        assert_eq!(objects.read("a.parquet").expect("read"), vec![4]);
        assert!(objects.read("c.parquet").is_err());
    }
}
