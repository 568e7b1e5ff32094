// OpenGL 3.3 core as used by the renderer: the entry points, shader programs, error texts.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <unordered_map>

#include "render/gl_entry.h"
#include "render/mesh.h"

namespace lab::render {

// Throws std::runtime_error "WHERE: OpenGL error NAME" if GL has recorded one.
void check_gl(const char* where);

// A linked program, in use after use(). Setting a uniform that the shader does not have is a
// std::logic_error.
class Program {
 public:
  // Throws std::runtime_error with the compiler's log. `defines` goes in front of both sources, after
  // #version.
  Program(const char* name, const std::string& defines, const char* vertex, const char* fragment);
  void use() const { glUseProgram(id_); }
  void set(const char* uniform, float value) const;
  void set(const char* uniform, int value) const;
  void set(const char* uniform, const Eigen::Vector3f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Matrix3f& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;

 private:
  int location(const char* uniform) const;
  const char* name_;
  unsigned id_ = 0;  // dies with its context
};

// Both throw std::runtime_error when GL cannot. 0 stands for "none".
unsigned make_texture(int width, int height, unsigned inner, unsigned format, unsigned type);
unsigned make_framebuffer(unsigned colour, unsigned depth);

// A mesh on the GL side: interleaved positions and normals, indices.
struct Buffers {
  std::weak_ptr<const Mesh> alive;  // expired when nobody else holds the mesh any more
  unsigned array = 0, vertices = 0, indices = 0;
};

class MeshStore {
 public:
  const Buffers& get(const MeshPtr& mesh);  // uploads at first sight
  // A new mesh may get the address of a dead one: call this before get() in every frame.
  void forget_dead();

 private:
  std::unordered_map<const Mesh*, Buffers> meshes_;
};

}  // namespace lab::render
