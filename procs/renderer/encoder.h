// Compresses and writes pictures on a thread of its own, beside the drawing of the next one.
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace lab::renderer {

/// Does jobs in their order on a thread of its own.
class Encoder {
 public:
  Encoder() : thread_([this] { work(); }) {}
  ~Encoder();  ///< waiting jobs are still done, errors are lost: finish() first
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  /// Waits while kMaxWaiting jobs wait. Throws what an earlier job threw; then nothing more is done.
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
