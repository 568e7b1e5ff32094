// Whatever a TYPE message or an .lcm file says: it is refused with file and line, or gives a schema; and whatever bytes
// are then held against its types, they are refused or decoded. Up to the first NUL: the text; behind it: the bytes.
#include <algorithm>
#include <string>

#include "core/util/big_endian.h"
#include "lcmtypes/texts.h"
#include "tests/fuzz/fuzz.h"
#include "wire/schema/schema.h"

namespace lab::fuzz {

std::vector<std::vector<uint8_t>> seeds() {
  std::vector<std::string> texts = lcm_texts();
  texts.push_back(
      "package a;\nenum kind_t { ONE = 1, TWO }\nstruct inner_t { byte n; int8_t x[n][2]; }\n"
      "struct outer_t { const int32_t K = -3, L = 0x10; kind_t kind; int32_t m; a.inner_t in[m]; string "
      "s[2]; boolean b; float f; }\n");
  std::vector<std::vector<uint8_t>> all;
  for (const std::string& text : texts) {
    all.emplace_back(text.begin(), text.end());
    try {
      const Schema schema({{"seed.lcm", text}});
      for (const Type& type : schema.types()) {  // all members 0
        all.emplace_back(text.begin(), text.end());
        all.back().push_back(0);
        append_big_endian(all.back(), type.fingerprint);
        all.back().resize(all.back().size() + 40);
      }
    } catch (const SchemaError&) {  // a text that needs others
    }
  }
  return all;
}

}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace lab;
  const uint8_t* nul = std::find(bytes, bytes + size, 0);
  const std::span<const uint8_t> data(nul == bytes + size ? nul : nul + 1, bytes + size);
  try {
    const Schema schema({{"x.lcm", std::string(bytes, nul)}});
    for (const Type& type : schema.types())
      for (const bool strict : {true, false}) {
        if (!schema.check(type, data, {.finite = strict, .text = strict}).empty()) continue;
        const Value value = schema.decode(type, data);
        fuzz::demand(!to_text(value).empty() || type.fields.empty(), "a message without a word");
      }
  } catch (const SchemaError& error) {
    fuzz::demand(std::string(error.what()).starts_with("x.lcm"), "an error that does not say where");
  }
  return 0;
}
