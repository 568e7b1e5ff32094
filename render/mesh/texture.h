// Pictures for textures: PNG and JPEG, from memory.
#pragma once

#include <memory>
#include <string>

#include "render/mesh/mesh.h"

namespace lab::render {

// Throws std::runtime_error (one line) for another kind, a broken picture, more than 8192 pixels a side.
std::shared_ptr<const Texture> decode_texture(const std::string& bytes);

}  // namespace lab::render
