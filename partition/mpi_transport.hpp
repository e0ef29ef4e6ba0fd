#pragma once

#include "partition/transport.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace troupe::partition {

/// The transport between the processes that an MPI launcher has started (docs/cluster.md). The MPI library is
/// loaded with a module at run time (partition/mpi/mpi_module.h). After a RankError, this rank neither sends
/// nor receives: later calls throw the same error.
class MpiTransport : public Transport {
 public:
  /// Loads the module and initialises MPI. Throws std::runtime_error if that is not possible. The text says
  /// why.
  explicit MpiTransport(const std::filesystem::path& module);
  /// Does not finalise MPI, which only finish() does: a process that has failed must be able to end without
  /// waiting for the others.
  ~MpiTransport() override;

  unsigned rank() const override;
  unsigned ranks() const override;
  /// Waits for a message; other processes may use the processor meanwhile. If no message has come after the
  /// time that set_limit() has set, throws RankError with the number and the host of the rank that did not
  /// answer.
  std::shared_ptr<const Message> receive(unsigned from) override;
  double seconds() const override;
  double waited_s() const override;

  const std::string& library() const;  ///< name and version of the MPI library
  /// Sets the longest time that receive() and complete_sending() wait, s. Before the first call there is no
  /// limit.
  void set_limit(double seconds);
  /// Sets the names of the hosts of all ranks, indexed by rank, for the texts of errors.
  void set_hosts(std::vector<std::string> hosts);
  /// Waits until MPI has finished sending all messages of this rank.
  void complete_sending();
  /// Finalises MPI. All ranks must call this, each after complete_sending(). Afterwards no other function may
  /// be called.
  void finish();

 private:
  void post(unsigned to, std::shared_ptr<const Message> message) override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
