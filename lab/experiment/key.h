// The description of one key of an experiment: a row of the tables in keys.h and gains.h.
#pragma once
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace lab {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

struct Key {
  const char* name;  ///< as in the file, sections joined by dots
  const char* unit;
  const char* standard;  ///< the default, in words
  const char* doc;
  double min = -kInf, max = kInf;    ///< of every number
  std::vector<std::string> words{};  ///< allowed values of a text; empty = any
  bool canonical = true;             ///< part of RUN's text: can change what is logged

  Key one_of(std::vector<std::string> all) && {
    words = std::move(all);
    return std::move(*this);
  }
  Key outside_run() && {
    canonical = false;
    return std::move(*this);
  }
};

}  // namespace lab
