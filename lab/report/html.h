#pragma once
#include <string>
#include <string_view>
#include <vector>

/// Pieces of a page.
namespace lab::report {

std::string escape(std::string_view text);
std::string base64(std::string_view bytes);

/// "0.1235", "1.2e-05"; "–" for what is no number.
std::string figure(double value, int digits = 4);

/// Cells are HTML. The first column is text, the others are numbers unless `text_columns` says more.
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows{};
  size_t text_columns = 1;
  bool narrow = false;  ///< many columns
  std::string html() const;
};

/// <section> with a heading; for the table of contents of a print, too.
std::string section(const std::string& heading, const std::string& body);

/// One kind line about what is not there.
std::string missing(const std::string& why);

/// The whole document: nothing in it comes from elsewhere.
std::string page(const std::string& title, const std::string& body);

}  // namespace lab::report
