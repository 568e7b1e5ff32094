#include "lab/sweep/engine.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <thread>

#include "core/util/interrupt.h"

namespace lab::sweep {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string duration(double seconds) {
  const auto s = static_cast<int64_t>(seconds + 0.5);
  if (s < 120) return fmt::format("{} s", s);
  return s < 7200 ? fmt::format("{} min", s / 60) : fmt::format("{} h {} min", s / 3600, s / 60 % 60);
}

}  // namespace

Progress::Progress(int64_t total, bool quiet)
    : total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO)),
      began_(now()),
      next_(terminal_ ? 0 : began_ + 10) {}

Progress::~Progress() {
  if (shown_ && terminal_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::show(int64_t done, int64_t fresh) {
  const double time = now();
  if (quiet_ || time < next_) return;
  next_ = time + (terminal_ ? 0.1 : 10);
  const double left =
      fresh > 0 ? (time - began_) / static_cast<double>(fresh) * static_cast<double>(total_ - done) : 0;
  const std::string text =
      fmt::format("{} of {}{}", done, total_, fresh > 0 ? ", " + duration(left) + " left" : "");
  if (terminal_) {
    const auto full = static_cast<size_t>(30 * done / std::max<int64_t>(total_, 1));
    fmt::print(stderr, "\r\x1b[K[{}{}] {}", std::string(full, '#'), std::string(30 - full, '.'), text);
  } else {
    fmt::print(stderr, "lab sweep: {}\n", text);
  }
  shown_ = true;
}

void work_through(Workbench& bench, Results& results, std::vector<Row>& rows, std::span<const int64_t> runs,
                  int threads, bool run_missing, bool quiet) {
  std::atomic<size_t> next{0};
  std::atomic<int64_t> done{0}, fresh{0};
  std::atomic<bool> failed{false};
  const auto keep_going = [&] { return !interrupted && !failed; };
  const auto one = [&](int64_t run) {
    Row& row = rows[static_cast<size_t>(run)];
    std::string line;
    try {
      const Workbench::Job job = bench.prepare(run);
      if (std::optional<Row> known = results.find(job.key)) {
        row = std::move(*known);
        ++done;
        return;
      }
      if (!run_missing) return;
      const std::optional<std::string> made = bench.work(job, keep_going);
      if (!made) return;
      line = *made;
    } catch (const std::exception& error) {
      row.state = Row::State::Unable;
      row.reason = bench.words(error);
      ++done;
      return;
    }
    row = results.add(line);
    ++done, ++fresh;
  };

  std::mutex lock;
  std::condition_variable ended;
  int alive = threads;
  std::exception_ptr fault;
  std::vector<std::thread> crew;
  for (int t = 0; t < threads; ++t)
    crew.emplace_back([&] {
      std::exception_ptr mine;
      try {
        for (size_t i; keep_going() && (i = next++) < runs.size();) one(runs[i]);
      } catch (...) {  // no place for results
        mine = std::current_exception();
        failed = true;
      }
      const std::lock_guard guard(lock);
      if (mine && !fault) fault = mine;
      --alive;
      ended.notify_one();
    });
  {
    Progress progress(static_cast<int64_t>(runs.size()), quiet);
    std::unique_lock guard(lock);
    while (!ended.wait_for(guard, std::chrono::milliseconds(100), [&] { return alive == 0; }))
      progress.show(done, fresh);
  }
  for (std::thread& thread : crew) thread.join();
  if (fault) std::rethrow_exception(fault);
}

std::vector<int64_t> part_of(int64_t runs, int64_t part, int64_t parts) {
  std::vector<int64_t> out;
  for (int64_t run = part; run < runs; run += parts) out.push_back(run);
  return out;
}

}  // namespace lab::sweep
