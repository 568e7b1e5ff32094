// Event logs: ours read by stock code and the other way round, damaged files, full disks.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/support/paths.h"
#include "wire/log/log_reader.h"
#include "wire/log/log_writer.h"

namespace lab {
namespace {

using Bytes = std::vector<uint8_t>;

struct Entry {
  int64_t utime;
  std::string channel;
  Bytes data;
  bool operator==(const Entry&) const = default;
};

class LogFiles : public testing::Test {
 protected:
  LogFiles() {
    std::filesystem::create_directories(folder_);
    for (int i = 0; i < 40; ++i) {
      Bytes data(i == 7 ? 50'000 : rng_() % 300);
      for (uint8_t& b : data) b = static_cast<uint8_t>(rng_());
      entries_.push_back({i * 1000, i % 3 ? "ROBOT_STATE" : "EVENT", std::move(data)});
    }
  }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string write(const std::string& name) {
    LogWriter writer(path(name));
    offsets_.clear();
    for (const Entry& e : entries_) {
      offsets_.push_back(writer.bytes());
      writer.add(e.utime, e.channel, e.data);
      writer.flush();
    }
    writer.finish();
    return path(name);
  }

  static std::vector<Entry> read(LogReader& reader) {
    std::vector<Entry> out;
    LogEvent e;
    while (reader.next(e))
      out.push_back({e.utime, std::string(e.channel), Bytes(e.data.begin(), e.data.end())});
    return out;
  }

  static Bytes load(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(in), {});
  }
  std::string store(const std::string& name, const Bytes& bytes) const {
    std::ofstream(path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path(name);
  }
  std::vector<Entry> without(std::vector<size_t> gone) const {
    std::vector<Entry> out;
    for (size_t i = 0; i < entries_.size(); ++i) {
      if (std::find(gone.begin(), gone.end(), i) == gone.end()) out.push_back(entries_[i]);
    }
    return out;
  }

  std::mt19937 rng_{3};
  std::string folder_ = lab::build_path("tests/wire/log_test");
  std::vector<Entry> entries_;
  std::vector<uint64_t> offsets_;
};

TEST_F(LogFiles, RoundTripAndStockReader) {
  entries_[7].data.resize(2'000'000, 5);  // more than the reader's window
  const std::string file = write("round.lcm");
  EXPECT_FALSE(std::filesystem::exists(part_name(file)));
  LogReader reader(file);
  EXPECT_EQ(read(reader), entries_);
  EXPECT_TRUE(reader.skipped().empty());
  EXPECT_EQ(reader.tail(), 0u);
  EXPECT_EQ(reader.position(), std::filesystem::file_size(file));

  lcm_eventlog_t* stock = lcm_eventlog_create(file.c_str(), "r");
  ASSERT_TRUE(stock);
  for (size_t i = 0; i < entries_.size(); ++i) {
    lcm_eventlog_event_t* e = lcm_eventlog_read_next_event(stock);
    ASSERT_TRUE(e) << i;
    EXPECT_EQ(e->eventnum, static_cast<int64_t>(i));
    const auto* data = static_cast<const uint8_t*>(e->data);
    EXPECT_EQ((Entry{e->timestamp, e->channel, Bytes(data, data + e->datalen)}), entries_[i]);
    lcm_eventlog_free_event(e);
  }
  EXPECT_EQ(lcm_eventlog_read_next_event(stock), nullptr);
  lcm_eventlog_destroy(stock);
}

TEST_F(LogFiles, ReadsWhatStockCodeWrites) {
  lcm_eventlog_t* stock = lcm_eventlog_create(path("stock.lcm").c_str(), "w");
  ASSERT_TRUE(stock);
  for (Entry& e : entries_) {
    lcm_eventlog_event_t event{};
    event.timestamp = e.utime;
    event.channellen = static_cast<int32_t>(e.channel.size());
    event.channel = e.channel.data();
    event.datalen = static_cast<int32_t>(e.data.size());
    event.data = e.data.data();
    ASSERT_EQ(lcm_eventlog_write_event(stock, &event), 0);
  }
  lcm_eventlog_destroy(stock);
  LogReader reader(path("stock.lcm"));
  EXPECT_EQ(read(reader), entries_);
}

TEST_F(LogFiles, CutAnywhereGivesTheWholeEventsBefore) {
  const Bytes all = load(write("whole.lcm"));
  for (int round = 0; round < 60; ++round) {
    const size_t i = rng_() % entries_.size();
    const size_t next = i + 1 < entries_.size() ? offsets_[i + 1] : all.size();
    const size_t cut = offsets_[i] + 1 + rng_() % std::min<size_t>(next - offsets_[i] - 1, 400);
    LogReader reader(store("cut.lcm", Bytes(all.begin(), all.begin() + static_cast<ptrdiff_t>(cut))));
    EXPECT_EQ(read(reader),
              std::vector<Entry>(entries_.begin(), entries_.begin() + static_cast<ptrdiff_t>(i)));
    EXPECT_EQ(reader.position(), offsets_[i]);
    EXPECT_EQ(reader.tail(), cut - offsets_[i]);
    EXPECT_TRUE(reader.skipped().empty());
  }
}

// Damage of one header costs that event alone (its sync word or a length), and says where.
TEST_F(LogFiles, DamagedHeadersCostOneEvent) {
  const Bytes all = load(write("whole.lcm"));
  for (size_t i = 0; i + 1 < entries_.size(); ++i) {
    for (const size_t byte : {0, 3, 20, 21, 22, 23, 24, 25, 26, 27}) {
      for (const uint8_t value : {0x00, 0x01, 0x02, 0x40, 0x7f, 0xff}) {
        Bytes bad = all;
        if (bad[offsets_[i] + byte] == value) continue;
        bad[offsets_[i] + byte] = value;
        LogReader reader(store("bad.lcm", bad));
        ASSERT_EQ(read(reader), without({i})) << "event " << i << " byte " << byte << " value " << int{value};
        ASSERT_EQ(reader.skipped().size(), 1u);
        EXPECT_EQ(reader.skipped()[0].offset, offsets_[i]);
        EXPECT_EQ(reader.skipped()[0].bytes, offsets_[i + 1] - offsets_[i]);
      }
      if (i % 13 != 7) break;  // all bytes for a few events only, one of them the large one
    }
  }
}

TEST_F(LogFiles, ForeignBytesBetweenAndAround) {
  const Bytes all = load(write("whole.lcm"));
  Bytes bad(17, 0xab);  // before, in the middle (a lone sync word among it), behind
  bad.reserve(all.size() + 100);
  bad.insert(bad.end(), all.begin(), all.begin() + static_cast<ptrdiff_t>(offsets_[5]));
  const size_t middle = bad.size();
  for (int k : {1, 2, 0xED, 0xA1, 0xDA, 0x01, 9, 9}) bad.push_back(static_cast<uint8_t>(k));
  bad.insert(bad.end(), all.begin() + static_cast<ptrdiff_t>(offsets_[5]), all.end());
  bad.insert(bad.end(), {1, 2, 3, 4, 5});
  LogReader reader(store("bad.lcm", bad));
  // the events before foreign bytes have no proof of their length, so they are given up too
  EXPECT_EQ(read(reader), without({4, 39}));
  ASSERT_EQ(reader.skipped().size(), 2u);
  EXPECT_EQ(reader.skipped()[0].bytes, 17u);
  EXPECT_EQ(reader.skipped()[1].offset + reader.skipped()[1].bytes, middle + 8);
  EXPECT_EQ(reader.tail(), all.size() - offsets_[39] + 5);
}

TEST_F(LogFiles, RandomDamageNeverInventsWholeEvents) {
  entries_.resize(7);  // the small ones
  const Bytes all = load(write("whole.lcm"));
  for (int round = 0; round < 1500; ++round) {
    Bytes bad = all;
    for (unsigned k = 1 + rng_() % 3; k > 0; --k) {
      const size_t at = rng_() % bad.size();
      switch (rng_() % 3) {
        case 0:
          bad[at] = static_cast<uint8_t>(rng_());
          break;
        case 1:
          bad.erase(bad.begin() + static_cast<ptrdiff_t>(at),
                    bad.begin() + static_cast<ptrdiff_t>(std::min(bad.size(), at + 1 + rng_() % 40)));
          break;
        case 2:
          bad.insert(bad.begin() + static_cast<ptrdiff_t>(at), 1 + rng_() % 40, static_cast<uint8_t>(rng_()));
          break;
      }
      if (bad.empty()) break;
    }
    LogReader reader(store("bad.lcm", bad));
    LogEvent e;
    uint64_t covered = 0;
    while (reader.next(e)) covered += e.bytes.size();
    for (const auto& gap : reader.skipped()) covered += gap.bytes;
    // every byte is an event's, skipped, or the tail's
    ASSERT_EQ(covered + reader.tail(), bad.size());
  }
}

TEST_F(LogFiles, FollowsAFileThatGrows) {
  LogWriter writer(path("grow.lcm"));
  LogReader reader(writer.part_path());
  LogEvent e;
  EXPECT_FALSE(reader.next(e));
  for (const Entry& entry : entries_) {
    writer.add(entry.utime, entry.channel, entry.data);
    EXPECT_FALSE(reader.next(e));
    writer.flush();
    ASSERT_TRUE(reader.next(e));
    EXPECT_EQ((Entry{e.utime, std::string(e.channel), Bytes(e.data.begin(), e.data.end())}), entry);
    EXPECT_FALSE(reader.next(e));
  }
  EXPECT_TRUE(reader.skipped().empty());
}

TEST_F(LogFiles, ResumesBehindAnyEvent) {
  const Bytes all = load(write("whole.lcm"));
  store("again.lcm.part",
        Bytes(all.begin(), all.begin() + static_cast<ptrdiff_t>(offsets_[10] + 13)));  // torn
  LogReader reader(path("again.lcm.part"));
  const size_t whole = read(reader).size();
  ASSERT_EQ(whole, 10u);
  {
    LogWriter writer(path("again.lcm"), reader.position(), static_cast<int64_t>(whole));
    for (size_t i = whole; i < entries_.size(); ++i)
      writer.add(entries_[i].utime, entries_[i].channel, entries_[i].data);
    EXPECT_EQ(writer.waiting() + writer.bytes(), all.size());
    writer.finish();
  }
  EXPECT_EQ(load(path("again.lcm")), all);
  store("short.lcm.part", {});
  EXPECT_THROW(LogWriter(path("short.lcm"), 100, 3), std::runtime_error);
}

TEST_F(LogFiles, FullDiskKeepsWhatWasWhole) {
  // the file size limit of this process stands in for a full disk: write(2) takes a part, then fails
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  std::string what;
  {
    LogWriter writer(path("full.lcm"));
    writer.add(1, "EVENT", Bytes(1000));
    writer.flush();
    const rlimit tight{1500, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &tight);
    writer.add(2, "EVENT", Bytes(1000));
    try {
      writer.flush();
    } catch (const std::runtime_error& e) {
      what = e.what();
    }
    setrlimit(RLIMIT_FSIZE, &old);
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(what, path("full.lcm.part") + ": writing: File too large");
  EXPECT_FALSE(std::filesystem::exists(path("full.lcm")));
  EXPECT_EQ(std::filesystem::file_size(path("full.lcm.part")), 28u + 5 + 1000);
}

// Also where the process has no standard input, and the next file is number 0.
TEST_F(LogFiles, NoFileStaysOpenBehindAFinishedLog) {
  const int input = fcntl(0, F_DUPFD_CLOEXEC, 3);
  ::close(0);
  write("whole.lcm");
  const int left_open = fcntl(0, F_GETFD);
  ::close(0);
  if (input >= 0) {
    dup2(input, 0);
    ::close(input);
  }
  EXPECT_EQ(left_open, -1);
}

TEST_F(LogFiles, ErrorsNameThePath) {
  const auto reason = [](auto f) -> std::string {
    try {
      f();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(reason([&] { LogReader(path("none.lcm")); }), path("none.lcm") + ": No such file or directory");
  EXPECT_EQ(reason([&] { LogWriter(path("none/x.lcm")); }),
            path("none/x.lcm.part") + ": opening: No such file or directory");
  EXPECT_EQ(reason([&] { publish_file(path("none.lcm")); }),
            path("none.lcm.part") + ": opening: No such file or directory");
  LogReader folder(folder_);
  LogEvent e;
  EXPECT_EQ(reason([&] { folder.next(e); }), folder_ + ": reading: Is a directory");
}

}  // namespace
}  // namespace lab
