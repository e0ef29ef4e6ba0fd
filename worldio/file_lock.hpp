#pragma once

namespace troupe::worldio {

/// The result of lock_file():
/// - taken: the file is locked
/// - held: another open file description, usually of another process, has the lock
/// - unavailable: the file system has no locks. Some network file systems, such as Lustre, have none unless
///   they are mounted with an option for them
enum class FileLock : char { taken, held, unavailable };

/// Tries to lock an open file exclusively (flock), without waiting for other locks. The lock lasts until all
/// descriptors of the open file description are closed. descriptor: a valid file descriptor
FileLock lock_file(int descriptor);

}  // namespace troupe::worldio
