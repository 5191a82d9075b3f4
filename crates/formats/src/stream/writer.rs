//! Appends blocks of rows to a file and digests them on a thread of its own, so that the next rows need not wait for the disk.

use std::fs::File;
use std::io::{self, Write};
use std::mem;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, Builder, JoinHandle};

use super::partial::BLOCK;

/// Blocks that may wait for the thread, 8 MiB in all. Chosen, not measured.
const WAITING: usize = (8 << 20) / BLOCK;

/// Blocks after which the device is waited for, 128 MiB (chosen, not measured). A whole file left in the system's
/// memory would be waited for at the end, while nothing else is done.
const BLOCKS_PER_SYNC: usize = (128 << 20) / BLOCK;

/// A file that is appended to.
#[derive(Debug)]
pub(super) struct Writer {
    file: Arc<File>,
    /// The digest of the blocks that were appended before the thread started.
    digest: blake3::Hasher,
    appending: Option<Appending>,
}

/// The thread that appends.
#[derive(Debug)]
struct Appending {
    blocks: SyncSender<Vec<u8>>,
    /// Blocks to fill again.
    spare: Receiver<Vec<u8>>,
    thread: JoinHandle<(blake3::Hasher, io::Result<()>)>,
}

impl Writer {
    pub fn new(file: File) -> Self {
        Self {
            file: Arc::new(file),
            digest: blake3::Hasher::new(),
            appending: None,
        }
    }

    /// Takes the bytes of a block and leaves an empty one. An error may be that of an earlier block.
    pub fn append(&mut self, block: &mut Vec<u8>) -> io::Result<()> {
        let appending = match self.appending.take() {
            Some(appending) => appending,
            None => Appending::start(&self.file, &self.digest)?,
        };

        let empty =
            (appending.spare.try_recv()).unwrap_or_else(|_| Vec::with_capacity(block.capacity()));
        let sent = appending.blocks.send(mem::replace(block, empty));
        self.appending = Some(appending);

        match sent {
            Ok(()) => Ok(()),
            // The thread ended because of an error, which is returned here.
            Err(_) => (self.settle()).and(Err(io::Error::other("writing has ended"))),
        }
    }

    /// Waits until all blocks are in the file.
    fn settle(&mut self) -> io::Result<()> {
        let Some(Appending { blocks, thread, .. }) = self.appending.take() else {
            return Ok(());
        };
        drop(blocks);
        let (digest, written) = (thread.join())
            .map_err(|_| io::Error::other("the thread that writes to the file has failed"))?;
        self.digest = digest;
        written
    }

    /// The file with all blocks in it, at their end.
    pub fn file(&mut self) -> io::Result<&File> {
        self.settle()?;
        Ok(&self.file)
    }

    /// The digest of all blocks.
    pub fn digest(&mut self) -> io::Result<&mut blake3::Hasher> {
        self.settle()?;
        Ok(&mut self.digest)
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // The file of a dropped writer is not used.
        let _ = self.settle();
    }
}

impl Appending {
    /// Starts the thread that appends blocks to the file.
    fn start(file: &Arc<File>, digest: &blake3::Hasher) -> io::Result<Self> {
        let (blocks, incoming) = sync_channel::<Vec<u8>>(WAITING);
        let (emptied, spare) = channel();
        // The digest goes on from the bytes that were appended before the thread started.
        let (file, mut digest) = (Arc::clone(file), digest.clone());
        let name = "writing a file".to_owned();
        let thread = Builder::new().name(name).spawn(move || {
            let written = append_all(&file, &incoming, &emptied, &mut digest);
            (digest, written)
        })?;
        Ok(Self {
            blocks,
            spare,
            thread,
        })
    }
}

/// Writes and digests blocks. A second thread waits for the device, so that writing goes on meanwhile. It does not wait
/// for the last blocks: the owner of the file does that itself, when it has written the head.
fn append_all(
    mut file: &File,
    incoming: &Receiver<Vec<u8>>,
    emptied: &Sender<Vec<u8>>,
    digest: &mut blake3::Hasher,
) -> io::Result<()> {
    thread::scope(|scope| {
        // One request for the device may wait. With the next one this thread waits, too, so that no more is left in memory.
        let (due, syncs) = sync_channel(1);
        let syncing = Builder::new()
            .name("waiting for the device".to_owned())
            .spawn_scoped(scope, move || {
                syncs.iter().try_for_each(|()| file.sync_data())
            })?;

        for (index, mut block) in incoming.iter().enumerate() {
            file.write_all(&block)?;
            digest.update(&block);
            block.clear();
            // The block goes back to be filled again. At the end there is no receiver any more, which is no error.
            let _ = emptied.send(block);

            if index % BLOCKS_PER_SYNC == BLOCKS_PER_SYNC - 1 && due.send(()).is_err() {
                // The other thread has ended with an error, which is returned below.
                break;
            }
        }

        // Without a sender the other thread ends.
        drop(due);
        let synced = syncing.join();
        synced.map_err(|_| io::Error::other("the thread that waits for the device has failed"))?
    })
}
