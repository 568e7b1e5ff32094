// Which .lcm texts can be used together: each by itself is parsed, no name is declared twice, and every type of a member is
// declared somewhere.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "wire/schema/schema_parse.h"

namespace lab {

struct ParsedSource {
  Source source;
  Declarations declared;
};

/// The texts that can be used together, in their order; of two that declare the same name the earlier one. Calls
/// fault(`file:line: what is wrong`) for each other one.
std::vector<ParsedSource> parse_together(std::vector<Source> sources,
                                         const std::function<void(const std::string&)>& fault);

}  // namespace lab
