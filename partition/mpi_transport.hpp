#pragma once

#include "partition/transport.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace troupe::partition {

/// The Transport between the processes that an MPI launcher has started (docs/cluster.md). Each process is a
/// rank: it computes a world together with the other processes. Troupe itself is not linked with MPI.
/// Instead, this class loads a module at run time: a shared library that is linked with MPI
/// (partition/mpi/mpi_module.h).
///
/// The functions send(), receive() and complete_sending() throw RankError if they find that another rank or
/// MPI has failed. After one of them has thrown RankError, later calls of all three throw RankError with the
/// same text.
class MpiTransport : public Transport {
 public:
  /// Loads the module and initialises MPI. module: path of the shared library. Throws std::runtime_error if
  /// the module cannot be loaded, belongs to another version of Troupe, or cannot initialise MPI.
  explicit MpiTransport(const std::filesystem::path& module);
  /// Does not finalise MPI, because that may wait for the other processes. A process that has failed must be
  /// able to end without them. Call finish() to finalise MPI.
  ~MpiTransport() override;

  unsigned rank() const override;
  unsigned ranks() const override;
  /// Waits for the next message from rank `from` and returns it. Other processes may use the processor
  /// meanwhile. If no message comes within the time that set_limit() has set, throws a RankError. Its text
  /// names the rank `from` and, if set_hosts() was called, the host of that rank. Also throws RankError if
  /// MPI fails.
  std::shared_ptr<const Message> receive(unsigned from) override;
  double seconds() const override;
  double waited_s() const override;

  const std::string& library() const;  ///< name and version of the MPI library
  /// Sets the longest time that receive() and complete_sending() wait, s, wall time. Before the first call
  /// there is no limit. Time in which this process is suspended does not count, except for up to 1 s.
  void set_limit(double seconds);
  /// Sets the names of the hosts of all ranks, indexed by rank, for the texts of errors.
  void set_hosts(std::vector<std::string> hosts);
  /// Waits until MPI has finished sending all messages of this rank. Throws RankError if this takes longer
  /// than the time that set_limit() has set, or if MPI fails.
  void complete_sending();
  /// Finalises MPI. All ranks must call this, each after complete_sending(). Afterwards no other function may
  /// be called. Throws RankError if MPI fails.
  void finish();

 private:
  void post(unsigned to, std::shared_ptr<const Message> message) override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
