#include "lab/report/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "core/util/number.h"
#include "lab/report/html.h"

namespace lab::report {
namespace {

// What gnuplot is told, and finds again in its output as rgb( r,  g,  b): the page's style has the real colours.
struct InkRow {
  const char *hex, *rgb, *name;
};
constexpr std::array<InkRow, kInks> kInkTable{{{"#0072B2", "rgb(  0, 114, 178)", "blue"},
                                               {"#E69F00", "rgb(230, 159,   0)", "orange"},
                                               {"#D55E00", "rgb(213,  94,   0)", "red"},
                                               {"#009E73", "rgb(  0, 158, 115)", "green"},
                                               {"#CC79A7", "rgb(204, 121, 167)", "purple"},
                                               {"#56B4E9", "rgb( 86, 180, 233)", "sky"},
                                               {"#8C5A2B", "rgb(140,  90,  43)", "brown"},
                                               {"#7F7F7F", "rgb(127, 127, 127)", "grey"}}};
constexpr const char *kFrame = "#9AA0A6", *kGrid = "#E3E5E8", *kText = "#5F6368", *kBand = "#DDEEDD";

std::string coordinate(double value) { return rounded(value, 9); }

std::string data(const Curve& curve, size_t index) {
  std::string out = "$d" + std::to_string(index) + " << EOD\n";
  const bool bins = curve.x.size() > curve.y.size();  // bars end where the next begins
  for (size_t i = 0; i < curve.y.size(); ++i)
    out += coordinate(curve.x[i]) + " " + coordinate(curve.y[i]) +
           (bins ? " " + coordinate(curve.x[i + 1]) : "") + "\n";
  return out + "EOD\n";
}

/// Room around the data; a constant gets some, too, and so does what the six digits at the axis cannot tell from one.
std::pair<double, double> padded(std::pair<double, double> range) {
  const double size = range.second - range.first, middle = (range.first + range.second) / 2;
  double room = 0.06 * size;
  if (size <= 1e-5 * std::abs(middle) || size < 1e-12)
    room = std::abs(middle) < 1e-12 ? 1 : 0.1 * std::abs(middle);
  return {range.first - room, range.second + room};
}

/// Around the positive values, over six decades at most.
std::pair<double, double> log_range(const Chart& chart) {
  double least = INFINITY, most = 0;
  for (const Curve& curve : chart.curves)
    for (double y : curve.y)
      if (y > 0) least = std::min(least, y), most = std::max(most, y);
  if (most == 0) return {0.1, 1};
  return {std::max(least, most * 1e-6) / 1.2, most * 1.5};
}

/// Makes the ranges of an area `aspect` times as wide as high such that a length is the same on both axes.
void widen(std::pair<double, double>& x, std::pair<double, double>& y, double aspect) {
  const double width = x.second - x.first, height = y.second - y.first, more_x = aspect * height - width,
               more_y = width / aspect - height;
  if (more_x > 0) x.first -= more_x / 2, x.second += more_x / 2;
  if (more_y > 0) y.first -= more_y / 2, y.second += more_y / 2;
}

std::string one(const Chart& chart) {
  std::string s = "reset\nset encoding utf8\nset terminal svg size " + std::to_string(chart.width) + "," +
                  std::to_string(chart.height) +
                  " dynamic noenhanced font 'sans,11' linewidth 1\n"
                  "set border 3 lc rgb '" +
                  kFrame + "' lw 0.8\nset tics nomirror scale 0.4 textcolor rgb '" + kText +
                  "'\nset grid lt 1 lc rgb '" + kGrid +
                  "' lw 0.7\nunset key\nset format '%g'\n"
                  "set lmargin 8\nset rmargin 1.5\nset tmargin 0.7\nset bmargin 2.6\n"
                  "set xlabel '" +
                  chart.x_label + "' textcolor rgb '" + kText + "' offset 0,0.6\n";
  std::pair<double, double> x = x_range(chart), y = padded(y_range(chart));
  if (chart.equal) x = padded(x), widen(x, y, (chart.width - 62.0) / (chart.height - 45.0));
  if (x.first == x.second) x.second += 1;
  if (chart.logarithmic) {
    y = log_range(chart), s += "set logscale y\nset grid noxtics\nset format y '%.0e'\n";
  } else if (chart.bars) {
    s += "set logscale x\nset grid noxtics\nset style fill solid 1 noborder\n";
    y.first = 0;
  } else if (!chart.equal) {
    s += "set grid noxtics\n";
  }
  s += "set xrange [" + coordinate(x.first) + ":" + coordinate(x.second) + "]\nset yrange [" +
       coordinate(y.first) + ":" + coordinate(y.second) + "]\n";
  int object = 1;
  for (const auto& [low, high] : chart.bands) {
    if (low > y.second || high < y.first) continue;
    s += "set object " + std::to_string(object++) + " rectangle from graph 0,first " +
         coordinate(std::max(low, y.first)) + " to graph 1,first " + coordinate(std::min(high, y.second)) +
         " behind fillcolor rgb '" + kBand + "' fillstyle solid 1 noborder\n";
  }
  for (size_t i = 0; i < chart.curves.size(); ++i) s += data(chart.curves[i], i);
  std::string plots;
  const auto add = [&](const std::string& text) { plots += (plots.empty() ? "plot " : ", \\\n  ") + text; };
  for (double level : chart.levels)
    if (level >= y.first && level <= y.second)
      add(coordinate(level) + " with lines lw 1 dt 2 lc rgb '" + kFrame + "'");
  for (size_t i = 0; i < chart.curves.size(); ++i) {
    const Curve& curve = chart.curves[i];
    const std::string ink = kInkTable[static_cast<size_t>(curve.ink)].hex;
    if (chart.bars && i == 0)
      add("$d0 using 1:2:1:3:(0):2 with boxxyerrorbars lc rgb '" + ink + "'");
    else
      add("$d" + std::to_string(i) + " with lines lw " + coordinate(curve.width) +
          (curve.dashed ? " dt 2" : "") + " lc rgb '" + ink + "'");
  }
  if (plots.empty()) plots = "plot 1/0";
  return s + plots + "\n";
}

std::string read_all(int fd) {
  std::string out;
  char part[65536];
  for (ssize_t n; (n = read(fd, part, sizeof part)) != 0;) {
    if (n < 0 && errno != EINTR) break;
    if (n > 0) out.append(part, static_cast<size_t>(n));
  }
  return out;
}

int memory_file(const char* name) {
  const int fd = memfd_create(name, MFD_CLOEXEC);
  if (fd < 0)
    throw std::runtime_error(std::string("no memory for gnuplot's script (") + std::strerror(errno) + ")");
  return fd;
}

/// The first line of what gnuplot wrote that says more than where it was, and is no warning.
std::string first_error(const std::string& complaint) {
  std::istringstream lines(complaint);
  for (std::string line; std::getline(lines, line);)
    if (const size_t from = line.find_first_not_of(" ^\t");
        from != std::string::npos && line.find("warning:") == std::string::npos)
      return line.substr(from);
  return "it does not say why";
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// gnuplot titles each curve with its own words: put the curve's label there, for who points at it, or nothing.
void rename_curves(std::string& svg, const Chart& chart) {
  for (size_t at = 0; (at = svg.find("<g id=\"gnuplot_plot_", at)) != std::string::npos;) {
    const size_t title = svg.find("<title>", at), end = svg.find("</title>", at);
    if (title == std::string::npos || end == std::string::npos) return;
    std::string label;
    if (svg.compare(title + 7, 2, "$d") == 0)
      if (const size_t i = std::stoul(svg.substr(title + 9)); i < chart.curves.size())
        label = chart.curves[i].label;
    const std::string now = label.empty() ? "<g>" : "<g><title>" + escape(label) + "</title>";
    svg.replace(at, end + 8 - at, now);
    at += now.size();
  }
}

/// Every element has a class of its own; what its group says of colours and ends is the page's default. Empty groups go.
void strip_groups(std::string& svg) {
  std::string out;
  const std::string colours = "<g fill=\"none\" color=", width = "stroke-width=", empty = "</g>\n";
  size_t at = 0;
  for (size_t found; (found = svg.find(colours, at)) != std::string::npos;) {
    out.append(svg, at, found - at);
    const size_t from = svg.find(width, found), to = svg.find(' ', from), end = svg.find(">\n", found) + 2;
    at = end;
    if (svg.compare(end, empty.size(), empty) == 0)
      at += empty.size();
    else
      out += "<g " + svg.substr(from, to - from) + ">\n";
  }
  svg = out.append(svg, at);
}

}  // namespace

std::string script(const std::vector<Chart>& charts) {
  std::string all;
  for (const Chart& chart : charts) all += one(chart);
  return all;
}

std::vector<std::string> clean(const std::string& output, const std::vector<Chart>& charts) {
  std::vector<std::string> all;
  for (size_t at = output.find("<?xml"); at != std::string::npos;) {
    const size_t next = output.find("<?xml", at + 5), canvas = output.find("<g id=\"gnuplot_canvas\">", at),
                 defs = output.find("</defs>", at), end = output.rfind("</svg>", next);
    if (canvas == std::string::npos || defs == std::string::npos || all.size() == charts.size()) break;
    const Chart& chart = charts[all.size()];
    std::string body = "<g>" + output.substr(defs + 7, end - defs - 7);
    rename_curves(body, chart);
    for (const InkRow& ink : kInkTable) {
      replace_all(body, std::string("stroke='") + ink.rgb + "'", std::string("class=\"s-") + ink.name + "\"");
      replace_all(body, std::string("fill = '") + ink.rgb + "'", std::string("class=\"f-") + ink.name + "\"");
    }
    replace_all(body, "stroke='rgb(227, 229, 232)' class=\"gridline\" ", "class=\"grid\"");
    replace_all(body, "stroke='rgb(154, 160, 166)'", "class=\"frame\"");
    replace_all(body, "fill = 'rgb(221, 238, 221)'", "class=\"band\"");
    replace_all(body, "stroke=\"none\" fill=\"rgb(95,99,104)\" font-family=\"sans\" font-size=\"11.00\" ",
                "class=\"t\"");
    replace_all(body, "<tspan font-family=\"sans\" >", "<tspan>");
    strip_groups(body);
    all.push_back("<svg viewBox=\"0 0 " + std::to_string(chart.width) + " " + std::to_string(chart.height) +
                  "\" role=\"img\" aria-label=\"" + escape(chart.title) + "\">" + body + "</svg>");
    at = next;
  }
  return all;
}

std::optional<std::vector<std::string>> draw(const std::vector<Chart>& charts) {
  const std::string text = script(charts);
  const int in = memory_file("script"), err = memory_file("complaints");
  if (write(in, text.data(), text.size()) != static_cast<ssize_t>(text.size()) || lseek(in, 0, SEEK_SET) != 0)
    throw std::runtime_error("gnuplot's script cannot be written");
  int out[2];
  if (pipe2(out, O_CLOEXEC) != 0)
    throw std::runtime_error(std::string("no pipe for gnuplot (") + std::strerror(errno) + ")");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err, 2);
  // the same picture whatever the user's settings: no ~/.gnuplot (-d), no locale
  std::vector<char*> environment;
  std::string locale = "LC_ALL=C";
  for (char** one = environ; *one; ++one)
    if (std::strncmp(*one, "LC_", 3) != 0 && std::strncmp(*one, "GNUTERM", 7) != 0 &&
        std::strncmp(*one, "GNUPLOT", 7) != 0)
      environment.push_back(*one);
  environment.push_back(locale.data());
  environment.push_back(nullptr);
  std::string program = "gnuplot", option = "-d";
  char* arguments[] = {program.data(), option.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environment.data());
  posix_spawn_file_actions_destroy(&actions);
  close(in), close(out[1]);
  std::string output, complaint;
  int status = 0;
  if (!failed) {
    output = read_all(out[0]);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    lseek(err, 0, SEEK_SET);
    complaint = read_all(err);
  }
  close(out[0]), close(err);
  if (failed == ENOENT) return std::nullopt;
  if (failed)
    throw std::runtime_error(std::string("gnuplot cannot be started (") + std::strerror(failed) + ")");
  std::vector<std::string> all = clean(output, charts);
  if (status != 0 || all.size() != charts.size()) {
    throw std::runtime_error("gnuplot drew " + std::to_string(all.size()) + " of " +
                             std::to_string(charts.size()) + " pictures: " + first_error(complaint));
  }
  return all;
}

}  // namespace lab::report
