#include "procs/renderer/encoder.h"

namespace lab::renderer {

Encoder::~Encoder() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Encoder::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return closing_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    if (!error_) {
      const std::function<void()>& job = jobs_.front();  // a deque's elements stay where they are
      lock.unlock();
      std::exception_ptr error;
      try {
        job();
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      error_ = error;
      done_ += error ? 0 : 1;
    }
    jobs_.pop_front();
    changed_.notify_all();
  }
}

void Encoder::rethrow() {
  if (error_) std::rethrow_exception(error_);
}

void Encoder::push(std::function<void()> job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.size() < kMaxWaiting; });
  rethrow();
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

int64_t Encoder::done() {
  const std::lock_guard lock(mutex_);
  return done_;
}

void Encoder::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.empty(); });
  rethrow();
}

}  // namespace lab::renderer
