#include "lab/page/template.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/util/printable.h"

namespace lab::page {
namespace {

using nlohmann::json;

struct Tag {
  size_t begin = 0, end = 0;  ///< of the tag in the text; with its whole line if it stands alone
  char kind = 0;              ///< one of # ^ / > { or ' ' for a plain name
  std::string name;
};

bool truthy(const json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_string()) return !value.get_ref<const std::string&>().empty();
  if (value.is_array()) return !value.empty();
  return !value.is_null();
}

class Filler {
 public:
  Filler(const Texts& texts, const json& values) : texts_(texts), scopes_{&values} {}

  void file(std::string_view name) {
    const auto found = texts_.find(name);
    if (found == texts_.end()) throw std::logic_error("there is no template " + std::string(name));
    const std::string_view outer = std::exchange(text_, found->second);
    const std::string outer_file = std::exchange(file_, std::string(name));
    block(0, text_.size());
    text_ = outer;
    file_ = outer_file;
  }
  std::string take() { return std::move(out_); }

 private:
  [[noreturn]] void fault(const std::string& what) const { throw std::logic_error(file_ + ": " + what); }

  /// The next tag from `at` on; its kind is 0 if there is none before `end`.
  Tag next(size_t at, size_t end) const {
    Tag tag;
    tag.begin = text_.find("{{", at);
    if (tag.begin >= end) return tag;
    const bool raw = text_.substr(tag.begin, 3) == "{{{";
    const size_t close = text_.find(raw ? "}}}" : "}}", tag.begin);
    if (close >= end) fault("a tag does not end");
    size_t from = tag.begin + 2;
    tag.kind = std::string_view("#^/>{").find(text_[from]) != std::string_view::npos ? text_[from++] : ' ';
    tag.name = text_.substr(from, close - from);
    tag.end = close + (raw ? 3 : 2);
    if (tag.kind != ' ' && tag.kind != '{') take_line(tag);
    return tag;
  }

  /// Widens a tag that stands alone on its line to the whole line.
  void take_line(Tag& tag) const {
    const size_t before = tag.begin == 0 ? 0 : text_.rfind('\n', tag.begin - 1) + 1;
    const size_t after = text_.find('\n', tag.end);
    const std::string_view left = text_.substr(before, tag.begin - before),
                           right = text_.substr(tag.end, after - tag.end);
    if (left.find_first_not_of(' ') != left.npos || right.find_first_not_of(' ') != right.npos) return;
    tag.begin = before;
    tag.end = after == text_.npos ? text_.size() : after + 1;
  }

  /// The tag that closes the section `open`.
  Tag closing(const Tag& open, size_t end) const {
    int depth = 1;
    for (Tag tag = next(open.end, end); tag.kind; tag = next(tag.end, end)) {
      if (tag.name != open.name) continue;
      if (tag.kind == '#' || tag.kind == '^') ++depth;
      if (tag.kind == '/' && --depth == 0) return tag;
    }
    fault("{{#" + open.name + "}} is not closed");
  }

  void block(size_t at, size_t end) {
    for (Tag tag = next(at, end);; tag = next(at, end)) {
      out_ += text_.substr(at, std::min(tag.begin, end) - at);
      if (!tag.kind) return;
      at = tag.end;
      if (tag.kind == '#' || tag.kind == '^') {
        const Tag close = closing(tag, end);
        section(tag, close.begin);
        at = close.end;
      } else if (tag.kind == '/') {
        fault("{{/" + tag.name + "}} closes nothing");
      } else if (tag.kind == '>') {
        file(tag.name);
      } else {
        const std::string value = text_of(tag.name);
        out_ += tag.kind == '{' ? value : escape(value);
      }
    }
  }

  void section(const Tag& tag, size_t end) {
    const json* value = find(tag.name);
    const bool shown = value && truthy(*value);
    if (tag.kind == '^') {
      if (!shown) block(tag.end, end);
    } else if (shown && value->is_array()) {
      for (const json& item : *value) with(item, tag.end, end);
    } else if (shown) {
      with(*value, tag.end, end);
    }
  }

  void with(const json& scope, size_t at, size_t end) {
    scopes_.push_back(&scope);
    block(at, end);
    scopes_.pop_back();
  }

  const json* find(const std::string& name) const {
    if (name == ".") return scopes_.back();
    for (size_t i = scopes_.size(); i-- > 0;)
      if (scopes_[i]->is_object())
        if (const auto found = scopes_[i]->find(name); found != scopes_[i]->end()) return &*found;
    return nullptr;
  }

  std::string text_of(const std::string& name) const {
    const json* value = find(name);
    if (value && value->is_string()) return value->get<std::string>();
    if (value && (value->is_number_integer() || value->is_boolean())) return value->dump();
    fault("{{" + name + "}} has no value that is text");
  }

  const Texts& texts_;
  std::vector<const json*> scopes_;
  std::string_view text_;
  std::string file_, out_;
};

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  for (char c : printable_lines(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string fill(const Texts& texts, std::string_view file, const json& values) {
  Filler filler(texts, values);
  filler.file(file);
  return filler.take();
}

}  // namespace lab::page
