// What the supervisor's own record, a file that only the lab's owner can write, says about an address on the bus.
#pragma once
#include <cstdint>
#include <string>

#include "wire/protocol/publishers.h"

namespace lab {

class LaunchRecord {
 public:
  /// `run_dir`: the run's folder, whose processes/state the supervisor writes; empty: no record.
  explicit LaunchRecord(std::string run_dir) : run_dir_(std::move(run_dir)) {}
  /// Whether the socket of `address` (as in Datagram::sender) belongs to the process `name`, or to a descendant of it. Reads
  /// some twenty small files of /proc.
  Claim check(const std::string& name, uint64_t address) const;

 private:
  std::string run_dir_;
};

}  // namespace lab
