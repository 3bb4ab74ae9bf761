//! Numbers that come row by row and are wanted column by column, most of them on the medium.

use std::io::{self, Read, Seek, SeekFrom, Write};

/// Rows of a page: what is held in memory.
const PAGE: usize = 128;
/// Bytes of one column of a page.
const STRIP: usize = 8 * PAGE;

/// A table of words of 64 bits.
///
/// A page holds its columns one after another, so that a column is read back from it in one piece.
#[derive(Debug)]
pub(super) struct Spool<F> {
    file: F,
    columns: usize,
    /// The last page, of which `rows` rows are filled.
    page: Vec<u8>,
    rows: usize,
    /// Pages in the file.
    full: usize,
}

impl<F: Read + Write + Seek> Spool<F> {
    /// An empty table; `file` is empty and nobody else's.
    pub fn new(file: F, columns: usize) -> Self {
        Self { file, columns, page: vec![0; columns * STRIP], rows: 0, full: 0 }
    }

    /// Rows in the table.
    pub fn rows(&self) -> usize {
        self.full * PAGE + self.rows
    }

    /// Adds a row, one word for each column; words beyond the last column are ignored.
    ///
    /// # Errors
    /// Where the file cannot be written; the table must then be given up.
    pub fn push(&mut self, row: impl IntoIterator<Item = u64>) -> io::Result<()> {
        for (strip, word) in self.page.chunks_exact_mut(STRIP).zip(row) {
            strip[8 * self.rows..][..8].copy_from_slice(&word.to_le_bytes());
        }
        self.rows += 1;
        if self.rows == PAGE {
            self.file.seek(SeekFrom::Start((self.full * self.page.len()) as u64))?;
            self.file.write_all(&self.page)?;
            (self.full, self.rows) = (self.full + 1, 0);
        }
        Ok(())
    }

    /// Shows the words of a column from the first row to the last, in pieces.
    ///
    /// # Errors
    /// Where the file cannot be read, and what `see` returns.
    pub fn column<E: From<io::Error>>(
        &mut self,
        column: usize,
        mut see: impl FnMut(&[u64]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut bytes = [0; STRIP];
        let mut words = Vec::with_capacity(PAGE);
        for page in 0..=self.full {
            let strip = if page < self.full {
                let at = (page * self.columns + column) * STRIP;
                self.file.seek(SeekFrom::Start(at as u64))?;
                self.file.read_exact(&mut bytes)?;
                &bytes[..]
            } else {
                &self.page[column * STRIP..][..8 * self.rows]
            };
            words.clear();
            words.extend(strip.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word)));
            if !words.is_empty() {
                see(&words)?;
            }
        }
        Ok(())
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        (self.rows, self.full) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn read(spool: &mut Spool<Cursor<Vec<u8>>>, column: usize) -> Vec<u64> {
        let mut all = Vec::new();
        let seen = spool.column(column, |words| -> io::Result<()> {
            all.extend(words);
            Ok(())
        });
        seen.expect("in memory");
        all
    }

    #[test]
    fn columns_come_back_whole_around_the_ends_of_pages() {
        let mut spool = Spool::new(Cursor::new(Vec::new()), 3);
        // The second time what the first has left must not show.
        for (salt, rows) in [(0, 2 * PAGE + 7), (1 << 60, PAGE), (2 << 60, PAGE - 1), (3 << 60, 0)]
        {
            let word = |row: usize, column: usize| salt + (row * 10 + column) as u64;
            for row in 0..rows {
                spool.push((0..3).map(|column| word(row, column))).expect("in memory");
            }
            assert_eq!(spool.rows(), rows);
            for column in 0..3 {
                let wanted: Vec<u64> = (0..rows).map(|row| word(row, column)).collect();
                assert_eq!(read(&mut spool, column), wanted);
            }
            spool.clear();
        }
    }

    #[test]
    fn memory_is_that_of_a_page() {
        let mut spool = Spool::new(Cursor::new(Vec::new()), 2);
        for row in 0..10 * PAGE as u64 {
            spool.push([row, row]).expect("in memory");
        }
        assert_eq!(spool.page.len(), 2 * STRIP);
        assert_eq!(spool.file.get_ref().len(), 20 * STRIP);
    }
}
