#include "render/context.h"

#include <GL/osmesa.h>

#include <array>
#include <stdexcept>

#ifdef __SANITIZE_ADDRESS__
// OSMesa 22.3 never frees the 160 bytes that a context's surface takes: not our leak, and it would hide ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }
#endif

namespace lab::render {
namespace {

class OsmesaContext : public Context {
 public:
  OsmesaContext() {
    const int wanted[] = {OSMESA_FORMAT,
                          OSMESA_RGBA,
                          OSMESA_PROFILE,
                          OSMESA_CORE_PROFILE,
                          OSMESA_CONTEXT_MAJOR_VERSION,
                          3,
                          OSMESA_CONTEXT_MINOR_VERSION,
                          3,
                          0};
    context_ = OSMesaCreateContextAttribs(wanted, nullptr);
    if (!context_)
      throw std::runtime_error("OSMesa gives no OpenGL 3.3 core context (is libosmesa6 installed?)");
  }
  ~OsmesaContext() override { OSMesaDestroyContext(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  void make_current() override {
    if (OSMesaGetCurrentContext() == context_) return;
    // OSMesa wants a surface although everything goes to frame buffer objects: a tiny one will do.
    if (!OSMesaMakeCurrent(context_, surface_.data(), GL_UNSIGNED_BYTE, kSide, kSide))
      throw std::runtime_error("OSMesa cannot make its context current in this thread");
  }
  std::string name() const override { return "OSMesa"; }

 private:
  static constexpr int kSide = 4;
  OSMesaContext context_;
  std::array<unsigned char, kSide * kSide * 4> surface_{};
};

}  // namespace

std::unique_ptr<Context> Context::create() { return std::make_unique<OsmesaContext>(); }

}  // namespace lab::render
