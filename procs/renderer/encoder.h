// Compresses and writes pictures on a separate thread, while the next one is drawn.
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace lab::renderer {

/// Runs jobs in order on a separate thread.
class Encoder {
 public:
  Encoder() : thread_([this] { work(); }) {}
  ~Encoder();  ///< runs the waiting jobs, but drops errors: call finish() first
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  /// Blocks while kMaxWaiting jobs wait. Throws what an earlier job threw; after that no job is run.
  void push(std::function<void()> job);
  /// Jobs done so far.
  int64_t done();
  /// Waits until all are done. Throws what one of them threw.
  void finish();

  static constexpr size_t kMaxWaiting = 4;  ///< pictures in memory

 private:
  void work();
  void rethrow();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;  // the first one is being done
  int64_t done_ = 0;
  bool closing_ = false;
  std::exception_ptr error_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace lab::renderer
