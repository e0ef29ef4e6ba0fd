#pragma once

#include "partition/transport.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace troupe::partition {

/// The transport between the processes that an MPI launcher has started (docs/cluster.md). Each process is a
/// rank. Troupe itself is not linked with MPI: this class loads a module at run time, which is a shared
/// library that is linked with MPI (partition/mpi/mpi_module.h). After send(), receive() or
/// complete_sending() has thrown RankError (another rank or MPI has failed), later calls of these functions
/// throw an error with the same text.
class MpiTransport : public Transport {
 public:
  /// Loads the module and initialises MPI. module: path of the shared library. Throws std::runtime_error if
  /// the module cannot be loaded, belongs to another version of Troupe, or cannot initialise MPI.
  explicit MpiTransport(const std::filesystem::path& module);
  /// Does not finalise MPI; only finish() does. Finalising may wait for the other processes, and a process
  /// that has failed must be able to end without them.
  ~MpiTransport() override;

  unsigned rank() const override;
  unsigned ranks() const override;
  /// Waits for a message; other processes may use the processor meanwhile. If no message has come after the
  /// time that set_limit() has set, throws a RankError that names the rank that did not answer: its number
  /// and, if set_hosts() was called, its host. Also throws RankError if MPI fails.
  std::shared_ptr<const Message> receive(unsigned from) override;
  double seconds() const override;
  double waited_s() const override;

  const std::string& library() const;  ///< name and version of the MPI library
  /// Sets the longest time that receive() and complete_sending() wait, s, wall time. Before the first call
  /// there is no limit.
  void set_limit(double seconds);
  /// Sets the names of the hosts of all ranks, indexed by rank, for the texts of errors.
  void set_hosts(std::vector<std::string> hosts);
  /// Waits until MPI has finished sending all messages of this rank. Throws RankError as receive() does.
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
