#include "procs/renderer/workers.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace lab::renderer {
namespace {

struct Child {
  pid_t pid = 0;
  int pipe = -1;
  std::string text;   // of its pipe, not yet a whole line
  int64_t drawn = 0;  // how many of its own
};

/// A line up the pipe: "" for a picture, else what went wrong.
void report(int pipe, std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  line += '\n';
  for (size_t done = 0; done < line.size();) {
    const ssize_t n = write(pipe, line.data() + done, line.size() - done);
    if (n < 0 && errno != EINTR) _exit(1);  // the parent is gone
    if (n > 0) done += static_cast<size_t>(n);
  }
}

[[noreturn]] void work(int64_t count, int which, int workers, int pipe,
                       const std::function<std::unique_ptr<Worker>()>& make_worker) {
  // as many threads for OpenGL as this worker has of the machine's cores; how many never shows in the pictures
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  setenv("LP_NUM_THREADS", std::to_string(std::max(1u, cores / static_cast<unsigned>(workers))).c_str(), 0);
  try {
    const auto worker = make_worker();
    for (int64_t i = which; i < count; i += workers) {
      worker->draw(i);
      report(pipe, "");
    }
    worker->finish();
  } catch (const std::exception& error) {
    report(pipe, error.what());
    _exit(1);
  }
  _exit(0);  // without the parent's destructors and buffers
}

/// Ends and awaits what still runs, whatever happens.
struct Children {
  std::vector<Child> all;
  ~Children() {
    for (Child& child : all) {
      if (child.pipe >= 0) close(child.pipe);
      if (child.pid > 0) {
        kill(child.pid, SIGTERM);
        waitpid(child.pid, nullptr, 0);
      }
    }
  }
};

/// Reads the lines of a child, or its end.
void read_from(Child& child) {
  char buffer[4096];
  const ssize_t n = read(child.pipe, buffer, sizeof buffer);
  if (n < 0 && errno == EINTR) return;
  if (n > 0) {
    child.text.append(buffer, static_cast<size_t>(n));
    for (size_t end; (end = child.text.find('\n')) != std::string::npos; child.text.erase(0, end + 1)) {
      if (end > 0) throw std::runtime_error(child.text.substr(0, end));
      ++child.drawn;
    }
    return;
  }
  close(child.pipe);
  child.pipe = -1;
  int status = 0;
  while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  child.pid = 0;
  if (WIFSIGNALED(status))
    throw std::runtime_error(fmt::format(
        "a process that draws was killed by signal {} ({}){}", WTERMSIG(status), strsignal(WTERMSIG(status)),
        WTERMSIG(status) == SIGKILL ? ": is there too little memory? try a smaller -j" : ""));
  if (WEXITSTATUS(status) != 0)
    throw std::runtime_error(
        fmt::format("a process that draws ended with exit code {}", WEXITSTATUS(status)));
}

}  // namespace

int sensible_workers(int64_t pictures) {
  // a worker has to draw some pictures before it has made up for its own start
  const int64_t cores = std::clamp<int64_t>(std::thread::hardware_concurrency(), 1, 8);
  return static_cast<int>(std::clamp<int64_t>(pictures / 8, 1, cores));
}

void draw_all(int64_t count, int workers, const std::function<std::unique_ptr<Worker>()>& make_worker,
              const std::function<void(int64_t index)>& drawn) {
  workers = static_cast<int>(std::clamp<int64_t>(workers, 1, std::max<int64_t>(count, 1)));
  std::fflush(nullptr);  // else the children would have it too
  Children children;
  for (int i = 0; i < workers; ++i) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
    const pid_t pid = fork();
    if (pid == 0) {
      close(ends[0]);
      for (const Child& child : children.all) close(child.pipe);
      work(count, i, workers, ends[1], make_worker);
    }
    close(ends[1]);
    if (pid < 0) {
      close(ends[0]);
      throw std::runtime_error(std::string("cannot start a process that draws: ") + std::strerror(errno));
    }
    children.all.push_back({pid, ends[0], "", 0});
  }
  for (int64_t reported = 0;;) {
    std::vector<pollfd> waiting;
    for (const Child& child : children.all)
      if (child.pipe >= 0) waiting.push_back({child.pipe, POLLIN, 0});
    if (waiting.empty()) return;
    if (poll(waiting.data(), waiting.size(), -1) < 0) continue;
    for (const pollfd& each : waiting)
      if (each.revents)
        for (Child& child : children.all)
          if (child.pipe == each.fd) read_from(child);
    // the i-th is there when its worker has drawn more than i / workers of its own
    for (;
         reported < count && children.all[static_cast<size_t>(reported % workers)].drawn > reported / workers;
         ++reported)
      drawn(reported);
  }
}

}  // namespace lab::renderer
