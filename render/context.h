// Creates an OpenGL context without a screen: with OSMesa (software), or EGL on Mesa's surfaceless platform (also
// software without a GPU; Mesa 25.1 has no OSMesa). Both libraries are loaded at run time. Everything is
// drawn into frame buffer objects, so a context needs no surface.
#pragma once

#include <memory>
#include <string>

namespace lab::render {

class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;  // for the calling thread; throws std::runtime_error
  virtual std::string name() const = 0;

  // A core profile context of at least OpenGL 3.3: OSMesa if it is there, else EGL; the environment variable
  // LAB_GL=osmesa or LAB_GL=egl allows only that one. The first choice holds for the whole process. Throws
  // std::runtime_error, one line that says what was tried and what each answered.
  static std::unique_ptr<Context> create();
};

}  // namespace lab::render
