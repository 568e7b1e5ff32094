// The frame of every page, and how pages write numbers and pictures.
#pragma once
#include <string>
#include <string_view>

namespace lab::page {

/// The whole document: nothing in it comes from elsewhere. `body` is HTML.
std::string document(const std::string& title, const std::string& body);

/// "0.1235", "1.2e-05" with a true minus sign; "–" if the value is not a number.
std::string figure(double value, int digits = 4);

/// The value of text that is a number, in four digits; other text as it is.
std::string short_figure(const std::string& text);

std::string base64(std::string_view bytes);

}  // namespace lab::page
