#include "render/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <mutex>
#include <stdexcept>

#include "render/gl_entry.h"

#ifdef __SANITIZE_ADDRESS__
// OSMesa 22.3 never frees the 160 bytes that a context's surface takes, EGL keeps its driver: not our leaks,
// and they would hide ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libEGL\nleak:_dri.so\n";
}
#endif

namespace lab::render {
namespace {

// A shared library that stays loaded. Throws std::runtime_error with the loader's words.
class Library {
 public:
  explicit Library(std::initializer_list<const char*> names) {
    std::string why;
    for (const char* name : names) {
      handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
      if (handle_) return;
      if (why.empty()) why = dlerror();
    }
    throw std::runtime_error(why);
  }
  template <class Function>
  void find(Function& function, const char* name) const {
    function = reinterpret_cast<Function>(dlsym(handle_, name));
    if (!function) throw std::runtime_error(std::string("it has no ") + name);
  }

 private:
  void* handle_ = nullptr;
};

// OSMesa's entry points, declared here and not by GL/osmesa.h: Mesa 25.1 ends OSMesa, and the build must not need
// a header that is about to leave.
struct Osmesa {
  using Handle = struct OsmesaHandle*;
  // names of attributes, from GL/osmesa.h
  static constexpr int kFormat = 0x22, kProfile = 0x33, kCoreProfile = 0x34, kMajorVersion = 0x36,
                       kMinorVersion = 0x37;
  Handle (*create)(const int* attributes, Handle shared);
  void (*destroy)(Handle);
  GLboolean (*make_current)(Handle, void* surface, GLenum type, GLsizei width, GLsizei height);
  Handle (*current)();
  void (*(*address)(const char* name))();

  static const Osmesa& get() {
    static const Osmesa loaded;
    return loaded;
  }

