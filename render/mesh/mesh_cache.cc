#include "render/mesh/mesh_cache.h"

#include <assimp/version.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "core/util/atomic_file.h"
#include "render/mesh/decimate.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/texture.h"

namespace lab::render {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMany = 4;            // times the triangles asked for: then the error may be larger
constexpr char kMagic[] = "lab mesh";  // 8 bytes in the file
constexpr uintmax_t kMaxCache = 1'000'000'000;

uint64_t hash(const std::string& bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

// An entry is a row of numbers and arrays in the machine's own order: it never leaves this machine.
struct Writer {
  std::string bytes;
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void add_all(const T& row) {
    add<uint64_t>(row.size());
    bytes.append(reinterpret_cast<const char*>(row.data()), row.size() * sizeof row[0]);
  }
};

struct Reader {
  const std::string& bytes;
  size_t at = 0;
  void take(void* to, uint64_t size) {
    if (size > bytes.size() - at) throw std::runtime_error("too short");
    if (size) std::memcpy(to, bytes.data() + at, size);
    at += size;
  }
  template <class T>
  void get(T& value) {
    take(&value, sizeof value);
  }
  template <class T>
  void get_all(T& row) {
    uint64_t size = 0;
    get(size);
    if (size > (bytes.size() - at) / sizeof row[0]) throw std::runtime_error("too short");
    row.resize(size);
    take(row.data(), size * sizeof row[0]);
  }
};

// Of a file beside the mesh: 0 = it is not there.
uint64_t hash_of_file(const std::string& path) {
  std::string bytes;
  return read_bytes(path, bytes) ? hash(bytes) | 1 : 0;
}

std::string pack(const MeshFile& file, const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  Writer w;
  w.add<uint64_t>(file.others.size());
  for (const std::string& other : file.others) {
    w.add_all(fs::path(other).lexically_proximate(folder).string());
    w.add(hash_of_file(other));
  }
  w.add<uint64_t>(file.warnings.size());
  for (const std::string& warning : file.warnings) w.add_all(warning);

  const Mesh& mesh = *file.mesh;
  w.add_all(mesh.positions);
  w.add_all(mesh.normals);
  w.add_all(mesh.uvs);
  w.add_all(mesh.colours);
  w.add_all(mesh.indices);
  std::vector<const Texture*> textures;
  std::map<const Texture*, int64_t> number{{nullptr, -1}};
  for (const Surface& s : mesh.surfaces)
    if (number.emplace(s.texture.get(), textures.size()).second) textures.push_back(s.texture.get());
  w.add<uint64_t>(textures.size());
  for (const Texture* t : textures) {
    w.add_all(t->file);
    if (t->file.empty()) {
      w.add(t->width);
      w.add(t->height);
      w.add_all(t->rgba);
    }
  }
  w.add<uint64_t>(mesh.surfaces.size());
  for (const Surface& s : mesh.surfaces) {
    w.add(s.first);
    w.add(s.count);
    w.add(s.roughness);
    w.add(s.coloured);
    w.add(s.two_sided);
    for (int i = 0; i < 4; ++i) w.add(s.rgba[i]);
    w.add(number[s.texture.get()]);
  }
  Writer whole;
  whole.bytes.assign(kMagic, 8);
  whole.add(hash(w.bytes));
  return whole.bytes + w.bytes;
}

void require(bool ok) {
  if (!ok) throw std::runtime_error("not a mesh");
}

// Throws std::runtime_error for anything but a whole entry that is up to date.
MeshFile unpack(const std::string& bytes, const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  require(bytes.size() > 16 && bytes.compare(0, 8, kMagic) == 0);
  Reader r{bytes, 8};
  uint64_t expected = 0, count = 0;
  r.get(expected);
  require(XXH3_64bits(bytes.data() + 16, bytes.size() - 16) == expected);

  MeshFile file;
  for (r.get(count); count > 0; --count) {
    std::string other;
    uint64_t content = 0;
    r.get_all(other);
    r.get(content);
    require(hash_of_file((folder / other).lexically_normal().string()) == content);
  }
  for (r.get(count); count > 0; --count) r.get_all(file.warnings.emplace_back());

  auto mesh = std::make_shared<Mesh>();
  r.get_all(mesh->positions);
  r.get_all(mesh->normals);
  r.get_all(mesh->uvs);
  r.get_all(mesh->colours);
  r.get_all(mesh->indices);
  const size_t n = mesh->positions.size();
  require(mesh->normals.size() == n && (mesh->uvs.empty() || mesh->uvs.size() == n) &&
          (mesh->colours.empty() || mesh->colours.size() == n) && mesh->indices.size() % 3 == 0);
  for (uint32_t i : mesh->indices) require(i < n);
  std::vector<std::shared_ptr<const Texture>> textures;
  for (r.get(count); count > 0; --count) {
    std::string source;
    r.get_all(source);
    if (!source.empty()) {
      textures.push_back(decode_texture(source));
      continue;
    }
    auto texture = std::make_shared<Texture>();
    r.get(texture->width);
    r.get(texture->height);
    r.get_all(texture->rgba);
    require(texture->width > 0 && texture->height > 0 &&
            texture->rgba.size() == size_t(texture->width) * texture->height * 4);
    textures.push_back(texture);
  }
  for (r.get(count); count > 0; --count) {
    Surface s;
    int64_t texture = -1;
    r.get(s.first);
    r.get(s.count);
    r.get(s.roughness);
    r.get(s.coloured);
    r.get(s.two_sided);
    for (int i = 0; i < 4; ++i) r.get(s.rgba[i]);
    r.get(texture);
    require(uint64_t{s.first} + s.count <= mesh->indices.size());
    require(texture >= -1 && texture < static_cast<int64_t>(textures.size()));
    if (texture >= 0) s.texture = textures[static_cast<size_t>(texture)];
    mesh->surfaces.push_back(s);
  }
  for (const Eigen::Vector3f& p : mesh->positions) mesh->bounds.extend(p.cast<double>());
  file.mesh = mesh;
  return file;
}

// Entries that were not used for longest go until the rest fits. Others may do the same at the same time:
// what is already gone is no error.
void keep_small(const fs::path& folder) {
  struct Entry {
    fs::file_time_type used;
    fs::path path;
    uintmax_t size;
  };
  std::vector<Entry> entries;
  std::error_code error;
  uintmax_t sum = 0;
  for (const auto& item : fs::directory_iterator(folder, error)) {
    std::error_code gone;
    Entry e{item.last_write_time(gone), item.path(), item.file_size(gone)};
    if (gone) continue;
    sum += e.size;
    entries.push_back(std::move(e));
  }
  if (sum <= kMaxCache) return;
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
  for (const Entry& e : entries) {
    if (sum <= kMaxCache) break;
    sum -= e.size;
    fs::remove(e.path, error);
  }
}

// Under a name of this process first: readers see a whole entry or none.
void store(const fs::path& entry, const std::string& bytes) {
  std::error_code error;
  fs::create_directories(entry.parent_path(), error);
  const std::string part = entry.string() + ".part" + std::to_string(getpid());
  if (write_and_rename(entry.string(), part, bytes, false).error == 0) keep_small(entry.parent_path());
}

MeshFile make(const std::string& path, const MeshOptions& options) {
  MeshFile file = read_mesh_file(path);
  const auto reduce = [&](size_t triangles, double error) {
    if (options.triangles > 0 && file.mesh->triangles() > triangles)
      file.mesh = decimate(*file.mesh, triangles, error);
  };
  reduce(options.triangles, options.error);
  reduce(kMany * options.triangles, 2 * options.error);
  for (std::string& warning : file.warnings)  // the same content may lie elsewhere tomorrow
    if (warning.compare(0, path.size(), path) == 0) warning.erase(0, path.size());
  return file;
}

MeshFile from_cache(const std::string& path, const MeshOptions& options) {
  std::string bytes;
  if (options.cache.empty() || !read_bytes(path, bytes)) return make(path, options);
  Writer key;
  key.add_all(std::string(LAB_MESH_CODE));
  for (unsigned v : {aiGetVersionMajor(), aiGetVersionMinor(), aiGetVersionPatch()}) key.add(v);
  key.add_all(fs::path(path).extension().string());
  key.add(options.triangles);
  key.add(options.error);
  key.add_all(bytes);
  const XXH128_hash_t name = XXH3_128bits(key.bytes.data(), key.bytes.size());
  char text[40];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(name.high64),
                static_cast<unsigned long long>(name.low64));
  const fs::path entry = fs::path(options.cache) / text;

  std::string kept;
  if (read_bytes(entry.string(), kept)) {
    try {
      MeshFile file = unpack(kept, path);
      std::error_code none;
      fs::last_write_time(entry, fs::file_time_type::clock::now(), none);
      return file;
    } catch (const std::exception&) {
      kept.clear();  // a damaged entry: it is made anew
    }
  }
  MeshFile file = make(path, options);
  store(entry, pack(file, path));
  return file;
}

}  // namespace

std::string mesh_cache_folder() {
  const auto value = [](const char* name) {
    const char* text = std::getenv(name);
    return std::string(text ? text : "");
  };
  const std::string own = value("LAB_MESH_CACHE"), xdg = value("XDG_CACHE_HOME"), home = value("HOME");
  if (!own.empty()) return own == "off" ? "" : own;
  if (!xdg.empty()) return xdg + "/lcmlab/meshes";
  return home.empty() ? "" : home + "/.cache/lcmlab/meshes";
}

MeshPtr load_mesh(const std::string& path, const MeshOptions& options, std::vector<std::string>* warnings) {
  const MeshFile file = from_cache(path, options);
  if (warnings)
    for (const std::string& warning : file.warnings) warnings->push_back(path + warning);
  return file.mesh;
}

}  // namespace lab::render
