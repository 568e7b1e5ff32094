#include "procs/spy/types.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/util/big_endian.h"
#include "lcmtypes/texts.h"
#include "wire/schema/channels.h"

namespace lab::spy {
namespace {

bool contains(const std::vector<Source>& sources, const std::string& text) {
  return std::any_of(sources.begin(), sources.end(), [&](const Source& known) { return known.text == text; });
}

std::vector<Source> sources_of(const std::string& folder) {
  std::vector<Source> sources;
  for (const std::string& text : lcm_texts()) sources.push_back({"lcmtypes", text});
  if (folder.empty()) return sources;
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error))
    if (entry.path().extension() == ".lcm") files.push_back(entry.path());
  if (files.empty()) throw SchemaError("--types " + folder + ": no .lcm file there");
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    if (!contains(sources, text.str())) sources.push_back({file.string(), text.str()});
  }
  return sources;
}

}  // namespace

Types::Types(const std::string& folder) : schema_(sources_of(folder)) {}

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

int64_t fingerprint(std::span<const uint8_t> bytes) {
  return bytes.size() < 8 ? 0 : load_big_endian<int64_t>(bytes.data());
}

}  // namespace lab::spy
