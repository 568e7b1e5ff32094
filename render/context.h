// Where OpenGL comes from. One implementation today (OSMesa: software, no display, no GPU); EGL surfaceless
// can take its place behind the same three calls. Everything is drawn into frame buffer objects, so a context
// needs no surface.
#pragma once

#include <memory>
#include <string>

namespace lab::render {

class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;  // for the calling thread; throws std::runtime_error
  virtual std::string name() const = 0;

  // A core profile context of at least OpenGL 3.3. Throws std::runtime_error that says what was tried.
  static std::unique_ptr<Context> create();
};

}  // namespace lab::render
