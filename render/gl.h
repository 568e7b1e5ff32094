// OpenGL 3.3 core as used by the renderer: the entry points, shader programs, error texts.
#pragma once

#include <Eigen/Core>
#include <string>
#include <unordered_map>
#include <vector>

#include "render/gl_entry.h"

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
  void set(const char* uniform, const std::vector<Eigen::Vector2f>& values) const;  // an array
  void set(const char* uniform, const Eigen::Vector3f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Matrix3f& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;

 private:
  int location(const char* uniform) const;
  const char* name_;
  unsigned id_ = 0;                                         // freed with its context
  mutable std::unordered_map<std::string, int> locations_;  // of uniforms: a query per call is slow
};

// Both throw std::runtime_error when GL cannot. 0 stands for "none".
unsigned make_texture(int width, int height, unsigned inner, unsigned format, unsigned type);
unsigned make_framebuffer(unsigned colour, unsigned depth);

}  // namespace lab::render