 private:
  Osmesa() {
    const Library lib{"libOSMesa.so.8", "libOSMesa.so"};
    lib.find(create, "OSMesaCreateContextAttribs");
    lib.find(destroy, "OSMesaDestroyContext");
    lib.find(make_current, "OSMesaMakeCurrent");
    lib.find(current, "OSMesaGetCurrentContext");
    lib.find(address, "OSMesaGetProcAddress");
  }
};

class OsmesaContext : public Context {
 public:
  OsmesaContext() {
    const int attributes[] = {Osmesa::kFormat,
                              GL_RGBA,
                              Osmesa::kProfile,
                              Osmesa::kCoreProfile,
                              Osmesa::kMajorVersion,
                              3,
                              Osmesa::kMinorVersion,
                              3,
                              0};
    context_ = lib_.create(attributes, nullptr);
    if (!context_) throw std::runtime_error("gives no OpenGL 3.3 core context");
  }
  ~OsmesaContext() override { lib_.destroy(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  void make_current() override {
    if (lib_.current() == context_) return;
    // OSMesa needs a surface although everything is drawn into frame buffer objects: a tiny one is enough.
    if (!lib_.make_current(context_, surface_.data(), GL_UNSIGNED_BYTE, kSide, kSide))
      throw std::runtime_error("OSMesa cannot make its context current in this thread");
  }
  std::string name() const override { return "OSMesa"; }
  static void* address(const char* name) { return reinterpret_cast<void*>(Osmesa::get().address(name)); }

 private:
  static constexpr int kSide = 4;
  const Osmesa& lib_ = Osmesa::get();
  Osmesa::Handle context_;
  std::array<unsigned char, kSide * kSide * 4> surface_{};
};

struct Egl {
  decltype(&eglGetProcAddress) address;
  decltype(&eglInitialize) initialize;
  decltype(&eglBindAPI) bind_api;
  decltype(&eglChooseConfig) choose_config;
  decltype(&eglCreateContext) create;
  decltype(&eglDestroyContext) destroy;
  decltype(&eglMakeCurrent) make_current;
  decltype(&eglGetCurrentContext) current;
  EGLDisplay display = EGL_NO_DISPLAY;  // one for the process, never closed: contexts share it

  static const Egl& get() {
    static const Egl loaded;
    return loaded;
  }

 private:
  Egl() {
    const Library lib{"libEGL.so.1", "libEGL.so"};
    lib.find(address, "eglGetProcAddress");
    lib.find(initialize, "eglInitialize");
    lib.find(bind_api, "eglBindAPI");
    lib.find(choose_config, "eglChooseConfig");
    lib.find(create, "eglCreateContext");
    lib.find(destroy, "eglDestroyContext");
    lib.find(make_current, "eglMakeCurrent");
    lib.find(current, "eglGetCurrentContext");
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(address("eglGetPlatformDisplayEXT"));
    if (get_display) display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !initialize(display, nullptr, nullptr))
      throw std::runtime_error("gives no display without a screen (it needs Mesa's surfaceless platform)");
  }
};

class EglContext : public Context {
 public:
  EglContext() {
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                        EGL_OPENGL_BIT, EGL_NONE};
    const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         3,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         3,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (lib_.bind_api(EGL_OPENGL_API) &&
        lib_.choose_config(lib_.display, config_attributes, &config, 1, &count) && count == 1)
      context_ = lib_.create(lib_.display, config, EGL_NO_CONTEXT, context_attributes);
    if (context_ == EGL_NO_CONTEXT) throw std::runtime_error("gives no OpenGL 3.3 core context");
  }
  ~EglContext() override {
    if (lib_.current() == context_)
      lib_.make_current(lib_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    lib_.destroy(lib_.display, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() override {
    if (lib_.current() == context_) return;
    lib_.bind_api(EGL_OPENGL_API);  // is a setting of the thread
    if (!lib_.make_current(lib_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw std::runtime_error("EGL cannot make its context current in this thread");
  }
  std::string name() const override { return "EGL"; }
  static void* address(const char* name) { return reinterpret_cast<void*>(Egl::get().address(name)); }

 private:
  const Egl& lib_ = Egl::get();
  EGLContext context_ = EGL_NO_CONTEXT;
};

template <class Kind>
std::unique_ptr<Context> make() {
  return std::make_unique<Kind>();
}

struct Backend {
  const char *key, *name;
  std::unique_ptr<Context> (*make)();
  void* (*address)(const char*);
};
constexpr Backend kBackends[] = {{"osmesa", "OSMesa", make<OsmesaContext>, OsmesaContext::address},
                                 {"egl", "EGL", make<EglContext>, EglContext::address}};

}  // namespace

void GlEntry::load(void* (*find)(const char*)) {
  for (GlEntry* entry = first_; entry; entry = entry->next_) {
    entry->address_ = find(entry->name_);
    if (!entry->address_) throw std::runtime_error(std::string("it has no ") + entry->name_);
  }
}

std::unique_ptr<Context> Context::create() {
  static std::mutex mutex;
  static const Backend* chosen = nullptr;  // entry points are the process'
  const std::lock_guard lock(mutex);
  if (chosen) return chosen->make();
  const char* setting = std::getenv("LAB_GL");
  const std::string only = setting ? setting : "";
  const auto asked = [&](const Backend& backend) { return only.empty() || only == backend.key; };
  if (std::none_of(std::begin(kBackends), std::end(kBackends), asked))
    throw std::runtime_error("LAB_GL must be osmesa or egl, not '" + only + "'");
  std::string answers;
  for (const Backend& backend : kBackends) {
    if (!asked(backend)) continue;
    try {
      auto context = backend.make();
      context->make_current();
      GlEntry::load(backend.address);
      chosen = &backend;
      return context;
    } catch (const std::exception& e) {
      answers += (answers.empty() ? "" : "; ") + std::string(backend.name) + ": " + e.what();
    }
  }
  throw std::runtime_error("no OpenGL without a screen (install libosmesa6, or libegl1 and libegl-mesa0): " +
                           answers);
}

}  // namespace lab::render
