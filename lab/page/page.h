// The frame of every page, and how pages write numbers and pictures.
#pragma once
#include <string>
#include <string_view>

namespace lab::page {

/// The whole document: nothing in it comes from elsewhere. `body` is HTML.
std::string document(const std::string& title, const std::string& body);

/// "0.1235", "12346", "1.2e-05" with a true minus sign; "–" if the value is not a number. Of numbers below a million all
/// digits before the point are written.
std::string figure(double value, int digits = 4);

/// The value of text that is a number, in four digits; other text as it is.
std::string short_figure(const std::string& text);

/// A name as HTML that breaks after its underscores and dots where a long one does not fit.
std::string breakable(const std::string& name);

std::string base64(std::string_view bytes);

}  // namespace lab::page
