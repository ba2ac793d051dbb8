/// @file
/// An HDF5 file driver whose flushes are all or nothing. Internal to the module.
///
/// HDF5 writes its metadata in place: a process that is killed, or a disk that fills up, in the
/// middle of a flush leaves a file that nobody can read. This driver keeps everything in memory
/// between flushes. A flush then
///   1. writes new pages behind the end of the file, where nothing refers to them yet,
///   2. writes changed pages to a journal beside the file, with a checksum,
///   3. copies them from there to their places, and empties the journal.
/// All pages of the first flush go the way of the changed ones: a part of them would be no file.
/// Whoever is killed before 2 is complete leaves the file as it was at the last flush; afterwards
/// recover() finishes 3. The journal exists while the file is open for writing and is locked, so
/// that two writers exclude each other.
#pragma once

#include <cstdint>
#include <string>

namespace gotai::recording {

/// Path of the journal that belongs to a file.
std::string journal_path(const std::string& path);

/// Finishes an interrupted flush, when there is one, and removes the journal of a dead writer.
/// @returns whether another process has the file open for writing
/// @throws FileError when the journal cannot be read or applied
bool recover(const std::string& path);

/// A file access property list (hid_t) that selects the driver. Close it with H5Pclose.
std::int64_t make_transaction_access();

/// What went wrong in the last failed operation of the driver ("No space left on device"), or "".
/// After a failed flush the driver drops all further writes: the file stays as it was.
const std::string& transaction_failure();

/// While one lives, flushes of this thread commit nothing: what was written waits for the next one.
class HeldFlushes {
 public:
  HeldFlushes();
  ~HeldFlushes();
  HeldFlushes(const HeldFlushes&) = delete;
  HeldFlushes& operator=(const HeldFlushes&) = delete;
};

}  // namespace gotai::recording
