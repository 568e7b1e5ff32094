#include "lab/sweep/engine.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <thread>

#include "core/util/interrupt.h"
#include "core/util/progress.h"

namespace lab::sweep {

void work_through(Workbench& bench, Results& results, std::vector<Row>& rows, std::span<const int64_t> runs,
                  int threads, bool run_missing, bool quiet) {
  std::atomic<size_t> next{0};
  std::atomic<int64_t> done{0}, completed{0};
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
      row.reason = bench.reason(error);
      ++done;
      return;
    }
    row = results.add(line);
    ++done;
    ++completed;
  };

  std::mutex lock;
  std::condition_variable ended;
  int running = threads;
  std::exception_ptr fault;
  std::vector<std::thread> workers;
  for (int t = 0; t < threads; ++t)
    workers.emplace_back([&] {
      std::exception_ptr own_fault;
      try {
        for (size_t i; keep_going() && (i = next++) < runs.size();) one(runs[i]);
      } catch (...) {  // results cannot be written
        own_fault = std::current_exception();
        failed = true;
      }
      const std::lock_guard guard(lock);
      if (own_fault && !fault) fault = own_fault;
      --running;
      ended.notify_one();
    });
  {
    Progress progress(static_cast<int64_t>(runs.size()), {.line_name = "lab sweep", .quiet = quiet});
    std::unique_lock guard(lock);
    while (!ended.wait_for(guard, std::chrono::milliseconds(100), [&] { return running == 0; }))
      progress.show(done, completed);
  }
  for (std::thread& thread : workers) thread.join();
  if (fault) std::rethrow_exception(fault);
}

std::vector<int64_t> part_of(int64_t runs, int64_t part, int64_t parts) {
  std::vector<int64_t> out;
  for (int64_t run = part; run < runs; run += parts) out.push_back(run);
  return out;
}

}  // namespace lab::sweep
