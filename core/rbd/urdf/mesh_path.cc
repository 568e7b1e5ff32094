// Finds the files behind package:// without ROS.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "rbd/urdf/shapes.h"

namespace rbd::urdf {
namespace {

namespace fs = std::filesystem;

// Folders of a colon-separated environment variable, each with `suffix` behind it.
std::vector<fs::path> folders_of(const char* variable, const fs::path& suffix = {}) {
  std::vector<fs::path> out;
  const char* value = std::getenv(variable);
  std::string_view rest = value ? value : "";
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
    if (!folder.empty()) out.push_back(suffix.empty() ? fs::path(folder) : fs::path(folder) / suffix);
  }
  return out;
}

bool is_file(const std::string& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

// What is wrong with a file that is there: empty, or the note that Git LFS leaves in place of the real one.
std::string problem_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  char begin[24] = {};
  in.read(begin, sizeof begin);
  if (in.gcount() == 0) return in.eof() ? " is empty" : " cannot be read";
  const std::string_view text(begin, static_cast<size_t>(in.gcount()));
  return text == "version https://git-lfs." ? " is only a Git LFS pointer: run git lfs pull there" : "";
}

}  // namespace

std::vector<std::string> mesh_candidates(const std::string& uri, const std::string& urdf,
                                         const std::vector<std::string>& package_dirs) {
  std::vector<std::string> out;
  const auto add = [&](const fs::path& path) {
    const std::string text = path.lexically_normal().string();
    if (std::find(out.begin(), out.end(), text) == out.end()) out.push_back(text);
  };
  const std::vector<fs::path> given(package_dirs.begin(), package_dirs.end());
  const size_t scheme = uri.find("://");
  const std::string kind = scheme == uri.npos ? "" : uri.substr(0, scheme);
  const std::string rest = scheme == uri.npos ? uri : uri.substr(scheme + 3);
  std::error_code none;
  const fs::path beside = fs::absolute(urdf, none).lexically_normal().parent_path();

  if (kind == "file" || (kind.empty() && fs::path(rest).is_absolute())) {
    add(rest);
  } else if (kind.empty()) {
    add(beside / rest);
    for (const fs::path& folder : given) add(folder / rest);
  } else if (kind == "package" || kind == "model") {
    const std::string package = rest.substr(0, rest.find('/'));
    const fs::path inside = package.size() < rest.size() ? rest.substr(package.size() + 1) : "";
    const auto look_in = [&](const fs::path& folder) {
      const fs::path normal = folder.lexically_normal();
      const fs::path name = normal.has_filename() ? normal.filename() : normal.parent_path().filename();
      if (name == package) add(folder / inside);
      add(folder / package / inside);
    };
    for (const fs::path& folder : given) look_in(folder);
    for (const fs::path& folder : folders_of("LAB_PACKAGE_PATH")) look_in(folder);
    for (const fs::path& folder : folders_of("ROS_PACKAGE_PATH")) look_in(folder);
    for (const fs::path& folder : folders_of("AMENT_PREFIX_PATH", "share")) look_in(folder);
    for (fs::path folder = beside; !folder.empty(); folder = folder.parent_path()) {
      look_in(folder);
      if (folder == folder.parent_path()) break;
    }
  }
  return out;
}

namespace {

/// The first mesh of a package that is not there.
struct Missing {
  int line = 0;
  std::string link, uri, places;
  int count = 0;
};

/// "panda" of package://panda/meshes/hand.stl; "" for a path.
std::string package_of(const std::string& uri) {
  for (const std::string kind : {"package://", "model://"})
    if (uri.starts_with(kind)) return uri.substr(kind.size(), uri.find('/', kind.size()) - kind.size());
  return "";
}

}  // namespace

void find_meshes(std::vector<LinkShape>& shapes, const std::vector<std::string>& package_dirs,
                 Report& report) {
  std::map<std::string, std::string> known;  // uri -> file, empty if there is none
  std::map<std::string, Missing> lost;       // by package: one warning each
  for (LinkShape& item : shapes) {
    const std::string& uri = item.object.meshUri;
    if (item.object.shape != Shape::Mesh) continue;
    const auto [entry, fresh] = known.emplace(uri, "");
    if (fresh) {
      const std::vector<std::string> tried = mesh_candidates(uri, report.file(), package_dirs);
      const auto found = std::find_if(tried.begin(), tried.end(), is_file);
      if (found != tried.end()) {
        const std::string problem = problem_of(*found);
        if (problem.empty()) entry->second = *found;
        if (!problem.empty())
          report.warn(item.line, "link '" + item.link + "'", "mesh '" + uri + "': " + *found + problem);
      } else {
        std::string places;
        for (const std::string& path : tried) places += (places.empty() ? "tried " : ", ") + path;
        if (places.empty()) places = "known: package:// model:// file:// or a path";
        Missing& missing = lost[package_of(uri)];
        if (missing.count++ == 0) missing = {item.line, item.link, uri, places, 1};
      }
    }
    item.object.mesh = entry->second;
  }
  for (const auto& [package, first] : lost) {
    const std::string others = first.count > 1
                                   ? ", nor are " + std::to_string(first.count - 1) +
                                         (package.empty() ? " others" : " others of '" + package + "'")
                                   : "";
    const std::string remedy =
        package.empty() ? ""
                        : "; LAB_PACKAGE_PATH must have the folder that holds the package '" + package + "'";
    report.warn(first.line, "link '" + first.link + "'",
                "mesh '" + first.uri + "' not found" + others + remedy + " (" + first.places + ")");
  }
}

}  // namespace rbd::urdf
