//! Every cycle to a file, without blocking the loop: a bounded queue and a writer
//! thread. A full queue drops the cycle and counts it.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use bridge::protocol::Report;
use bridge::session::CycleReport;
use record::csv::Row;
use record::session::channels;

/// Cycles that fit into the queue: 8 s at 2 ms.
const QUEUE: usize = 4096;

/// The loop's end of the queue, and the thread behind it; robots say `R` of themselves.
#[derive(Debug)]
pub struct Recorder<R> {
    queue: Option<SyncSender<CycleReport<R>>>,
    writer: Option<JoinHandle<io::Result<()>>>,
    dropped: u64,
}

impl<R: Report + Send + 'static> Recorder<R> {
    /// Waits for cycles. The file at `path` is made with the first of them: a robot
    /// that never comes leaves an older record as it is.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn create(path: &Path) -> io::Result<Self> {
        let path = path.to_path_buf();
        let (queue, cycles) = sync_channel(QUEUE);
        let writer = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || write_all(&path, &cycles))?;
        Ok(Self {
            queue: Some(queue),
            writer: Some(writer),
            dropped: 0,
        })
    }

    /// Hands over a cycle; never waits.
    pub fn push(&mut self, cycle: &CycleReport<R>) {
        let full = (self.queue.as_ref()).is_none_or(|queue| queue.try_send(*cycle).is_err());
        self.dropped += u64::from(full);
    }

    /// Waits until everything is written. Returns the number of cycles dropped.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(mut self) -> io::Result<u64> {
        // Closing the queue ends the thread.
        self.queue = None;
        let result = self.writer.take().map(JoinHandle::join);
        match result {
            Some(Ok(written)) => written.map(|()| self.dropped),
            _ => Err(io::Error::other("the recorder's thread ended early")),
        }
    }
}

fn write_all<R: Report>(path: &Path, cycles: &Receiver<CycleReport<R>>) -> io::Result<()> {
    let Ok(first) = cycles.recv() else {
        return Ok(());
    };
    let mut file = BufWriter::new(File::create(path)?);
    write_rows(&mut file, std::iter::once(first).chain(cycles))?;
    file.flush()
}

/// Writes a header, and a row per cycle.
///
/// # Errors
/// Those of the writer.
pub fn write_rows<R: Report>(
    out: &mut impl Write,
    cycles: impl Iterator<Item = CycleReport<R>>,
) -> io::Result<()> {
    let channels = channels();
    let mut row = Row::default();
    row.names(&channels, 0, &[]);
    row.finish(out)?;
    for cycle in cycles {
        row.values(&channels, &cycle);
        row.finish(out)?;
    }
    Ok(())
}
