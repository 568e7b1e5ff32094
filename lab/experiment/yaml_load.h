// The one place where a text becomes YAML: experiments, sweeps, values of --set.
#pragma once
#include <yaml-cpp/yaml.h>

#include <string>

namespace lab::yaml {

inline constexpr int kMaxValues = 100'000;  ///< in a text, each alias counted as what it stands for
inline constexpr int kMaxDepth = 64;

/// Parses a text. An alias is cheap to write and can stand for a list of aliases: a few hundred bytes can mean more values than
/// memory holds. Such a text is refused with an ExperimentError that begins with `place`; throws YAML::ParserException for
/// what is not YAML.
YAML::Node load(const std::string& text, const std::string& place);

}  // namespace lab::yaml
