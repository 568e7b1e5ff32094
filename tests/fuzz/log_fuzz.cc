// Whatever bytes a log file holds: the reader ends, gives only what is there, in order, and counts the rest as skipped.
#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "core/util/big_endian.h"
#include "tests/fuzz/fuzz.h"
#include "wire/log/checked_log.h"
#include "wire/log/log_reader.h"

namespace lab::fuzz {
std::vector<std::vector<uint8_t>> seeds() {
  std::vector<std::vector<uint8_t>> all(2);
  for (uint64_t number = 0; number < 5; ++number) {
    const std::string channel = number % 2 ? "A" : "ROBOT_STATE";
    std::vector<uint8_t>& log = all[1];
    append_big_endian(log, uint32_t{0xEDA1DA01});
    append_big_endian(log, number);
    append_big_endian(log, 1000 * number);
    append_big_endian(log, static_cast<uint32_t>(channel.size()));
    append_big_endian(log, static_cast<uint32_t>(7 * number));
    log.insert(log.end(), channel.begin(), channel.end());
    log.resize(log.size() + 7 * number, 0xED);
  }
  return all;
}

}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace lab;
  const int file = memfd_create("log", 0);
  fuzz::demand(file >= 0 && write(file, bytes, size) == static_cast<ssize_t>(size), "no memory file");
  {
    LogReader reader("/proc/self/fd/" + std::to_string(file));
    uint64_t end = 0, given = 0, skipped = 0;
    for (LogEvent event; reader.next(event);) {
      fuzz::demand(event.offset >= end && event.bytes.size() == 28 + event.channel.size() + event.data.size(),
                   "an event out of order, or of another size");
      end = event.offset + event.bytes.size(), given += event.bytes.size();
      fuzz::demand(end <= size, "an event beyond the end");
      fuzz::demand(std::equal(event.data.begin(), event.data.end(), bytes + end - event.data.size()),
                   "other bytes than in the file");
    }
    for (const auto& gap : reader.skipped()) skipped += gap.bytes;
    fuzz::demand(given + skipped + reader.tail() == size, "bytes that are neither given, skipped nor left");
    const LogFindings found =
        read_checked("/proc/self/fd/" + std::to_string(file), [](Channel, std::span<const uint8_t>) {});
    fuzz::demand(!found.complete() || found.run != 0, "a log without RUN is taken for a whole one");
  }
  close(file);
  return 0;
}
