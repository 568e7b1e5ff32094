#include "lab/sweep/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "lab/evaluation/evaluate.h"
#include "lab/report/html.h"
#include "lab/sweep/svg.h"
#include "lab/sweep/table.h"

namespace lab::sweep {
namespace {

constexpr double kLeft = 96, kTop = 16, kWidth = 500, kBottom = 48;  // px: margins of a plot and its inside
constexpr size_t kNamed = 20;                                        // runs that went wrong, in the table
constexpr size_t kTitled = 1000;  // cells of a map that say what they are; more make a heavy page

/// What the runs of one place have in common.
struct Place {
  double sum = 0, least = INFINITY, most = -INFINITY;
  int64_t values = 0, runs = 0, without = 0;  ///< without figures: ended early, or could not be run
  void add(const Row& row, size_t metric) {
    ++runs;
    without += !row.complete;
    if (row.metrics.empty() || !std::isfinite(row.metrics[metric])) return;
    const double value = row.metrics[metric];
    sum += value, ++values;
    least = std::min(least, value), most = std::max(most, value);
  }
  double mean() const { return sum / static_cast<double>(values); }
  std::string words(const std::string& where) const {
    std::string text = where + ": ";
    if (values == 0)
      text += without == runs ? "no figures" : "no value";
    else if (runs == 1)
      text += svg::label(mean());
    else
      text += fmt::format("mean {} of {} runs ({} .. {})", svg::label(mean()), values, svg::label(least),
                          svg::label(most));
    if (without > 0 && without < runs) text += fmt::format(", {} without figures", without);
    return text;
  }
};

std::optional<double> as_number(const std::string& text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

/// One key as the horizontal axis: a scale if all its values are numbers, else a place for each in turn.
class Horizontal {
 public:
  explicit Horizontal(const std::vector<std::string>& values) : values_(values) {
    for (const std::string& value : values_)
      if (const auto x = as_number(value)) numbers_.push_back(*x);
    if (numbers_.size() != values_.size()) {
      std::sort(values_.begin(), values_.end());
      values_.erase(std::unique(values_.begin(), values_.end()), values_.end());
      numbers_.clear();
    }
    scale_.emplace(numbers_, kLeft, kLeft + kWidth);
    std::sort(numbers_.begin(), numbers_.end());
    numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
    for (size_t i = 1; i < numbers_.size(); ++i)
      few_ = few_ && scale_->at(numbers_[i]) - scale_->at(numbers_[i - 1]) > 44;
  }
  double at(const std::string& value) const {
    if (!numbers_.empty()) return scale_->at(*as_number(value));
    const auto place = std::find(values_.begin(), values_.end(), value) - values_.begin();
    return kLeft + kWidth * (static_cast<double>(place) + 0.5) / static_cast<double>(values_.size());
  }
  std::string draw(double bottom, const std::string& name) const {
    std::string out =
        svg::text(kLeft + kWidth / 2, bottom + 38, name + (scale_->logarithmic() ? " (log)" : ""));
    const auto mark = [&](double x, const std::string& words) {
      out += svg::line(x, bottom, x, bottom + 5, "frame") + svg::text(x, bottom + 19, words);
    };
    if (numbers_.empty())
      for (const std::string& value : values_) mark(at(value), value);
    else
      for (double tick : few_ ? numbers_ : scale_->ticks()) mark(scale_->at(tick), svg::label(tick));
    return out;
  }

 private:
  std::vector<std::string> values_;
  std::vector<double> numbers_;
  bool few_ = true;  ///< so few values, and so far apart, that each can have its tick
  std::optional<svg::Scale> scale_;
};

class Page {
 public:
  Page(const Sweep& sweep, const std::vector<Row>& rows) : sweep_(sweep), rows_(rows) {}

  std::string write() {
    out_ = "<h1>Sweep " + report::escape(sweep_.name) + "</h1>\n";
    head();
    best();
    const size_t plots =
        !sweep_.grid.empty() + sweep_.draws.size();  // of each metric; single ones stand side by side
    out_ += plots == 1 ? "<div class=\"metrics\">\n" : "<div>\n";
    for (size_t m = 0; m < sweep_.metrics.size(); ++m) metric(m);
    out_ += "</div>\n";
    wrong();
    return report::page("sweep " + sweep_.name, out_);
  }

 private:
  void head() {
    const Counts counts = count(rows_);
    out_ += fmt::format(
        "<p>{} runs of <code>{}</code>: {} complete, {} ended early, {} could not be run.</p>\n<ul>\n",
        rows_.size(), report::escape(std::filesystem::path(sweep_.experiment).filename().string()),
        counts.complete, counts.ended_early, counts.unable);
    for (const Override& one : sweep_.set)
      out_ += "<li><code>" + report::escape(one.text) + "</code> in all runs</li>\n";
    for (const Axis& axis : sweep_.grid) {
      const size_t n = axis.values.size();
      std::string values;
      for (size_t i = 0; i < n; ++i) {
        if (n > 8 && i == 3)
          values += ", .., " + svg::label(axis.values[i = n - 1]);
        else
          values += (i ? ", " : "") + svg::label(axis.values[i]);
      }
      out_ += fmt::format("<li>grid: <code>{}</code>, {} values: {}</li>\n", report::escape(axis.key), n,
                          report::escape(values));
    }
    for (const Draw& draw : sweep_.draws)
      out_ += fmt::format("<li>drawn: <code>{}</code>, {} times, seed {}</li>\n", report::escape(draw.key),
                          sweep_.draw_count, sweep_.seed);
    out_ += "</ul>\n";
  }

  void best() {
    report::Table table{.head = {"metric", "smallest", "run", "largest", "run"}, .text_columns = 5};
    for (size_t m = 0; m < sweep_.metrics.size(); ++m) {
      const Extremes found = extremes(rows_, m);
      table.rows.push_back({report::escape(sweep_.metrics[m])});
      for (int64_t run : {found.smallest, found.largest}) {
        table.rows.back().push_back(run < 0 ? "–" : svg::label(rows_[static_cast<size_t>(run)].metrics[m]));
        table.rows.back().push_back(
            run < 0 ? "" : report::escape(fmt::format("{}: {}", run, short_settings(run))));
      }
    }
    out_ += report::section("Smallest and largest", table.html());
  }

  std::string short_settings(int64_t run) const {
    std::string text;
    const std::vector<std::string> keys = sweep_.keys(), values = sweep_.values(run);
    for (size_t i = 0; i < keys.size(); ++i) text += (i ? ", " : "") + keys[i] + " " + svg::label(values[i]);
    return text;
  }

  void wrong() {
    std::vector<size_t> runs;
    for (size_t run = 0; run < rows_.size(); ++run)
      if (!rows_[run].complete) runs.push_back(run);
    if (runs.empty()) return;
    report::Table table{.head = {"run", "settings", "reason"}, .text_columns = 3};
    for (size_t i = 0; i < std::min(runs.size(), kNamed); ++i)
      table.rows.push_back({fmt::format("{}", runs[i]),
                            report::escape(short_settings(static_cast<int64_t>(runs[i]))),
                            report::escape(rows_[runs[i]].reason)});
    std::string more;
    if (runs.size() > kNamed)
      more = fmt::format("<p>.. and {} more, in sweep.csv.</p>\n", runs.size() - kNamed);
    out_ += report::section("Runs without figures", table.html() + more);
  }

  void metric(size_t m) {
    const std::string& name = sweep_.metrics[m];
    out_ += "<section><h2>" + report::escape(name) + "</h2>\n";
    for (const Metric& known : metrics())
      if (known.name == name.substr(0, name.find('.')))
        out_ += fmt::format("<p class=\"soft\">{}{}</p>\n", report::escape(known.what),
                            *known.unit ? std::string(", ") + known.unit : "");
    const Extremes found = extremes(rows_, m);
    if (found.smallest < 0) {
      out_ += "<p>No run has a value.</p></section>\n";
      return;
    }
    out_ += "<div class=\"maps\">\n";
    if (sweep_.grid.size() >= 2) heat_map(m);
    if (sweep_.grid.size() == 1) along(m, sweep_.grid[0].key, 0, true);
    for (size_t i = 0; i < sweep_.draws.size(); ++i)
      along(m, sweep_.draws[i].key, sweep_.grid.size() + i, false);
    out_ += "</div>\n";
    if (const size_t more = sweep_.grid.size() > 2 ? sweep_.grid.size() - 2 : 0;
        more > 0 || (!sweep_.draws.empty() && !sweep_.grid.empty()))
      out_ +=
          "<p class=\"soft\">Over the grid: means of the runs that agree in what is shown; a cross in a "
          "corner: some of them have no figures.</p>\n";
    out_ += "<p class=\"soft\">Smallest: <code>" + report::escape(command(sweep_, found.smallest)) +
            "</code></p></section>\n";
  }

  void open(double height) { out_ += fmt::format("<svg viewBox=\"0 0 640 {:.0f}\" role=\"img\">\n", height); }

  void heat_map(size_t m) {
    const Axis &down = sweep_.grid[0], &across = sweep_.grid[1];
    const size_t rows = down.values.size(), columns = across.values.size();
    std::vector<Place> places(rows * columns);
    for (size_t run = 0; run < rows_.size(); ++run) {
      const std::vector<size_t> point = sweep_.point_of(static_cast<int64_t>(run));
      places[point[0] * columns + point[1]].add(rows_[run], m);
    }
    std::vector<double> means;
    for (const Place& place : places)
      if (place.values > 0) means.push_back(place.mean());
    const svg::Scale shade(means, 0, 1, false);
    const double w = kWidth / static_cast<double>(columns),
                 h = std::clamp(320 / static_cast<double>(rows), 4.0, 44.0);
    const double bottom = kTop + h * static_cast<double>(rows);
    open(bottom + kBottom + 34);
    const size_t every_row = 1 + static_cast<size_t>(13 / h), every_column = 1 + static_cast<size_t>(44 / w);
    for (size_t r = 0; r < rows; ++r) {
      const double y =
          bottom - h * static_cast<double>(r + 1);  // the first value at the bottom, as in a plot
      if (r % every_row == 0) out_ += svg::text(kLeft - 6, y + h / 2 + 4, svg::label(down.values[r]), "end");
      for (size_t c = 0; c < columns; ++c) {
        const Place& place = places[r * columns + c];
        const double x = kLeft + w * static_cast<double>(c);
        const std::string title =
            places.size() > kTitled
                ? ""
                : place.words(down.key + " " + down.values[r] + ", " + across.key + " " + across.values[c]);
        if (place.values == 0) {
          out_ += svg::rect(x, y, w, h, "var(--line)", title) + svg::cross(x + w / 2, y + h / 2, title);
          continue;
        }
        const double share = shade.share(place.mean());
        out_ += svg::rect(x, y, w, h, svg::colour(share), title);
        if (place.without > 0 && w > 24 && h > 15)
          out_ += svg::cross(x + w - 8, y + 8, title);  // the mean leaves some out
        if (w > 42 && h > 15)
          out_ += svg::text(x + w / 2, y + h / 2 + 4, fmt::format("{:.3g}", place.mean()), "middle",
                            fmt::format("style=\"fill:{}\" pointer-events=\"none\"", svg::ink(share)));
      }
    }
    for (size_t c = 0; c < columns; c += every_column)
      out_ +=
          svg::text(kLeft + w * (static_cast<double>(c) + 0.5), bottom + 17, svg::label(across.values[c]));
    out_ += svg::text(kLeft + kWidth / 2, bottom + 34, across.key);
    vertical_name(down.key, kTop + (bottom - kTop) / 2);
    // what the colours mean
    const double top = bottom + kBottom;
    for (int i = 0; i < 50; ++i)
      out_ += svg::rect(kLeft + kWidth * i / 50.0, top, kWidth / 50 + 0.5, 10, svg::colour((i + 0.5) / 50));
    out_ += svg::text(kLeft, top + 24, svg::label(shade.low()), "start") +
            svg::text(kLeft + kWidth, top + 24, svg::label(shade.high()), "end");
    out_ +=
        svg::text(kLeft + kWidth / 2, top + 24, sweep_.metrics[m] + (shade.logarithmic() ? " (log)" : "")) +
        "</svg>\n";
  }

  void vertical_name(const std::string& name, double y) {
    out_ += svg::text(16, y, name, "middle", fmt::format("transform=\"rotate(-90 16 {:.1f})\"", y));
  }

  /// The metric along one key: every run a point, or the mean of those of each value, joined by a line.
  void along(size_t m, const std::string& key, size_t which, bool joined) {
    std::map<std::string, Place> places;
    std::vector<std::string> values;
    for (size_t run = 0; run < rows_.size(); ++run) {
      values.push_back(sweep_.values(static_cast<int64_t>(run))[which]);
      places[joined ? values.back() : fmt::format("{}", run)].add(rows_[run], m);
    }
    std::vector<double> ends;
    for (const auto& [name, place] : places)
      if (place.values > 0) ends.push_back(place.least), ends.push_back(place.most);
    const double bottom = 300;
    const Horizontal x(values);
    const svg::Scale y(ends, bottom, kTop + 14);  // a strip on top is for the runs without a value
    open(bottom + kBottom);
    out_ +=
        fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" class=\"frame\" fill=\"none\"/>\n",
                    kLeft, kTop, kWidth, bottom - kTop);
    for (double tick : y.ticks())
      out_ += svg::line(kLeft, y.at(tick), kLeft + kWidth, y.at(tick), "grid") +
              svg::text(kLeft - 6, y.at(tick) + 4, svg::label(tick), "end");
    out_ += x.draw(bottom, key);
    vertical_name(sweep_.metrics[m] + (y.logarithmic() ? " (log)" : ""), (kTop + bottom) / 2);
    std::map<double, double> way;
    for (const auto& [name, place] : places) {
      const std::string& value = joined ? name : values[static_cast<size_t>(std::stoll(name))];
      const std::string title = place.words((joined ? "" : "run " + name + ", ") + key + " " + value);
      if (place.values == 0) {
        out_ += svg::cross(x.at(value), kTop + 8, title);
        continue;
      }
      if (place.values > 1)
        out_ += svg::line(x.at(value), y.at(place.least), x.at(value), y.at(place.most), "frame");
      out_ += svg::dot(x.at(value), y.at(place.mean()), joined ? 4 : 3, title);
      way[x.at(value)] = y.at(place.mean());
    }
    if (joined) {
      out_ += "<polyline class=\"way\" fill=\"none\" points=\"";
      for (const auto& [at, height] : way) out_ += fmt::format("{:.1f},{:.1f} ", at, height);
      out_ += "\"/>\n";
    }
    out_ += "</svg>\n";
  }

  const Sweep& sweep_;
  const std::vector<Row>& rows_;
  std::string out_;
};

}  // namespace

std::string page(const Sweep& sweep, const std::vector<Row>& rows) { return Page(sweep, rows).write(); }

}  // namespace lab::sweep
