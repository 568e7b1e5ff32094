#include "procs/spy/types.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/util/big_endian.h"
#include "lcmtypes/texts.h"
#include "wire/schema/channels.h"

namespace lab::spy {

Types::Types(const std::string& folder) {
  for (const std::string& text : lcm_texts()) sources_.push_back({"lcmtypes", text});
  if (!folder.empty()) {
    std::vector<std::filesystem::path> files;
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error))
      if (entry.path().extension() == ".lcm") files.push_back(entry.path());
    if (files.empty()) throw SchemaError("--types " + folder + ": no .lcm file there");
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      std::stringstream text;
      text << std::ifstream(file).rdbuf();
      const Source source{file.string(), text.str()};
      if (std::none_of(sources_.begin(), sources_.end(),
                       [&](const Source& known) { return known.text == source.text; }))
        sources_.push_back(source);
    }
  }
  schema_.emplace(sources_);
}

void Types::learn(const std::string& source) {
  if (std::any_of(sources_.begin(), sources_.end(),
                  [&](const Source& known) { return known.text == source; }))
    return;
  sources_.push_back({"TYPE", source});
  try {
    schema_.emplace(sources_);
  } catch (const SchemaError&) {
    sources_.pop_back();  // a name that is taken, or a part that is still missing
    schema_.emplace(sources_);
  }
}

const Type* Types::of(std::string_view channel, std::span<const uint8_t> bytes) const {
  if (const auto known = channel_of(channel))
    if (const Type* type = schema_->find(row(*known).type); type && type->fingerprint == fingerprint(bytes))
      return type;
  return schema_->find(fingerprint(bytes));
}

int64_t fingerprint(std::span<const uint8_t> bytes) {
  return bytes.size() < 8 ? 0 : load_big_endian<int64_t>(bytes.data());
}

}  // namespace lab::spy
