#include "render/gl.h"

#include <stdexcept>
#include <vector>

namespace lab::render {
namespace {

unsigned compile(const char* name, unsigned kind, const std::string& defines, const char* source) {
  const unsigned shader = glCreateShader(kind);
  const std::string head = "#version 330 core\n" + defines;
  const char* texts[2] = {head.c_str(), source};
  glShaderSource(shader, 2, texts, nullptr);
  glCompileShader(shader);
  int ok = 0, length = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::vector<char> log(length + 1);
  glGetShaderInfoLog(shader, length, nullptr, log.data());
  throw std::runtime_error(std::string("shader ") + name + " does not compile: " + log.data());
}

}  // namespace

void check_gl(const char* where) {
  const unsigned error = glGetError();
  if (error == GL_NO_ERROR) return;
  const char* name = error == GL_OUT_OF_MEMORY                   ? "out of memory"
                     : error == GL_INVALID_ENUM                  ? "invalid enum"
                     : error == GL_INVALID_VALUE                 ? "invalid value"
                     : error == GL_INVALID_OPERATION             ? "invalid operation"
                     : error == GL_INVALID_FRAMEBUFFER_OPERATION ? "invalid framebuffer operation"
                                                                 : "unknown";
  throw std::runtime_error(std::string(where) + ": OpenGL error: " + name + " (" + std::to_string(error) +
                           ")");
}

Program::Program(const char* name, const std::string& defines, const char* vertex, const char* fragment)
    : name_(name) {
  const unsigned v = compile(name, GL_VERTEX_SHADER, defines, vertex);
  const unsigned f = compile(name, GL_FRAGMENT_SHADER, defines, fragment);
  id_ = glCreateProgram();
  glAttachShader(id_, v);
  glAttachShader(id_, f);
  glLinkProgram(id_);
  glDeleteShader(v);
  glDeleteShader(f);
  int ok = 0, length = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &ok);
  if (ok) return;
  glGetProgramiv(id_, GL_INFO_LOG_LENGTH, &length);
  std::vector<char> log(length + 1);
  glGetProgramInfoLog(id_, length, nullptr, log.data());
  throw std::runtime_error(std::string("shader ") + name + " does not link: " + log.data());
}

int Program::location(const char* uniform) const {
  const auto known = locations_.find(uniform);
  if (known != locations_.end()) return known->second;
  const int place = glGetUniformLocation(id_, uniform);
  if (place < 0) throw std::logic_error(std::string("shader ") + name_ + " has no uniform " + uniform);
  return locations_[uniform] = place;
}

void Program::set(const char* uniform, float value) const { glUniform1f(location(uniform), value); }
void Program::set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
void Program::set(const char* uniform, const std::vector<Eigen::Vector2f>& values) const {
  glUniform2fv(location(uniform), static_cast<int>(values.size()), values.front().data());
}
void Program::set(const char* uniform, const Eigen::Vector3f& value) const {
  glUniform3fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Eigen::Vector4f& value) const {
  glUniform4fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Eigen::Matrix3f& value) const {
  glUniformMatrix3fv(location(uniform), 1, GL_FALSE, value.data());
}
void Program::set(const char* uniform, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}

unsigned make_texture(int width, int height, unsigned inner, unsigned format, unsigned type) {
  unsigned id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<int>(inner), width, height, 0, format, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return id;
}

unsigned make_framebuffer(unsigned colour, unsigned depth) {
  unsigned id = 0;
  glGenFramebuffers(1, &id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  if (colour) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour, 0);
  if (depth) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  if (!colour) {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("OpenGL has no frame buffer of this size");
  return id;
}

}  // namespace lab::render
