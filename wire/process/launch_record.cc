#include "wire/process/launch_record.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

namespace lab {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxDescendants = 64;

/// The pid of the process as the host sees it; 0 while the supervisor does not know it; nothing when it has no such process.
std::optional<int> recorded_pid(const std::string& run_dir, const std::string& name) {
  std::ifstream state(run_dir + "/processes/state");
  if (!state) return 0;
  for (std::string line; std::getline(state, line);) {
    std::istringstream words(line);
    std::string key, of, status;
    int pid = 0;
    if (words >> key >> of >> status >> pid && key == "process" && of == name) return pid;
  }
  return std::nullopt;
}

/// The process and all that it has started, directly or not. Only the process where the kernel does not list children.
std::vector<int> with_descendants(int pid) {
  std::vector<int> all{pid};
  for (size_t i = 0; i < all.size() && all.size() < kMaxDescendants; ++i) {
    const std::string task = std::to_string(all[i]);
    std::ifstream children("/proc/" + task + "/task/" + task + "/children");
    for (int child = 0; children >> child;) all.push_back(child);
  }
  return all;
}

/// The inodes of the UDP sockets of this network with that port.
std::vector<std::string> sockets_of(uint16_t port) {
  std::vector<std::string> inodes;
  std::ifstream table("/proc/self/net/udp");
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    std::string slot, local, remote, state, queues, timer, retransmits, uid, timeout, inode;
    if (!(words >> slot >> local >> remote >> state >> queues >> timer >> retransmits >> uid >> timeout >>
          inode))
      continue;
    const size_t colon = local.find(':');
    unsigned value = 0;
    if (colon == std::string::npos ||
        std::from_chars(local.data() + colon + 1, local.data() + local.size(), value, 16).ec != std::errc())
      continue;
    if (value == port) inodes.push_back("socket:[" + inode + "]");
  }
  return inodes;
}

}  // namespace

Claim LaunchRecord::check(const std::string& name, uint64_t address) const {
  if (run_dir_.empty()) return Claim::Unknown;
  const auto pid = recorded_pid(run_dir_, name);
  if (!pid) return Claim::Unknown;
  if (*pid == 0) return Claim::Stranger;  // what the supervisor has not started cannot speak yet
  const std::vector<std::string> sockets = sockets_of(static_cast<uint16_t>(address));
  for (const int process : with_descendants(*pid)) {
    std::error_code error;
    const fs::directory_iterator files("/proc/" + std::to_string(process) + "/fd", error);
    if (error == std::errc::permission_denied) return Claim::Unknown;
    if (error) continue;
    for (const auto& file : files) {
      const std::string target = fs::read_symlink(file.path(), error).string();
      if (!error && std::find(sockets.begin(), sockets.end(), target) != sockets.end()) return Claim::Ours;
    }
  }
  return Claim::Stranger;
}

}  // namespace lab
