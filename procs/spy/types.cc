#include "procs/spy/types.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/util/big_endian.h"
#include "lcmtypes/texts.h"
#include "wire/schema/channels.h"

namespace lab::spy {
namespace {

namespace fs = std::filesystem;

bool contains(const std::vector<Source>& sources, const std::string& text) {
  return std::any_of(sources.begin(), sources.end(), [&](const Source& known) { return known.text == text; });
}

using Warn = std::function<void(const std::string&)>;

std::vector<Source> own_sources() {
  std::vector<Source> sources;
  for (const std::string& text : lcm_texts()) sources.push_back({"lcmtypes", text});
  return sources;
}

std::vector<fs::path> files_below(const fs::path& folder, const Warn& warn) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
    if (entry->path().extension() == ".lcm") files.push_back(entry->path());
  if (files.empty())
    warn(folder.string() + ": " + (error ? error.message() : "there is no .lcm file in this folder"));
  std::sort(files.begin(), files.end());
  return files;
}

void add_file(const fs::path& file, std::vector<Source>& sources, const Warn& warn) {
  std::error_code error;
  std::ifstream in;
  if (fs::is_regular_file(file, error)) in.open(file);
  if (!in.is_open()) {
    const bool is_there = fs::exists(file, error);
    return warn(file.string() + ": " + (is_there ? "cannot be read" : "there is no such file or folder"));
  }
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (!contains(sources, text)) sources.push_back({file.string(), text});
}

Schema make_schema(const std::vector<std::string>& paths, const Warn& warn) {
  std::vector<Source> sources = own_sources();
  for (const std::string& path : paths) {
    std::error_code error;
    const bool is_folder = fs::is_directory(path, error);
    for (const fs::path& file : is_folder ? files_below(path, warn) : std::vector<fs::path>{path})
      add_file(file, sources, warn);
  }
  try {
    return Schema(std::move(sources), warn);
  } catch (const SchemaError&
               error) {  // types that cannot be hashed: it is not known which of them is one too many
    warn(std::string(error.what()) + "; no --types are used");
    return Schema(own_sources());
  }
}

}  // namespace

Types::Types(const std::vector<std::string>& paths, const Warn& warn) : schema_(make_schema(paths, warn)) {}

void Types::learn(const std::string& source) {
  std::vector<Source> sources = schema_.sources();
  if (contains(sources, source)) return;
  sources.push_back({"TYPE", source});
  try {
    schema_ = Schema(std::move(sources));
  } catch (const SchemaError&) {
    return;  // a name that is taken, or a part that is still missing: what was known stays
  }
}

const Type* Types::of(std::string_view channel, std::span<const uint8_t> bytes) const {
  if (const auto known = channel_of(channel))
    if (const Type* type = schema_.find(row(*known).type); type && type->fingerprint == fingerprint(bytes))
      return type;
  return schema_.find(fingerprint(bytes));
}

std::string Types::name_of(std::string_view channel, std::span<const uint8_t> bytes) const {
  const auto known = channel_of(channel);
  if (const Type* type = of(channel, bytes); type && known && row(*known).type == type->name)
    return type->name;
  std::string names;
  for (const Type* type : schema_.all_of(fingerprint(bytes)))
    names += (names.empty() ? "" : "|") + type->name;
  return names.empty() ? fmt::format("? {:016x}", static_cast<uint64_t>(fingerprint(bytes))) : names;
}

int64_t fingerprint(std::span<const uint8_t> bytes) {
  return bytes.size() < 8 ? 0 : load_big_endian<int64_t>(bytes.data());
}

}  // namespace lab::spy
