// Many pictures drawn by several processes at once.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace lab::renderer {

/// Draws some pictures of many.
class Worker {
 public:
  virtual ~Worker() = default;
  virtual void draw(int64_t index) = 0;
  virtual void finish() = 0;  ///< after the last one
};

/// A suitable number of workers for so many pictures on this machine.
int sensible_workers(int64_t pictures);

/// Draws pictures 0 to count - 1 in `workers` processes forked from this one, picture i in worker i modulo `workers`.
/// Processes, not threads: software OpenGL draws for only one context of a process at a time. Call it while this
/// process has neither threads nor an OpenGL context. `drawn` is called for each picture, in order. Throws
/// std::runtime_error with the first error of a worker; the others are killed then.
void draw_all(int64_t count, int workers, const std::function<std::unique_ptr<Worker>()>& make_worker,
              const std::function<void(int64_t index)>& drawn);

}  // namespace lab::renderer
